//! A shape that emits.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Emission, Emit, Illumination};
use crate::geometry::{Surface, Surfaces};
use crate::math::{Frame, warp};
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// A shape with the same radiance everywhere and in all directions on the side of its normal.
#[derive(Clone, Copy, Debug)]
pub struct Area {
    /// The number of the shape.
    pub shape: u32,
    /// Radiance in W/(m² sr).
    pub radiance: Spectrum,
}

impl Area {
    /// Radiance that leaves `surface` in this direction.
    #[inline]
    pub fn radiance(&self, surface: &Surface, direction: Vec3) -> Spectrum {
        if direction.dot(surface.normal) > 0.0 { self.radiance } else { Spectrum::ZERO }
    }

    /// Density of [`Emit::illuminate`] per solid angle at `at`, of a point on the light.
    pub fn pdf(&self, surfaces: &Surfaces, at: Vec3, surface: &Surface) -> f32 {
        surfaces.pdf_from(self.shape, at, surface).unwrap_or(0.0)
    }
}

impl Emit for Area {
    fn emit(&self, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Emission> {
        let surface = surfaces.sample(self.shape, sampler.square())?;
        let direction = Frame::around(surface.normal).to_world(warp::cosine_hemisphere(sampler.square()));
        Some(Emission { ray: surface.spawn(direction), flux: self.power(surfaces), hidden: false })
    }

    fn illuminate(&self, surfaces: &Surfaces, at: Vec3, sampler: &mut Sampler) -> Option<Illumination> {
        let (surface, pdf) = surfaces.sample_from(self.shape, at, sampler.square())?;
        let to_light = (surface.position - at).normalize_or_zero();
        let radiance = self.radiance(&surface, -to_light);
        if radiance.is_zero() {
            return None;
        }
        let target = Some(surface.offset(-to_light));
        Some(Illumination { to_light, target, irradiance: radiance / pdf, pdf: Some(pdf) })
    }

    fn power(&self, surfaces: &Surfaces) -> Spectrum {
        self.radiance * (PI * surfaces.area(self.shape))
    }
}
