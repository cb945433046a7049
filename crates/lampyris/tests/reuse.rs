//! Paths that lend each other what they find: every pixel has the same light at the same time, and less noise.

mod common;

use common::lit;
use common::statistics::{Sample, assert_same_mean};
use common::time::{bins, slots};
use lampyris::image::luminance;

/// A room that is open to a sky in front, with a lamp and all that a path can meet on its way from one station to another:
/// edges, a sheet that is lit on both sides, coats, highlights, holes, painted bumps, mirrors and glass.
fn room(floor: &str, left: &str) -> String {
    let plane = |normal: &str, material: &str| {
        format!("[[shapes]]\ntype = 'plane'\nnormal = {normal}\ndistance = 1\nmaterial = {material}\n")
    };
    let ball = |center: &str, radius: f32, material: &str| {
        format!("[[shapes]]\ntype = 'sphere'\ncenter = {center}\nradius = {radius}\nmaterial = {material}\n")
    };
    let quad = |corner: &str, u: &str, v: &str, material: &str| {
        format!("[[shapes]]\ntype = 'quad'\ncorner = {corner}\nu = {u}\nv = {v}\nmaterial = {material}\n")
    };
    "camera = { origin = [0, 0, -3.5], target = [0, 0, 0], fov = 38 }
     film = { size = [16, 16] }
     textures = { board = { type = 'checkerboard', color0 = [1, 0.5, 0.2], color1 = 0.1 }, heights = { type = 'bitmap', file = 'heights' } }
     [[lights]]
     type = 'constant'
     radiance = 0.3\n"
        .to_string()
        + &plane("[0, 1, 0]", floor)
        + &plane("[1, 0, 0]", left)
        + &plane("[-1, 0, 0]", "{ type = 'diffuse', reflectance = [0.2, 0.4, 0.8] }")
        + &plane("[0, -1, 0]", "{ type = 'diffuse', reflectance = 'board' }")
        + &plane("[0, 0, -1]", "{ type = 'plastic' }")
        + &ball("[-0.5, -0.6, 0.25]", 0.4, "{ type = 'mirror' }")
        + &ball("[0.5, -0.6, 0.1]", 0.4, "{ type = 'glass' }")
        + &ball("[0.1, -0.2, 0.5]", 0.2, "{ type = 'blend', first = { type = 'diffuse' }, second = { type = 'conductor', metal = 'Au', roughness = { alpha = 0.2 } }, weight = 0.5 }")
        + &quad("[-0.2, -1, 0.4]", "[0.3, 0, 0.3]", "[0, 1.2, 0]", "{ type = 'two-sided', front = { type = 'diffuse', reflectance = [0.8, 0.8, 0.3] } }")
        + &quad("[0.3, -0.3, -0.4]", "[0.5, 0, 0]", "[0, 0.5, 0.2]", "{ type = 'mask', opacity = 0.6, material = { type = 'two-sided', front = { type = 'diffuse' } } }")
        + "[[shapes]]
           type = 'sphere'
           center = [0.3, 0.6, -0.25]
           radius = 0.1
           emission = { power = 4 }
           material = { type = 'diffuse' }\n"
}

/// The luminance of each pixel in each pass.
fn pixels(text: &str, settings: &str, passes: u32) -> Vec<Vec<f64>> {
    let images = lit(text, &format!("integrator=path {settings}")).passes(passes);
    let of = |pixel: usize| images.iter().map(|image| f64::from(luminance(image.pixels()[pixel]))).collect();
    (0..images[0].pixels().len()).map(of).collect()
}

#[track_caller]
fn assert_same_pixels(text: &str) {
    const PASSES: u32 = 3000;
    let (lent, alone) = (pixels(text, "render.seed=1", PASSES), pixels(text, "reuse=false render.seed=2", PASSES));
    for (pixel, (a, b)) in lent.iter().zip(&alone).enumerate() {
        assert_same_mean(&format!("pixel {pixel}"), a, b, lent.len(), 0.0);
    }
    let left = |(a, b): (&Vec<f64>, &Vec<f64>)| Sample::of(a).variance / Sample::of(b).variance;
    let mut left: Vec<f64> = lent.iter().zip(&alone).map(left).collect();
    left.sort_by(f64::total_cmp);
    let typical = left[left.len() / 2];
    assert!(typical < 0.95, "of the noise of a typical pixel, {typical} is left");
}

