//! The files beside a scene file, opened as the scene asks for them.

use std::collections::HashMap;
use std::fs;
use std::hash::Hash;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};

use super::{gzip, obj, ply, serialized, source, stl, vol};
use crate::error::{Error, Result};
use crate::geometry::MeshData;
use crate::medium::VolumeData;
use crate::observer::{Observer, Silent, Work};
use crate::output::decode_texture;
use crate::scene::Assets;
use crate::texture::Raster;

/// Meshes and pictures from the file system. What is still in use somewhere is not read again.
pub struct Files<'o> {
    folder: PathBuf,
    observer: &'o dyn Observer,
    embedded: HashMap<String, Arc<[u8]>>,
    meshes: Shared<(String, u32), MeshData>,
    pictures: Shared<(String, bool), Raster>,
    volumes: Shared<String, VolumeData>,
}

impl<'o> Files<'o> {
    /// Names are relative to the folder of `scene_file`.
    pub fn beside(scene_file: &Path) -> Files<'o> {
        let folder = scene_file.parent().unwrap_or(Path::new("")).to_path_buf();
        let (meshes, pictures, volumes) = (Shared::default(), Shared::default(), Shared::default());
        Files { folder, observer: &Silent, embedded: HashMap::new(), meshes, pictures, volumes }
    }

    /// The same, telling `observer` how many bytes were read, file by file.
    #[must_use]
    pub fn observed(self, observer: &'o dyn Observer) -> Files<'o> {
        Files { observer, ..self }
    }

    /// The same with files that lie inside the scene file, which go before those beside it.
    #[must_use]
    pub fn with_embedded(self, embedded: HashMap<String, Arc<[u8]>>) -> Files<'o> {
        Files { embedded, ..self }
    }

    fn read_mesh(&self, file: &str, index: u32) -> Result<MeshData> {
        let path = self.folder.join(file);
        let mesh = read_mesh(&path, index);
        self.tell(&path);
        mesh
    }

    fn read_picture(&self, file: &str, raw: bool) -> Result<Raster> {
        if let Some(bytes) = self.embedded.get(file) {
            return decode_texture(file, bytes, raw);
        }
        let path = self.folder.join(file);
        let bytes = source::read(&path).map_err(|error| Error::io(&path, "read", &error))?;
        let picture = decode_texture(&path.to_string_lossy(), &bytes, raw);
        self.tell(&path);
        picture
    }

    fn read_volume(&self, file: &str) -> Result<VolumeData> {
        if let Some(bytes) = self.embedded.get(file) {
            return vol::read(file, bytes);
        }
        let path = self.folder.join(file);
        let bytes = source::read(&path).map_err(|error| Error::io(&path, "read", &error))?;
        let volume = vol::read(&path.to_string_lossy(), &bytes);
        self.tell(&path);
        volume
    }

    fn tell(&self, path: &Path) {
        let bytes = fs::metadata(path).map_or(0, |file| file.len());
        self.observer.work(&Work { bytes, ..Work::default() });
    }
}

impl Assets for Files<'_> {
    fn mesh(&self, file: &str, index: u32) -> Result<Arc<MeshData>> {
        self.meshes.get((file.to_string(), index), || self.read_mesh(file, index))
    }

    fn picture(&self, file: &str, raw: bool) -> Result<Arc<Raster>> {
        self.pictures.get((file.to_string(), raw), || self.read_picture(file, raw))
    }

    fn volume(&self, file: &str) -> Result<Arc<VolumeData>> {
        self.volumes.get(file.to_string(), || self.read_volume(file))
    }
}

/// Things that are made once as long as someone holds them, and that are not kept any longer: a mesh that was moved to
/// its place in the world needs no original beside it.
struct Shared<K, T>(Mutex<HashMap<K, Arc<Mutex<Weak<T>>>>>);

impl<K, T> Default for Shared<K, T> {
    fn default() -> Self {
        Shared(Mutex::default())
    }
}

impl<K: Eq + Hash, T> Shared<K, T> {
    fn get(&self, key: K, make: impl FnOnce() -> Result<T>) -> Result<Arc<T>> {
        // The lock on all is held only to find the cell, so that different things are made at the same time.
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let cell = Arc::clone(all.entry(key).or_default());
        drop(all);
        let mut held = cell.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(thing) = held.upgrade() {
            return Ok(thing);
        }
        let thing = Arc::new(make()?);
        *held = Arc::downgrade(&thing);
        Ok(thing)
    }
}

/// Reads a mesh in the format that the extension of `path` names, unpacked where another `.gz` follows it.
pub(super) fn read_mesh(path: &Path, index: u32) -> Result<MeshData> {
    let name = path.to_string_lossy();
    let failed = |error: std::io::Error| Error::io(path, "read", &error);
    let extension = mesh_extension(path);
    if index > 0 && matches!(extension.as_str(), "obj" | "ply" | "stl") {
        return Err(Error::new(format!("cannot read mesh {index} of '{name}': it has only one"))
            .with_hint("only .serialized files hold several meshes"));
    }
    let read: fn(&str, &[u8]) -> Result<MeshData> = match extension.as_str() {
        "obj" => obj::read,
        "ply" => ply::read,
        "stl" => stl::read,
        "serialized" => return serialized::read(&name, source::open(path).map_err(failed)?, index),
        _ => {
            return Err(Error::new(format!("cannot read '{name}': not a known mesh format"))
                .with_hint("known are .obj, .ply, .stl and .serialized"));
        }
    };
    let bytes = source::read(path).map_err(failed)?;
    read(&name, &gzip::unpacked(&name, &bytes)?)
}

/// The last part of a name in small letters, or the one before `.gz`.
pub(super) fn mesh_extension(path: &Path) -> String {
    let extension = |path: &Path| path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match extension(path) {
        packed if packed == "gz" => extension(Path::new(path.file_stem().unwrap_or_default())),
        plain => plain,
    }
}

#[cfg(test)]
mod tests;
