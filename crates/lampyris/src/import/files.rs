//! The files beside a scene file, opened as the scene asks for them.

use std::collections::HashMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::{gzip, obj, ply, serialized, stl};
use crate::error::{Error, Result};
use crate::geometry::MeshData;
use crate::image::Image;
use crate::observer::{Observer, Silent, Work};
use crate::output::decode_texture;
use crate::scene::Assets;

/// Meshes and pictures from the file system. A mesh is read once, however often it is asked for.
pub struct Files<'o> {
    folder: PathBuf,
    observer: &'o dyn Observer,
    embedded: HashMap<String, Arc<[u8]>>,
    meshes: Mutex<HashMap<(String, u32), Arc<MeshOnce>>>,
}

/// A mesh or why there is none, once someone has asked for it.
type MeshOnce = OnceLock<Result<Arc<MeshData>>>;

impl<'o> Files<'o> {
    /// Names are relative to the folder of `scene_file`.
    pub fn beside(scene_file: &Path) -> Files<'o> {
        let folder = scene_file.parent().unwrap_or(Path::new("")).to_path_buf();
        Files { folder, observer: &Silent, embedded: HashMap::new(), meshes: Mutex::default() }
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

    fn tell(&self, path: &Path) {
        let bytes = fs::metadata(path).map_or(0, |file| file.len());
        self.observer.work(&Work { bytes, ..Work::default() });
    }
}

impl Assets for Files<'_> {
    fn mesh(&self, file: &str, index: u32) -> Result<Arc<MeshData>> {
        // The lock is held only to find the cell, so that different meshes are read at the same time.
        let mut meshes = self.meshes.lock().unwrap_or_else(PoisonError::into_inner);
        let cell = Arc::clone(meshes.entry((file.to_string(), index)).or_default());
        drop(meshes);
        let read = || {
            let path = self.folder.join(file);
            let mesh = read_mesh(&path, index).map(Arc::new);
            self.tell(&path);
            mesh
        };
        cell.get_or_init(read).clone()
    }

    fn image(&self, file: &str, raw: bool) -> Result<Arc<Image>> {
        if let Some(bytes) = self.embedded.get(file) {
            return decode_texture(file, bytes, raw).map(Arc::new);
        }
        let path = self.folder.join(file);
        let bytes = fs::read(&path).map_err(|error| Error::io(&path, "read", &error))?;
        let image = decode_texture(&path.to_string_lossy(), &bytes, raw).map(Arc::new);
        self.tell(&path);
        image
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
        "serialized" => return serialized::read(&name, File::open(path).map_err(failed)?, index),
        _ => {
            return Err(Error::new(format!("cannot read '{name}': not a known mesh format"))
                .with_hint("known are .obj, .ply, .stl and .serialized"));
        }
    };
    let bytes = fs::read(path).map_err(failed)?;
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
