//! Choosing one of several things by weight.

/// A discrete distribution over `0..n`, proportional to non-negative weights.
#[derive(Clone, Debug, Default)]
pub struct Distribution {
    /// `cumulative[i]` is the probability of all before `i`; one more entry than weights, the last one 1.
    cumulative: Vec<f32>,
}

impl Distribution {
    /// Proportional to `weights`; uniform if all are zero. Empty for no weights.
    pub fn new(weights: &[f64]) -> Distribution {
        let total: f64 = weights.iter().sum();
        let (weights, total): (Vec<f64>, f64) =
            if total > 0.0 { (weights.to_vec(), total) } else { (vec![1.0; weights.len()], weights.len() as f64) };
        let mut before = 0.0;
        let mut cumulative = Vec::with_capacity(weights.len() + 1);
        for weight in weights {
            cumulative.push((before / total) as f32);
            before += weight;
        }
        cumulative.push(1.0);
        Distribution { cumulative }
    }

    /// How many things there are to choose from.
    pub fn len(&self) -> usize {
        self.cumulative.len().saturating_sub(1)
    }

    /// Whether there is nothing to choose.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The probability of `index`.
    pub fn probability(&self, index: usize) -> f32 {
        self.cumulative[index + 1] - self.cumulative[index]
    }

    /// The index that `u` in 0..1 falls on, its probability, and `u` stretched to 0..1 for use in what was chosen.
    ///
    /// # Panics
    /// If the distribution is empty.
    pub fn sample(&self, u: f32) -> (usize, f32, f32) {
        assert!(!self.is_empty(), "there is nothing to choose from");
        if self.len() == 1 {
            return (0, 1.0, u);
        }
        let mut index = self.cumulative.partition_point(|&before| before <= u).saturating_sub(1).min(self.len() - 1);
        // Rounding can leave a thing of probability zero under u at the very end: step back to one that has some.
        while self.probability(index) <= 0.0 && index > 0 {
            index -= 1;
        }
        let probability = self.probability(index);
        let rest = ((u - self.cumulative[index]) / probability.max(f32::MIN_POSITIVE)).clamp(0.0, ONE_MINUS_EPSILON);
        (index, probability, rest)
    }
}

/// The largest float below 1.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_follow_the_weights_and_zero_is_never_chosen() {
        let distribution = Distribution::new(&[1.0, 0.0, 3.0]);
        assert_eq!(distribution.sample(0.1).0, 0);
        assert_eq!(distribution.sample(0.25).0, 2);
        assert_eq!(distribution.sample(ONE_MINUS_EPSILON).0, 2);
        assert_eq!(distribution.probability(2), 0.75);
        assert!((distribution.sample(0.125).2 - 0.5).abs() < 1e-6);
    }

    #[test]
    fn all_zero_weights_choose_uniformly() {
        assert_eq!(Distribution::new(&[0.0, 0.0]).probability(1), 0.5);
    }
}
