//! Where a group of shapes is put.

use glam::{Affine3A, Mat3A, Mat4, Vec3, Vec3A};

use super::{Bounds, RELATIVE_ERROR, Ray, Surface};

/// An affine transform and its inverse.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    to_world: Affine3A,
    to_local: Affine3A,
}

impl Placement {
    /// From a transform that is affine and not singular.
    pub(super) fn new(to_world: &Mat4) -> Placement {
        let to_world = Affine3A::from_mat4(*to_world);
        Placement { to_world, to_local: to_world.inverse() }
    }

    /// A ray in the coordinates of the group. Its direction keeps what length it gets, so that distances stay.
    #[inline]
    pub(super) fn ray_to_local(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.to_local.transform_point3(ray.origin),
            direction: self.to_local.transform_vector3(ray.direction),
        }
    }

    /// A surface of the group in the world. Its normals go by the inverse transpose, so that a mirror leaves them on
    /// the side where they are.
    pub(super) fn surface_to_world(&self, local: &Surface) -> Surface {
        let position = self.to_world.transform_point3a(local.position.into());
        let normals = self.to_local.matrix3.transpose();
        let normal = |n: Vec3| Vec3::from((normals * Vec3A::from(n)).normalize_or(n.into()));
        // What rounding does to the ray on its way to the group, to the point there, and to it on its way back.
        let (out, back) = (absolute(&self.to_world.matrix3), absolute(&self.to_local.matrix3));
        let there = back * position.abs() + self.to_local.translation.abs() + Vec3A::from(local.position).abs();
        let here = out * there * RELATIVE_ERROR + self.to_world.translation.abs() * RELATIVE_ERROR;
        let error = (out * Vec3A::splat(local.error) + here).max_element();
        Surface {
            position: position.into(),
            normal: normal(local.normal),
            shading_normal: normal(local.shading_normal),
            error,
            ..*local
        }
    }

    /// A difference of positions of the group in the world.
    pub(super) fn vector_to_world(&self, local: Vec3) -> Vec3 {
        self.to_world.transform_vector3(local)
    }

    /// The box around a box of the group.
    pub(super) fn bounds_to_world(&self, local: Bounds) -> Bounds {
        let corner = |corner: usize| {
            let side = |axis: usize| if corner >> axis & 1 == 0 { local.min[axis] } else { local.max[axis] };
            self.to_world.transform_point3(Vec3::new(side(0), side(1), side(2)))
        };
        Bounds::around((0..8).map(corner))
    }
}

fn absolute(matrix: &Mat3A) -> Mat3A {
    Mat3A::from_cols(matrix.x_axis.abs(), matrix.y_axis.abs(), matrix.z_axis.abs())
}
