//! The infinite plane, by normal and distance as the course writes it.

use glam::{Vec2, Vec3};

use super::{RELATIVE_ERROR, Ray, Surface};
use crate::math::Frame;

/// The points with normal · x + distance = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    frame: Frame,
    distance: f32,
}

impl Plane {
    /// From a normal of any length but 0, and the distance of the origin along the unit normal.
    pub fn new(normal: Vec3, distance: f32) -> Plane {
        Plane { frame: Frame::around(normal.normalize()), distance }
    }

    /// Distance to the plane along the ray, if it is met before `max`.
    #[inline]
    pub fn intersect(&self, ray: &Ray, max: f32) -> Option<f32> {
        let normal = self.frame.normal;
        let distance = -(normal.dot(ray.origin) + self.distance) / normal.dot(ray.direction);
        (distance > 0.0 && distance < max).then_some(distance)
    }

    /// The surface at `distance` along the ray; texture coordinates in scene units.
    pub fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        let normal = self.frame.normal;
        let point = ray.at(distance);
        let position = point - normal * (normal.dot(point) + self.distance);
        let local = self.frame.to_local(position);
        let error = RELATIVE_ERROR * position.abs().max_element().max(self.distance.abs());
        Surface::flat(position, normal, Vec2::new(local.x, local.y), error)
    }

    /// What a step in either texture coordinate adds to the position.
    pub fn partials(&self) -> (Vec3, Vec3) {
        (self.frame.to_world(Vec3::X), self.frame.to_world(Vec3::Y))
    }
}
