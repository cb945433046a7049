//! Choosing one of several things by weight.

/// A discrete distribution over `0..n`, proportional to non-negative weights.
#[derive(Clone, Debug, Default)]
pub struct Distribution {
    /// `cumulative[i]` is the probability of all before `i`; one more entry than weights, the last one 1.
    cumulative: Vec<f32>,
    /// `guide[j]` is the first place whose entry is above j / (guide's length − 1): of long distributions, so that a
    /// search touches little memory. Empty for short ones.
    guide: Vec<u32>,
}

/// Distributions of more things than this have a guide, with about one entry for as many of them.
const GUIDED: usize = 16;

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
        Distribution { guide: Distribution::guide(&cumulative), cumulative }
    }

    fn guide(cumulative: &[f32]) -> Vec<u32> {
        if cumulative.len() <= GUIDED {
            return Vec::new();
        }
        // A power of two, by which numbers are multiplied and divided without rounding.
        let steps = (cumulative.len() / GUIDED).next_power_of_two();
        let mut place = 0;
        let entry = |step| {
            let start = step as f32 / steps as f32;
            place += cumulative[place..].iter().take_while(|&&before| before <= start).count();
            place as u32
        };
        (0..=steps).map(entry).collect()
    }

    /// How many entries are not above `u`.
    #[inline]
    fn not_above(&self, u: f32) -> usize {
        let Some(steps) = self.guide.len().checked_sub(1) else {
            return self.cumulative.partition_point(|&before| before <= u);
        };
        let step = ((u * steps as f32) as usize).min(steps - 1);
        let (first, last) = (self.guide[step] as usize, self.guide[step + 1] as usize);
        first + self.cumulative[first..last].partition_point(|&before| before <= u)
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

    /// The inverse of [`Distribution::sample`]: what falls on `index` and is stretched to `rest`.
    pub fn unsample(&self, index: usize, rest: f32) -> f32 {
        (self.cumulative[index] + rest * self.probability(index)).min(ONE_MINUS_EPSILON)
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
        let mut index = self.not_above(u).saturating_sub(1).min(self.len() - 1);
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
    fn a_guide_leads_to_where_a_search_does() {
        for n in [15, 16, 17, 100, 1000] {
            let weights: Vec<f64> = (0..n).map(|i| if i % 7 < 3 { 0.0 } else { f64::from(i * i % 31) }).collect();
            let distribution = Distribution::new(&weights);
            let edges = distribution.cumulative.iter().flat_map(|&at| [at.next_down(), at, at.next_up()]);
            let even = (0..=4096).map(|i| i as f32 / 4096.0);
            for u in edges.chain(even).filter(|u| (0.0..1.0).contains(u)) {
                let searched = distribution.cumulative.partition_point(|&before| before <= u);
                assert_eq!(distribution.not_above(u), searched, "{n}, {u}");
            }
        }
    }

    #[test]
    fn all_zero_weights_choose_uniformly() {
        assert_eq!(Distribution::new(&[0.0, 0.0]).probability(1), 0.5);
    }
}
