//! How light in media is estimated: by what kind of photons, and within which radius (theory §9.4).

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::photons::Photons;
use super::pilot::{PASS, fallback, look, median};
use super::sharing::{Sharing, from_lamp};
use super::{Observer, Pass};
use crate::film::Sink;
use crate::material::Lobes;
use crate::medium::MediumId;
use crate::photon::{Beam, Kernel, Radius, Volume, VolumeMap, shrunk};
use crate::sampler::Sampler;
use crate::scene::description::FilmDescription;
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transient::Met;
use crate::transport::{Crossing, PathState, Segment, Visitor};

/// What is estimated how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct VolumeEstimate {
    /// By what.
    pub volume: Volume,
    /// With this kernel.
    pub kernel: Kernel,
    /// Of this radius at the first pass, in scene units.
    pub radius: f32,
    /// Which shrinks so slowly; none if it stays.
    pub alpha: Option<f32>,
    /// By photons of so many light paths of a pass, at most.
    pub paths: u64,
    /// The part of the light straight from lamps that photons bring, 0 to 1: see [`Sharing`].
    pub direct: f32,
}

/// What a user may say of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wishes {
    pub volume: Option<Volume>,
    pub radius: Option<f32>,
    pub alpha: Option<f32>,
    pub kernel: Kernel,
    /// Whether the radius shrinks at all.
    pub shrinks: bool,
    /// How many photons a typical ray finds.
    pub count: usize,
    /// So many photons in media are enough for a pass.
    pub enough: Option<f64>,
}

/// Beams where light flies on average farther than this many radii: beyond, points have less noise for their price
/// [Křivánek et al. 2014, §6.3].
const FREE_FLIGHT: f32 = std::f32::consts::FRAC_PI_2;

/// Light paths of the pilot, at most: enough to know distances by.
const PILOT_PATHS: u64 = 50_000;

/// And as many as tell how many photons a path leaves.
const FEW_PATHS: u64 = 1024;

/// Rays of the pilot.
const RAYS: u64 = 128;

impl VolumeEstimate {
    /// What is wished for; measured where nothing is said. None where there is nothing in the scene to be estimated.
    pub(super) fn new(
        scene: &Scene,
        film: &FilmDescription,
        wishes: Wishes,
        photons: Photons,
        seed: u64,
        observer: &dyn Observer,
    ) -> Option<VolumeEstimate> {
        if !scene.has_media() {
            return None;
        }
        let with = |volume: Volume| {
            let optimum = match volume {
                Volume::Beams => 4.0 / 5.0,
                Volume::Points => 2.0 / 3.0,
                Volume::Balls => 4.0 / 7.0,
            };
            let alpha = wishes.shrinks.then(|| wishes.alpha.unwrap_or(optimum));
            let estimate =
                VolumeEstimate { volume, kernel: wishes.kernel, radius: 1.0, alpha, paths: u64::MAX, direct: 1.0 };
            let paths = wishes.enough.map_or(u64::MAX, |enough| estimate.paths(scene, enough, photons, seed, observer));
            let (estimate, photons) =
                (VolumeEstimate { paths, ..estimate }, Photons { paths: photons.paths.min(paths), ..photons });
            let radius = wishes.radius.unwrap_or_else(|| {
                estimate.measure(scene, film, wishes.count, photons, seed, observer).unwrap_or_else(|| fallback(scene))
            });
            VolumeEstimate { radius, ..estimate }
        };
        Some(match wishes.volume {
            // What a beam weighs along its way is not known there.
            Some(Volume::Beams) | None if coloured_cloud(scene) => with(Volume::Points),
            Some(volume) => with(volume),
            None => {
                let beams = with(Volume::Beams);
                if free_flight(scene) > FREE_FLIGHT * beams.radius { beams } else { with(Volume::Points) }
            }
        })
    }

    /// Whether it can have been chosen so: films come from anywhere.
    pub(super) fn is_fit(&self) -> bool {
        let alpha = self.alpha.is_none_or(|alpha| (0.0..=1.0).contains(&alpha));
        let direct = (0.0..=1.0).contains(&self.direct);
        self.radius.is_finite() && self.radius > 0.0 && alpha && direct && self.paths > 0
    }

    /// The radius in a pass.
    fn radius_in(&self, pass: &Pass) -> f32 {
        let shrunk = match (self.alpha, self.volume) {
            (None, _) => 1.0,
            (Some(alpha), Volume::Beams) => shrunk::<1>(pass.index, alpha),
            (Some(alpha), Volume::Points) => shrunk::<2>(pass.index, alpha),
            (Some(alpha), Volume::Balls) => shrunk::<3>(pass.index, alpha),
        };
        self.radius * shrunk
    }

    /// The map of a pass.
    pub(super) fn map(&self, blocks: Vec<Vec<Beam>>, paths: u64, pass: &Pass) -> VolumeMap {
        VolumeMap::new(blocks, paths, self.volume, self.kernel, self.radius_in(pass))
    }

