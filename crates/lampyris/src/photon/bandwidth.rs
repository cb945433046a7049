//! How the radius of an estimate is chosen (theory §5.3).

/// A rule for the radius; a pure function of the pass, so that passes can be computed in any order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bandwidth {
    /// Always this radius, in scene units.
    Fixed(f32),
    /// The distance of the `count`-th nearest photon, at most `max_radius`.
    Nearest {
        /// How many photons; the last of them sets the radius and is not counted itself.
        count: usize,
        /// In scene units; may be infinite.
        max_radius: f32,
    },
    /// Shrinking from pass to pass [Knaus & Zwicker 2011].
    Shrinking {
        /// At the first pass, in scene units.
        initial: f32,
        /// Between 0 and 1: how slowly. Variance falls as N^-α and, on surfaces, squared bias as N^-2(1-α).
        alpha: f32,
    },
}

/// A radius for one pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Radius {
    /// The same everywhere.
    Fixed(f32),
    /// Up to the distance of the `count`-th nearest photon.
    Nearest {
        /// How many photons.
        count: usize,
        /// At most this far.
        max_radius: f32,
    },
}

impl Bandwidth {
    /// The radius for pass number `pass`, from 0, of an estimate in D dimensions.
    pub fn radius<const D: usize>(&self, pass: u32) -> Radius {
        match *self {
            Bandwidth::Fixed(radius) => Radius::Fixed(radius),
            Bandwidth::Nearest { count, max_radius } => Radius::Nearest { count, max_radius },
            Bandwidth::Shrinking { initial, alpha } => Radius::Fixed(initial * shrunk::<D>(pass, alpha)),
        }
    }

    /// The area of the disk at pass number `pass`, from 0, that of the first pass being 1; none if it does not shrink.
    pub fn area(&self, pass: u32) -> Option<f64> {
        match *self {
            Bandwidth::Shrinking { alpha, .. } => Some(f64::from(shrunk::<2>(pass, alpha)).powi(2)),
            _ => None,
        }
    }
}

/// What is left of the radius of the first pass at pass number `pass`, from 0, in D dimensions.
pub fn shrunk<const D: usize>(pass: u32, alpha: f32) -> f32 {
    (shrinkage(pass, alpha) / D as f64).exp() as f32
}

/// ln Π (i + α)/(i + 1) for i from 1 to `pass`: the logarithm of what is left of the first pass's volume
/// [Knaus & Zwicker 2011, eq. 20].
fn shrinkage(pass: u32, alpha: f32) -> f64 {
    let alpha = f64::from(alpha);
    let term = |i: u32| ((f64::from(i) + alpha) / (f64::from(i) + 1.0)).ln();
    // Beyond some thousand factors the rest is an integral with a correction (Euler and Maclaurin) with an error of
    // about 1e-9, so that pass ten million costs no more than pass ten thousand.
    const EXACT: u32 = 4096;
    let exact: f64 = (1..=pass.min(EXACT)).map(term).sum();
    if pass <= EXACT {
        return exact;
    }
    let antiderivative = |x: f64| (x + alpha) * (x + alpha).ln() - (x + 1.0) * (x + 1.0).ln();
    let (from, to) = (f64::from(EXACT), f64::from(pass));
    exact + antiderivative(to) - antiderivative(from) + 0.5 * (term(pass) - term(EXACT))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radius_at(pass: u32) -> f64 {
        match (Bandwidth::Shrinking { initial: 1.0, alpha: 2.0 / 3.0 }).radius::<2>(pass) {
            Radius::Fixed(radius) => f64::from(radius),
            nearest => panic!("{nearest:?}"),
        }
    }

    #[test]
    fn the_first_passes_shrink_by_the_papers_ratios() {
        assert_eq!(radius_at(0), 1.0);
        for pass in 1..5 {
            let ratio = (radius_at(pass) / radius_at(pass - 1)).powi(2);
            let expected = (f64::from(pass) + 2.0 / 3.0) / (f64::from(pass) + 1.0);
            assert!((ratio - expected).abs() < 1e-6, "pass {pass}: {ratio} is not {expected}");
        }
    }

    #[test]
    fn the_integral_continues_the_product() {
        let alpha = f64::from(2.0_f32 / 3.0);
        let product: f64 = (1..=100_000).map(|i| ((f64::from(i) + alpha) / (f64::from(i) + 1.0)).ln()).sum();
        assert!((shrinkage(100_000, 2.0 / 3.0) - product).abs() < 1e-8);
    }
}
