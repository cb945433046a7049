//! The point light.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Aim, Emission, Emit, Illumination, Section, Source, Span, Start, aim};
use crate::geometry::{Ray, Surfaces};
use crate::math::Frame;
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
        aim::evenly(self, surfaces, sampler)
    }

    fn illuminate(&self, _: &Surfaces, at: Vec3, _: &mut Sampler) -> Option<Illumination> {
        from_point(self.position, at, |_| (self.intensity, PDF))
    }

    fn span(&self, _: &Ray, length: f32) -> Option<Span> {
        Some(Span::whole(length, Some((self.position, 0.0))))
    }

    fn aim(&self) -> Option<&dyn Aim> {
        Some(self)
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.intensity * (4.0 * PI)
    }
}

impl Aim for Point {
    fn start(&self, _: &Surfaces, _: &mut Sampler) -> Option<Start> {
        Some(Start { section: self.all(), source: Source::Point })
    }

    fn send(&self, surfaces: &Surfaces, start: &Start, ray: Ray) -> Option<Emission> {
        Some(Emission { ray, flux: self.power(surfaces), source: start.source, density: PDF })
    }

    fn section(&self, _: &Ray, _: Vec3) -> Section {
        self.all()
    }
}

impl Point {
    fn all(&self) -> Section {
        Section::Cap { origin: self.position, axis: Frame::around(Vec3::Z), height: 2.0 }
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
    Some(Illumination { to_light, target: Some(position), irradiance, pdf: None, emission, normal: Vec3::ZERO })
}
