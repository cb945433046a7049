//! A source that does not flash at once, or a sensor that is not exact: the response to a delta pulse, convolved.

use rayon::prelude::*;

use super::Transient;
use crate::error::{Error, Result};

/// How a flash at path length 0 is spread over path lengths; its integral is 1.
#[derive(Clone, Debug, PartialEq)]
pub enum Pulse {
    /// Not at all.
    Delta,
    /// A Gaussian around 0.
    Gaussian {
        /// The full width at half maximum, in scene units.
        fwhm: f64,
    },
    /// A Gaussian around 0 convolved with an exponential e^(-s/tail)/tail from 0 on, as single-photon detectors respond. Its
    /// mean is `tail`, its variance sigma² + tail². Either may be 0.
    ModifiedGaussian {
        /// The standard deviation of the Gaussian, in scene units.
        sigma: f64,
        /// The mean of the exponential, in scene units.
        tail: f64,
    },
    /// Measured: linear between these points and 0 beyond them.
    Table(Table),
}

/// A tabulated pulse of area 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Path length in scene units, rising; density.
    points: Vec<(f64, f64)>,
}

impl Table {
    /// The pulse through these points: path lengths in scene units, each above the one before, and strengths in any unit.
    ///
    /// # Errors
    /// Fewer than two points, path lengths that do not rise, strengths that are negative or all 0, or what is not finite.
    pub fn new(points: Vec<(f64, f64)>) -> Result<Table> {
        if points.len() < 2 {
            return Err(Error::new("a tabulated pulse needs at least two points"));
        }
        if let Some((at, strength)) = points.iter().find(|(at, v)| !(at.is_finite() && v.is_finite() && *v >= 0.0)) {
            return Err(Error::new(format!("a pulse cannot have the strength {strength} at {at}"))
                .with_hint("strengths are numbers from 0 on"));
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[0].0 >= pair[1].0) {
            return Err(Error::new(format!(
                "the path lengths of a pulse must rise, but {} follows {}",
                pair[1].0, pair[0].0
            )));
        }
        let area: f64 = points.windows(2).map(|p| (p[1].0 - p[0].0) * (p[0].1 + p[1].1) / 2.0).sum();
        if !area.is_finite() {
            return Err(Error::new("the path lengths and strengths of a pulse are too large"));
        }
        if area == 0.0 {
            return Err(Error::new("a pulse must have a strength above 0 somewhere"));
        }
        Ok(Table { points: points.into_iter().map(|(at, strength)| (at, strength / area)).collect() })
    }
}

/// A full width at half maximum is this many standard deviations: √(8 ln 2).
const FWHM_PER_SIGMA: f64 = 2.354_820_045_030_949;

/// A Gaussian has nothing to tell beyond so many standard deviations, nor an exponential beyond so many means.
const SIGMAS: f64 = 9.0;
const TAILS: f64 = 40.0;

impl Pulse {
    /// Finds what makes no pulse.
    ///
    /// # Errors
    /// Widths that are negative or not finite.
    pub fn check(&self) -> Result<()> {
        let widths = match *self {
            Pulse::Gaussian { fwhm } => [("fwhm", fwhm), ("tail", 0.0)],
            Pulse::ModifiedGaussian { sigma, tail } => [("sigma", sigma), ("tail", tail)],
            Pulse::Delta | Pulse::Table(_) => [("", 0.0); 2],
        };
        match widths.into_iter().find(|(_, width)| !(width.is_finite() && *width >= 0.0)) {
            None => Ok(()),
            Some((name, width)) => {
                Err(Error::new(format!("the {name} of a pulse must be a number from 0 on, not {width}")))
            }
        }
    }

    /// How much of the light of a bin goes to each bin around it: `(first, weights)`, where `weights[0]` belongs to the bin
    /// `first` after it, negative before it. At most `reach` bins away. The light within a bin counts as spread evenly: a
    /// weight is the integral of the pulse under a tent, as wide as two bins. So the weights of all bins add up to 1, and their
    /// mean is the pulse's.
    pub fn weights(&self, bin_width: f64, reach: usize) -> (isize, Vec<f64>) {
        let (first, last) = self.support();
        let within = |bin: f64| bin.clamp(-(reach as f64), reach as f64) as isize;
        let (first, last) = (within((first / bin_width).floor()), within((last / bin_width).ceil()));
        // The second difference of the second antiderivative.
        let at: Vec<f64> = (first - 1..=last + 1).map(|bin| self.twice_integrated(bin as f64 * bin_width)).collect();
        let weights = at.windows(3).map(|at| ((at[2] - at[1]) - (at[1] - at[0])).max(0.0) / bin_width).collect();
        (first, weights)
    }

