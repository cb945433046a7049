//! All shapes of a scene, and the structures that find the one a ray meets first.

use std::ops::Range;

use glam::{Mat4, Vec2, Vec3};

use super::instance::Placement;
use super::level::{Item, Items, Level, TreeStatistics, TriangleHit};
use super::{Bounds, Ray, Shape, Surface};

/// The shapes of a scene, ready for rays.
#[derive(Debug)]
pub struct Surfaces {
    shapes: Vec<PlacedShape>,
    world: Level,
    /// Each in its own coordinates.
    groups: Vec<Level>,
    /// The numbers of the shapes that are in no group, and of those in each group.
    alone: Vec<u32>,
    grouped: Vec<Range<u32>>,
    instances: Vec<Instance>,
}

#[derive(Debug)]
struct PlacedShape {
    shape: Shape,
    flip_normal: bool,
}

/// A group at one of its places.
#[derive(Debug)]
struct Instance {
    group: u32,
    placement: Placement,
}

/// The number of a group of shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroupId(u32);

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Along the ray, in scene units.
    pub distance: f32,
    /// Number of the shape, in the order they were added; in an instance that of the group's shape.
    pub shape: u32,
    pub(super) instance: Option<u32>,
    pub(super) triangle: u32,
    pub(super) barycentric: Vec2,
}

impl Hit {
    /// Whether the shape stands there by an instance.
    pub fn is_in_instance(&self) -> bool {
        self.instance.is_some()
    }
}

/// Collects shapes for [`Surfaces`].
#[derive(Debug, Default)]
pub struct SurfacesBuilder {
    shapes: Vec<PlacedShape>,
    /// Numbers of the shapes that are in no group.
    world: Vec<u32>,
    groups: Vec<Range<u32>>,
    instances: Vec<Instance>,
}

impl SurfacesBuilder {
    /// Adds a shape and returns its number.
    pub fn add(&mut self, shape: Shape, flip_normal: bool) -> u32 {
        let number = self.shapes.len() as u32;
        self.shapes.push(PlacedShape { shape, flip_normal });
        self.world.push(number);
        number
    }

    /// Adds shapes, each with whether its normal is flipped, that are seen only where [instances] put their group.
    /// They are numbered on from the last shape, in their order.
    ///
    /// [instances]: SurfacesBuilder::add_instance
    pub fn add_group(&mut self, shapes: impl IntoIterator<Item = (Shape, bool)>) -> GroupId {
        let first = self.shapes.len() as u32;
        self.shapes.extend(shapes.into_iter().map(|(shape, flip_normal)| PlacedShape { shape, flip_normal }));
        self.groups.push(first..self.shapes.len() as u32);
        GroupId((self.groups.len() - 1) as u32)
    }

    /// Puts a group into the world by an affine transform, which must not be singular.
    pub fn add_instance(&mut self, group: GroupId, to_world: &Mat4) {
        self.instances.push(Instance { group: group.0, placement: Placement::new(to_world) });
    }

    /// The shapes with their acceleration structures.
    pub fn build(self) -> Surfaces {
        let groups: Vec<Level> = self.groups.iter().map(|group| self.level(group.clone(), Vec::new())).collect();
        let instance = |(number, instance): (u32, &Instance)| {
            let infinite = self.groups[instance.group as usize].clone().any(|shape| self.bounds(shape).is_none());
            let bounds = instance.placement.bounds_to_world(groups[instance.group as usize].bounds());
            (Item::Instance(number), (!infinite).then_some(bounds))
        };
        let instances = (0..).zip(&self.instances).map(instance).collect();
        let world = self.level(self.world.iter().copied(), instances);
        let SurfacesBuilder { shapes, world: alone, groups: grouped, instances } = self;
        Surfaces { world, groups, alone, grouped, shapes, instances }
    }

    fn level(&self, shapes: impl Iterator<Item = u32>, mut items: Vec<(Item, Option<Bounds>)>) -> Level {
        let (mut quads, mut meshes) = (Vec::new(), Vec::new());
        for number in shapes {
            match &self.shapes[number as usize].shape {
                Shape::Mesh(mesh) => meshes.push((number, mesh)),
                Shape::Quad(quad) => quads.push((number, *quad)),
                _ => items.push((Item::Shape(number), self.bounds(number))),
            }
        }
        Level::build(&items, &quads, &meshes)
    }

    fn bounds(&self, shape: u32) -> Option<Bounds> {
        self.shapes[shape as usize].shape.bounds()
    }
}

impl Surfaces {
    /// The first shape that the ray meets before `max`.
    #[inline]
    pub fn closest(&self, ray: &Ray, max: f32) -> Option<Hit> {
        self.closest_in(&self.world, ray, max)
    }

