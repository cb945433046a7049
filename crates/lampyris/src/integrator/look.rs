//! The visitor of path tracing, which can merge with photons on its way (theory §4.4, §5.4).

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3;

use super::sharing::Sharing;
use super::volume::MediumPhotons;
use crate::film::Sink;
use crate::light::{Illumination, LightId, Vista};
use crate::material::{Event, Lobes, Scattered};
use crate::photon::{Estimate, Kernel, Nearest, Photon, PhotonMap, Radius, VolumeMap};
use crate::sampler::Sampler;
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transient::Met;
use crate::transport::{
    Crossing, MediumPoint, Origin, PathState, Rivals, Segment, Visitor, direct_light, direct_light_in_medium, mis_weight, norm,
    squared,
};

/// Adds up the light that a path from the camera meets.
///
/// By itself it collides with particles of media; with photons, it gathers what they left there until it first scatters
/// smoothly: beyond, those on surfaces bring that light.
pub(super) struct Look<'a, S, const MERGES: bool> {
    scene: &'a Scene,
    max_bounces: u32,
    sink: &'a mut S,
    /// The last smooth event; none after a delta event.
    last: Option<Last<'a>>,
    /// What is likely to be seen of the lights from the last surface.
    vista: Option<Vista<'a>>,
    /// Smooth events so far.
    smooth_events: u32,
    /// What glimpses leave to the path of the light that it meets next.
    left: f32,
    merge: Option<Merge<'a>>,
    /// Photons in media, and what part of the light straight from lamps is left to them.
    volume: Option<(&'a VolumeMap, Sharing)>,
}

/// A smooth event of a path.
#[derive(Clone, Copy)]
struct Last<'a> {
    from: Vec3,
    /// Of the direction that it chose, per solid angle.
    pdf: f32,
    /// Where shadow rays are shot from there.
    vista: Option<Vista<'a>>,
}

/// How paths from the camera are merged with the photons of a pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Merging {
    /// Light paths of the pass.
    pub paths: u64,
    /// How far photons are looked for in the first pass: on the first smooth surface that a path meets, over the width of
    /// what the path stands for there.
    pub first: f32,
    /// And on all further ones, in scene units.
    pub further: f32,
    /// Where photons are denser than that, as in a caustic, the nearest of so many are enough.
    pub nearest: usize,
    /// What is left of these radii.
    pub shrunk: f32,
    /// The probability with which a path goes on after scattering smoothly on the first smooth surface.
    pub on_from_first: f32,
    /// And on all further ones.
    pub on_from_further: f32,
}

impl Merging {
    /// How many photons would lie within what has become of this radius, if each light path left one in each square unit:
    /// the density of merging a path with a photon, over that of the two halves.
    pub(super) fn density(&self, radius: f32) -> f32 {
        PI * (self.shrunk * radius).powi(2) * self.paths as f32
    }
}

/// A path from the camera that is merged with photons.
pub(super) struct Merge<'a> {
    map: &'a PhotonMap,
    merging: Merging,
    found: &'a mut Nearest,
    /// What photons have brought, by the numbers of their paths, for those who ask.
    tally: Option<&'a mut Vec<(u32, f32)>>,
    /// What else could have made the path so far.
    rivals: Rivals,
    /// The same without merging at the last smooth point, for lamps that shine on it directly.
    rivals_of_lamps: Rivals,
    /// Whether the path has met mirrors and glass alone.
    first: bool,
    /// [`Merging::density`] at the last point.
    here: f32,
    /// The probability with which the path went on after its last event.
    went_on: f32,
}

