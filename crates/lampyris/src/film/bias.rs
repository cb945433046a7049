//! How much of a picture is bias, as the fall of the bias from pass to pass tells (theory §6).
//!
//! Where photons are gathered within a radius that shrinks, pass i errs by b·aᵢ, with the area aᵢ of its disk over that of the
//! first pass. A line through the light of the passes over aᵢ has the slope b. The square of one slope would be too large by
//! its noise; so passes form groups, each with a slope of its own, and slopes of two groups are multiplied, whose noise has
//! nothing in common: no model of the noise is needed.

use rayon::prelude::*;

use super::exact::ExactSums;
use super::luminance_of;

/// Pass i is in group i modulo this number. As the first passes tell most, more groups would tell little more.
const GROUPS: usize = 8;

/// Pixels are taken together in squares of this side: bias varies slowly, noise does not.
const SIDE: usize = 8;

/// The bias of a picture, to first order in the area over which photons are gathered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bias {
    /// The mean over the picture of the square of its luminance's relative bias: over the luminance around it or, where that is
    /// darker, over a typical one. By chance it may be below 0.
    pub square: f64,
    /// The standard error of `square`.
    pub error_of_square: f64,
}

impl Bias {
    /// The root of the mean square.
    pub fn rms(&self) -> f64 {
        self.square.max(0.0).sqrt()
    }

    /// How much larger it may be, by one standard error.
    pub fn standard_error(&self) -> f64 {
        self.at_most(1.0) - self.rms()
    }

    /// The root of the mean square, and so many standard errors more of its square.
    pub fn at_most(&self, errors: f64) -> f64 {
        (self.square.max(0.0) + errors * self.error_of_square).sqrt()
    }
}

/// Sums of passes whose area is known.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BiasSums {
    width: usize,
    height: usize,
    groups: Vec<Group>,
}

#[derive(Clone, Debug, PartialEq)]
struct Group {
    /// The number of passes, Σ a and Σ a².
    areas: ExactSums,
    /// Of each block, Σ L and Σ a L, where L adds up the luminance of its pixels.
    light: ExactSums,
}

/// What one group tells.
struct Slope {
    /// Σ (a - mean of a)².
    spread: f64,
    /// Of each block, Σ (a - mean of a) L: its mean is the spread times the slope.
    light: Vec<f64>,
}

impl BiasSums {
    pub(super) fn new([width, height]: [usize; 2]) -> BiasSums {
        let group = Group { areas: ExactSums::new(3), light: ExactSums::new(2 * blocks([width, height])) };
        BiasSums { width, height, groups: vec![group; GROUPS] }
    }

    /// How many sums there are.
    pub(super) fn count(size: [usize; 2]) -> usize {
        GROUPS * (3 + 2 * blocks(size))
    }

    /// In an order that depends on nothing.
    pub(super) fn sums(&self) -> impl Iterator<Item = &ExactSums> {
        self.groups.iter().flat_map(|group| [&group.areas, &group.light])
    }

    /// The same, to be changed.
    pub(super) fn sums_mut(&mut self) -> impl Iterator<Item = &mut ExactSums> {
        self.groups.iter_mut().flat_map(|group| [&mut group.areas, &mut group.light])
    }

    /// Adds the pixels of pass `index`, whose area is this.
    pub(super) fn add(&mut self, index: u32, area: f64, pixels: &[[f32; 3]]) {
        let rows = pixels.par_chunks((SIDE * self.width).max(1)).map(|rows| self.of_blocks(rows));
        let light: Vec<f64> = rows.collect::<Vec<_>>().concat();
        let group = &mut self.groups[index as usize % GROUPS];
        group.areas.add_each(|power| area.powi(power as i32));
        group.light.add_each(|number| light[number / 2] * if number % 2 == 0 { 1.0 } else { area });
    }

    /// The luminance of the blocks in a row of them, each added up.
    fn of_blocks(&self, rows: &[[f32; 3]]) -> Vec<f64> {
        let mut light = vec![0.0; self.width.div_ceil(SIDE)];
        for row in rows.chunks(self.width) {
            for (light, pixels) in light.iter_mut().zip(row.chunks(SIDE)) {
                *light += pixels.iter().map(|pixel| luminance_of(*pixel)).sum::<f64>();
            }
        }
        light
    }

