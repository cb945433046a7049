//! Light tracing: walks from the lamps, each vertex connected to the camera (theory §4.5).
//!
//! It cannot see what the camera sees through glass or in mirrors; lamps and the background in plain sight are added by
//! rays from the camera.

use glam::{Vec2, Vec3};

use super::blocks::{CameraPass, Eye, light_pass};
use super::path::CAMERA_ROULETTE_FROM;
use super::reuse::Lending;
use super::{Integrator, Observer, Pass, Phase, Work};
use crate::camera::Seen;
use crate::film::{Arrival, Clock, Exposure, Layers, Sink};
use crate::light::Illumination;
use crate::material::Lobes;
use crate::sampler::Sampler;
use crate::scene::description::{FilmDescription, LightSettings, TimeDescription};
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transient::{Met, Unwarp};
use crate::transport::{Crossing, Limits, MediumPoint, Origin, PathState, Visitor, walk};

/// See the module.
#[derive(Clone, Debug)]
pub struct LightTracing {
    /// How many paths, how long.
    pub settings: LightSettings,
}

impl Integrator for LightTracing {
    fn expose_in_parts(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        layers: Layers,
        observer: &dyn Observer,
        arrived: &mut dyn FnMut(&[Arrival]),
    ) -> Exposure {
        let [width, height] = film.size;
        let paths = self.settings.photons.map_or(u64::from(width) * u64::from(height), u64::from);
        let max_bounces = self.settings.max_bounces;
        observer.phase(Phase::Photons);
        let new = || Splat::new(scene, film, max_bounces);
        let blocks = light_pass(scene, pass, paths, max_bounces, observer, new);
        observer.phase(Phase::Camera);
        let limits = Limits { max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
        let (observer, eye) = (&Rowless(observer), &PlainSight { limits });
        let mut in_sight = Vec::new();
        let mut see = |part: &[Arrival]| in_sight.extend_from_slice(part);
        let camera_pass = CameraPass { scene, film, pass, samples: 1, layers, observer };
        let mut exposure = camera_pass.expose(eye, &mut see);
        // Splats come to any pixel at any time: there are no parts before all are there.
        exposure.arrivals = in_sight;
        let clock = Clock::of(film);
        let scale = 1.0 / paths as f32;
        let mut arrivals = Vec::new();
        for Splatted { at, light, met, optical_length } in blocks.into_iter().flat_map(|block| block.splats) {
            for (pixel, share) in film.pixels_at(at) {
                let light = scene.basis().to_rgb(light * (scale * share));
                exposure.add(pixel as usize, light, met);
                if let Some(clock) = &clock {
                    let arrival = |slot, share| Arrival { pixel, slot, light: light.map(|channel| channel * share) };
                    clock.note(optical_length, met, |slot, share| arrivals.push(arrival(slot, share)));
                    if arrivals.len() > AT_ONCE {
                        exposure.add_arrivals(arrivals.drain(..));
                    }
                }
            }
        }
        exposure.add_arrivals(arrivals);
        arrived(&std::mem::take(&mut exposure.arrivals));
        exposure
    }

    fn name(&self) -> &'static str {
        "light"
    }
}

/// Arrivals that are kept until they are added up.
const AT_ONCE: usize = 1 << 22;

/// Sees lamps and the background in plain sight.
struct PlainSight {
    limits: Limits,
}

impl Eye for PlainSight {
    type Working = ();

    fn look<S: Sink>(
        &self,
        scene: &Scene,
        path: PathState,
        sampler: &mut Sampler,
        (): &mut (),
        sink: &mut S,
        _: Option<Lending<S>>,
    ) -> u32 {
        let PlainSight { limits } = *self;
        let mut rays = walk(scene, path, Origin::Camera, &limits, sampler, &mut InSight { scene, sink }).rays;
        if S::LAYERED {
            rays += walk(scene, path, Origin::Camera, &limits, sampler, &mut Surfaces(sink)).rays;
        }
        rays
    }
}

/// Adds what shines in plain sight, or through holes.
struct InSight<'a, S> {
    scene: &'a Scene,
    sink: &'a mut S,
}

impl<S: Sink> Visitor for InSight<'_, S> {
    const CROSSING: Crossing = Crossing::Fade;

    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, _: &mut Sampler) -> Lobes {
        self.sink.add(path.throughput * self.scene.emitted(point), Met::surfaces(0), path.optical_length);
        point.bsdf.lobes().and(Lobes::HOLES)
    }

    fn escaped(&mut self, path: &PathState) {
        let distance = self.scene.distance_from_far(path.ray.origin, path.ray.direction);
        let optical_length = path.optical_length + f64::from(distance);
        let background = self.scene.background(path.ray.direction);
        self.sink.add(path.throughput * background, Met::surfaces(0), optical_length);
    }
}

