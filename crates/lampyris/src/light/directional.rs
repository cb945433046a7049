//! Parallel light.

use glam::Vec3;

use super::{Emission, Emit, Illumination, Source, World};
use crate::geometry::Surfaces;
use crate::math::Frame;
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// Parallel light from infinitely far away.
#[derive(Clone, Copy, Debug)]
pub struct Directional {
    /// A frame whose normal is where the light goes.
    pub direction: Frame,
    /// Irradiance in W/m² on a surface that faces the light.
    pub irradiance: Spectrum,
    /// What the photons must cover.
    pub world: World,
}

impl Emit for Directional {
    fn emit(&self, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Emission> {
        Some(Emission {
            ray: self.world.entry(&self.direction, sampler.square()),
            flux: self.power(surfaces),
            source: Source::Parallel,
            density: self.world.density(),
        })
    }

    fn illuminate(&self, _: &Surfaces, _: Vec3, _: &mut Sampler) -> Option<Illumination> {
        let to_light = -self.direction.normal;
        let emission = self.world.density();
        Some(Illumination { to_light, target: None, irradiance: self.irradiance, pdf: None, emission })
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.irradiance * self.world.section()
    }
}
