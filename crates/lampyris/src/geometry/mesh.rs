//! Triangles.

use std::sync::{Arc, OnceLock};

use glam::{Mat4, Vec2, Vec3};

use rayon::prelude::*;

use super::{Bounds, MeshData, RELATIVE_ERROR, Surface};
use crate::math::{Distribution, Frame, warp};

/// A triangle mesh in world coordinates.
#[derive(Clone, Debug)]
pub struct Mesh {
    data: Arc<MeshData>,
    /// Only of meshes of which points are sampled.
    by_area: OnceLock<Distribution>,
    area: f32,
    bounds: Bounds,
}

#[derive(Clone, Copy, Debug)]
struct Triangle {
    corner: Vec3,
    edges: [Vec3; 2],
}

impl Mesh {
    /// The mesh moved to the world by `transform`, which must not be singular. `data` must have no
    /// [fault](MeshData::fault).
    pub fn new(data: &Arc<MeshData>, transform: &Mat4) -> Mesh {
        let data = if *transform == Mat4::IDENTITY { Arc::clone(data) } else { Arc::new(transformed(data, transform)) };
        let parts: Vec<(f64, Bounds)> = data.triangles.par_chunks(1 << 16).map(|part| extent(&data, part)).collect();
        let (area, bounds) =
            parts.into_iter().fold((0.0, Bounds::EMPTY), |sum, part| (sum.0 + part.0, sum.1.union(part.1)));
        Mesh { data, by_area: OnceLock::new(), area: area as f32, bounds }
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.data.triangles.len()
    }

    /// Whether there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.data.triangles.is_empty()
    }

    /// The positions of the three corners of triangle number `index`.
    pub fn corners(&self, index: usize) -> [[f32; 3]; 3] {
        corners(&self.data, self.data.triangles[index])
    }

    /// The box around the triangles.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The surface on triangle `index` at the barycentric coordinates of its second and third corner.
    pub fn surface(&self, index: usize, barycentric: Vec2) -> Surface {
        let triangle = Triangle::new(self.corners(index));
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

    /// The colour of the vertices of triangle `index` at these barycentric coordinates, linear RGB; none in a mesh
    /// without colours.
    pub fn color(&self, index: usize, barycentric: Vec2) -> Option<[f32; 3]> {
        if self.data.colors.is_empty() {
            return None;
        }
        let [a, b, c] = self.data.triangles[index].map(|corner| Vec3::from_array(self.data.colors[corner as usize]));
        Some((a * (1.0 - barycentric.x - barycentric.y) + b * barycentric.x + c * barycentric.y).to_array())
    }

    /// How the position changes with either texture coordinate on triangle `index`. Where the mesh has none they are the
    /// barycentric coordinates; where they do not span the triangle, any two vectors in its plane.
    pub fn partials(&self, index: usize) -> (Vec3, Vec3) {
        let Triangle { edges: [e1, e2], .. } = Triangle::new(self.corners(index));
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
        let areas = || self.data.triangles.iter().map(|&t| Triangle::new(corners(&self.data, t)).area());
        let by_area = self.by_area.get_or_init(|| Distribution::new(&areas().map(f64::from).collect::<Vec<_>>()));
        let (index, _, rest) = by_area.sample(u.x);
        self.surface(index, warp::triangle(Vec2::new(rest, u.y)))
    }
}

impl Triangle {
    fn new(corners: [[f32; 3]; 3]) -> Triangle {
        let [a, b, c] = corners.map(Vec3::from_array);
        Triangle { corner: a, edges: [b - a, c - a] }
    }

    fn area(&self) -> f32 {
        0.5 * self.edges[0].cross(self.edges[1]).length()
    }
}

fn corners(data: &MeshData, triangle: [u32; 3]) -> [[f32; 3]; 3] {
    triangle.map(|corner| data.positions[corner as usize])
}

/// The area of some triangles, and the box around them.
fn extent(data: &MeshData, triangles: &[[u32; 3]]) -> (f64, Bounds) {
    triangles.iter().fold((0.0, Bounds::EMPTY), |(area, bounds), &triangle| {
        let corners = corners(data, triangle);
        let here = Bounds::around(corners.map(Vec3::from_array));
        (area + f64::from(Triangle::new(corners).area()), bounds.union(here))
    })
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
