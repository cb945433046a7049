//! What photons from infinitely far away must cover.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use crate::geometry::Ray;
use crate::math::{Frame, warp};

/// A sphere around all that is finite in a scene: photons from infinitely far away start on a disk before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct World {
    /// Its centre.
    pub center: Vec3,
    /// Its radius.
    pub radius: f32,
}

impl World {
    /// A ray along the normal of `direction` that starts on the disk which covers the sphere from there, uniform by
    /// area.
    pub(super) fn entry(&self, direction: &Frame, u: Vec2) -> Ray {
        let on_disk = direction.to_world(warp::disk(u).extend(-1.0));
        Ray { origin: self.center + on_disk * self.radius, direction: direction.normal }
    }

    /// Density of the place where such a ray starts, per area across it.
    pub(super) fn density(&self) -> f32 {
        1.0 / self.section()
    }

    /// Area of that disk.
    pub(super) fn section(&self) -> f32 {
        PI * self.radius * self.radius
    }
}
