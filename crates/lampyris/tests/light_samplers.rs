//! Photons and shadow rays of every light are drawn with the density that is claimed: chi-square tests.

mod common;

use std::f64::consts::{PI, TAU};

use common::lit;
use common::statistics::{assert_distribution, assert_frequency, assert_mean};
use glam::{Vec2, Vec3};
use lampyris::geometry::Ray;
use lampyris::light::Light;
use lampyris::material::Bsdf;
use lampyris::math::Frame;
use lampyris::sampler::Sampler;
use lampyris::scene::Scene;
use lampyris::spectrum::Spectrum;

/// A grid over all directions, uniform in solid angle: `Z` bands of the cosine to +z, `AROUND` sectors.
const Z: usize = 12;
const AROUND: usize = 16;
const BIN: f64 = 2.0 * TAU / (Z * AROUND) as f64;

fn bin(direction: Vec3) -> usize {
    let z = ((0.5 + 0.5 * f64::from(direction.z)) * Z as f64) as usize;
    let around = f64::from(direction.y.atan2(direction.x)) / TAU;
    let around = ((around + if around < 0.0 { 1.0 } else { 0.0 }) * AROUND as f64) as usize;
    z.min(Z - 1) * AROUND + around.min(AROUND - 1)
}

/// The integral of a density per solid angle over each bin, by the midpoint rule with `fine`² points.
fn integrals(fine: usize, density: impl Fn(Vec3) -> f64) -> Vec<f64> {
    let at = |step: usize, within: usize, of: usize| (step as f64 + (within as f64 + 0.5) / fine as f64) / of as f64;
    let integral = |bin: usize| {
        let mut sum = 0.0;
        for (i, j) in (0..fine).flat_map(|i| (0..fine).map(move |j| (i, j))) {
            let z = 2.0 * at(bin / AROUND, i, Z) - 1.0;
            let (sin, cos) = (TAU * at(bin % AROUND, j, AROUND)).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            sum += density(Vec3::new((radius * cos) as f32, (radius * sin) as f32, z as f32));
        }
        sum * BIN / (fine * fine) as f64
    };
    (0..Z * AROUND).map(integral).collect()
}

fn with_lights(lights: &str) -> Scene {
    lit(&format!("camera = {{ origin = [0, 0, 9], target = [0, 0, 0] }}\n{lights}"), "").scene
}

/// The lamps that are shapes, each seen from somewhere beside it.
const LAMPS: [(&str, [f32; 3]); 9] = [
    ("{ type = 'quad', corner = [-1, -1, 0], u = [2, 0, 0], v = [0.5, 2, 0]", [0.3, 0.2, 0.8]),
    ("{ type = 'quad', corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0]", [0.3, 0.2, 0.3]),
    ("{ type = 'quad', corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0]", [1.2, 0.3, 0.4]),
    ("{ type = 'disk', radius = 1.2", [0.6, -0.2, 0.9]),
    ("{ type = 'sphere'", [0.9, 0.9, 0.9]),
    ("{ type = 'sphere', flip-normal = true", [0.3, -0.2, 0.5]),
    ("{ type = 'cylinder', from = [0, 0, -1], to = [0, 0.2, 1], radius = 0.7", [1.2, 0.3, 0.1]),
    ("{ type = 'cube'", [1.5, 1.4, 0.3]),
    ("{ type = 'cube', flip-normal = true", [0.2, 0.1, 0.3]),
];

/// Shadow rays towards shapes: the directions' distribution against the density that the light claims for the point
/// that a ray in that direction meets, which is what multiple importance sampling asks for.
#[test]
fn every_lamp_is_sampled_with_the_density_that_it_claims() {
    for (shape, at) in LAMPS {
        let scene = with_lights(&format!("shapes = [{shape}, emission = {{ radiance = 3 }} }}]"));
        let at = Vec3::from(at);
        let density = |direction: Vec3| {
            let mut bsdf = Bsdf::default();
            let point = scene.closest(&Ray { origin: at, direction }, &mut bsdf);
            let lit = point.filter(|point| !scene.emitted(point).is_zero());
            lit.map_or(0.0, |point| f64::from(scene.emitted_pdf(at, None, &point)))
        };
        let draws = 40_000;
        let expected: Vec<f64> = integrals(32, density).iter().map(|p| p * f64::from(draws)).collect();
        let mut observed = vec![0.0; Z * AROUND];
        let mut sampler = Sampler::new(1, 0, 0, 0);
        for _ in 0..draws {
            let Some((_, light)) = scene.illuminate(at, None, &mut sampler) else { continue };
            let (pdf, claimed) = (light.pdf.expect("a density"), density(light.to_light));
            assert!((light.irradiance * pdf).to_rgb().iter().all(|radiance| (radiance / 3.0 - 1.0).abs() < 1e-4));
            // Rays to a shape's very edge may miss it, and where they graze it a rounding is a large step.
            let off = (f64::from(pdf) / claimed - 1.0).abs();
            assert!(claimed == 0.0 || claimed > 20.0 || off < 5e-3, "{shape}: {pdf} and {claimed}");
            observed[bin(light.to_light)] += 1.0;
        }
        assert_distribution(shape, &observed, &expected, f64::from(draws));
    }
}

