//! A plane with two axes of its own: what flat shapes have in common.

use glam::{Vec2, Vec3};

use super::{RELATIVE_ERROR, Ray, Surface};

/// The points origin + a·u + b·v; the normal is u × v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Flat {
    pub(super) origin: Vec3,
    pub(super) u: Vec3,
    pub(super) v: Vec3,
    pub(super) normal: Vec3,
    /// Vectors in the plane whose dot product with a·u + b·v is a or b.
    pub(super) dual_u: Vec3,
    pub(super) dual_v: Vec3,
    error: f32,
}

impl Flat {
    /// From two axes that are not parallel.
    pub(super) fn new(origin: Vec3, u: Vec3, v: Vec3) -> Flat {
        let across = u.cross(v);
        let scale = 1.0 / across.length_squared();
        let extent = origin.abs() + u.abs() + v.abs();
        Flat {
            origin,
            u,
            v,
            normal: across.normalize(),
            dual_u: v.cross(across) * scale,
            dual_v: across.cross(u) * scale,
            error: RELATIVE_ERROR * extent.max_element(),
        }
    }

    /// Distance along the ray, if the plane is met before `max`, with a and b there.
    #[inline]
    pub(super) fn intersect(&self, ray: &Ray, max: f32) -> Option<(f32, Vec2)> {
        let to_origin = self.origin - ray.origin;
        let distance = self.normal.dot(to_origin) / self.normal.dot(ray.direction);
        let met = distance > 0.0 && distance < max;
        met.then(|| (distance, self.coordinates(ray.direction * distance - to_origin)))
    }

    /// The point of the plane where the ray is at `distance`, by a and b.
    pub(super) fn met_at(&self, ray: &Ray, distance: f32) -> Vec2 {
        self.coordinates(ray.at(distance) - self.origin)
    }

    fn coordinates(&self, from_origin: Vec3) -> Vec2 {
        Vec2::new(self.dual_u.dot(from_origin), self.dual_v.dot(from_origin))
    }

    /// The surface at a and b.
    pub(super) fn surface(&self, ab: Vec2, uv: Vec2) -> Surface {
        Surface::flat(self.origin + self.u * ab.x + self.v * ab.y, self.normal, uv, self.error)
    }

    /// Area of the parallelogram that the axes span.
    pub(super) fn area(&self) -> f32 {
        self.u.cross(self.v).length()
    }
}
