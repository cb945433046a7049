//! Light that fog scatters straight from a lamp, by shadow rays: without bias, and drawn as densely as it says.

mod common;

use std::f64::consts::PI;
use std::sync::Arc;

use common::lit;
use common::statistics::{assert_distribution, assert_mean, assert_same_mean};
use glam::{Affine3A, Vec3};
use lampyris::geometry::Ray;
use lampyris::light::Span;
use lampyris::medium::{Cloud, Depth, Fading, Grid, Matter, Phase, VolumeData};
use lampyris::sampler::Sampler;
use lampyris::spectrum::{Basis, Spectrum};
use lampyris::transport::{PathState, Segment, airlight};

const RAY: Ray = Ray { origin: Vec3::ZERO, direction: Vec3::Z };

/// What shadow rays to a segment of this length along +z bring in the first lane, many times.
fn estimates(scene: &str, length: f32, count: u64) -> Vec<f64> {
    let scene = lit(scene, "integrator=path").scene;
    let inside = scene.inside_at(RAY.origin);
    let matter = scene.matter(&inside, length.is_finite()).expect("a medium");
    let path = PathState { inside, ..PathState::new(RAY, Spectrum::ONE) };
    let of = |index: u64| {
        let mut sampler = Sampler::new(5, 0, 0, index);
        let found = airlight(&scene, &Segment { ray: RAY, length, matter }, &path, &mut sampler);
        found.map_or(0.0, |found| f64::from(found.light.to_rgb()[0]))
    };
    (0..count).map(of).collect()
}

const CAMERA: &str = "camera = { origin = [0, 0, 0], target = [0, 0, 1] }\n";

/// The anchors of light in fog: a lamp of 1 W beside a ray, σs = 0.8, σt = 1, h = 0.5, z0 = 1, as far as 3; and with
/// σt = σs / 10⁵, where the limit of none at all is (σs Φ / 16 π² h) (atan((3 − z0) / h) + atan(z0 / h)).
#[test]
fn a_lamp_beside_a_ray_shines_as_the_closed_form_says() {
    let scene = |scattering: f64, absorption: f64, power: f64| {
        let intensity = power / (4.0 * PI);
        format!(
            "{CAMERA}lights = [{{ type = 'point', position = [0, 0.5, 1], intensity = {intensity} }}]
            medium = 'fog'
            media = {{ fog = {{ type = 'homogeneous', sigma-s = {scattering}, sigma-a = {absorption} }} }}"
        )
    };
    assert_mean("fog", &estimates(&scene(0.8, 0.2, 1.0), 3.0, 20_000), 4.781_382e-3, 0.0, 0.01);
    let thin = 0.8 / (16.0 * PI * PI * 0.5) * ((2.0_f64 / 0.5).atan() + (1.0_f64 / 0.5).atan());
    assert!((thin - 2.465_110_3e-2).abs() < 1e-9, "{thin}");
    assert_mean("thin", &estimates(&scene(0.8e-5, 0.0, 1e5), 3.0, 20_000), thin, 1e-4 * thin, 0.01);
}

/// A cone and a cylinder of light across a ray, through which nothing else comes: against the closed forms of short ways.
#[test]
fn a_beam_and_a_spot_light_their_part_of_a_ray() {
    let fog = "medium = 'fog'\nmedia = { fog = { type = 'homogeneous', sigma-s = 0.3, sigma-a = 0.1 } }\n";
    // Across the ray at z = 2, from 1 away: 0.5 wide, of irradiance 1/(π r²).
    let beam = format!(
        "{CAMERA}{fog}lights = [{{ type = 'beam', position = [0, 1, 2], direction = [0, -1, 0], radius = 0.25, power = 1 }}]"
    );
    let irradiance = 1.0 / (PI * 0.0625);
    let integral = |from: f64, to: f64, value: &dyn Fn(f64) -> f64| {
        let (pieces, step) = (20_000, (to - from) / 20_000.0);
        (0..pieces).map(|i| value(from + (f64::from(i) + 0.5) * step) * step).sum::<f64>()
    };
    let expected = integral(1.75, 2.25, &|t| 0.3 / (4.0 * PI) * (-0.4 * (t + 1.0)).exp() * irradiance);
    assert_mean("beam", &estimates(&beam, 5.0, 20_000), expected, 0.0, 0.01);
    // A spot 1 above, whose edge meets the ray at tan 30° to either side.
    let spot = format!(
        "{CAMERA}{fog}lights = [{{ type = 'spot', position = [0, 1, 2], target = [0, 0, 2], intensity = 1, cutoff = 30, beam-width = 30 }}]"
    );
    let half = 1.0 / 3.0_f64.sqrt();
    let expected = integral(2.0 - half, 2.0 + half, &|t| {
        let d2 = 1.0 + (t - 2.0).powi(2);
        0.3 / (4.0 * PI) * (-0.4 * (t + d2.sqrt())).exp() / d2
    });
    assert_mean("spot", &estimates(&spot, f32::INFINITY, 20_000), expected, 0.0, 0.01);
}

