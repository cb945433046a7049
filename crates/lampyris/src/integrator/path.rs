//! Path tracing with next-event estimation and multiple importance sampling: the reference (theory §4.4).

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::blocks::{CameraPass, Eye};
use super::look::Look;
use super::reuse::Lending;
use super::survey::{outlook, survey};
use super::{Integrator, Observer, Pass, Phase, pilot, reuse, with};
use crate::error::Result;
use crate::film::{Arrival, Exposure, Layers, Sink};
use crate::light::{Outlook, Sightings};
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::scene::description::{FilmDescription, PathSettings};
use crate::transport::{Limits, Origin, PathState, walk};

/// See the module.
#[derive(Clone, Debug)]
pub struct PathTracing {
    settings: PathSettings,
    pilot: Pilot,
    outlook: Option<Arc<Outlook>>,
}

/// What is measured before the first pass.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Pilot {
    /// Where shadow rays are shot, if that was worth learning.
    seen: Option<Sightings>,
}

impl PathTracing {
    /// With these settings: how many samples, how long paths; and what a pilot learns of the lights.
    pub fn new(
        scene: &Scene,
        film: &FilmDescription,
        settings: PathSettings,
        seed: u64,
        observer: &dyn Observer,
    ) -> PathTracing {
        let learned = settings.guiding.then(|| survey(scene, film, settings.max_bounces, seed, observer));
        PathTracing::seeing(scene, settings, learned.flatten())
    }

    /// With what was learned of the lights, if that is worth anything.
    pub(super) fn seeing(scene: &Scene, settings: PathSettings, seen: Option<Sightings>) -> PathTracing {
        let outlook = seen.as_ref().and_then(|seen| outlook(scene, seen));
        PathTracing { settings, outlook, pilot: Pilot { seen } }
    }

    /// With what a pilot has learned before.
    ///
    /// # Errors
    /// If it is no such thing, or not about such a scene.
    pub(super) fn resumed(scene: &Scene, settings: PathSettings, pilot: &[u8]) -> Result<PathTracing> {
        let pilot: Pilot = pilot::read(pilot)?;
        let outlook = pilot.seen.as_ref().map(|seen| outlook(scene, seen).ok_or_else(pilot::unfit)).transpose()?;
        Ok(PathTracing { settings, pilot, outlook })
    }
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
        let scene = &*with(scene, &self.outlook, Scene::with_outlook);
        let limits = Limits { max_bounces: self.settings.max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
        CameraPass { scene, film, pass, samples: self.settings.samples, layers, observer }
            .expose(&Paths { limits, reuse: self.settings.reuse }, arrived)
    }

    fn name(&self) -> &'static str {
        "path"
    }

    fn pilot(&self) -> Vec<u8> {
        pilot::write(&self.pilot)
    }
}

/// Follows paths on their own.
struct Paths {
    limits: Limits,
    /// Whether paths lend each other what they find.
    reuse: bool,
}

impl Eye for Paths {
    type Working = ();

    fn lends(&self, scene: &Scene) -> bool {
        self.reuse && reuse::is_possible(scene)
    }

    fn look<S: Sink>(
        &self,
        scene: &Scene,
        path: PathState,
        sampler: &mut Sampler,
        (): &mut (),
        sink: &mut S,
        lending: Option<Lending<S>>,
    ) -> u32 {
        let mut look = Look::alone(scene, self.limits.max_bounces, sink).lending(lending);
        walk(scene, path, Origin::Camera, &self.limits, sampler, &mut look).rays
    }
}
