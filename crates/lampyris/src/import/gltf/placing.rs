//! Meshes in the world: as shapes of their own, or as instances of a group where that would be too many.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use glam::{DMat4, Vec3};

use super::Importer;
use super::mesh::GeometryKey;
use super::nodes::Placed;
use super::source::missing;
use crate::error::Result;
use crate::geometry::Bounds;
use crate::import::framing;
use crate::scene::description::{GeometryDescription, MaterialRef, ShapeDescription, Transform};

/// Triangles that may stand in memory a second time for being used again, each part of a mesh counted as a hundred.
const COPIED: usize = 50_000;

/// The same for meshes that emit light, which instances cannot.
const COPIED_LIGHTS: usize = 4_000_000;

/// A mesh of the file in its own coordinates.
struct Model {
    shapes: Vec<ShapeDescription>,
    triangles: usize,
    bounds: Bounds,
}

impl Model {
    fn emits(&self) -> bool {
        self.shapes.iter().any(|shape| shape.emission.is_some())
    }

    /// How much memory another use takes, in triangles.
    fn weight(&self) -> usize {
        self.triangles + 100 * self.shapes.len()
    }

    fn is_group(&self) -> bool {
        matches!(&self.shapes[..], [ShapeDescription { geometry: GeometryDescription::Instance { .. }, .. }])
    }
}

impl Importer<'_> {
    /// All meshes of the nodes.
    pub(super) fn shapes(&mut self, placed: &[Placed]) -> Result<()> {
        let mut uses: Vec<(usize, usize, DMat4)> = Vec::new();
        for (at, Placed { node, .. }) in placed.iter().enumerate() {
            let Some(mesh) = self.node(*node)?.mesh else { continue };
            let to_world = self.mesh_to_world(placed, at)?;
            let copies = self.copies(*node)?.unwrap_or_else(|| vec![DMat4::IDENTITY]);
            for copy in copies {
                let to_world = to_world * copy;
                self.check_transform(*node, to_world)?;
                uses.push((mesh, *node, to_world));
            }
        }
        let mut counts: HashMap<usize, usize> = HashMap::new();
        for (mesh, ..) in &uses {
            *counts.entry(*mesh).or_default() += 1;
        }
        let mut models: HashMap<(usize, bool), Model> = HashMap::new();
        for (mesh, node, to_world) in uses {
            if let Entry::Vacant(place) = models.entry((mesh, false)) {
                place.insert(self.model(mesh, node, counts[&mesh])?);
            }
            // A mirror turns the order of corners round, by which triangles have a front. Instances see to that
            // themselves.
            let mirrored = to_world.determinant() < 0.0 && !models[&(mesh, false)].is_group();
            if let Entry::Vacant(place) = models.entry((mesh, mirrored)) {
                place.insert(self.parts(mesh, node, mirrored)?);
            }
            self.place(&models[&(mesh, mirrored)], node, to_world);
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
    fn model(&mut self, mesh: usize, node: usize, count: usize) -> Result<Model> {
        let mut model = self.parts(mesh, node, false)?;
        let copied = (count - 1).saturating_mul(model.weight());
        let most = if model.emits() { COPIED_LIGHTS } else { COPIED };
        if copied <= most || model.shapes.is_empty() {
            return Ok(model);
        }
        let path = format!("meshes[{mesh}]");
        if model.emits() {
            self.warn(&path, format!("{count} copies of a mesh that emits light are too many: they do not emit"));
            model.shapes.iter_mut().for_each(|shape| shape.emission = None);
        }
        let group = format!("mesh{mesh}");
        self.note(format!("groups.{group}"), &path);
        let instance = shape(GeometryDescription::Instance { group: group.clone() });
        let shapes = std::mem::replace(&mut model.shapes, vec![instance]);
        self.imported.description.groups.insert(group, shapes);
        Ok(model)
    }

    fn parts(&mut self, index: usize, node: usize, mirrored: bool) -> Result<Model> {
        let path = format!("meshes[{index}]");
        let meshes = &self.document.meshes;
        let mesh = meshes.get(index).ok_or_else(|| missing(&self.spots, &path, meshes.len()))?;
        let pose = &self.node(node)?.weights;
        let weights = if pose.is_empty() { &mesh.weights } else { pose };
        let mut model = Model { shapes: Vec::new(), triangles: 0, bounds: Bounds::EMPTY };
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let path = format!("{path}.primitives[{number}]");
            let has_colors = primitive.attributes.color_0.is_some();
            let surface = self.surface(primitive.material, has_colors)?;
            let key = GeometryKey::new(primitive, surface.uv_set, weights, mirrored);
            let Some(data) = self.geometry(key, &path)? else { continue };
            model.triangles += data.triangles.len();
            model.bounds = model.bounds.union(framing::bounds([&*data]));
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
        let Bounds { min, max } = model.bounds;
        let corners = (0..8).map(|number| {
            let side = |bit: u32| f32::from(u8::from(number >> bit & 1 == 1));
            (min + (max - min) * Vec3::new(side(0), side(1), side(2))).as_dvec3()
        });
        let moved = corners.map(|corner| to_world.transform_point3(corner).as_vec3());
        self.bounds = self.bounds.union(Bounds::around(moved));
    }
}

fn shape(geometry: GeometryDescription) -> ShapeDescription {
    ShapeDescription {
        interior: None,
        priority: 0,
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