/// Tells of surfaces as far as the first with a smooth lobe.
struct Surfaces<'a, S>(&'a mut S);

impl<S: Sink> Visitor for Surfaces<'_, S> {
    const CROSSING: Crossing = Crossing::Fade;

    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, _: &mut Sampler) -> Lobes {
        self.0.surface(point, path);
        if point.bsdf.lobes().meets(Lobes::SMOOTH) { Lobes::NONE } else { Lobes::DELTA }
    }
}

/// Passes on everything but rows, which lack most of their light.
struct Rowless<'a>(&'a dyn Observer);

impl Observer for Rowless<'_> {
    fn work(&self, work: &Work) {
        self.0.work(work);
    }
}

/// Light that arrives at the camera.
pub(super) struct Splatted {
    /// The point of the picture, in pixels.
    at: Vec2,
    /// Radiance as if the path were the only one.
    pub light: Spectrum,
    /// What it met on its way.
    met: Met,
    /// Optical length of its way, in scene units, as far as it counts.
    pub optical_length: f64,
}

/// Connects every vertex to the camera.
pub(super) struct Splat<'a> {
    scene: &'a Scene,
    film: &'a FilmDescription,
    pub splats: Vec<Splatted>,
    max_bounces: u32,
}

impl Visitor for Splat<'_> {
    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, sampler: &mut Sampler) -> Lobes {
        if path.bounce < self.max_bounces && point.bsdf.lobes().meets(Lobes::SMOOTH) {
            let splat = self.connect(point, path, sampler);
            self.splats.extend(splat);
        }
        Lobes::ALL
    }

    fn medium_vertex(&mut self, point: &MediumPoint, path: &PathState, sampler: &mut Sampler) -> bool {
        if path.bounce < self.max_bounces {
            let splat = self.connect_particle(point, path, sampler);
            self.splats.extend(splat);
        }
        true
    }
}

impl<'a> Splat<'a> {
    pub(super) fn new(scene: &'a Scene, film: &'a FilmDescription, max_bounces: u32) -> Splat<'a> {
        Splat { scene, film, splats: Vec::new(), max_bounces }
    }

    /// The camera as a point sees it, if the point is in the picture.
    fn seen(&self, at: Vec3, sampler: &mut Sampler) -> Option<(Seen, Vec3)> {
        let seen = self.scene.seen_by_camera(at, sampler.square())?;
        self.film.pixels_at(seen.pixel).next()?;
        Some((seen, (seen.lens - at).normalize()))
    }

    fn connect(&self, point: &SurfacePoint, path: &PathState, sampler: &mut Sampler) -> Option<Splatted> {
        let at = point.surface.position;
        let (seen, to_camera) = self.seen(at, sampler)?;
        let value = point.sent(to_camera) * seen.importance;
        let way = Illumination::way(at, seen.lens);
        let light = match value.is_zero() {
            true => value,
            false if self.scene.has_media() => {
                path.throughput * value * self.scene.passage_to(point, &path.inside, &way, sampler)
            }
            false => path.throughput * value * self.scene.visibility(&point.surface, &way),
        };
        let slowness = || path.slowness * point.slowness_toward(seen.lens - at);
        self.splatted(&seen, light, path, (at, false), slowness)
    }

    fn connect_particle(&self, point: &MediumPoint, path: &PathState, sampler: &mut Sampler) -> Option<Splatted> {
        let (seen, to_camera) = self.seen(point.position, sampler)?;
        let way = Illumination::way(point.position, seen.lens);
        let passage = self.scene.passage(point.position, path.inside, &way, sampler);
        let value = point.albedo * (point.value(to_camera) * seen.importance);
        self.splatted(&seen, path.throughput * value * passage, path, (point.position, true), || path.slowness)
    }

    /// Light that a path brings to the camera from a point, which may be a particle of a medium, where light is so
    /// slow to go on; unless there is none.
    fn splatted(
        &self,
        seen: &Seen,
        light: Spectrum,
        path: &PathState,
        (at, particle): (Vec3, bool),
        slowness: impl FnOnce() -> f32,
    ) -> Option<Splatted> {
        let read = path.met(1);
        let is_caustic = PathState::is_caustic_history(path.history);
        let met = Met { is_caustic, particles: read.particles || particle, ..read };
        (!light.is_zero()).then(|| {
            // In scene units where the camera is, without what does not count.
            let last = match &self.film.time {
                Some(TimeDescription { unwarp: Unwarp::FirstSurface | Unwarp::LastSegment, .. }) => 0.0,
                _ => f64::from(seen.lens.distance(at)),
            };
            let optical_length = path.optical_length / f64::from(slowness()) + last;
            Splatted { at: seen.pixel, light, met, optical_length }
        })
    }
}
