//! Metals with a rough surface.

use std::f32::consts::PI;

use glam::Vec3;

use super::diffuse::{self, above};
use super::table::Row;
use super::{Event, Microfacets, Scatter, Shares};
use crate::math::fresnel;
use crate::spectrum::{Basis, Spectrum};

/// A metal's complex index of refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// Real part.
    pub eta: Spectrum,
    /// Imaginary part.
    pub k: Spectrum,
    mean: Spectrum,
}

impl Metal {
    /// Of these parts, relative to the outside.
    pub fn new(eta: Spectrum, k: Spectrum) -> Metal {
        let mut metal = Metal { eta, k, mean: Spectrum::ZERO };
        let steps = 256;
        for step in 0..steps {
            let cos = (step as f32 + 0.5) / steps as f32;
            metal.mean += metal.reflectance(cos) * (2.0 * cos / steps as f32);
        }
        metal
    }

    /// The same in the lanes of a pass: between red, green and blue, an index follows the curves of the primaries.
    pub(super) fn in_lanes(&self, basis: &Basis) -> Metal {
        let [eta, k, mean] = [self.eta, self.k, self.mean].map(|part| basis.lanes(part));
        Metal { eta, k, mean }
    }

    /// Share of the light that is reflected under this cosine.
    #[inline]
    pub fn reflectance(&self, cos: f32) -> Spectrum {
        conductor(cos, self.eta, self.k)
    }
}

/// Microfacets of metal, on both sides (theory §3.6).
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor<'a> {
    /// How rough it is.
    pub facets: Microfacets,
    /// Of what.
    pub metal: Metal,
    /// Tint, 0 to 1.
    pub reflectance: Spectrum,
    /// What white facets reflect at once, to give back what they do not (theory §3.7).
    pub white: Option<&'a Row>,
}

/// [`fresnel::conductor`] by lane.
#[inline]
pub(super) fn conductor(cos: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
    let ([e0, e1, e2, e3], [k0, k1, k2, k3]) = (eta.lanes(), k.lanes());
    let [r, g, b] = [(e0, k0), (e1, k1), (e2, k2)].map(|(eta, k)| fresnel::conductor(cos, eta, k));
    // In an RGB pass the last lane is green again.
    let last = if (e3, k3) == (e1, k1) { g } else { fresnel::conductor(cos, e3, k3) };
    Spectrum::from_lanes([r, g, b, last])
}

impl RoughConductor<'_> {
    /// Factor of the light that leaves after more than one facet [Kulla & Conty 2017].
    fn repeated(&self, white: &Row) -> Spectrum {
        let mean = self.metal.mean * self.reflectance;
        mean.map(|mean| mean * mean * white.mean / (1.0 - mean * (1.0 - white.mean)))
    }
}

impl Scatter for RoughConductor<'_> {
    fn shares(&self, to_previous: Vec3) -> Shares {
        let cos = to_previous.z.abs();
        let mut shares = [Spectrum::ZERO; Event::ALL.len()];
        shares[Event::Glossy.index()] = self.metal.reflectance(cos) * self.reflectance;
        if let Some(white) = self.white {
            shares[Event::Diffuse.index()] = self.repeated(white) * (1.0 - white.at(cos)).max(0.0);
        }
        shares
    }

    fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        if !diffuse::same_side(to_previous, to_next) {
            return Spectrum::ZERO;
        }
        let (to_previous, to_next) = (above(to_previous), above(to_next));
        let Some((value, normal)) = self.facets.reflection(to_previous, to_next) else { return Spectrum::ZERO };
        let once = self.metal.reflectance(to_previous.dot(normal)) * self.reflectance * value;
        match self.white {
            Some(white) => {
                let lost = |direction: Vec3| (1.0 - white.at(direction.z)).max(0.0);
                let share = lost(to_previous) * lost(to_next) / (PI * (1.0 - white.mean).max(1e-6));
                once + self.repeated(white) * share
            }
            None => once,
        }
    }

    fn even(&self, _: Vec3) -> Option<Spectrum> {
        None
    }

    fn pdf(&self, event: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        match event {
            Event::Diffuse => diffuse::pdf(to_previous, to_next),
            _ if diffuse::same_side(to_previous, to_next) => {
                self.facets.reflection_pdf(above(to_previous), above(to_next))
            }
            _ => 0.0,
        }
    }

    fn sample(&self, event: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)> {
        let u = u.truncate();
        if event == Event::Diffuse {
            return Some((diffuse::sample(to_previous, u), 1.0));
        }
        let to_next = self.facets.sample_reflection(above(to_previous), u)?;
        Some((to_next.with_z(to_next.z.copysign(to_previous.z)), 1.0))
    }
}
