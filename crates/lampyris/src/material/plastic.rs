//! A diffuse base under a smooth clear coat.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Breadth, Event, Scatter, Shares, diffuse};
use crate::math::fresnel;
use crate::spectrum::Spectrum;

/// Light is mirrored on the coat, or enters it, is reflected by the diffuse base any number of times between base and
/// coat, and leaves (theory §3.4; the model of Mitsuba's `plastic`). Black from behind.
#[derive(Clone, Copy, Debug)]
pub struct Plastic {
    /// Albedo of what is under the coat, all inner reflections included.
    base: Spectrum,
    specular: Spectrum,
    ior: f32,
    /// Share of diffuse light that the coat lets out of itself, `1 - diffuse_reflectance(1 / ior)`.
    escape: f32,
}

impl Plastic {
    /// From the colour of the base, the tint of the mirror reflection, the coat's index over the outside's and
    /// [`Plastic::inner_reflectance`] of it; `nonlinear` lets repeated inner reflection saturate the colour.
    pub fn new(
        reflectance: Spectrum,
        specular: Spectrum,
        ior: f32,
        inner_reflectance: f32,
        nonlinear: bool,
    ) -> Plastic {
        let base = reflectance.map(|rho| rho / (1.0 - inner_reflectance * if nonlinear { rho } else { 1.0 }));
        Plastic { base, specular, ior, escape: 1.0 - inner_reflectance }
    }

    /// Share of diffuse light that a coat of this index sends back down to its base.
    pub fn inner_reflectance(ior: f32) -> f32 {
        fresnel::diffuse_reflectance(1.0 / ior)
    }

    /// The share of light at this cosine that comes through the coat.
    fn entering(&self, cos: f32) -> f32 {
        1.0 - fresnel::dielectric(cos, self.ior).reflectance
    }
}

impl Scatter for Plastic {
    fn shares(&self, to_previous: Vec3) -> Shares {
        let mut shares = [Spectrum::ZERO; Event::ALL.len()];
        if to_previous.z > 0.0 {
            let reflected = fresnel::dielectric(to_previous.z, self.ior).reflectance;
            shares[Event::Diffuse.index()] = self.base * ((1.0 - reflected) * self.escape);
            shares[Event::Specular.index()] = self.specular * reflected;
        }
        shares
    }

    fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        if to_previous.z <= 0.0 || to_next.z <= 0.0 {
            return Spectrum::ZERO;
        }
        self.base * (self.entering(to_previous.z) * self.entering(to_next.z) / (PI * self.ior * self.ior))
    }

    fn even(&self, _: Vec3) -> Option<Spectrum> {
        None
    }

    fn broad(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        self.eval(to_previous, to_next)
    }

    fn breadth(&self) -> Breadth {
        Breadth::Coated
    }

    fn outward(&self, to_previous: Vec3) -> f32 {
        self.entering(to_previous.z)
    }

    fn pdf(&self, _: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        diffuse::pdf(to_previous, to_next)
    }

    fn sample(&self, event: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)> {
        let to_next = if event == Event::Specular {
            fresnel::reflect(to_previous)
        } else {
            diffuse::sample(to_previous, u.truncate())
        };
        Some((to_next, 1.0))
    }
}
