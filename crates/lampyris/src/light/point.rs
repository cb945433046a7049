//! The point light.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Emission, Emit, Illumination, Source};
use crate::geometry::{Ray, Surfaces};
use crate::math::warp;
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// A point that shines equally in all directions.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Where it is.
    pub position: Vec3,
    /// Radiant intensity in W/sr.
    pub intensity: Spectrum,
}

impl Emit for Point {
    fn emit(&self, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Emission> {
        let ray = Ray { origin: self.position, direction: warp::sphere(sampler.square()) };
        Some(Emission { ray, flux: self.power(surfaces), source: Source::Point, density: PDF })
    }

    fn illuminate(&self, _: &Surfaces, at: Vec3, _: &mut Sampler) -> Option<Illumination> {
        from_point(self.position, at, |_| (self.intensity, PDF))
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.intensity * (4.0 * PI)
    }
}

/// Density of a direction per solid angle.
const PDF: f32 = 0.25 / PI;

/// Light that arrives at `at` from a point with this intensity towards a direction, in which photons leave with the
/// density per solid angle that comes second.
pub(super) fn from_point(position: Vec3, at: Vec3, toward: impl Fn(Vec3) -> (Spectrum, f32)) -> Option<Illumination> {
    let to = position - at;
    let distance2 = to.length_squared();
    if distance2 <= 0.0 {
        return None;
    }
    let to_light = to / distance2.sqrt();
    let (intensity, pdf) = toward(-to_light);
    let (irradiance, emission) = (intensity / distance2, pdf / distance2);
    Some(Illumination { to_light, target: Some(position), irradiance, pdf: None, emission })
}
