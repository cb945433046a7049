//! What the sums of a film tell: the picture, its layers, and how far they are off.

use rayon::prelude::*;

use super::{Bias, Film, Layer, luminance_of};
use crate::image::Image;

impl Film {
    /// The mean over the passes: linear radiance.
    pub fn image(&self) -> Image {
        let pixels = (0..self.width * self.height).map(|pixel| self.mean(pixel)).collect();
        Image::from_pixels(self.width, self.height, pixels).unwrap_or_else(|| Image::new(self.width, self.height))
    }

    /// The mean of a layer over the passes, if it is kept and the passes told of it (pictures of the photon map itself
    /// have no layers). A layer of one channel has it three times.
    pub fn layer(&self, layer: Layer) -> Option<Image> {
        if !self.layers().contains(layer) || !self.layers.has_any() {
            return None;
        }
        let pixels = 0..self.width * self.height;
        let values = match layer {
            Layer::Variance if self.passes < 2 => return None,
            Layer::Variance => pixels.map(|pixel| [self.luminance(pixel).1 as f32; 3]).collect(),
            Layer::Samples => {
                let each = self.samples as f64 / f64::from(self.passes.max(1));
                pixels.map(|pixel| [(each * self.weight(pixel)) as f32; 3]).collect()
            }
            _ => self.layers.values(layer, |pixel| self.sum(pixel), |pixel| self.weight(pixel))?,
        };
        Image::from_pixels(self.width, self.height, values)
    }

    /// The sums of the channels of a pixel.
    fn sum(&self, pixel: usize) -> [f64; 3] {
        [0, 1, 2].map(|channel| self.sums.value(3 * pixel + channel))
    }

    fn mean(&self, pixel: usize) -> [f32; 3] {
        let weight = self.weight(pixel);
        self.sum(pixel).map(|channel| (channel / weight) as f32)
    }

    /// What the sums of a pixel are divided by.
    pub(super) fn weight(&self, pixel: usize) -> f64 {
        match self.weights.as_ref().map(|weights| weights.sums.value(pixel)) {
            Some(weight) if weight > 0.0 => weight,
            _ => f64::from(self.passes.max(1)),
        }
    }

    /// The mean of the luminance of a pixel, and the variance of that mean as the differences between passes tell it.
    fn luminance(&self, pixel: usize) -> (f64, f64) {
        let (n, weight, mean) = (f64::from(self.passes), self.weight(pixel), luminance_of(self.mean(pixel)));
        // Of a ratio of sums: the mean of (luminance − weight × ratio)², over the mean weight squared.
        let of_weights = match &self.weights {
            Some(weights) => mean * (mean * weights.squares.value(pixel) - 2.0 * weights.products.value(pixel)),
            None => -n * mean * mean,
        };
        let squares = (self.squares.value(pixel) + of_weights).max(0.0);
        (mean, squares * n / (weight * weight * (n - 1.0)))
    }

    /// The relative standard error of the picture's luminance (theory §6), as the root of the mean over pixels of its square;
    /// from the differences between passes, so none before the second. It does not know of bias.
    ///
    /// Each pixel's error is over its own luminance or, where that is darker, over that of a typical one: the square of
    /// the mean root.
    pub fn relative_error(&self) -> Option<f64> {
        let typical = self.typical();
        let square = |pixel: usize| {
            let (luminance, variance) = self.luminance(pixel);
            variance / luminance.max(typical).powi(2)
        };
        (self.passes >= 2 && typical > 0.0).then(|| self.mean_over(square).sqrt())
    }

    /// The relative bias of the picture's luminance, each pixel's as in [`Film::relative_error`], of passes with
    /// [a known area](super::Exposure::area); none before some sixteen passes.
    pub fn bias(&self) -> Option<Bias> {
        let sums = self.bias.as_ref()?;
        sums.estimate(self.typical())
    }

