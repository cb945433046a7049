//! Furnaces: where light comes from everywhere alike, the exact answer is known however complicated the scene.

mod common;

use common::statistics::assert_mean;
use common::{Lit, lit};
use glam::Vec3;
use lampyris::math::fresnel;

/// Every way to compute light, with settings under which the kernel has no bias in a furnace: there the irradiance is
/// the same all over a surface, and no edge is within reach.
const ALL: [&str; 5] = [
    "integrator=path samples=32",
    "integrator=light photons=20000",
    "integrator=photon-map photons=10000 bandwidth=fixed radius=0.3 direct=next-event samples=32",
    "integrator=photon-map photons=20000 bandwidth=nearest k=400 radius=0.5 direct=photons samples=16",
    "integrator=auto photons=10000 radius=1 samples=32",
];

/// Those that see through glass and into mirrors.
const ALL_BUT_LIGHT: [&str; 4] = [ALL[0], ALL[2], ALL[3], ALL[4]];

/// The same for balls seen from outside. There the gather point's horizon hides some of the light that its neighbours
/// get, a share of r²/8 where the sky is bright all around: 0.2 % for this radius on a ball of radius 1.
const ON_BALLS: [&str; 4] = [
    ALL[0],
    ALL[2],
    "integrator=photon-map photons=20000 bandwidth=fixed radius=0.125 direct=photons samples=4",
    "integrator=auto photons=10000 radius=0.5 samples=32",
];
const HIDDEN: f64 = 0.002;

/// Asserts that the mean over the picture is `expected` in each channel, in all these ways.
#[track_caller]
fn assert_radiance(name: &str, text: &str, ways: &[&str], expected: [f64; 3], power: f64) {
    assert_nearly(name, text, ways, expected, 0.0, power);
}

/// The same up to a known `bias`.
#[track_caller]
fn assert_nearly(name: &str, text: &str, ways: &[&str], expected: [f64; 3], bias: f64, power: f64) {
    for way in ways {
        let means = lit(text, way).means(50);
        for (values, expected) in means.iter().zip(expected) {
            assert_mean(&format!("{name}, {way}"), values, expected, bias, power);
        }
    }
}

const INSIDE_VIEW: &str = "
    camera = { origin = [0.2, 0.1, -0.3], target = [0.3, 0.2, 1], fov = 60 }
    film = { size = [8, 8] }\n";

#[test]
fn a_glowing_sphere_of_albedo_a_shines_with_le_over_one_minus_a() {
    let text = INSIDE_VIEW.to_string()
        + "[[shapes]]
           type = 'sphere'
           flip-normal = true
           emission = { radiance = [1, 2, 0.5] }
           material = { type = 'diffuse', reflectance = [0.5, 0.25, 0.8] }";
    assert_radiance("sphere", &text, &ALL, [2.0, 2.0 / 0.75, 2.5], 0.05);
}

/// Lit from inside by itself, however its normal points.
#[test]
fn a_sphere_that_glows_on_both_sides_shines_as_one_that_glows_inside() {
    let text = INSIDE_VIEW.to_string()
        + "[[shapes]]
           type = 'sphere'
           emission = { radiance = 'same', scale = 2, two-sided = true }
           material = { type = 'diffuse', reflectance = 0.5 }
           [textures.same]
           type = 'mix'
           weight = 0.25
           first = 0.2
           second = 1.4";
    assert_radiance("two-sided sphere", &text, &ALL, [2.0; 3], 0.05);
}

/// A box has corners, near which kernels lose light: look at the middle of a wall alone.
#[test]
fn a_glowing_box_of_albedo_a_shines_with_le_over_one_minus_a() {
    let text = "camera = { origin = [0.2, 0.1, -0.3], target = [0.1, 0.2, 1], fov = 30 }
        film = { size = [8, 8] }
        [[shapes]]
        type = 'cube'
        flip-normal = true
        emission = { radiance = 1 }
        material = { type = 'diffuse', reflectance = 0.6 }";
    assert_radiance("box", text, &ALL, [2.5; 3], 0.06);
}

/// pbrt-v4's own analytic scene.
#[test]
fn a_point_of_intensity_pi_in_a_sphere_of_albedo_one_half_gives_one() {
    let text = INSIDE_VIEW.to_string()
        + "lights = [{ type = 'point', position = [0, 0, 0], intensity = 3.14159265 }]
           [[shapes]]
           type = 'sphere'
           material = { type = 'diffuse', reflectance = 0.5 }";
    assert_radiance("sphere", &text, &ALL, [1.0; 3], 0.05);
}

