//! Path tracing with next-event estimation and multiple importance sampling: the reference (theory §4.4).

use glam::Vec3;

use super::blocks::camera_pass;
use super::{Integrator, Observer, Pass, Phase};
use crate::image::Image;
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
    fn pass(&self, scene: &Scene, film: &FilmDescription, pass: &Pass, observer: &dyn Observer) -> Image {
        observer.phase(Phase::Camera);
        let limits = Limits { max_bounces: self.settings.max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
        camera_pass(
            scene,
            film,
            pass,
            self.settings.samples,
            observer,
            || (),
            |ray, sampler, ()| {
                let mut look = Look { scene, max_bounces: limits.max_bounces, radiance: Spectrum::ZERO, last: None };
                let walked =
                    walk(scene, PathState::new(ray, Spectrum::ONE), Origin::Camera, &limits, sampler, &mut look);
                (look.radiance, walked.rays)
            },
        )
    }

    fn name(&self) -> &'static str {
        "path"
    }
}

/// Adds up the light that a path from the camera meets.
struct Look<'s> {
    scene: &'s Scene,
    max_bounces: u32,
    radiance: Spectrum,
    /// Where and with which density the last smooth event chose its direction; none after a delta event.
    last: Option<(Vec3, f32)>,
}

impl Visitor for Look<'_> {
    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, sampler: &mut Sampler) -> Lobes {
        let emitted = self.scene.emitted(point);
        if !emitted.is_zero() {
            let weight = self.last.map_or(1.0, |(from, pdf)| mis_weight(pdf, self.scene.emitted_pdf(from, point)));
            self.radiance += path.throughput * emitted * weight;
        }
        if path.bounce < self.max_bounces {
            self.radiance += path.throughput * direct_light(self.scene, point, Some(Lobes::ALL), sampler);
        }
        Lobes::ALL
    }

    fn scattered(&mut self, scattered: &Scattered, point: &SurfacePoint, _: &PathState) {
        let smooth = Lobes::SMOOTH.contains(scattered.event);
        self.last = smooth.then_some((point.surface.position, scattered.pdf));
    }

    fn escaped(&mut self, path: &PathState) {
        let weight = self.last.map_or(1.0, |(_, pdf)| mis_weight(pdf, self.scene.background_pdf(path.ray.direction)));
        self.radiance += path.throughput * self.scene.background(path.ray.direction) * weight;
    }
}