    #[inline]
    fn closest_in(&self, level: &Level, ray: &Ray, max: f32) -> Option<Hit> {
        let mut items = Asked { surfaces: self, ray, closest: None };
        match level.closest(ray, max, &mut items) {
            Some(TriangleHit { distance, shape, triangle, barycentric }) => {
                Some(Hit { distance, shape, instance: None, triangle, barycentric })
            }
            None => items.closest,
        }
    }

    /// Whether anything stands between two points that were moved off their surfaces.
    #[inline]
    pub fn occluded(&self, from: Vec3, to: Vec3) -> bool {
        let between = to - from;
        let distance = between.length();
        if distance <= 0.0 {
            return false;
        }
        let ray = Ray { origin: from, direction: between / distance };
        self.blocked(&ray, distance * (1.0 - 1e-6))
    }

    /// Whether the ray meets anything before `max`.
    #[inline]
    pub fn blocked(&self, ray: &Ray, max: f32) -> bool {
        self.blocked_in(&self.world, ray, max)
    }

    #[inline]
    fn blocked_in(&self, level: &Level, ray: &Ray, max: f32) -> bool {
        level.any(ray, max, &mut Asked { surfaces: self, ray, closest: None })
    }

    /// The surface that a ray hit.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let placed = &self.shapes[hit.shape as usize];
        let surface =
            |ray: &Ray| placed.oriented(placed.shape.surface(ray, hit.distance, hit.triangle, hit.barycentric));
        match hit.instance {
            None => surface(ray),
            Some(number) => {
                let placement = &self.instances[number as usize].placement;
                placement.surface_to_world(&surface(&placement.ray_to_local(ray)))
            }
        }
    }

    /// How the position changes with either texture coordinate (∂p/∂u, ∂p/∂v) where a ray hit: the tangents of normal
    /// maps and of anisotropy, in the world. Zero where all values of a coordinate meet, as at the poles of a sphere.
    pub fn partials(&self, hit: &Hit, surface: &Surface) -> (Vec3, Vec3) {
        let (along_u, along_v) = self.shapes[hit.shape as usize].shape.partials(surface.uv, hit.triangle);
        let Some(instance) = hit.instance else { return (along_u, along_v) };
        let placement = &self.instances[instance as usize].placement;
        (placement.vector_to_world(along_u), placement.vector_to_world(along_v))
    }

    /// The same, traced with what every processor has.
    #[cfg(test)]
    pub(super) fn portable(mut self) -> Surfaces {
        self.groups.iter_mut().chain([&mut self.world]).for_each(Level::make_portable);
        self
    }

    /// How much there is in the acceleration structures.
    pub fn statistics(&self) -> TreeStatistics {
        let all = self.groups.iter().chain([&self.world]).map(Level::statistics);
        all.fold(TreeStatistics::default(), |sum, level| TreeStatistics {
            triangles: sum.triangles + level.triangles,
            packets: sum.packets + level.packets,
            bytes: sum.bytes + level.bytes,
            cost: if level.triangles > sum.triangles { level.cost } else { sum.cost },
        })
    }

    /// The colour that the vertices around a hit give it, linear RGB; none without such colours.
    pub fn vertex_color(&self, hit: &Hit) -> Option<[f32; 3]> {
        self.shapes[hit.shape as usize].shape.vertex_color(hit.triangle, hit.barycentric)
    }

    /// A point uniform by area on a shape; none on an infinite plane.
    pub fn sample(&self, shape: u32, u: Vec2) -> Option<Surface> {
        let placed = &self.shapes[shape as usize];
        Some(placed.oriented(placed.shape.sample(u)?))
    }

    /// Every place where a shape of finite size stands in the world, in the order they were added: its number, and that of
    /// the instance that puts it there.
    pub fn places(&self) -> impl Iterator<Item = (u32, Option<u32>)> {
        let alone = self.alone.iter().map(|&shape| (shape, None));
        let in_groups = (0..).zip(&self.instances).flat_map(|(number, instance)| {
            self.grouped[instance.group as usize].clone().map(move |shape| (shape, Some(number)))
        });
        alone.chain(in_groups).filter(|&(shape, _)| self.area(shape).is_finite())
    }

    /// A point on a shape at one of its [places](Surfaces::places); uniform by the area of the shape.
    pub fn sample_place(&self, (shape, instance): (u32, Option<u32>), u: Vec2) -> Option<Surface> {
        let surface = self.sample(shape, u)?;
        Some(instance.map_or(surface, |number| self.instances[number as usize].placement.surface_to_world(&surface)))
    }

    /// A point on a shape as seen from `from`, with its density per solid angle there: uniform in solid angle on a
    /// sphere from outside and on a [rectangle](Shape::by_solid_angle) from nearby, uniform by area on all else.
    pub fn sample_from(&self, shape: u32, from: Vec3, u: Vec2) -> Option<(Surface, f32)> {
        let placed = &self.shapes[shape as usize];
        if let Some((surface, pdf)) = placed.shape.sample_from(from, u) {
            return Some((placed.oriented(surface), pdf));
        }
        let surface = self.sample(shape, u)?;
        Some((surface, self.area_pdf_from(shape, from, &surface)?))
    }

    /// Density of [`Surfaces::sample_from`] at `surface`, per solid angle at `from`; none where it cannot be sampled.
    pub fn pdf_from(&self, shape: u32, from: Vec3, surface: &Surface) -> Option<f32> {
        self.shapes[shape as usize].shape.pdf_from(from).or_else(|| self.area_pdf_from(shape, from, surface))
    }

    fn area_pdf_from(&self, shape: u32, from: Vec3, surface: &Surface) -> Option<f32> {
        let to = surface.position - from;
        let cos = (to.dot(surface.normal) / to.length()).abs();
        let pdf = to.length_squared() / (cos * self.area(shape));
        (pdf.is_finite() && pdf > 0.0).then_some(pdf)
    }

    /// Area of a shape, in scene units squared.
    pub fn area(&self, shape: u32) -> f32 {
        self.shapes[shape as usize].shape.area()
    }

    /// The box around all that is finite.
    pub fn bounds(&self) -> Bounds {
        self.world.bounds()
    }

    /// The shapes' geometries, in the order they were added.
    pub fn shapes(&self) -> impl Iterator<Item = &Shape> {
        self.shapes.iter().map(|placed| &placed.shape)
    }
}

