//! The parallelogram.

use glam::{Vec2, Vec3};

use super::flat::Flat;
use super::{Bounds, Ray, Surface};

/// The points corner + a·u + b·v with a and b from 0 to 1; its normal is u × v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad(Flat);

impl Quad {
    /// From a corner and two edges that are not parallel.
    pub fn new(corner: Vec3, u: Vec3, v: Vec3) -> Quad {
        Quad(Flat::new(corner, u, v))
    }

    pub(super) fn flat(&self) -> &Flat {
        &self.0
    }

    /// Distance to the quad along the ray, if it is met before `max`.
    #[inline]
    pub fn intersect(&self, ray: &Ray, max: f32) -> Option<f32> {
        let (distance, ab) = self.0.intersect(ray, max)?;
        let inside = ab.x >= 0.0 && ab.x <= 1.0 && ab.y >= 0.0 && ab.y <= 1.0;
        inside.then_some(distance)
    }

    /// The surface at `distance` along the ray; texture coordinates are a and b.
    pub fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        let ab = self.0.met_at(ray, distance);
        self.0.surface(ab, ab)
    }

    /// How the position changes with either texture coordinate: the edges.
    pub fn partials(&self) -> (Vec3, Vec3) {
        (self.0.u, self.0.v)
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        self.0.area()
    }

    /// A point uniform by area.
    pub fn sample(&self, u: Vec2) -> Surface {
        self.0.surface(u, u)
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        let Flat { origin, u, v, .. } = self.0;
        Bounds::around([Vec3::ZERO, u, v, u + v].map(|edge| origin + edge))
    }
}
