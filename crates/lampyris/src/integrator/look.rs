//! The visitor of path tracing, which can merge with photons on its way (theory §4.4, §5.4).

use std::cell::Cell;

use glam::Vec3;

use super::glimpse::Seen;
use super::merge::{Brought, Merge};
use super::reuse::Lending;
use super::sharing::Sharing;
use super::volume::MediumPhotons;
use crate::film::Sink;
use crate::light::{Illumination, LightId, Vista};
use crate::material::{Lobes, Scattered};
use crate::photon::VolumeMap;
use crate::sampler::Sampler;
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transient::Met;
use crate::transport::{
    Crossing, MediumPoint, PathState, Segment, Visitor, direct_light, direct_light_in_medium, mis_weight, squared,
};

/// Adds up the light that a path from the camera meets.
///
/// By itself it collides with particles of media; with photons, it gathers what they left there until it first scatters
/// smoothly: beyond, those on surfaces bring that light.
pub(super) struct Look<'a, S, const MERGES: bool> {
    pub(super) scene: &'a Scene,
    pub(super) max_bounces: u32,
    pub(super) sink: &'a mut S,
    /// The last smooth event; none after a delta event.
    last: Option<Last<'a>>,
    /// What is likely to be seen of the lights from the last surface.
    pub(super) vista: Option<Vista<'a>>,
    /// Smooth events so far.
    pub(super) smooth_events: u32,
    /// What glimpses have seen of its way.
    pub(super) seen: Seen,
    merge: Option<Merge<'a>>,
    /// Photons in media, and what part of the light straight from lamps is left to them.
    volume: Option<(&'a VolumeMap, Sharing)>,
    /// What it leaves for other paths.
    lending: Option<Lending<'a, S>>,
}

/// Shadow rays on the first smooth surface, if they differ: more leave less noise of direct light, of which there is most there,
/// and take more time; measured.
pub(super) const SHOTS: u32 = 2;

/// A smooth event of a path.
#[derive(Clone, Copy)]
struct Last<'a> {
    from: Vec3,
    /// Of the direction that it chose, per solid angle.
    pdf: f32,
    /// Of glimpses in that direction.
    glimpsed: f32,
    /// Shadow rays that were shot there.
    shots: f32,
    /// Where shadow rays are shot from there.
    vista: Option<Vista<'a>>,
}

impl<'a, S> Look<'a, S, false> {
    pub(super) fn alone(scene: &'a Scene, max_bounces: u32, sink: &'a mut S) -> Look<'a, S, false> {
        Look {
            scene,
            max_bounces,
            sink,
            last: None,
            vista: None,
            smooth_events: 0,
            seen: Seen::NOTHING,
            merge: None,
            volume: None,
            lending: None,
        }
    }
}

impl<'a, S> Look<'a, S, true> {
    pub(super) fn merging(
        scene: &'a Scene,
        max_bounces: u32,
        sink: &'a mut S,
        merge: Merge<'a>,
        volume: Option<(&'a VolumeMap, Sharing)>,
    ) -> Look<'a, S, true> {
        let merge = Some(merge);
        Look {
            scene,
            max_bounces,
            sink,
            last: None,
            vista: None,
            smooth_events: 0,
            seen: Seen::NOTHING,
            merge,
            volume,
            lending: None,
        }
    }
}

impl<'a, S, const MERGES: bool> Look<'a, S, MERGES> {
    /// The same, which notes here what it lends.
    pub(super) fn lending(self, lending: Option<Lending<'a, S>>) -> Self {
        Look { lending, ..self }
    }
}

impl<S, const MERGES: bool> Look<'_, S, MERGES> {
    /// The weight of a light that the path met by chance after its last smooth event, against glimpses, and shadow rays and
    /// photons of these densities.
    fn met(&self, of_shadow_rays: impl FnOnce(&Last) -> f32, of_photons: impl FnOnce() -> f32) -> f32 {
        let others =
            |last: Last| squared(last.shots * of_shadow_rays(&last) / last.pdf) + squared(last.glimpsed / last.pdf);
        let photons = |merge: &Merge| squared(merge.rivals_of_lamps.at_lamp(of_photons));
        1.0 / (1.0 + self.last.map_or(0.0, others) + self.merge.as_ref().map_or(0.0, photons))
    }
}

