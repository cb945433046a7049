//! Shadow rays learn what points see of the lights: that changes no mean, is drawn with the density that it claims, and is
//! worth while where most of a sky, or most lamps, are hidden.

mod common;

use std::sync::Arc;

use common::lit;
use common::statistics::{assert_distribution, assert_same_mean};
use glam::Vec3;
use lampyris::geometry::Ray;
use lampyris::image::Image;
use lampyris::light::{Node, SIDES, Sightings};
use lampyris::sampler::Sampler;
use lampyris::scene::Scene;

fn quad(corner: &str, u: &str, v: &str) -> String {
    format!(
        "[[shapes]]\ntype = 'quad'\ncorner = [{corner}]\nu = [{u}]\nv = [{v}]\n
         material = {{ type = 'diffuse', reflectance = [0.7, 0.6, 0.5] }}\n"
    )
}

/// A room of size 2 with a window to the right, and a board that stands on its floor.
fn room(lights: &str) -> String {
    let film = "film = { size = [16, 16] }
        camera = { origin = [0.1, 0.6, -0.9], target = [-0.2, -1, 0.2], fov = 70 }\n";
    let walls = [
        quad("-1, -1, -1", "0, 0, 2", "2, 0, 0"),
        quad("-1, 1, -1", "2, 0, 0", "0, 0, 2"),
        quad("-1, -1, -1", "0, 2, 0", "0, 0, 2"),
        quad("-1, -1, -1", "2, 0, 0", "0, 2, 0"),
        quad("-1, -1, 1", "0, 2, 0", "2, 0, 0"),
        quad("1, -1, -1", "0, 0, 2", "0, 0.9, 0"),
        quad("1, 0.3, -1", "0, 0, 2", "0, 0.7, 0"),
        quad("1, -0.1, -1", "0, 0, 0.8", "0, 0.4, 0"),
        quad("1, -0.1, 0.3", "0, 0, 0.7", "0, 0.4, 0"),
        quad("0.2, -1, -0.3", "0, 0, 0.6", "-0.1, 0.5, 0"),
    ];
    format!("{film}lights = [{lights}]\n{}", walls.concat())
}

const SKY: &str = "{ type = 'constant', radiance = [1, 2, 3] }";
const PICTURE: &str = "{ type = 'environment', file = 'oblong', scale = 4 }, { type = 'directional', direction = [-1, -0.6, 0.1], angle = 2, irradiance = 2 }";

/// One lamp in the room, and many that shine elsewhere.
fn lamps() -> String {
    let outside = |number: i32| {
        let (x, z) = (number % 5 - 2, number / 5 - 2);
        format!("{{ type = 'point', position = [{x}, -3, {z}], intensity = 3 }}")
    };
    let inside = "{ type = 'point', position = [0.5, 0.4, 0.3], intensity = [1, 1.5, 2] }".to_string();
    [inside].into_iter().chain((0..25).map(outside)).collect::<Vec<String>>().join(", ")
}

fn means(images: &[Image]) -> Vec<f64> {
    images.iter().map(|image| common::channel_mean(image, 1)).collect()
}

/// The variance of a pixel's green between passes, over the square of the picture's mean.
fn noise(images: &[Image]) -> f64 {
    let mean = means(images).iter().sum::<f64>() / images.len() as f64;
    let of_pixel = |pixel: usize| {
        let values = images.iter().map(|image| f64::from(image.pixel(pixel % 16, pixel / 16)[1]));
        let own = values.clone().sum::<f64>() / images.len() as f64;
        values.map(|value| (value - own).powi(2)).sum::<f64>() / (images.len() - 1) as f64
    };
    (0..256).map(of_pixel).sum::<f64>() / (256.0 * mean * mean)
}

#[track_caller]
fn assert_worth_while(name: &str, lights: &str, least: f64) {
    let text = room(lights);
    let passes = |settings: &str| lit(&text, settings).passes(40);
    let even = passes("integrator=path samples=16 guiding=false");
    let guided = passes("integrator=path samples=16 seed=1");
    let light = passes("integrator=light photons=32768 seed=2");
    let auto = passes("integrator=auto photons=16384 samples=16 seed=3");
    assert_same_mean(&format!("{name}, guided"), &means(&even), &means(&guided), 3, 0.0);
    assert_same_mean(&format!("{name}, light"), &means(&light), &means(&guided), 3, 0.0);
    assert_same_mean(&format!("{name}, auto"), &means(&auto), &means(&guided), 3, 0.005);
    let gain = noise(&even) / noise(&guided);
    assert!(gain > least, "{name}: {gain}");
}

