//! Light from infinitely far away, projectors, beams and meters of irradiance: each against what it claims or an exact
//! answer.

mod common;

use std::f64::consts::PI;

use common::lit;
use common::statistics::{assert_distribution, assert_mean};
use glam::{Vec2, Vec3};
use lampyris::geometry::Ray;
use lampyris::math::Frame;
use lampyris::sampler::Sampler;
use lampyris::scene::Scene;

/// Bands of the cosine to +y, and sectors around it.
const BANDS: usize = 24;
const SECTORS: usize = 32;

fn with_light(light: &str) -> Scene {
    let text = format!(
        "camera = {{ origin = [0, 0, 9], target = [0, 0, 0] }}
         lights = [{light}]
         shapes = [{{ type = 'sphere', center = [1, 2, 3] }}]"
    );
    lit(&text, "").scene
}

fn bin(direction: Vec3) -> usize {
    let band = ((0.5 + 0.5 * direction.y) * BANDS as f32) as usize;
    let around = direction.x.atan2(direction.z) / std::f32::consts::TAU + 0.5;
    band.min(BANDS - 1) * SECTORS + ((around * SECTORS as f32) as usize).min(SECTORS - 1)
}

/// The integral of a density over each bin, by the midpoint rule.
fn integrals(density: impl Fn(Vec3) -> f64) -> Vec<f64> {
    const FINE: usize = 40;
    let mut sums = vec![0.0; BANDS * SECTORS];
    for (i, j) in (0..BANDS * FINE).flat_map(|i| (0..SECTORS * FINE).map(move |j| (i, j))) {
        let y = 2.0 * (i as f64 + 0.5) / (BANDS * FINE) as f64 - 1.0;
        let (sin, cos) = (2.0 * PI * ((j as f64 + 0.5) / (SECTORS * FINE) as f64 - 0.5)).sin_cos();
        let radius = (1.0 - y * y).sqrt();
        let direction = Vec3::new((radius * sin) as f32, y as f32, (radius * cos) as f32);
        sums[i / FINE * SECTORS + j / FINE] += density(direction);
    }
    let cell = 4.0 * PI / (BANDS * SECTORS * FINE * FINE) as f64;
    sums.iter().map(|sum| sum * cell).collect()
}

const FAR: [&str; 5] = [
    "{ type = 'environment', file = 'oblong' }",
    "{ type = 'environment', file = 'oblong', scale = [2, 1, 0.5], transform = [{ rotate = { axis = [1, 2, 3], degrees = 70 } }] }",
    "{ type = 'environment', file = 'square', mapping = 'equal-area' }",
    "{ type = 'sky', sun-direction = [1, 1, 1], sun-scale = 0 }",
    "{ type = 'directional', direction = [0.3, -1, 0.2], angle = 60 }",
];

/// Shadow rays and photons alike, against the density that multiple importance sampling is told.
#[test]
fn the_sky_is_sampled_with_the_density_that_it_claims() {
    for light in FAR {
        let scene = with_light(light);
        let draws = 100_000;
        // Where the picture is black nothing is drawn.
        let density = |direction| {
            if scene.background(direction).is_zero() {
                0.0
            } else {
                scene.backgrounds(&Ray { origin: Vec3::ZERO, direction }, None).map(|(_, pdf, _)| f64::from(pdf)).sum()
            }
        };
        let expected: Vec<f64> = integrals(density).iter().map(|share| share * f64::from(draws)).collect();
        let total: f64 = expected.iter().sum::<f64>() / f64::from(draws);
        assert!((0.97..1.003).contains(&total), "{light}: {total}");
        let mut sampler = Sampler::new(3, 0, 0, 0);
        let mut shadows = vec![0.0; BANDS * SECTORS];
        let mut photons = vec![0.0; BANDS * SECTORS];
        let mut flux = Vec::new();
        for _ in 0..draws {
            if let Some((_, light)) = scene.illuminate(Vec3::ZERO, None, &mut sampler) {
                let pdf = light.pdf.expect("a density");
                let (radiance, due) = ((light.irradiance * pdf).to_rgb(), scene.background(light.to_light).to_rgb());
                // A rounding of the direction moves it by 1e-6 over a picture that changes by 10 within 1/12.
                let near = radiance.iter().zip(due).all(|(a, b)| (a - b).abs() < 1e-3 + 1e-3 * b);
                assert!(near, "{light:?}: {radiance:?} instead of {due:?}");
                shadows[bin(light.to_light)] += 1.0;
            }
            let photon = scene.emit(&mut sampler).map(|(_, photon)| photon);
            flux.push(photon.map_or(0.0, |photon| f64::from(photon.flux.mean())));
            if let Some(photon) = photon {
                photons[bin(-photon.ray.direction)] += 1.0;
            }
        }
        assert_distribution(light, &shadows, &expected, f64::from(draws));
        assert_distribution(light, &photons, &expected, f64::from(draws));
        assert_mean(light, &flux, f64::from(scene.power().mean()), 2e-3, 0.02);
    }
}

