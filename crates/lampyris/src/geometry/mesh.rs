//! Triangles.

use std::sync::Arc;

use glam::{Mat4, Vec2, Vec3};

use super::{Bounds, MeshData, RELATIVE_ERROR, Ray, Surface};
use crate::math::{Distribution, Frame, warp};

/// A triangle mesh in world coordinates.
#[derive(Clone, Debug)]
pub struct Mesh {
    data: Arc<MeshData>,
    by_area: Distribution,
    area: f32,
}

/// A triangle as rays meet it.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    corner: Vec3,
    edges: [Vec3; 2],
}

impl Mesh {
    /// The mesh moved to the world by `transform`, which must not be singular. `data` must have no
    /// [fault](MeshData::fault).
    pub fn new(data: &Arc<MeshData>, transform: &Mat4) -> Mesh {
        let data = if *transform == Mat4::IDENTITY { Arc::clone(data) } else { Arc::new(transformed(data, transform)) };
        let areas: Vec<f64> = (0..data.triangles.len()).map(|i| f64::from(triangle(&data, i).area())).collect();
        Mesh { by_area: Distribution::new(&areas), area: areas.iter().sum::<f64>() as f32, data }
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.data.triangles.len()
    }

    /// Whether there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.data.triangles.is_empty()
    }

    /// Triangle number `index`.
    pub fn triangle(&self, index: usize) -> Triangle {
        triangle(&self.data, index)
    }

    /// The surface on triangle `index` at the barycentric coordinates of its second and third corner.
    pub fn surface(&self, index: usize, barycentric: Vec2) -> Surface {
        let triangle = self.triangle(index);
        let weights = [1.0 - barycentric.x - barycentric.y, barycentric.x, barycentric.y];
        let corners = self.data.triangles[index].map(|corner| corner as usize);
        let [e1, e2] = triangle.edges;
        let normal = e1.cross(e2).normalize_or(Vec3::Z);
        let shading_normal = if self.data.normals.is_empty() {
            normal
        } else {
            let normals = corners.map(|corner| Vec3::from_array(self.data.normals[corner]));
            (normals[0] * weights[0] + normals[1] * weights[1] + normals[2] * weights[2]).normalize_or(normal)
        };
        let uv = if self.data.uvs.is_empty() {
            barycentric
        } else {
            let uvs = corners.map(|corner| Vec2::from_array(self.data.uvs[corner]));
            uvs[0] * weights[0] + uvs[1] * weights[1] + uvs[2] * weights[2]
        };
        let extent = triangle.corner.abs() + e1.abs() + e2.abs();
        let error = RELATIVE_ERROR * extent.max_element();
        let position = triangle.corner + e1 * barycentric.x + e2 * barycentric.y;
        Surface { position, normal, shading_normal, uv, error }
    }

    /// How the position changes with either texture coordinate on triangle `index`. Where the mesh has none they are the
    /// barycentric coordinates; where they do not span the triangle, any two vectors in its plane.
    pub fn partials(&self, index: usize) -> (Vec3, Vec3) {
        let Triangle { edges: [e1, e2], .. } = self.triangle(index);
        if self.data.uvs.is_empty() {
            return (e1, e2);
        }
        let [a, b, c] = self.data.triangles[index].map(|corner| Vec2::from_array(self.data.uvs[corner as usize]));
        let (d1, d2) = (b - a, c - a);
        let inverse = 1.0 / d1.perp_dot(d2);
        let along_u = (e1 * d2.y - e2 * d1.y) * inverse;
        let along_v = (e2 * d1.x - e1 * d2.x) * inverse;
        if along_u.is_finite() && along_v.is_finite() {
            return (along_u, along_v);
        }
        let frame = Frame::around(e1.cross(e2).normalize_or(Vec3::Z));
        (frame.to_world(Vec3::X), frame.to_world(Vec3::Y))
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        self.area
    }

    /// A point uniform by area.
    pub fn sample(&self, u: Vec2) -> Surface {
        let (index, _, rest) = self.by_area.sample(u.x);
        self.surface(index, warp::triangle(Vec2::new(rest, u.y)))
    }
}

impl Triangle {
    /// Distance and barycentric coordinates of where the ray meets it before `max` [Möller & Trumbore 1997].
    #[inline]
    pub fn intersect(&self, ray: &Ray, max: f32) -> Option<(f32, Vec2)> {
        let [e1, e2] = self.edges;
        let p = ray.direction.cross(e2);
        let inverse = 1.0 / e1.dot(p);
        let to_origin = ray.origin - self.corner;
        let u = to_origin.dot(p) * inverse;
        let q = to_origin.cross(e1);
        let v = ray.direction.dot(q) * inverse;
        let distance = e2.dot(q) * inverse;
        // False for a NaN from a degenerate triangle, too.
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0 && distance < max;
        inside.then_some((distance, Vec2::new(u, v)))
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        let [e1, e2] = self.edges;
        Bounds::around([self.corner, self.corner + e1, self.corner + e2])
    }

    fn area(&self) -> f32 {
        0.5 * self.edges[0].cross(self.edges[1]).length()
    }
}

fn triangle(data: &MeshData, index: usize) -> Triangle {
    let [a, b, c] = data.triangles[index].map(|corner| Vec3::from_array(data.positions[corner as usize]));
    Triangle { corner: a, edges: [b - a, c - a] }
}

fn transformed(data: &MeshData, transform: &Mat4) -> MeshData {
    let normal_transform = transform.inverse().transpose();
    let normal = |n: &[f32; 3]| {
        let n = Vec3::from_array(*n);
        normal_transform.transform_vector3(n).normalize_or(n).to_array()
    };
    MeshData {
        positions: data.positions.iter().map(|p| transform.transform_point3(Vec3::from_array(*p)).to_array()).collect(),
        normals: data.normals.iter().map(normal).collect(),
        uvs: data.uvs.clone(),
        colors: data.colors.clone(),
        triangles: data.triangles.clone(),
    }
}
