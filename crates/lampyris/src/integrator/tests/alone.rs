//! What paths would do without photons is told by photons, and photons are left where that is worth their price.

use glam::Vec2;

use super::built;
use crate::film::{Layers, Plain, Sink};
use crate::integrator::alone::rare;
use crate::integrator::guiding::judge;
use crate::integrator::look::Look;
use crate::integrator::merge::Merging;
use crate::integrator::path::CAMERA_ROULETTE_FROM;
use crate::integrator::photons::Photons;
use crate::integrator::sharing::Sharing;
use crate::integrator::{Pass, Silent, integrator};
use crate::photon::{Instead, Radius};
use crate::sampler::{Sampler, purpose};
use crate::scene::Scene;
use crate::scene::description::{AutoSettings, FilmDescription, IntegratorDescription, PathSettings};
use crate::transport::{Limits, Origin, PathState, walk};

/// A floor that the camera sees a small part of, and a lamp above that shines upwards, at a pane of this material.
fn lit_from_above(material: &str) -> String {
    format!(
        "film = {{ size = [32, 32] }}
        camera = {{ origin = [0, 0.9, 0.5], target = [0, 0, 0.5], fov = 50, up = [0, 0, 1] }}
        [[shapes]]
        type = 'quad'
        corner = [-2, 0, -2]
        u = [0, 0, 4]
        v = [4, 0, 0]
        material = {{ type = 'diffuse', reflectance = 0.5 }}
        [[shapes]]
        type = 'quad'
        corner = [-4, 2, -4]
        u = [8, 0, 0]
        v = [0, 0, 8]
        material = {{ type = '{material}' }}
        [[shapes]]
        type = 'quad'
        corner = [-0.2, 1, -0.2]
        u = [0, 0, 0.4]
        v = [0.4, 0, 0]
        emission = {{ radiance = 10 }}"
    )
}

/// The second moment over the square of the mean, less what is not cut of it, of what a path sees.
fn excess_of_paths(scene: &Scene, film: &FilmDescription, paths: u64) -> (f32, f64) {
    let size = Vec2::new(film.size[0] as f32, film.size[1] as f32);
    let limits = Limits { max_bounces: 8, roulette_from: CAMERA_ROULETTE_FROM };
    let look = |number: u64| {
        let pixel = Sampler::even(7, purpose::PILOT, 0, number).square() * size;
        let mut sampler = Sampler::new(7, 0, purpose::CAMERA, number);
        let path = PathState::from_camera(scene, pixel, &mut sampler);
        let mut sink = Plain::default();
        walk(scene, path, Origin::Camera, &limits, &mut sampler, &mut Look::alone(scene, 8, &mut sink));
        sink.radiance().mean()
    };
    let lights: Vec<f32> = (0..paths).map(look).collect();
    let mean = lights.iter().sum::<f32>() / paths as f32;
    let squares = lights.iter().map(|light| (f64::from(light / mean).powi(2) - 4.0).max(0.0));
    (mean, squares.sum::<f64>() / paths as f64)
}

/// What photons tell of that.
fn excess_by_photons(scene: &Scene, film: &FilmDescription, mean: f32) -> f64 {
    let pass = Pass { index: 3, seed: 5 };
    let merging = Merging {
        paths: 1_000_000,
        first: 4.0,
        further: 0.1,
        nearest: 50,
        shrunk: 1.0,
        on_from_first: 0.3,
        on_from_further: 0.5,
    };
    let photons = Photons { paths: merging.paths, max_bounces: 8, direct: false, volume: None };
    let instead = || Some(Instead::new(scene, merging.density(merging.further), merging.on_from_further));
    let maps = photons.maps(scene, &pass, Radius::Fixed(merging.further), instead, &Silent);
    let settings = AutoSettings { max_bounces: 8, ..AutoSettings::default() };
    let ways = (merging, Sharing::of(None, &maps));
    let mut places = judge(scene, film, &settings, &pass, &maps, ways).places;
    places.iter_mut().for_each(|place| place.unit = 1.0 / mean);
    rare(scene, &pass, 8, false, &places) / (2 * places.len()) as f64
}

#[track_caller]
fn assert_told(text: &str, at_least: f64) {
    let (description, scene) = built(text);
    let (mean, of_paths) = excess_of_paths(&scene, &description.film, 2_000_000);
    let told = excess_by_photons(&scene, &description.film, mean);
    // Some 9,000 paths met the lamp, and more photons came: within 2 %; 3 to 6 % less are told by what kernels blur.
    assert!((told / of_paths - 1.0).abs() < 0.15, "{told} instead of {of_paths}");
    assert!(of_paths > at_least, "{of_paths} is nothing rare");
}

#[test]
fn photons_tell_how_rarely_paths_meet_a_lamp_in_a_mirror() {
    assert_told(&lit_from_above("mirror"), 100.0);
}

#[test]
fn they_know_that_glimpses_see_it_in_a_pane_that_mirrors_little() {
    assert_told(&lit_from_above("glass"), 100.0);
}

/// Whether a pass of `auto` with these settings is that of `path`, which it must tell.
fn is_that_of_path(text: &str, settings: AutoSettings) -> bool {
    let (description, scene) = built(text);
    let film = &description.film;
    let pass = Pass { index: 0, seed: 1 };
    let [auto, path] = [
        IntegratorDescription::Auto(settings),
        IntegratorDescription::Path(PathSettings { max_bounces: 256, ..PathSettings::default() }),
    ]
    .map(|description| integrator(&scene, film, &description, 1, &Silent));
    let [is, of_path] = [&auto, &path].map(|each| each.expose(&scene, film, &pass, Layers::NONE, &Silent).image);
    let is_that = is == of_path;
    assert_eq!((auto.remark().is_some(), path.remark()), (is_that, None));
    is_that
}

#[test]
fn auto_leaves_photons_where_they_are_worth_it_and_is_path_elsewhere() {
    let open = "film = { size = [32, 32] }
        camera = { origin = [0, 1, -3], target = [0, 0.4, 0], fov = 40 }
        lights = [{ type = 'constant', radiance = 1 }]
        [[shapes]]
        type = 'disk'
        center = [0, 0, 0]
        radius = 5
        material = { type = 'diffuse', reflectance = 0.5 }
        [[shapes]]
        type = 'sphere'
        center = [0, 0.5, 0]
        radius = 0.5
        material = { type = 'plastic' }";
    let default = AutoSettings::default();
    assert!(is_that_of_path(open, default.clone()));
    assert!(!is_that_of_path(&lit_from_above("mirror"), default.clone()));
    // Who asks for photons gets them.
    assert!(!is_that_of_path(open, AutoSettings { photons: Some(20_000), ..default.clone() }));
    assert!(!is_that_of_path(open, AutoSettings { radius: Some(3.0), ..default }));
}