/// By path tracing, which flies to a particle by chance, with lamps of every kind, colours, and a cloud.
#[test]
fn shadow_rays_to_segments_agree_with_flights_to_particles() {
    for (name, lights) in [
        ("ball", "[[shapes]]\ntype = 'sphere'\ncenter = [0.3, 0.6, 0.4]\nradius = 0.2\nemission = { radiance = 3 }\n"),
        (
            "square",
            "[[shapes]]\ntype = 'quad'\ncorner = [-0.5, 0.8, 0]\nu = [1, 0, 0]\nv = [0, 0, 1]\nemission = { radiance = 3 }\n",
        ),
        ("sun", "[[lights]]\ntype = 'directional'\ndirection = [0.2, -1, 0.4]\nirradiance = 2\n"),
        ("sky", "[[lights]]\ntype = 'constant'\nradiance = 1\n"),
        (
            "several",
            "[[lights]]\ntype = 'point'\nposition = [0.3, 0.5, 0.2]\nintensity = 0.2\n[[lights]]\ntype = 'spot'\nposition = [0, 3, 0]\ntarget = [0, 0, 0]\nintensity = 5\ncutoff = 12\n",
        ),
    ] {
        let scene = format!(
            "camera = {{ origin = [0, 0, -5], target = [0, 0, 0], fov = 25 }}
            film = {{ size = [4, 4] }}
            media = {{ fog = {{ type = 'homogeneous', sigma-s = [0.3, 0.6, 2], sigma-a = [0.2, 0.1, 0], phase = {{ type = 'henyey-greenstein', g = 0.4 }} }} }}
            [[shapes]]
            type = 'cube'
            interior = 'fog'
            {lights}"
        );
        let path = lit(&scene, "integrator=path samples=64 max-bounces=1").means(40);
        let auto = lit(&scene, "integrator=auto samples=16 photons=4000 max-bounces=1").means(40);
        for (lane, (path, auto)) in path.iter().zip(&auto).enumerate() {
            assert_same_mean(&format!("{name}, lane {lane}"), path, auto, 15, 0.01);
        }
    }
}

fn matter<'m>(extinction: [f32; 3], cloud: Option<&'m Cloud>) -> Matter<'m> {
    let extinction = Spectrum::from_rgb(extinction);
    Matter {
        id: 0,
        extinction,
        scattering: extinction,
        phase: &Phase::Isotropic,
        cloud,
        basis: &Basis::Rgb,
        delay: 0.0,
    }
}

/// Distances by both densities, in even fog of one and of several colours, and in a cloud.
#[test]
fn distances_are_drawn_with_the_density_that_is_claimed() {
    let values = vec![0.0, 5.0, 1.0, 3.0];
    let data = VolumeData { size: [1, 1, 4], channels: 1, bounds: [[0.0; 3], [1.0; 3]], values };
    let to_unit =
        Affine3A::from_scale(Vec3::new(0.5, 0.5, 0.25)) * Affine3A::from_translation(Vec3::new(1.0, 1.0, -0.5));
    let cloud = Cloud::new(Grid::new(Arc::new(data), to_unit, false), None);
    let (carried, ends) = (Spectrum::from_rgb([1.0, 0.5, 2.0]), [0.2_f32, 4.0]);
    let mut sampler = Sampler::new(3, 0, 0, 0);
    let fadings = [
        ("grey", matter([0.7; 3], None).fading(&RAY, 4.0, &mut sampler)),
        ("colours", matter([0.1, 1.0, 6.0], None).fading(&RAY, 4.0, &mut sampler)),
        ("cloud", matter([1.0; 3], Some(&cloud)).fading(&RAY, 4.0, &mut sampler)),
    ];
    assert!(matches!(fadings[2].1, Fading::Steps(..)));
    let span = Span { from: ends[0], to: ends[1], center: Some((Vec3::new(0.1, 0.3, 1.2), 0.1)) };
    let lamp = span.equiangular(&RAY).expect("it has a center");
    check("lamp", ends, &mut sampler, |u| lamp.sample(u), |at| lamp.pdf(at));
    for (name, fading) in &fadings {
        let depth = Depth::new(fading, carried, ends).expect("there is fog");
        check(name, ends, &mut sampler, |u| depth.sample(u), |at| depth.pdf(at));
    }
    // Without an end, as far as can be seen.
    let depth = Depth::new(&fadings[0].1, carried, [0.0, f32::INFINITY]).expect("there is fog");
    check("no end", [0.0, 40.0], &mut sampler, |u| depth.sample(u), |at| depth.pdf(at));
}

fn check(
    name: &str,
    [from, to]: [f32; 2],
    sampler: &mut Sampler,
    sample: impl Fn(f32) -> f32,
    pdf: impl Fn(f32) -> f32,
) {
    const CELLS: usize = 50;
    const DRAWS: u32 = 100_000;
    let width = f64::from(to - from) / CELLS as f64;
    let mut observed = vec![0.0; CELLS];
    for _ in 0..DRAWS {
        let at = sample(sampler.uniform());
        assert!(at >= from && at.is_finite(), "{name}: {at}");
        let cell = (f64::from(at - from) / width) as usize;
        if let Some(count) = observed.get_mut(cell) {
            *count += 1.0;
        } else if at <= to {
            observed[CELLS - 1] += 1.0;
        }
    }
    let value = |cell: usize, piece: u32| {
        f64::from(pdf((f64::from(from) + (cell as f64 + (f64::from(piece) + 0.5) / 4000.0) * width) as f32))
    };
    let expected: Vec<f64> = (0..CELLS)
        .map(|cell| f64::from(DRAWS) * width * (0..4000).map(|piece| value(cell, piece)).sum::<f64>() / 4000.0)
        .collect();
    assert_distribution(name, &observed, &expected, f64::from(DRAWS));
}
