//! Any one of the geometries.

use glam::{Vec2, Vec3};

use super::{Bounds, Cylinder, Disk, Mesh, Plane, Quad, Ray, Sphere, Surface};

/// The geometry of one shape of the scene.
#[derive(Clone, Debug)]
pub enum Shape {
    /// An infinite plane.
    Plane(Plane),
    /// A sphere.
    Sphere(Sphere),
    /// A parallelogram.
    Quad(Quad),
    /// A disk.
    Disk(Disk),
    /// The side of a cylinder.
    Cylinder(Cylinder),
    /// Triangles, which rays find through [`Surfaces`](super::Surfaces) alone.
    Mesh(Mesh),
}

impl Shape {
    /// Distance to it along the ray, if it is met before `max`; never for a mesh.
    #[inline]
    pub(super) fn intersect(&self, ray: &Ray, max: f32) -> Option<f32> {
        match self {
            Shape::Plane(plane) => plane.intersect(ray, max),
            Shape::Sphere(sphere) => sphere.intersect(ray, max),
            Shape::Quad(quad) => quad.intersect(ray, max),
            Shape::Disk(disk) => disk.intersect(ray, max),
            Shape::Cylinder(cylinder) => cylinder.intersect(ray, max),
            Shape::Mesh(_) => None,
        }
    }

    /// The surface where the ray meets it: at `distance`, or on a mesh at that triangle and barycentric coordinates.
    #[inline]
    pub(super) fn surface(&self, ray: &Ray, distance: f32, triangle: u32, barycentric: Vec2) -> Surface {
        match self {
            Shape::Plane(plane) => plane.surface(ray, distance),
            Shape::Sphere(sphere) => sphere.surface(ray, distance),
            Shape::Quad(quad) => quad.surface(ray, distance),
            Shape::Disk(disk) => disk.surface(ray, distance),
            Shape::Cylinder(cylinder) => cylinder.surface(ray, distance),
            Shape::Mesh(mesh) => mesh.surface(triangle as usize, barycentric),
        }
    }

    /// How the position changes with either texture coordinate, at `uv`, on a mesh on that triangle.
    pub(super) fn partials(&self, uv: Vec2, triangle: u32) -> (Vec3, Vec3) {
        match self {
            Shape::Plane(plane) => plane.partials(),
            Shape::Sphere(sphere) => sphere.partials(uv),
            Shape::Quad(quad) => quad.partials(),
            Shape::Disk(disk) => disk.partials(uv),
            Shape::Cylinder(cylinder) => cylinder.partials(uv),
            Shape::Mesh(mesh) => mesh.partials(triangle as usize),
        }
    }

    /// A point uniform by area; none on an infinite plane.
    pub fn sample(&self, u: Vec2) -> Option<Surface> {
        match self {
            Shape::Plane(_) => None,
            Shape::Sphere(sphere) => Some(sphere.sample(u)),
            Shape::Quad(quad) => Some(quad.sample(u)),
            Shape::Disk(disk) => Some(disk.sample(u)),
            Shape::Cylinder(cylinder) => Some(cylinder.sample(u)),
            Shape::Mesh(mesh) => Some(mesh.sample(u)),
        }
    }

    /// The same shape for a lamp that is as bright everywhere: shadow rays from nearby are then shot at a rectangle evenly
    /// by solid angle.
    #[must_use]
    pub fn by_solid_angle(self) -> Shape {
        if let Shape::Quad(quad) = self { Shape::Quad(quad.by_solid_angle()) } else { self }
    }

    /// A point uniform by the solid angle under which `from` sees the shape, with that density; none of shapes and from
    /// places where points uniform by area have to do.
    pub(super) fn sample_from(&self, from: Vec3, u: Vec2) -> Option<(Surface, f32)> {
        match self {
            Shape::Sphere(sphere) => sphere.sample_from(from, u),
            Shape::Quad(quad) => quad.sample_from(from, u),
            _ => None,
        }
    }

    /// Density of [`Shape::sample_from`] per solid angle, in every direction that meets the shape; none where that has none.
    pub(super) fn pdf_from(&self, from: Vec3) -> Option<f32> {
        match self {
            Shape::Sphere(sphere) => sphere.pdf_from(from),
            Shape::Quad(quad) => quad.pdf_from(from),
            _ => None,
        }
    }

    /// The colour of the vertices around a point of a mesh, linear RGB; none without such colours.
    pub(super) fn vertex_color(&self, triangle: u32, barycentric: Vec2) -> Option<[f32; 3]> {
        if let Shape::Mesh(mesh) = self { mesh.color(triangle as usize, barycentric) } else { None }
    }

    /// Surface area in scene units squared; infinite for a plane.
    pub fn area(&self) -> f32 {
        match self {
            Shape::Plane(_) => f32::INFINITY,
            Shape::Sphere(sphere) => sphere.area(),
            Shape::Quad(quad) => quad.area(),
            Shape::Disk(disk) => disk.area(),
            Shape::Cylinder(cylinder) => cylinder.area(),
            Shape::Mesh(mesh) => mesh.area(),
        }
    }

    /// The box around it; none around an infinite plane.
    pub fn bounds(&self) -> Option<Bounds> {
        match self {
            Shape::Plane(_) => None,
            Shape::Sphere(sphere) => Some(sphere.bounds()),
            Shape::Quad(quad) => Some(quad.bounds()),
            Shape::Disk(disk) => Some(disk.bounds()),
            Shape::Cylinder(cylinder) => Some(cylinder.bounds()),
            Shape::Mesh(mesh) => Some(mesh.bounds()),
        }
    }
}