#[test]
fn photons_from_a_picture_start_on_a_disk_that_hides_the_scene() {
    let scene = with_light(FAR[0]);
    let (center, radius) = (scene.bounds().center(), 1.001 * scene.bounds().radius());
    let mut sampler = Sampler::new(4, 0, 0, 0);
    let mut observed = vec![0.0; 60];
    let mut drawn = 0.0;
    for _ in 0..50_000 {
        let Some(Ray { origin, direction }) = scene.emit(&mut sampler).map(|(_, photon)| photon.ray) else { continue };
        let local = Frame::around(direction).to_local(origin - center) / radius;
        assert!(local.z < -0.999, "outside the scene");
        let ring = ((local.truncate().length_squared() * 6.0) as usize).min(5);
        let around = f64::from(local.y.atan2(local.x)) / (2.0 * PI) + 0.5;
        drawn += 1.0;
        observed[ring * 10 + ((around * 10.0) as usize).min(9)] += 1.0;
    }
    assert_distribution("disk", &observed, &[drawn / 60.0; 60], drawn);
}

/// The sun's irradiance is what was asked for, on a surface that faces it.
#[test]
fn a_disk_in_the_sky_gives_its_irradiance() {
    for angle in ["0", "0.53", "60"] {
        let text = format!(
            "camera = {{ origin = [0, 0, 3], target = [0, 0, 0], fov = 10 }}
             film = {{ size = [4, 4] }}
             lights = [{{ type = 'directional', direction = [0, 0, -1], irradiance = [1, 2, 3], angle = {angle} }}]
             shapes = [{{ type = 'disk', material = {{ type = 'diffuse', reflectance = 0.5 }} }}]"
        );
        for way in ["integrator=path samples=16", "integrator=photon-map photons=20000 direct=photons radius=0.2"] {
            for (values, irradiance) in lit(&text, way).means(30).iter().zip([1.0, 2.0, 3.0]) {
                assert_mean(&format!("{angle}, {way}"), values, 0.5 * irradiance / PI, 0.0, 0.05);
            }
        }
    }
}

#[test]
fn a_meter_measures_the_irradiance_of_its_shape() {
    // Under a sky of radiance 1 it is π; on a ball's outside, too, and half of it where a wall hides half the sky.
    let sky = "lights = [{ type = 'constant', radiance = 1 }]\nfilm = { size = [2, 2] }\n";
    let camera = "camera = { origin = [0, 0, 0], irradiance-of = 'meter' }\n";
    let black = "material = { type = 'diffuse', reflectance = 0 }";
    for (shapes, expected) in [
        (format!("[[shapes]]\ntype = 'sphere'\nname = 'meter'\n{black}\n"), PI),
        (
            format!(
                "[[shapes]]\ntype = 'quad'\ncorner = [0, 0, 0]\nu = [0.001, 0, 0]\nv = [0, 0.001, 0]\nname = 'meter'
                 {black}\n[[shapes]]\ntype = 'plane'\nnormal = [1, 0, 0]\ndistance = 0.0001\n{black}\n"
            ),
            PI / 2.0,
        ),
    ] {
        let text = format!("{camera}{sky}{shapes}");
        let values = &lit(&text, "integrator=path samples=256").means(60)[0];
        assert_mean(&shapes, values, expected, 0.02 * f64::from(u8::from(expected < 2.0)), 0.05);
    }
}

