//! Scene files, meshes and pictures, read into the library's own types.

mod files;
mod framing;
pub mod gltf;
mod gzip;
pub mod load;
mod mesh;
pub mod mitsuba;
mod mtl;
mod named;
pub mod obj;
pub mod obj_scene;
pub mod pbrt;
pub mod ply;
pub mod serialized;
mod source;
mod spectrum;
pub mod stl;
pub mod toml;
mod value;
mod vol;

use std::collections::HashMap;
use std::sync::Arc;

use crate::error::{Error, Place, Warning};
use crate::scene::SceneDescription;

pub use files::Files;

/// A scene file as read: what it says, where it says it, and what we could not do.
#[derive(Debug, Default)]
pub struct Imported {
    /// What the file says.
    pub description: SceneDescription,
    /// Where it says it, by key path.
    pub places: Places,
    /// What was left out or done differently, each with its place.
    pub warnings: Vec<Warning>,
    /// Files that lie inside the scene file, as pictures do in a `.glb`, by the names that the description gives
    /// them; see [`Files::with_embedded`].
    pub embedded: HashMap<String, Arc<[u8]>>,
}

/// The most warnings that are told of one file: who reads a thousand will not read more, and a file can give cause to
/// one with every second byte.
const MOST_WARNINGS: usize = 1000;

/// Adds what `warning` makes to `warnings`, where there is room.
fn warn(warnings: &mut Vec<Warning>, warning: impl FnOnce() -> Warning) {
    match warnings.len() {
        ..MOST_WARNINGS => warnings.push(warning()),
        MOST_WARNINGS => warnings.push(Warning::new(format!("only the first {MOST_WARNINGS} warnings are shown"))),
        _ => {}
    }
}

/// Whether another warning would be told.
fn has_room(warnings: &[Warning]) -> bool {
    warnings.len() <= MOST_WARNINGS
}

/// Where each part of a description stands in its file, by key path: `shapes[2]`, `shapes[2].radius`.
#[derive(Debug, Default)]
pub struct Places(HashMap<String, Place>);

impl Places {
    /// Notes where `key` stands.
    pub fn note(&mut self, key: impl Into<String>, place: Place) {
        self.0.insert(key.into(), place);
    }

    /// The place of `key`, or of the nearest part around it that has one.
    pub fn find(&self, key: &str) -> Option<&Place> {
        let mut key = key.trim_start_matches('/');
        loop {
            if let Some(place) = self.0.get(key) {
                return Some(place);
            }
            key = &key[..key.rfind(['.', '['])?];
        }
    }

    /// The same error with the place of its key.
    pub fn locate(&self, error: Error) -> Error {
        match error.key.as_deref().and_then(|key| self.find(key)) {
            Some(place) => {
                let place = place.clone();
                error.with_place(place)
            }
            None => error,
        }
    }
}
