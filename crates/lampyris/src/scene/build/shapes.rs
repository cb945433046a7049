//! Shapes: geometry moved to the world, with material and light.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Mat3, Mat4, Vec3};

use super::textures::Quantity;
use super::{check, materials, media};
use crate::error::{Error, Result};
use crate::geometry::{Cylinder, Disk, GroupId, Mesh, MeshData, Plane, Quad, Shape, Sphere, Surfaces, SurfacesBuilder};
use crate::light::{Area, LightId};
use crate::scene::description::{EmissionDescription, GeometryDescription, ShapeDescription};
use crate::scene::{Assets, ShapeRecord};
use crate::spectrum::Spectrum;
use crate::texture::Texture;

/// Collects shapes.
pub(super) struct Builder<'d> {
    media: &'d media::Builder<'d>,
    surfaces: SurfacesBuilder,
    groups: BTreeMap<&'d String, GroupId>,
    records: Vec<ShapeRecord>,
    lights: Vec<Area>,
}

impl<'d> Builder<'d> {
    pub(super) fn new(media: &'d media::Builder<'d>) -> Builder<'d> {
        let (surfaces, groups) = (SurfacesBuilder::default(), BTreeMap::new());
        Builder { media, surfaces, groups, records: Vec::new(), lights: Vec::new() }
    }

    /// Adds a group, before the shapes that name it.
    pub(super) fn add_group(
        &mut self,
        name: &'d String,
        shapes: &'d [ShapeDescription],
        materials: &mut materials::Builder<'d>,
        assets: &dyn Assets,
    ) -> Result<()> {
        let mut geometries = Vec::with_capacity(shapes.len());
        for (index, shape) in shapes.iter().enumerate() {
            let geometry =
                self.grouped(shape, materials, assets).map_err(|error| error.under(&format!("[{index}]")))?;
            geometries.push((geometry, shape.flip_normal));
        }
        self.groups.insert(name, self.surfaces.add_group(geometries));
        Ok(())
    }

    /// The geometry of a shape in a group, whose record is added.
    fn grouped(
        &mut self,
        shape: &'d ShapeDescription,
        materials: &mut materials::Builder<'d>,
        assets: &dyn Assets,
    ) -> Result<Shape> {
        if shape.emission.is_some() {
            return Err(
                Error::at_key("emission", "a shape in a group cannot emit light").with_hint("take it out of the group")
            );
        }
        check::transform("transform", &shape.transform)?;
        let geometry = within_reach(geometry(&shape.geometry, &shape.transform.0, assets)?)?;
        let interior = self.media.interior(shape.interior.as_ref(), shape.priority)?;
        let material = materials.of_shape(shape.material.as_ref(), false, interior.is_some())?;
        let asks = materials.asks(material);
        self.records.push(ShapeRecord { material, light: None, interior, asks, name: shape.name.clone() });
        Ok(geometry)
    }

    fn add_instance(&mut self, shape: &ShapeDescription, group: &String) -> Result<()> {
        let own = [
            ("material", shape.material.is_some()),
            ("emission", shape.emission.is_some()),
            ("flip_normal", shape.flip_normal),
            ("interior", shape.interior.is_some()),
        ];
        if let Some((key, _)) = own.into_iter().find(|(_, given)| *given) {
            return Err(Error::at_key(key, "an instance shows its group's shapes as they are")
                .with_hint("give this to the shapes of the group"));
        }
        let Some(&group) = self.groups.get(group) else {
            return Err(materials::unknown("group", group, self.groups.keys().copied(), "group"));
        };
        self.surfaces.add_instance(group, &shape.transform.0);
        Ok(())
    }

    pub(super) fn add(
        &mut self,
        shape: &'d ShapeDescription,
        materials: &mut materials::Builder<'d>,
        assets: &dyn Assets,
    ) -> Result<()> {
        check::transform("transform", &shape.transform)?;
        if let GeometryDescription::Instance { group } = &shape.geometry {
            return self.add_instance(shape, group);
        }
        let mut geometry = within_reach(geometry(&shape.geometry, &shape.transform.0, assets)?)?;
        let interior = self.media.interior(shape.interior.as_ref(), shape.priority)?;
        let material = materials.of_shape(shape.material.as_ref(), shape.emission.is_some(), interior.is_some())?;
        let (mut light, mut asks) = (None, materials.asks(material));
        if let Some(emission) = &shape.emission {
            let number = self.records.len() as u32;
            let area = area_light(number, emission, &geometry, materials).map_err(|error| error.under("emission"))?;
            asks = asks | area.radiance.asks();
            light = Some(self.lights.len() as LightId);
            if matches!(area.radiance, Texture::Constant(_)) {
                geometry = geometry.by_solid_angle();
            }
            self.lights.push(area);
        }
        self.surfaces.add(geometry, shape.flip_normal);
        self.records.push(ShapeRecord { material, light, interior, asks, name: shape.name.clone() });
        Ok(())
    }

    /// The surfaces, what belongs to each shape, and the shapes that are lights, in the order of their numbers.
    pub(super) fn finish(self) -> (Surfaces, Vec<ShapeRecord>, Vec<Area>) {
        (self.surfaces.build(), self.records, self.lights)
    }
}

