//! Shapes: geometry, placed, with material and emission.
//!
//! Spheres, rectangles, disks and cylinders go to the world here, because their normals follow rules of their own
//! when a matrix mirrors: Mitsuba turns those of a sphere inside out, and keeps those of a rectangle, a disk, a
//! cylinder and a cube. A mesh without normals follows its corners.

mod groups;

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::document::Kind;
use super::query::Query;
use super::spectrum::Role;
use super::{Importer, bsdf, single};
use crate::error::Result;
use crate::geometry::MeshData;
use crate::scene::description::{EmissionDescription, GeometryDescription, ShapeDescription, Transform};

/// Corners of the polygon that stands for an ellipse.
const CORNERS: u32 = 256;
/// Relative difference of lengths that a matrix written with few digits may have.
const TOLERANCE: f64 = 1e-3;

/// A geometry with what is left of its placement.
struct Placed {
    geometry: GeometryDescription,
    transform: DMat4,
    /// Whether its own normal is the opposite of Mitsuba's.
    flip: bool,
}

impl Placed {
    fn in_world(geometry: GeometryDescription, flip: bool) -> Placed {
        Placed { geometry, transform: DMat4::IDENTITY, flip }
    }
}

impl Importer<'_> {
    /// A shape of the scene.
    pub(super) fn shape(&mut self, object: usize) -> Result<()> {
        self.nested_shape(object, 0)
    }

    fn nested_shape(&mut self, object: usize, depth: usize) -> Result<()> {
        let query = self.query(object);
        let plugin = query.object.plugin.to_ascii_lowercase();
        self.visit(query, depth)?;
        if plugin == "merge" {
            // Merging only makes Mitsuba faster.
            let parts = query.parts(Kind::Shape);
            self.leftovers(query);
            return parts.iter().try_for_each(|part| self.nested_shape(part.object, depth + 1));
        }
        let matrix = self.parent * query.transform("to_world")?.unwrap_or(DMat4::IDENTITY);
        let placed = match plugin.as_str() {
            "sphere" => self.sphere(query, matrix)?,
            "rectangle" => rectangle(matrix),
            "disk" => self.disk(query, matrix),
            "cylinder" => self.cylinder(query, matrix)?,
            "cube" => cube(matrix),
            "obj" | "ply" | "serialized" => self.mesh(query, matrix, &plugin)?,
            "instance" => return self.instance(query, matrix, depth),
            // Seen through its instances only.
            "shapegroup" => return Ok(()),
            _ => {
                self.left_out(object, "this shape is left out");
                return Ok(());
            }
        };
        self.finish_shape(query, placed)
    }

    fn finish_shape(&mut self, query: Query, placed: Placed) -> Result<()> {
        let key = self.next_shape();
        self.note(&key, query.object.spot);
        let names = ["radius", "center", "filename", "to_world", "shape_index"];
        let ours = ["radius", "center", "file", "transform", "index"];
        for (ours, theirs) in ours.iter().zip(names) {
            if query.object.properties.iter().any(|property| property.name == theirs) {
                self.note(format!("{key}.{ours}"), query.spot(theirs));
            }
        }
        let flip_normals = query.boolean("flip_normals", false)?;
        let emission = match query.part(Kind::Emitter) {
            Some(part) => {
                self.note(format!("{key}.emission"), part.spot);
                self.emission(part.object)?
            }
            None => None,
        };
        let bsdfs = query.parts(Kind::Bsdf);
        if bsdfs.len() > 1 {
            self.warn(bsdfs[1].spot, "a shape of several materials is not supported: all of it has the first");
        }
        let material = match bsdfs.first() {
            Some(part) => {
                self.note(format!("{key}.material"), part.spot);
                Some(self.material(part.object)?)
            }
            None if emission.is_some() => None,
            None => Some(bsdf::default_material()),
        };
        let meter = self.meter(query, &key);
        let interior = self.interior(query, &key)?;
        query.ignore(&["optimize", "silhouette_sampling_weight"]);
        self.leftovers(query);
        self.push_shape(ShapeDescription {
            interior,
            priority: 0,
            geometry: placed.geometry,
            material,
            emission,
            transform: Transform(placed.transform.as_mat4()),
            flip_normal: flip_normals != placed.flip,
            name: query.object.id.clone().or(meter),
        });
        Ok(())
    }

    fn emission(&mut self, object: usize) -> Result<Option<EmissionDescription>> {
        let query = self.query(object);
        match query.object.plugin.as_str() {
            "area" => {}
            "angulararea" => self.left_out(object, "it shines in all directions, as an 'area' does"),
            _ => {
                self.left_out(object, "the shape does not emit");
                return Ok(None);
            }
        }
        query.ignore(&["sampling_weight"]);
        self.exterior(query)?;
        let (radiance, scale) = match query.named_part("radiance") {
            Some(part) => {
                let (inner, factor) = self.unscaled(part.object)?;
                (self.painted(inner, Role::Light, 1.0)?, factor)
            }
            None => (self.paint(query, "radiance", Role::Light, 1.0)?, 1.0),
        };
        self.leftovers(query);
        let scale = scale as f32;
        Ok(Some(EmissionDescription { radiance: Some(radiance), power: None, scale, two_sided: false }))
    }

    fn sphere(&mut self, query: Query, matrix: DMat4) -> Result<Placed> {
        let center = query.vector("center")?.unwrap_or(DVec3::ZERO);
        let radius = query.float("radius", 1.0)?;
        let [x, y, z] = axes(matrix);
        let lengths = [x.length(), y.length(), z.length()];
        if !alike(lengths[0], lengths[1]) || !alike(lengths[0], lengths[2]) || !square(&[x, y, z]) {
            let message = "a sphere cannot be stretched: the scale along its x axis is used for all";
            self.warn(query.spot("to_world"), message);
        }
        let center = single(matrix.transform_point3(center));
        let geometry = GeometryDescription::Sphere { center, radius: (radius * lengths[0]) as f32 };
        Ok(Placed::in_world(geometry, matrix.determinant() < 0.0))
    }

    /// The unit disk; one that is stretched becomes a polygon.
    fn disk(&mut self, query: Query, matrix: DMat4) -> Placed {
        let [x, y, _] = axes(matrix);
        let mirrored = matrix.determinant() < 0.0;
        if !alike(x.length(), y.length()) || !square(&[x, y]) {
            let message = format!("a stretched disk is drawn as a polygon of {CORNERS} corners");
            self.warn(query.spot("to_world"), message);
            let polygon = GeometryDescription::Triangles(Arc::new(polygon(matrix)));
            return Placed::in_world(polygon, mirrored);
        }
        let normal = x.cross(y).normalize_or_zero();
        let geometry = GeometryDescription::Disk {
            center: single(matrix.transform_point3(DVec3::ZERO)),
            normal: single(if mirrored { -normal } else { normal }),
            radius: x.length() as f32,
        };
        Placed::in_world(geometry, false)
    }

    fn cylinder(&mut self, query: Query, matrix: DMat4) -> Result<Placed> {
        let from = query.vector("p0")?.unwrap_or(DVec3::ZERO);
        let to = query.vector("p1")?.unwrap_or(DVec3::Z);
        let radius = query.float("radius", 1.0)?;
        let axis = (to - from).try_normalize().unwrap_or(DVec3::Z);
        let (side, other) = axis.any_orthonormal_pair();
        let [side, other, along] = [side, other, axis].map(|direction| matrix.transform_vector3(direction));
        if !alike(side.length(), other.length()) || !square(&[side, other, along]) {
            let message = "a cylinder cannot be flattened or sheared: it stays round and straight";
            self.warn(query.spot("to_world"), message);
        }
        let geometry = GeometryDescription::Cylinder {
            from: single(matrix.transform_point3(from)),
            to: single(matrix.transform_point3(to)),
            radius: (radius * side.length()) as f32,
        };
        Ok(Placed::in_world(geometry, false))
    }

    fn mesh(&mut self, query: Query, matrix: DMat4, plugin: &str) -> Result<Placed> {
        let Some(file) = query.text("filename")? else {
            return Err(query.fault("filename", format!("a shape of type '{plugin}' needs a 'filename'")));
        };
        if query.optional_float("max_smooth_angle")?.is_some() {
            let message = "'max_smooth_angle' is not supported: the normals of the file are used";
            self.warn(query.spot("max_smooth_angle"), message);
        }
        let geometry = GeometryDescription::Mesh {
            file: file.to_string(),
            index: if plugin == "serialized" { query.count("shape_index", 0)?.unwrap_or(0) } else { 0 },
            face_normals: query.boolean("face_normals", false)?,
            smooth: true,
            // In OBJ files v runs upwards, in Mitsuba's pictures downwards.
            flip_v: query.boolean("flip_tex_coords", plugin == "obj")?,
        };
        // Where normals are smooth anyway, and where colours are taken as they are.
        query.ignore(&["collapse", "srgb"]);
        Ok(Placed { geometry, transform: matrix, flip: false })
    }
}

