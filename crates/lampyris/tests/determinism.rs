//! The same picture to the bit on any number of threads, in any order of passes, and in any unit of length.

mod common;

use common::{lit, on_threads};
use lampyris::film::Layers;
use lampyris::image::Image;
use lampyris::integrator::{Pass, Silent, integrator};

/// The course's box with all lengths times `scale`, and the power of its lamps by the square: a point, and a ball in the
/// glass one. Light is scattered by all kinds of things.
fn box_of_size(scale: f64) -> String {
    let v = |x: f64, y: f64, z: f64| format!("[{:?}, {:?}, {:?}]", x * scale, y * scale, z * scale);
    let quad = |corner: (f64, f64, f64), u: (f64, f64, f64), w: (f64, f64, f64), reflectance: &str| {
        let (corner, u, w) = (v(corner.0, corner.1, corner.2), v(u.0, u.1, u.2), v(w.0, w.1, w.2));
        format!(
            "[[shapes]]\ntype = 'quad'\ncorner = {corner}\nu = {u}\nv = {w}\nmaterial = {{ type = 'diffuse', reflectance = {reflectance} }}\n"
        )
    };
    let plane = |normal: &str| {
        format!(
            "[[shapes]]\ntype = 'plane'\nnormal = {normal}\ndistance = {scale:?}\nmaterial = {{ type = 'diffuse' }}\n"
        )
    };
    let ball = |radius: f64, center: String, material: &str| {
        let radius = radius * scale;
        format!("[[shapes]]\ntype = 'sphere'\ncenter = {center}\nradius = {radius:?}\nmaterial = {material}\n")
    };
    let lamp = ball(
        0.1,
        v(0.5, -0.7, -0.25),
        &format!("{{ type = 'diffuse' }}\nemission = {{ power = {:?} }}", 4.0 * scale * scale),
    );
    format!(
        "film = {{ size = [24, 24] }}
         lights = [{{ type = 'point', position = {light}, power = {power:?} }}]
         [camera]
         origin = {eye}
         left = {left}
         up = {up}
         forward = {forward}\n",
        light = v(0.0, 0.5, 0.0),
        power = 12.0 * scale * scale,
        eye = v(0.0, 0.0, -3.5),
        left = v(-1.0, 0.0, 0.0),
        up = v(0.0, 1.0, 0.0),
        forward = v(0.0, 0.0, 3.0),
    ) + &plane("[1, 0, 0]")
        + &plane("[-1, 0, 0]")
        + &plane("[0, 1, 0]")
        + &quad((-1.0, 1.0, -1.0), (2.0, 0.0, 0.0), (0.0, 0.0, 2.0), "[0.7, 0.6, 0.5]")
        + &quad((-1.0, -1.0, 1.0), (0.0, 2.0, 0.0), (2.0, 0.0, 0.0), "[0.2, 0.6, 0.5]")
        + &format!(
            "[[shapes]]\ntype = 'cube'\ntransform = [{{ scale = {:?} }}, {{ translate = {} }}]\n",
            0.1 * scale,
            v(0.2, 0.1, 0.3)
        )
        + &ball(0.3, v(-0.5, -0.7, 0.25), "{ type = 'plastic' }")
        + &ball(0.3, v(0.5, -0.7, -0.25), "{ type = 'glass' }")
        + &lamp
        + &ball(0.2, v(0.1, -0.8, -0.5), "{ type = 'glass', roughness = { alpha = 0.3 } }")
        + &ball(0.2, v(-0.4, 0.1, 0.4), "{ type = 'plastic', roughness = { alpha = 0.2 } }")
}

const WAYS: [&str; 7] = [
    "integrator=auto photons=10000",
    "integrator=path samples=2",
    "integrator=light photons=10000",
    "integrator=photon-map photons=10000",
    "integrator=photon-map photons=10000 bandwidth=nearest direct=photons kernel=gaussian",
    "integrator=photon-map photons=10000 show=photons",
    "integrator=photon-map photons=10000 show=caustics",
];

fn bits(image: &Image) -> Vec<u32> {
    image.pixels().iter().flatten().map(|value| value.to_bits()).collect()
}

#[test]
fn every_number_of_threads_gives_the_same_bits() {
    for way in WAYS {
        let lit = lit(&box_of_size(1.0), way);
        let one = on_threads(1, || bits(&lit.image(3)));
        assert!(one.iter().any(|&bits| bits != 0), "{way} sees something");
        for threads in [2, 5] {
            assert!(one == on_threads(threads, || bits(&lit.image(3))), "{way} on {threads} threads");
        }
    }
}

#[test]
fn passes_can_be_rendered_in_any_order_by_anyone() {
    for way in WAYS {
        let lit = lit(&box_of_size(1.0), way);
        let (film, seed) = (&lit.description.film, lit.description.render.seed);
        let make = || integrator(&lit.scene, film, &lit.description.integrator, seed, &Silent);
        let pass = |index| bits(&make().expose(&lit.scene, film, &Pass { index, seed }, Layers::NONE, &Silent).image);
        let straight: Vec<_> = lit.passes(3).iter().map(bits).collect();
        assert!(straight[2] == pass(2) && straight[0] == pass(0), "{way}");
        assert!(straight[0] != straight[1] || way.contains("show"), "{way}: passes differ");
    }
}

#[test]
fn another_seed_gives_another_picture() {
    let seen = |seed: u64| bits(&lit(&box_of_size(1.0), &format!("integrator=path seed={seed}")).image(1));
    assert_ne!(seen(0), seen(1));
}

/// A power of two changes exponents alone: the same picture to the bit, with the same settings, from a thousandth to a
/// thousandfold.
#[test]
fn a_scene_a_thousand_times_larger_or_smaller_gives_the_same_bits() {
    for way in WAYS {
        let seen = |scale: f64| bits(&lit(&box_of_size(scale), way).image(2));
        let same = seen(1.0);
        for scale in [1.0 / 1024.0, 1024.0] {
            assert!(same == seen(scale), "{way}, {scale}");
        }
    }
}

/// Σ |a - b| over Σ a.
fn difference(a: &Image, b: &Image) -> f64 {
    let pairs = || a.pixels().iter().flatten().zip(b.pixels().iter().flatten());
    let total: f64 = pairs().map(|(a, _)| f64::from(*a)).sum();
    pairs().map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / total
}

/// Other factors round differently, so that one path in some hundreds takes another turn. That is little beside what
/// other random numbers change.
#[test]
fn a_scene_in_millimetres_or_kilometres_gives_the_same_picture() {
    for way in WAYS {
        let seen = |scale: f64, seed: u32| lit(&box_of_size(scale), &format!("{way} seed={seed}")).image(2);
        let same = seen(1.0, 0);
        let chance = difference(&same, &seen(1.0, 1));
        for scale in [1e-3, 1e3] {
            let off = difference(&same, &seen(scale, 0));
            assert!(off < 0.05 && off < 0.2 * chance, "{way}, {scale}: {off} where chance makes {chance}");
        }
    }
}