impl<S: Sink, const MERGES: bool> Look<'_, S, MERGES> {
    /// Adds light of a lamp that the path has reached.
    fn add(&mut self, light: Spectrum, path: &PathState, optical_length: f64) {
        let light = light * self.seen.left;
        // From the lamp, mirrors and glass came first, and then one smooth surface.
        let is_caustic = self.last.is_none() && self.smooth_events == 1;
        self.sink.add(light, Met { is_caustic, ..path.met(0) }, optical_length);
    }

    /// Adds light that comes to this point from this direction (world), and is lent if the point is the first that is.
    pub(super) fn add_from(
        &mut self,
        to_light: Vec3,
        point: &SurfacePoint,
        light: Spectrum,
        met: Met,
        optical_length: f64,
    ) {
        match self.lending.as_mut().and_then(|lending| lending.from(to_light, point)) {
            None => self.sink.add(light, met, optical_length),
            Some((lent, share)) => {
                lent.add(light * share, met, optical_length);
                if share != Spectrum::ONE {
                    self.sink.add(light * (Spectrum::ONE + share * -1.0), met, optical_length);
                }
            }
        }
    }

    /// Shadow rays that are shot at the point where the path is.
    pub(super) fn shots(&self) -> u32 {
        if self.smooth_events == 0 && self.scene.shadow_rays_differ() { SHOTS } else { 1 }
    }

    /// The probability with which the path goes on after it has scattered smoothly.
    pub(super) fn goes_on(&self) -> f32 {
        self.merge.as_ref().map_or(1.0, Merge::goes_on)
    }
}

