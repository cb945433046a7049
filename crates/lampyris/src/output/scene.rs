//! Scenes as files of our own: TOML, with what other formats hold inside their files written beside it.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use super::{check_writable, write_whole};
use crate::error::{Error, Result};
use crate::geometry::MeshData;
use crate::import::Imported;
use crate::scene::SceneDescription;
use crate::scene::description::{
    GeometryDescription, LightDescription, MediumDescription, ShapeDescription, TextureDescription,
};
use crate::scene::notation;

/// Finds what would stop [`write_scene`] from writing to `path`.
///
/// # Errors
/// An ending other than `.toml`, a folder that does not exist or may not be written to.
pub fn check_scene_path(path: &Path) -> Result<()> {
    if path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("toml")) {
        return Err(Error::new(format!("cannot write a scene to '{}': unknown format", path.display()))
            .with_hint("scenes can be written as .toml"));
    }
    check_writable(path)
}

/// Writes the scene that was read from `source` to `path`, each file whole or not at all: meshes and pictures that
/// lie inside the source become files beside `path`, whose names begin with its own, and names of other files are made
/// relative to it. Returns the files that were written, the scene last. If one cannot be written, those that are new
/// are removed again.
///
/// # Errors
/// As [`check_scene_path`]; a file that would take the place of `source` or of one that the scene names; a scene that
/// TOML cannot hold; or what the operating system says.
pub fn write_scene(path: &Path, imported: &Imported, source: &Path) -> Result<Vec<PathBuf>> {
    check_scene_path(path)?;
    let mut description = imported.description.clone();
    let mut moved = Move::new(path, imported, source);
    moved.scene(&mut description)?;
    let Some(text) = notation::text(&description) else {
        return Err(Error::new(format!(
            "cannot write '{}': the scene holds a number that TOML cannot",
            path.display()
        )));
    };
    moved.files.push((path.to_path_buf(), Content::Bytes(text.as_bytes())));
    moved.write()
}

/// A scene on its way from one folder to another.
struct Move<'a> {
    from: PathBuf,
    to: PathBuf,
    /// What the names of new files begin with.
    stem: String,
    embedded: &'a HashMap<String, Arc<[u8]>>,
    /// Files of meshes to be written, by the mesh's address: the description shares what it can.
    meshes: BTreeMap<usize, String>,
    /// Files of pictures to be written, by their names inside the source.
    pictures: BTreeMap<String, String>,
    /// What is to be written.
    files: Vec<(PathBuf, Content<'a>)>,
    /// Files that are read, by their true places: they must stay.
    kept: BTreeSet<PathBuf>,
}

enum Content<'a> {
    Bytes(&'a [u8]),
    Mesh(Arc<MeshData>),
}

impl<'a> Move<'a> {
    fn new(path: &Path, imported: &'a Imported, source: &Path) -> Move<'a> {
        let folder = |path: &Path| match path.parent() {
            Some(folder) if folder != Path::new("") => folder.to_path_buf(),
            _ => PathBuf::from("."),
        };
        Move {
            from: folder(source),
            to: folder(path),
            stem: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            embedded: &imported.embedded,
            meshes: BTreeMap::new(),
            pictures: BTreeMap::new(),
            files: Vec::new(),
            kept: source.canonicalize().into_iter().collect(),
        }
    }

    fn scene(&mut self, description: &mut SceneDescription) -> Result<()> {
        for shape in description.shapes.iter_mut().chain(description.groups.values_mut().flatten()) {
            self.shape(shape)?;
        }
        for texture in description.textures.values_mut() {
            if let TextureDescription::Bitmap { file, .. } = texture {
                self.picture(file)?;
            }
        }
        for medium in description.media.values_mut() {
            if let MediumDescription::Grid { file, albedo_file, .. } = medium {
                for file in [Some(file), albedo_file.as_mut()].into_iter().flatten() {
                    self.inside(file, "grid", |_| "vol")?;
                }
            }
        }
        for light in &mut description.lights {
            if let LightDescription::Environment { file, .. } = light {
                self.picture(file)?;
            }
        }
        Ok(())
    }

    fn shape(&mut self, shape: &mut ShapeDescription) -> Result<()> {
        match &mut shape.geometry {
            GeometryDescription::Mesh { file, .. } => *file = self.elsewhere(file)?,
            GeometryDescription::Triangles(data) => {
                let file = self.mesh(data);
                shape.geometry =
                    GeometryDescription::Mesh { file, index: 0, face_normals: false, smooth: false, flip_v: false };
            }
            _ => {}
        }
        Ok(())
    }

    fn mesh(&mut self, data: &Arc<MeshData>) -> String {
        let address = Arc::as_ptr(data) as usize;
        if let Some(file) = self.meshes.get(&address) {
            return file.clone();
        }
        let file = format!("{}-mesh{}.ply", self.stem, self.meshes.len());
        self.files.push((self.to.join(&file), Content::Mesh(Arc::clone(data))));
        self.meshes.insert(address, file.clone());
        file
    }

    fn picture(&mut self, file: &mut String) -> Result<()> {
        self.inside(file, "image", picture_ending)
    }

    /// A file that may lie inside the source: then it becomes one of this kind, with the ending that its bytes ask for.
    fn inside(&mut self, file: &mut String, kind: &str, ending: fn(&[u8]) -> &'static str) -> Result<()> {
        let embedded = self.embedded;
        let Some(bytes) = embedded.get(file) else {
            *file = self.elsewhere(file)?;
            return Ok(());
        };
        if let Some(written) = self.pictures.get(file) {
            file.clone_from(written);
            return Ok(());
        }
        let name = format!("{}-{kind}{}.{}", self.stem, self.pictures.len(), ending(bytes));
        self.files.push((self.to.join(&name), Content::Bytes(bytes)));
        self.pictures.insert(std::mem::replace(file, name.clone()), name);
        Ok(())
    }

    /// The name, from where the scene goes, of a file that is named from where it was.
    fn elsewhere(&mut self, file: &str) -> Result<String> {
        let path = self.from.join(file);
        // A file that is missing has no true place, and `..` means nothing after a link.
        let place = path.canonicalize().or_else(|_| std::path::absolute(&path));
        let folder = self.to.canonicalize();
        let (Ok(place), Ok(folder)) = (place, folder) else {
            return Err(Error::new(format!("cannot find '{}' from '{}'", path.display(), self.to.display())));
        };
        let seen = relative(&place, &folder);
        self.kept.insert(place);
        let parts: Option<Vec<&str>> = seen.iter().map(|part| part.to_str()).collect();
        match parts {
            // `/` is understood everywhere; a path with a root stays as it is.
            Some(parts) if seen.is_relative() => Ok(parts.join("/")),
            Some(_) => Ok(seen.to_string_lossy().into_owned()),
            None => Err(Error::new(format!("cannot write the name of '{}' in TOML: it is not UTF-8", seen.display()))),
        }
    }

    fn write(&self) -> Result<Vec<PathBuf>> {
        for (path, _) in &self.files {
            if path.canonicalize().is_ok_and(|place| self.kept.contains(&place)) {
                let message = format!("cannot write '{}': the scene is read from it", path.display());
                return Err(Error::new(message).with_hint("choose another name or folder"));
            }
        }
        let mut new: Vec<&Path> = Vec::new();
        for (path, content) in &self.files {
            let is_new = !path.exists();
            let written = match content {
                Content::Bytes(bytes) => write_whole(path, bytes),
                Content::Mesh(mesh) => write_whole(path, &encode_mesh(mesh)),
            };
            if let Err(error) = written {
                // The error is what there is to tell; that the rest could not be cleared away adds nothing.
                new.into_iter().for_each(|path| drop(std::fs::remove_file(path)));
                return Err(error);
            }
            if is_new {
                new.push(path);
            }
        }
        Ok(self.files.iter().map(|(path, _)| path.clone()).collect())
    }
}

/// The ending that the first bytes of a picture ask for.
fn picture_ending(bytes: &[u8]) -> &'static str {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => "png",
        [0xff, 0xd8, ..] => "jpg",
        [0x76, 0x2f, 0x31, 0x01, ..] => "exr",
        [b'#', b'?', ..] => "hdr",
        _ => "tga",
    }
}

