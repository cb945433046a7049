//! The hierarchy of nodes, from the roots of a scene down.

use glam::{DMat4, DQuat, DVec3, DVec4};

use super::Importer;
use super::document::Node;
use super::source::missing;
use crate::error::Result;

/// A node at its place in the world.
pub(super) struct Placed {
    pub node: usize,
    pub to_world: DMat4,
}

impl<'a> Importer<'a> {
    /// The nodes of the scene that the file shows, parents before their children.
    pub(super) fn placed_nodes(&mut self) -> Result<Vec<Placed>> {
        let mut waiting: Vec<Placed> =
            self.roots()?.into_iter().rev().map(|node| Placed { node, to_world: DMat4::IDENTITY }).collect();
        let mut placed = Vec::new();
        let mut met = vec![false; self.document.nodes.len()];
        while let Some(Placed { node: index, to_world }) = waiting.pop() {
            let path = format!("nodes[{index}]");
            let node = self.node(index)?;
            if std::mem::replace(&mut met[index], true) {
                return Err(self.spots.fault(&path, "the node has two parents, or is its own ancestor"));
            }
            let to_world = to_world * local(node);
            waiting.extend(node.children.iter().rev().map(|&node| Placed { node, to_world }));
            placed.push(Placed { node: index, to_world });
        }
        Ok(placed)
    }

    pub(super) fn node(&self, index: usize) -> Result<&'a Node> {
        let nodes = &self.document.nodes;
        nodes.get(index).ok_or_else(|| missing(&self.spots, &format!("nodes[{index}]"), nodes.len()))
    }

    fn roots(&mut self) -> Result<Vec<usize>> {
        let scenes = &self.document.scenes;
        match (self.document.scene, scenes.first()) {
            (Some(index), _) => match scenes.get(index) {
                Some(scene) => Ok(scene.nodes.clone()),
                None => Err(missing(&self.spots, &format!("scenes[{index}]"), scenes.len())),
            },
            (None, Some(scene)) => Ok(scene.nodes.clone()),
            // A library of nodes: all that are no one's children.
            (None, None) => {
                let nodes = &self.document.nodes;
                let mut is_child = vec![false; nodes.len()];
                for &child in nodes.iter().flat_map(|node| &node.children) {
                    if let Some(is_child) = is_child.get_mut(child) {
                        *is_child = true;
                    }
                }
                Ok((0..nodes.len()).filter(|&node| !is_child[node]).collect())
            }
        }
    }

    /// What moves the mesh of a node to the world. The node of a skinned mesh does not move it: its bones do, all
    /// in the same way while the skin is at rest.
    pub(super) fn mesh_to_world(&mut self, placed: &[Placed], at: usize) -> Result<DMat4> {
        let Placed { node: index, to_world } = placed[at];
        let Some(skin) = self.node(index)?.skin else { return Ok(to_world) };
        self.warn("skins", "skins are left out: their meshes stand as they were bound");
        let skins = &self.document.skins;
        let skin = skins.get(skin).ok_or_else(|| missing(&self.spots, &format!("skins[{skin}]"), skins.len()))?;
        let bone = skin.joints.first().and_then(|joint| placed.iter().find(|placed| placed.node == *joint));
        let (Some(bone), Some(matrices)) = (bone, skin.inverse_bind_matrices) else { return Ok(to_world) };
        let inverse = match self.bind_matrices.get(&matrices) {
            Some(inverse) => *inverse,
            None => {
                let inverse = self.vectors::<16>(matrices)?.first().copied();
                *self.bind_matrices.entry(matrices).or_insert(inverse)
            }
        };
        Ok(match inverse {
            Some(inverse) => bone.to_world * DMat4::from_cols_array(&inverse.map(f64::from)),
            None => to_world,
        })
    }

    /// The places of the copies of a node's mesh that `EXT_mesh_gpu_instancing` asks for, relative to the node.
    pub(super) fn copies(&mut self, index: usize) -> Result<Option<Vec<DMat4>>> {
        let Some(instancing) = &self.node(index)?.extensions.instancing else { return Ok(None) };
        let attributes = &instancing.attributes;
        let read = |accessor: Option<usize>| accessor.map(|accessor| self.vectors::<3>(accessor)).transpose();
        let (translations, scales) = (read(attributes.translation)?, read(attributes.scale)?);
        let rotations = attributes.rotation.map(|accessor| self.vectors::<4>(accessor)).transpose()?;
        let counts = [translations.as_ref().map(Vec::len), scales.as_ref().map(Vec::len)];
        let counts: Vec<usize> = counts.into_iter().chain([rotations.as_ref().map(Vec::len)]).flatten().collect();
        let count = counts.first().copied().unwrap_or(0);
        if counts.iter().any(|&other| other != count) {
            let message = "the attributes of the instances have different lengths";
            return Err(self.spots.fault(&format!("nodes[{index}]"), message));
        }
        self.spend(count, &format!("nodes[{index}]"))?;
        let vector = |list: &Option<Vec<[f32; 3]>>, at: usize, default: DVec3| {
            list.as_ref().map_or(default, |list| DVec3::from(list[at].map(f64::from)))
        };
        let copy = |at: usize| {
            let rotation = rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |list| list[at].map(f64::from));
            let (scale, translation) = (vector(&scales, at, DVec3::ONE), vector(&translations, at, DVec3::ZERO));
            DMat4::from_scale_rotation_translation(scale, quaternion(rotation), translation)
        };
        Ok(Some((0..count).map(copy).collect()))
    }
}

/// From a node's own coordinates to those of its parent.
fn local(node: &Node) -> DMat4 {
    if let Some(columns) = &node.matrix {
        return DMat4::from_cols_array(columns);
    }
    let rotation = node.rotation.map_or(DQuat::IDENTITY, quaternion);
    let (scale, translation) = (node.scale.map_or(DVec3::ONE, DVec3::from), node.translation.map(DVec3::from));
    DMat4::from_scale_rotation_translation(scale, rotation, translation.unwrap_or(DVec3::ZERO))
}

/// The unit quaternion nearest to one that is written with few digits.
fn quaternion(xyzw: [f64; 4]) -> DQuat {
    DQuat::from_vec4(DVec4::from(xyzw).try_normalize().unwrap_or(DVec4::W))
}
