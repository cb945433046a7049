//! Light tracing: walks from the lamps, each vertex connected to the camera (theory §4.5).
//!
//! It cannot see what the camera sees through glass or in mirrors; lamps and the background in plain sight are added by
//! rays from the camera.

use glam::{Vec2, Vec3};

use super::blocks::{camera_pass, light_pass};
use super::path::CAMERA_ROULETTE_FROM;
use super::{Integrator, Observer, Pass, Phase, Work};
use crate::film::{Arrival, Clock, Exposure, Kind, Layered, Layers, Plain, Sink, Timed};
use crate::material::{Bsdf, Lobes};
use crate::sampler::Sampler;
use crate::scene::description::{FilmDescription, LightSettings, TimeDescription};
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transient::Unwarp;
use crate::transport::{Limits, Origin, PathState, Visitor, walk};

/// See the module.
#[derive(Clone, Debug)]
pub struct LightTracing {
    /// How many paths, how long.
    pub settings: LightSettings,
}

impl Integrator for LightTracing {
    fn expose(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        layers: Layers,
        observer: &dyn Observer,
    ) -> Exposure {
        let [width, height] = film.size;
        let paths = self.settings.photons.map_or(u64::from(width) * u64::from(height), u64::from);
        let max_bounces = self.settings.max_bounces;
        observer.phase(Phase::Photons);
        let new = || Splat::new(scene, film, max_bounces);
        let blocks = light_pass(scene, pass, paths, max_bounces, observer, new);
        observer.phase(Phase::Camera);
        let clock = Clock::of(film);
        let mut exposure = match (clock, layers.is_empty()) {
            (None, true) => emission(Plain::default(), scene, film, pass, max_bounces, observer),
            (None, false) => emission(Layered::default(), scene, film, pass, max_bounces, observer),
            (Some(clock), none) => emission(Timed::new(clock, !none), scene, film, pass, max_bounces, observer),
        };
        let scale = 1.0 / paths as f32;
        let mut arrivals = Vec::new();
        for Splatted { at, light, kind, optical_length } in blocks.into_iter().flat_map(|block| block.splats) {
            for (pixel, share) in film.pixels_at(at) {
                let light = scene.basis().to_rgb(light * (scale * share));
                exposure.add(pixel as usize, light, kind);
                if let Some(clock) = &clock {
                    arrivals.push(Arrival { pixel: pixel as u32, slot: clock.slot(optical_length), light });
                }
            }
        }
        exposure.add_arrivals(arrivals);
        exposure
    }

    fn name(&self) -> &'static str {
        "light"
    }
}

/// Lamps and the background in plain sight.
fn emission<S: Sink>(
    empty: S,
    scene: &Scene,
    film: &FilmDescription,
    pass: &Pass,
    max_bounces: u32,
    observer: &dyn Observer,
) -> Exposure {
    camera_pass(
        scene,
        film,
        pass,
        1,
        &Rowless(observer),
        || (),
        empty,
        |path, sampler, (), sink| {
            let (mut light, mut ray, mut share, mut rays) = (Spectrum::ZERO, path.ray, 1.0, 0);
            let mut bsdf = Bsdf::default();
            let mut way = 0.0;
            // On through holes, if there are any.
            while share > 0.0 {
                let Some(point) = scene.closest_in_cone(&ray, path.cone, &mut bsdf) else {
                    let found = scene.background(ray.direction) * share;
                    sink.note(found, way + f64::from(scene.distance_from_far(ray.origin, ray.direction)));
                    light += found;
                    break;
                };
                rays += 1;
                let found = scene.emitted(&point) * share;
                way += f64::from(point.distance);
                sink.note(found, way);
                light += found;
                share *= point.bsdf.holes();
                ray = point.surface.spawn(ray.direction);
            }
            sink.add_noted(path.throughput * light, 0, path.throughput);
            if S::LAYERED {
                let limits = Limits { max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
                rays += walk(scene, path, Origin::Camera, &limits, sampler, &mut Surfaces(sink)).rays;
            }
            rays.max(1)
        },
    )
}

/// Tells of surfaces as far as the first with a smooth lobe.
struct Surfaces<'a, S>(&'a mut S);

impl<S: Sink> Visitor for Surfaces<'_, S> {
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
    kind: Kind,
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
            let splat = self.connect(point, path, sampler.square());
            self.splats.extend(splat);
        }
        Lobes::ALL
    }
}

impl<'a> Splat<'a> {
    pub(super) fn new(scene: &'a Scene, film: &'a FilmDescription, max_bounces: u32) -> Splat<'a> {
        Splat { scene, film, splats: Vec::new(), max_bounces }
    }

    fn connect(&self, point: &SurfacePoint, path: &PathState, lens: Vec2) -> Option<Splatted> {
        let seen = self.scene.seen_by_camera(point.surface.position, lens)?;
        self.film.pixels_at(seen.pixel).next()?;
        let to_camera = (seen.lens - point.surface.position).normalize();
        // The adjoint cosine: with a shading normal, it is the geometry that sends the light off.
        let cos = point.cos(to_camera) * point.geometric_over_shading(to_camera)
            / point.geometric_over_shading(point.to_previous).max(1e-3);
        let value = point.eval(to_camera) * (cos * seen.importance);
        let visibility = if value.is_zero() { 0.0 } else { self.scene.visibility_of(&point.surface, seen.lens) };
        let light = path.throughput * value * visibility;
        let kind = match path.bounce {
            0 => Kind::Direct,
            _ if PathState::is_caustic_history(path.history) => Kind::Caustic,
            _ => Kind::Other,
        };
        (visibility > 0.0).then(|| {
            let optical_length = self.optical_length(point, path, seen.lens);
            Splatted { at: seen.pixel, light, kind, optical_length }
        })
    }

    /// Of the way by a point to the camera, in scene units where the camera is, without what does not count.
    fn optical_length(&self, point: &SurfacePoint, path: &PathState, lens: Vec3) -> f64 {
        let to_camera = lens - point.surface.position;
        let ior = f64::from(path.ior * point.ior_toward(to_camera));
        let last = match &self.film.time {
            Some(TimeDescription { unwarp: Unwarp::FirstSurface | Unwarp::LastSegment, .. }) => 0.0,
            _ => f64::from(to_camera.length()),
        };
        path.optical_length / ior + last
    }
}