    pub(super) fn merge(&mut self, other: &BiasSums) {
        for (own, other) in self.groups.iter_mut().zip(&other.groups) {
            own.areas.merge(&other.areas);
            own.light.merge(&other.light);
        }
    }

    /// The bias of the mean of all passes, if there are enough to tell it, where this is a typical luminance.
    pub(super) fn estimate(&self, typical: f64) -> Option<Bias> {
        let (mut passes, mut area) = (0.0, 0.0);
        for group in &self.groups {
            passes += group.areas.value(0);
            area += group.areas.value(1);
        }
        let slopes: Vec<Slope> = self.groups.iter().filter_map(Group::slope).collect();
        // Two to be multiplied, and more to tell how uncertain that is.
        if slopes.len() < 4 {
            return None;
        }
        let scale = (area / passes).powi(2);
        let bias = Bias::of(&slopes, &self.products(&slopes, &self.weights(passes, typical)));
        let bias = Bias { square: scale * bias.square, error_of_square: scale * bias.error_of_square };
        (bias.square.is_finite() && bias.error_of_square.is_finite()).then_some(bias)
    }

    /// What squares of blocks, whose light is that of all their pixels, count in a relative mean square over the picture.
    fn weights(&self, passes: f64, typical: f64) -> Vec<f64> {
        let [across, down] = [self.width, self.height].map(|side| side.div_ceil(SIDE));
        let length = |side: usize, block: usize| SIDE.min(side - SIDE * block);
        let weight = |block: usize| {
            let pixels = (length(self.width, block % across) * length(self.height, block / across)) as f64;
            let light: f64 = self.groups.iter().map(|group| group.light.value(2 * block)).sum();
            1.0 / (pixels * (light / (passes * pixels)).max(typical).powi(2))
        };
        (0..across * down).map(weight).collect()
    }

    /// Means over the picture of the products of two groups' light.
    fn products(&self, slopes: &[Slope], weights: &[f64]) -> Vec<Vec<f64>> {
        let pixels = (self.width * self.height) as f64;
        let product = |a: &Slope, b: &Slope| {
            let products = a.light.iter().zip(&b.light).zip(weights).map(|((a, b), weight)| a * b * weight);
            products.sum::<f64>() / pixels
        };
        slopes.iter().map(|a| slopes.iter().map(|b| product(a, b)).collect()).collect()
    }
}

impl Group {
    /// Nothing of less than two passes, or of passes of one area.
    fn slope(&self) -> Option<Slope> {
        let [passes, sum, squares] = [0, 1, 2].map(|index| self.areas.value(index));
        let mean = sum / passes;
        let spread = squares - sum * mean;
        // What is lost in a difference of two sums.
        let is_known = passes >= 2.0 && spread > 1e-9 * squares;
        let light = |block: usize| self.light.value(2 * block + 1) - mean * self.light.value(2 * block);
        is_known.then(|| Slope { spread, light: (0..self.light.len() / 2).map(light).collect() })
    }
}

impl Bias {
    /// Of a first pass: the mean square of the slope, where `products` are those of the groups' light.
    fn of(slopes: &[Slope], products: &[Vec<f64>]) -> Bias {
        let spread = |group: usize| slopes[group].spread;
        let all: f64 = (0..slopes.len()).map(spread).sum();
        let (mut of_pairs, mut spread_of_pairs) = (0.0, 0.0);
        let (mut squares, mut spread_of_squares) = (0.0, 0.0);
        for a in 0..slopes.len() {
            for b in 0..a {
                of_pairs += products[a][b];
                spread_of_pairs += spread(a) * spread(b);
                // The difference of two slopes is noise; its product with what all others tell has the mean 0, and shows
                // how far such products scatter.
                let others = (0..slopes.len()).filter(|&other| other != a && other != b);
                let noise = |other: usize| products[other][a] / spread(a) - products[other][b] / spread(b);
                let noise: f64 = others.map(noise).sum();
                squares += noise.powi(2) / (1.0 / spread(a) + 1.0 / spread(b));
                spread_of_squares += (all - spread(a) - spread(b)).powi(2);
            }
        }
        Bias { square: of_pairs / spread_of_pairs, error_of_square: (4.0 / all * squares / spread_of_squares).sqrt() }
    }
}