fn geometry(geometry: &GeometryDescription, to_world: &Mat4, assets: &dyn Assets) -> Result<Shape> {
    let point = |p: Vec3| to_world.transform_point3(p);
    let vector = |v: Vec3| to_world.transform_vector3(v);
    match geometry {
        GeometryDescription::Plane { normal, distance } => {
            let normal = check::direction("normal", *normal)?;
            let on_plane = point(normal * -check::finite("distance", *distance)?);
            let normal = transformed_normal(to_world, normal);
            Ok(Shape::Plane(Plane::new(normal, -normal.dot(on_plane))))
        }
        GeometryDescription::Sphere { center, radius } => {
            let center = check::point("center", *center)?;
            let (scale, rotation) = similarity(to_world, "sphere")?;
            let radius = check::above_zero("radius", *radius)? * scale;
            Ok(Shape::Sphere(Sphere::new(point(center), radius, rotation)))
        }
        GeometryDescription::Quad { corner, u, v } => {
            let (corner, u, v) = (check::point("corner", *corner)?, check::point("u", *u)?, check::point("v", *v)?);
            // An extent of zero has no inside; compared with the lengths, so that no unit comes into it.
            let has_inside = u.cross(v).length() > 1e-7 * u.length() * v.length();
            if !has_inside {
                return Err(Error::at_key("u", "the edges u and v of the quad are parallel or zero"));
            }
            Ok(Shape::Quad(Quad::new(point(corner), vector(u), vector(v))))
        }
        GeometryDescription::Disk { center, normal, radius } => {
            let center = check::point("center", *center)?;
            let normal = check::direction("normal", *normal)?;
            let radius = check::above_zero("radius", *radius)?;
            let frame = crate::math::Frame::around(normal);
            let axis = |local: Vec3| vector(frame.to_world(local) * radius);
            Ok(Shape::Disk(Disk::new(point(center), axis(Vec3::X), axis(Vec3::Y))))
        }
        GeometryDescription::Cylinder { from, to, radius } => {
            let (from, to) = (check::point("from", *from)?, check::point("to", *to)?);
            check::direction("to", (to - from).to_array())
                .map_err(|_| Error::at_key("to", "the two ends of the cylinder are the same point"))?;
            let (scale, _) = similarity(to_world, "cylinder")?;
            Ok(Shape::Cylinder(Cylinder::new(point(from), point(to), check::above_zero("radius", *radius)? * scale)))
        }
        GeometryDescription::Cube {} => mesh(&Arc::new(cube()), to_world, "the cube"),
        GeometryDescription::Mesh { file, index, face_normals, smooth, flip_v } => {
            let data = assets.mesh(file, *index).map_err(|error| error.under("file"))?;
            let data = adapted(data, *face_normals, *smooth, *flip_v);
            mesh(&data, to_world, file).map_err(|error| error.under("file"))
        }
        GeometryDescription::Instance { .. } => Err(Error::new("a group cannot hold instances")),
        GeometryDescription::Triangles(data) => mesh(data, to_world, "the mesh"),
    }
}

