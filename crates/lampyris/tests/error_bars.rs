//! What a render says of its error is true: intervals cover the truth as often as they claim.

mod common;

use common::{Lit, lit};
use lampyris::film::{Bias, Layer, Layers};
use lampyris::integrator::Silent;
use lampyris::render::Render;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Inside a sphere of albedo ½ with a point light of intensity π in its middle, whose radiance is 1 everywhere.
fn sphere(settings: &str) -> Lit {
    let text = "film = { size = [4, 4] }
         camera = { origin = [0.3, 0.2, -0.4], target = [0.5, -0.6, 2], fov = 80 }
         lights = [{ type = 'point', position = [0, 0, 0], intensity = 3.14159265 }]
         shapes = [{ type = 'sphere', flip-normal = true, material = { type = 'diffuse', reflectance = 0.5 } }]";
    lit(text, settings)
}

const RUNS: u32 = 200;

/// The share of 95 % intervals, of all pixels in renders with different seeds, that hold 1.
fn coverage(settings: &str, passes: u32) -> f64 {
    let t = StudentsT::new(0.0, 1.0, f64::from(passes - 1)).expect("freedom").inverse_cdf(0.975);
    let mut lit = sphere(settings);
    let (mut covered, mut all) = (0, 0);
    for seed in 0..u64::from(RUNS) {
        lit.description.render.seed = seed;
        let mut render = Render::with_layers(&lit.scene, &lit.description, Layers::NONE.with(Layer::Variance), &Silent);
        (0..passes).for_each(|_| render.step(&Silent));
        let film = render.film();
        let variances = film.layer(Layer::Variance).expect("more than one pass");
        for (pixel, variance) in film.image().pixels().iter().zip(variances.pixels()) {
            let (off, error) = ((f64::from(pixel[0]) - 1.0).abs(), f64::from(variance[0]).sqrt());
            assert!(error > 1e-4 && error < 0.2, "{settings}: {error}");
            covered += u32::from(off <= t * error);
            all += 1;
        }
    }
    f64::from(covered) / f64::from(all)
}

/// Of 3200 intervals, 95 % ± 2 % is more than five standard deviations (false alarm 2e-7, and seeds are fixed). Pixels of a
/// picture share paths, and with a larger radius they would share photons.
#[test]
fn intervals_cover_the_truth_in_ninety_five_of_a_hundred_renders() {
    for settings in [
        "integrator=light photons=2000",
        "integrator=photon-map photons=2000 direct=photons bandwidth=fixed radius=0.15 kernel=box",
    ] {
        let share = coverage(settings, 12);
        assert!((0.93..=0.97).contains(&share), "{settings}: {share}");
    }
}

/// Camera paths of later passes fill the gaps between those of earlier ones, so that intervals are wider than they must be:
/// with a wide filter those of light tracing, too, as what pixels are divided by comes from camera paths.
#[test]
fn intervals_of_camera_paths_cover_the_truth_at_least_as_often() {
    for settings in [
        "integrator=path samples=16",
        "integrator=light photons=2000 filter=tent",
        "integrator=auto photons=2000 samples=16",
    ] {
        let share = coverage(settings, 12);
        assert!(share >= 0.93, "{settings}: {share}");
    }
}

/// A spot of the plane below a lamp at the height 1, where the box kernel is wrong by a known factor.
const PLANE: &str = "
    lights = [{ type = 'spot', position = [0, 1, 0], target = [0, 0, 0], intensity = 1, cutoff = 70, beam-width = 70 }]
    film = { size = [4, 4] }
    [camera]
    origin = [0, 3, 0]
    left = [-0.01, 0, 0]
    up = [0, 0, 0.01]
    forward = [0, -3, 0]
    [[shapes]]
    type = 'quad'
    corner = [-3, 0, -3]
    u = [0, 0, 6]
    v = [6, 0, 0]
    material = { type = 'diffuse', reflectance = 1 }";

/// What so many renders with different seeds tell of their bias.
fn biases(mut lit: Lit, runs: u64, passes: u32) -> Vec<Bias> {
    let one = |seed| {
        lit.description.render.seed = seed;
        let mut render = Render::new(&lit.scene, &lit.description, &Silent);
        (0..passes).for_each(|_| render.step(&Silent));
        render.film().bias().expect("the radius shrinks")
    };
    (0..runs).map(one).collect()
}

/// Mean and standard error of the mean square of the bias.
fn mean_square(biases: &[Bias]) -> (f64, f64) {
    let count = biases.len() as f64;
    let mean = biases.iter().map(|bias| bias.square).sum::<f64>() / count;
    let variance = biases.iter().map(|bias| (bias.square - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

/// The box kernel gives 2/x (1 - 1/√(1 + x)) of the truth, with x = r²/h². A line knows the term in x alone: drawn through these
/// very numbers, the mean square comes out as 0.778 of what it is. Five standard errors are allowed (one in 2e6).
#[test]
fn the_bias_that_is_told_is_that_below_a_lamp() {
    let (passes, x) = (32, 0.25);
    let settings = "integrator=photon-map photons=10000 direct=photons kernel=box radius=0.5";
    let mut area = 1.0;
    let mut exact = 0.0;
    for pass in 0..passes {
        let x = x * area;
        exact += (1.0 - 2.0 / x * (1.0 - 1.0 / (1.0_f64 + x).sqrt())) / f64::from(passes);
        area *= (f64::from(pass + 1) + 2.0 / 3.0) / (f64::from(pass + 1) + 1.0);
    }
    // The picture by whose mean it is told is darker by the bias itself.
    let exact = (exact / (1.0 - exact)).powi(2);
    let all = biases(lit(PLANE, settings), 48, passes);
    let (mean, error) = mean_square(&all);
    assert!(error < 0.2 * exact, "{error} of {exact}");
    assert!((mean - 0.778 * exact).abs() < 5.0 * error, "{mean} ± {error} is not 0.778 of {exact}");
    // Of 48 intervals that hold the truth in 90 % or more, 33 are five standard deviations away.
    let covered = all.iter().filter(|bias| (bias.square - exact).abs() <= 2.4 * bias.error_of_square).count();
    assert!(covered >= 33, "{covered} of 48");
}

/// A cap of a sphere has the area of the disk whose radius is its chord, so that nothing is wrong there on average.
#[test]
fn no_bias_is_told_where_there_is_none() {
    let settings = "integrator=photon-map photons=2000 direct=photons kernel=box radius=0.3";
    let (mean, error) = mean_square(&biases(sphere(settings), 32, 32));
    assert!(error < 0.02_f64.powi(2), "{error}");
    assert!(mean.abs() < 5.0 * error, "{mean} ± {error}");
}
