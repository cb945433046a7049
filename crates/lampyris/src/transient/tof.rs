//! A camera with a lamp that throbs: continuous-wave time of flight with four buckets
//! [Lange & Seitz 2001].

use super::Transient;
use crate::error::{Error, Result};
use crate::image::{Image, luminance};

/// Light that throbs with a wavelength, seen by a sensor that throbs with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeOfFlight {
    /// Λ, the wavelength of the modulation in scene units: the speed of light over the frequency.
    pub wavelength: f64,
    /// m, the contrast of the modulation, in 0..1.
    pub contrast: f64,
}

impl TimeOfFlight {
    /// Full contrast at this frequency in hertz, where light travels `light_speed` scene units a second.
    ///
    /// # Errors
    /// A frequency that is not above 0.
    pub fn of_frequency(frequency: f64, light_speed: f64) -> Result<TimeOfFlight> {
        match light_speed / frequency {
            wavelength if wavelength.is_finite() && wavelength > 0.0 => Ok(TimeOfFlight { wavelength, contrast: 1.0 }),
            _ => Err(Error::new(format!("the frequency must be a number above 0, not {frequency}"))),
        }
    }

    /// Depths from 0 to before this are told apart; those behind it begin again at 0: Λ/2.
    pub fn range(&self) -> f64 {
        self.wavelength / 2.0
    }

    /// What the four buckets of a pixel collect: Q_k = Σ L(s) (1 + m cos(2πs/Λ - kπ/2)) / 2 over the bins, with L the
    /// luminance and s the middle of a bin.
    fn buckets(&self, transient: &Transient, profile: &[[f32; 3]]) -> [f64; 4] {
        let mut sums = [0.0; 4];
        for (bin, &value) in profile.iter().enumerate() {
            let light = f64::from(luminance(value));
            let phase = 2.0 * std::f64::consts::PI * (transient.axis().middle(bin) / self.wavelength).fract();
            let (sine, cosine) = phase.sin_cos();
            // cos(x - kπ/2) for k = 0, 1, 2, 3.
            for (sum, wave) in sums.iter_mut().zip([cosine, sine, -cosine, -sine]) {
                *sum += light * (1.0 + self.contrast * wave) / 2.0;
            }
        }
        sums
    }

    /// The depth that such a camera takes its pixels to have: Λφ/4π with φ = atan2(Q₁ - Q₃, Q₀ - Q₂) in 0..2π, half of the
    /// path there and back; in scene units, from 0 to before [`TimeOfFlight::range`], and infinite where it is dark or light is not
    /// finite. Where light comes by several ways it is none of their lengths, as in a real camera.
    pub fn depths(&self, transient: &Transient) -> Image {
        transient.picture(|profile| {
            let [q0, q1, q2, q3] = self.buckets(transient, profile);
            [self.depth(q1 - q3, q0 - q2) as f32; 3]
        })
    }

    /// How strongly each pixel throbs: √((Q₁ - Q₃)² + (Q₀ - Q₂)²) / m, the light itself if all of it comes at one time.
    pub fn amplitudes(&self, transient: &Transient) -> Image {
        transient.picture(|profile| {
            let [q0, q1, q2, q3] = self.buckets(transient, profile);
            [((q1 - q3).hypot(q0 - q2) / self.contrast) as f32; 3]
        })
    }

    fn depth(&self, sine: f64, cosine: f64) -> f64 {
        // Of what is no number, nothing can be told either.
        if sine == 0.0 && cosine == 0.0 || !(sine.is_finite() && cosine.is_finite()) {
            return f64::INFINITY;
        }
        let turns = (sine.atan2(cosine) / (2.0 * std::f64::consts::PI)).rem_euclid(1.0);
        // A phase a rounding below 0 is a turn above it, which is 0 again.
        self.range() * if turns < 1.0 { turns } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{SPEED_OF_LIGHT, Timing};
    use super::*;

    /// A pixel for each bin, with all of its light there.
    fn wall(bins: usize) -> Transient {
        let timing = Timing::new(0.0, 0.05);
        let mut transient = Transient::new(bins, 1, bins, timing).expect("pixels");
        for (bin, profile) in transient.profiles_mut().enumerate() {
            profile[bin] = [3.0; 3];
        }
        transient
    }

    #[test]
    fn twenty_megahertz_reach_seven_and_a_half_metres() {
        let camera = TimeOfFlight::of_frequency(20e6, SPEED_OF_LIGHT).expect("a frequency");
        assert!((camera.range() - 7.494_811_45).abs() < 1e-8);
        assert!(TimeOfFlight::of_frequency(0.0, SPEED_OF_LIGHT).is_err());
        assert!(TimeOfFlight::of_frequency(-1.0, SPEED_OF_LIGHT).is_err());
    }

    #[test]
    fn a_depth_is_half_the_path_and_wraps_at_the_range() {
        for contrast in [1.0, 0.3] {
            let camera = TimeOfFlight { wavelength: 7.0, contrast };
            let transient = wall(400);
            for (bin, pixel) in camera.depths(&transient).pixels().iter().enumerate() {
                let expected = (transient.axis().middle(bin) / 2.0).rem_euclid(3.5);
                assert!((f64::from(pixel[0]) - expected).abs() < 1e-5, "bin {bin}: {} not {expected}", pixel[0]);
            }
            for pixel in camera.amplitudes(&transient).pixels() {
                assert!((pixel[0] / luminance([3.0; 3]) - 1.0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn opposite_buckets_add_up_to_the_light() {
        let transient = wall(9);
        let [q0, q1, q2, q3] =
            TimeOfFlight { wavelength: 0.3, contrast: 0.8 }.buckets(&transient, transient.profile(4, 0));
        let light = f64::from(luminance([3.0; 3]));
        assert!((q0 + q2 - light).abs() < 1e-12 && (q1 + q3 - light).abs() < 1e-12);
    }

    #[test]
    fn light_that_is_no_number_has_no_depth() {
        for value in [f32::NAN, f32::INFINITY] {
            let light = Transient::from_values((1, 1, 1), Timing::new(0.0, 1.0), vec![value; 3]).expect("a pixel");
            assert_eq!(TimeOfFlight { wavelength: 2.0, contrast: 1.0 }.depths(&light).pixels(), [[f32::INFINITY; 3]]);
        }
    }

    #[test]
    fn the_dark_has_no_depth() {
        let dark = Transient::new(1, 1, 3, Timing::new(0.0, 1.0)).expect("a pixel");
        assert_eq!(TimeOfFlight { wavelength: 2.0, contrast: 1.0 }.depths(&dark).pixels(), [[f32::INFINITY; 3]]);
    }
}
