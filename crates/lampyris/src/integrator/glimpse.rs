//! Glimpses: what shines where a path from the camera has not gone (theory §4.3).

use glam::Vec3;

use super::look::Look;
use crate::film::Sink;
use crate::material::{Event, Lobes, Scattered};
use crate::sampler::Sampler;
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transport::{Limits, Origin, PathState, Visitor, squared, walk};

/// A glimpse from glass goes through so many of its boundaries: from within a pane and through another one.
const BOUNDARIES: u32 = 4;

/// What glimpses have seen of the way on which a path is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// By this the light counts that the path meets next.
    pub left: f32,
    /// Through so many boundaries they have gone on.
    boundaries: u32,
}

impl Seen {
    pub(super) const NOTHING: Seen = Seen { left: 1.0, boundaries: 0 };

    /// What is seen of the way through this point.
    pub(super) fn beyond(self, point: &SurfacePoint) -> Seen {
        if self.boundaries > 0 && point.is_clear() { self } else { Seen::NOTHING }
    }
}

impl<S: Sink, const MERGES: bool> Look<'_, S, MERGES> {
    /// Whether glimpses are worth their price at a point: on the first smooth surface, and before it.
    pub(super) fn glimpses(&self, point: &SurfacePoint) -> bool {
        self.smooth_events == 0 && point.may_glimpse() && self.scene.has_glimpses()
    }

    /// Looks where mirrors and glass would have led the path that has chosen otherwise, and adds the light of what shines
    /// there; a path that goes there counts it less. For lamps that are seen in a coat or in a pane that mirrors little of
    /// what falls on it, and would be met too rarely.
    #[inline(never)]
    pub(super) fn glimpse(&mut self, chosen: &Scattered, point: &SurfacePoint, path: &PathState) {
        let before = std::mem::replace(&mut self.seen, Seen::NOTHING);
        let boundaries = if point.is_clear() { BOUNDARIES } else { 0 };
        for delta in point.deltas() {
            let seen = match delta.event {
                Event::Refraction if before.boundaries > 0 => Seen { boundaries: before.boundaries - 1, ..before },
                _ => Seen { boundaries, ..Seen::NOTHING },
            };
            if delta.slot == chosen.slot {
                self.seen = Seen { left: chosen.pdf * seen.left, ..seen };
                continue;
            }
            let mut aside = *path;
            aside.turn(point, &delta, Origin::Camera);
            aside.throughput *= seen.left;
            if seen.boundaries > 0 {
                let mut through = Through { scene: self.scene, sink: self.sink, boundaries: seen.boundaries };
                let limits = Limits { max_bounces: self.max_bounces, roulette_from: u32::MAX };
                // One event is left to follow at a time: no number decides anything.
                walk(self.scene, aside, Origin::Camera, &limits, &mut Sampler::new(0, 0, 0, 0), &mut through);
                continue;
            }
            let from = (point.surface.position, None);
            self.scene.glimpse(&aside.ray, aside.cone, from, |light, distance, _| {
                let optical_length = aside.optical_length + f64::from(aside.slowness * distance);
                self.sink.add(aside.throughput * light, aside.met(0), optical_length);
            });
        }
    }

    /// Looks once into the glossy lobe, where a path would have to choose between that and others, and adds the light of what
    /// shines there, weighed against shadow rays and the path itself.
    #[inline(never)]
    pub(super) fn glimpse_gloss(&mut self, point: &SurfacePoint, path: &PathState, sampler: &Sampler) {
        let mut sampler = sampler.ahead();
        let chosen = sampler.uniform();
        if let Some(to_light) = point.sample_gloss(sampler.square().extend(chosen)) {
            self.glimpse_toward(to_light, point, path);
        }
    }

    /// The same in a direction (world) that was drawn so.
    pub(super) fn glimpse_toward(&mut self, to_light: Vec3, point: &SurfacePoint, path: &PathState) {
        let pdf = point.gloss_pdf(to_light);
        let value = point.eval_radiance(to_light) * (point.cos(to_light) / pdf);
        if value.is_zero() || pdf <= 0.0 {
            return;
        }
        let own = self.goes_on() * self.scene.scattering_pdf(point, to_light);
        let (ray, from) = (point.surface.spawn(to_light), (point.surface.position, self.vista));
        self.scene.glimpse(&ray, path.cone.scattered(), from, |light, distance, shadow| {
            let weight = 1.0 / (1.0 + squared(own / pdf) + squared(shadow / pdf));
            let slowness = path.slowness * point.slowness_toward(to_light);
            let optical_length = path.optical_length + f64::from(slowness * distance);
            self.sink.add(path.throughput * value * light * weight, path.met(1), optical_length);
        });
    }
}

/// The visitor of a glimpse that goes through boundaries, straight on.
struct Through<'a, S> {
    scene: &'a Scene,
    sink: &'a mut S,
    boundaries: u32,
}

impl<S: Sink> Visitor for Through<'_, S> {
    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, _: &mut Sampler) -> Lobes {
        let emitted = self.scene.emitted(point);
        if !emitted.is_zero() {
            self.sink.add(path.throughput * emitted, path.met(0), path.optical_length);
        }
        if self.boundaries == 0 || !point.is_clear() {
            return Lobes::NONE;
        }
        self.boundaries -= 1;
        Event::Refraction.into()
    }

    fn escaped(&mut self, path: &PathState) {
        let background = self.scene.background(path.ray.direction);
        if background != Spectrum::ZERO {
            let distance = self.scene.distance_from_far(path.ray.origin, path.ray.direction);
            let optical_length = path.optical_length + f64::from(path.slowness * distance);
            self.sink.add(path.throughput * background, path.met(0), optical_length);
        }
    }
}