/// The shape, unless numbers cannot hold where its transform has put it.
fn within_reach(shape: Shape) -> Result<Shape> {
    let finite = shape.bounds().is_none_or(|bounds| bounds.min.is_finite() && bounds.max.is_finite());
    if finite && !shape.area().is_nan() {
        return Ok(shape);
    }
    Err(Error::new("the shape is too large or too far away: numbers cannot hold its coordinates")
        .with_hint("give it smaller numbers, or a smaller scale"))
}

fn mesh(data: &Arc<MeshData>, to_world: &Mat4, name: &str) -> Result<Shape> {
    if let Some(fault) = data.fault() {
        return Err(Error::new(format!("{name}: {fault}")));
    }
    if data.triangles.is_empty() {
        return Err(Error::new(format!("{name} has no triangles")));
    }
    Ok(Shape::Mesh(Mesh::new(data, to_world)))
}

fn adapted(data: Arc<MeshData>, face_normals: bool, smooth: bool, flip_v: bool) -> Arc<MeshData> {
    let (has_normals, flip_v) = (!data.normals.is_empty(), flip_v && !data.uvs.is_empty());
    let smooth = smooth && !face_normals && !has_normals;
    if !(face_normals && has_normals || smooth || flip_v) {
        return data;
    }
    let mut data = MeshData::clone(&data);
    if face_normals {
        data.normals.clear();
    }
    if smooth {
        data.compute_normals();
    }
    if flip_v {
        data.uvs.iter_mut().for_each(|uv| uv[1] = 1.0 - uv[1]);
    }
    Arc::new(data)
}

/// Normals go by the inverse transpose, so that they stay on their side under mirroring.
fn transformed_normal(to_world: &Mat4, normal: Vec3) -> Vec3 {
    to_world.inverse().transpose().transform_vector3(normal).normalize()
}

/// The scale and rotation of a transform that keeps shapes similar.
fn similarity(to_world: &Mat4, shape: &str) -> Result<(f32, Mat3)> {
    let axes = Mat3::from_mat4(*to_world);
    let scale = axes.determinant().abs().cbrt();
    let rotation = axes * (1.0 / scale);
    if (rotation.transpose() * rotation).abs_diff_eq(Mat3::IDENTITY, 1e-3) {
        return Ok((scale, rotation));
    }
    Err(Error::at_key(
        "transform",
        format!("a {shape} can only be moved, rotated and scaled by the same factor in all directions"),
    )
    .with_hint("use a mesh for other shapes"))
}

/// The shape of this number as a light.
fn area_light<'d>(
    shape: u32,
    emission: &'d EmissionDescription,
    geometry: &Shape,
    materials: &mut materials::Builder<'d>,
) -> Result<Area> {
    if matches!(geometry, Shape::Plane(_)) {
        return Err(Error::new("an infinite plane cannot emit: its power would be infinite").with_hint("use a quad"));
    }
    let scale = check::at_least_zero("scale", emission.scale)?;
    let radiance = match (&emission.radiance, emission.power) {
        (Some(paint), None) => match materials.textures().paint("radiance", paint, Quantity::Light)? {
            Texture::Constant(radiance) => Texture::Constant(radiance * scale),
            texture if scale == 1.0 => texture,
            texture => Texture::Product(Box::new([Texture::Constant(Spectrum::grey(scale)), texture])),
        },
        (None, Some(power)) => {
            let sides = if emission.two_sided { 2.0 } else { 1.0 };
            Texture::Constant(check::light("power", power)? / (sides * std::f32::consts::PI * geometry.area()))
        }
        _ => return Err(Error::new("an emission needs either a radiance or a power")),
    };
    if radiance.asks().vertex_color {
        return Err(Error::at_key("radiance", "the colours of vertices cannot emit")
            .with_hint("use a colour, a bitmap or a checkerboard"));
    }
    let area = Area::new(shape, geometry, radiance, emission.two_sided);
    if area.power().is_zero() {
        return Err(Error::new("the emission has no power: the light is black")
            .with_hint("give it a radiance above 0, or leave the emission out"));
    }
    Ok(area)
}

