//! Rays, and what they meet.

use glam::{Vec2, Vec3};

/// A half-line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Where it goes, unit length.
    pub direction: Vec3,
}

impl Ray {
    /// The point at `distance`.
    #[inline]
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + self.direction * distance
    }
}

/// A point on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, exact to within `error`.
    pub position: Vec3,
    /// Normal of the geometry, unit length, pointing out.
    pub normal: Vec3,
    /// Normal that shading uses, unit length; differs from `normal` on smooth meshes.
    pub shading_normal: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// How far `position` may lie off the surface, in scene units.
    pub error: f32,
}

impl Surface {
    /// A surface point whose shading normal is that of the geometry.
    pub(super) fn flat(position: Vec3, normal: Vec3, uv: Vec2, error: f32) -> Surface {
        Surface { position, normal, shading_normal: normal, uv, error }
    }

    /// The point, moved off the surface by more than its error, to the side into which `direction` points: from there a
    /// ray cannot meet the same surface again by rounding.
    #[inline]
    pub fn offset(&self, direction: Vec3) -> Vec3 {
        let side = if direction.dot(self.normal) >= 0.0 { self.error } else { -self.error };
        self.position + self.normal * side
    }

    /// The ray that leaves in this direction (unit length).
    #[inline]
    pub fn spawn(&self, direction: Vec3) -> Ray {
        Ray { origin: self.offset(direction), direction }
    }
}
