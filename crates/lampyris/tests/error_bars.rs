//! What a render says of its error is true: intervals cover the truth as often as they claim.

mod common;

use common::{Lit, lit};
use lampyris::film::{Layer, Layers};
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
    for settings in ["integrator=path samples=16", "integrator=light photons=2000 filter=tent"] {
        let share = coverage(settings, 12);
        assert!(share >= 0.93, "{settings}: {share}");
    }
}
