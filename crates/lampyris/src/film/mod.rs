//! The picture as it grows, pass by pass.

mod filter;
mod layers;
mod spread;

pub use layers::{Exposure, Features, Layer, Layered, Layers, Plain, Sink};

pub(crate) use spread::{Band, Sums};

use layers::LayerSums;

use crate::image::{Image, luminance};

/// Sums over passes, in double precision and in the order of the passes.
#[derive(Clone, Debug)]
pub struct Film {
    width: usize,
    height: usize,
    passes: u32,
    sums: Vec<[f64; 3]>,
    /// Σ luminance² of the passes.
    squares: Vec<f64>,
    /// From the first pass on that has weights.
    weights: Option<Weights>,
    layers: LayerSums,
}

/// What the passes weigh, by pixel.
#[derive(Clone, Debug)]
struct Weights {
    sums: Vec<f64>,
    squares: Vec<f64>,
    /// Σ weight × luminance.
    products: Vec<f64>,
}

impl Film {
    /// Before the first pass, for the picture alone.
    pub fn new(size: [u32; 2]) -> Film {
        Film::with_layers(size, Layers::NONE)
    }

    /// Before the first pass, for a picture with these layers.
    pub fn with_layers([width, height]: [u32; 2], layers: Layers) -> Film {
        let (width, height) = (width as usize, height as usize);
        let pixels = width * height;
        Film {
            width,
            height,
            passes: 0,
            sums: vec![[0.0; 3]; pixels],
            squares: vec![0.0; pixels],
            weights: None,
            layers: LayerSums::new(layers, pixels),
        }
    }

    /// Adds the picture of a pass of weight 1.
    ///
    /// # Panics
    /// If the picture has another size.
    pub fn add(&mut self, pass: &Image) {
        self.add_weighted(pass, &[]);
    }

    fn add_weighted(&mut self, pass: &Image, weights: &[f32]) {
        assert_eq!((pass.width(), pass.height()), (self.width, self.height), "a pass must have the film's size");
        if !weights.is_empty() && self.weights.is_none() {
            self.weights = Some(Weights::of_ones(self.passes, &self.sums));
        }
        if let Some(sums) = &mut self.weights {
            sums.add(pass, weights);
        }
        for ((sum, square), &pixel) in self.sums.iter_mut().zip(&mut self.squares).zip(pass.pixels()) {
            for (sum, value) in sum.iter_mut().zip(pixel) {
                *sum += f64::from(value);
            }
            *square += f64::from(luminance(pixel)).powi(2);
        }
        self.passes += 1;
    }

    /// Adds a pass, with what it tells of the layers.
    ///
    /// # Panics
    /// If the picture has another size.
    pub fn add_pass(&mut self, pass: &Exposure) {
        self.add_weighted(&pass.image, &pass.weights);
        self.layers.add(&pass.features);
    }

    /// The layers that are kept beside the picture.
    pub fn layers(&self) -> Layers {
        self.layers.layers()
    }

    /// The mean of a layer over the passes, if it is kept and the passes told of it (pictures of the photon map itself
    /// have no layers). A layer of one channel has it three times.
    pub fn layer(&self, layer: Layer) -> Option<Image> {
        let values = self.layers.values(layer, &self.sums, |pixel| self.weight(pixel))?;
        Image::from_pixels(self.width, self.height, values)
    }

    /// How many passes were added.
    pub fn passes(&self) -> u32 {
        self.passes
    }

    /// The mean over the passes: linear radiance.
    pub fn image(&self) -> Image {
        let mean = |(pixel, sum): (usize, &[f64; 3])| sum.map(|channel| (channel / self.weight(pixel)) as f32);
        let pixels = self.sums.iter().enumerate().map(mean).collect();
        Image::from_pixels(self.width, self.height, pixels).unwrap_or_else(|| Image::new(self.width, self.height))
    }

    /// What the sums of a pixel are divided by.
    fn weight(&self, pixel: usize) -> f64 {
        match &self.weights {
            Some(weights) if weights.sums[pixel] > 0.0 => weights.sums[pixel],
            _ => f64::from(self.passes.max(1)),
        }
    }

    /// The standard error of the picture's luminance, as the root of the mean over pixels of its square, relative to
    /// the mean luminance; from the differences between passes, so none before the second. It does not know of bias.
    pub fn relative_error(&self) -> Option<f64> {
        if self.passes < 2 {
            return None;
        }
        let n = f64::from(self.passes);
        let (mut variance, mut mean) = (0.0, 0.0);
        for (pixel, (sum, square)) in self.sums.iter().zip(&self.squares).enumerate() {
            let weight = self.weight(pixel);
            let luminance = f64::from(luminance(sum.map(|channel| (channel / weight) as f32)));
            // Of a ratio of sums: the mean of (luminance − weight × ratio)², over the mean weight squared.
            let of_weights = match &self.weights {
                Some(weights) => luminance * (luminance * weights.squares[pixel] - 2.0 * weights.products[pixel]),
                None => -n * luminance * luminance,
            };
            variance += (square + of_weights).max(0.0) * n / (weight * weight * (n - 1.0));
            mean += luminance;
        }
        let pixels = self.sums.len() as f64;
        (mean > 0.0).then(|| (variance / pixels).sqrt() / (mean / pixels))
    }
}

impl Weights {
    /// After so many passes of weight 1, whose pictures have these sums.
    fn of_ones(passes: u32, pictures: &[[f64; 3]]) -> Weights {
        let ones = vec![f64::from(passes); pictures.len()];
        let luminance = |sum: &[f64; 3]| f64::from(luminance(sum.map(|channel| channel as f32)));
        Weights { sums: ones.clone(), squares: ones, products: pictures.iter().map(luminance).collect() }
    }

    fn add(&mut self, pass: &Image, weights: &[f32]) {
        let weights = weights.iter().copied().chain(std::iter::repeat(1.0)).map(f64::from);
        let sums = self.sums.iter_mut().zip(&mut self.squares).zip(&mut self.products);
        for (((sum, square), product), (weight, &pixel)) in sums.zip(weights.zip(pass.pixels())) {
            *sum += weight;
            *square += weight * weight;
            *product += weight * f64::from(luminance(pixel));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_image_is_the_mean_and_the_error_that_of_the_passes() {
        let mut film = Film::new([1, 1]);
        for value in [1.0, 3.0] {
            film.add(&Image::from_pixels(1, 1, vec![[value; 3]]).expect("one pixel"));
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
}
