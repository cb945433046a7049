//! Meshes in the world: as shapes of their own, or as instances of a group where that would be too many.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::Importer;
use super::mesh::GeometryKey;
use super::nodes::Placed;
use super::source::missing;
use crate::error::Result;
use crate::geometry::MeshData;
use crate::scene::description::{GeometryDescription, MaterialRef, ShapeDescription, Transform};

/// Triangles that may stand in memory a second time for being used again, each part of a mesh counted as a hundred.
const COPIED: usize = 50_000;

/// The same for meshes that emit light, which instances cannot.
const COPIED_LIGHTS: usize = 4_000_000;

/// A box, or nothing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Extent(Option<(DVec3, DVec3)>);

impl Extent {
    fn add(&mut self, point: DVec3) {
        if point.is_finite() {
            let (min, max) = self.0.unwrap_or((point, point));
            self.0 = Some((min.min(point), max.max(point)));
        }
    }

    /// The lower and the upper corner.
    pub(super) fn ends(&self) -> Option<(DVec3, DVec3)> {
        self.0
    }

    /// All corners.
    pub(super) fn corners(&self) -> impl Iterator<Item = DVec3> + use<> {
        self.0.into_iter().flat_map(|(min, max)| {
            (0..8).map(move |number| {
                let side = |bit: u32| f64::from(number >> bit & 1);
                min + (max - min) * DVec3::new(side(0), side(1), side(2))
            })
        })
    }
}

/// A mesh of the file in its own coordinates, mirrored or not.
struct Model {
    shapes: Vec<ShapeDescription>,
    triangles: usize,
    extent: Extent,
}

impl Model {
    fn emits(&self) -> bool {
        self.shapes.iter().any(|shape| shape.emission.is_some())
    }

    /// How much memory another use takes, in triangles.
    fn weight(&self) -> usize {
        self.triangles + 100 * self.shapes.len()
    }
}

/// A mesh of the file, and whether it is mirrored.
type ModelKey = (usize, bool);

impl Importer<'_> {
    /// All meshes of the nodes.
    pub(super) fn shapes(&mut self, placed: &[Placed]) -> Result<()> {
        let mut uses: Vec<(ModelKey, usize, DMat4)> = Vec::new();
        for (at, Placed { node, .. }) in placed.iter().enumerate() {
            let Some(mesh) = self.node(*node)?.mesh else { continue };
            let to_world = self.mesh_to_world(placed, at)?;
            let copies = self.copies(*node)?.unwrap_or_else(|| vec![DMat4::IDENTITY]);
            for copy in copies {
                let to_world = to_world * copy;
                self.check_transform(*node, to_world)?;
                uses.push(((mesh, to_world.determinant() < 0.0), *node, to_world));
            }
        }
        let mut counts: HashMap<ModelKey, usize> = HashMap::new();
        for (key, ..) in &uses {
            *counts.entry(*key).or_default() += 1;
        }
        let mut models: HashMap<ModelKey, Model> = HashMap::new();
        for (key, node, to_world) in uses {
            if !models.contains_key(&key) {
                let model = self.model(key, node, counts[&key])?;
                models.insert(key, model);
            }
            self.place(&models[&key], node, to_world);
        }
        Ok(())
    }

    /// A scale of zero, by which files hide things, leaves nothing to see, but a matrix must be a matrix.
    fn check_transform(&self, node: usize, to_world: DMat4) -> Result<()> {
        let affine = to_world.is_finite() && (to_world.row(3) - glam::DVec4::W).abs().max_element() < 1e-6;
        match affine {
            true => Ok(()),
            false => Err(self.spots.fault(&format!("nodes[{node}]"), "its matrix is not that of an affine transform")),
        }
    }

    /// Reads a mesh that is used `count` times; its shapes are those of one use.
    fn model(&mut self, key: ModelKey, node: usize, count: usize) -> Result<Model> {
        let mut model = self.parts(key, node)?;
        let copied = (count - 1).saturating_mul(model.weight());
        let is_group = match model.emits() {
            true => copied > COPIED_LIGHTS,
            false => copied > COPIED,
        };
        if is_group && !model.shapes.is_empty() {
            if model.emits() {
                let message = format!("{count} copies of a mesh that emits light are too many: they do not emit");
                self.warn(&format!("meshes[{}]", key.0), message);
                model.shapes.iter_mut().for_each(|shape| shape.emission = None);
            }
            let group = format!("mesh{}{}", key.0, if key.1 { "-mirrored" } else { "" });
            self.note(format!("groups.{group}"), &format!("meshes[{}]", key.0));
            let instance = shape(GeometryDescription::Instance { group: group.clone() });
            let shapes = std::mem::replace(&mut model.shapes, vec![instance]);
            self.imported.description.groups.insert(group, shapes);
        }
        Ok(model)
    }

    fn parts(&mut self, (index, mirrored): ModelKey, node: usize) -> Result<Model> {
        let path = format!("meshes[{index}]");
        let meshes = &self.document.meshes;
        let mesh = meshes.get(index).ok_or_else(|| missing(&self.spots, &path, meshes.len()))?;
        let pose = &self.node(node)?.weights;
        let weights = if pose.is_empty() { &mesh.weights } else { pose };
        let mut model = Model { shapes: Vec::new(), triangles: 0, extent: Extent::default() };
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let path = format!("{path}.primitives[{number}]");
            let has_colors = primitive.attributes.color_0.is_some();
            let surface = self.surface(primitive.material, has_colors)?;
            let key = GeometryKey::new(primitive, surface.uv_set, weights, mirrored);
            let Some(data) = self.geometry(key, &path)? else { continue };
            model.triangles += data.triangles.len();
            add(&mut model.extent, &data);
            let name = mesh.name.clone().filter(|name| !name.is_empty());
            model.shapes.push(ShapeDescription {
                material: Some(MaterialRef::Named(surface.material)),
                emission: surface.emission,
                name,
                ..shape(GeometryDescription::Triangles(data))
            });
        }
        Ok(model)
    }

    fn place(&mut self, model: &Model, node: usize, to_world: DMat4) {
        if flattens(to_world) {
            self.warn(&format!("nodes[{node}]"), "nodes that are scaled to nothing are left out");
            return;
        }
        for shape in &model.shapes {
            let key = format!("shapes[{}]", self.imported.description.shapes.len());
            self.note(key, &format!("nodes[{node}]"));
            let name = self.document.nodes[node].name.clone().filter(|name| !name.is_empty());
            let name = name.or_else(|| shape.name.clone());
            let shape = ShapeDescription { transform: Transform(to_world.as_mat4()), name, ..shape.clone() };
            self.imported.description.shapes.push(shape);
        }
        for corner in model.extent.corners() {
            self.extent.add(to_world.transform_point3(corner));
        }
    }
}

fn add(extent: &mut Extent, data: &Arc<MeshData>) {
    for position in &data.positions {
        extent.add(DVec3::from(position.map(f64::from)));
    }
}

fn shape(geometry: GeometryDescription) -> ShapeDescription {
    ShapeDescription {
        geometry,
        material: None,
        emission: None,
        transform: Transform::default(),
        flip_normal: false,
        name: None,
    }
}

/// Whether a matrix leaves no room, judged by the lengths of its axes so that no unit comes into it.
fn flattens(matrix: DMat4) -> bool {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate());
    x.cross(y).dot(z).abs() <= 1e-9 * x.length() * y.length() * z.length()
}
