//! Tests whose false alarms have stated odds. Seeds are fixed, so a test that passes once passes always; the odds say
//! how likely a change of seeds would be to fail a program without fault.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// Every statistical assertion has a false alarm with less than this probability.
pub const FALSE_ALARM: f64 = 1e-7;

/// Mean and variance of a sample.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub count: f64,
    pub mean: f64,
    /// Of one draw, unbiased.
    pub variance: f64,
}

impl Sample {
    pub fn of(values: &[f64]) -> Sample {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        Sample { count, mean, variance }
    }

    /// Variance of the mean.
    pub fn error2(&self) -> f64 {
        self.variance / self.count
    }
}

/// Two-sided p-value of Student's t.
fn p_of_t(t: f64, freedom: f64) -> f64 {
    2.0 * StudentsT::new(0.0, 1.0, freedom).expect("freedom").sf(t.abs())
}

/// Asserts by a t-test that values have this mean, to within `bias` (known, absolute). The values must be numerous or
/// near normal. Also asserts that the test could have seen a difference of `power` (relative), so that it never passes
/// for want of samples.
#[track_caller]
pub fn assert_mean(name: &str, values: &[f64], expected: f64, bias: f64, power: f64) {
    let sample = Sample::of(values);
    let error = sample.error2().sqrt();
    let off = ((sample.mean - expected).abs() - bias).max(0.0);
    let rounding = 2e-6 * expected.abs();
    if off > rounding {
        let p = p_of_t(off / error, sample.count - 1.0);
        assert!(p > FALSE_ALARM, "{name}: {} ± {error} is not {expected} (p = {p:e})", sample.mean);
    }
    let seen = critical_t(sample.count - 1.0) * error + bias;
    assert!(seen <= power * expected.abs() + rounding, "{name}: too weak, sees no less than {}", seen / expected);
}

/// Asserts by Welch's t-test that two samples have the same mean, where `tests` such tests are made together (Šidák).
#[track_caller]
pub fn assert_same_mean(name: &str, a: &[f64], b: &[f64], tests: usize, bias: f64) {
    let (a, b) = (Sample::of(a), Sample::of(b));
    let error2 = a.error2() + b.error2();
    let off = ((a.mean - b.mean).abs() - bias * a.mean.abs().max(b.mean.abs())).max(0.0);
    if off <= 2e-6 * a.mean.abs() {
        return;
    }
    let freedom = error2 * error2
        / (a.error2().powi(2) / (a.count - 1.0) + b.error2().powi(2) / (b.count - 1.0)).max(f64::MIN_POSITIVE);
    let p = p_of_t(off / error2.sqrt(), freedom);
    let each = sidak(tests);
    assert!(
        p > each,
        "{name}: {} ± {} and {} ± {} differ, p = {p:e} < {each:e}",
        a.mean,
        a.error2().sqrt(),
        b.mean,
        b.error2().sqrt()
    );
}

/// The significance of each of `tests` tests, so that all together have the agreed odds of a false alarm.
pub fn sidak(tests: usize) -> f64 {
    -((-FALSE_ALARM).ln_1p() / tests as f64).exp_m1()
}

/// |t| beyond which a difference is significant.
fn critical_t(freedom: f64) -> f64 {
    -StudentsT::new(0.0, 1.0, freedom).expect("freedom").inverse_cdf(0.5 * FALSE_ALARM)
}

/// Asserts that `observed` of `trials` happened at random with this probability (normal approximation of the binomial;
/// some ten expected of either outcome).
#[track_caller]
pub fn assert_frequency(name: &str, observed: f64, trials: f64, probability: f64) {
    let (mean, variance) = (trials * probability, trials * probability * (1.0 - probability));
    if variance < 1e-6 * trials {
        assert!((observed - mean).abs() <= 1e-3 * trials.sqrt(), "{name}: {observed}/{trials} is not {probability}");
        return;
    }
    // Half a count for continuity.
    let z = ((observed - mean).abs() - 0.5).max(0.0) / variance.sqrt();
    let p = 2.0 * Normal::standard().sf(z);
    assert!(p > FALSE_ALARM, "{name}: {observed} of {trials} instead of {mean} (p = {p:e})");
}

/// Asserts by Pearson's chi-square test that counts are distributed as expected. `trials` is the number of draws; what
/// of it neither list accounts for is a class of its own. Classes of few are joined.
#[track_caller]
pub fn assert_distribution(name: &str, observed: &[f64], expected: &[f64], trials: f64) {
    const FEW: f64 = 8.0;
    assert_eq!(observed.len(), expected.len());
    // A quadrature may find a little more than there is.
    let rest = |counts: &[f64]| (trials - counts.iter().sum::<f64>()).max(0.0);
    let mut classes: Vec<(f64, f64)> = observed.iter().copied().zip(expected.iter().copied()).collect();
    classes.push((rest(observed), rest(expected)));
    classes.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (mut chi2, mut count, mut joined) = (0.0, 0_u32, (0.0, 0.0));
    for (seen, due) in classes {
        joined = (joined.0 + seen, joined.1 + due);
        if joined.1 >= FEW {
            chi2 += (joined.0 - joined.1).powi(2) / joined.1;
            count += 1;
            joined = (0.0, 0.0);
        }
    }
    // What is left at the end would be a few of the last class; there is none unless nearly nothing is expected at all.
    assert!(joined.0 <= FEW + 40.0 * joined.1.abs(), "{name}: {} where {} were due", joined.0, joined.1);
    assert!(count >= 2 || chi2 < 1e-6 * trials, "{name}: one class of {trials}, chi² {chi2}");
    if count >= 2 {
        let p = ChiSquared::new(f64::from(count - 1)).expect("freedom").sf(chi2);
        assert!(p > FALSE_ALARM, "{name}: chi² = {chi2} with {count} classes, p = {p:e}");
    }
}
