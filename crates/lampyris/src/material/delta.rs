//! The models that know one direction only: mirror, metal, hole.

use glam::Vec3;

use super::rough_conductor::conductor;
use super::{Event, Scatter, Shares, glass};
use crate::math::fresnel;
use crate::spectrum::Spectrum;

/// Reflects perfectly, on both sides, the same share under all angles.
#[derive(Clone, Copy, Debug)]
pub struct Mirror {
    /// Share of the light that is reflected, 0 to 1.
    pub reflectance: Spectrum,
}

/// A smooth metal (theory §3.3).
#[derive(Clone, Copy, Debug)]
pub struct Conductor {
    /// Real part of the index of refraction.
    pub eta: Spectrum,
    /// Imaginary part of the index of refraction.
    pub k: Spectrum,
    /// Tint, 0 to 1.
    pub reflectance: Spectrum,
}

/// Where there is no surface: light passes straight through.
#[derive(Clone, Copy, Debug)]
pub struct Hole;

impl Scatter for Mirror {
    fn shares(&self, _: Vec3) -> Shares {
        glass::delta_shares(self.reflectance, Spectrum::ZERO)
    }

    fn sample(&self, _: Event, to_previous: Vec3, _: Vec3) -> Option<(Vec3, f32)> {
        Some((fresnel::reflect(to_previous), 1.0))
    }
}

impl Scatter for Conductor {
    fn shares(&self, to_previous: Vec3) -> Shares {
        let reflected = conductor(to_previous.z, self.eta, self.k);
        glass::delta_shares(reflected * self.reflectance, Spectrum::ZERO)
    }

    fn sample(&self, _: Event, to_previous: Vec3, _: Vec3) -> Option<(Vec3, f32)> {
        Some((fresnel::reflect(to_previous), 1.0))
    }
}

impl Scatter for Hole {
    fn shares(&self, _: Vec3) -> Shares {
        let mut shares = [Spectrum::ZERO; Event::ALL.len()];
        shares[Event::Pass.index()] = Spectrum::ONE;
        shares
    }

    fn sample(&self, _: Event, to_previous: Vec3, _: Vec3) -> Option<(Vec3, f32)> {
        Some((-to_previous, 1.0))
    }
}