impl PlacedShape {
    #[inline]
    fn oriented(&self, surface: Surface) -> Surface {
        if self.flip_normal {
            Surface { normal: -surface.normal, shading_normal: -surface.shading_normal, ..surface }
        } else {
            surface
        }
    }
}

/// The items of a level as one ray asks for them.
struct Asked<'a> {
    surfaces: &'a Surfaces,
    ray: &'a Ray,
    closest: Option<Hit>,
}

impl Items for Asked<'_> {
    #[inline]
    fn closest(&mut self, item: Item, max: f32) -> Option<f32> {
        let hit = match item {
            Item::Shape(shape) => {
                let distance = self.surfaces.shapes[shape as usize].shape.intersect(self.ray, max)?;
                self.found(shape, distance);
                return Some(distance);
            }
            Item::Instance(number) => {
                let Instance { group, placement } = &self.surfaces.instances[number as usize];
                let level = &self.surfaces.groups[*group as usize];
                let hit = self.surfaces.closest_in(level, &placement.ray_to_local(self.ray), max)?;
                Hit { instance: Some(number), ..hit }
            }
        };
        self.closest = Some(hit);
        Some(hit.distance)
    }

    #[inline]
    fn found(&mut self, shape: u32, distance: f32) {
        self.closest = Some(Hit { distance, shape, instance: None, triangle: 0, barycentric: Vec2::ZERO });
    }

    #[inline]
    fn any(&self, item: Item, max: f32) -> bool {
        match item {
            Item::Shape(shape) => self.surfaces.shapes[shape as usize].shape.intersect(self.ray, max).is_some(),
            Item::Instance(number) => {
                let Instance { group, placement } = &self.surfaces.instances[number as usize];
                let level = &self.surfaces.groups[*group as usize];
                self.surfaces.blocked_in(level, &placement.ray_to_local(self.ray), max)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Mat3, Mat4, Vec3};

    use super::super::level::FEW;
    use super::super::{Mesh, MeshData, Sphere};
    use super::*;

    /// A wall of two triangles at z = 0.
    fn wall() -> Shape {
        let data = MeshData {
            positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshData::default()
        };
        Shape::Mesh(Mesh::new(&Arc::new(data), &Mat4::IDENTITY))
    }

    #[test]
    fn a_surface_is_met_however_near_it_is() {
        let mut builder = SurfacesBuilder::default();
        builder.add(wall(), false);
        // So many that they are in a tree.
        for index in 0..=FEW {
            let center = Vec3::new(4.0 * index as f32, 0.0, -1.0);
            builder.add(Shape::Sphere(Sphere::new(center, 0.5, Mat3::IDENTITY)), false);
        }
        let surfaces = builder.build();
        for exponent in 1..24 {
            let distance = 0.5_f32.powi(exponent);
            // In front of the wall, and in the second ball below its top.
            for (shape, ray) in [
                (0, Ray { origin: Vec3::new(0.3, 0.1, distance), direction: Vec3::NEG_Z }),
                (2, Ray { origin: Vec3::new(4.0, 0.0, -0.5 - distance), direction: Vec3::Z }),
            ] {
                let hit = surfaces.closest(&ray, f32::INFINITY).expect("a surface");
                assert_eq!((hit.shape, hit.distance), (shape, distance));
                assert!(surfaces.blocked(&ray, 2.0 * distance) && !surfaces.blocked(&ray, 0.5 * distance));
            }
        }
    }
}
