//! The picture as it grows, pass by pass.

mod bias;
mod bins;
mod clock;
mod exact;
mod exposure;
mod filter;
mod layers;
mod passes;
mod sinks;
mod spread;
mod storage;
mod timed;

pub use bias::Bias;
pub use clock::Clock;
pub use exposure::{Arrival, Exposure, Features};
pub use layers::{Layer, Layers};
pub use passes::PassSet;
pub use sinks::{Layered, Plain, Sink};
pub use storage::Storage;
pub use timed::Timed;

pub(crate) use spread::{Band, Sums};
pub(crate) use timed::Way;

use std::io::{self, Read, Write};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use bias::BiasSums;
use bins::BinSums;
use exact::ExactSums;
use layers::LayerSums;

use crate::error::{Error, Result};
use crate::image::{Image, luminance};
use crate::transient::{Capture, Phasors, TimeLayer, Transient};

/// Sums over passes, which are the same to the last bit in whatever order the passes come, and in however many films that
/// are merged.
///
/// It takes 68 bytes a pixel, 5 more where bias is told, 51 more with a filter that spreads samples, up to 340 more with
/// all layers, and 51 more for each time bin, or 68 with its variance, once more for each layer in time.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: usize,
    height: usize,
    passes: u32,
    /// Camera samples of a pixel, in all passes.
    samples: u64,
    /// Three a pixel.
    sums: ExactSums,
    /// Σ luminance² of the passes.
    squares: ExactSums,
    /// From the first pass on, if it has weights.
    weights: Option<Weights>,
    /// From the first pass on, if its area is known.
    bias: Option<BiasSums>,
    layers: LayerSums,
    bins: Option<BinSums>,
    capture: Option<Capture>,
}

/// What sums a film has, and of what.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FilmShape {
    size: [usize; 2],
    passes: u32,
    samples: u64,
    has_weights: bool,
    has_bias: bool,
    layers: Vec<String>,
    /// Whether any pass told of the layers.
    has_features: bool,
    time: Option<Clock>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    capture: Option<Capture>,
}

/// What the passes weigh, by pixel.
#[derive(Clone, Debug, PartialEq)]
struct Weights {
    sums: ExactSums,
    squares: ExactSums,
    /// Σ weight × luminance.
    products: ExactSums,
}

