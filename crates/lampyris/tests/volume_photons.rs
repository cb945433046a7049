//! Photons in media: beams, points and balls against the closed form of light in fog, against path tracing, and their rates.

mod common;

use std::f64::consts::PI;

use common::lit;
use common::rates::{self, slope};
use common::statistics::{assert_mean, assert_same_mean};

/// Eight parallel rays along +z at steps of 0.2, between a lamp's place and each other's.
const SCENE: &str = "
    camera = { origin = [0, 0, 0], target = [0, 0, 1], projection = 'orthographic', width = 1.6 }
    film = { size = [8, 1], filter = { type = 'box', radius = 0.0001 } }
    lights = [{ type = 'point', position = [0, 0.5, 1], intensity = 1 }]
    medium = 'fog'
    media = { fog = { type = 'homogeneous', sigma-t = 1, albedo = 0.8 } }\n";

/// Light that has been scattered once, on the ray of a pixel.
fn exact(x: usize) -> f64 {
    let h2 = 0.25 + (0.2 * (x as f64 + 0.5) - 0.8).powi(2);
    let (pieces, step) = (40_000, 30.0 / 40_000.0);
    let value = |t: f64| {
        let d2 = h2 + (t - 1.0).powi(2);
        0.2 / PI * (-(t + d2.sqrt())).exp() / d2
    };
    let piece = |i: i32| {
        let t = f64::from(i) * step;
        (value(t) + 4.0 * value(t + 0.5 * step) + value(t + step)) / 6.0 * step
    };
    (0..pieces).map(piece).sum()
}

/// The bias of a small radius is known from its square: 10 % at 0.6 of the distance from the lamp, so 0.3 % at 0.1.
#[test]
fn photons_of_every_kind_shine_as_the_closed_form_says_with_every_kernel() {
    let expected = (0..8).map(exact).sum::<f64>() / 8.0;
    for (kind, radius, photons) in [("beams", 0.05, 800), ("points", 0.06, 5000), ("balls", 0.1, 10_000)] {
        for kernel in ["box", "cone", "gaussian", "epanechnikov", "biweight", "cosine"] {
            let settings = format!(
                "integrator=photon-map volume={kind} kernel={kernel} bandwidth=fixed radius=1 volume-radius={radius} \
                 photons={photons} max-bounces=1 samples=4"
            );
            let [values, ..] = lit(SCENE, &settings).means(80);
            assert_mean(&format!("{kind}, {kernel}"), &values, expected, 0.01 * expected, 0.15);
        }
    }
}

/// The path traced picture and that of photons, of a cube of coloured fog, lit from outside through its border, with a ball
/// of glass, a ball of clear glass and a floor in it.
#[test]
fn photons_and_paths_agree_in_coloured_fog_with_surfaces() {
    let scene = "
        camera = { origin = [0, 0, -5], target = [0, 0, 0], fov = 40 }
        film = { size = [6, 6] }
        lights = [{ type = 'spot', position = [0.3, 3, -0.3], target = [0.3, 0, -0.3], intensity = 20, cutoff = 25, beam-width = 20 }]
        media = { fog = { type = 'homogeneous', sigma-s = [0.3, 0.6, 1], sigma-a = [0.2, 0.1, 0], phase = { type = 'henyey-greenstein', g = 0.4 } } }
        [[shapes]]
        type = 'cube'
        interior = 'fog'
        [[shapes]]
        type = 'quad'
        corner = [-3, -0.9, -3]
        u = [0, 0, 6]
        v = [6, 0, 0]
        material = { type = 'diffuse', reflectance = [0.8, 0.5, 0.2] }\n";
    let path = lit(scene, "integrator=path samples=32").means(40);
    for (settings, bias) in [
        (
            "integrator=photon-map bandwidth=fixed radius=0.1 volume=beams volume-radius=0.03 photons=20000 samples=4",
            0.015,
        ),
        (
            "integrator=photon-map bandwidth=fixed radius=0.1 volume=points volume-radius=0.06 photons=20000 samples=4",
            0.015,
        ),
        (
            "integrator=photon-map bandwidth=fixed radius=0.1 volume=balls volume-radius=0.1 photons=20000 samples=16",
            0.02,
        ),
        ("integrator=auto photons=20000 volume=beams volume-radius=0.03 samples=4", 0.015),
        ("integrator=auto photons=20000 samples=4", 0.03),
        ("integrator=light photons=40000", 0.0),
    ] {
        let photons = lit(scene, settings).means(40);
        for (channel, (a, b)) in path.iter().zip(&photons).enumerate() {
            assert_same_mean(&format!("{settings}, channel {channel}"), a, b, 18, bias);
        }
    }
}

/// A furnace of fog that absorbs nothing is 1 whoever looks.
#[test]
fn fog_that_absorbs_nothing_is_invisible_in_a_furnace_of_photons() {
    let scene = "
        camera = { origin = [0, 0, -4], target = [0, 0, 0], fov = 10 }
        film = { size = [4, 4] }
        lights = [{ type = 'constant', radiance = 1 }]
        media = { milk = { type = 'homogeneous', sigma-t = 1.5, albedo = 1 } }
        [[shapes]]
        type = 'sphere'
        interior = 'milk'\n";
    for settings in [
        "integrator=photon-map volume=beams volume-radius=0.05 bandwidth=fixed radius=1 photons=10000",
        "integrator=photon-map volume=points volume-radius=0.08 bandwidth=fixed radius=1 photons=20000",
        "integrator=auto photons=10000",
    ] {
        for values in lit(scene, settings).means(40) {
            // The kernel loses light only where it hangs over the ends of the ray.
            assert_mean(settings, &values, 1.0, 0.03, 0.25);
        }
    }
}

/// Mean squared error after each of these numbers of passes, over 48 seeds and all pixels.
fn errors(settings: &str, at: &[u32]) -> Vec<f64> {
    let expected: Vec<f64> = (0..8).map(exact).collect();
    rates::errors(&lit(SCENE, settings), 48, at, |image| {
        let off = |x: usize| (f64::from(image.pixel(x, 0)[0]) - expected[x]).powi(2);
        (0..8).map(off).sum::<f64>() / 8.0
    })
}

/// Each error is known to √(2 / (8 × 48)) = 7 %, so the slope over six doublings to 0.02 where the errors are independent
/// (they share passes, which makes it better): 0.1 is five standard deviations, odds 4e-7.
#[test]
fn every_kind_of_photons_converges_at_the_rate_of_its_dimension() {
    let at = [8, 16, 32, 64, 128, 256, 512];
    for (kind, radius, rate) in [("beams", 0.5, 4.0 / 5.0), ("points", 0.5, 2.0 / 3.0), ("balls", 0.6, 4.0 / 7.0)] {
        let settings =
            format!("integrator=photon-map volume={kind} volume-radius={radius} radius=1 photons=200 max-bounces=1");
        let errors = errors(&settings, &at);
        let slope = slope(&at, &errors);
        assert!((slope + rate).abs() < 0.1, "{kind}: slope {slope}: {errors:?}");
    }
}