/// On a wall across the axis at distance 2 the irradiance is a quarter of the texture, wherever it falls.
#[test]
fn a_projector_throws_its_texture_without_falling_off() {
    let scene = lit(
        "camera = { origin = [0, 0, 9], target = [0, 0, 0] }
         textures = { board = { type = 'checkerboard', color0 = [0.2, 0.4, 0.6], color1 = 0.9 } }
         shapes = [{ type = 'sphere' }]
         lights = [{ type = 'projector', position = [1, 2, 3], target = [1, 2, 5], texture = 'board', aspect = 2,
                     fov = 90, scale = [1, 2, 3] }]",
        "",
    )
    .scene;
    let mut sampler = Sampler::new(5, 0, 0, 0);
    // Looking along +z with y up, x runs to the left: (0, 0) of the texture is at +x, below.
    let at = |u: f32, v: f32| Vec3::new(1.0 + 2.0 * (1.0 - 2.0 * u), 2.0 + 1.0 * (2.0 * v - 1.0), 5.0);
    for (u, v, green) in [(0.25, 0.25, 0.4), (0.75, 0.25, 0.9), (0.9, 0.9, 0.4), (0.1, 0.6, 0.9)] {
        let point = at(u, v);
        let (_, light) = scene.illuminate(point, None, &mut sampler).expect("light");
        let irradiance = f64::from(light.irradiance.to_rgb()[1] * light.to_light.z.abs());
        assert!((irradiance - 2.0 * green / 4.0).abs() < 1e-4, "{u} {v}: {irradiance}");
    }
    assert!(scene.illuminate(at(1.05, 0.5), None, &mut sampler).is_none());
    // Photons: the flux on each quarter of the wall.
    let mut flux = [const { Vec::new() }; 4];
    for _ in 0..100_000 {
        let (_, photon) = scene.emit(&mut sampler).expect("a photon");
        let Ray { origin, direction } = photon.ray;
        let hit = origin + direction * (2.0 / direction.z);
        let uv = Vec2::new(0.5 - (hit.x - 1.0) / 4.0, 0.5 + (hit.y - 2.0) / 2.0);
        let quarter = usize::from(uv.x > 0.5) + 2 * usize::from(uv.y > 0.5);
        for (index, flux) in flux.iter_mut().enumerate() {
            flux.push(if index == quarter { f64::from(photon.flux.to_rgb()[1]) } else { 0.0 });
        }
    }
    for (quarter, (flux, green)) in flux.iter().zip([0.4, 0.9, 0.9, 0.4]).enumerate() {
        // Irradiance × area at distance 1: the picture is 2 × 1 there, a quarter 1 × 0.5.
        assert_mean(&format!("quarter {quarter}"), flux, 2.0 * green * 0.5, 0.0, 0.05);
    }
}

/// All of a thin beam's flux arrives: what a diffuse wall in a black world absorbs and reflects.
#[test]
fn a_thin_beam_lights_what_only_photons_can_see() {
    let text = "camera = { origin = [0, 0, 3], target = [0, 0, 0], projection = 'orthographic', width = 2 }
        film = { size = [8, 8] }
        lights = [{ type = 'beam', position = [0.05, 0.02, 2], direction = [0, 0, -1], power = [1, 2, 3] }]
        shapes = [{ type = 'quad', corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0],
                    material = { type = 'diffuse', reflectance = 0.5 } }]";
    let means = lit(text, "integrator=photon-map photons=1000 bandwidth=fixed radius=0.3 samples=64").means(60);
    for (values, power) in means.iter().zip([1.0, 2.0, 3.0]) {
        // Mean radiance over the four units of area that the picture sees: flux · ρ / π / 4.
        assert_mean("beam", values, power * 0.5 / PI / 4.0, 0.0, 0.05);
    }
}
