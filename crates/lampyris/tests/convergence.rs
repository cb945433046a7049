//! The mean squared error falls as theory says, down to nothing.

mod common;

use common::lit;
use lampyris::film::{Film, Layers};
use lampyris::integrator::{Pass, Silent, integrator};

/// Places on a plane, looked at from straight above, below a lamp at the height 1: 16 × 16 pixels of 0.125, each of
/// which samples its middle alone.
const SCENE: &str = "
    lights = [{ type = 'spot', position = [0, 1, 0], target = [0, 0, 0], intensity = 1, cutoff = 70, beam-width = 70 }]
    [camera]
    origin = [0, 3, 0]
    left = [-1, 0, 0]
    up = [0, 0, 1]
    forward = [0, -3, 0]
    [film]
    size = [16, 16]
    filter = { type = 'box', radius = 0.0001 }
    [[shapes]]
    type = 'quad'
    corner = [-3, 0, -3]
    u = [0, 0, 6]
    v = [6, 0, 0]
    material = { type = 'diffuse', reflectance = 1 }";

/// Radiance I h / (π d³) at each pixel.
fn exact(x: usize, y: usize) -> f64 {
    let middle = |index: usize| (index as f64 + 0.5) / 8.0 - 1.0;
    (middle(x).powi(2) + middle(y).powi(2) + 1.0).powf(-1.5) / std::f64::consts::PI
}

fn squared_error(film: &Film) -> f64 {
    let image = film.image();
    let off =
        |index: usize| (f64::from(image.pixel(index % 16, index / 16)[0]) - exact(index % 16, index / 16)).powi(2);
    (0..256).map(off).sum::<f64>() / 256.0
}

const SEEDS: u64 = 16;

/// Mean squared error after each of these numbers of passes, over 16 seeds.
fn errors(settings: &str, at: &[u32]) -> Vec<f64> {
    let mut sums = vec![0.0; at.len()];
    for seed in 0..SEEDS {
        let lit = lit(SCENE, settings);
        let (scene, film) = (&lit.scene, &lit.description.film);
        let way = integrator(scene, film, &lit.description.integrator, seed, &Silent);
        let mut picture = Film::new(film.size);
        for (sum, &passes) in sums.iter_mut().zip(at) {
            while picture.passes() < passes {
                let pass = Pass { index: picture.passes(), seed };
                picture.add_pass(&way.expose(scene, film, &pass, Layers::NONE, &Silent));
            }
            *sum += squared_error(&picture) / SEEDS as f64;
        }
    }
    sums
}

/// Least squares of log error over log passes.
fn slope(at: &[u32], errors: &[f64]) -> f64 {
    let points: Vec<(f64, f64)> = at.iter().zip(errors).map(|(&n, error)| (f64::from(n).ln(), error.ln())).collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / count, y + point.1 / count));
    points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// With α = 2/3 both variance and squared bias fall as N^(-2/3) [Knaus & Zwicker 2011]. Nine runs with other seeds gave
/// slopes of -0.655 ± 0.016 from 8 seeds each, so that 0.08 is six standard deviations of 16 seeds (2e-9).
#[test]
fn a_shrinking_radius_converges_at_the_rate_of_theory() {
    let at = [8, 16, 32, 64, 128, 256, 512, 1024];
    let settings = "photons=500 kernel=epanechnikov bandwidth=shrinking radius=0.4 direct=photons";
    let errors = errors(settings, &at);
    let all = slope(&at, &errors);
    assert!((all + 2.0 / 3.0).abs() < 0.08, "slope {all}: {errors:?}");
    // No floor: the end falls as well, where a fixed radius stays at -0.1. Known to 0.03.
    let last = slope(&at[4..], &errors[4..]);
    assert!(last < -0.5, "slope {last} at the end: {errors:?}");
}

/// A smaller α trades variance for bias: what falls slower decides. With 0.9 the squared bias falls as N^-0.2
/// (nine runs of 8 seeds: -0.18 ± 0.015).
#[test]
fn a_radius_that_shrinks_too_slowly_keeps_its_bias() {
    let at = [16, 64, 256, 1024];
    let errors = errors("photons=100 bandwidth=shrinking radius=0.9 alpha=0.9 direct=photons", &at);
    let slope = slope(&at[1..], &errors[1..]);
    assert!((slope + 0.2).abs() < 0.08, "slope {slope}: {errors:?}");
}

/// This is what the first test would see if there were a floor.
#[test]
fn a_fixed_radius_stops_at_its_bias() {
    let at = [16, 64, 256, 1024];
    let errors = errors("photons=500 bandwidth=fixed radius=0.4 direct=photons", &at);
    let slope = slope(&at[1..], &errors[1..]);
    assert!(slope > -0.4, "slope {slope}: {errors:?}");
}

/// Next-event estimation has no bias, so that its error falls as N^-1 or, where the numbers of a pixel's samples fill the
/// space of paths evenly and the integrand is smooth, faster: as N^-2.2 here.
#[test]
fn shadow_rays_converge_with_the_number_of_samples() {
    let at = [16, 64, 256, 1024];
    let sky = SCENE.replace(
        "type = 'spot', position = [0, 1, 0], target = [0, 0, 0], intensity = 1, cutoff = 70, beam-width = 70",
        "type = 'constant', radiance = 1",
    );
    let lit = lit(&sky, "integrator=path");
    let mut picture = Film::new([16, 16]);
    let way = integrator(&lit.scene, &lit.description.film, &lit.description.integrator, 0, &Silent);
    let errors: Vec<f64> = (at.iter())
        .map(|&passes| {
            while picture.passes() < passes {
                let pass = Pass { index: picture.passes(), seed: 0 };
                picture.add_pass(&way.expose(&lit.scene, &lit.description.film, &pass, Layers::NONE, &Silent));
            }
            let image = picture.image();
            image.pixels().iter().map(|pixel| (f64::from(pixel[0]) - 1.0).powi(2)).sum::<f64>() / 256.0
        })
        .collect();
    let slope = slope(&at, &errors);
    // Each error is known to √(2/256) = 9 %, the slope to 0.029.
    assert!(slope < -1.85, "slope {slope}: {errors:?}");
}