#[test]
fn lending_changes_no_pixel_between_matt_walls() {
    assert_same_pixels(&room(
        "{ type = 'diffuse', reflectance = 0.6 }",
        "{ type = 'bump-map', height = 'heights', scale = 0.3, material = { type = 'diffuse', reflectance = [0.8, 0.3, 0.3] } }",
    ));
}

#[test]
fn lending_changes_no_pixel_between_coats_and_highlights() {
    assert_same_pixels(&room(
        "{ type = 'plastic', reflectance = [0.7, 0.5, 0.2], roughness = { alpha = 0.2 } }",
        "{ type = 'plastic', reflectance = [0.3, 0.6, 0.3] }",
    ));
}

#[test]
fn lending_changes_no_pixel_between_models_of_old() {
    assert_same_pixels(&room(
        "{ type = 'phong', diffuse = [0.5, 0.3, 0.2], specular = 0.3, exponent = 20 }",
        "{ type = 'ward', diffuse = [0.2, 0.5, 0.2], specular = 0.2, alpha-u = 0.15, alpha-v = 0.15 }",
    ));
}

/// Four matt walls and a lamp, of which only half of the light is direct.
const BOX: &str = "
    camera = { origin = [0, 0, 0], target = [0, -0.5, 1], fov = 90 }
    film = { size = [16, 16] }
    [[shapes]]
    type = 'cube'
    flip-normal = true
    material = { type = 'diffuse', reflectance = [0.8, 0.7, 0.6] }
    [[shapes]]
    type = 'sphere'
    center = [0.3, 0.7, -0.2]
    radius = 0.05
    emission = { power = 4 }
    material = { type = 'diffuse' }
";

/// The foot of a matt wall, which sees the coat of the floor under one degree and more: the higher, the more comes out there.
const SKIRTING: &str = "
    camera = { origin = [0, 0.08, -1], target = [0, 0.08, 0], fov = 9 }
    film = { size = [16, 16] }
    [[shapes]]
    type = 'quad'
    corner = [-2, 0, 0]
    u = [0, 1, 0]
    v = [4, 0, 0]
    material = { type = 'diffuse', reflectance = 0.8 }
    [[shapes]]
    type = 'quad'
    corner = [-2, 0, -4]
    u = [0, 0, 4]
    v = [4, 0, 0]
    material = { type = 'plastic', ior = 1.5, reflectance = 0.8 }
    [[shapes]]
    type = 'sphere'
    center = [0, 3, 1.5]
    radius = 0.3
    emission = { power = 100 }
    material = { type = 'diffuse' }
";

#[test]
fn coats_let_out_to_each_station_what_they_must() {
    assert_same_pixels(SKIRTING);
}

#[test]
fn a_box_has_a_fourth_of_the_noise() {
    let noise =
        |settings: &str| pixels(BOX, settings, 100).iter().map(|values| Sample::of(values).variance).sum::<f64>();
    let (lent, alone) = (noise("render.seed=1"), noise("reuse=false render.seed=2"));
    assert!(lent < 0.25 * alone, "{lent}, {alone}");
}

#[test]
fn light_that_is_lent_arrives_when_it_must() {
    let of = |settings: &str| {
        let lit = lit(BOX, &format!("integrator=path {settings}{}", bins(40, 0.5, 0.25)));
        slots(&lit, 400)
    };
    let (lent, alone) = (of("render.seed=1"), of("reuse=false render.seed=2"));
    let mut with_light = 0;
    for (slot, (a, b)) in lent.iter().zip(&alone).enumerate() {
        assert_same_mean(&format!("slot {slot}"), a, b, lent.len(), 0.0);
        with_light += u32::from(a.iter().sum::<f64>() > 0.0);
    }
    assert!(with_light > 20, "{with_light}");
}