/// `path` as seen from `folder`, both absolute; `path` itself where they have no root in common.
fn relative(path: &Path, folder: &Path) -> PathBuf {
    let (path, folder) = (plain(path), plain(folder));
    let common = path.iter().zip(&folder).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return path.iter().collect();
    }
    let up = folder[common..].iter().map(|_| Component::ParentDir);
    up.chain(path[common..].iter().copied()).collect()
}

/// The components of an absolute path without `.` and `..`.
fn plain(path: &Path) -> Vec<Component<'_>> {
    let mut components = Vec::new();
    for component in path.components() {
        match component {
            Component::ParentDir => drop(components.pop()),
            Component::CurDir => {}
            other => components.push(other),
        }
    }
    components
}

/// A mesh as binary PLY, little-endian.
fn encode_mesh(mesh: &MeshData) -> Vec<u8> {
    let lists: [(&[[f32; 3]], &str); 3] =
        [(&mesh.positions, "x y z"), (&mesh.normals, "nx ny nz"), (&mesh.colors, "r g b")];
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.len());
    let names = lists.iter().filter(|(list, _)| !list.is_empty()).map(|(_, names)| *names);
    let names = names.chain((!mesh.uvs.is_empty()).then_some("u v"));
    for name in names.flat_map(|names| names.split(' ')) {
        header.push_str(&format!("property float {name}\n"));
    }
    header.push_str(&format!(
        "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.triangles.len()
    ));
    let mut bytes = header.into_bytes();
    for vertex in 0..mesh.positions.len() {
        let vectors = lists.iter().filter_map(|(list, _)| list.get(vertex)).flatten();
        let numbers = vectors.chain(mesh.uvs.get(vertex).into_iter().flatten());
        numbers.for_each(|number| bytes.extend(number.to_le_bytes()));
    }
    for triangle in &mesh.triangles {
        bytes.push(3);
        triangle.iter().for_each(|index| bytes.extend(index.to_le_bytes()));
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::ply;

    #[test]
    fn a_written_mesh_is_read_as_it_was() {
        let mut mesh = MeshData {
            positions: vec![[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]],
            normals: vec![[0.3, 0.1, 1.0], [-7.0, 3.0, 0.2], [1e-3, -1.0, 0.9]],
            uvs: vec![[0.25, 0.5], [1.0, 0.0], [0.0, 1.0]],
            colors: vec![[0.1, 0.2, 0.3], [1.0, 0.5, 0.0], [0.0, 0.0, 1.0]],
            triangles: vec![[0, 1, 2]],
        };
        mesh.normalize_normals();
        assert_eq!(ply::read("a.ply", &encode_mesh(&mesh)).expect("a mesh"), mesh);
    }

    #[test]
    fn names_are_relative_to_the_new_folder() {
        let seen =
            |path: &str, folder: &str| relative(Path::new(path), Path::new(folder)).to_string_lossy().into_owned();
        assert_eq!(seen("/a/b/../c/t.png", "/a/c"), "t.png");
        assert_eq!(seen("/a/b/t.png", "/a/c/d"), "../../b/t.png");
    }
}
