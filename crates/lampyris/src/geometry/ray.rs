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

/// What a ray stands for: a cone around it, of which one picture's pixel, or one path among many, sees the whole
/// [Akenine-Möller et al. 2021].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Its width where the ray starts, in scene units.
    pub width: f32,
    /// By how much it becomes wider for each scene unit: an angle in radians, where it is small.
    pub spread: f32,
}

impl Cone {
    /// Of a path that went anywhere: one of many in all directions. About 7 degrees wide, which is little beside the
    /// hemisphere that it was chosen from, and much beside a pixel.
    pub const WIDE: Cone = Cone { width: 0.0, spread: 0.125 };
    /// Of a ray that stands for itself.
    pub const THIN: Cone = Cone { width: 0.0, spread: 0.0 };

    /// The same cone from `distance` further on.
    #[inline]
    #[must_use]
    pub fn after(self, distance: f32) -> Cone {
        Cone { width: self.width + self.spread * distance, ..self }
    }

    /// The same cone from `distance` before; see [`Cone::after`].
    #[inline]
    #[must_use]
    pub fn before(self, distance: f32) -> Cone {
        self.after(-distance)
    }

    /// The cone after a choice among many directions: at least as wide as [`Cone::WIDE`].
    #[inline]
    #[must_use]
    pub fn scattered(self) -> Cone {
        Cone { spread: self.spread.max(Cone::WIDE.spread), ..self }
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