/// Things around the origin under a sky of radiance 1, filling about half of the picture.
fn under_the_sky(shapes: &str) -> String {
    "camera = { origin = [0, 1, -4], target = [0, 0, 0], fov = 40 }
     film = { size = [16, 16] }
     lights = [{ type = 'constant', radiance = 1 }]\n"
        .to_string()
        + shapes
}

fn ball(material: &str) -> String {
    under_the_sky(&format!("[[shapes]]\ntype = 'sphere'\nmaterial = {material}"))
}

#[test]
fn what_absorbs_nothing_and_is_smooth_vanishes_to_the_last_digits() {
    for material in [
        "{ type = 'mirror' }",
        "{ type = 'glass', ior = 1.5 }",
        "{ type = 'glass', ior = 2.4 }",
        "{ type = 'glass', ior = 1, exterior-ior = 1.4 }",
        "{ type = 'thin-glass', ior = 1.7 }",
        "{ type = 'coefficients', kt = 1 }",
        "{ type = 'coefficients', kt = 1, fresnel = false }",
        "{ type = 'coefficients', ks = 0.3, kt = 0.7 }",
        "{ type = 'blend', weight = 0.3, first = { type = 'glass' }, second = { type = 'mirror' } }",
        "{ type = 'mask', opacity = 0.3, material = { type = 'mirror' } }",
        "{ type = 'two-sided', front = { type = 'mirror' } }",
    ] {
        // No path can be absorbed, so that every pixel is 1 but for rounding; about one path in 10⁵ gets lost where it
        // touches the rim of a sphere in less than rounding.
        for way in ALL_BUT_LIGHT {
            let image = lit(&ball(material), way).image(4);
            let wrong = image.pixels().iter().flatten().filter(|&&value| (value - 1.0).abs() > 1e-4).count();
            assert_eq!(wrong, 0, "{material}, {way}");
        }
    }
}

#[test]
fn what_absorbs_nothing_and_is_diffuse_vanishes() {
    for material in [
        "{ type = 'diffuse', reflectance = 1 }",
        "{ type = 'plastic', reflectance = 1 }",
        "{ type = 'plastic', reflectance = 1, ior = 1.9, nonlinear = true }",
        "{ type = 'coefficients', kd = 0.4, ks = 0.1, kt = 0.5 }",
        "{ type = 'coefficients', kd = 0.5, ks = 0.2, kt = 0.3, fresnel = false }",
        "{ type = 'blend', weight = 0.3, first = { type = 'diffuse', reflectance = 1 }, second = { type = 'glass' } }",
        "{ type = 'mask', opacity = 0.6, material = { type = 'diffuse', reflectance = 1 } }",
        "{ type = 'two-sided', front = { type = 'plastic', reflectance = 1 } }",
    ] {
        assert_nearly(material, &ball(material), &ON_BALLS, [1.0; 3], HIDDEN, 0.03);
    }
    let diffuse = ball("{ type = 'diffuse', reflectance = 1 }");
    assert_radiance("diffuse", &diffuse, &["integrator=light photons=20000"], [1.0; 3], 0.06);
}

/// To within what the tables of their lost light are exact, and the horizon hides.
#[test]
fn what_absorbs_nothing_and_is_rough_vanishes() {
    for material in [
        "{ type = 'conductor', eta = 0, k = 1, roughness = { alpha = 0.5, multiple-scattering = true } }",
        "{ type = 'glass', roughness = { alpha = 0.4, multiple-scattering = true } }",
        "{ type = 'plastic', reflectance = 1, roughness = { alpha = 0.3, multiple-scattering = true } }",
        "{ type = 'diffuse-transmission', reflectance = 0.4, transmittance = 0.6 }",
        "{ type = 'mask', opacity = 0.5, material = { type = 'glass', ior = 1.3,
           roughness = { alpha = 0.8, multiple-scattering = true } } }",
    ] {
        assert_nearly(material, &ball(&material.replace('\n', " ")), &ON_BALLS, [1.0; 3], 0.007, 0.05);
    }
}

