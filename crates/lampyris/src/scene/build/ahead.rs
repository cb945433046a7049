//! Files read ahead, all at the same time, before the parts of the scene ask for them one after the other.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rayon::prelude::*;

use crate::geometry::MeshData;
use crate::scene::Assets;
use crate::scene::description::{
    GeometryDescription, LightDescription, SceneDescription, ShapeDescription, TextureDescription,
};
use crate::texture::Raster;

/// What has been read. As long as it is held here, [`Assets`] has it at hand.
pub(super) struct ReadAhead<'d> {
    /// Each with the number of shapes that are still to come and use it.
    meshes: BTreeMap<MeshKey<'d>, (Arc<MeshData>, usize)>,
    _pictures: Vec<Arc<Raster>>,
}

/// A file, and the number of a mesh in it.
type MeshKey<'d> = (&'d str, u32);

impl<'d> ReadAhead<'d> {
    /// Whatever cannot be read is left out; who asks for it will be told why.
    pub(super) fn new(description: &'d SceneDescription, assets: &dyn Assets) -> ReadAhead<'d> {
        let mut uses: BTreeMap<MeshKey, usize> = BTreeMap::new();
        let shapes = description.shapes.iter().chain(description.groups.values().flatten());
        shapes.filter_map(mesh).for_each(|key| *uses.entry(key).or_default() += 1);
        let of_lights = description.lights.iter().filter_map(sky);
        let pictures: BTreeSet<(&str, bool)> =
            description.textures.values().filter_map(picture).chain(of_lights).collect();
        // Both at once, so that a large picture does not wait for the meshes.
        let (meshes, pictures) = rayon::join(
            || {
                let read = |((file, index), uses)| Some(((file, index), (assets.mesh(file, index).ok()?, uses)));
                uses.into_par_iter().filter_map(read).collect()
            },
            || pictures.into_par_iter().filter_map(|(file, raw)| assets.picture(file, raw).ok()).collect(),
        );
        ReadAhead { meshes, _pictures: pictures }
    }

    /// The shape has been built: a mesh that no other one needs is let go, so that those that were moved to their place
    /// do not lie in memory twice.
    pub(super) fn built(&mut self, shape: &'d ShapeDescription) {
        let Some(key) = mesh(shape) else { return };
        if let Some((_, uses)) = self.meshes.get_mut(&key) {
            *uses = uses.saturating_sub(1);
            if *uses == 0 {
                self.meshes.remove(&key);
            }
        }
    }
}

fn mesh(shape: &ShapeDescription) -> Option<MeshKey<'_>> {
    match &shape.geometry {
        GeometryDescription::Mesh { file, index, .. } => Some((file, *index)),
        _ => None,
    }
}

fn sky(light: &LightDescription) -> Option<(&str, bool)> {
    match light {
        LightDescription::Environment { file, .. } => Some((file, false)),
        _ => None,
    }
}

fn picture(texture: &TextureDescription) -> Option<(&str, bool)> {
    match texture {
        TextureDescription::Bitmap { file, raw, .. } => Some((file, *raw)),
        _ => None,
    }
}