    /// Where it is more than nothing.
    fn support(&self) -> (f64, f64) {
        match self {
            Pulse::Delta => (0.0, 0.0),
            Pulse::Gaussian { fwhm } => (-SIGMAS * fwhm / FWHM_PER_SIGMA, SIGMAS * fwhm / FWHM_PER_SIGMA),
            Pulse::ModifiedGaussian { sigma, tail } => (-SIGMAS * sigma, SIGMAS * sigma + TAILS * tail),
            Pulse::Table(table) => match &table.points[..] {
                [first, .., last] => (first.0, last.0),
                _ => (0.0, 0.0),
            },
        }
    }

    /// ∫ (x - t) p(t) dt over t < x: the pulse p integrated twice.
    fn twice_integrated(&self, x: f64) -> f64 {
        match self {
            Pulse::Delta => x.max(0.0),
            Pulse::Gaussian { fwhm } => gaussian_twice(x, fwhm / FWHM_PER_SIGMA),
            // From p = (Φ - P) / τ, where Φ and P are the cumulative functions of Gaussian and pulse.
            Pulse::ModifiedGaussian { sigma, tail } => gaussian_twice(x, *sigma) - tail * cumulative(x, *sigma, *tail),
            Pulse::Table(table) => table.points.windows(2).map(|pair| segment_twice(x, pair[0], pair[1])).sum(),
        }
    }
}

/// The standard normal distribution up to z.
fn normal(z: f64) -> f64 {
    0.5 * libm::erfc(-z / std::f64::consts::SQRT_2)
}

fn normal_density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt()
}

fn gaussian_twice(x: f64, sigma: f64) -> f64 {
    if sigma > 0.0 { x * normal(x / sigma) + sigma * normal_density(x / sigma) } else { x.max(0.0) }
}

/// The share of an exponentially modified Gaussian up to x: Φ(x/σ) - exp(σ²/2τ² - x/τ) Φ(x/σ - σ/τ).
fn cumulative(x: f64, sigma: f64, tail: f64) -> f64 {
    if tail <= 0.0 {
        return if sigma > 0.0 { normal(x / sigma) } else { f64::from(x >= 0.0) };
    }
    if sigma <= 0.0 {
        return if x > 0.0 { -(-x / tail).exp_m1() } else { 0.0 };
    }
    let z = x / sigma - sigma / tail;
    let tail_part = if z > -30.0 {
        (0.5 * (sigma / tail).powi(2) - x / tail).exp() * normal(z)
    } else {
        // The exponential would overflow; Mills' ratio of Φ to its density takes it in.
        let square = 1.0 / (z * z);
        normal_density(x / sigma) / -z * (1.0 - square + 3.0 * square * square)
    };
    normal(x / sigma) - tail_part
}

/// [`Pulse::twice_integrated`] of the straight line between two points.
fn segment_twice(x: f64, (start, low): (f64, f64), (end, high): (f64, f64)) -> f64 {
    let (reach, upto) = (x - start, x.min(end) - start);
    if upto <= 0.0 {
        return 0.0;
    }
    let slope = (high - low) / (end - start);
    low * (reach * upto - upto * upto / 2.0) + slope * (reach * upto * upto / 2.0 - upto.powi(3) / 3.0)
}

impl Transient {
    /// What arrives when the lamps do not flash at once, but as `pulse` says; or what a sensor with this response sees. What
    /// leaves the bins is lost, and nothing comes in from outside.
    ///
    /// # Errors
    /// As [`Pulse::check`].
    pub fn convolved(&self, pulse: &Pulse) -> Result<Transient> {
        pulse.check()?;
        let (first, weights) = pulse.weights(self.axis().bin_width, self.bins() - 1);
        let mut values = vec![0.0; self.values().len()];
        let width = 3 * self.bins();
        values.par_chunks_exact_mut(width).zip(self.values().par_chunks_exact(width)).for_each(|(out, profile)| {
            for channel in 0..3 {
                let lit: Vec<f64> = profile.iter().skip(channel).step_by(3).map(|&value| value.into()).collect();
                for (value, sum) in out.iter_mut().skip(channel).step_by(3).zip(convolve(&lit, first, &weights)) {
                    *value = sum as f32;
                }
            }
        });
        Ok(self.with_values(values))
    }
}

