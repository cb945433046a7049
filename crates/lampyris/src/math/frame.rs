//! A right-handed orthonormal frame around a normal.

use glam::Vec3;

/// An orthonormal frame whose z axis is a surface normal. Local directions have their cosine to the normal in `z`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    x: Vec3,
    y: Vec3,
    /// The normal, unit length.
    pub normal: Vec3,
}

impl Frame {
    /// The frame around `normal`, of unit length; continuous but at `normal.z = 0` [Duff et al. 2017, listing 3].
    pub fn around(normal: Vec3) -> Frame {
        let sign = 1.0_f32.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Frame {
            x: Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
            y: Vec3::new(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// The frame around `normal`, of unit length, whose x axis lies as near as it can to `tangent`; any frame where that is
    /// zero or along the normal.
    pub fn along(normal: Vec3, tangent: Vec3) -> Frame {
        match (tangent - normal * normal.dot(tangent)).try_normalize() {
            Some(x) => Frame { x, y: normal.cross(x), normal },
            None => Frame::around(normal),
        }
    }

    /// The x axis, of unit length.
    pub fn tangent(&self) -> Vec3 {
        self.x
    }

    /// A world direction in local coordinates.
    #[inline]
    pub fn to_local(&self, world: Vec3) -> Vec3 {
        Vec3::new(world.dot(self.x), world.dot(self.y), world.dot(self.normal))
    }

    /// A local direction in world coordinates.
    #[inline]
    pub fn to_world(&self, local: Vec3) -> Vec3 {
        self.x * local.x + self.y * local.y + self.normal * local.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_frame_is_orthonormal_and_right_handed(x in -1.0f32..1.0, y in -1.0f32..1.0, z in -1.0f32..1.0) {
            prop_assume!(Vec3::new(x, y, z).length() > 1e-3);
            let frame = Frame::around(Vec3::new(x, y, z).normalize());
            prop_assert!((frame.x.cross(frame.y) - frame.normal).length() < 1e-5);
            prop_assert!((frame.x.length() - 1.0).abs() < 1e-5);
            let v = Vec3::new(0.3, -0.4, 0.8);
            prop_assert!((frame.to_local(frame.to_world(v)) - v).length() < 1e-5);
        }
    }
}
