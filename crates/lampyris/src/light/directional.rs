//! Parallel light.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Emission, Emit, Illumination, World};
use crate::geometry::{Ray, Surfaces};
use crate::math::{Frame, warp};
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// Parallel light from infinitely far away. Its photons start on a disk that covers all finite shapes.
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
        let on_disk = self.direction.to_world(warp::disk(sampler.square()).extend(-1.0));
        let ray = Ray { origin: self.world.center + on_disk * self.world.radius, direction: self.direction.normal };
        Some(Emission { ray, flux: self.power(surfaces) })
    }

    fn illuminate(&self, _: &Surfaces, _: Vec3, _: &mut Sampler) -> Option<Illumination> {
        let to_light = -self.direction.normal;
        Some(Illumination { to_light, target: None, irradiance: self.irradiance, pdf: None })
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.irradiance * (PI * self.world.radius * self.world.radius)
    }
}
