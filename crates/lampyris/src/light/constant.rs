//! The same light from everywhere.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Emission, Emit, Illumination, World};
use crate::geometry::{Ray, Surfaces};
use crate::math::{Frame, warp};
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// The same radiance from everywhere infinitely far away. Its photons start on a disk that covers all finite shapes.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    /// Radiance in W/(m² sr).
    pub radiance: Spectrum,
    /// What the photons must cover.
    pub world: World,
}

impl Constant {
    /// Density of [`Emit::illuminate`] per solid angle, in all directions.
    pub const PDF: f32 = 1.0 / (4.0 * PI);
}

impl Emit for Constant {
    fn emit(&self, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Emission> {
        let direction = warp::sphere(sampler.square());
        let on_disk = Frame::around(direction).to_world(warp::disk(sampler.square()).extend(-1.0));
        let ray = Ray { origin: self.world.center + on_disk * self.world.radius, direction };
        Some(Emission { ray, flux: self.power(surfaces) })
    }

    fn illuminate(&self, _: &Surfaces, _: Vec3, sampler: &mut Sampler) -> Option<Illumination> {
        let to_light = warp::sphere(sampler.square());
        let irradiance = self.radiance / Constant::PDF;
        Some(Illumination { to_light, target: None, irradiance, pdf: Some(Constant::PDF) })
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.radiance * (4.0 * PI * PI * self.world.radius * self.world.radius)
    }
}