    /// How many light paths leave so many photons in media.
    fn paths(&self, scene: &Scene, enough: f64, photons: Photons, seed: u64, observer: &dyn Observer) -> u64 {
        let few = photons.paths.min(FEW_PATHS);
        let photons = Photons { paths: few, volume: Some(*self), ..photons };
        let maps = photons.maps(scene, &Pass { index: PASS, seed }, Radius::Fixed(1.0), || None, observer);
        let left = maps.volume.map_or(0, |map| map.beams().len());
        // None at all may be chance: then there can be as many as there are paths.
        ((enough * few as f64 / left as f64) as u64).max(1)
    }

    /// The radius within which a typical ray finds so many photons of a pass.
    fn measure(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        count: usize,
        photons: Photons,
        seed: u64,
        observer: &dyn Observer,
    ) -> Option<f32> {
        let paths = photons.paths.min(PILOT_PATHS);
        // The pilot's are fewer than those of a pass.
        let count = (count as f32 * paths as f32 / photons.paths as f32).max(1.0);
        let pass = Pass { index: PASS, seed };
        let photons = Photons { paths, volume: Some(VolumeEstimate { radius: f32::MAX.sqrt(), ..*self }), ..photons };
        let map = photons.maps(scene, &pass, Radius::Fixed(fallback(scene)), || None, observer).volume?;
        let typical = |ray: u64| {
            let mut along = Along { map: &map, distances: Vec::new() };
            look(scene, film, photons.max_bounces, seed, ray, &mut along);
            along.distances.sort_unstable_by(f32::total_cmp);
            let at = (count as usize).min(along.distances.len().checked_sub(1)?);
            // If there are fewer photons, by their density.
            Some(along.distances[at] * (count / (at as f32 + 1.0)).max(1.0).powf(1.0 / self.dimensions()))
        };
        median((0..RAYS).into_par_iter().filter_map(typical).collect())
    }

    /// Of the blur.
    fn dimensions(&self) -> f32 {
        match self.volume {
            Volume::Beams => 1.0,
            Volume::Points | Volume::Balls => 2.0,
        }
    }
}

/// The shortest mean distance between collisions in any medium that scatters.
fn free_flight(scene: &Scene) -> f32 {
    let media = 0..scene.media().len() as MediumId;
    let scatters = media.map(|id| scene.media()[usize::from(id)].matter(id, scene.basis()));
    scatters
        .filter(|matter| !matter.scattering.is_zero())
        .fold(f32::INFINITY, |shortest, matter| shortest.min(1.0 / matter.most_extinction()))
}

/// Whether in any medium of varying density the lanes differ.
fn coloured_cloud(scene: &Scene) -> bool {
    scene
        .media()
        .iter()
        .any(|medium| medium.cloud.as_ref().is_some_and(|cloud| cloud.is_coloured() || medium.is_coloured()))
}

/// Notes how far photons lie from the ways of a path.
struct Along<'m> {
    map: &'m VolumeMap,
    distances: Vec<f32>,
}

impl Visitor for Along<'_> {
    const CROSSING: Crossing = Crossing::Fade;

    fn segment(&mut self, segment: &Segment, _: &PathState, _: &mut Sampler) {
        self.distances.extend(self.map.distances(segment));
    }

    fn vertex(&mut self, _: &SurfacePoint, _: &PathState, _: &mut Sampler) -> Lobes {
        Lobes::DELTA
    }
}

/// The photons of a pass in media, as paths from the camera read them.
pub(super) struct MediumPhotons<'m> {
    pub map: &'m VolumeMap,
    /// Of a path and what it reads together.
    pub max_bounces: u32,
    /// With shadow rays, of light straight from lamps; where there is nobody to share with, photons bring all.
    pub sharing: Option<Sharing>,
}

impl MediumPhotons<'_> {
    /// Leaves at `sink` the light of all that shine along a segment, and tells of each.
    pub(super) fn gather<S: Sink>(
        &self,
        segment: &Segment,
        path: &PathState,
        sampler: &mut Sampler,
        sink: &mut S,
        mut tell: impl FnMut(&Beam, Spectrum),
    ) {
        // The event in which the photons are read is one of the path's, too.
        let Some(most) = self.max_bounces.checked_sub(path.bounce + 1) else { return };
        let aside = sampler.aside();
        self.map.gather(segment, path.slowness, sampler, |beam, light, [leg, way]| {
            if u32::from(beam.bounce) > most {
                return;
            }
            let share = match &self.sharing {
                Some(sharing) if beam.is_rivalled() => sharing.of_photons(from_lamp([leg, way], path)),
                _ => 1.0,
            };
            let light = path.throughput * light * share;
            tell(beam, light);
            if S::TIMED && path.bounce == 0 {
                sink.particle(path.optical_length + leg);
            }
            let events = path.bounce + 1 + u32::from(beam.bounce);
            let met = Met { events, is_caustic: path.bounce == 0 && beam.is_caustic(), particles: true };
            let key = [beam.path, u32::from(beam.bounce) << 16 | path.bounce & 0xffff];
            let delay = if S::TIMED { segment.matter.delay(|| aside.uniform(key)) } else { 0.0 };
            sink.add(light, met, path.optical_length + way + delay);
        });
    }
}
