//! What photons from infinitely far away must cover.

use std::f32::consts::PI;

use glam::Vec3;

use super::Section;
use crate::geometry::Ray;
use crate::math::Frame;

/// A sphere around all that is finite in a scene: photons from infinitely far away start on a disk before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct World {
    /// Its centre.
    pub center: Vec3,
    /// Its radius.
    pub radius: f32,
}

impl World {
    /// All rays in the direction of the frame's normal that can meet the sphere, even by area.
    pub(super) fn rays(&self, direction: Frame) -> Section {
        Section::Disk { direction, center: self.center, radius: self.radius, world: *self }
    }

    /// The ray through a point that starts before the sphere.
    pub(super) fn entry(&self, direction: Vec3, through: Vec3) -> Ray {
        let beyond = (through - self.center).dot(direction) + self.radius;
        Ray { origin: through - direction * beyond, direction }
    }

    /// Whether a ray that is aimed at something also comes near enough to the sphere to be one of all rays.
    pub(super) fn covers(&self, ray: &Ray) -> bool {
        let to_center = self.center - ray.origin;
        let across = to_center - ray.direction * to_center.dot(ray.direction);
        across.length_squared() <= self.radius * self.radius
    }

    /// Density of the place where such a ray starts, per area across it.
    pub(super) fn density(&self) -> f32 {
        1.0 / self.cross_section()
    }

    /// Density of the rays in this direction that come to a point, per area across them: none come to what lies beside the
    /// sphere or before it, as parts of infinite planes do.
    pub fn density_at(&self, at: Vec3, direction: Vec3) -> f32 {
        let before = (at - self.center).dot(direction) < -self.radius;
        if before || !self.covers(&Ray { origin: at, direction }) { 0.0 } else { self.density() }
    }

    /// Area of that disk.
    pub(super) fn cross_section(&self) -> f32 {
        PI * self.radius * self.radius
    }
}
