//! Over how many bins of a film the pilot finds the light of photons spread that lie together.

use glam::Vec3;

use crate::import::toml::read_str;
use crate::integrator::pilot::{MOST_BINS, bins_of_neighbours};
use crate::material::Lobes;
use crate::photon::{Photon, PhotonMap, Radius};
use crate::sampler::{Sampler, purpose};
use crate::scene::{NoAssets, build};
use crate::spectrum::Spectrum;

/// Photons that have come straight down to a floor by ways of so many lengths, which differ by a tenth.
fn photons(lengths: u32) -> PhotonMap {
    let photon = |number: u64| {
        let mut sampler = Sampler::new(1, 0, purpose::PILOT, number);
        let [place, length] = [sampler.square() * 2.0 - 1.0, sampler.square()].map(|square| square.extend(0.0));
        Photon {
            position: Vec3::new(place.x, 0.0, place.y),
            direction: Vec3::NEG_Y,
            normal: Vec3::Y,
            optical_length: 1.0 + 0.1 * (length.x * lengths as f32).floor(),
            reach: f32::INFINITY,
            slowness: 1.0,
            // Unequal, so that rounding has its say.
            flux: Spectrum::ONE * (0.1 * (1 + number % 7) as f32),
            shading: 1.0,
            rivals: 0.0,
            path: number as u32,
            bounce: 1,
            history: Lobes::NONE,
        }
    };
    PhotonMap::build((0..50_000).map(photon).collect(), 50_000, Radius::Fixed(0.02))
}

/// With this of the film's time.
fn bins(time: &str, lengths: u32) -> f32 {
    let text = format!(
        "film = {{ size = [16, 16]{time} }}
        camera = {{ origin = [0, 0.2, 0.9], target = [0, 0, 0], fov = 30 }}
        lights = [{{ type = 'point', position = [0, 3, 0], intensity = 1 }}]
        shapes = [{{ type = 'quad', corner = [-1, 0, -1], u = [0, 0, 2], v = [2, 0, 0] }}]"
    );
    let description = read_str("a.toml".as_ref(), &text).unwrap_or_else(|error| panic!("{error}\n{text}")).description;
    let scene = build(&description, &NoAssets).expect("a scene").scene;
    bins_of_neighbours(&scene, &description.film, 8, 1, &photons(lengths), 20)
}

#[test]
fn as_many_bins_are_told_as_there_are_lengths() {
    const BINS: &str = ", time = { bins = 1000, start = 0, bin-width = 0.01 }";
    for lengths in [1, 2, 5, 20] {
        // Of independent photons, in some 200,000 pairs, many of them of the same photons.
        let told = bins(BINS, lengths);
        assert!((told / lengths as f32 - 1.0).abs() < 0.05, "{told} instead of {lengths}");
    }
    let with_layers = bins(", time = { bins = 1000, start = 0, bin-width = 0.01, layers = ['direct', 'indirect'] }", 5);
    assert_eq!(with_layers, bins(BINS, 5));
}

#[test]
fn one_bin_is_told_of_films_that_have_none_or_wide_ones() {
    assert_eq!(bins("", 5), 1.0);
    assert_eq!(bins(", time = { bins = 4, start = 0, bin-width = 100 }", 5), 1.0);
    assert_eq!(bins(", time = { start = 0, frequencies = [1, 2] }", 5), 1.0);
    // Where no two are told apart from none, there is a limit.
    assert_eq!(bins(", time = { bins = 4000000, start = 0, bin-width = 1e-6 }", 1_000_000), MOST_BINS);
}
