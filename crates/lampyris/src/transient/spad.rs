//! A single-photon avalanche diode and its time-to-digital converter: what they count, and what can be known from it.

use rand_distr::{Binomial, Distribution, Poisson};
use rayon::prelude::*;

use super::pulse::convolve;
use super::{Pulse, Transient};
use crate::error::{Error, Result};
use crate::image::luminance;
use crate::sampler::{Sampler, purpose};

/// How the detections after a flash are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counting {
    /// All of them.
    Linear,
    /// The first after each flash: what came early hides what comes late, the pile-up.
    FirstPhoton,
}

/// A detector that looks at each pixel, flash by flash.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spad {
    /// η: the mean number of detections that a luminance of 1 makes with one flash. It holds the area of the pixel, the energy
    /// of the flash, and the efficiency of the detector.
    pub efficiency: f64,
    /// The standard deviation of the Gaussian jitter, in scene units.
    pub jitter: f64,
    /// The mean of the exponential delay within the detector, in scene units.
    pub tail: f64,
    /// Detections a second without any light.
    pub dark_rate: f64,
    /// Detections a second by light that has nothing to do with the flashes.
    pub ambient_rate: f64,
    /// N: how many flashes.
    pub pulses: u64,
    /// Which detections are counted.
    pub counting: Counting,
}

impl Default for Spad {
    /// A perfect detector that looks at a thousand flashes.
    fn default() -> Spad {
        Spad {
            efficiency: 1.0,
            jitter: 0.0,
            tail: 0.0,
            dark_rate: 0.0,
            ambient_rate: 0.0,
            pulses: 1000,
            counting: Counting::Linear,
        }
    }
}

/// So many flashes are counted exactly in single precision.
const MOST_PULSES: u64 = 1 << 24;

impl Spad {
    /// Finds what makes no detector.
    ///
    /// # Errors
    /// Numbers that are negative or not finite, no efficiency, no flash or more than 2²⁴.
    pub fn check(&self) -> Result<()> {
        let numbers = [
            ("efficiency", self.efficiency),
            ("jitter", self.jitter),
            ("tail", self.tail),
            ("dark", self.dark_rate),
            ("ambient", self.ambient_rate),
        ];
        if let Some((name, value)) = numbers.into_iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0)) {
            return Err(Error::new(format!("the {name} of a detector must be a number from 0 on, not {value}")));
        }
        if self.efficiency == 0.0 {
            return Err(Error::new("a detector with the efficiency 0 sees nothing"));
        }
        match self.pulses {
            1..=MOST_PULSES => Ok(()),
            pulses => Err(Error::new(format!("the number of pulses must be from 1 to {MOST_PULSES}, not {pulses}"))),
        }
    }

    /// λ_k = η (H ∗ jitter)_k + (dark + ambient) Δt: how many detections one flash makes in each bin of a pixel, in the mean,
    /// if none hides another; with H the luminance and Δt the time of a bin.
    fn rates(&self, transient: &Transient, profile: &[[f32; 3]], (first, weights): &(isize, Vec<f64>)) -> Vec<f64> {
        let light: Vec<f64> = profile.iter().map(|&value| f64::from(luminance(value)).max(0.0)).collect();
        let background = self.background(transient);
        convolve(&light, *first, weights).into_iter().map(|light| self.efficiency * light + background).collect()
    }

    /// Detections in a bin after one flash that the flash did not cause.
    fn background(&self, transient: &Transient) -> f64 {
        (self.dark_rate + self.ambient_rate) * transient.axis().bin_width / transient.timing().light_speed
    }

    /// What is counted in each bin of each pixel, in all three channels: Poisson numbers of mean N λ_k if all detections
    /// count; if the first does, of the flashes that had none before the bin a binomial share of 1 - exp(-λ_k), so that
    /// all bins and the flashes without any detection together are multinomial. The same for the same seed, to the last bit.
    ///
    /// # Errors
    /// As [`Spad::check`], and light that is not finite.
    pub fn count(&self, transient: &Transient, seed: u64) -> Result<Transient> {
        self.check()?;
        let jitter = Pulse::ModifiedGaussian { sigma: self.jitter, tail: self.tail };
        let weights = jitter.weights(transient.axis().bin_width, transient.bins() - 1);
        let counts: Result<Vec<Vec<f32>>> = (0..transient.width() * transient.height())
            .into_par_iter()
            .map(|pixel| {
                let profile = transient.profile(pixel % transient.width(), pixel / transient.width());
                let rates = self.rates(transient, profile, &weights);
                let sampler = Sampler::new(seed, 0, purpose::DETECTOR, pixel as u64);
                match self.counting {
                    Counting::Linear => all_detections(&rates, self.pulses, sampler),
                    Counting::FirstPhoton => first_detections(&rates, self.pulses, sampler),
                }
            })
            .collect();
        let values = counts?.iter().flatten().flat_map(|&count| [count; 3]).collect();
        Ok(transient.with_values(values))
    }

    /// The luminance that the counts of this detector speak for: (λ̂_k - background) / η, in all three channels. If the first
    /// detection counts, λ̂_k = -ln(1 - h_k / (N - Σ_{j<k} h_j)) undoes the pile-up [Coates 1968]; else λ̂_k = h_k / N. The
    /// jitter stays in it, and noise below the background is negative. Bins in which no flash is left are 0.
    ///
    /// # Errors
    /// As [`Spad::check`]; counts that are no whole numbers, or more than there are flashes if the first detection counts.
    pub fn estimate(&self, counts: &Transient) -> Result<Transient> {
        self.check()?;
        let background = self.background(counts);
        let mut values = Vec::with_capacity(counts.values().len());
        for profile in counts.profiles() {
            let mut left = self.pulses as f64;
            for &[count, _, _] in profile {
                let count = f64::from(count);
                if !(count >= 0.0 && count.fract() == 0.0 && count.is_finite()) {
                    return Err(Error::new(format!("{count} is no number of detections"))
                        .with_hint("give the counts of a detector, as --spad writes them"));
                }
                let rate = match self.counting {
                    Counting::Linear => count / self.pulses as f64,
                    Counting::FirstPhoton if count > left => {
                        return Err(Error::new(format!(
                            "a pixel has more first detections than the {} flashes",
                            self.pulses
                        )));
                    }
                    // No flash is left to tell anything.
                    Counting::FirstPhoton if left == 0.0 => background,
                    // All that were left ended here: as if half a flash had got through.
                    Counting::FirstPhoton if count == left => (2.0 * left).ln(),
                    Counting::FirstPhoton => -(-count / left).ln_1p(),
                };
                left -= count;
                values.extend([((rate - background) / self.efficiency) as f32; 3]);
            }
        }
        Ok(counts.with_values(values))
    }
}

