//! Light and reflectance in four lanes.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign};

use glam::Vec4;

mod basis;
mod curves;
pub mod eye;
mod index;
pub mod metals;
mod observer;
mod srgb;
mod substances;

pub use basis::Basis;
pub use index::{Dispersion, FRAUNHOFER_C, FRAUNHOFER_D, FRAUNHOFER_F};
pub use srgb::{linear_to_srgb, srgb_to_linear};

/// Four numbers that multiply and add lane by lane. In an RGB pass the lanes are linear red, green, blue, and green once
/// more, so that whatever is done to all four is right for three; in a spectral pass they are four wavelengths, of which
/// the scene's [`Basis`] tells. What a value means (flux, radiance, reflectance) its name says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spectrum(Vec4);

impl Spectrum {
    /// No light.
    pub const ZERO: Spectrum = Spectrum(Vec4::ZERO);
    /// White light of 1, or perfect reflectance.
    pub const ONE: Spectrum = Spectrum(Vec4::ONE);

    /// From linear RGB.
    pub fn from_rgb([r, g, b]: [f32; 3]) -> Spectrum {
        Spectrum(Vec4::new(r, g, b, g))
    }

    /// From four lanes.
    pub fn from_lanes(lanes: [f32; 4]) -> Spectrum {
        Spectrum(Vec4::from_array(lanes))
    }

    /// The four lanes.
    pub fn lanes(self) -> [f32; 4] {
        self.0.to_array()
    }

    /// As linear RGB, if that is what the lanes are; see [`Basis::to_rgb`] for all passes.
    pub fn to_rgb(self) -> [f32; 3] {
        self.0.truncate().to_array()
    }

    /// The same value in all lanes.
    pub fn grey(value: f32) -> Spectrum {
        Spectrum::ONE * value
    }

    /// The largest lane.
    pub fn max(self) -> f32 {
        self.0.max_element()
    }

    /// The mean of red, green and blue, if that is what the lanes are.
    pub fn mean(self) -> f32 {
        (self.0.x + self.0.y + self.0.z) / 3.0
    }

    /// Whether there is no light at all.
    pub fn is_zero(self) -> bool {
        self.0 == Vec4::ZERO
    }

    /// Whether all lanes are finite.
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// Each lane changed by `change`.
    #[must_use]
    pub fn map(self, change: impl Fn(f32) -> f32) -> Spectrum {
        Spectrum::from_lanes(self.lanes().map(change))
    }

    /// One lane, and nothing in the others.
    #[must_use]
    pub fn only(self, lane: usize) -> Spectrum {
        let mut lanes = [0.0; 4];
        lanes[lane] = self.lanes()[lane];
        Spectrum::from_lanes(lanes)
    }

    /// Lane by lane division where the divisor is not zero.
    #[must_use]
    pub fn divided(self, by: Spectrum) -> Spectrum {
        let lane = |a: f32, b: f32| if b == 0.0 { 0.0 } else { a / b };
        Spectrum(Vec4::new(
            lane(self.0.x, by.0.x),
            lane(self.0.y, by.0.y),
            lane(self.0.z, by.0.z),
            lane(self.0.w, by.0.w),
        ))
    }
}

impl Add for Spectrum {
    type Output = Spectrum;
    #[inline]
    fn add(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 + other.0)
    }
}

impl AddAssign for Spectrum {
    #[inline]
    fn add_assign(&mut self, other: Spectrum) {
        self.0 += other.0;
    }
}

impl Mul for Spectrum {
    type Output = Spectrum;
    #[inline]
    fn mul(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 * other.0)
    }
}

impl Mul<f32> for Spectrum {
    type Output = Spectrum;
    #[inline]
    fn mul(self, factor: f32) -> Spectrum {
        Spectrum(self.0 * factor)
    }
}

impl MulAssign<f32> for Spectrum {
    #[inline]
    fn mul_assign(&mut self, factor: f32) {
        self.0 *= factor;
    }
}

impl Div for Spectrum {
    type Output = Spectrum;
    #[inline]
    fn div(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 / other.0)
    }
}

impl Div<f32> for Spectrum {
    type Output = Spectrum;
    #[inline]
    fn div(self, divisor: f32) -> Spectrum {
        Spectrum(self.0 / divisor)
    }
}