/// Lamps with a back and with a pattern: still even by area, from both sides.
#[test]
fn lamps_of_two_sides_are_sampled_with_the_density_that_they_claim() {
    let emission = "emission = { radiance = 'squares', scale = 3, two-sided = true }";
    for (shape, at) in LAMPS {
        for side in [1.0, -1.0] {
            let textures = "textures = { squares = { type = 'checkerboard', color0 = 0.5, color1 = 1 } }";
            let scene = with_lights(&format!("{textures}\nshapes = [{shape}, {emission} }}]"));
            let at = Vec3::from(at) * Vec3::new(1.0, 1.0, side);
            let density = |direction: Vec3| {
                let mut bsdf = Bsdf::default();
                let lit = scene.closest(&Ray { origin: at, direction }, &mut bsdf);
                lit.map_or(0.0, |point| f64::from(scene.emitted_pdf(at, None, &point)))
            };
            let draws = 40_000;
            // Seen from inside or from beside, a closed shape has a back that the density of the front knows nothing
            // of: what is found behind is one more class.
            let expected: Vec<f64> = integrals(32, density).iter().map(|p| p * f64::from(draws)).collect();
            let mut observed = vec![0.0; Z * AROUND];
            let mut sampler = Sampler::new(3, 0, 0, 0);
            for _ in 0..draws {
                let Some((_, light)) = scene.illuminate(at, None, &mut sampler) else { continue };
                // Points behind the front do not count: a shadow ray would not reach them.
                let seen = light.target.is_some_and(|target| !scene.surfaces().occluded(at, target));
                if seen {
                    observed[bin(light.to_light)] += 1.0;
                }
            }
            assert_distribution(&format!("{shape}, {side}"), &observed, &expected, f64::from(draws));
        }
    }
}

/// Photons carry the radiance of where they start, times π, the area and two sides; half of them leave by each.
#[test]
fn photons_of_a_lamp_of_two_sides_carry_what_its_texture_says() {
    let scene = with_lights(
        "textures = { squares = { type = 'checkerboard', color0 = [1, 0, 0.5], color1 = 1 } }
         shapes = [{ type = 'quad', corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 3, 0],
                     emission = { radiance = 'squares', scale = 2, two-sided = true } }]",
    );
    let draws = 10_000;
    let (mut above, mut greens) = (0.0, Vec::new());
    let mut sampler = Sampler::new(4, 0, 0, 0);
    for _ in 0..draws {
        let light = scene.lights()[0].emitter().emit(scene.surfaces(), &mut sampler).expect("a photon");
        above += f64::from(u8::from(light.ray.direction.z > 0.0));
        let uv = (light.ray.origin.truncate() + 1.0) / Vec2::new(2.0, 3.0);
        let even = (uv.x > 0.5) == (uv.y > 0.5);
        let radiance = if even { [2.0, 0.0, 1.0] } else { [2.0; 3] };
        for (flux, radiance) in light.flux.to_rgb().into_iter().zip(radiance) {
            assert!((flux - radiance * 2.0 * std::f32::consts::PI * 6.0).abs() < 1e-3, "{light:?}");
        }
        greens.push(f64::from(light.flux.to_rgb()[1]));
    }
    assert_frequency("front", above, f64::from(draws), 0.5);
    let power = scene.power().to_rgb();
    assert!((power[1] / (2.0 * std::f32::consts::PI * 6.0) - 1.0).abs() < 1e-3, "{power:?}");
    assert_mean("green", &greens, f64::from(power[1]), 0.0, 0.1);
}