fn all_detections(rates: &[f64], pulses: u64, sampler: Sampler) -> Result<Vec<f32>> {
    let mut bits = sampler.bits();
    let count = |&rate: &f64| match rate * pulses as f64 {
        0.0 => Ok(0.0),
        mean => Ok(Poisson::new(mean).map_err(|_| too_bright(rate))?.sample(&mut bits) as f32),
    };
    rates.iter().map(count).collect()
}

fn first_detections(rates: &[f64], pulses: u64, sampler: Sampler) -> Result<Vec<f32>> {
    let mut bits = sampler.bits();
    let mut left = pulses;
    let count = |&rate: &f64| {
        // 1 - exp(-λ)
        let share = Binomial::new(left, -(-rate).exp_m1()).map_err(|_| too_bright(rate))?;
        let count = share.sample(&mut bits).min(left);
        left -= count;
        Ok(count as f32)
    };
    rates.iter().map(count).collect()
}

fn too_bright(rate: f64) -> Error {
    Error::new(format!("a bin with {rate:e} detections a flash cannot be counted")).with_hint("lower the efficiency")
}

#[cfg(test)]
mod tests {
    use super::super::{SPEED_OF_LIGHT, Timing};
    use super::*;

    const BINS: usize = 40;

    /// Bins of a nanosecond.
    fn transient(light: impl Fn(usize) -> f32) -> Transient {
        let values = (0..BINS).flat_map(|bin| [light(bin); 3]).collect();
        Transient::from_values((1, 1, BINS), Timing::new(0.0, SPEED_OF_LIGHT * 1e-9), values).expect("a pixel")
    }

    fn light(bin: usize) -> f32 {
        0.02 + 0.3 * (-((bin as f32 - 12.0) / 3.0).powi(2)).exp()
    }

    fn counts(spad: &Spad, transient: &Transient, seed: u64) -> Vec<f64> {
        let counted = spad.count(transient, seed).expect("counted");
        counted.profile(0, 0).iter().map(|value| value[0].into()).collect()
    }

    /// That no count lies more than 6.5 standard deviations from its mean. For 40 nearly normal counts the odds of a false
    /// alarm are 40 × 8e-11 = 3e-9.
    fn agree(found: &[f64], means: &[f64], variances: &[f64]) {
        for (bin, found) in found.iter().enumerate() {
            let z = (found - means[bin]) / variances[bin].sqrt();
            assert!(z.abs() < 6.5, "bin {bin}: {found} is {z} from {}", means[bin]);
        }
    }

    #[test]
    fn all_detections_are_poisson_with_background() {
        let spad = Spad { efficiency: 0.5, dark_rate: 4e6, ambient_rate: 6e6, pulses: 1 << 20, ..Spad::default() };
        let means: Vec<f64> =
            (0..BINS).map(|bin| f64::from(1 << 20) * (0.5 * f64::from(light(bin)) + 1e7 * 1e-9)).collect();
        agree(&counts(&spad, &transient(light), 1), &means, &means);
    }