/// The cube from (-1, -1, -1) to (1, 1, 1): six faces of their own corners, texture coordinates 0 to 1 on each.
fn cube() -> MeshData {
    let mut data = MeshData::default();
    for axis in 0..3 {
        for sign in [-1.0_f32, 1.0] {
            let first = data.positions.len() as u32;
            for [a, b] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
                let mut position = [0.0; 3];
                position[axis] = sign;
                // Turning the order of the other two axes with the sign keeps the faces counter-clockwise from outside.
                position[(axis + 1) % 3] = a * sign;
                position[(axis + 2) % 3] = b;
                data.positions.push(position);
                data.uvs.push([0.5 + 0.5 * a, 0.5 + 0.5 * b]);
            }
            data.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Bsdf;

    #[test]
    fn all_faces_of_the_cube_point_out() {
        let data = cube();
        for triangle in &data.triangles {
            let [a, b, c] = triangle.map(|corner| Vec3::from_array(data.positions[corner as usize]));
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
        }
    }

    /// What is wrong with a scene of a group and shapes, or the scene.
    fn scene(shapes: &str) -> Result<crate::scene::Scene> {
        let text = format!(
            r#"
            [camera]
            origin = [0, 0, 5]
            target = [0, 0, 0]
            [[lights]]
            type = "point"
            position = [0, 0, 5]
            intensity = 1.0
            [materials]
            red = {{ type = "diffuse", reflectance = [1, 0, 0] }}
            green = {{ type = "diffuse", reflectance = [0, 1, 0] }}
            {shapes}
            "#
        );
        let imported = crate::import::toml::read_str(std::path::Path::new("scene.toml"), &text)?;
        Ok(crate::scene::build(&imported.description, &crate::scene::NoAssets)?.scene)
    }

    const PAIR: &str = r#"
        [[groups.pair]]
        type = "sphere"
        material = "red"
        [[groups.pair]]
        type = "cube"
        transform = [{ translate = [3, 0, 0] }]
        material = "green"
    "#;

    #[test]
    fn instances_show_the_shapes_of_their_group_with_their_materials() {
        let two = r#"
            [[shapes]]
            type = "instance"
            group = "pair"
            [[shapes]]
            type = "instance"
            group = "pair"
            transform = [{ scale = [-0.5, 1, 1] }, { translate = [0, 10, 0] }]
        "#;
        let scene = scene(&format!("{PAIR}{two}")).expect("a good scene");
        let seen = |x: f32, y: f32| {
            let ray = crate::geometry::Ray { origin: Vec3::new(x, y, 5.0), direction: Vec3::NEG_Z };
            let mut bsdf = Bsdf::default();
            let point = scene.closest(&ray, &mut bsdf)?;
            Some((point.shape, point.distance, point.surface.normal, point.eval(Vec3::Z).to_rgb().map(|x| x > 0.0)))
        };
        let (red, green) = ([true, false, false], [false, true, false]);
        assert_eq!(seen(0.0, 0.0), Some((0, 4.0, Vec3::Z, red)));
        assert_eq!(seen(3.5, 0.5), Some((1, 4.0, Vec3::Z, green)));
        assert_eq!(seen(0.0, 10.0), Some((0, 4.0, Vec3::Z, red)));
        assert_eq!(seen(-1.75, 10.5), Some((1, 4.0, Vec3::Z, green)));
        assert_eq!(seen(1.75, 10.5), None);
    }

    #[test]
    fn what_a_group_cannot_hold_is_told_with_its_place() {
        let key = |shapes: &str| scene(shapes).expect_err("a fault");
        let unknown = key(&format!("{PAIR}\n[[shapes]]\ntype = \"instance\"\ngroup = \"pear\""));
        assert!(unknown.to_string().contains("pear") && unknown.hint.is_some_and(|hint| hint.contains("pair")));
        let own = key(&format!("{PAIR}\n[[shapes]]\ntype = \"instance\"\ngroup = \"pair\"\nmaterial = \"red\""));
        assert_eq!(own.key.as_deref(), Some("shapes[0].material"));
        let lamp = key("[[groups.lamp]]\ntype = \"sphere\"\nemission = { radiance = 1.0 }");
        assert_eq!(lamp.key.as_deref(), Some("groups.lamp[0].emission"));
        let nested = key("[[groups.a]]\ntype = \"instance\"\ngroup = \"a\"");
        assert_eq!(nested.key.as_deref(), Some("groups.a[0]"));
    }
}
