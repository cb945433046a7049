//! What lights that are infinitely far away have in common.

use glam::{Vec2, Vec3};

use super::{Aim, Emission, Emit, Illumination, Section, Source, Start, World, aim};
use crate::geometry::{Ray, Surfaces};
use crate::math::Frame;
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// Light from infinitely far away that rays meet when they leave the scene; it emits and illuminates by these.
pub trait Far {
    /// Radiance that arrives from there, in W/(m² sr).
    fn radiance(&self, toward: Vec3) -> Spectrum;

    /// The direction (world) of a point of the unit square with its radiance and density per solid angle; none where it is
    /// dark.
    fn sample(&self, u: Vec2) -> Option<(Vec3, Spectrum, f32)>;

    /// Density of [`Far::sample`] per solid angle, for even points.
    fn pdf(&self, toward: Vec3) -> f32;

    /// The point from which [`Far::sample`] makes this direction, for lights so large that they can be seen in part.
    fn unsample(&self, _toward: Vec3) -> Option<Vec2> {
        None
    }

    /// What the photons must cover.
    fn world(&self) -> &World;

    /// Flux in W that comes to what the photons must cover.
    fn power(&self) -> Spectrum;
}

impl<F: Far> Emit for F {
    fn emit(&self, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Emission> {
        aim::evenly(self, surfaces, sampler)
    }

    fn illuminate(&self, _: &Surfaces, at: Vec3, sampler: &mut Sampler) -> Option<Illumination> {
        illuminate_by(self, at, sampler.square())
    }

    fn aim(&self) -> Option<&dyn Aim> {
        Some(self)
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        Far::power(self)
    }
}

impl<F: Far> Aim for F {
    fn start(&self, _: &Surfaces, sampler: &mut Sampler) -> Option<Start> {
        let (toward, _, pdf) = self.sample(sampler.square())?;
        Some(Start { section: self.world().rays(Frame::around(-toward)), source: Source::Far(pdf) })
    }

    fn send(&self, _: &Surfaces, start: &Start, ray: Ray) -> Option<Emission> {
        let Source::Far(pdf) = start.source else { return None };
        let density = pdf * self.world().density();
        let flux = self.radiance(-ray.direction) / density;
        self.world().covers(&ray).then_some(Emission { ray, flux, source: start.source, density })
    }

    fn section(&self, ray: &Ray, _: Vec3) -> Section {
        self.world().rays(Frame::around(ray.direction))
    }
}

/// Light that arrives at `at` from the direction of a point of the unit square; none where it is dark.
#[inline]
pub(crate) fn illuminate_by<F: Far + ?Sized>(light: &F, at: Vec3, u: Vec2) -> Option<Illumination> {
    let (to_light, radiance, pdf) = light.sample(u)?;
    let emission = light.world().density_at(at, -to_light);
    let (irradiance, pdf, normal) = (radiance / pdf, Some(pdf), Vec3::ZERO);
    Some(Illumination { to_light, target: None, irradiance, pdf, emission, normal })
}
