//! Normals that textures turn (theory §3.10).

use glam::{Vec2, Vec3};

use super::{Material, MaterialId, Materials};
use crate::math::Frame;
use crate::texture::{Lookup, Texture};

/// How positions change with the texture coordinates, in the frame around the shading normal.
#[derive(Clone, Copy, Debug)]
pub struct Slopes {
    /// ∂p/∂u.
    pub along_u: Vec3,
    /// ∂p/∂v.
    pub along_v: Vec3,
}

impl Materials {
    /// The normal that the maps of a material make of +z, as seen from `view` on the side of the normal (`front`) or the
    /// other one. All of it is in the frame around the shading normal with its x axis along ∂p/∂u.
    pub fn normal(&self, id: MaterialId, at: &Lookup, front: bool, view: Vec3, slopes: &Slopes) -> Vec3 {
        match &self.materials[id as usize] {
            Material::NormalMap { normals, strength, material } => {
                let map = Vec3::from_array(normals.at(at).to_rgb()) * 2.0 - 1.0;
                let normal = facing(map * Vec3::new(*strength, *strength, 1.0), view);
                self.within(*material, normal, at, front, view, slopes)
            }
            Material::BumpMap { height, scale, material } => {
                let gradient = height.gradient(at) * *scale;
                let lifted = |along: Vec3, rise: f32| along.with_z(rise);
                let normal = lifted(slopes.along_u, gradient.x).cross(lifted(slopes.along_v, gradient.y));
                // The texture may be mirrored; the normal stays on its side.
                let normal = facing(if normal.z < 0.0 { -normal } else { normal }, view);
                self.within(*material, normal, at, front, view, slopes)
            }
            Material::TwoSided { front: material, .. } if front => self.normal(*material, at, true, view, slopes),
            Material::TwoSided { back, .. } => {
                // The material of the back sees the surface from there, as in a mirror.
                let mirrored = Vec3::new(1.0, 1.0, -1.0);
                let seen = Slopes { along_u: slopes.along_u * mirrored, along_v: slopes.along_v * mirrored };
                let normal = self.normal(*back, at, true, view * mirrored, &seen);
                Vec3::new(-normal.x, -normal.y, normal.z)
            }
            Material::Mask { material, .. } => self.normal(*material, at, front, view, slopes),
            Material::Blend { weight, first, second } => {
                let weight = weight.at(at).mean();
                let [first, second] = [first, second].map(|part| self.normal(*part, at, front, view, slopes));
                (first * (1.0 - weight) + second * weight).normalize_or(Vec3::Z)
            }
            _ => Vec3::Z,
        }
    }

    /// The normal that a material in a map makes of `normal`.
    fn within(&self, id: MaterialId, normal: Vec3, at: &Lookup, front: bool, view: Vec3, slopes: &Slopes) -> Vec3 {
        let frame = Frame::along(normal, Vec3::X);
        let seen = Slopes { along_u: frame.to_local(slopes.along_u), along_v: frame.to_local(slopes.along_v) };
        match self.normal(id, at, front, frame.to_local(view), &seen) {
            Vec3::Z => normal,
            inner => frame.to_world(inner).normalize_or(Vec3::Z),
        }
    }
}

/// The normal, of unit length, leaning the other way if the side that `view` sees would turn its back on it
/// [Schüssler et al. 2017].
fn facing(normal: Vec3, view: Vec3) -> Vec3 {
    let turned = view.z * view.dot(normal) <= 0.0;
    let normal = if turned { Vec3::new(-normal.x, -normal.y, normal.z) } else { normal };
    normal.try_normalize().unwrap_or(Vec3::Z)
}

impl Texture {
    /// How the mean of the lanes changes with either texture coordinate.
    pub fn gradient(&self, at: &Lookup) -> Vec2 {
        let step = self.detail() / 16.0;
        let value = |offset: Vec2| self.at(&Lookup { uv: at.uv + offset, ..*at }).mean();
        let along = |offset: Vec2| (value(offset) - value(-offset)) / (2.0 * step);
        if step.is_finite() { Vec2::new(along(Vec2::X * step), along(Vec2::Y * step)) } else { Vec2::ZERO }
    }

    /// The size of the smallest thing to be seen, in texture coordinates: a pixel.
    fn detail(&self) -> f32 {
        match self {
            Texture::Constant(_) | Texture::VertexColor => f32::INFINITY,
            Texture::Bitmap(bitmap) => {
                let picture = bitmap.pyramid.picture(0);
                let size = Vec2::new(picture.width() as f32, picture.height() as f32);
                let matrix = bitmap.to_uv.matrix2;
                let pixels = (matrix.x_axis * size).length().max((matrix.y_axis * size).length());
                1.0 / pixels.max(f32::MIN_POSITIVE)
            }
            Texture::Checkerboard(checkerboard) => {
                let matrix = checkerboard.to_uv.matrix2;
                0.5 / matrix.x_axis.length().max(matrix.y_axis.length()).max(f32::MIN_POSITIVE)
            }
            Texture::Product(parts) => parts.iter().map(Texture::detail).fold(f32::INFINITY, f32::min),
            Texture::Mix(parts) => parts.iter().map(Texture::detail).fold(f32::INFINITY, f32::min),
            Texture::AtMostOne(inner) | Texture::Threshold(inner, _) => inner.detail(),
        }
    }
}
