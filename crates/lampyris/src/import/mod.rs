//! Scene files, meshes and pictures, read into the library's own types.

pub mod mitsuba;

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::error::{Error, Place, Result, Warning};
use crate::geometry::MeshData;
use crate::image::Image;
use crate::scene::{Assets, SceneDescription};

/// A scene file as read: what it says, where it says it, and what we could not do.
#[derive(Debug, Default)]
pub struct Imported {
    /// What the file says.
    pub description: SceneDescription,
    /// Where it says it, by key path.
    pub places: Places,
    /// What was left out or done differently, each with its place.
    pub warnings: Vec<Warning>,
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
        let mut key = key;
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

/// The files beside a scene file, opened as the scene asks for them.
pub struct Files {
    folder: PathBuf,
}

impl Files {
    /// Names are relative to the folder of `scene_file`.
    pub fn beside(scene_file: &Path) -> Files {
        Files { folder: scene_file.parent().unwrap_or(Path::new("")).to_path_buf() }
    }
}
