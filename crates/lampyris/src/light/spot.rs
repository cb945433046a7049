//! The spot light.

use std::f32::consts::TAU;

use glam::Vec3;

use super::{Aim, Emission, Emit, Illumination, Section, Source, Span, Start, aim, point};
use crate::geometry::{Ray, Surfaces};
use crate::math::Frame;
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// A point that shines into a cone: fully near the axis, then falling linearly in the angle to nothing at the edge.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    position: Vec3,
    axis: Frame,
    intensity: Spectrum,
    cutoff: f32,
    beam_width: f32,
}

impl Spot {
    /// A spot at `position` that shines along `direction` (unit length) with `intensity` in W/sr on the axis. Angles to
    /// the axis in radians, 0 ≤ `beam_width` ≤ `cutoff` ≤ π/2.
    pub fn new(position: Vec3, direction: Vec3, intensity: Spectrum, cutoff: f32, beam_width: f32) -> Spot {
        Spot { position, axis: Frame::around(direction), intensity, cutoff, beam_width }
    }

    /// Flux of a spot of intensity 1 with these angles, in W: ∫ falloff dω.
    pub fn unit_power(cutoff: f32, beam_width: f32) -> f32 {
        // ∫ (c - θ)/(c - b) sin θ dθ over b..c = cos b - (sin c - sin b)/(c - b), plus the full part 1 - cos b.
        let (c, b) = (f64::from(cutoff), f64::from(beam_width));
        let edge = if c - b > 1e-6 { (c.sin() - b.sin()) / (c - b) } else { c.cos() };
        (std::f64::consts::TAU * (1.0 - edge)) as f32
    }

    /// Density per solid angle of a direction in the cone.
    fn pdf(&self) -> f32 {
        1.0 / (TAU * (1.0 - self.cutoff.cos()))
    }

    fn all(&self) -> Section {
        Section::Cap { origin: self.position, axis: self.axis, height: 1.0 - self.cutoff.cos() }
    }

    fn falloff(&self, direction: Vec3) -> f32 {
        let angle = self.axis.normal.cross(direction).length().atan2(self.axis.normal.dot(direction));
        if angle >= self.cutoff {
            0.0
        } else if angle <= self.beam_width {
            1.0
        } else {
            (self.cutoff - angle) / (self.cutoff - self.beam_width)
        }
    }
}

impl Emit for Spot {
    fn emit(&self, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Emission> {
        aim::evenly(self, surfaces, sampler)
    }

    fn illuminate(&self, _: &Surfaces, at: Vec3, _: &mut Sampler) -> Option<Illumination> {
        point::from_point(self.position, at, |direction| (self.intensity * self.falloff(direction), self.pdf()))
            .filter(|illumination| !illumination.irradiance.is_zero())
    }

    fn span(&self, ray: &Ray, length: f32) -> Option<Span> {
        let whole = Span::whole(length, Some((self.position, 0.0)));
        whole.in_cone(ray, self.position, self.axis.normal, self.cutoff)
    }

    fn aim(&self) -> Option<&dyn Aim> {
        Some(self)
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.intensity * Spot::unit_power(self.cutoff, self.beam_width)
    }
}

impl Aim for Spot {
    fn start(&self, _: &Surfaces, _: &mut Sampler) -> Option<Start> {
        Some(Start { section: self.all(), source: Source::Point })
    }

    fn send(&self, _: &Surfaces, start: &Start, ray: Ray) -> Option<Emission> {
        let density = self.pdf();
        let flux = self.intensity * (self.falloff(ray.direction) / density);
        (!flux.is_zero()).then_some(Emission { ray, flux, source: start.source, density })
    }

    fn section(&self, _: &Ray, _: Vec3) -> Section {
        self.all()
    }
}
