//! Seeing around corners: what a sensor sees of a wall that a laser lights.

mod common;

use common::statistics::{Sample, assert_mean, assert_same_mean};
use common::time::{arriving, bins, slot_count};
use common::{Lit, described, lit};
use lampyris::error::Error;
use lampyris::film::Arrival;
use lampyris::scene::{NoAssets, build};

/// A wall of albedo 0.8 at z = 0, two units wide, with these keys of the capture; sensor and laser stand apart.
fn wall(capture: &str, target: &str) -> String {
    format!(
        "camera = {{ origin = [-0.5, 0, 0.25], capture = {{ wall = 'wall', {capture} }} }}
        integrator = {{ type = 'path' }}
        film = {{ size = [1, 1] }}
        lights = [{{ type = 'laser', position = [0.3, -0.4, 0.5], power = 2, {target} }}]
        [[shapes]]
        type = 'quad'
        corner = [-1, -1, 0]
        u = [2, 0, 0]
        v = [0, 2, 0]
        name = 'wall'
        material = {{ type = 'diffuse', reflectance = 0.8 }}\n"
    )
}

/// A square patch with this side and albedo 0.5 that faces the wall's middle.
fn patch(distance: f32, side: f32) -> String {
    format!(
        "[[shapes]]
        type = 'quad'
        corner = [{0}, {0}, {distance}]
        u = [0, {side}, 0]
        v = [{side}, 0, 0]
        material = {{ type = 'diffuse', reflectance = 0.5 }}\n",
        -0.5 * side
    )
}

/// Things behind the corner: a square that looks at the wall, and a ball.
const HIDDEN: &str = "
    [[shapes]]
    type = 'quad'
    corner = [0.1, -0.2, 1]
    u = [0, 0.6, 0]
    v = [0.4, 0, 0.1]
    material = { type = 'diffuse', reflectance = 0.7 }
    [[shapes]]
    type = 'sphere'
    center = [-0.4, 0.1, 0.7]
    radius = 0.25
    material = { type = 'plastic', reflectance = 0.5 }\n";

/// The luminance of each pixel in each slot, before the first bin and after the last too, of each pass.
fn slots(lit: &Lit, passes: u32) -> Vec<Vec<f64>> {
    let ([width, height], slots) = (lit.description.film.size, slot_count(lit));
    let place = |arrival: &Arrival| arrival.pixel as usize * slots + arrival.slot as usize;
    arriving(lit, passes, slots * (width * height) as usize, place)
}

fn fault(text: &str) -> Error {
    match build(&described(text), &NoAssets) {
        Err(error) => error,
        Ok(_) => panic!("no fault in {text}"),
    }
}

/// L = Φ ρ_w² ρ_y A / (π³ r⁴), all of it at s = 2r and no more than what the patch is wide.
#[test]
fn a_small_patch_answers_after_twice_its_distance_by_the_fourth_power_of_it() {
    for distance in [0.5_f32, 1.0, 2.0] {
        let side = 0.01 * distance;
        let r = f64::from(distance);
        let expected = 2.0 * 0.8 * 0.8 * 0.5 * f64::from(side).powi(2) / (std::f64::consts::PI.powi(3) * r.powi(4));
        for (mode, target) in [("'confocal'", ""), ("'single'", "target = [0, 0, 0]")] {
            // The second of three bins begins a hair before 2r.
            let range = bins(3, 2.0 * r * (1.0 - 1e-4) - 0.001, 0.001);
            let scene = wall(&format!("mode = {mode}, hidden-geometry = true"), target) + &patch(distance, side);
            let found = slots(&lit(&scene, &format!("max-bounces=2 samples=64{range}")), 40);
            let dark = [0, 1, 3, 4].map(|slot| Sample::of(&found[slot]).mean);
            assert_eq!(dark, [0.0; 4], "{mode} at {distance}: light outside of the bin");
            assert_mean(&format!("{mode} at {distance}"), &found[2], expected, 2e-4 * expected, 0.05);
        }
    }
}

#[test]
fn the_ways_from_the_laser_and_to_the_sensor_count_if_they_are_to() {
    let length = |x: [f64; 3]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let legs = length([0.5, 0.0, 0.25]) + length([0.3, 0.4, 0.5]);
    for (counts, before) in [(false, 0.0), (true, legs)] {
        let scene =
            wall(&format!("mode = 'confocal', hidden-geometry = true, legs = {counts}"), "") + &patch(1.0, 0.01);
        let range = bins(2, before + 2.0 - 2e-4 - 1e-5, 1e-4);
        let found = slots(&lit(&scene, &format!("max-bounces=2 samples=16{range}")), 4);
        let lit: Vec<bool> = found.iter().map(|values| Sample::of(values).mean > 0.0).collect();
        assert_eq!(lit, [false, false, false, true], "the light is there at 2 + {before}, and in no bin before");
    }
}