impl<'a> Merge<'a> {
    pub(super) fn new(map: &'a PhotonMap, merging: Merging, found: &'a mut Nearest) -> Merge<'a> {
        let nothing = Rivals::default();
        let (first, here, went_on) = (true, 0.0, 1.0);
        Merge { map, merging, found, tally: None, rivals: nothing, rivals_of_lamps: nothing, first, here, went_on }
    }

    /// The same, which writes down what each photon brings: the mean of its radiance over all wavelengths, with the number
    /// of its path.
    pub(super) fn tallied(self, tally: &'a mut Vec<(u32, f32)>) -> Merge<'a> {
        Merge { tally: Some(tally), ..self }
    }

    /// The probability with which the path goes on after it has scattered smoothly here.
    fn goes_on(&self) -> f32 {
        if self.first { self.merging.on_from_first } else { self.merging.on_from_further }
    }

    /// The path leaves a point. Returns the probability with which it does.
    fn scattered(&mut self, scattered: &Scattered, point: &SurfacePoint, smooth: bool) -> f32 {
        let at = self.rivals.at(point);
        self.went_on = if smooth { self.goes_on() } else { 1.0 };
        let back = if smooth && at > 0.0 { at * point.pdf_back(scattered.to_next, Lobes::ALL) } else { 0.0 };
        let after = |smooth| Rivals::after(at, smooth, self.went_on, point, scattered);
        (self.rivals, self.rivals_of_lamps) = (after(norm([back, self.here])), after(back));
        self.first &= !smooth;
        self.went_on
    }

    /// Radiance back along the path of the light of photons that have been scattered at most so often; the second set has
    /// that of those among them that came by mirrors and glass alone. What each photon brings is noted in the sink; the unit
    /// of that comes last.
    fn radiance<const SETS: usize, S: Sink>(
        &mut self,
        point: &SurfacePoint,
        path: &PathState,
        max_bounces: u32,
        sink: &mut S,
    ) -> ([Spectrum; SETS], Spectrum) {
        let most = if self.first { self.merging.first * path.cone.width } else { self.merging.further };
        // Not by the radius that is found: weights must not depend on the photons that they weigh.
        self.here = self.merging.density(most);
        if !self.here.is_normal() {
            // Beyond all reason in size: nothing can be found so near, or told apart so far away.
            self.here = 0.0;
            return ([Spectrum::ZERO; SETS], Spectrum::ZERO);
        }
        let estimate = Estimate {
            map: self.map,
            kernel: Kernel::Epanechnikov,
            radius: Radius::Nearest { count: self.merging.nearest, max_radius: most },
        };
        let radius = self.merging.shrunk * estimate.find(point, self.found);
        let (at, on, per_photon) = (self.rivals.at(point), self.goes_on(), 1.0 / self.here);
        let counts = |photon: &Photon| u32::from(photon.bounce) <= max_bounces;
        if point.is_lambertian() {
            // The same as below, for the most frequent case.
            let nearer = 1.0 + squared(at * point.cos(point.to_previous) * (FRAC_1_PI * per_photon));
            let farther = on * FRAC_1_PI * per_photon;
            self.sum(&estimate, (point, path, radius), sink, |photon| {
                let others = nearer + squared(farther * photon.rivals * point.cos(photon.direction));
                sets(photon, counts(photon), others)
            })
        } else {
            self.sum(&estimate, (point, path, radius), sink, |photon| {
                let to_light = -photon.direction;
                let nearer = if at > 0.0 { at * point.pdf_back(to_light, Lobes::ALL) } else { 0.0 };
                let farther = on * photon.rivals * point.pdf(to_light, Lobes::ALL);
                sets(photon, counts(photon), 1.0 + squared(nearer * per_photon) + squared(farther * per_photon))
            })
        }
    }

    /// The light of the photons that were found within a radius, in sets, and its unit in the sink.
    fn sum<const SETS: usize, S: Sink>(
        &mut self,
        estimate: &Estimate,
        (point, path, radius): (&SurfacePoint, &PathState, f32),
        sink: &mut S,
        sets: impl Fn(&Photon) -> [f32; SETS],
    ) -> ([Spectrum; SETS], Spectrum) {
        let Some(tally) = &mut self.tally else {
            return estimate
                .weighted(point, radius, self.found, sets, |photon, light| note(sink, photon, light, point, path));
        };
        let mut light_of = Vec::new();
        let (sums, unit) = estimate.weighted(point, radius, self.found, sets, |photon, light| {
            light_of.push((photon.path, light));
        });
        let seen = unit * path.throughput;
        tally.extend(light_of.into_iter().map(|(number, light)| (number, (light * seen).mean())));
        (sums, unit)
    }
}

/// Notes the light of a photon that is read at `point`, where `path` from the camera has come, by its time.
#[inline]
pub(super) fn note<S: Sink>(sink: &mut S, photon: &Photon, light: Spectrum, point: &SurfacePoint, path: &PathState) {
    if S::TIMED {
        let slowness = path.slowness * point.slowness_toward(-photon.direction);
        let read = path.met(1 + u32::from(photon.bounce));
        let met = Met {
            is_caustic: photon.is_caustic() && !path.history.meets(Lobes::SMOOTH),
            particles: read.particles || photon.history.contains(Event::Scatter),
            ..read
        };
        sink.note(light, met, path.optical_length + photon.optical_length_at(point.surface.position, slowness));
    }
}

/// The weights of a photon that counts, where `others` is the density of all ways to make its path over that of merging:
/// in all light, and in caustics.
#[inline]
fn sets<const SETS: usize>(photon: &Photon, counts: bool, others: f32) -> [f32; SETS] {
    let weight = if counts { 1.0 / others } else { 0.0 };
    std::array::from_fn(|set| if set == 0 || photon.is_caustic() { weight } else { 0.0 })
}

