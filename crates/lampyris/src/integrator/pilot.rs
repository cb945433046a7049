//! The pilot: radii where the user gives none.
//!
//! It traces one pass of photons of its own and measures, where the camera would gather, how far the k-th nearest photon
//! is. Its result depends on scene, film, settings and seed alone, so that every pass stays a pure function of these,
//! and it scales with the scene.

use std::collections::BTreeMap;

use glam::Vec2;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::path::CAMERA_ROULETTE_FROM;
use super::photon_map::photon_map;
use super::{Observer, Pass, Phase};
use crate::error::{Error, Result};
use crate::film::Clock;
use crate::material::{Lobes, Scattered};
use crate::photon::{Nearest, PhotonMap, Radius};
use crate::sampler::{Sampler, purpose};
use crate::scene::description::{FilmDescription, PhotonMapSettings};
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transport::{Crossing, Limits, Origin, PathState, Visitor, walk};

/// What a pilot measured as bytes, for [`Integrator::pilot`](super::Integrator::pilot).
pub(super) fn write(pilot: &impl Serialize) -> Vec<u8> {
    postcard::to_stdvec(pilot).unwrap_or_default()
}

/// What was measured, from the bytes.
///
/// # Errors
/// If it is something else.
pub(super) fn read<P: DeserializeOwned>(bytes: &[u8]) -> Result<P> {
    postcard::from_bytes(bytes).map_err(|_| unfit())
}

/// What was measured is not what the settings need.
pub(super) fn unfit() -> Error {
    Error::new("what the pilot measured is missing or damaged")
}

/// Rays from the camera that look for gather points.
const RAYS: u64 = 1024;

/// The pass of the pilot: none has this number. Its map is thrown away.
pub(super) const PASS: u32 = u32::MAX;

/// The median distance of the `settings.k`-th nearest photon from the points where the camera gathers, in scene units.
pub(super) fn radius(
    scene: &Scene,
    film: &FilmDescription,
    settings: &PhotonMapSettings,
    seed: u64,
    observer: &dyn Observer,
) -> f32 {
    observer.phase(Phase::Pilot);
    let (pass, count) = (Pass { index: PASS, seed }, settings.k as usize);
    let map = photon_map(scene, settings, &pass, Radius::Nearest { count, max_radius: f32::INFINITY }, observer);
    let (mut found, mut radii) = (Nearest::default(), Vec::new());
    gather_points(scene, film, settings.max_bounces, seed, |point, _, _| {
        radii.push(distance(&map, point, count, &mut found));
        Lobes::DELTA
    });
    median(radii).unwrap_or_else(|| fallback(scene))
}

/// The distance of the `count`-th nearest photon, or of the farthest if there are fewer.
pub(super) fn distance(map: &PhotonMap, point: &SurfacePoint, count: usize, found: &mut Nearest) -> f32 {
    map.nearest(point.surface.position, count, f32::INFINITY, found).0
}

/// More bins change nothing: as many photons are gathered for so many as a pass has time for.
pub(super) const MOST_BINS: f32 = 4096.0;

/// Over how many time bins the light of so many photons that lie together is spread: one over the chance that two of them arrive
/// in the same one, mean over the points where the camera gathers first. 1 where there are no bins, and no more than
/// [`MOST_BINS`].
pub(super) fn bins_of_neighbours(
    scene: &Scene,
    film: &FilmDescription,
    max_bounces: u32,
    seed: u64,
    map: &PhotonMap,
    count: usize,
) -> f32 {
    let Some(width) = Clock::of(film).map(|clock| clock.bin_width()).filter(|&width| width > 0.0) else { return 1.0 };
    let (mut found, mut fluxes) = (Nearest::default(), BTreeMap::new());
    let (mut chances, mut points) = (0.0, 0u32);
    gather_points(scene, film, max_bounces, seed, |point, path, _| {
        let position = point.surface.position;
        fluxes.clear();
        let mut equals = 0.0;
        for (photon, _) in map.nearest(position, count, f32::INFINITY, &mut found).1 {
            let slowness = path.slowness * point.slowness_toward(-photon.direction);
            // Where bins begin, and the way to the camera, is the same for all of them.
            let bin = (photon.optical_length_at(position, slowness) / width).floor() as i64;
            let flux = f64::from(photon.flux.mean());
            equals += flux * flux;
            *fluxes.entry(bin).or_insert(0.0) += flux;
        }
        let all = fluxes.values().sum::<f64>().powi(2) - equals;
        if all > 0.0 {
            let pairs = fluxes.values().map(|flux| flux * flux).sum::<f64>() - equals;
            // Rounding could make it less.
            chances += pairs.max(0.0) / all;
            points += 1;
        }
        Lobes::DELTA
    });
    if points > 0 { (f64::from(points) / chances).clamp(1.0, MOST_BINS.into()) as f32 } else { 1.0 }
}

/// Tells `visit` of points with smooth lobes that walks from the camera reach, and of how many smooth events led there.
/// It answers which lobes to follow.
pub(super) fn gather_points(
    scene: &Scene,
    film: &FilmDescription,
    max_bounces: u32,
    seed: u64,
    visit: impl FnMut(&SurfacePoint, &PathState, u32) -> Lobes,
) {
    let mut visitor = GatherPoints { visit, smooth_events: 0 };
    for index in 0..RAYS {
        visitor.smooth_events = 0;
        look(scene, film, max_bounces, seed, index, &mut visitor);
    }
}

/// Shows the visitor a path from the camera, through a random place of the picture that the number chooses.
pub(super) fn look<V: Visitor>(
    scene: &Scene,
    film: &FilmDescription,
    max_bounces: u32,
    seed: u64,
    number: u64,
    visitor: &mut V,
) {
    let [width, height] = film.size.map(|side| side as f32);
    let limits = Limits { max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
    let mut sampler = Sampler::new(seed, PASS, purpose::PILOT, number);
    let pixel = sampler.square() * Vec2::new(width, height);
    let (ray, _) = scene.view(pixel, &mut sampler);
    let path =
        PathState { cone: scene.cone(), inside: scene.inside_of_view(&ray), ..PathState::new(ray, Spectrum::ONE) };
    walk(scene, path, Origin::Camera, &limits, &mut sampler, visitor);
}

struct GatherPoints<F> {
    visit: F,
    smooth_events: u32,
}

impl<F: FnMut(&SurfacePoint, &PathState, u32) -> Lobes> Visitor for GatherPoints<F> {
    const CROSSING: Crossing = Crossing::Fade;

    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, _: &mut Sampler) -> Lobes {
        if point.bsdf.lobes().meets(Lobes::SMOOTH) {
            (self.visit)(point, path, self.smooth_events)
        } else {
            Lobes::DELTA
        }
    }

    fn scattered(&mut self, scattered: &Scattered, _: &SurfacePoint, _: &PathState) {
        self.smooth_events += u32::from(Lobes::SMOOTH.contains(scattered.event));
    }
}

/// The median of those numbers that are positive and finite.
pub(super) fn median(mut numbers: Vec<f32>) -> Option<f32> {
    numbers.retain(|number| number.is_finite() && *number > 0.0);
    let middle = numbers.len() / 2;
    let (_, median, _) = (!numbers.is_empty()).then(|| numbers.select_nth_unstable_by(middle, f32::total_cmp))?;
    Some(*median)
}

/// Without gather points or photons the radius matters little; it must only be positive and scale with the scene.
pub(super) fn fallback(scene: &Scene) -> f32 {
    let radius = scene.bounds().radius();
    if radius.is_finite() && radius > 0.0 { 0.01 * radius } else { 1.0 }
}
