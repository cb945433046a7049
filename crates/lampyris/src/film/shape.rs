//! What sums a film has, and their way to files and back.

use std::io::{self, Read, Write};

use serde::{Deserialize, Serialize};

use super::bias::BiasSums;
use super::bins::BinSums;
use super::exact::ExactSums;
use super::layers::LayerSums;
use super::{Clock, Film, Layer, Layers, Storage, Weights};
use crate::error::Result;
use crate::transient::Capture;

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

impl Film {
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
