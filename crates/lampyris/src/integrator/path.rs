//! Path tracing with next-event estimation and multiple importance sampling: the reference (theory §4.4).

use super::blocks::camera_pass;
use super::look::Look;
use super::{Integrator, Observer, Pass, Phase};
use crate::film::{Clock, Exposure, Layered, Layers, Plain, Sink, Timed};
use crate::scene::Scene;
use crate::scene::description::{FilmDescription, PathSettings};
use crate::transport::{Limits, Origin, walk};

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
        match (Clock::of(film), layers.is_empty()) {
            (None, true) => self.look(Plain::default(), scene, film, pass, observer),
            (None, false) => self.look(Layered::default(), scene, film, pass, observer),
            (Some(clock), none) => self.look(Timed::new(clock, !none), scene, film, pass, observer),
        }
    }

    fn name(&self) -> &'static str {
        "path"
    }
}

impl PathTracing {
    fn look<S: Sink>(
        &self,
        empty: S,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        observer: &dyn Observer,
    ) -> Exposure {
        let limits = Limits { max_bounces: self.settings.max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
        let samples = self.settings.samples;
        camera_pass(
            scene,
            film,
            pass,
            samples,
            observer,
            || (),
            empty,
            |path, sampler, (), sink| {
                let mut look = Look::new(scene, limits.max_bounces, sink, None);
                walk(scene, path, Origin::Camera, &limits, sampler, &mut look).rays
            },
        )
    }
}
