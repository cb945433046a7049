//! The flat round (or, transformed, elliptic) disk.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::{Bounds, RELATIVE_ERROR, Ray, Surface};
use crate::math::warp;

/// The points center + a·u + b·v with a² + b² ≤ 1; its normal is u × v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    center: Vec3,
    u: Vec3,
    v: Vec3,
    normal: Vec3,
    dual_u: Vec3,
    dual_v: Vec3,
    error: f32,
}

impl Disk {
    /// From the centre and two half axes that are not parallel.
    pub fn new(center: Vec3, u: Vec3, v: Vec3) -> Disk {
        let (dual_u, dual_v) = dual(u, v);
        let extent = center.abs() + u.abs() + v.abs();
        let normal = u.cross(v).normalize();
        Disk { center, u, v, normal, dual_u, dual_v, error: RELATIVE_ERROR * extent.max_element() }
    }

    /// Distance to the disk along the ray, if it is met before `max`.
    #[inline]
    pub fn intersect(&self, ray: &Ray, max: f32) -> Option<f32> {
        let to_center = self.center - ray.origin;
        let distance = self.normal.dot(to_center) / self.normal.dot(ray.direction);
        if !(distance > 0.0 && distance < max) {
            return None;
        }
        let point = ray.direction * distance - to_center;
        (self.dual_u.dot(point).powi(2) + self.dual_v.dot(point).powi(2) <= 1.0).then_some(distance)
    }

    /// The surface at `distance` along the ray; texture coordinates are the radius and the angle, 0 to 1.
    pub fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        let point = ray.at(distance) - self.center;
        self.at(Vec2::new(self.dual_u.dot(point), self.dual_v.dot(point)))
    }

    fn at(&self, p: Vec2) -> Surface {
        let around = p.y.atan2(p.x) / TAU;
        let uv = Vec2::new(p.length(), if around < 0.0 { around + 1.0 } else { around });
        Surface::flat(self.center + self.u * p.x + self.v * p.y, self.normal, uv, self.error)
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        PI * self.u.cross(self.v).length()
    }

    /// A point uniform by area.
    pub fn sample(&self, u: Vec2) -> Surface {
        self.at(warp::disk(u))
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        let half = (self.u * self.u + self.v * self.v).map(f32::sqrt);
        Bounds { min: self.center - half, max: self.center + half }
    }
}

/// Vectors in the plane of `u` and `v` whose dot products with a·u + b·v are a and b.
pub(super) fn dual(u: Vec3, v: Vec3) -> (Vec3, Vec3) {
    let normal = u.cross(v);
    let scale = 1.0 / normal.length_squared();
    (v.cross(normal) * scale, normal.cross(u) * scale)
}
