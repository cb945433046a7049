//! Scenes that the benchmarks share.

#![allow(dead_code)]

use std::path::Path;
use std::sync::Arc;

use glam::Vec3;
use lampyris::geometry::MeshData;
use lampyris::import::toml::read_str;
use lampyris::scene::description::{
    CameraDescription, Color, GeometryDescription, LightDescription, SceneDescription, ShapeDescription, Transform,
};
use lampyris::scene::{NoAssets, Scene, build};

/// The course's box, from the file that the README renders.
pub fn cornell_box() -> Scene {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/cornell-box/cornell-box.toml"));
    let text = std::fs::read_to_string(file).expect("the project's scene");
    let imported = read_str(file, &text).expect("a good scene");
    build(&imported.description, &NoAssets).expect("a good scene").scene
}

/// A displaced sphere of 786,432 triangles in a box, with a point light between them.
pub fn blob() -> Scene {
    let shape = |geometry| ShapeDescription {
        interior: None,
        priority: 0,
        geometry,
        material: None,
        emission: None,
        transform: Transform::default(),
        flip_normal: false,
        name: None,
    };
    let mut room = shape(GeometryDescription::Cube {});
    room.transform = Transform(glam::Mat4::from_scale(Vec3::splat(1.5)));
    let light = LightDescription::Point { position: [1.3; 3], intensity: Some(Color::grey(1.0)), power: None };
    let camera = CameraDescription { origin: [0.0, 0.0, -1.4], target: Some([0.0; 3]), ..CameraDescription::default() };
    let description = SceneDescription {
        camera: Some(camera),
        shapes: vec![shape(GeometryDescription::Triangles(Arc::new(displaced_sphere(256)))), room],
        lights: vec![light],
        ..SceneDescription::default()
    };
    build(&description, &NoAssets).expect("a good scene").scene
}

/// The six faces of a cube, `n` squares each way, blown up to a sphere with bumps: 12 n² triangles.
fn displaced_sphere(n: u32) -> MeshData {
    let mut mesh = MeshData::default();
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
                mesh.positions.push((out * (0.8 + 0.15 * bumps)).to_array());
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
    mesh
}