/// Each bin's light, shared out by the weights, in as many bins.
pub(super) fn convolve(light: &[f64], first: isize, weights: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; light.len()];
    for (bin, &amount) in light.iter().enumerate().filter(|(_, amount)| **amount != 0.0) {
        let start = bin as isize + first;
        let cut = (-start).max(0) as usize;
        let to = sums.iter_mut().skip((start + cut as isize) as usize);
        for (sum, weight) in to.zip(weights.iter().skip(cut)) {
            *sum += amount * weight;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::super::Timing;
    use super::*;

    /// The mean and the variance of weights, in bins.
    fn moments((first, weights): &(isize, Vec<f64>)) -> [f64; 3] {
        let at = |power: i32| {
            weights.iter().enumerate().map(|(i, w)| w * ((*first + i as isize) as f64).powi(power)).sum::<f64>()
        };
        [at(0), at(1), at(2) - at(1) * at(1)]
    }

    fn pulses() -> Vec<Pulse> {
        let triangle = Table::new(vec![(-1.0, 0.0), (0.5, 6.0), (2.0, 0.0)]).expect("a pulse");
        vec![
            Pulse::Delta,
            Pulse::Gaussian { fwhm: 0.0 },
            Pulse::Gaussian { fwhm: 3.0 },
            Pulse::ModifiedGaussian { sigma: 0.7, tail: 1.3 },
            Pulse::ModifiedGaussian { sigma: 0.0, tail: 2.0 },
            Pulse::ModifiedGaussian { sigma: 2.0, tail: 0.01 },
            Pulse::Table(triangle),
        ]
    }

    #[test]
    fn weights_add_up_to_one_and_keep_the_mean_in_bins_of_any_width() {
        let means = [0.0, 0.0, 0.0, 1.3, 2.0, 0.01, 0.5];
        for (pulse, mean) in pulses().iter().zip(means) {
            for width in [0.05, 0.3, 1.0, 7.0] {
                let [sum, first, _] = moments(&pulse.weights(width, 10_000));
                assert!((sum - 1.0).abs() < 1e-9, "{pulse:?}, {width}: {sum}");
                assert!((first * width - mean).abs() < 1e-8, "{pulse:?}, {width}: {}", first * width);
            }
        }
    }

    #[test]
    fn narrow_bins_have_the_variance_of_the_pulse() {
        let sigma = 3.0 / FWHM_PER_SIGMA;
        let variances = [0.0, 0.0, sigma * sigma, 0.49 + 1.69, 4.0, 4.0 + 1e-4, 0.375];
        let width = 0.01;
        for (pulse, variance) in pulses().iter().zip(variances) {
            // The tent adds its own, at most a quarter of a bin's square; a Gaussian pulse, a sixth.
            let found = moments(&pulse.weights(width, 100_000))[2] * width * width;
            assert!((found - variance).abs() < 0.3 * width * width, "{pulse:?}: {found}, not {variance}");
        }
    }

    #[test]
    fn a_gaussian_is_half_as_strong_at_half_its_width() {
        let (first, weights) = Pulse::Gaussian { fwhm: 1.0 }.weights(1e-3, 100_000);
        let at = |bin: isize| weights[(bin - first) as usize];
        assert!((at(500) / at(0) - 0.5).abs() < 1e-6 && (at(-500) / at(0) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn a_delta_pulse_changes_nothing_and_a_late_one_shifts() {
        let transient =
            Transient::from_values((1, 1, 4), Timing::new(0.0, 0.5), (0..12).map(|v| v as f32).collect()).expect("12");
        assert_eq!(transient.convolved(&Pulse::Delta).expect("a pulse"), transient);
        // A bin late, as narrow as nothing: a table from 0.5 - ε to 0.5 + ε.
        let late = Table::new(vec![(0.499_999, 1.0), (0.500_001, 1.0)]).expect("a pulse");
        let shifted = transient.convolved(&Pulse::Table(late)).expect("a pulse");
        for (a, b) in shifted.profile(0, 0)[1..].iter().flatten().zip(transient.profile(0, 0).iter().flatten()) {
            assert!((a - b).abs() < 1e-4, "{shifted:?}");
        }
    }

    #[test]
    fn what_is_no_pulse_is_refused() {
        for points in [
            vec![(0.0, 1.0)],
            vec![(0.0, 1.0), (0.0, 2.0)],
            vec![(0.0, 0.0), (1.0, 0.0)],
            vec![(0.0, -1.0), (1.0, 2.0)],
        ] {
            assert!(Table::new(points).is_err());
        }
        let large = Table::new(vec![(-1e308, 1e308), (1e308, 1.0)]).expect_err("an area that is infinite").to_string();
        assert!(large.contains("too large"), "{large}");
        assert!(Pulse::Gaussian { fwhm: -1.0 }.check().is_err());
        assert!(Pulse::ModifiedGaussian { sigma: 1.0, tail: f64::NAN }.check().is_err());
    }
}
