//! What other photon mappers get wrong, or got wrong for years, in scenes that show it at once. Which test finds which
//! defect is a table in docs/validation.md; those that are guarded elsewhere are not repeated here.
//!
//! Left out is what does not exist here yet: estimates in media that never shrink, and motion blur that photons miss.

mod common;

use std::f64::consts::PI;

use common::statistics::assert_mean;
use common::{Lit, lit};
use lampyris::photon::Kernel;

/// All light from photons, by their distance to a gather point.
const PHOTONS: &str = "integrator=photon-map direct=photons";

/// Sixteen places of a plane in parallel light, looked at from straight above: 3 × `scale` from the next edge or further,
/// half of that from each other. The irradiance of 3 does not depend on the unit of length, nor does the radiance.
fn plane(scale: f64) -> String {
    let half = 4.0 * scale;
    format!(
        "lights = [{{ type = 'directional', direction = [0, -1, 0], irradiance = 3 }}]
         film = {{ size = [4, 4], filter = {{ type = 'box', radius = 0.0001 }} }}
         [camera]
         origin = [0, {scale:?}, 0]
         left = [{0:?}, 0, 0]
         up = [0, 0, {scale:?}]
         forward = [0, {0:?}, 0]
         [[shapes]]
         type = 'quad'
         corner = [{1:?}, 0, {1:?}]
         u = [0, 0, {2:?}]
         v = [{2:?}, 0, 0]
         material = {{ type = 'diffuse', reflectance = 0.5 }}",
        -scale,
        -half,
        2.0 * half
    )
}

/// The k-th photon makes 11 % here, the textbook's Gaussian -47 %, and kernels of one dimension more than that, with every
/// unit of length another.
#[test]
fn a_plane_in_even_light_is_as_bright_as_it_should_be() {
    for kernel in Kernel::ALL {
        let kernel = format!("{kernel:?}").to_lowercase();
        for scale in [1e-3, 1.0, 1e3] {
            for bandwidth in ["nearest k=10".to_string(), format!("fixed radius={}", 0.5 * scale)] {
                let way = format!("{PHOTONS} photons=1000 kernel={kernel} bandwidth={bandwidth}");
                let means = &lit(&plane(scale), &way).means(300)[0];
                assert_mean(&format!("{way}, {scale}"), means, 0.5 * 3.0 / PI, 0.0, 0.06);
            }
        }
    }
}

/// A pixel that samples its middle alone, which is `target`.
fn point(origin: [f32; 3], target: [f32; 3], rest: &str, settings: &str) -> Lit {
    let text = format!(
        "camera = {{ origin = {origin:?}, target = {target:?}, up = [0.1, 0.2, 0.3], fov = 10 }}
         film = {{ size = [1, 1], filter = {{ type = 'box', radius = 0.0001 }} }}\n"
    );
    lit(&(text + rest), settings)
}

/// Two squares of one plane meet at x = 0. Who chooses the nearest photons among all, and then leaves out those of the
/// other square, finds half of the light; who leaves out the k-th of these alone, is wrong by less.
#[test]
fn the_nearest_photons_of_two_objects_count_for_both() {
    let squares = "lights = [{ type = 'directional', direction = [0, -1, 0], irradiance = 3 }]
        [[shapes]]
        type = 'quad'
        corner = [-2, 0, -2]
        u = [0, 0, 4]
        v = [2, 0, 0]
        material = { type = 'diffuse', reflectance = 0.8 }
        [[shapes]]
        type = 'quad'
        corner = [0, 0, -2]
        u = [0, 0, 4]
        v = [2, 0, 0]
        material = { type = 'diffuse', reflectance = 0.4 }";
    for (x, reflectance) in [(-1e-3, 0.8), (1e-3, 0.4)] {
        for kernel in ["box", "epanechnikov"] {
            let way = format!("{PHOTONS} photons=2000 kernel={kernel} bandwidth=nearest k=10");
            let means = &point([0.3, 2.0, 0.1], [x, 0.0, 0.0], squares, &way).means(1000)[0];
            assert_mean(&format!("{x}, {way}"), means, reflectance * 3.0 / PI, 0.0, 0.08);
        }
    }
}

/// A square wall at x = 0.
const WALL: &str = "
    [[shapes]]
    type = 'quad'
    corner = [0, -1, -1]
    u = [0, 2, 0]
    v = [0, 0, 2]
    material = { type = 'diffuse', reflectance = 0.5 }\n";

/// The light comes by a mirror, so that it is left to photons whoever else finds direct light.
#[test]
fn a_caustic_on_one_side_of_a_thin_wall_is_not_seen_on_the_other() {
    let scene = "
        lights = [{ type = 'spot', position = [-1, 0, 0], target = [-2, 0, 0], intensity = 1, cutoff = 30,
                    beam-width = 30 }]
        [[shapes]]
        type = 'quad'
        corner = [-2, -1, -1]
        u = [0, 2, 0]
        v = [0, 0, 2]
        material = { type = 'mirror' }"
        .to_string()
        + WALL;
    for way in [
        "integrator=photon-map photons=5000 bandwidth=nearest k=50",
        "integrator=photon-map photons=5000 bandwidth=nearest k=50 direct=photons",
        "integrator=photon-map photons=5000",
        "integrator=auto photons=5000",
    ] {
        let seen = |x: f32| point([x, 0.3, 0.2], [0.0; 3], &scene, way).means(8)[0].clone();
        let lit = seen(-0.5).iter().sum::<f64>() / 8.0;
        let expected = 0.5 / 9.0 / PI;
        assert!((lit / expected - 1.0).abs() < 0.3, "{way}: {lit} is not nearly {expected}");
        assert_eq!(seen(0.5), [0.0; 8], "{way}");
    }
}

/// The nearest photons lie on both sides. A radius that those of the other side cut short must not take their light away.
#[test]
fn each_side_of_a_thin_wall_has_its_own_light() {
    let lights = "lights = [{ type = 'directional', direction = [1, 0, 0], irradiance = 3 },
                            { type = 'directional', direction = [-1, 0, 0], irradiance = 1 }]"
        .to_string()
        + WALL;
    for (x, irradiance) in [(-1.0, 3.0), (1.0, 1.0)] {
        for bandwidth in ["nearest k=20", "fixed radius=0.4"] {
            let way = format!("{PHOTONS} photons=1000 bandwidth={bandwidth}");
            let means = &point([x, 0.1, 0.2], [0.0; 3], &lights, &way).means(2000)[0];
            assert_mean(&format!("{x}, {way}"), means, 0.5 * irradiance / PI, 0.0, 0.08);
        }
    }
}