fn blocks([width, height]: [usize; 2]) -> usize {
    width.div_ceil(SIDE) * height.div_ceil(SIDE)
}

#[cfg(test)]
mod tests {
    use rand_core::{Rng, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    const PASSES: u32 = 48;

    fn area(pass: u32) -> f64 {
        f64::from(pass + 1).powf(-1.0 / 3.0)
    }

    /// What is told of a picture of 20 × 20 pixels with the luminance 2 whose first pass errs by `bias`, up in one pixel and
    /// down in one of the next block, and that has noise, in all pixels of a block the same, which grows as photons get fewer.
    fn told(bias: f64, noise: f64, seed: u64) -> Bias {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut sums = BiasSums::new([20, 20]);
        for pass in 0..PASSES {
            // Of variance 1.
            let draws: Vec<f64> =
                (0..9).map(|_| 12_f64.sqrt() * (f64::from(random.next_u32()) / 2_f64.powi(32) - 0.5)).collect();
            let value = |pixel: usize| {
                let (x, y) = (pixel % 20 / SIDE, pixel / 20 / SIDE);
                let sign = if (x + y) % 2 == 0 { 1.0 } else { -1.0 };
                [(2.0 + sign * bias * area(pass) + noise * draws[3 * y + x] / area(pass).sqrt()) as f32; 3]
            };
            let pixels: Vec<[f32; 3]> = (0..400).map(value).collect();
            sums.add(pass, area(pass), &pixels);
        }
        sums.estimate(2.0).expect("enough passes")
    }

    fn expected(bias: f64) -> f64 {
        let mean: f64 = (0..PASSES).map(area).sum::<f64>() / f64::from(PASSES);
        let bias = bias * mean;
        // In 208 of the 400 pixels it makes brighter what it is related to.
        bias.powi(2) * (0.52 / (2.0 + bias).powi(2) + 0.48 / 2_f64.powi(2))
    }

    #[test]
    fn without_noise_the_bias_is_exact() {
        let bias = told(0.3, 0.0, 1);
        assert!((bias.square / expected(0.3) - 1.0).abs() < 1e-4, "{bias:?}");
        assert!(bias.standard_error() < 1e-4 * bias.rms() && bias.at_most(5.0) < 1.0001 * bias.rms(), "{bias:?}");
    }

    /// Of 400 renders each. The mean square is right on average, within five standard errors (one in 2e6); as the error that
    /// is told comes from eight groups, intervals of Student's 2.4 of them should hold the truth in about 95 %, and must in 90 %,
    /// which is as far from that.
    #[test]
    fn noise_is_not_taken_for_bias_and_the_error_is_told() {
        for (bias, noise) in [(0.0, 0.3), (0.1, 0.3), (0.3, 0.3), (0.3, 0.05)] {
            let all: Vec<Bias> = (0..400).map(|seed| told(bias, noise, seed)).collect();
            let covers = |found: &&Bias| (found.square - expected(bias)).abs() <= 2.4 * found.error_of_square;
            let covered = all.iter().filter(covers).count();
            assert!(covered >= 360, "{bias}, {noise}: {covered}");
            let mean = all.iter().map(|bias| bias.square).sum::<f64>() / 400.0;
            let variance = all.iter().map(|bias| (bias.square - mean).powi(2)).sum::<f64>() / 399.0;
            let off = (mean - expected(bias)) / (variance / 400.0).sqrt();
            assert!(off.abs() < 5.0, "{bias}, {noise}: {off}");
        }
    }

    #[test]
    fn nothing_is_told_by_too_few_passes_or_by_a_radius_that_stays() {
        let mut sums = BiasSums::new([3, 2]);
        for pass in 0..11 {
            sums.add(pass, area(pass), &[[1.0; 3]; 6]);
            assert_eq!(sums.estimate(1.0), None);
        }
        sums.add(11, area(11), &[[1.0; 3]; 6]);
        assert!(sums.estimate(1.0).is_some(), "four groups of two");
        let mut sums = BiasSums::new([3, 2]);
        (0..64).for_each(|pass| sums.add(pass, 0.7, &[[1.0 + pass as f32; 3]; 6]));
        assert_eq!(sums.estimate(1.0), None);
    }
}
