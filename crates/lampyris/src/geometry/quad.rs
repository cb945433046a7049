//! The parallelogram.

use glam::{Vec2, Vec3};

use super::{Bounds, RELATIVE_ERROR, Ray, Surface};

/// The points corner + a·u + b·v with a and b from 0 to 1; its normal is u × v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    corner: Vec3,
    u: Vec3,
    v: Vec3,
    normal: Vec3,
    /// Vectors whose dot product with a point of the plane, from the corner, is a or b.
    dual_u: Vec3,
    dual_v: Vec3,
    error: f32,
}

impl Quad {
    /// From a corner and two edges that are not parallel.
    pub fn new(corner: Vec3, u: Vec3, v: Vec3) -> Quad {
        let (dual_u, dual_v) = super::disk::dual(u, v);
        let extent = corner.abs() + u.abs() + v.abs();
        let normal = u.cross(v).normalize();
        Quad { corner, u, v, normal, dual_u, dual_v, error: RELATIVE_ERROR * extent.max_element() }
    }

    /// Distance to the quad along the ray, if it is met before `max`.
    #[inline]
    pub fn intersect(&self, ray: &Ray, max: f32) -> Option<f32> {
        let to_corner = self.corner - ray.origin;
        let distance = self.normal.dot(to_corner) / self.normal.dot(ray.direction);
        if !(distance > 0.0 && distance < max) {
            return None;
        }
        let point = ray.direction * distance - to_corner;
        let (a, b) = (self.dual_u.dot(point), self.dual_v.dot(point));
        ((0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b)).then_some(distance)
    }

    /// The surface at `distance` along the ray.
    pub fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        let point = ray.at(distance) - self.corner;
        self.at(Vec2::new(self.dual_u.dot(point), self.dual_v.dot(point)))
    }

    fn at(&self, uv: Vec2) -> Surface {
        Surface::flat(self.corner + self.u * uv.x + self.v * uv.y, self.normal, uv, self.error)
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        self.u.cross(self.v).length()
    }

    /// A point uniform by area.
    pub fn sample(&self, u: Vec2) -> Surface {
        self.at(u)
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        Bounds::around([Vec3::ZERO, self.u, self.v, self.u + self.v].map(|edge| self.corner + edge))
    }
}
