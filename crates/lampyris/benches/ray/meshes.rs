//! The meshes that rays are shot at.

use std::sync::Arc;

use glam::Vec3;
use lampyris::geometry::MeshData;
use lampyris::math::warp;
use lampyris::sampler::Sampler;

/// A displaced sphere of 786,432 triangles in a box.
pub fn blob() -> Arc<MeshData> {
    let mut mesh = MeshData::default();
    add_displaced_sphere(&mut mesh, 256, Vec3::ZERO, 1.0);
    add_box(&mut mesh, 1.5);
    Arc::new(mesh)
}

/// 2000 displaced spheres of 768 triangles each, anywhere in a box.
pub fn cloud() -> Arc<MeshData> {
    let mut mesh = MeshData::default();
    let mut sampler = Sampler::new(7, 0, 0, 0);
    for _ in 0..2000 {
        let direction = warp::sphere(sampler.square());
        let center = direction.map(|x| (x * 1e3).fract()) * 1.4;
        let radius = 0.02 + 0.08 * sampler.uniform();
        add_displaced_sphere(&mut mesh, 8, center, radius);
    }
    add_box(&mut mesh, 1.5);
    Arc::new(mesh)
}

/// The same with the halves of its squares far from each other in the file, so that none follows on the other.
pub fn halves_apart(mesh: &MeshData) -> Arc<MeshData> {
    let halves = |first| mesh.triangles.iter().skip(first).step_by(2).copied();
    Arc::new(MeshData { triangles: halves(0).chain(halves(1)).collect(), ..mesh.clone() })
}

/// The six faces of a cube, `n` squares each way, blown up to a sphere with bumps: 12 n² triangles.
fn add_displaced_sphere(mesh: &mut MeshData, n: u32, center: Vec3, radius: f32) {
    for face in 0..6 {
        let first = mesh.positions.len() as u32;
        let sign = if face % 2 == 0 { 1.0 } else { -1.0 };
        for row in 0..=n {
            for column in 0..=n {
                let at = |step| 2.0 * step as f32 / n as f32 - 1.0;
                let mut point = [0.0; 3];
                point[face / 2] = sign;
                point[(face / 2 + 1) % 3] = at(column);
                point[(face / 2 + 2) % 3] = at(row);
                let out = Vec3::from_array(point).normalize();
                let bumps = (9.0 * out.x).sin() * (11.0 * out.y).sin() * (7.0 * out.z).sin();
                mesh.positions.push((center + out * radius * (0.8 + 0.15 * bumps)).to_array());
            }
        }
        for row in 0..n {
            for column in 0..n {
                let corner = first + row * (n + 1) + column;
                mesh.triangles.push([corner, corner + 1, corner + n + 2]);
                mesh.triangles.push([corner, corner + n + 2, corner + n + 1]);
            }
        }
    }
}

fn add_box(mesh: &mut MeshData, half: f32) {
    for axis in 0..3 {
        for sign in [-half, half] {
            let first = mesh.positions.len() as u32;
            for [a, b] in [[-half, -half], [half, -half], [half, half], [-half, half]] {
                let mut position = [0.0; 3];
                position[axis] = sign;
                position[(axis + 1) % 3] = a;
                position[(axis + 2) % 3] = b;
                mesh.positions.push(position);
            }
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
}
