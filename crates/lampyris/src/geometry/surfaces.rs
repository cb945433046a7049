//! All shapes of a scene, and the structure that finds the one a ray meets first.

use std::time::Duration;

use glam::{Vec2, Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::RayHit;
use obvhs::{Boundable, BvhBuildParams};

use super::{Bounds, Ray, Shape, Surface, Triangle};

/// Up to this many curved and flat shapes are tried one after the other, which is faster than a tree.
const FEW: usize = 16;

/// The shapes of a scene, ready for rays.
#[derive(Debug)]
pub struct Surfaces {
    shapes: Vec<PlacedShape>,
    /// Shapes without triangles that every ray tries: the infinite ones, and all if there are few.
    tried: Vec<u32>,
    /// The other shapes without triangles.
    grouped: Option<Tree<u32>>,
    triangles: Option<Tree<SceneTriangle>>,
    bounds: Bounds,
}

#[derive(Debug)]
struct PlacedShape {
    shape: Shape,
    flip_normal: bool,
}

/// A triangle of one of the scene's meshes.
#[derive(Clone, Copy, Debug)]
struct SceneTriangle {
    triangle: Triangle,
    shape: u32,
    index: u32,
}

/// A bounding volume hierarchy over `T`, which lie in the order of its leaves.
#[derive(Debug)]
struct Tree<T> {
    bvh: CwBvh,
    leaves: Vec<T>,
}

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Along the ray, in scene units.
    pub distance: f32,
    /// Number of the shape, in the order they were added.
    pub shape: u32,
    triangle: u32,
    barycentric: Vec2,
}

/// Collects shapes for [`Surfaces`].
#[derive(Debug, Default)]
pub struct SurfacesBuilder {
    shapes: Vec<PlacedShape>,
}

impl SurfacesBuilder {
    /// Adds a shape and returns its number.
    pub fn add(&mut self, shape: Shape, flip_normal: bool) -> u32 {
        self.shapes.push(PlacedShape { shape, flip_normal });
        (self.shapes.len() - 1) as u32
    }

    /// The shapes with their acceleration structure.
    pub fn build(self) -> Surfaces {
        let numbered = || self.shapes.iter().enumerate().map(|(number, placed)| (number as u32, &placed.shape));
        let (infinite, finite): (Vec<_>, Vec<_>) = numbered()
            .filter(|(_, shape)| !matches!(shape, Shape::Mesh(_)))
            .map(|(number, shape)| (number, shape.bounds()))
            .partition(|(_, bounds)| bounds.is_none());
        let mut tried: Vec<u32> = infinite.into_iter().map(|(number, _)| number).collect();
        let grouped = if finite.len() > FEW {
            Tree::build(finite.iter().filter_map(|&(number, bounds)| Some((number, bounds?))).collect())
        } else {
            tried.extend(finite.iter().map(|(number, _)| number));
            None
        };
        let triangles = numbered().flat_map(|(shape, geometry)| {
            let mesh = if let Shape::Mesh(mesh) = geometry { Some(mesh) } else { None };
            mesh.into_iter().flat_map(move |mesh| {
                (0..mesh.len()).map(move |index| {
                    let triangle = mesh.triangle(index);
                    (SceneTriangle { triangle, shape, index: index as u32 }, triangle.bounds())
                })
            })
        });
        let triangles = Tree::build(triangles.collect());
        let bounds = numbered().filter_map(|(_, shape)| shape.bounds()).fold(Bounds::EMPTY, Bounds::union);
        Surfaces { tried, grouped, triangles, bounds, shapes: self.shapes }
    }
}

impl Surfaces {
    /// The first shape that the ray meets before `max`.
    #[inline]
    pub fn closest(&self, ray: &Ray, max: f32) -> Option<Hit> {
        let mut closest = None;
        let mut max = max;
        for &shape in &self.tried {
            if let Some(distance) = self.shapes[shape as usize].shape.intersect(ray, max) {
                max = distance;
                closest = Some(Hit { distance, shape, triangle: 0, barycentric: Vec2::ZERO });
            }
        }
        if let Some(tree) = &self.grouped {
            tree.closest(ray, max, |&shape, max| {
                let distance = self.shapes[shape as usize].shape.intersect(ray, max)?;
                closest = Some(Hit { distance, shape, triangle: 0, barycentric: Vec2::ZERO });
                Some(distance)
            });
            max = closest.map_or(max, |hit: Hit| hit.distance);
        }
        if let Some(tree) = &self.triangles {
            tree.closest(ray, max, |&SceneTriangle { triangle, shape, index }, max| {
                let (distance, barycentric) = triangle.intersect(ray, max)?;
                closest = Some(Hit { distance, shape, triangle: index, barycentric });
                Some(distance)
            });
        }
        closest
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
        self.tried.iter().any(|&shape| self.shapes[shape as usize].shape.intersect(ray, max).is_some())
            || self.grouped.as_ref().is_some_and(|tree| {
                tree.any(ray, max, |&shape, max| self.shapes[shape as usize].shape.intersect(ray, max))
            })
            || self
                .triangles
                .as_ref()
                .is_some_and(|tree| tree.any(ray, max, |leaf, max| Some(leaf.triangle.intersect(ray, max)?.0)))
    }