#[test]
fn a_sky_through_a_window() {
    assert_worth_while("sky", SKY, 4.0);
}

#[test]
fn a_picture_of_the_sky_and_a_sun_through_a_window() {
    assert_worth_while("picture", PICTURE, 2.0);
}

#[test]
fn one_of_many_lamps() {
    assert_worth_while("lamps", &lamps(), 20.0);
}

/// Parts of the lights otherwise to the left than to the right, and by the way that a surface faces.
fn sightings(scene: &Scene) -> Sightings {
    let parts = scene.parts_of_lights().len();
    let vista = |vista: usize| (0..parts).map(|part| ((vista + part / 5) % 7) as f32 / 6.0).collect();
    let split = |side: u32| {
        let root = Node::Split { axis: 0, at: 0.05, children: [1, 2] };
        vec![root, Node::Vista(2 * side), Node::Vista(2 * side + 1)]
    };
    Sightings { trees: std::array::from_fn(|side| split(side as u32)), vistas: (0..2 * SIDES).map(vista).collect() }
}

#[test]
fn shadow_rays_have_the_density_that_they_claim() {
    const BANDS: usize = 24;
    const SECTORS: usize = 24;
    let lights = "{ type = 'constant', radiance = 1 }, { type = 'environment', file = 'oblong', scale = 0.3 }";
    let scene = lit(&room(lights), "").scene;
    let scene = scene.with_outlook(Arc::new(scene.outlook(&sightings(&scene)).expect("an outlook")));
    // On the floor to the left, and on the wall to the right.
    for (from, toward) in [(Vec3::ZERO, Vec3::new(-0.5, -1.0, 0.0)), (Vec3::ZERO, Vec3::new(1.0, -0.5, 0.0))] {
        let mut bsdf = lampyris::material::Bsdf::default();
        let point = scene.closest(&Ray { origin: from, direction: toward.normalize() }, &mut bsdf).expect("a wall");
        let vista = scene.vista(&point.surface);
        let at = point.surface.position;
        let (draws, fine) = (200_000, 12);
        let direction = |z: f32, around: f32| {
            let (sin, cos) = (std::f32::consts::TAU * around).sin_cos();
            let radius = (1.0 - z * z).max(0.0).sqrt();
            Vec3::new(radius * cos, radius * sin, z)
        };
        // Of both lights, each by its own density.
        let density = |direction| -> f64 {
            let ray = Ray { origin: at, direction };
            let lights = scene.backgrounds(&ray, vista);
            lights.filter(|(radiance, ..)| !radiance.is_zero()).map(|(_, pdf, _)| f64::from(pdf)).sum()
        };
        let expected = |bin: usize| -> f64 {
            let step = |within: usize| (within as f32 + 0.5) / fine as f32;
            let points = (0..fine * fine).map(|point| (step(point % fine), step(point / fine)));
            let at = points.map(|(i, j)| {
                let z = 2.0 * ((bin / SECTORS) as f32 + i) / BANDS as f32 - 1.0;
                density(direction(z, ((bin % SECTORS) as f32 + j) / SECTORS as f32))
            });
            at.sum::<f64>() / (fine * fine) as f64 * 4.0 * std::f64::consts::PI / (BANDS * SECTORS) as f64
        };
        let expected: Vec<f64> = (0..BANDS * SECTORS).map(|bin| expected(bin) * f64::from(draws)).collect();
        let mut observed = vec![0.0; BANDS * SECTORS];
        let (mut sampler, mut edges) = (Sampler::new(7, 0, 0, 0), 0);
        for _ in 0..draws {
            let Some((light, illumination)) = scene.illuminate(at, vista, &mut sampler) else { continue };
            let (to_light, pdf) = (illumination.to_light, illumination.pdf.expect("a density"));
            let ray = Ray { origin: at, direction: to_light };
            let claimed = scene.backgrounds(&ray, vista).nth(light as usize).expect("a light").1;
            // Rounding can take a direction over the edge of a cell or of a pixel.
            edges += u32::from((pdf / claimed - 1.0).abs() > 1e-2);
            let around = to_light.y.atan2(to_light.x) / std::f32::consts::TAU;
            let band = ((0.5 + 0.5 * to_light.z) * BANDS as f32) as usize;
            let sector = ((around - around.floor()) * SECTORS as f32) as usize;
            observed[band.min(BANDS - 1) * SECTORS + sector.min(SECTORS - 1)] += 1.0;
        }
        assert!(edges < 20, "{edges} of {draws} have another density");
        assert_distribution("vista", &observed, &expected, f64::from(draws));
    }
}
