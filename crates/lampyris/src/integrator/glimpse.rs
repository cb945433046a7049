//! Glimpses: what shines where a path from the camera has not gone (theory §4.3).

use glam::Vec3;

use super::look::Look;
use crate::film::Sink;
use crate::material::{Event, Lobes, Scattered};
use crate::sampler::Sampler;
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transient::Met;
use crate::transport::{Limits, Origin, PathState, Visitor, squared, walk};

/// A glimpse from glass goes through so many of its boundaries: from within a pane and through another one.
pub(super) const BOUNDARIES: u32 = 4;

/// What glimpses have seen of the way on which a path is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// By this the light counts that the path meets next.
    pub left: f32,
    /// They have gone on from there through as many boundaries of glass, if there are so many.
    boundaries: u32,
}

impl Seen {
    pub(super) const NOTHING: Seen = Seen { left: 1.0, boundaries: 0 };

    /// What is seen of the way through this point.
    pub(super) fn beyond(self, point: &SurfacePoint) -> Seen {
        if self.boundaries > 0 && point.is_clear() { self } else { Seen::NOTHING }
    }
}

/// Whether paths that choose here leave something to glimpses. Where there is no smooth lobe all events see a sky about
/// alike, and the choice between them makes less noise than glimpses do.
pub(super) fn leaves_to_glimpses(scene: &Scene, point: &SurfacePoint) -> bool {
    let is_smooth = point.bsdf.lobes().meets(Lobes::SMOOTH);
    point.may_glimpse() && (is_smooth || !scene.has_sky()) && scene.has_glimpses()
}

impl<S: Sink, const MERGES: bool> Look<'_, S, MERGES> {
    /// Whether this path looks there. Where it merges with photons, these bring after the first smooth surface what glimpses
    /// would.
    fn glimpses(&self, point: &SurfacePoint) -> bool {
        let is_early = self.smooth_events == 0 || !MERGES;
        is_early && leaves_to_glimpses(self.scene, point)
    }

    /// The same for a glossy lobe.
    pub(super) fn glimpses_gloss(&self, point: &SurfacePoint) -> bool {
        point.bsdf.lobes().contains(Event::Glossy) && self.glimpses(point)
    }

    /// Looks where mirrors and glass would have led the path that has chosen otherwise, or something that leads nowhere, and
    /// adds the light of what shines there; a path that goes there counts it less. For lamps that are seen in a coat or in a
    /// pane that mirrors little of what falls on it, and would be met too rarely.
    pub(super) fn glimpse(&mut self, chosen: Option<&Scattered>, point: &SurfacePoint, path: &PathState) {
        let before = std::mem::replace(&mut self.seen, Seen::NOTHING);
        if point.bsdf.lobes().meets(Lobes::DELTA) && self.glimpses(point) {
            self.glimpse_beyond(before, chosen, point, path);
        }
    }

    #[inline(never)]
    fn glimpse_beyond(&mut self, before: Seen, chosen: Option<&Scattered>, point: &SurfacePoint, path: &PathState) {
        let boundaries = if point.is_clear() { BOUNDARIES } else { 0 };
        for delta in point.deltas() {
            let seen = match delta.event {
                Event::Refraction if before.boundaries > 0 => Seen { boundaries: before.boundaries - 1, ..before },
                _ => Seen { boundaries, ..Seen::NOTHING },
            };
            if let Some(chosen) = chosen.filter(|chosen| chosen.slot == delta.slot) {
                self.seen = Seen { left: chosen.pdf * seen.left, ..seen };
                continue;
            }
            let mut aside = *path;
            aside.turn(point, &delta, Origin::Camera);
            aside.throughput *= seen.left;
            if seen.boundaries == 0 && !self.scene.may_meet_light(&aside.ray) {
                continue;
            }
            let mut through = Through {
                scene: self.scene,
                sink: self.sink,
                boundaries: seen.boundaries,
                is_caustic: self.smooth_events == 1,
            };
            let limits = Limits { max_bounces: self.max_bounces, roulette_from: u32::MAX };
            // One event is left to follow at a time: no number decides anything.
            walk(self.scene, aside, Origin::Camera, &limits, &mut Sampler::new(0, 0, 0, 0), &mut through);
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
        let (value, pdf) = (point.eval_radiance(to_light), point.gloss_pdf(to_light));
        if value.is_zero() || pdf <= 0.0 {
            return;
        }
        let value = value * (point.cos(to_light) / pdf);
        let own = self.goes_on() * self.scene.scattering_pdf(point, to_light);
        let (ray, from) = (point.surface.spawn(to_light), (point.surface.position, self.vista));
        let scene = self.scene;
        scene.glimpse(&ray, path.cone.scattered(), from, |light, distance, shadow| {
            let weight = 1.0 / (1.0 + squared(own / pdf) + squared(self.shots() as f32 * shadow / pdf));
            let slowness = path.slowness * point.slowness_toward(to_light);
            let optical_length = path.optical_length + f64::from(slowness * distance);
            self.add_from(to_light, point, path.throughput * value * light * weight, path.met(1), optical_length);
        });
    }
}

/// The visitor of a glimpse that goes straight on through boundaries.
struct Through<'a, S> {
    scene: &'a Scene,
    sink: &'a mut S,
    /// So many of them.
    boundaries: u32,
    /// Whether one smooth surface came before: from the lamp, mirrors and glass came first, and then that.
    is_caustic: bool,
}

impl<S: Sink> Through<'_, S> {
    fn add(&mut self, light: Spectrum, path: &PathState, distance: f32) {
        let met = Met { is_caustic: self.is_caustic, ..path.met(0) };
        self.sink.add(path.throughput * light, met, path.optical_length + f64::from(path.slowness * distance));
    }
}

impl<S: Sink> Visitor for Through<'_, S> {
    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, _: &mut Sampler) -> Lobes {
        let emitted = self.scene.emitted(point);
        if !emitted.is_zero() {
            self.add(emitted, path, 0.0);
        }
        if self.boundaries == 0 || !point.is_clear() {
            return Lobes::NONE;
        }
        self.boundaries -= 1;
        Event::Refraction.into()
    }

    fn escaped(&mut self, path: &PathState) {
        let radiance = self.scene.background(path.ray.direction);
        if !radiance.is_zero() {
            self.add(radiance, path, self.scene.distance_from_far(path.ray.origin, path.ray.direction));
        }
    }
}
