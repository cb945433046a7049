//! Rough surfaces of diffuse grooves.

use std::f32::consts::{FRAC_2_PI, PI};

use glam::Vec3;

use super::diffuse::above;
use super::{Breadth, Event, Scatter, Shares, diffuse};
use crate::spectrum::Spectrum;

/// V-shaped grooves whose sides are diffuse, on both sides [Oren & Nayar 1994] (theory §3.8).
#[derive(Clone, Copy, Debug)]
pub struct RoughDiffuse {
    reflectance: Spectrum,
    /// Variance of the slope angle of the grooves.
    variance: f32,
    fast: bool,
}

impl RoughDiffuse {
    /// With this share of reflected light and roughness α, which is √2 times the standard deviation of the slope angle;
    /// `fast` takes the authors' qualitative model, without light that goes from one side of a groove to the other.
    pub fn new(reflectance: Spectrum, alpha: f32, fast: bool) -> RoughDiffuse {
        RoughDiffuse { reflectance, variance: 0.5 * alpha * alpha, fast }
    }
}

/// What the model asks of two directions.
struct Angles {
    /// Cosine of the angle between their azimuths.
    azimuth: f32,
    /// Sine of the larger polar angle, and of the smaller one.
    sin: [f32; 2],
    cos: [f32; 2],
}

impl Angles {
    fn new(a: Vec3, b: Vec3) -> Angles {
        let (high, low) = if a.z > b.z { (b, a) } else { (a, b) };
        let sin = [high, low].map(|direction| direction.truncate().length());
        let product = sin[0] * sin[1];
        let azimuth =
            if product > 1e-8 { (high.truncate().dot(low.truncate()) / product).clamp(-1.0, 1.0) } else { 0.0 };
        Angles { azimuth, sin, cos: [high.z, low.z] }
    }
}

impl RoughDiffuse {
    /// Light that meets one side of a groove, over that of a flat surface; and light that meets two.
    fn once_and_twice(&self, angles: &Angles) -> (f32, f32) {
        let variance = self.variance;
        let tan_low = angles.sin[1] / angles.cos[1];
        let steep = variance / (variance + 0.09);
        let flat = 1.0 - 0.5 * variance / (variance + 0.33);
        if self.fast {
            return (flat + 0.45 * steep * angles.azimuth.max(0.0) * angles.sin[0] * tan_low, 0.0);
        }
        let [high, low] = angles.cos.map(|cos| cos.clamp(-1.0, 1.0).acos());
        let low_share = low * FRAC_2_PI;
        let shift = if angles.azimuth >= 0.0 { 0.0 } else { low_share.powi(3) };
        let facing = 0.45 * steep * (angles.sin[0] - shift);
        let product = high * low * FRAC_2_PI * FRAC_2_PI;
        let aside = 0.125 * steep * product * product;
        let tan_half = (0.5 * (high + low)).tan();
        let once = flat + angles.azimuth * facing * tan_low + (1.0 - angles.azimuth.abs()) * aside * tan_half;
        let twice = 0.17 * variance / (variance + 0.13) * (1.0 - angles.azimuth * low_share * low_share);
        (once, twice)
    }
}

impl Scatter for RoughDiffuse {
    fn shares(&self, _: Vec3) -> Shares {
        let mut shares = [Spectrum::ZERO; Event::ALL.len()];
        shares[Event::Diffuse.index()] = self.reflectance;
        shares
    }

    fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        if !diffuse::same_side(to_previous, to_next) {
            return Spectrum::ZERO;
        }
        let (once, twice) = self.once_and_twice(&Angles::new(above(to_previous), above(to_next)));
        (self.reflectance * once + self.reflectance * self.reflectance * twice) / PI
    }

    fn even(&self, _: Vec3) -> Option<Spectrum> {
        (self.variance == 0.0).then_some(self.reflectance / PI)
    }

    fn broad(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        self.eval(to_previous, to_next)
    }

    fn breadth(&self) -> Breadth {
        if self.variance == 0.0 { Breadth::Even } else { Breadth::None }
    }

    fn pdf(&self, _: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        diffuse::pdf(to_previous, to_next)
    }

    fn sample(&self, _: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)> {
        Some((diffuse::sample(to_previous, u.truncate()), 1.0))
    }
}
