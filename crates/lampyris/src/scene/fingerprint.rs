//! By what a scene is known again: a hash of its description, and of what the files that it names hold.

use std::collections::HashMap;
use std::fmt;
use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::Assets;
use super::description::{
    GeometryDescription, LightDescription, MediumDescription, RenderDescription, SceneDescription, ShapeDescription,
    TextureDescription,
};
use crate::error::Result;
use crate::geometry::MeshData;
use crate::medium::VolumeData;
use crate::texture::Raster;

/// SHA-256 of all that the light in a scene depends on, whatever its files are called and wherever they lie. Camera, film,
/// integrator and seed are left out. In hexadecimal digits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fingerprint(String);

impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Hands on what other assets give, and keeps the hash of each, for the [`Fingerprint`] of the scene that is
/// [built](super::build) with them.
pub struct NotedAssets<'a> {
    assets: &'a dyn Assets,
    meshes: Notes<u32>,
    pictures: Notes<bool>,
    volumes: Notes<()>,
}

/// Hashes by name and number.
type Notes<K> = Mutex<HashMap<(String, K), Fingerprint>>;

impl<'a> NotedAssets<'a> {
    /// Before the scene is built.
    pub fn new(assets: &'a dyn Assets) -> NotedAssets<'a> {
        NotedAssets { assets, meshes: Notes::default(), pictures: Notes::default(), volumes: Notes::default() }
    }

    /// The fingerprint of the scene that was built from this description.
    pub fn fingerprint(&self, description: &SceneDescription) -> Fingerprint {
        let mut scene = SceneDescription {
            camera: None,
            film: Default::default(),
            integrator: Default::default(),
            render: RenderDescription::default(),
            ..description.clone()
        };
        scene.shapes.iter_mut().chain(scene.groups.values_mut().flatten()).for_each(|shape| self.name_mesh(shape));
        for light in &mut scene.lights {
            if let LightDescription::Environment { file, .. } = light {
                *file = noted(&self.pictures, file, false);
            }
        }
        for medium in scene.media.values_mut() {
            if let MediumDescription::Grid { file, albedo_file, .. } = medium {
                for file in [Some(file), albedo_file.as_mut()].into_iter().flatten() {
                    *file = noted(&self.volumes, file, ());
                }
            }
        }
        for texture in scene.textures.values_mut() {
            if let TextureDescription::Bitmap { file, raw, .. } = texture {
                *file = noted(&self.pictures, file, *raw);
            }
        }
        hash(|hasher| {
            // A hasher takes all that is written, and every description can be told.
            let _ = serde_json::to_writer(Into(hasher), &scene);
        })
    }

    /// Names a mesh by what it holds.
    fn name_mesh(&self, shape: &mut ShapeDescription) {
        match &mut shape.geometry {
            GeometryDescription::Mesh { file, index, .. } => *file = noted(&self.meshes, file, *index),
            GeometryDescription::Triangles(mesh) => {
                let file = of_mesh(mesh).to_string();
                let [face_normals, smooth, flip_v] = [false; 3];
                shape.geometry = GeometryDescription::Mesh { file, index: 0, face_normals, smooth, flip_v };
            }
            _ => {}
        }
    }
}

/// The hash of a file; its name, if nobody has asked for it.
fn noted<K: Eq + std::hash::Hash>(notes: &Notes<K>, file: &str, which: K) -> String {
    let notes = notes.lock().unwrap_or_else(PoisonError::into_inner);
    notes.get(&(file.to_string(), which)).map_or_else(|| file.to_string(), Fingerprint::to_string)
}

fn note<K: Eq + std::hash::Hash + Copy>(notes: &Notes<K>, file: &str, which: K, of: impl FnOnce() -> Fingerprint) {
    let key = (file.to_string(), which);
    let is_known = |notes: &Notes<K>| notes.lock().unwrap_or_else(PoisonError::into_inner).contains_key(&key);
    // The lock is not held while hashing, so that several files are hashed at the same time.
    if !is_known(notes) {
        let found = of();
        notes.lock().unwrap_or_else(PoisonError::into_inner).insert(key, found);
    }
}

impl Assets for NotedAssets<'_> {
    fn mesh(&self, file: &str, index: u32) -> Result<Arc<MeshData>> {
        let mesh = self.assets.mesh(file, index)?;
        note(&self.meshes, file, index, || of_mesh(&mesh));
        Ok(mesh)
    }

    fn picture(&self, file: &str, raw: bool) -> Result<Arc<Raster>> {
        let picture = self.assets.picture(file, raw)?;
        note(&self.pictures, file, raw, || of_picture(&picture));
        Ok(picture)
    }

