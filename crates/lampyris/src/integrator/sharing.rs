//! How photons and shadow rays share light that comes straight from a lamp and is scattered once in a medium (theory §9.6).

use rayon::prelude::*;

use super::photons::{Maps, Photons};
use super::pilot::{PASS, look};
use super::volume::VolumeEstimate;
use super::{Observer, Pass};
use crate::film::Sink;
use crate::material::Lobes;
use crate::photon::{Beam, Radius, VolumeMap};
use crate::sampler::Sampler;
use crate::scene::description::{AutoSettings, FilmDescription};
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transient::Met;
use crate::transport::{Airlight, Crossing, PathState, Segment, Visitor, airlight};

/// What part of such light photons bring: multiple importance sampling with weights by the variance of each technique
/// [Grittmann et al. 2019], here one for all of a scene, and by the distance from the lamp.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sharing {
    /// Far from the lamp.
    pub photons: f32,
    /// Of the kernel, in scene units.
    pub radius: f32,
}

/// So many radii from a lamp, what kernels blur counts as much as noise.
const BLUR: f32 = 3.0;

/// Rays by which variances are judged.
const RAYS: u64 = 1024;

/// Each by so many shadow rays, so that the light itself is known well.
const SHADOW_RAYS: u32 = 16;

/// The passes of the photons, which no others look at.
const PASSES: u32 = PASS - 64;

/// What is worth less than this is left to the other technique.
const LEAST: f32 = 0.02;

impl Sharing {
    /// In a pass with these photons.
    pub(super) fn of(estimate: Option<VolumeEstimate>, maps: &Maps) -> Sharing {
        let photons = estimate.map_or(0.0, |estimate| estimate.direct);
        Sharing { photons, radius: maps.volume.as_ref().map_or(0.0, VolumeMap::radius) }
    }

    /// Of light from so far away, in scene units.
    pub(super) fn of_photons(&self, distance: f32) -> f32 {
        let blur = BLUR * self.radius / distance;
        self.photons / (1.0 + blur * blur)
    }

    /// Leaves at `sink` the part of the light of one shadow ray to the segment that photons do not bring.
    pub(super) fn shadow_ray<S: Sink>(
        &self,
        scene: &Scene,
        segment: &Segment,
        path: &PathState,
        sampler: &mut Sampler,
        sink: &mut S,
    ) {
        let aside = sampler.aside();
        let Some(Airlight { light, way: [leg, further] }) = airlight(scene, segment, path, sampler) else { return };
        let at = |distance: f32| path.optical_length + f64::from(path.slowness * distance);
        if S::TIMED && path.bounce == 0 {
            sink.particle(at(leg));
        }
        let share = 1.0 - self.of_photons(further);
        // Photons have numbers of paths in the place of the first of these.
        let delay = if S::TIMED { segment.matter.delay(|| aside.uniform([u32::MAX, path.bounce])) } else { 0.0 };
        let met = Met { particles: true, ..path.met(1) };
        sink.add(path.throughput * light * share, met, at(leg + further) + delay);
    }

    /// The part of photons far from lamps: by the variances that they have, and that shadow rays have, along rays from the
    /// camera, relative to what both see on each.
    pub(super) fn measure(
        scene: &Scene,
        film: &FilmDescription,
        settings: &AutoSettings,
        photons: Photons,
        estimate: VolumeEstimate,
        seed: u64,
        observer: &dyn Observer,
    ) -> f32 {
        // As in the first pass.
        let photons = Photons { volume: Some(VolumeEstimate { direct: 1.0, alpha: None, ..estimate }), ..photons };
        let map = |back: u32| {
            let pass = Pass { index: PASSES - back, seed };
            photons.maps(scene, &pass, Radius::Fixed(1.0), || None, observer).volume
        };
        let (Some(first), Some(second)) = (map(0), map(1)) else { return 0.0 };
        let sharing = Sharing { photons: 1.0, radius: estimate.radius };
        let ray = |number: u64| {
            let (maps, nothing) = ([&first, &second], [0.0; 2]);
            let mut both = Both { scene, maps, sharing, of_photons: nothing, of_shadow_rays: nothing };
            look(scene, film, photons.max_bounces, seed, number, &mut both);
            both
        };
        let rays: Vec<Both> = (0..RAYS).into_par_iter().map(ray).collect();
        let light = |both: &Both| both.of_photons.iter().chain(&both.of_shadow_rays).sum::<f64>() / 4.0;
        let typical = rays.iter().map(light).sum::<f64>() / rays.len() as f64;
        let variance = |estimates: fn(&Both) -> [f64; 2]| -> f64 {
            let relative = |both: &Both| {
                let ([a, b], light) = (estimates(both), light(both));
                (a - b).powi(2) / (light * light + 0.01 * typical * typical)
            };
            rays.iter().map(relative).sum()
        };
        let of_photons = variance(|both| both.of_photons);
        let of_shadow_rays =
            variance(|both| both.of_shadow_rays) * f64::from(SHADOW_RAYS) / f64::from(settings.samples);
        let share = of_shadow_rays / (of_shadow_rays + of_photons);
        if share > f64::from(LEAST) { share as f32 } else { 0.0 }
    }
}

/// Sees the same light by both techniques, twice each, until it first scatters smoothly.
struct Both<'a> {
    scene: &'a Scene,
    maps: [&'a VolumeMap; 2],
    sharing: Sharing,
    of_photons: [f64; 2],
    of_shadow_rays: [f64; 2],
}

impl Visitor for Both<'_> {
    const CROSSING: Crossing = Crossing::Fade;

    fn segment(&mut self, segment: &Segment, path: &PathState, sampler: &mut Sampler) {
        // Where photons are blurred is no matter of noise.
        for (sum, map) in self.of_photons.iter_mut().zip(self.maps) {
            map.gather(segment, path.slowness, sampler, |beam: &Beam, light: Spectrum, way| {
                if beam.is_rivalled() {
                    let share = self.sharing.of_photons(from_lamp(way, path));
                    *sum += f64::from((path.throughput * light * share).mean());
                }
            });
        }
        for number in 0..2 * SHADOW_RAYS {
            let sum = &mut self.of_shadow_rays[number as usize % 2];
            if let Some(Airlight { light, way: [_, further] }) = airlight(self.scene, segment, path, sampler) {
                let light = (path.throughput * light * self.sharing.of_photons(further)).mean();
                *sum += f64::from(light) / f64::from(SHADOW_RAYS);
            }
        }
    }

    fn vertex(&mut self, _: &SurfacePoint, _: &PathState, _: &mut Sampler) -> Lobes {
        Lobes::DELTA
    }
}

/// The distance of its lamp from where a photon that came straight from there is seen, in scene units, by the optical lengths
/// of the way to where it is seen and of the whole way.
pub(super) fn from_lamp([leg, way]: [f64; 2], path: &PathState) -> f32 {
    ((way - leg) / f64::from(path.slowness)) as f32
}
