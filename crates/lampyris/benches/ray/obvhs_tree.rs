//! The crate obvhs as Lampyris used it before it had a traversal of its own: its compressed eight-wide tree, with the
//! triangle test of [Möller & Trumbore 1997].

use std::time::Duration;

use glam::{Vec3, Vec3A};
use lampyris::geometry::{MeshData, Ray};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::RayHit;
use obvhs::{Boundable, BvhBuildParams};

pub struct ObvhsTree {
    tree: CwBvh,
    triangles: Vec<Triangle>,
}

#[derive(Clone, Copy)]
struct Triangle {
    corner: Vec3,
    edges: [Vec3; 2],
}

impl ObvhsTree {
    pub fn new(mesh: &MeshData) -> ObvhsTree {
        let triangle = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| Vec3::from_array(mesh.positions[corner as usize]));
            Triangle { corner: a, edges: [b - a, c - a] }
        };
        let triangles: Vec<Triangle> = mesh.triangles.iter().map(triangle).collect();
        let tree = build_cwbvh(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
        let triangles = tree.primitive_indices.iter().map(|&index| triangles[index as usize]).collect();
        ObvhsTree { tree, triangles }
    }
}

impl super::Tracer for ObvhsTree {
    fn name(&self) -> &'static str {
        "obvhs"
    }

    fn closest(&self, ray: &Ray) -> Option<f32> {
        let ray = obvhs::ray::Ray::new(Vec3A::from(ray.origin), Vec3A::from(ray.direction), 0.0, f32::INFINITY);
        let mut nearest = RayHit::none();
        self.tree.ray_traverse(ray, &mut nearest, |ray, leaf| self.triangles[leaf].intersect(ray));
        (nearest.t < f32::INFINITY).then_some(nearest.t)
    }

    fn blocked(&self, ray: &Ray, max: f32) -> bool {
        let ray = obvhs::ray::Ray::new(Vec3A::from(ray.origin), Vec3A::from(ray.direction), 0.0, max);
        !self.tree.ray_traverse_miss(ray, |ray, leaf| self.triangles[leaf].intersect(ray))
    }
}

impl Triangle {
    #[inline]
    fn intersect(&self, ray: &obvhs::ray::Ray) -> f32 {
        let [e1, e2] = self.edges;
        let direction = Vec3::from(ray.direction);
        let p = direction.cross(e2);
        let inverse = 1.0 / e1.dot(p);
        let to_origin = Vec3::from(ray.origin) - self.corner;
        let u = to_origin.dot(p) * inverse;
        let q = to_origin.cross(e1);
        let v = direction.dot(q) * inverse;
        let distance = e2.dot(q) * inverse;
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0 && distance < ray.tmax;
        if inside { distance } else { f32::INFINITY }
    }
}

impl Boundable for Triangle {
    fn aabb(&self) -> Aabb {
        let [e1, e2] = self.edges;
        let corners = [self.corner, self.corner + e1, self.corner + e2].map(Vec3A::from);
        Aabb::new(corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]))
    }
}
