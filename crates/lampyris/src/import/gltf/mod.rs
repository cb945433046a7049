//! glTF 2.0 scene files, `.gltf` and `.glb`.
//!
//! The JSON becomes a `Document` of serde's making, whose numbers are checked where they are used. Each kind of part
//! has its file here that turns it into its part of the description. Errors name the part by its path in the JSON,
//! `materials[3].normalTexture`, and give its line where the file is text.

mod accessor;
mod camera;
mod container;
mod document;
mod extensions;
mod light;
mod mesh;
mod nodes;
mod placing;
mod scattering;
mod source;
mod spots;
mod surface;
#[cfg(test)]
mod tests;
mod texture;

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use self::document::Document;
use self::mesh::GeometryKey;
use self::source::Buffers;
use self::spots::Spots;
use self::surface::Surface;
use super::{Imported, source as ordinary};
use crate::error::{Error, Place, Result, Warning};
use crate::geometry::{Bounds, MeshData};

/// Reads a glTF file, text or binary. Pictures beside it stay relative to its folder; those in it are
/// [`Imported::embedded`].
///
/// # Errors
/// Where the file or its buffers cannot be read, are no glTF 2.0 or contradict themselves, and for required extensions
/// that we lack; with the place where the file is text. What it has beyond that is a warning.
pub fn read(path: &Path) -> Result<Imported> {
    let bytes = ordinary::read(path).map_err(|error| Error::io(path, "read", &error))?;
    read_bytes(path, &bytes)
}

/// Reads the content of a file at `path`.
fn read_bytes(path: &Path, bytes: &[u8]) -> Result<Imported> {
    let container = container::open(bytes).map_err(|error| error.with_file(path))?;
    let text = std::str::from_utf8(container.json).map_err(|_| Error::new("the JSON is not UTF-8").with_file(path))?;
    let document: Document =
        serde_json::from_str(text).map_err(|error| not_as_expected(path, text, container.is_text, &error))?;
    let spots = if container.is_text { Spots::of(path, text) } else { Spots::none(path) };
    let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let importer = Importer {
        document: &document,
        path: path.to_path_buf(),
        file_name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        spots,
        buffers: Buffers::new(&document, folder, container.binary),
        imported: Imported::default(),
        geometries: HashMap::new(),
        surfaces: HashMap::new(),
        bind_matrices: HashMap::new(),
        warned: HashSet::new(),
        bounds: Bounds::EMPTY,
        glows: false,
        spent: 0,
    };
    importer.scene()
}

/// What serde says, in our words and at its place.
fn not_as_expected(path: &Path, text: &str, is_text: bool, error: &serde_json::Error) -> Error {
    let full = error.to_string();
    let message = full.rfind(" at line ").map_or(full.as_str(), |end| &full[..end]);
    let message = ["u32", "usize"].iter().fold(message.to_string(), |message, kind| {
        message.replace(&format!("expected {kind}"), "expected a whole number, 0 or more")
    });
    let message = message.replace("expected f32", "expected a number").replace("expected f64", "expected a number");
    if !is_text {
        let message = format!("in the JSON, line {}, column {}: {message}", error.line(), error.column());
        return Error::new(message).with_file(path);
    }
    let line_start: usize = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
    let at = line_start + error.column().saturating_sub(1);
    Error::new(message).with_place(Place::of(path, text, at..at + 1))
}

/// A description in the making.
struct Importer<'a> {
    document: &'a Document,
    path: PathBuf,
    /// Of the scene file, from which names of the pictures in it are made.
    file_name: String,
    spots: Spots,
    buffers: Buffers<'a>,
    imported: Imported,
    geometries: HashMap<GeometryKey, Option<Arc<MeshData>>>,
    /// By number of the material and whether the mesh has colours.
    surfaces: HashMap<(Option<usize>, bool), Surface>,
    /// The first matrix of each such accessor that was asked for.
    bind_matrices: HashMap<usize, Option<[f32; 16]>>,
    /// Warnings given already.
    warned: HashSet<String>,
    /// The box around all shapes.
    bounds: Bounds,
    /// Whether a surface emits that is taken for a light of the scene.
    glows: bool,
    /// Indices and instances read so far.
    spent: usize,
}

impl Importer<'_> {
    fn scene(mut self) -> Result<Imported> {
        self.check_version()?;
        extensions::check_required(self.document).map_err(|error| self.spots.placed("extensionsRequired", error))?;
        for name in extensions::unknown(self.document) {
            self.warn("extensionsUsed", format!("the extension '{name}' is not supported: left out"));
        }
        if !self.document.animations.is_empty() {
            self.warn("animations", "animations are left out: the scene stands still");
        }
        let placed = self.placed_nodes()?;
        self.shapes(&placed)?;
        if self.imported.description.shapes.is_empty() {
            let error = Error::new("the scene is empty: none of its nodes has a mesh of triangles");
            return Err(self.spots.placed("scenes", error));
        }
        self.lights(&placed)?;
        self.sky();
        self.camera(&placed)?;
        if self.imported.description.camera.is_none() {
            self.frame();
        }
        Ok(self.imported)
    }

    fn check_version(&self) -> Result<()> {
        let asset = self.document.asset.as_ref();
        let version = asset.map(|asset| asset.min_version.as_deref().unwrap_or(&asset.version));
        match version {
            Some(version)
                if version == "2.0"
                    || (version.starts_with("2.") && asset.is_some_and(|a| a.min_version.is_none())) =>
            {
                Ok(())
            }
            Some(version) => {
                let message = format!("the file is of glTF {version}; only version 2.0 can be read");
                let hint = "convert it, for example with Blender or gltf-pipeline";
                Err(self.spots.placed("asset", Error::new(message).with_hint(hint)))
            }
            None => Err(Error::new("this is no glTF file: it has no 'asset'").with_file(&self.path)),
        }
    }

    /// Warns of what stands at `path`, once for each message.
    fn warn(&mut self, path: &str, message: impl Into<String>) {
        let message = message.into();
        if super::has_room(&self.imported.warnings) && self.warned.insert(message.clone()) {
            let Importer { imported, spots, .. } = self;
            super::warn(&mut imported.warnings, || spots.placed(path, Warning::new(message)));
        }
    }

    /// Notes where a key of the description comes from.
    fn note(&mut self, key: impl Into<String>, path: &str) {
        if let Some(place) = self.spots.find(path) {
            self.imported.places.note(key, place);
        }
    }
}