    fn volume(&self, file: &str) -> Result<Arc<VolumeData>> {
        let volume = self.assets.volume(file)?;
        note(&self.volumes, file, (), || of_volume(&volume));
        Ok(volume)
    }
}

fn of_mesh(mesh: &MeshData) -> Fingerprint {
    let MeshData { positions, normals, uvs, colors, triangles } = mesh;
    let lists: [&[u8]; 5] = [
        bytemuck::cast_slice(positions),
        bytemuck::cast_slice(normals),
        bytemuck::cast_slice(uvs),
        bytemuck::cast_slice(colors),
        bytemuck::cast_slice(triangles),
    ];
    of_lists(&lists)
}

fn of_volume(volume: &VolumeData) -> Fingerprint {
    let VolumeData { size, channels, bounds, values } = volume;
    of_lists(&[
        bytemuck::cast_slice(size),
        &channels.to_le_bytes(),
        bytemuck::cast_slice(bounds),
        bytemuck::cast_slice(values),
    ])
}

fn of_picture(picture: &Raster) -> Fingerprint {
    let (kind, texels) = picture.identity();
    of_lists(&[kind.as_bytes(), texels])
}

/// Of lists with their lengths.
fn of_lists(lists: &[&[u8]]) -> Fingerprint {
    hash(|hasher| {
        for list in lists {
            hasher.update((list.len() as u64).to_le_bytes());
            hasher.update(list);
        }
    })
}

fn hash(of: impl FnOnce(&mut Sha256)) -> Fingerprint {
    let mut hasher = Sha256::new();
    of(&mut hasher);
    Fingerprint(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Takes what is written.
struct Into<'a>(&'a mut Sha256);

impl Write for Into<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::toml::read_str;
    use crate::scene::NoAssets;

    /// One mesh, by any name.
    struct Same(MeshData);

    impl Assets for Same {
        fn mesh(&self, _: &str, _: u32) -> Result<Arc<MeshData>> {
            Ok(Arc::new(self.0.clone()))
        }

        fn picture(&self, file: &str, raw: bool) -> Result<Arc<Raster>> {
            NoAssets.picture(file, raw)
        }
    }

    fn triangle(height: f32) -> MeshData {
        let positions = vec![[0.0, height, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        MeshData { positions, triangles: vec![[0, 1, 2]], ..MeshData::default() }
    }

    fn fingerprint(text: &str, mesh: MeshData) -> Fingerprint {
        let text = format!(
            "lights = [{{ type = 'point', position = [0, 1, 0], intensity = 2 }}]
             camera = {{ origin = [0, 0, -3], target = [0, 0, 0] }}\n{text}"
        );
        let description = read_str("a.toml".as_ref(), &text).expect("a scene").description;
        let assets = Same(mesh);
        let noted = NotedAssets::new(&assets);
        super::super::build(&description, &noted).expect("it builds");
        noted.fingerprint(&description)
    }

    #[test]
    fn content_counts_and_names_do_not() {
        let scene = |name: &str| format!("shapes = [{{ type = 'mesh', file = '{name}' }}]");
        let found = fingerprint(&scene("a.ply"), triangle(0.0));
        assert_eq!(found, fingerprint(&scene("/home/me/b.ply"), triangle(0.0)));
        assert_ne!(found, fingerprint(&scene("a.ply"), triangle(0.1)));
        assert_ne!(found, fingerprint("shapes = [{ type = 'mesh', file = 'a.ply', smooth = true }]", triangle(0.0)));
    }

    #[test]
    fn settings_do_not_count_and_shapes_do() {
        let found = fingerprint("shapes = [{ type = 'sphere' }]", triangle(0.0));
        let settings = "film = { size = [3, 2] }\nintegrator = { type = 'path' }\nrender = { seed = 4 }\n";
        assert_eq!(found, fingerprint(&format!("{settings}shapes = [{{ type = 'sphere' }}]"), triangle(0.0)));
        assert_ne!(found, fingerprint("shapes = [{ type = 'sphere', radius = 2 }]", triangle(0.0)));
    }

    #[test]
    fn triangles_in_the_description_count() {
        let of = |height: f32| {
            let mut scene = SceneDescription::default();
            let sphere = read_str("a.toml".as_ref(), "shapes = [{ type = 'sphere' }]").expect("one").description;
            scene.shapes = sphere.shapes;
            scene.shapes[0].geometry = GeometryDescription::Triangles(Arc::new(triangle(height)));
            NotedAssets::new(&NoAssets).fingerprint(&scene)
        };
        assert_ne!(of(0.0), of(1.0));
    }
}