/// Where photons leave a shape: strata of equal area, by the texture coordinates.
#[test]
fn photons_leave_every_lamp_evenly() {
    for (shape, _) in LAMPS {
        let scene = with_lights(&format!("shapes = [{shape}, emission = {{ radiance = 1 }} }}]"));
        let strata = |uv: Vec2, normal: Vec3| -> usize {
            // Coordinates in which the area is uniform.
            let (u, v) = match shape {
                _ if shape.contains("disk") => (uv.x * uv.x, uv.y),
                _ if shape.contains("sphere") => (uv.x, 0.5 - 0.5 * (std::f32::consts::PI * uv.y).cos()),
                _ => (uv.x, uv.y),
            };
            let face = if shape.contains("cube") {
                let axis = normal.abs().max_position();
                2 * axis + usize::from(normal[axis] > 0.0)
            } else {
                0
            };
            let cell = |x: f32| ((x * 5.0) as usize).min(4);
            25 * face + 5 * cell(u) + cell(v)
        };
        let cells = if shape.contains("cube") { 150 } else { 25 };
        let draws = 30_000;
        let (mut places, mut directions) = (vec![0.0; cells], vec![0.0; 40]);
        let mut sampler = Sampler::new(2, 0, 0, 0);
        for _ in 0..draws {
            let light = scene.lights()[0].emitter().emit(scene.surfaces(), &mut sampler).expect("a photon");
            // Look back at where it came from.
            let back = Ray { origin: light.ray.origin, direction: -light.ray.direction };
            let mut bsdf = Bsdf::default();
            let Some(point) = scene.closest(&back, &mut bsdf) else { continue };
            if point.distance > 1e-2 {
                continue;
            }
            places[strata(point.surface.uv, point.surface.normal)] += 1.0;
            // Cosine-distributed: the squared cosine is uniform.
            let local = Frame::around(point.surface.normal).to_local(light.ray.direction);
            let around = f64::from(local.y.atan2(local.x)) / TAU + 0.5;
            let cos2 = f64::from(local.z * local.z);
            directions[((cos2 * 5.0) as usize).min(4) * 8 + ((around * 8.0) as usize).min(7)] += 1.0;
            assert!(local.z > 0.0, "{shape}: a photon leaves backwards {light:?} {point:?}");
        }
        let even = |cells: usize| vec![f64::from(draws) / cells as f64; cells];
        // Of the few photons that graze the surface, some are not found again by looking back.
        assert!(places.iter().sum::<f64>() > 0.999 * f64::from(draws));
        assert_distribution(shape, &places, &even(cells), f64::from(draws));
        assert_distribution(shape, &directions, &even(40), f64::from(draws));
    }
}

/// The photons of a light, by direction and by where they start in the plane across it.
fn emissions(light: &str, draws: u32) -> (Scene, Vec<(Ray, Spectrum)>) {
    // A small ball so that the world has an extent.
    let scene = with_lights(&format!("lights = [{light}]\nshapes = [{{ type = 'sphere', center = [1, 2, 3] }}]"));
    let mut sampler = Sampler::new(4, 0, 0, 0);
    let emitter = |scene: &Scene, sampler: &mut Sampler| scene.lights()[0].emitter().emit(scene.surfaces(), sampler);
    let all = (0..draws).filter_map(|_| emitter(&scene, &mut sampler)).map(|light| (light.ray, light.flux)).collect();
    (scene, all)
}

#[test]
fn photons_of_points_and_of_the_sky_go_in_all_directions() {
    for light in
        ["{ type = 'point', position = [1, 0, 0], intensity = 2 }", "{ type = 'constant', radiance = [1, 2, 3] }"]
    {
        let (_, all) = emissions(light, 50_000);
        let mut observed = vec![0.0; Z * AROUND];
        all.iter().for_each(|(ray, _)| observed[bin(ray.direction)] += 1.0);
        assert_distribution(light, &observed, &vec![50_000.0 * BIN / (2.0 * TAU); Z * AROUND], 50_000.0);
    }
}

/// They start evenly on a disk that hides the whole scene.
#[test]
fn photons_from_far_away_start_evenly_on_a_disk() {
    for light in ["{ type = 'directional', direction = [1, 2, -2] }", "{ type = 'constant' }"] {
        let (scene, all) = emissions(light, 50_000);
        let radius = f64::from(scene.bounds().radius()) * 1.001;
        let mut observed = vec![0.0; 60];
        for (ray, flux) in &all {
            let local = Frame::around(ray.direction).to_local(ray.origin - scene.bounds().center());
            assert!(f64::from(local.z) < -0.999 * radius, "outside the scene");
            let r2 = f64::from(local.x * local.x + local.y * local.y) / (radius * radius);
            let around = f64::from(local.y.atan2(local.x)) / TAU + 0.5;
            observed[((r2 * 6.0) as usize).min(5) * 10 + ((around * 10.0) as usize).min(9)] += 1.0;
            let solid_angle = if light.contains("constant") { 4.0 * PI } else { 1.0 };
            assert!((f64::from(flux.mean()) / (solid_angle * PI * radius * radius) - 1.0).abs() < 1e-4);
        }
        assert_distribution(light, &observed, &[50_000.0 / 60.0; 60], 50_000.0);
    }
}