/// A rough boundary multiplies radiance by the square of the index, and divides it by that on the way out.
#[test]
fn inside_rough_glass_radiance_is_larger_by_the_square_of_the_index() {
    let text = "camera = { origin = [0.3, 0.2, 0], target = [0, 0, 5], fov = 120 }
        film = { size = [8, 8] }
        lights = [{ type = 'constant', radiance = 1 }]
        [[shapes]]
        type = 'sphere'
        material = { type = 'glass', ior = 1.6, roughness = { alpha = 0.3, multiple-scattering = true } }";
    // Photons are few at each place of the ball.
    assert_nearly("rough glass", text, &ON_BALLS[..1], [2.56; 3], 0.02, 0.05);
    assert_nearly("rough glass", text, &ON_BALLS[2..], [2.56; 3], 0.02, 0.15);
}

#[test]
fn all_kinds_of_things_together_vanish() {
    let mut shapes = String::new();
    for (at, material) in [
        ("-1, 0, 0", "{ type = 'glass' }"),
        ("0.1, 0, 0", "{ type = 'diffuse', reflectance = 1 }"),
        ("1.2, 0, 0.2", "{ type = 'plastic', reflectance = 1 }"),
        ("-0.5, 1, 0.4", "{ type = 'mirror' }"),
        ("0.6, 0.9, -0.4", "{ type = 'coefficients', kd = 0.3, ks = 0.3, kt = 0.4 }"),
        ("-1, 0, 0", "{ type = 'diffuse', reflectance = 1 }"),
    ] {
        // The last ball sits in the glass one, half as large.
        let radius = if shapes.contains(at) { 0.25 } else { 0.5 };
        shapes += &format!("[[shapes]]\ntype = 'sphere'\ncenter = [{at}]\nradius = {radius}\nmaterial = {material}\n");
    }
    // On the smallest ball the horizon hides (0.06 / 0.25)² / 8 = 0.7 %; it covers a tenth of the picture.
    let ways = ON_BALLS.map(|way| way.replace("radius=0.125", "radius=0.06").replace("radius=0.3", "radius=0.06"));
    let ways = ways.each_ref().map(String::as_str);
    assert_nearly("mixed", &under_the_sky(&shapes), &ways, [1.0; 3], HIDDEN, 0.04);
}

/// A wall that fills the picture, seen under the angle whose cosine is `cos`, so narrowly that it does not vary.
fn wall(cos: f32, material: &str) -> String {
    let origin = Vec3::new(3.0 * (1.0 - cos * cos).sqrt(), 3.0 * cos, 0.0).to_array();
    format!(
        "camera = {{ origin = {origin:?}, target = [0, 0, 0], up = [0, 0, 1], fov = 0.1 }}
         film = {{ size = [4, 4] }}
         lights = [{{ type = 'constant', radiance = 1 }}]
         [[shapes]]
         type = 'quad'
         corner = [-1, 0, -1]
         u = [0, 0, 2]
         v = [2, 0, 0]
         material = {material}"
    )
}

#[test]
fn a_blend_of_diffuse_and_mirror_reflects_the_sum_of_both() {
    let material = "{ type = 'blend', weight = 0.3, second = { type = 'mirror' },
                      first = { type = 'diffuse', reflectance = [0.2, 0.4, 0.8] } }";
    assert_radiance("blend", &wall(0.8, material), &ALL_BUT_LIGHT, [0.44, 0.58, 0.86], 0.06);
}

#[test]
fn a_mask_lets_light_through_its_holes() {
    let material = "{ type = 'mask', opacity = 0.25, material = { type = 'diffuse', reflectance = [0, 0.4, 1] } }";
    assert_radiance("mask", &wall(0.8, material), &ALL_BUT_LIGHT, [0.75, 0.85, 1.0], 0.05);
}

/// Of index 1, since behind a boundary of another one the sky itself would be brighter by its square.
#[test]
fn the_coefficients_add_up() {
    let material = "{ type = 'coefficients', kd = [0.3, 0.1, 0], ks = [0.2, 0.2, 0.5], kt = [0.4, 0, 0.1], ior = 1 }";
    assert_radiance("coefficients", &wall(0.6, material), &ALL_BUT_LIGHT, [0.9, 0.3, 0.6], 0.07);
}