/// From (-1, -1) to (1, 1), seen from +z, also through a mirror, which turns u × v round.
fn rectangle(matrix: DMat4) -> Placed {
    let geometry = GeometryDescription::Quad {
        corner: single(matrix.transform_point3(DVec3::new(-1.0, -1.0, 0.0))),
        u: single(matrix.transform_vector3(2.0 * DVec3::X)),
        v: single(matrix.transform_vector3(2.0 * DVec3::Y)),
    };
    Placed::in_world(geometry, matrix.determinant() < 0.0)
}

/// Its normals point outwards. A mirrored cube is the same as one mirrored twice, which nothing can turn inside out.
fn cube(matrix: DMat4) -> Placed {
    let mirrored = matrix.determinant() < 0.0;
    let mirror = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let transform = if mirrored { matrix * mirror } else { matrix };
    Placed { geometry: GeometryDescription::Cube {}, transform, flip: false }
}

fn axes(matrix: DMat4) -> [DVec3; 3] {
    [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| matrix.transform_vector3(axis))
}

fn alike(a: f64, b: f64) -> bool {
    (a - b).abs() <= TOLERANCE * a.abs().max(b.abs())
}

/// Whether the axes stand at right angles to each other.
fn square(axes: &[DVec3]) -> bool {
    let unit = |axis: &DVec3| axis.normalize_or_zero();
    axes.iter().enumerate().all(|(index, a)| axes[index + 1..].iter().all(|b| unit(a).dot(unit(b)).abs() <= TOLERANCE))
}

/// The unit disk under `matrix`, as a fan of triangles.
fn polygon(matrix: DMat4) -> MeshData {
    let corner = |index: u32| {
        let (sine, cosine) = (TAU * f64::from(index) / f64::from(CORNERS)).sin_cos();
        single(matrix.transform_point3(DVec3::new(cosine, sine, 0.0)))
    };
    let center = single(matrix.transform_point3(DVec3::ZERO));
    MeshData {
        positions: std::iter::once(center).chain((0..CORNERS).map(corner)).collect(),
        triangles: (0..CORNERS).map(|index| [0, 1 + index, 1 + (index + 1) % CORNERS]).collect(),
        ..MeshData::default()
    }
}
