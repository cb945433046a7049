//! Path tracing with next-event estimation and multiple importance sampling: the reference (theory §4.4).

use glam::Vec3;

use super::blocks::camera_pass;
use super::{Integrator, Observer, Pass, Phase};
use crate::film::{Exposure, Layered, Layers, Plain, Sink};
use crate::material::{Lobes, Scattered};
use crate::sampler::Sampler;
use crate::scene::description::{FilmDescription, PathSettings};
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transport::{Limits, Origin, PathState, Visitor, direct_light, mis_weight, walk};

/// See the module.
#[derive(Clone, Debug)]
pub struct PathTracing {
    /// How many samples, how long paths.
    pub settings: PathSettings,
}

/// Paths from the camera always make this many scattering events, unless something absorbs them; then roulette begins.
pub(super) const CAMERA_ROULETTE_FROM: u32 = 4;

impl Integrator for PathTracing {
    fn expose(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        layers: Layers,
        observer: &dyn Observer,
    ) -> Exposure {
        observer.phase(Phase::Camera);
        match layers.is_empty() {
            true => self.look::<Plain>(scene, film, pass, observer),
            false => self.look::<Layered>(scene, film, pass, observer),
        }
    }

    fn name(&self) -> &'static str {
        "path"
    }
}

impl PathTracing {
    fn look<S: Sink>(&self, scene: &Scene, film: &FilmDescription, pass: &Pass, observer: &dyn Observer) -> Exposure {
        let limits = Limits { max_bounces: self.settings.max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
        let samples = self.settings.samples;
        camera_pass(
            scene,
            film,
            pass,
            samples,
            observer,
            || (),
            |path, sampler, (), sink: &mut S| {
                let max_bounces = limits.max_bounces;
                let mut look = Look { scene, max_bounces, sink, last: None, smooth_events: 0 };
                walk(scene, path, Origin::Camera, &limits, sampler, &mut look).rays
            },
        )
    }
}

/// Adds up the light that a path from the camera meets.
struct Look<'a, S> {
    scene: &'a Scene,
    max_bounces: u32,
    sink: &'a mut S,
    /// Where and with which density the last smooth event chose its direction; none after a delta event.
    last: Option<(Vec3, f32)>,
    /// Smooth events so far.
    smooth_events: u32,
}

impl<S: Sink> Look<'_, S> {
    /// Adds light of a lamp that the path has reached.
    fn add(&mut self, light: Spectrum, events: u32) {
        self.sink.add(light, events);
        // From the lamp, mirrors and glass came first, and then one smooth surface.
        if S::LAYERED && self.last.is_none() && self.smooth_events == 1 {
            self.sink.was_caustic(light);
        }
    }
}

impl<S: Sink> Visitor for Look<'_, S> {
    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, sampler: &mut Sampler) -> Lobes {
        self.sink.surface(point, path);
        let emitted = self.scene.emitted(point);
        if !emitted.is_zero() {
            let weight = self.last.map_or(1.0, |(from, pdf)| mis_weight(pdf, self.scene.emitted_pdf(from, point)));
            self.add(path.throughput * emitted * weight, path.bounce);
        }
        if path.bounce < self.max_bounces {
            let light = direct_light(self.scene, point, Some(Lobes::ALL), sampler);
            self.sink.add(path.throughput * light, path.bounce + 1);
        }
        Lobes::ALL
    }

    fn scattered(&mut self, scattered: &Scattered, point: &SurfacePoint, _: &PathState) {
        let smooth = Lobes::SMOOTH.contains(scattered.event);
        self.last = smooth.then_some((point.surface.position, scattered.pdf));
        self.smooth_events += u32::from(smooth);
    }

    fn escaped(&mut self, path: &PathState) {
        // Each light by its own density: a shadow ray to one of them brings the light of that one alone.
        let weighted = |(radiance, of_shadow_rays): (Spectrum, f32)| {
            radiance * self.last.map_or(1.0, |(_, pdf)| mis_weight(pdf, of_shadow_rays))
        };
        let lights = self.scene.backgrounds(path.ray.direction).map(weighted);
        let radiance = lights.fold(Spectrum::ZERO, |sum, radiance| sum + radiance);
        self.add(path.throughput * radiance, path.bounce);
    }
}
