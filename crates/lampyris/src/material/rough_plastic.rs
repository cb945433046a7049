//! A diffuse base under a rough clear coat.

use std::f32::consts::PI;

use glam::Vec3;

use super::diffuse;
use super::table::Coat;
use super::{Breadth, Event, Microfacets, Scatter, Shares};
use crate::math::fresnel;
use crate::spectrum::Spectrum;

/// [`Plastic`](super::Plastic) under a coat of microfacets, the model of Mitsuba's `roughplastic` (theory §3.6). Black from
/// behind.
#[derive(Clone, Copy, Debug)]
pub struct RoughPlastic<'a> {
    base: Spectrum,
    specular: Spectrum,
    facets: Microfacets,
    ior: f32,
    coat: &'a Coat,
}

impl<'a> RoughPlastic<'a> {
    /// From the colour of the base, the tint of the reflection on the coat, the coat's facets, its index over the
    /// outside's and what it does on average; `nonlinear` lets repeated inner reflection saturate the colour.
    pub fn new(
        reflectance: Spectrum,
        specular: Spectrum,
        facets: Microfacets,
        ior: f32,
        coat: &'a Coat,
        nonlinear: bool,
    ) -> RoughPlastic<'a> {
        let base = reflectance.map(|rho| rho / (1.0 - coat.kept * if nonlinear { rho } else { 1.0 }));
        RoughPlastic { base, specular, facets, ior, coat }
    }
}

impl Scatter for RoughPlastic<'_> {
    fn shares(&self, to_previous: Vec3) -> Shares {
        let mut shares = [Spectrum::ZERO; Event::ALL.len()];
        if to_previous.z > 0.0 {
            let entering = self.coat.entering.at(to_previous.z);
            shares[Event::Diffuse.index()] = self.base * (entering * (1.0 - self.coat.kept));
            shares[Event::Glossy.index()] = self.specular * (1.0 - entering);
        }
        shares
    }

    fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        let Some((value, normal)) = self.facets.reflection(to_previous, to_next) else { return Spectrum::ZERO };
        let reflected = fresnel::dielectric(to_previous.dot(normal), self.ior).reflectance;
        self.specular * (reflected * value) + self.broad(to_previous, to_next)
    }

    fn even(&self, _: Vec3) -> Option<Spectrum> {
        None
    }

    fn broad(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        let entering = self.coat.entering.at(to_previous.z) * self.coat.entering.at(to_next.z);
        let is_above = to_previous.z > 0.0 && to_next.z > 0.0;
        if is_above { self.base * (entering / (PI * self.ior * self.ior)) } else { Spectrum::ZERO }
    }

    fn breadth(&self) -> Breadth {
        Breadth::Coated
    }

    fn outward(&self, to_previous: Vec3) -> f32 {
        self.coat.entering.at(to_previous.z)
    }

    fn pdf(&self, event: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        match event {
            Event::Diffuse => diffuse::pdf(to_previous, to_next),
            _ => self.facets.reflection_pdf(to_previous, to_next),
        }
    }

    fn sample(&self, event: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)> {
        let to_next = match event {
            Event::Diffuse => diffuse::sample(to_previous, u.truncate()),
            _ => self.facets.sample_reflection(to_previous, u.truncate())?,
        };
        Some((to_next, 1.0))
    }
}
