//! The same light from everywhere.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Emission, Emit, Far, Illumination, Source, World};
use crate::geometry::Surfaces;
use crate::math::{Frame, warp};
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// The same radiance from everywhere infinitely far away.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    /// Radiance in W/(m² sr).
    pub radiance: Spectrum,
    /// What the photons must cover.
    pub world: World,
}

/// Density of a direction per solid angle, the same for all.
const PDF: f32 = 1.0 / (4.0 * PI);

impl Emit for Constant {
    fn emit(&self, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Emission> {
        let direction = Frame::around(warp::sphere(sampler.square()));
        Some(Emission {
            ray: self.world.entry(&direction, sampler.square()),
            flux: self.power(surfaces),
            source: Source::Far(PDF),
            density: PDF * self.world.density(),
        })
    }

    fn illuminate(&self, _: &Surfaces, _: Vec3, sampler: &mut Sampler) -> Option<Illumination> {
        let to_light = warp::sphere(sampler.square());
        let emission = self.world.density();
        Some(Illumination { to_light, target: None, irradiance: self.radiance / PDF, pdf: Some(PDF), emission })
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.radiance * (self.world.section() / PDF)
    }
}

impl Far for Constant {
    fn radiance(&self, _: Vec3) -> Spectrum {
        self.radiance
    }

    fn pdf(&self, _: Vec3) -> f32 {
        PDF
    }

    fn emission(&self, _: Vec3) -> f32 {
        PDF * self.world.density()
    }
}
