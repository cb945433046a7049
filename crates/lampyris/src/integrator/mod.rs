//! Integrators: each is its first rays and its visitor.

mod blocks;
mod dots;
mod light;
mod path;
mod photon_map;
mod pilot;

pub use light::LightTracing;
pub use path::PathTracing;
pub use photon_map::PhotonMapping;

use crate::image::Image;
use crate::scene::Scene;
use crate::scene::description::{FilmDescription, IntegratorDescription};

/// One pass of a render: together with the scene, everything that its picture depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// Its number, from 0.
    pub index: u32,
    /// The seed of the render.
    pub seed: u64,
}

/// A way to compute light.
pub trait Integrator: Send + Sync {
    /// The picture of one pass, in linear radiance: a pure function of scene and pass, up to the last bit, on any number
    /// of threads of the current `rayon` pool.
    fn pass(&self, scene: &Scene, film: &FilmDescription, pass: &Pass, observer: &dyn Observer) -> Image;

    /// Its name on the command line.
    fn name(&self) -> &'static str;
}

/// Who wants to know how a pass is getting on. Called from many threads.
pub trait Observer: Sync {
    /// A phase begins.
    fn phase(&self, _phase: Phase) {}

    /// Some work was done.
    fn work(&self, _work: &Work) {}
}

/// Nobody wants to know.
pub struct Silent;

impl Observer for Silent {}

/// The phases of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Phase {
    /// The radius is chosen, once, before the first pass.
    Pilot,
    /// Walks from the lamps.
    Photons,
    /// The photons are sorted.
    Map,
    /// Walks from the camera.
    Camera,
}

/// Work done since the last report.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Rays traced, shadow rays not counted.
    pub rays: u64,
    /// Walks from lamps.
    pub light_paths: u64,
    /// Photons stored.
    pub photons: u64,
    /// Flux that the lamps emitted, in W, mean of the lanes, as of one pass.
    pub flux_emitted: f64,
    /// Flux that was lost because its path grew too long.
    pub flux_cut: f64,
    /// Share of the current phase.
    pub share: f64,
}

/// The integrator that a scene file or a command line asks for. Chooses the photon map's first radius by a pilot
/// where none is given, which depends on the scene, the film, the settings and the seed alone.
pub fn integrator(
    scene: &Scene,
    film: &FilmDescription,
    description: &IntegratorDescription,
    seed: u64,
    observer: &dyn Observer,
) -> Box<dyn Integrator> {
    match description {
        IntegratorDescription::PhotonMap(settings) => {
            Box::new(PhotonMapping::new(scene, film, settings.clone(), seed, observer))
        }
        IntegratorDescription::Path(settings) => Box::new(PathTracing { settings: settings.clone() }),
        IntegratorDescription::Light(settings) => Box::new(LightTracing { settings: settings.clone() }),
    }
}