#[test]
fn a_wall_alone_sends_nothing_back_to_itself() {
    for (mode, target) in [("'confocal'", ""), ("'single'", "target = [0, 0, 0]"), ("'single'", "target = [0.1, 0, 0]")]
    {
        let image = lit(&wall(&format!("mode = {mode}"), target), "size=[3,3] samples=64").image(2);
        assert!(image.pixels().iter().flatten().all(|&value| value == 0.0), "{mode}");
    }
}

/// Each pixel and bin has the same mean, with the balance heuristic and without.
#[test]
fn aiming_at_what_is_hidden_changes_no_mean() {
    for (mode, target) in [("'confocal'", ""), ("'single'", "target = [0.3, 0.2, 0]")] {
        let found = [true, false].map(|aims| {
            let scene = wall(&format!("mode = {mode}, hidden-geometry = {aims}"), target) + HIDDEN;
            let settings = format!("size=[2,2] samples=512 seed={}{}", u8::from(aims), bins(8, 1.0, 0.3));
            slots(&lit(&scene, &settings), 40)
        });
        let [aimed, even] = &found;
        let mut noise = [0.0, 0.0];
        for (slot, (a, b)) in aimed.iter().zip(even).enumerate() {
            assert_same_mean(&format!("{mode}, slot {slot}"), a, b, aimed.len(), 0.0);
            noise[0] += Sample::of(a).variance;
            noise[1] += Sample::of(b).variance;
        }
        assert!(noise[0] < noise[1], "aiming helps: {noise:?}");
    }
}

/// What is hidden may be a lamp, too: then paths that were aimed at it and shadow rays share its light.
#[test]
fn aiming_at_a_lamp_changes_no_mean() {
    let lamp = "[[shapes]]
        type = 'sphere'
        center = [0.1, 0.3, 0.8]
        radius = 0.3
        emission = { radiance = 0.05 }\n";
    let found = [true, false].map(|aims| {
        let scene = wall(&format!("hidden-geometry = {aims}"), "target = [0.3, 0.2, 0]") + HIDDEN + lamp;
        slots(&lit(&scene, &format!("size=[2,2] samples=256 seed={}{}", u8::from(aims), bins(6, 0.0, 0.5))), 40)
    });
    for (slot, (a, b)) in found[0].iter().zip(&found[1]).enumerate() {
        assert_same_mean(&format!("slot {slot}"), a, b, found[0].len(), 0.0);
    }
}

/// A wall and a ball on it, both lit by way of another wall, on which the laser shines: an ordinary camera sees them.
fn lit_by(light: &str) -> String {
    format!(
        "film = {{ size = [12, 12] }}
        camera = {{ origin = [0, 0, 1.5], target = [0, 0, 0], fov = 40 }}
        lights = [{light}]
        [[shapes]]
        type = 'quad'
        corner = [-1, -1, 0]
        u = [2, 0, 0]
        v = [0, 2, 0]
        material = {{ type = 'diffuse', reflectance = 0.8 }}
        [[shapes]]
        type = 'sphere'
        center = [0.3, 0, 0.25]
        radius = 0.25
        material = {{ type = 'diffuse', reflectance = 0.4 }}
        [[shapes]]
        type = 'quad'
        corner = [-1, -1, 2]
        u = [0, 2, 0]
        v = [2, 0, 0]
        material = {{ type = 'phong', diffuse = 0.4, specular = 0.3, exponent = 8 }}\n"
    )
}

/// The laser's light as all integrators see it, and that of a thin beam, whose photons know nothing of spots: there the
/// wall is one event of the path more.
#[test]
fn a_spot_is_a_lamp_to_all_integrators_and_the_end_of_a_beam() {
    let laser = lit_by("{ type = 'laser', position = [0.1, 0.8, 0.5], target = [0.2, 0.3, 2], power = 3 }");
    let beam = lit_by("{ type = 'beam', position = [0.1, 0.8, 0.5], direction = [0.1, -0.5, 1.5], power = 3 }");
    let (range, passes) = (bins(12, 4.0, 0.5), 30);
    let sums = |text: &str, settings: String| {
        let lit = lit(text, &settings);
        let slots = slots(&lit, passes);
        let pixels = slots.chunks(14);
        (0..14)
            .map(|slot| {
                let sum = |pass: usize| pixels.clone().map(|pixel| pixel[slot][pass]).sum::<f64>() / 144.0;
                (0..passes as usize).map(sum).collect::<Vec<f64>>()
            })
            .collect::<Vec<_>>()
    };
    let reference = sums(&laser, format!("integrator=path samples=64 max-bounces=4{range}"));
    assert!(reference[2..].iter().all(|values| Sample::of(values).mean > 0.0), "nearly every bin has light");
    for (text, way, bias) in [
        (&laser, "light photons=65536 max-bounces=4", 0.0),
        (&beam, "light photons=65536 max-bounces=5", 0.0),
        (&laser, "photon-map photons=16384 bandwidth=fixed radius=0.04 samples=8 max-bounces=4", 0.01),
        (&laser, "photon-map photons=65536 bandwidth=fixed radius=0.04 direct=photons samples=4 max-bounces=4", 0.02),
        (&laser, "auto photons=16384 samples=8 radius=0.6 max-bounces=4", 0.005),
    ] {
        let found = sums(text, format!("integrator={way}{range} seed=1"));
        for (slot, (a, b)) in reference.iter().zip(&found).enumerate() {
            assert_same_mean(&format!("{way}, slot {slot}"), a, b, reference.len(), bias);
        }
    }
}

