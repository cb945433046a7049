//! The course's material: f = k_d/π + k_s δ(mirror)/cos + k_t δ(refracted)/cos.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Breadth, Event, Lobes, Scatter, Shares, diffuse, glass};
use crate::math::fresnel;
use crate::spectrum::{Basis, Spectrum};

/// A mix of diffuse reflection, mirror and refraction, on both sides (theory §3.5).
#[derive(Clone, Copy, Debug)]
pub struct Coefficients {
    /// Share that is reflected diffusely.
    pub kd: Spectrum,
    /// Share that is mirrored.
    pub ks: Spectrum,
    /// Share that meets a refractive boundary.
    pub kt: Spectrum,
    /// Index of refraction below the normal over that above it.
    pub ior: f32,
    /// Whether the share `kt` is divided by Fresnel's equations; if not, all of it is refracted, but for total
    /// reflection.
    pub fresnel: bool,
}

impl Coefficients {
    /// The same in the lanes of a pass.
    pub(super) fn in_lanes(&self, basis: &Basis) -> Coefficients {
        let [kd, ks, kt] = [self.kd, self.ks, self.kt].map(|share| basis.lanes(share));
        Coefficients { kd, ks, kt, ..*self }
    }

    /// The events that can happen.
    pub fn lobes(&self) -> Lobes {
        let mut lobes = Lobes::NONE;
        if !self.kd.is_zero() {
            lobes = lobes | Event::Diffuse.into();
        }
        if !self.ks.is_zero() || !self.kt.is_zero() {
            lobes = lobes | Event::Specular.into();
        }
        if !self.kt.is_zero() {
            lobes = lobes | Event::Refraction.into();
        }
        lobes
    }
}

impl Scatter for Coefficients {
    fn shares(&self, to_previous: Vec3) -> Shares {
        let mut shares = if self.kt.is_zero() {
            glass::delta_shares(self.ks, Spectrum::ZERO)
        } else {
            let boundary = fresnel::dielectric(to_previous.z, self.ior);
            let total = boundary.cos_refracted == 0.0;
            let reflected = if self.fresnel || total { boundary.reflectance } else { 0.0 };
            glass::delta_shares(self.ks + self.kt * reflected, self.kt * (1.0 - reflected))
        };
        shares[Event::Diffuse.index()] = self.kd;
        shares
    }

    fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        if diffuse::same_side(to_previous, to_next) { self.kd / PI } else { Spectrum::ZERO }
    }

    fn even(&self, _: Vec3) -> Option<Spectrum> {
        Some(self.kd / PI)
    }

    fn broad(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        self.eval(to_previous, to_next)
    }

    fn breadth(&self) -> Breadth {
        Breadth::Even
    }

    fn pdf(&self, _: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        diffuse::pdf(to_previous, to_next)
    }

    fn sample(&self, event: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)> {
        if event == Event::Diffuse {
            return Some((diffuse::sample(to_previous, u.truncate()), 1.0));
        }
        glass::delta_direction(event, to_previous, &fresnel::dielectric(to_previous.z, self.ior))
    }
}