    /// The surface that a ray hit.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let placed = &self.shapes[hit.shape as usize];
        placed.oriented(placed.shape.surface(ray, hit.distance, hit.triangle, hit.barycentric))
    }

    /// How the position changes with either texture coordinate (∂p/∂u, ∂p/∂v) where a ray hit: the tangents of normal
    /// maps and of anisotropy, in the world. Zero where all values of a coordinate meet, as at the poles of a sphere.
    pub fn partials(&self, hit: &Hit, surface: &Surface) -> (Vec3, Vec3) {
        self.shapes[hit.shape as usize].shape.partials(surface.uv, hit.triangle)
    }

    /// A point uniform by area on a shape; none on an infinite plane.
    pub fn sample(&self, shape: u32, u: Vec2) -> Option<Surface> {
        let placed = &self.shapes[shape as usize];
        Some(placed.oriented(placed.shape.sample(u)?))
    }

    /// A point on a shape as seen from `from`, with its density per solid angle there: uniform in solid angle on a
    /// sphere from outside, uniform by area on all else.
    pub fn sample_from(&self, shape: u32, from: Vec3, u: Vec2) -> Option<(Surface, f32)> {
        let placed = &self.shapes[shape as usize];
        if let Shape::Sphere(sphere) = &placed.shape
            && let Some((surface, pdf)) = sphere.sample_from(from, u)
        {
            return Some((placed.oriented(surface), pdf));
        }
        let surface = self.sample(shape, u)?;
        Some((surface, self.area_pdf_from(shape, from, &surface)?))
    }

    /// Density of [`Surfaces::sample_from`] at `surface`, per solid angle at `from`; none where it cannot be sampled.
    pub fn pdf_from(&self, shape: u32, from: Vec3, surface: &Surface) -> Option<f32> {
        if let Shape::Sphere(sphere) = &self.shapes[shape as usize].shape
            && let Some(pdf) = sphere.pdf_from(from)
        {
            return Some(pdf);
        }
        self.area_pdf_from(shape, from, surface)
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
        self.bounds
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

impl<T: Copy> Tree<T> {
    /// None over nothing.
    fn build(items: Vec<(T, Bounds)>) -> Option<Tree<T>> {
        if items.is_empty() {
            return None;
        }
        let boxes: Vec<Boxed> = items.iter().map(|(_, bounds)| Boxed(*bounds)).collect();
        let bvh = build_cwbvh(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
        let leaves = bvh.primitive_indices.iter().map(|&index| items[index as usize].0).collect();
        Some(Tree { bvh, leaves })
    }

    /// Calls `meet` with leaves near the ray and the distance up to which they matter, which shrinks as it answers.
    #[inline]
    fn closest(&self, ray: &Ray, max: f32, mut meet: impl FnMut(&T, f32) -> Option<f32>) {
        let mut nearest = RayHit::none();
        self.bvh.ray_traverse(obvhs_ray(ray, max), &mut nearest, |ray, leaf| {
            meet(&self.leaves[leaf], ray.tmax / STEPS).map_or(f32::INFINITY, |distance| distance * STEPS)
        });
    }

    /// Whether `meet` finds any leaf before `max`.
    #[inline]
    fn any(&self, ray: &Ray, max: f32, meet: impl Fn(&T, f32) -> Option<f32>) -> bool {
        !self.bvh.ray_traverse_miss(obvhs_ray(ray, max), |ray, leaf| {
            meet(&self.leaves[leaf], ray.tmax / STEPS).map_or(f32::INFINITY, |distance| distance * STEPS)
        })
    }
}

/// The tree passes over boxes that end within 0.0001 of a ray's origin, a length that would let light leak through the
/// corners of any scene and through all of a small one. It is told of distances in steps, of which there are so many to
/// a scene unit that this is nothing; a power of two, so that no bit of a distance is lost.
const STEPS: f32 = (1_u64 << 40) as f32;

fn obvhs_ray(ray: &Ray, max: f32) -> obvhs::ray::Ray {
    let with_unit_steps = obvhs::ray::Ray::new(Vec3A::from(ray.origin), Vec3A::from(ray.direction), 0.0, max * STEPS);
    let inv_direction = with_unit_steps.inv_direction * STEPS;
    obvhs::ray::Ray { direction: with_unit_steps.direction / STEPS, inv_direction, ..with_unit_steps }
}

struct Boxed(Bounds);

impl Boundable for Boxed {
    fn aabb(&self) -> Aabb {
        Aabb::new(Vec3A::from(self.0.min), Vec3A::from(self.0.max))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Mat3, Mat4, Vec3};

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
