//! Scenes as files of our own: TOML, with what other formats hold inside their files written beside it.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use super::{check_writable, write_whole};
use crate::error::{Error, Result};
use crate::geometry::MeshData;
use crate::import::Imported;
use crate::scene::SceneDescription;
use crate::scene::description::{GeometryDescription, LightDescription, ShapeDescription, TextureDescription};
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
/// lie inside the source become files beside `path`, and names of other files are made relative to it. Returns the
/// files that were written, the scene last.
///
/// # Errors
/// As [`check_scene_path`]; a number that is not finite; or what the operating system says.
pub fn write_scene(path: &Path, imported: &Imported, source: &Path) -> Result<Vec<PathBuf>> {
    check_scene_path(path)?;
    let mut moved = Move {
        from: source.parent().unwrap_or(Path::new("")).to_path_buf(),
        to: path.parent().unwrap_or(Path::new("")).to_path_buf(),
        stem: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        imported,
        meshes: BTreeMap::new(),
        pictures: BTreeMap::new(),
        written: Vec::new(),
    };
    let mut description = imported.description.clone();
    moved.scene(&mut description)?;
    let text = notation::text(&description).ok_or_else(|| {
        Error::new(format!("cannot write '{}': the scene holds a number that is not finite", path.display()))
    })?;
    write_whole(path, text.as_bytes())?;
    moved.written.push(path.to_path_buf());
    Ok(moved.written)
}

/// A scene on its way from one folder to another.
struct Move<'a> {
    from: PathBuf,
    to: PathBuf,
    /// What the names of new files begin with.
    stem: String,
    imported: &'a Imported,
    /// Files of meshes written, by the mesh's address: the description shares what it can.
    meshes: BTreeMap<usize, String>,
    /// Files of pictures written, by their names inside the source.
    pictures: BTreeMap<String, String>,
    written: Vec<PathBuf>,
}

impl Move<'_> {
    fn scene(&mut self, description: &mut SceneDescription) -> Result<()> {
        for shape in description.shapes.iter_mut().chain(description.groups.values_mut().flatten()) {
            self.shape(shape)?;
        }
        for texture in description.textures.values_mut() {
            if let TextureDescription::Bitmap { file, .. } = texture {
                self.picture(file)?;
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
            GeometryDescription::Mesh { file, .. } => *file = self.elsewhere(file),
            GeometryDescription::Triangles(data) => {
                let file = self.mesh(data)?;
                shape.geometry =
                    GeometryDescription::Mesh { file, index: 0, face_normals: false, smooth: false, flip_v: false };
            }
            _ => {}
        }
        Ok(())
    }

    fn mesh(&mut self, data: &Arc<MeshData>) -> Result<String> {
        let address = Arc::as_ptr(data) as usize;
        if let Some(file) = self.meshes.get(&address) {
            return Ok(file.clone());
        }
        let file = format!("{}-mesh{}.ply", self.stem, self.meshes.len());
        self.write(&file, &encode_mesh(data))?;
        self.meshes.insert(address, file.clone());
        Ok(file)
    }

    fn picture(&mut self, file: &mut String) -> Result<()> {
        let Some(bytes) = self.imported.embedded.get(file) else {
            *file = self.elsewhere(file);
            return Ok(());
        };
        if let Some(written) = self.pictures.get(file) {
            file.clone_from(written);
            return Ok(());
        }
        let ending = match bytes {
            _ if bytes.starts_with(b"\x89PNG") => "png",
            _ if bytes.starts_with(b"\xff\xd8") => "jpg",
            _ if bytes.starts_with(b"\x76\x2f\x31\x01") => "exr",
            _ if bytes.starts_with(b"#?") => "hdr",
            _ => "tga",
        };
        let name = format!("{}-image{}.{ending}", self.stem, self.pictures.len());
        self.write(&name, bytes)?;
        self.pictures.insert(file.clone(), name.clone());
        *file = name;
        Ok(())
    }

    fn write(&mut self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.to.join(name);
        write_whole(&path, bytes)?;
        self.written.push(path);
        Ok(())
    }

    /// The name, from where the scene goes, of a file that is named from where it was.
    fn elsewhere(&self, file: &str) -> String {
        let path = self.from.join(file);
        let (Ok(path), Ok(folder)) = (std::path::absolute(&path), std::path::absolute(&self.to)) else {
            return path.to_string_lossy().into_owned();
        };
        relative(&path, &folder).to_string_lossy().into_owned()
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
    use crate::import::{ply, toml};

    #[test]
    fn a_written_mesh_is_read_as_it_was() {
        let mesh = MeshData {
            positions: vec![[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]],
            normals: vec![[0.0, 0.0, 1.0]; 3],
            uvs: vec![[0.25, 0.5], [1.0, 0.0], [0.0, 1.0]],
            colors: vec![[0.1, 0.2, 0.3], [1.0, 0.5, 0.0], [0.0, 0.0, 1.0]],
            triangles: vec![[0, 1, 2]],
        };
        assert_eq!(ply::read("a.ply", &encode_mesh(&mesh)).expect("a mesh"), mesh);
    }

    #[test]
    fn names_are_relative_to_the_new_folder() {
        let seen =
            |path: &str, folder: &str| relative(Path::new(path), Path::new(folder)).to_string_lossy().into_owned();
        assert_eq!(seen("/a/b/../c/t.png", "/a/c"), "t.png");
        assert_eq!(seen("/a/b/t.png", "/a/c/d"), "../../b/t.png");
    }

    #[test]
    fn a_scene_says_the_same_after_a_round_trip() {
        let text = "camera = { origin = [0, 0, 4], target = [0, 0.1, 0], fov = 35.5 }
            film = { size = [40, 30], filter = { type = 'tent' } }
            integrator = { type = 'photon-map', k = 20, radius = 0.1 }
            textures = { wood = { type = 'bitmap', file = 'wood.png', wrap = 'mirror' },
                         board = { type = 'checkerboard', color0 = 'wood', color1 = [0.1, 0.2, 0.3] } }
            materials = { floor = { type = 'two-sided', front = { type = 'plastic', reflectance = 'board' } },
                          shiny = { type = 'principled', metallic = 1, base-color = [0.9, 0.6, 0.1] },
                          gold = { type = 'conductor', metal = 'Au', roughness = { alpha = 0.2 } } }
            groups = { pair = [{ type = 'sphere', material = 'gold' }, { type = 'cube', material = { type = 'mirror' } }] }
            lights = [{ type = 'sky', sun-direction = [1, 1, 0] }, { type = 'point', position = [0, 1, 0], power = 3 }]
            shapes = [{ type = 'quad', corner = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0], material = 'floor',
                        emission = { radiance = 'wood', scale = 3 } },
                      { type = 'instance', group = 'pair', transform = [{ translate = [1, 2, 3] }, { scale = 2 }] },
                      { type = 'mesh', file = 'bunny.obj', smooth = true, name = 'bunny' }]";
        let read =
            |text: &str| toml::read_str(Path::new("s.toml"), text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let first = read(text).description;
        let written = notation::text(&first).expect("a scene");
        assert_eq!(read(&written).description, first, "{written}");
        assert!(!written.contains("nearest") && !written.contains("max-bounces"), "defaults are left out: {written}");
    }
}
