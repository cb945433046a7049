//! The pilot: a radius for photon mapping where the user gives none.
//!
//! It traces one pass of photons of its own and measures, where the camera would gather, how far the k-th nearest photon
//! is. Its result depends on scene, film, settings and seed alone, so that every pass stays a pure function of these,
//! and it scales with the scene.

use glam::Vec2;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::path::CAMERA_ROULETTE_FROM;
use super::photon_map::photon_map;
use super::{Observer, Pass, Phase};
use crate::error::{Error, Result};
use crate::material::Lobes;
use crate::photon::{Nearest, PhotonMap, Radius};
use crate::sampler::{Sampler, purpose};
use crate::scene::description::{FilmDescription, PhotonMapSettings};
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transport::{Limits, Origin, PathState, Visitor, walk};

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

/// The median distance of the `settings.k`-th nearest photon from the points where the camera gathers, in scene units.
pub(super) fn radius(
    scene: &Scene,
    film: &FilmDescription,
    settings: &PhotonMapSettings,
    seed: u64,
    observer: &dyn Observer,
) -> f32 {
    observer.phase(Phase::Pilot);
    // No pass has this number, and the map is thrown away.
    let pass = Pass { index: u32::MAX, seed };
    let count = settings.k as usize;
    let map = photon_map(scene, settings, &pass, Radius::Nearest { count, max_radius: f32::INFINITY }, observer);
    let [width, height] = film.size.map(|side| side as f32);
    let limits = Limits { max_bounces: settings.max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
    let mut measure = Measure { map: &map, count, found: Nearest::default(), radii: Vec::new() };
    for index in 0..RAYS {
        let mut sampler = Sampler::new(seed, pass.index, purpose::PILOT, index);
        let pixel = sampler.square() * Vec2::new(width, height);
        let (ray, _) = scene.view(pixel, &mut sampler);
        walk(scene, PathState::new(ray, Spectrum::ONE), Origin::Camera, &limits, &mut sampler, &mut measure);
    }
    measure.median().unwrap_or_else(|| fallback(scene))
}

/// Without gather points or photons the radius matters little; it must only be positive and scale with the scene.
fn fallback(scene: &Scene) -> f32 {
    let radius = scene.bounds().radius();
    if radius.is_finite() && radius > 0.0 { 0.01 * radius } else { 1.0 }
}

/// Measures at gather points; follows delta lobes, as the gathering walk does.
struct Measure<'a> {
    map: &'a PhotonMap,
    count: usize,
    found: Nearest,
    radii: Vec<f32>,
}

impl Visitor for Measure<'_> {
    fn vertex(&mut self, point: &SurfacePoint, _: &PathState, _: &mut Sampler) -> Lobes {
        if point.bsdf.lobes().meets(Lobes::SMOOTH) {
            self.radii.push(self.map.nearest(point.surface.position, self.count, f32::INFINITY, &mut self.found).0);
        }
        Lobes::DELTA
    }
}

impl Measure<'_> {
    fn median(mut self) -> Option<f32> {
        self.radii.retain(|radius| radius.is_finite() && *radius > 0.0);
        let middle = self.radii.len() / 2;
        let (_, median, _) =
            (!self.radii.is_empty()).then(|| self.radii.select_nth_unstable_by(middle, f32::total_cmp))?;
        Some(*median)
    }
}