#[test]
fn a_metal_reflects_by_fresnel_and_nothing_else() {
    let material = "{ type = 'conductor', eta = [0.2, 0.9, 1.5], k = [3.9, 2.4, 1.9], reflectance = 0.9 }";
    let expected = [(0.2, 3.9), (0.9, 2.4), (1.5, 1.9)].map(|(eta, k)| 0.9 * fresnel::conductor(0.5, eta, k));
    for way in ALL_BUT_LIGHT {
        for pixel in lit(&wall(0.5, material), way).image(2).pixels() {
            let near = pixel.iter().zip(expected).all(|(value, expected)| (value / expected - 1.0).abs() < 2e-3);
            assert!(near, "{way}: {pixel:?} is not {expected:?}");
        }
    }
}

/// Light that goes in, is reflected by the base any number of times, and comes out, summed by quadrature here.
fn plastic_albedo(cos: f64, rho: f64, ior: f64, nonlinear: bool) -> f64 {
    let reflected = |cos: f64, ior: f64| f64::from(fresnel::dielectric(cos as f32, ior as f32).reflectance);
    // Midpoint rule for ∫ F 2cos d(cos).
    let diffuse = |ior: f64| {
        let n = 100_000;
        let cos = |i: i32| (f64::from(i) + 0.5) / f64::from(n);
        (0..n).map(|i| 2.0 * cos(i) * reflected(cos(i), ior) / f64::from(n)).sum::<f64>()
    };
    let inner = diffuse(1.0 / ior);
    let base = rho / (1.0 - inner * if nonlinear { rho } else { 1.0 });
    reflected(cos, ior) + (1.0 - reflected(cos, ior)) * base * (1.0 - diffuse(ior)) / (ior * ior)
}

#[test]
fn a_coloured_plastic_has_the_albedo_that_quadrature_gives() {
    for (cos, ior, nonlinear) in [(0.9, 1.5, false), (0.4, 1.5, true), (0.2, 1.9, true)] {
        let material =
            format!("{{ type = 'plastic', reflectance = [0.1, 0.5, 0.9], ior = {ior}, nonlinear = {nonlinear} }}");
        let expected = [0.1, 0.5, 0.9].map(|rho| plastic_albedo(f64::from(cos), rho, ior, nonlinear));
        assert_radiance(&material, &wall(cos, &material), &ALL_BUT_LIGHT, expected, 0.08);
    }
}

#[test]
fn a_plastic_is_black_from_behind_unless_it_has_two_sides() {
    let seen = |material: &str, way: &str| lit(&wall(-0.8, material), way);
    for way in ALL_BUT_LIGHT {
        let black = |lit: Lit| lit.image(2).max() == 0.0;
        assert!(black(seen("{ type = 'plastic' }", way)), "{way}");
        let front = "{ type = 'diffuse', reflectance = 0 }";
        let two = format!("{{ type = 'two-sided', front = {front}, back = {{ type = 'plastic', ior = 1.3 }} }}");
        let expected = plastic_albedo(0.8, 0.5, 1.3, false);
        assert_mean(way, &seen(&two, way).means(50)[1], expected, 0.0, 0.1);
    }
}

/// Radiance over the square of the index is what a boundary keeps.
#[test]
fn inside_glass_radiance_is_larger_by_the_square_of_the_index() {
    let text = "camera = { origin = [0.3, 0.2, 0], target = [0, 0, 5], fov = 120 }
        film = { size = [8, 8] }
        lights = [{ type = 'constant', radiance = 1 }]
        [[shapes]]
        type = 'sphere'
        material = { type = 'glass', ior = 1.6 }";
    for way in ALL_BUT_LIGHT {
        for pixel in lit(text, way).image(4).pixels() {
            assert!((pixel[0] / 2.56 - 1.0).abs() < 1e-4, "{way}: {pixel:?}");
        }
    }
}

/// A white plate in a glass ball: photons arrive with their flux, the camera's rays with radiance over index squared,
/// and both meet. The plate is small enough that no light is caught in the ball.
#[test]
fn a_white_plate_in_a_glass_ball_vanishes() {
    let text = "camera = { origin = [0, 5, 0.5], target = [0, 0, 0], fov = 3 }
        film = { size = [4, 4] }
        lights = [{ type = 'constant', radiance = 1 }]
        [[shapes]]
        type = 'sphere'
        material = { type = 'glass', ior = 1.5 }
        [[shapes]]
        type = 'disk'
        normal = [0, 1, 0]
        radius = 0.6
        material = { type = 'diffuse', reflectance = 1 }";
    assert_radiance("plate", text, &["integrator=path samples=64", ALL[3], ALL[4]], [1.0; 3], 0.08);
}