/// By angle to the axis: the flux in each ring of the cone is the intensity times its solid angle; shadow rays see the
/// same intensity.
#[test]
fn a_spot_sends_the_flux_that_its_intensity_promises() {
    let light =
        "{ type = 'spot', position = [0, 0, 0], target = [1, 2, 2], intensity = 5, cutoff = 50, beam-width = 20 }";
    let (scene, all) = emissions(light, 100_000);
    let axis = Vec3::new(1.0, 2.0, 2.0) / 3.0;
    let Light::Spot(_) = &scene.lights()[0] else { panic!("a spot") };
    let falloff = |angle: f64| ((50.0 - angle) / 30.0).clamp(0.0, 1.0);
    let rings = 25;
    let mut flux: Vec<Vec<f64>> = vec![Vec::new(); rings];
    for (ray, watts) in &all {
        let angle = f64::from(axis.dot(ray.direction).clamp(-1.0, 1.0)).acos().to_degrees();
        let ring = ((angle / 2.0) as usize).min(rings - 1);
        for (index, sums) in flux.iter_mut().enumerate() {
            sums.push(if index == ring { f64::from(watts.mean()) } else { 0.0 });
        }
    }
    let mut power = 0.0;
    for (ring, flux) in flux.iter().enumerate() {
        let steps = 1000;
        let expected: f64 = (0..steps)
            .map(|step| 2.0 * (ring as f64 + (f64::from(step) + 0.5) / f64::from(steps)))
            .map(|angle| {
                5.0 * falloff(angle) * TAU * angle.to_radians().sin() * 2.0_f64.to_radians() / f64::from(steps)
            })
            .sum();
        power += expected;
        assert_mean(&format!("ring {ring}"), flux, expected, 1e-4, 1.0);
        let angle = (2.0 * ring as f32 + 1.0).to_radians();
        let aside = Frame::around(axis).to_world(Vec3::new(angle.sin(), 0.0, angle.cos()));
        let (_, light) = scene.illuminate(aside * 3.0, None, &mut Sampler::new(0, 0, 0, 0)).expect("light");
        let intensity = f64::from(light.irradiance.mean()) * 9.0;
        assert!((intensity / (5.0 * falloff(2.0 * ring as f64 + 1.0)) - 1.0).abs() < 1e-3, "ring {ring}");
    }
    assert!((f64::from(scene.power().mean()) / power - 1.0).abs() < 1e-4);
    let all: Vec<f64> = all.iter().map(|(_, watts)| f64::from(watts.mean())).collect();
    assert_mean("all rings", &all, power, 0.0, 0.02);
}

/// The sky is asked for all directions alike.
#[test]
fn shadow_rays_to_the_sky_go_in_all_directions() {
    let scene = with_lights("lights = [{ type = 'constant' }]");
    let mut sampler = Sampler::new(6, 0, 0, 0);
    let mut observed = vec![0.0; Z * AROUND];
    for _ in 0..50_000 {
        let (_, light) = scene.illuminate(Vec3::ZERO, None, &mut sampler).expect("light");
        assert!((light.pdf.expect("a density") * 2.0 * TAU as f32 - 1.0).abs() < 1e-5);
        observed[bin(light.to_light)] += 1.0;
    }
    assert_distribution("sky", &observed, &vec![50_000.0 * BIN / (2.0 * TAU); Z * AROUND], 50_000.0);
}

/// One of several lights is chosen with the probability that its light is divided by.
#[test]
fn with_several_lights_each_gets_its_due() {
    let scene = with_lights(
        "lights = [{ type = 'point', position = [0, 0, 1], intensity = 1 },
                   { type = 'point', position = [0, 2, 0], intensity = [9, 0, 0] },
                   { type = 'directional', direction = [1, 0, 0], irradiance = 0.1 }]
         shapes = [{ type = 'sphere', center = [20, 20, 20] }]",
    );
    let mut sampler = Sampler::new(7, 0, 0, 0);
    let mut sums = [vec![], vec![]];
    let mut photons = vec![];
    for _ in 0..100_000 {
        let [red, green, _] =
            scene.illuminate(Vec3::ZERO, None, &mut sampler).map_or([0.0; 3], |(_, l)| l.irradiance.to_rgb());
        sums[0].push(f64::from(red));
        sums[1].push(f64::from(green));
        photons.push(f64::from(scene.emit(&mut sampler).expect("a photon").1.flux.mean()));
    }
    assert_mean("red", &sums[0], 1.0 + 9.0 / 4.0 + 0.1, 0.0, 0.1);
    assert_mean("green", &sums[1], 1.0 + 0.1, 0.0, 0.1);
    assert_mean("flux", &photons, f64::from(scene.power().mean()), 0.0, 0.05);
}