/// The same light for a point of the laser's grid as if it were the only one.
#[test]
fn an_exhaustive_capture_is_many_single_ones() {
    let range = bins(6, 1.0, 0.4);
    let exhaustive = wall("mode = 'exhaustive', laser-grid = [2, 3], hidden-geometry = true", "") + HIDDEN;
    let exhaustive = slots(&lit(&exhaustive, &format!("size=[4,6] samples=256{range}")), 40);
    // The laser's point (1, 2) of 2 × 3 over the wall: its middle in u is 3/4, in v 5/6.
    let single = wall("hidden-geometry = true", "target = [0.5, 0.6666667, 0]") + HIDDEN;
    let single = slots(&lit(&single, &format!("size=[2,2] samples=256 seed=1{range}")), 40);
    for (pixel, slots) in single.chunks(8).enumerate() {
        let (x, y) = (2 + pixel % 2, 4 + pixel / 2);
        for (slot, (a, b)) in slots.iter().zip(&exhaustive[8 * (4 * y + x)..]).enumerate() {
            assert_same_mean(&format!("pixel {pixel}, slot {slot}"), a, b, single.len(), 0.0);
        }
    }
}

#[test]
fn any_threads_and_any_order_of_passes_give_the_same_film() {
    for (capture, target) in [
        ("mode = 'single'", "target = [0.3, 0.2, 0]"),
        ("mode = 'confocal', hidden-geometry = true", ""),
        ("mode = 'exhaustive', laser-grid = [3, 2], hidden-geometry = true", ""),
    ] {
        let lit = lit(&(wall(capture, target) + HIDDEN), "size=[12,8] time.bins=20 time.variance=true");
        let film = lit.film_on(1, [0, 1, 2]);
        assert!(film.image().pixels().iter().flatten().any(|&value| value > 0.0), "{capture}: there is light");
        assert!(film == lit.film_on(3, [2, 0, 1]), "{capture}");
    }
}

#[test]
fn what_makes_no_sense_is_told_with_its_key() {
    let target = "target = [0, 0, 0]";
    for (text, key, said) in [
        (wall("mode = 'single'", ""), "lights[0]", "does not say where it shines"),
        (wall("mode = 'exhaustive'", ""), "camera.capture.laser-grid", "grid is missing"),
        (wall("mode = 'exhaustive', laser-grid = [2, 1]", ""), "camera.capture.laser-grid", "no multiple"),
        (wall("laser-grid = [2, 1]", target), "camera.capture.laser-grid", "only the mode 'exhaustive'"),
        (wall("", target).replace("'wall', ", "'door'"), "camera.capture.wall", "no shape named 'door'"),
        (wall("", target).replace("'path'", "'light'"), "camera.capture", "does not find single points"),
        (wall("mode = 'confocal'", "").replace("'path'", "'auto'"), "camera.capture.mode", "photons of one laser spot"),
        (
            wall("hidden-geometry = true", target).replace("'path'", "'photon-map'"),
            "camera.capture.hidden-geometry",
            "only paths",
        ),
        (
            wall("", target).replace("[1, 1]", "[1, 1], filter = { type = 'tent' }"),
            "film.filter",
            "must not be blurred",
        ),
        (wall("", "target = [0, 0, 1]"), "lights[0]", "meets no surface"),
        (
            wall("", target).replace("type = 'diffuse', reflectance = 0.8", "type = 'mirror'"),
            "lights[0]",
            "only mirrors",
        ),
        (
            wall("", target).replace("type = 'laser'", "type = 'point'").replace(", target = [0, 0, 0]", ""),
            "camera.capture",
            "no laser",
        ),
        (wall("", target) + "[[lights]]\ntype = 'point'\nposition = [0, 0, 1]\npower = 1\n", "", ""),
    ] {
        if key.is_empty() {
            continue;
        }
        let error = fault(&text);
        assert!(error.message.contains(said), "{} instead of '{said}'", error.message);
        assert_eq!(error.key.as_deref(), Some(key), "{}", error.message);
    }
}
