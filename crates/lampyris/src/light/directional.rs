//! Parallel light.

use glam::Vec3;

use super::{Aim, Emission, Emit, Illumination, Section, Source, Start, World, aim};
use crate::geometry::{Ray, Surfaces};
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
        aim::evenly(self, surfaces, sampler)
    }

    fn illuminate(&self, _: &Surfaces, at: Vec3, _: &mut Sampler) -> Option<Illumination> {
        let to_light = -self.direction.normal;
        let emission = self.world.density_at(at, self.direction.normal);
        Some(Illumination {
            to_light,
            target: None,
            irradiance: self.irradiance,
            pdf: None,
            emission,
            normal: Vec3::ZERO,
        })
    }

    fn aim(&self) -> Option<&dyn Aim> {
        Some(self)
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.irradiance * self.world.cross_section()
    }
}

impl Aim for Directional {
    fn start(&self, _: &Surfaces, _: &mut Sampler) -> Option<Start> {
        Some(Start { section: self.world.rays(self.direction), source: Source::Parallel })
    }

    fn send(&self, surfaces: &Surfaces, start: &Start, ray: Ray) -> Option<Emission> {
        let (flux, density) = (self.power(surfaces), self.world.density());
        self.world.covers(&ray).then_some(Emission { ray, flux, source: start.source, density })
    }

    fn section(&self, _: &Ray, _: Vec3) -> Section {
        self.world.rays(self.direction)
    }
}