impl Film {
    /// Passes that a film can hold.
    pub const MOST_PASSES: u32 = exact::MOST_VALUES;

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
            samples: 0,
            sums: ExactSums::new(3 * pixels),
            squares: ExactSums::new(pixels),
            weights: None,
            bias: None,
            layers: LayerSums::new(layers, pixels),
            bins: None,
            capture: None,
        }
    }

    /// The same with these time bins, before the first pass.
    ///
    /// # Errors
    /// More bins than there can be, or files for which there is no room.
    pub fn with_time(self, clock: Clock, storage: &Storage) -> Result<Film> {
        let bins = BinSums::new(clock, self.width * self.height, storage)?;
        Ok(Film { bins: Some(bins), ..self })
    }

    /// The same of a wall that is captured so, if it is one.
    ///
    /// # Errors
    /// As [`Capture::check`].
    pub fn with_capture(self, capture: Option<Capture>) -> Result<Film> {
        capture.as_ref().map_or(Ok(()), |capture| capture.check(self.width, self.height))?;
        Ok(Film { capture, ..self })
    }

    /// Adds some of the arrivals of the pass that is added next, in the order of pixels and slots: all that it has of each of
    /// these pairs. A pass so large that they are more than there is room for brings them in parts.
    pub fn add_arrivals(&mut self, arrivals: &[Arrival]) {
        if let Some(bins) = &mut self.bins {
            bins.add(arrivals);
        }
    }

    /// Adds a pass, with what it tells of the layers, on the current `rayon` pool. Whether weights and areas count is for the
    /// first pass to tell: all passes of a render have them, or none has.
    ///
    /// # Panics
    /// If the picture has another size, or if there were [`Film::MOST_PASSES`] already.
    pub fn add_pass(&mut self, pass: &Exposure) {
        let Exposure { image, features, weights, samples, area, arrivals } = pass;
        let pixels = self.width * self.height;
        assert_eq!((image.width(), image.height()), (self.width, self.height), "a pass must have the film's size");
        assert!(self.passes < Film::MOST_PASSES, "a film holds no more than {} passes", Film::MOST_PASSES);
        if self.passes == 0 && !weights.is_empty() {
            self.weights = Some(Weights::new(pixels));
        }
        if self.passes == 0 && area.is_some() {
            self.bias = Some(BiasSums::new(self.size()));
        }
        let (values, luminances) = (image.pixels().as_flattened(), |pixel: usize| luminance_of(image.pixels()[pixel]));
        self.sums.add_each(|index| f64::from(values[index]));
        self.squares.add_each(|pixel| luminances(pixel).powi(2));
        if let Some(sums) = &mut self.weights {
            let weight = |pixel: usize| f64::from(weights.get(pixel).copied().unwrap_or(1.0));
            sums.sums.add_each(weight);
            sums.squares.add_each(|pixel| weight(pixel).powi(2));
            sums.products.add_each(|pixel| weight(pixel) * luminances(pixel));
        }
        if let (Some(sums), Some((index, area))) = (&mut self.bias, *area) {
            sums.add(index, area, image.pixels());
        }
        self.layers.add(features);
        self.add_arrivals(arrivals);
        self.passes += 1;
        self.samples = self.samples.saturating_add(u64::from(*samples));
    }

    /// Adds the passes of another film: the same to the bit as adding them here.
    ///
    /// # Errors
    /// Films of different sizes, layers, bins or walls, or of more passes than one can hold.
    pub fn merge(&mut self, other: &Film) -> Result<()> {
        if (self.width, self.height) != (other.width, other.height) {
            let sizes = [self.width, self.height, other.width, other.height];
            return Err(Error::new(format!(
                "films of {}×{} and {}×{} cannot be merged",
                sizes[0], sizes[1], sizes[2], sizes[3]
            )));
        }
        if self.layers() != other.layers() {
            return Err(Error::new("films of different layers cannot be merged"));
        }
        if self.clock() != other.clock() {
            return Err(Error::new("films of different time bins cannot be merged"));
        }
        if self.capture != other.capture {
            return Err(Error::new("films of walls that were captured in different ways cannot be merged"));
        }
        if other.passes == 0 {
            return Ok(());
        }
        if self.passes == 0 {
            self.weights = other.weights.as_ref().map(|_| Weights::new(self.width * self.height));
            self.bias = other.bias.as_ref().map(|_| BiasSums::new(self.size()));
        }
        let passes = self.passes.saturating_add(other.passes);
        if passes > Film::MOST_PASSES {
            let most = Film::MOST_PASSES;
            return Err(Error::new(format!("a film cannot hold {passes} passes, only {most}")));
        }
        match (&mut self.weights, &other.weights) {
            (Some(own), Some(other)) => own.merge(other),
            (None, None) => {}
            _ => return Err(Error::new("a film with weights cannot be merged with one without")),
        }
        match (&mut self.bias, &other.bias) {
            (Some(own), Some(other)) => own.merge(other),
            (None, None) => {}
            // What some passes do not tell cannot be known of all.
            _ => self.bias = None,
        }
        self.sums.merge(&other.sums);
        self.squares.merge(&other.squares);
        self.layers.merge(&other.layers);
        if let (Some(own), Some(other)) = (&mut self.bins, &other.bins) {
            own.merge(other);
        }
        self.passes = passes;
        self.samples = self.samples.saturating_add(other.samples);
        Ok(())
    }

    /// What sums it has.
    pub(crate) fn shape(&self) -> FilmShape {
        FilmShape {
            size: [self.width, self.height],
            passes: self.passes,
            samples: self.samples,
            has_weights: self.weights.is_some(),
            has_bias: self.bias.is_some(),
            layers: self.layers().iter().map(|layer| layer.name().to_string()).collect(),
            has_features: self.layers.has_any(),
            time: self.clock().cloned(),
            capture: self.capture.clone(),
        }
    }

    /// Writes all of them.
    pub(crate) fn write_sums(&self, to: &mut dyn Write) -> io::Result<()> {
        let weights = self.weights.iter().flat_map(|weights| [&weights.sums, &weights.squares, &weights.products]);
        let sums = [&self.sums, &self.squares].into_iter().chain(weights);
        let bias = self.bias.iter().flat_map(BiasSums::sums);
        let bins = self.bins.iter().flat_map(BinSums::sums);
        sums.chain(bias).chain(self.layers.sums()).chain(bins).try_for_each(|sums| sums.write(to))
    }

    /// Makes all of them, of a film of the same shape, what [`Film::write_sums`] wrote.
    ///
    /// # Errors
    /// If they are not as many, or none that values can make.
    pub(crate) fn read_sums(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let weights = self.weights.iter_mut();
        let weights = weights.flat_map(|weights| [&mut weights.sums, &mut weights.squares, &mut weights.products]);
        let sums = [&mut self.sums, &mut self.squares].into_iter().chain(weights);
        let bias = self.bias.iter_mut().flat_map(BiasSums::sums_mut);
        let bins = self.bins.iter_mut().flat_map(BinSums::sums_mut);
        sums.chain(bias).chain(self.layers.sums_mut()).chain(bins).try_for_each(|sums| sums.read(from))
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The layers that are kept beside the picture.
    pub fn layers(&self) -> Layers {
        self.layers.layers()
    }

    /// The time bins that are kept beside the picture, if there are any.
    pub fn clock(&self) -> Option<&Clock> {
        self.bins.as_ref().map(BinSums::clock)
    }

    /// How the wall is captured that it shows by time, if it is one.
    pub fn capture(&self) -> Option<&Capture> {
        self.capture.as_ref()
    }

    /// The mean over the passes of what arrived at a pixel, counted row by row, within each time bin: linear radiance, of
    /// which the picture is the sum over all time. Empty without time.
    pub fn bins(&self, pixel: usize) -> Vec<[f32; 3]> {
        self.bins_from(pixel, 0)
    }

    /// [`Film::bins`] of a layer, or of all light if none is named.
    ///
    /// # Errors
    /// A film without time bins or without this layer in time.
    pub fn bins_of(&self, pixel: usize, layer: Option<TimeLayer>) -> Result<Vec<[f32; 3]>> {
        Ok(self.bins_from(pixel, first_slot(self.clock_of_bins()?, layer)?))
    }

    fn bins_from(&self, pixel: usize, first: usize) -> Vec<[f32; 3]> {
        let Some(bins) = &self.bins else { return Vec::new() };
        let (weight, slots) = (self.weight(pixel), first + 1..=first + bins.clock().bins());
        slots.map(|slot| bins.sum(pixel, slot).map(|sum| (sum / weight) as f32)).collect()
    }

    fn clock_of_bins(&self) -> Result<&Clock> {
        let clock = self.clock().filter(|clock| !clock.is_dense());
        clock.ok_or_else(|| Error::new("the film has no time bins"))
    }

    /// [`Film::bins`] of all pixels; of a layer, or of all light if none is named. It is a copy in memory.
    ///
    /// # Errors
    /// A film without time or without this layer in time, or bins that are too many.
    pub fn transient(&self, layer: Option<TimeLayer>) -> Result<Transient> {
        let clock = self.clock_of_bins()?;
        let mut transient = Transient::new(self.width, self.height, clock.bins(), clock.timing())?;
        for (pixel, profile) in transient.profiles_mut().enumerate() {
            profile.copy_from_slice(&self.bins_of(pixel, layer)?);
        }
        match self.capture() {
            Some(capture) => transient.with_capture(capture.clone()),
            None => Ok(transient),
        }
    }

    /// The mean over the passes of the complex amplitudes of a pixel, real and imaginary part of each frequency: linear
    /// radiance times exp(-2πi f (s - start)). Of a layer, or of all light if none is named.
    ///
    /// # Errors
    /// A film without amplitudes or without this layer in time.
    pub fn amplitudes(&self, pixel: usize, layer: Option<TimeLayer>) -> Result<Vec<[[f32; 3]; 2]>> {
        let none = || Error::new("the film has no amplitudes");
        let bins = self.bins.as_ref().filter(|bins| bins.clock().is_dense()).ok_or_else(none)?;
        let (first, weight) = (first_slot(bins.clock(), layer)?, self.weight(pixel));
        let part = |slot: usize| bins.sum(pixel, first + slot).map(|sum| (sum / weight) as f32);
        Ok((0..bins.clock().frequencies().len()).map(|place| [part(2 * place), part(2 * place + 1)]).collect())
    }

    /// The luminance of [`Film::amplitudes`] of all pixels.
    ///
    /// # Errors
    /// As there.
    pub fn phasors(&self, layer: Option<TimeLayer>) -> Result<Phasors> {
        let mut values = Vec::new();
        for pixel in 0..self.width * self.height {
            values.extend(self.amplitudes(pixel, layer)?.into_iter().flatten().map(luminance));
        }
        let (frequencies, start) = self.clock().map(|clock| (clock.frequencies(), clock.start())).unwrap_or_default();
        Ok(Phasors { width: self.width, height: self.height, frequencies, start, values })
    }

    /// The mean over the passes of what arrived at a pixel before the first time bin, and after the last. None without
    /// time.
    pub fn outside_bins(&self, pixel: usize) -> Option<[[f32; 3]; 2]> {
        let (bins, weight) = (self.bins.as_ref().filter(|bins| !bins.clock().is_dense())?, self.weight(pixel));
        Some([0, bins.clock().bins() + 1].map(|slot| bins.sum(pixel, slot).map(|sum| (sum / weight) as f32)))
    }

    /// The variance of the luminance of [`Film::bins`], as the differences between passes tell it; what the weights of the
    /// passes do to it is left out, so that it may be too large where samples are spread. None before the second pass, or
    /// where it is not kept.
    pub fn variance_of_bins(&self, pixel: usize) -> Option<Vec<f32>> {
        let (bins, weight, n) = (self.bins.as_ref()?, self.weight(pixel), f64::from(self.passes));
        if self.passes < 2 {
            return None;
        }
        let variance = |slot: usize| {
            let sum = luminance_of(bins.sum(pixel, slot).map(|sum| sum as f32));
            let squares = (bins.square(pixel, slot)? - sum * sum / n).max(0.0);
            Some((squares * n / (weight * weight * (n - 1.0))) as f32)
        };
        (1..=bins.clock().bins()).map(variance).collect()
    }

    /// The shares of all light that arrived before the first time bin, and after the last. None without time or light.
    pub fn share_outside_bins(&self) -> Option<[f64; 2]> {
        let mut sums = [0.0; 2];
        for pixel in 0..self.width * self.height {
            let outside = self.outside_bins(pixel)?;
            sums.iter_mut().zip(outside).for_each(|(sum, light)| *sum += luminance_of(light));
        }
        let all = self.means().0 * (self.width * self.height) as f64;
        (all > 0.0).then(|| sums.map(|sum| sum / all))
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

    /// How many passes were added.
    pub fn passes(&self) -> u32 {
        self.passes
    }

    /// The mean over the passes: linear radiance.
    pub fn image(&self) -> Image {
        let pixels = (0..self.width * self.height).map(|pixel| self.mean(pixel)).collect();
        Image::from_pixels(self.width, self.height, pixels).unwrap_or_else(|| Image::new(self.width, self.height))
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
    fn weight(&self, pixel: usize) -> f64 {
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

    /// The standard error of the picture's luminance, as the root of the mean over pixels of its square, relative to
    /// the mean luminance (theory §6); from the differences between passes, so none before the second. It does not know
    /// of bias.
    pub fn relative_error(&self) -> Option<f64> {
        if self.passes < 2 {
            return None;
        }
        let (mean, variance) = self.means();
        (mean > 0.0).then(|| variance.sqrt() / mean)
    }

    /// The bias of the picture's luminance, relative to the mean luminance, of passes with [a known area](Exposure::area);
    /// none before some sixteen passes.
    pub fn bias(&self) -> Option<Bias> {
        let sums = self.bias.as_ref()?;
        let (mean, _) = self.means();
        sums.estimate(mean)
    }

    /// The means over the picture of luminance, and of its variance, which takes two passes.
    fn means(&self) -> (f64, f64) {
        let add = |(mean, variance): (f64, f64), (more, of_more): (f64, f64)| (mean + more, variance + of_more);
        let pixels = self.width * self.height;
        let chunks: Vec<(f64, f64)> = (0..pixels.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| (chunk * CHUNK..pixels.min((chunk + 1) * CHUNK)).map(|pixel| self.luminance(pixel)))
            .map(|chunk| chunk.fold((0.0, 0.0), add))
            .collect();
        let (mean, variance) = chunks.into_iter().fold((0.0, 0.0), add);
        let pixels = pixels as f64;
        (mean / pixels, variance / pixels)
    }
}

fn first_slot(clock: &Clock, layer: Option<TimeLayer>) -> Result<usize> {
    clock.first_slot(layer).ok_or_else(|| {
        let layer = layer.map(|layer| layer.to_string()).unwrap_or_default();
        Error::new(format!("the film has no layer '{layer}' in time"))
    })
}

/// Pixels of which sums are taken together, so that their order does not depend on the threads.
const CHUNK: usize = 1 << 12;

fn luminance_of(pixel: [f32; 3]) -> f64 {
    f64::from(luminance(pixel))
}

impl FilmShape {
    fn layers(&self) -> Option<Layers> {
        self.layers.iter().try_fold(Layers::NONE, |layers, name| {
            Some(layers.with(Layer::ALL.into_iter().find(|layer| layer.name() == name)?))
        })
    }

    /// How many passes the film holds.
    pub(crate) fn passes(&self) -> u32 {
        self.passes
    }

    /// A film of this shape, all of whose sums are 0; none that could not be.
    ///
    /// # Errors
    /// Files for which there is no room.
    pub(crate) fn empty(&self, storage: &Storage) -> Result<Option<Film>> {
        let Some(layers) = self.layers().filter(|_| self.passes <= Film::MOST_PASSES && self.bytes().is_some()) else {
            return Ok(None);
        };
        let (size, pixels) = (self.size, self.size[0] * self.size[1]);
        if self.capture.as_ref().is_some_and(|capture| capture.check(size[0], size[1]).is_err()) {
            return Ok(None);
        }
        let bins = self.time.clone().map(|clock| BinSums::new(clock, pixels, storage)).transpose()?;
        Ok(Some(Film {
            width: size[0],
            height: size[1],
            passes: self.passes,
            samples: self.samples,
            sums: ExactSums::new(3 * pixels),
            squares: ExactSums::new(pixels),
            weights: self.has_weights.then(|| Weights::new(pixels)),
            bias: self.has_bias.then(|| BiasSums::new(size)),
            layers: LayerSums::new(layers, pixels).with_any(self.has_features),
            bins,
            capture: self.capture.clone(),
        }))
    }

    /// Leaves the time bins out, whose sums are the last, with what is to be known of them.
    pub(crate) fn drop_time(&mut self) {
        (self.time, self.capture) = (None, None);
    }

    /// Bytes that the time bins take, in memory or in a file.
    pub(crate) fn bytes_of_bins(&self) -> usize {
        let of_bins = |clock: &Clock| BinSums::count(clock, self.size[0].checked_mul(self.size[1])?);
        self.time
            .as_ref()
            .map_or(0, |clock| of_bins(clock).map_or(usize::MAX, |sums| sums.saturating_mul(ExactSums::BYTES)))
    }

    /// Bytes that the sums take in a file; none of a film that could not be.
    pub(crate) fn bytes(&self) -> Option<usize> {
        // Without pixels, no sum would bear witness to how many layers there are.
        let pixels = self.size[0].checked_mul(self.size[1]).filter(|&pixels| pixels > 0)?;
        let each = 4 + if self.has_weights { 3 } else { 0 } + LayerSums::channels(self.layers()?);
        let of_pixels = pixels.checked_mul(each * ExactSums::BYTES)?;
        // There are fewer blocks than pixels.
        let of_bias = if self.has_bias { BiasSums::count(self.size).checked_mul(ExactSums::BYTES)? } else { 0 };
        let of_bins = match &self.time {
            Some(clock) => BinSums::count(clock, pixels)?.checked_mul(ExactSums::BYTES)?,
            None => 0,
        };
        of_pixels.checked_add(of_bias)?.checked_add(of_bins)
    }
}

impl Weights {
    fn new(pixels: usize) -> Weights {
        let sums = ExactSums::new(pixels);
        Weights { sums: sums.clone(), squares: sums.clone(), products: sums }
    }

    fn merge(&mut self, other: &Weights) {
        self.sums.merge(&other.sums);
        self.squares.merge(&other.squares);
        self.products.merge(&other.products);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
