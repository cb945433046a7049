//! Integrators: each is its first rays and its visitor.

mod alone;
mod auto;
mod blocks;
mod dots;
mod glimpse;
mod groups;
mod guiding;
mod light;
mod look;
mod merge;
mod path;
mod photon_map;
mod photons;
mod pilot;
mod range;
mod reuse;
mod sharing;
mod survey;
#[cfg(test)]
mod tests;
mod volume;

pub use auto::Auto;
pub use light::LightTracing;
pub use path::PathTracing;
pub use photon_map::PhotonMapping;
pub use range::timed;

use std::borrow::Cow;
use std::sync::Arc;

use crate::error::Result;
use crate::film::{Arrival, Exposure, Layers};
pub use crate::observer::{Observer, Phase, Silent, Work};
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
    /// One pass, with what these layers need: a pure function of scene and pass, up to the last bit, on any number of
    /// threads of the current `rayon` pool. The picture is the same for any layers.
    fn expose(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        layers: Layers,
        observer: &dyn Observer,
    ) -> Exposure {
        let mut arrivals = Vec::new();
        let mut arrived = |part: &[Arrival]| arrivals.extend_from_slice(part);
        let exposure = self.expose_in_parts(scene, film, pass, layers, observer, &mut arrived);
        Exposure { arrivals, ..exposure }
    }

    /// [`Integrator::expose`], without its arrivals: `arrived` is told of these, some at a time, in their order. All of them
    /// together may be more than there is memory.
    fn expose_in_parts(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        layers: Layers,
        observer: &dyn Observer,
        arrived: &mut dyn FnMut(&[Arrival]),
    ) -> Exposure;

    /// The area over which a pass gathers photons, that of the first being 1, if it shrinks from pass to pass: bias is in
    /// proportion to it.
    fn area(&self, _pass: &Pass) -> Option<f64> {
        None
    }

    /// What it found out before the first pass and a user may wonder about, as part of a sentence.
    fn remark(&self) -> Option<&'static str> {
        None
    }

    /// Its name on the command line.
    fn name(&self) -> &'static str;

    /// What it measured before the first pass, for [`resumed`]; nothing, if it measures nothing.
    fn pilot(&self) -> Vec<u8> {
        Vec::new()
    }
}

/// The scene with what was learned of it, if anything was.
fn with<'s, T>(scene: &'s Scene, learned: &Option<Arc<T>>, with: fn(&Scene, Arc<T>) -> Scene) -> Cow<'s, Scene> {
    learned.as_ref().map_or(Cow::Borrowed(scene), |learned| Cow::Owned(with(scene, learned.clone())))
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
        IntegratorDescription::Auto(settings) => Box::new(Auto::new(scene, film, settings.clone(), seed, observer)),
        IntegratorDescription::PhotonMap(settings) => {
            Box::new(PhotonMapping::new(scene, film, settings.clone(), seed, observer))
        }
        IntegratorDescription::Path(settings) => {
            Box::new(PathTracing::new(scene, film, settings.clone(), seed, observer))
        }
        IntegratorDescription::Light(settings) => Box::new(LightTracing { settings: settings.clone() }),
    }
}

/// The same integrator as [`integrator`] makes, to the bit, without measuring again: `pilot` is what the first one measured.
///
/// # Errors
/// If no integrator with these settings has measured that, or not in a scene like this.
pub fn resumed(scene: &Scene, description: &IntegratorDescription, pilot: &[u8]) -> Result<Box<dyn Integrator>> {
    Ok(match description {
        IntegratorDescription::Auto(settings) => Box::new(Auto::resumed(scene, settings.clone(), pilot)?),
        IntegratorDescription::PhotonMap(settings) => {
            Box::new(PhotonMapping::resumed(settings.clone(), pilot::read(pilot)?)?)
        }
        IntegratorDescription::Path(settings) => Box::new(PathTracing::resumed(scene, settings.clone(), pilot)?),
        IntegratorDescription::Light(settings) => Box::new(LightTracing { settings: settings.clone() }),
    })
}
