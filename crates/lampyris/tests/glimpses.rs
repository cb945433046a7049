//! Lamps in coats and panes that mirror little of what falls on them are seen by every path, and no light is counted twice.

mod common;

use common::materials::{MATERIALS, bsdf, direction};
use common::statistics::{assert_mean, assert_same_mean};
use common::{Lit, lit, slab};
use lampyris::material::{Event, Lobes};
use lampyris::math::fresnel;
use lampyris::sampler::Sampler;

/// A floor of a material under a lamp that is all that it mirrors, seen from 37° to its normal.
fn mirrored_lamp(material: &str, fov: f32, settings: &str) -> Lit {
    let floor = format!(
        "[[shapes]]
         type = 'quad'
         corner = [-5, 0, -5]
         u = [0, 0, 10]
         v = [10, 0, 0]
         material = {material}\n"
    );
    under_lamp(&floor, fov, settings)
}

fn under_lamp(floor: &str, fov: f32, settings: &str) -> Lit {
    let text = format!(
        "camera = {{ origin = [3, 4, 0], target = [0, 0, 0], fov = {fov} }}
         film = {{ size = [6, 6] }}
         {floor}
         [[shapes]]
         type = 'quad'
         corner = [-60, 12, -60]
         u = [120, 0, 0]
         v = [0, 0, 120]
         material = {{ type = 'diffuse', reflectance = 0 }}
         emission = {{ radiance = [1, 2, 0.5] }}"
    );
    lit(&text, settings)
}

/// Nothing is behind the floor. What a path would see once in 25 times, all of them see by this share, in every pass.
#[test]
fn every_path_sees_a_lamp_in_a_pane() {
    let glass = fresnel::dielectric(0.8, 1.5).reflectance;
    let panes = [
        ("{ type = 'glass', ior = 1.5 }", glass),
        ("{ type = 'coefficients', kd = 0, ks = 0.2, kt = 0.3, ior = 1.5, fresnel = true }", 0.2 + 0.3 * glass),
        (
            "{ type = 'blend', weight = 0.25, first = { type = 'glass', ior = 1.5 }, second = { type = 'mirror', reflectance = 0.5 } }",
            0.75 * glass + 0.125,
        ),
    ];
    for (material, share) in panes {
        for settings in ["integrator=path", "integrator=auto photons=1000"] {
            for pass in mirrored_lamp(material, 0.1, settings).passes(8) {
                for pixel in pass.pixels() {
                    for (light, emitted) in pixel.iter().zip([1.0, 2.0, 0.5]) {
                        let expected = share * emitted;
                        assert!(
                            (light / expected - 1.0).abs() < 1e-3,
                            "{material}, {settings}: {light}, not {expected}"
                        );
                    }
                }
            }
        }
    }
}

/// All reflections between the two sides of a pane add up to 2F / (1 + F): what comes from its inside has gone through
/// boundaries, which glimpses do, too.
#[test]
fn glimpses_through_boundaries_count_no_light_twice() {
    let mirrored = f64::from(fresnel::dielectric(0.8, 1.5).reflectance);
    let expected = 2.0 * mirrored / (1.0 + mirrored);
    for panes in [1, 2] {
        // Between two panes light goes to and fro as it does within each.
        let all = if panes == 1 { expected } else { 2.0 * expected / (1.0 + expected) };
        let pane =
            |number: u32| slab(-0.4 * number as f32, -0.4 * number as f32 - 0.2, 40.0, "{ type = 'glass', ior = 1.5 }");
        let text: String = (0..panes).map(pane).collect();
        for settings in ["integrator=path samples=16", "integrator=auto photons=100 samples=16"] {
            let [found, ..] = under_lamp(&text, 0.1, settings).means(200);
            assert_mean(&format!("{panes}, {settings}"), &found, all, 1e-4 * all, 0.01);
        }
    }
}

/// Light tracing meets no lobe with a camera path, and glimpses nothing.
#[test]
fn glimpses_change_no_mean() {
    let floors = [
        "{ type = 'plastic', reflectance = 0.3, roughness = { alpha = 0.1 } }",
        "{ type = 'plastic', reflectance = 0.6, roughness = { alpha = 0.4 } }",
        "{ type = 'phong', diffuse = 0.3, specular = 0.3, exponent = 30 }",
        "{ type = 'blend', weight = 0.5, first = { type = 'diffuse', reflectance = 0.7 }, second = { type = 'conductor', metal = 'Al', roughness = { alpha = 0.2 } } }",
    ];
    for material in floors {
        let means = |settings: &str| mirrored_lamp(material, 30.0, settings).means(200);
        let [reference, ..] = means("integrator=light photons=20000");
        for settings in ["integrator=path samples=4", "integrator=auto photons=2000 samples=4"] {
            let [found, ..] = means(settings);
            assert_same_mean(&format!("{material}, {settings}"), &reference, &found, 8, 0.0);
        }
    }
}

/// Where the other event of the mix often leads below the floor, paths that end there have had their glimpse.
#[test]
fn paths_that_choose_a_dead_end_glimpse_too() {
    let grazing = "{ type = 'blend', weight = 0.5, first = { type = 'mirror', reflectance = 0.5 },
        second = { type = 'phong', diffuse = 0, specular = 0.9, exponent = 2 } }";
    let means = |settings: &str| mirrored_lamp(&grazing.replace('\n', " "), 30.0, settings).means(200);
    let [reference, ..] = means("integrator=photon-map photons=100 samples=16");
    for settings in ["integrator=path samples=4", "integrator=auto photons=100 samples=4"] {
        let [found, ..] = means(settings);
        assert_same_mean(settings, &reference, &found, 2, 0.0);
    }
}

/// It is the lobe that paths draw from, too, which `material_samplers.rs` tests.
#[test]
fn glimpses_are_drawn_as_paths_that_have_no_other_choice() {
    let (glossy, mut found) = (Lobes::from(Event::Glossy), 0);
    for material in MATERIALS {
        let bsdf = bsdf(material, true);
        for (number, z) in (0..).zip([0.95_f32, 0.5, 0.1]) {
            let to_previous = direction(z, 0.7);
            for index in 0..50 {
                let (mut sampler, mut path) = (Sampler::new(7, number, 0, index), Sampler::new(7, number, 0, index));
                let chosen = sampler.uniform();
                let Some(to_next) = bsdf.sample_gloss(to_previous, sampler.square().extend(chosen)) else { continue };
                let pdf = bsdf.gloss_pdf(to_previous, to_next);
                assert!(pdf > 0.0, "{material}: {to_next}");
                let Some(drawn) = bsdf.sample(to_previous, glossy, &mut path) else { continue };
                assert!((drawn.to_next - to_next).length() < 1e-5, "{material}: {to_next}, not {}", drawn.to_next);
                assert!((pdf / drawn.pdf - 1.0).abs() < 1e-4, "{material}: {pdf}, not {}", drawn.pdf);
                found += 1;
            }
        }
    }
    assert!(found > 500, "{found} directions");
}