impl<'a, S> Look<'a, S, false> {
    pub(super) fn alone(scene: &'a Scene, max_bounces: u32, sink: &'a mut S) -> Look<'a, S, false> {
        Look { scene, max_bounces, sink, last: None, vista: None, smooth_events: 0, left: 1.0, merge: None, volume: None }
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
        Look { scene, max_bounces, sink, last: None, vista: None, smooth_events: 0, left: 1.0, merge, volume }
    }
}

impl<S, const MERGES: bool> Look<'_, S, MERGES> {
    /// The weight of a light that the path met by chance after leaving a surface with a density of `pdf` per solid angle,
    /// where shadow rays and photons have these.
    fn met(&self, of_shadow_rays: impl FnOnce(&Last) -> f32, of_photons: impl FnOnce() -> f32) -> f32 {
        match &self.merge {
            None => self.last.map_or(1.0, |last| mis_weight(last.pdf, of_shadow_rays(&last))),
            Some(merge) => {
                let shadow_rays = self.last.map_or(0.0, |last| squared(of_shadow_rays(&last) / last.pdf));
                1.0 / (1.0 + shadow_rays + squared(merge.rivals_of_lamps.at_lamp(of_photons)))
            }
        }
    }
}

impl<S: Sink, const MERGES: bool> Look<'_, S, MERGES> {
    /// Adds light of a lamp that the path has reached.
    fn add(&mut self, light: Spectrum, path: &PathState, optical_length: f64) {
        let light = light * self.left;
        // From the lamp, mirrors and glass came first, and then one smooth surface.
        let is_caustic = self.last.is_none() && self.smooth_events == 1;
        self.sink.add(light, Met { is_caustic, ..path.met(0) }, optical_length);
    }

    /// Looks where mirrors and glass would have led the path that has chosen otherwise, and adds the light of what shines
    /// there. Returns what is left of such light for the path itself, if it goes where one of them leads: lamps are seen
    /// in a coat or in a pane that mirrors little of what falls on it, and would be met too rarely.
    #[inline(never)]
    fn glimpse(&mut self, chosen: &Scattered, point: &SurfacePoint, path: &PathState) -> f32 {
        let mut left = 1.0;
        for delta in point.deltas() {
            if delta.slot == chosen.slot {
                left = chosen.pdf;
                continue;
            }
            let mut aside = *path;
            aside.turn(point, &delta, Origin::Camera);
            if let Some((light, distance)) = self.scene.glimpse(&aside.ray, aside.cone) {
                let optical_length = aside.optical_length + f64::from(aside.slowness * distance);
                self.sink.add(aside.throughput * light, aside.met(0), optical_length);
            }
        }
        left
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
                    tally.push((beam.path, light.mean()));
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
        self.left = 1.0;
        if path.bounce < self.max_bounces {
            self.vista = self.scene.vista(&point.surface);
            let merge = self.merge.as_ref().map(|merge| (merge.rivals.at(point), merge.goes_on()));
            let weight = |light: LightId, illumination: &Illumination| {
                let to_light = illumination.to_light;
                let chance = || self.scene.scattering_pdf(point, to_light);
                match merge {
                    None => illumination.pdf.map_or(1.0, |pdf| mis_weight(pdf, chance())),
                    Some((at, on)) => {
                        // On the first smooth surface photons are no rivals of shadow rays.
                        let photons = if at > 0.0 {
                            let emission = self.scene.emission_toward(point.surface.position, light, illumination);
                            squared(
                                at * point.pdf_back(to_light, Lobes::ALL) * emission * point.geometric_cos(to_light),
                            )
                        } else {
                            0.0
                        };
                        1.0 / (1.0 + photons + illumination.pdf.map_or(0.0, |pdf| squared(on * chance() / pdf)))
                    }
                }
            };
            let (light, distance) = direct_light(self.scene, point, self.vista, path, sampler, weight);
            let optical_length = path.optical_length + f64::from(path.slowness * distance);
            self.sink.add(path.throughput * light, path.met(1), optical_length);
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
        self.last = Some(Last { from: point.position, pdf: point.value(to_next), vista: None });
        self.smooth_events += 1;
    }

    fn scattered(&mut self, scattered: &Scattered, point: &SurfacePoint, path: &PathState) {
        if self.smooth_events == 0 && point.may_glimpse() && self.scene.has_glimpses() {
            self.left = self.glimpse(scattered, point, path);
        }
        let smooth = Lobes::SMOOTH.contains(scattered.event);
        let on = self.merge.as_mut().map_or(1.0, |merge| merge.scattered(scattered, point, smooth));
        let last = Last { from: point.surface.position, pdf: on * scattered.pdf, vista: self.vista };
        self.last = smooth.then_some(last);
        self.smooth_events += u32::from(smooth);
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
