//! The side of a round cylinder.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::{Bounds, RELATIVE_ERROR, Ray, Surface};
use crate::math::Frame;

/// A cylinder without its ends, its normal pointing out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    from: Vec3,
    axis: Frame,
    length: f32,
    radius: f32,
    error: f32,
}

impl Cylinder {
    /// Around the line between two different points.
    pub fn new(from: Vec3, to: Vec3, radius: f32) -> Cylinder {
        let extent = from.abs().max(to.abs()).max_element() + radius;
        let axis = Frame::around((to - from).normalize());
        Cylinder { from, axis, length: (to - from).length(), radius, error: RELATIVE_ERROR * extent }
    }

    /// Distance to the cylinder along the ray, if it is met before `max`.
    ///
    /// In double precision, for the same reason as the sphere's.
    #[inline]
    pub fn intersect(&self, ray: &Ray, max: f32) -> Option<f32> {
        let axis = self.axis.normal.as_dvec3();
        let origin = (ray.origin - self.from).as_dvec3();
        let direction = ray.direction.as_dvec3();
        let across = direction - axis * direction.dot(axis);
        let start = origin - axis * origin.dot(axis);
        let a = across.length_squared();
        if a <= 0.0 {
            return None;
        }
        let middle = -start.dot(across) / a;
        let radius = f64::from(self.radius);
        let half2 = (radius * radius - (start + across * middle).length_squared()) / a;
        if half2 < 0.0 {
            return None;
        }
        [middle - half2.sqrt(), middle + half2.sqrt()].into_iter().find_map(|distance| {
            let along = (origin + direction * distance).dot(axis);
            let inside = distance > 0.0 && distance < f64::from(max) && along >= 0.0 && along <= f64::from(self.length);
            inside.then_some(distance as f32)
        })
    }

    /// The surface at `distance` along the ray; texture coordinates are the angle and the height, 0 to 1.
    pub fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        let local = self.axis.to_local(ray.at(distance) - self.from);
        self.at(Vec2::new(local.x, local.y).normalize(), local.z / self.length)
    }

    fn at(&self, out: Vec2, height: f32) -> Surface {
        let around = out.y.atan2(out.x) / TAU;
        let uv = Vec2::new(if around < 0.0 { around + 1.0 } else { around }, height);
        let normal = self.axis.to_world(out.extend(0.0));
        let position = self.from + self.axis.normal * (height * self.length) + normal * self.radius;
        Surface::flat(position, normal, uv, self.error)
    }

    /// How the position changes with either texture coordinate, at `uv`.
    pub fn partials(&self, uv: Vec2) -> (Vec3, Vec3) {
        let (sin, cos) = (TAU * uv.x).sin_cos();
        let around = self.axis.to_world(Vec3::new(-sin, cos, 0.0));
        (around * (TAU * self.radius), self.axis.normal * self.length)
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        TAU * self.radius * self.length
    }

    /// A point uniform by area.
    pub fn sample(&self, u: Vec2) -> Surface {
        self.at(Vec2::from_angle(TAU * u.x), u.y)
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        let axis = self.axis.normal;
        let half = self.radius * (Vec3::ONE - axis * axis).max(Vec3::ZERO).map(f32::sqrt);
        let to = self.from + axis * self.length;
        Bounds { min: self.from.min(to) - half, max: self.from.max(to) + half }
    }
}
