//! The picture as it grows, pass by pass.

mod bias;
mod bins;
mod by_time;
mod clock;
mod estimates;
mod exact;
mod exposure;
mod filter;
mod layers;
mod passes;
mod shape;
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

pub(crate) use shape::FilmShape;
pub(crate) use spread::{Band, Sums};
pub(crate) use timed::Way;

use bias::BiasSums;
use bins::BinSums;
use exact::ExactSums;
use layers::LayerSums;

use crate::error::{Error, Result};
use crate::image::luminance;
use crate::transient::Capture;

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

    /// How many passes were added.
    pub fn passes(&self) -> u32 {
        self.passes
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

fn luminance_of(pixel: [f32; 3]) -> f64 {
    f64::from(luminance(pixel))
}
