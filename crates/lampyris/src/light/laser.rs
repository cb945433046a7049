//! An infinitely thin beam, as the point that it lights.

use glam::Vec3;

use super::{Emission, Emit, Illumination, Source};
use crate::geometry::{Ray, Surfaces};
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// An infinitely thin beam from a point. Its lamp, as far as paths of light are concerned, is the spot where it first meets a
/// surface: the scene knows that one, and lets the spot send the beam's light on as the material there does.
#[derive(Clone, Copy, Debug)]
pub struct Laser {
    /// Where the beam starts.
    pub position: Vec3,
    /// A point that it goes through; none if whoever looks at the scene says so.
    pub target: Option<Vec3>,
    /// Flux in W.
    pub power: Spectrum,
}

impl Laser {
    /// The beam to a point; none if it is that in which it starts.
    pub fn ray(&self, target: Vec3) -> Option<Ray> {
        let direction = (target - self.position).try_normalize()?;
        Some(Ray { origin: self.position, direction })
    }
}

impl Emit for Laser {
    /// The beam itself, before it has met anything.
    fn emit(&self, _: &Surfaces, _: &mut Sampler) -> Option<Emission> {
        let ray = self.ray(self.target?)?;
        Some(Emission { ray, flux: self.power, source: Source::Hidden, density: f32::INFINITY })
    }

    /// None: nothing lies in the beam by chance.
    fn illuminate(&self, _: &Surfaces, _: Vec3, _: &mut Sampler) -> Option<Illumination> {
        None
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.power
    }
}