impl<S: Sink, const MERGES: bool> Visitor for Look<'_, S, MERGES> {
    const CROSSING: Crossing = if MERGES { Crossing::Fade } else { Crossing::Collide };

    fn segment(&mut self, segment: &Segment, path: &PathState, sampler: &mut Sampler) {
        if let Some((map, sharing)) = self.volume
            && self.smooth_events == 0
        {
            let mut tally = self.merge.as_mut().and_then(|merge| merge.tally.as_deref_mut());
            if path.bounce < self.max_bounces {
                sharing.shadow_ray(self.scene, segment, path, sampler, self.sink);
            }
            let photons = MediumPhotons { map, max_bounces: self.max_bounces, sharing: Some(sharing) };
            photons.gather(segment, path, sampler, self.sink, |beam, light| {
                if let Some(tally) = &mut tally {
                    tally.push(Brought::in_a_medium(beam.path, light.mean()));
                }
            });
        }
    }

    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, sampler: &mut Sampler) -> Lobes {
        self.sink.surface(point, path);
        let emitted = self.scene.emitted(point);
        if !emitted.is_zero() {
            let weight = self.met(
                |last| self.scene.emitted_pdf(last.from, last.vista, point),
                || self.scene.emission_density(point),
            );
            self.add(path.throughput * emitted * weight, path, path.optical_length);
        }
        self.seen = self.seen.beyond(point);
        if let Some(lending) = &mut self.lending {
            lending.vertex(point, path);
        }
        if path.bounce < self.max_bounces {
            self.vista = self.scene.vista(&point.surface);
            let (at, on) = (self.merge.as_ref().map_or(0.0, |merge| merge.rivals.at(point)), self.goes_on());
            let glimpses = self.glimpses_gloss(point);
            if glimpses {
                self.glimpse_gloss(point, path, sampler);
            }
            let shots = self.shots();
            let toward = Cell::new(Vec3::ZERO);
            let weight = |light: LightId, illumination: &Illumination| {
                let to_light = illumination.to_light;
                toward.set(to_light);
                let chance = |pdf: f32| {
                    let glimpsed = if glimpses { point.gloss_pdf(to_light) } else { 0.0 };
                    let pdf = pdf * shots as f32;
                    squared(on * self.scene.scattering_pdf(point, to_light) / pdf) + squared(glimpsed / pdf)
                };
                // On the first smooth surface photons are no rivals of shadow rays.
                let photons = if at > 0.0 {
                    let emission = self.scene.emission_toward(point.surface.position, light, illumination);
                    squared(at * point.pdf_back(to_light, Lobes::ALL) * emission * point.geometric_cos(to_light))
                } else {
                    0.0
                };
                1.0 / (1.0 + photons + illumination.pdf.map_or(0.0, chance))
            };
            for number in 0..shots {
                let mut part = sampler.part(number, shots);
                let (light, distance) = direct_light(self.scene, point, self.vista, path, &mut part, weight);
                let optical_length = path.optical_length + f64::from(path.slowness * distance);
                let light = path.throughput * light * (1.0 / shots as f32);
                self.add_from(toward.get(), point, light, path.met(1), optical_length);
            }
            if let Some(merge) = &mut self.merge
                && point.bsdf.lobes().meets(Lobes::SMOOTH)
            {
                // The event in which the photons are read is one of the path's, too.
                let left = self.max_bounces - path.bounce - 1;
                if S::LAYERED && self.smooth_events == 0 {
                    let ([light, caustic], unit) = merge.radiance(point, path, left, self.sink);
                    self.sink.add_noted(path.throughput * light, path.bounce + 2, path.throughput * unit);
                    self.sink.was_caustic(path.throughput * caustic);
                } else {
                    let ([light], unit) = merge.radiance(point, path, left, self.sink);
                    self.sink.add_noted(path.throughput * light, path.bounce + 2, path.throughput * unit);
                }
            }
        }
        Lobes::ALL
    }

    fn medium_vertex(&mut self, point: &MediumPoint, path: &PathState, sampler: &mut Sampler) -> bool {
        if S::TIMED && path.bounce == 0 {
            self.sink.particle(path.optical_length - point.delay);
        }
        if path.bounce < self.max_bounces {
            let weight = |illumination: &Illumination| {
                illumination.pdf.map_or(1.0, |pdf| mis_weight(pdf, point.value(illumination.to_light)))
            };
            let (light, distance) = direct_light_in_medium(self.scene, point, path, sampler, weight);
            let optical_length = path.optical_length + f64::from(path.slowness * distance);
            self.sink.add(path.throughput * light, Met { particles: true, ..path.met(1) }, optical_length);
        }
        true
    }

    fn scattered_by_particle(&mut self, to_next: Vec3, point: &MediumPoint, _: &PathState) {
        self.last =
            Some(Last { from: point.position, pdf: point.value(to_next), glimpsed: 0.0, shots: 1.0, vista: None });
        self.smooth_events += 1;
    }

    fn scattered(&mut self, scattered: &Scattered, point: &SurfacePoint, path: &PathState) {
        let smooth = Lobes::SMOOTH.contains(scattered.event);
        self.glimpse(Some(scattered), point, path);
        if let Some(lending) = &mut self.lending {
            lending.scattered(Some(scattered), point, path, &mut self.sink);
        }
        let glimpsed = if smooth && self.glimpses_gloss(point) { point.gloss_pdf(scattered.to_next) } else { 0.0 };
        let on = self.merge.as_mut().map_or(1.0, |merge| merge.scattered(scattered, point, smooth));
        let last = Last {
            from: point.surface.position,
            pdf: on * scattered.pdf,
            glimpsed,
            shots: self.shots() as f32,
            vista: self.vista,
        };
        self.last = smooth.then_some(last);
        self.smooth_events += u32::from(smooth);
    }

    fn lost(&mut self, point: &SurfacePoint, path: &PathState) {
        self.glimpse(None, point, path);
    }

    fn escaped(&mut self, path: &PathState) {
        // Each light by its own density: a shadow ray to one of them brings the light of that one alone.
        let lights = self
            .scene
            .backgrounds(&path.ray, self.last.and_then(|last| last.vista))
            .map(|(radiance, of_shadow_rays, of_photons)| radiance * self.met(|_| of_shadow_rays, of_photons));
        let radiance = lights.fold(Spectrum::ZERO, |sum, radiance| sum + radiance);
        let distance = self.scene.distance_from_far(path.ray.origin, path.ray.direction);
        self.add(path.throughput * radiance, path, path.optical_length + f64::from(path.slowness * distance));
    }

    fn worth(&self) -> f32 {
        self.merge.as_ref().map_or(1.0, |merge| merge.went_on)
    }
}