    /// The luminance of a typical pixel: the square of the mean root, which a lamp in a few pixels hardly changes, however
    /// bright it is.
    fn typical(&self) -> f64 {
        self.mean_over(|pixel| luminance_of(self.mean(pixel)).max(0.0).sqrt()).powi(2)
    }

    /// The mean of something over the picture.
    pub(super) fn mean_over(&self, of: impl Fn(usize) -> f64 + Sync) -> f64 {
        let pixels = self.width * self.height;
        let chunk = |chunk: usize| (chunk * CHUNK..pixels.min((chunk + 1) * CHUNK)).map(&of).sum();
        let chunks: Vec<f64> = (0..pixels.div_ceil(CHUNK)).into_par_iter().map(chunk).collect();
        chunks.into_iter().sum::<f64>() / pixels as f64
    }

    /// The mean luminance of the picture.
    pub(super) fn mean_luminance(&self) -> f64 {
        self.mean_over(|pixel| luminance_of(self.mean(pixel)))
    }
}

/// Pixels of which sums are taken together, so that their order does not depend on the threads.
const CHUNK: usize = 1 << 12;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Exposure;

    #[test]
    fn the_image_is_the_mean_and_the_error_that_of_the_passes() {
        let mut film = Film::new([1, 1]);
        for value in [1.0, 3.0] {
            film.add_pass(&Image::from_pixels(1, 1, vec![[value; 3]]).expect("one pixel").into());
        }
        assert_eq!(film.image().pixel(0, 0), [2.0; 3]);
        // Standard error of the mean of 1 and 3 is √(((1² + 1²) / 1) / 2) = 1, half of the mean.
        assert!((film.relative_error().expect("two passes") - 0.5).abs() < 1e-6);
    }

    #[test]
    fn what_weighs_more_counts_more_and_a_constant_has_no_error() {
        let pass = |value: f32, weight: f32| {
            let image = Image::from_pixels(1, 1, vec![[value * weight; 3]]).expect("one pixel");
            Exposure { weights: vec![weight], ..Exposure::from(image) }
        };
        let film = |passes: &[(f32, f32)]| {
            let mut film = Film::new([1, 1]);
            passes.iter().for_each(|&(value, weight)| film.add_pass(&pass(value, weight)));
            film
        };
        let uneven = film(&[(1.0, 0.5), (3.0, 1.5)]);
        assert_eq!(uneven.image().pixel(0, 0), [2.5; 3]);
        // Residuals 0.5 × (1 - 2.5) and 1.5 × (3 - 2.5) of a mean weight of 1.
        let expected = ((0.75_f64.powi(2) + 0.75_f64.powi(2)) / 2.0).sqrt() / 2.5;
        assert!((uneven.relative_error().expect("two passes") - expected).abs() < 1e-6);
        assert!(film(&[(2.0, 0.4), (2.0, 1.2), (2.0, 0.7)]).relative_error().expect("passes") < 1e-6);
    }

    /// Nor does it hide the errors of all others behind its own light.
    #[test]
    fn a_lamp_that_is_seen_by_chance_counts_no_more_than_its_pixel() {
        let error = |lamp: f32| {
            let mut film = Film::new([100, 100]);
            for pass in 0..10_u8 {
                let value = |pixel: usize| match (pixel, pass) {
                    (0, 0) => lamp,
                    _ => 1.0 + 0.1 * f32::from((pass + pixel as u8 % 2) % 2),
                };
                let pixels = (0..10_000).map(|pixel| [value(pixel); 3]).collect();
                film.add_pass(&Image::from_pixels(100, 100, pixels).expect("pixels").into());
            }
            film.relative_error().expect("passes")
        };
        let without = 0.05 / 9_f64.sqrt() / 1.05;
        assert!((error(1.0) / without - 1.0).abs() < 1e-3);
        // One pixel of 10,000 is wholly unknown.
        for lamp in [1e3, 1e5] {
            assert!((error(lamp) / without.hypot(0.01) - 1.0).abs() < 0.02, "{}", error(lamp));
        }
    }
}
