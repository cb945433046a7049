//! The picture as it grows, pass by pass.

mod filter;
mod layers;

pub use layers::{Exposure, Features, Layer, Layered, Layers, Plain, Sink};

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
    layers: LayerSums,
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
            layers: LayerSums::new(layers, pixels),
        }
    }

    /// Adds the picture of a pass.
    ///
    /// # Panics
    /// If the picture has another size.
    pub fn add(&mut self, pass: &Image) {
        assert_eq!((pass.width(), pass.height()), (self.width, self.height), "a pass must have the film's size");
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
        self.add(&pass.image);
        self.layers.add(&pass.features);
    }

    /// The layers that are kept beside the picture.
    pub fn layers(&self) -> Layers {
        self.layers.layers()
    }

    /// The mean of a layer over the passes, if it is kept and the passes told of it (pictures of the photon map itself
    /// have no layers). A layer of one channel has it three times.
    pub fn layer(&self, layer: Layer) -> Option<Image> {
        let values = self.layers.values(layer, &self.sums, f64::from(self.passes.max(1)))?;
        Image::from_pixels(self.width, self.height, values)
    }

    /// How many passes were added.
    pub fn passes(&self) -> u32 {
        self.passes
    }

    /// The mean over the passes: linear radiance.
    pub fn image(&self) -> Image {
        let passes = f64::from(self.passes.max(1));
        let pixels = self.sums.iter().map(|sum| sum.map(|channel| (channel / passes) as f32)).collect();
        Image::from_pixels(self.width, self.height, pixels).unwrap_or_else(|| Image::new(self.width, self.height))
    }

    /// The standard error of the picture's luminance, as the root of the mean over pixels of its square, relative to
    /// the mean luminance; from the differences between passes, so none before the second. It does not know of bias.
    pub fn relative_error(&self) -> Option<f64> {
        if self.passes < 2 {
            return None;
        }
        let n = f64::from(self.passes);
        let (mut variance, mut mean) = (0.0, 0.0);
        for (sum, square) in self.sums.iter().zip(&self.squares) {
            let [r, g, b] = sum.map(|channel| (channel / n) as f32);
            let luminance = f64::from(luminance([r, g, b]));
            variance += (square / n - luminance * luminance).max(0.0) / (n - 1.0);
            mean += luminance;
        }
        let pixels = self.sums.len() as f64;
        (mean > 0.0).then(|| (variance / pixels).sqrt() / (mean / pixels))
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
}
