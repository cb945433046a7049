//! Path tracing with next-event estimation and multiple importance sampling: the reference (theory §4.4).

use super::blocks::{Eye, camera_pass};
use super::look::Look;
use super::{Integrator, Observer, Pass, Phase};
use crate::film::{Arrival, Exposure, Layers, Sink};
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::scene::description::{FilmDescription, PathSettings};
use crate::transport::{Limits, Origin, PathState, walk};

/// See the module.
#[derive(Clone, Debug)]
pub struct PathTracing {
    /// How many samples, how long paths.
    pub settings: PathSettings,
}

/// Paths from the camera always make this many scattering events, unless something absorbs them; then roulette begins.
pub(super) const CAMERA_ROULETTE_FROM: u32 = 4;

impl Integrator for PathTracing {
    fn expose_in_parts(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        layers: Layers,
        observer: &dyn Observer,
        arrived: &mut dyn FnMut(&[Arrival]),
    ) -> Exposure {
        observer.phase(Phase::Camera);
        let limits = Limits { max_bounces: self.settings.max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
        camera_pass(scene, film, pass, self.settings.samples, layers, observer, &Paths { limits }, arrived)
    }

    fn name(&self) -> &'static str {
        "path"
    }
}

/// Follows paths on their own.
struct Paths {
    limits: Limits,
}

impl Eye for Paths {
    type Working = ();

    fn look<S: Sink>(&self, scene: &Scene, path: PathState, sampler: &mut Sampler, (): &mut (), sink: &mut S) -> u32 {
        let mut look = Look::alone(scene, self.limits.max_bounces, sink);
        walk(scene, path, Origin::Camera, &self.limits, sampler, &mut look).rays
    }
}
