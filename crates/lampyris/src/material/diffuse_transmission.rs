//! Sheets that scatter light evenly on both sides.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Event, Scatter, Shares, diffuse};
use crate::math::warp;
use crate::spectrum::Spectrum;

/// Reflects and transmits equally in all directions, as paper and leaves do, from both sides (theory §3.8).
#[derive(Clone, Copy, Debug)]
pub struct DiffuseTransmission {
    /// Share of the light that is reflected.
    pub reflectance: Spectrum,
    /// Share of the light that is transmitted.
    pub transmittance: Spectrum,
}

impl DiffuseTransmission {
    /// The probability with which a path stays on its side.
    fn staying(&self) -> f32 {
        let (reflected, transmitted) = (self.reflectance.max(), self.transmittance.max());
        if reflected + transmitted > 0.0 { reflected / (reflected + transmitted) } else { 1.0 }
    }
}

impl Scatter for DiffuseTransmission {
    fn shares(&self, _: Vec3) -> Shares {
        let mut shares = [Spectrum::ZERO; Event::ALL.len()];
        shares[Event::Diffuse.index()] = self.reflectance + self.transmittance;
        shares
    }

    fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        let stays = diffuse::same_side(to_previous, to_next);
        if stays { self.reflectance / PI } else { self.transmittance / PI }
    }

    fn even(&self, _: Vec3) -> Option<Spectrum> {
        None
    }

    fn pdf(&self, _: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        let staying = self.staying();
        let chance = if diffuse::same_side(to_previous, to_next) { staying } else { 1.0 - staying };
        chance * warp::cosine_hemisphere_pdf(to_next.z.abs())
    }

    fn sample(&self, _: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)> {
        let same = diffuse::sample(to_previous, u.truncate());
        Some((if u.z < self.staying() { same } else { -same }, 1.0))
    }
}