    #[test]
    fn the_variance_of_counts_is_their_mean() {
        // Σ (n - μ)² / μ over 4000 counts has the mean 4000 and the standard deviation √(2 × 4000) = 89; with means of 1000
        // it is nearly normal, and 6 standard deviations have odds of 2e-9.
        let spad = Spad { pulses: 1000, ..Spad::default() };
        let flat = transient(|_| 1.0);
        let chi: f64 =
            (0..100).flat_map(|seed| counts(&spad, &flat, seed)).map(|n| (n - 1000.0).powi(2) / 1000.0).sum();
        assert!((chi - 4000.0).abs() < 6.0 * 89.5, "{chi}");
    }

    #[test]
    fn first_detections_pile_up() {
        let (spad, n) =
            (Spad { pulses: 1 << 20, counting: Counting::FirstPhoton, ..Spad::default() }, f64::from(1 << 20));
        let mut before = 0.0;
        let shares: Vec<f64> = (0..BINS)
            .map(|bin| {
                let rate = f64::from(light(bin));
                let share = (1.0 - (-rate).exp()) * f64::exp(-before);
                before += rate;
                share
            })
            .collect();
        let means: Vec<f64> = shares.iter().map(|share| n * share).collect();
        let variances: Vec<f64> = shares.iter().map(|share| n * share * (1.0 - share)).collect();
        let found = counts(&spad, &transient(light), 2);
        agree(&found, &means, &variances);
        assert!(found.iter().sum::<f64>() <= n);
    }

    #[test]
    fn coates_undoes_the_pile_up() {
        let spad = Spad {
            pulses: 1 << 22,
            counting: Counting::FirstPhoton,
            dark_rate: 1e6,
            efficiency: 0.8,
            ..Spad::default()
        };
        let counted = spad.count(&transient(light), 3).expect("counted");
        let found: Vec<f64> =
            spad.estimate(&counted).expect("estimated").profile(0, 0).iter().map(|value| value[0].into()).collect();
        // var λ̂ = (e^λ - 1) / (flashes without a detection before), and of the luminance 1/η² of it.
        let (mut before, mut means, mut variances) = (0.0, Vec::new(), Vec::new());
        for bin in 0..BINS {
            let rate = 0.8 * f64::from(light(bin)) + 1e-3;
            means.push(f64::from(light(bin)));
            variances.push(rate.exp_m1() / (f64::from(1 << 22) * f64::exp(-before)) / 0.64);
            before += rate;
        }
        agree(&found, &means, &variances);
    }

    #[test]
    fn jitter_spreads_and_delays() {
        let spad = Spad {
            jitter: 1.5 * SPEED_OF_LIGHT * 1e-9,
            tail: 2.0 * SPEED_OF_LIGHT * 1e-9,
            pulses: 1 << 22,
            ..Spad::default()
        };
        let found = counts(&spad, &transient(|bin| if bin == 10 { 0.5 } else { 0.0 }), 4);
        let total: f64 = found.iter().sum();
        let mean = found.iter().enumerate().map(|(bin, n)| n * bin as f64).sum::<f64>() / total;
        // Of 2²¹ detections, each with the variance 1.5² + 2² + 1/6 = 6.4: 6 standard deviations are 0.0105; what is cut off
        // behind the last bin is e^-14 of them.
        assert!((mean - 12.0).abs() < 0.011, "{mean}");
    }

    #[test]
    fn the_same_seed_counts_the_same_and_another_does_not() {
        let spad = Spad { counting: Counting::FirstPhoton, pulses: 100_000, ..Spad::default() };
        assert_eq!(counts(&spad, &transient(light), 5), counts(&spad, &transient(light), 5));
        assert_ne!(counts(&spad, &transient(light), 5), counts(&spad, &transient(light), 6));
    }

    #[test]
    fn what_is_no_detector_or_no_count_is_refused() {
        let perfect = Spad::default();
        for broken in [
            Spad { efficiency: 0.0, ..perfect },
            Spad { jitter: -1.0, ..perfect },
            Spad { dark_rate: f64::INFINITY, ..perfect },
            Spad { pulses: 0, ..perfect },
            Spad { pulses: u64::MAX, ..perfect },
        ] {
            assert!(broken.check().is_err(), "{broken:?}");
        }
        assert!(perfect.estimate(&transient(|_| 0.5)).is_err());
        let first = Spad { counting: Counting::FirstPhoton, ..perfect };
        assert!(first.estimate(&transient(|_| 900.0)).is_err());
        assert!(perfect.count(&transient(|_| f32::INFINITY), 0).is_err());
    }
}
