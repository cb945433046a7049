//! The flat round (or, transformed, elliptic) disk.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::flat::Flat;
use super::{Bounds, Ray, Surface};
use crate::math::warp;

/// The points center + a·u + b·v with a² + b² ≤ 1; its normal is u × v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk(Flat);

impl Disk {
    /// From the centre and two half axes that are not parallel.
    pub fn new(center: Vec3, u: Vec3, v: Vec3) -> Disk {
        Disk(Flat::new(center, u, v))
    }

    /// Distance to the disk along the ray, if it is met before `max`.
    #[inline]
    pub fn intersect(&self, ray: &Ray, max: f32) -> Option<f32> {
        let (distance, ab) = self.0.intersect(ray, max)?;
        (ab.length_squared() <= 1.0).then_some(distance)
    }

    /// The surface at `distance` along the ray; texture coordinates are the radius and the angle, 0 to 1.
    pub fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        self.at(self.0.met_at(ray, distance))
    }

    fn at(&self, ab: Vec2) -> Surface {
        let around = ab.y.atan2(ab.x) / TAU;
        self.0.surface(ab, Vec2::new(ab.length(), if around < 0.0 { around + 1.0 } else { around }))
    }

    /// How the position changes with either texture coordinate, at `uv`; in the centre not with the second.
    pub fn partials(&self, uv: Vec2) -> (Vec3, Vec3) {
        let (sin, cos) = (TAU * uv.y).sin_cos();
        let Flat { u, v, .. } = self.0;
        (u * cos + v * sin, (v * cos - u * sin) * (TAU * uv.x))
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        PI * self.0.area()
    }

    /// A point uniform by area.
    pub fn sample(&self, u: Vec2) -> Surface {
        self.at(warp::disk(u))
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        let Flat { origin, u, v, .. } = self.0;
        let half = (u * u + v * v).map(f32::sqrt);
        Bounds { min: origin - half, max: origin + half }
    }
}
