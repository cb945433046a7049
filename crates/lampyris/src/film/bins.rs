//! What a film has in its time bins.

use super::exact::ExactSums;
use super::{Arrival, Clock, Storage, luminance_of};
use crate::error::{Error, Result};

/// Sums over passes of what arrived in each slot of each pixel, the same to the last bit in any order of the passes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BinSums {
    clock: Clock,
    slots: usize,
    /// Three a slot, pixel by pixel.
    light: ExactSums,
    /// Σ luminance² of the passes, one a slot, if the variance is asked for.
    squares: Option<ExactSums>,
}

impl BinSums {
    /// Of nothing, for so many pixels.
    ///
    /// # Errors
    /// More of them than there can be, or than there is room for in files.
    pub(super) fn new(clock: Clock, pixels: usize, storage: &Storage) -> Result<BinSums> {
        let too_many = || Error::new("the film has more time bins than there can be").with_hint("keep fewer of them");
        let (slots, _) = clock.slots().zip(BinSums::count(&clock, pixels)).ok_or_else(too_many)?;
        let light = ExactSums::new_in(storage, 3 * slots * pixels)?;
        let squares = clock.has_variance().then(|| ExactSums::new_in(storage, slots * pixels)).transpose()?;
        Ok(BinSums { clock, slots, light, squares })
    }

    /// How many sums there are for so many pixels; none if they are too many to be.
    pub(super) fn count(clock: &Clock, pixels: usize) -> Option<usize> {
        let each = if clock.has_variance() { 4 } else { 3 };
        clock.slots()?.checked_mul(each)?.checked_mul(pixels)
    }

    pub(super) fn clock(&self) -> &Clock {
        &self.clock
    }

    /// In an order that depends on the clock alone.
    pub(super) fn sums(&self) -> impl Iterator<Item = &ExactSums> {
        [&self.light].into_iter().chain(&self.squares)
    }

    /// The same, to be changed.
    pub(super) fn sums_mut(&mut self) -> impl Iterator<Item = &mut ExactSums> {
        [&mut self.light].into_iter().chain(&mut self.squares)
    }

    /// Adds some of those of a pass, in the order of pixels and slots: all that it has of each of these pairs.
    pub(super) fn add(&mut self, arrivals: &[Arrival]) {
        let slots = self.slots;
        let at = |arrival: &Arrival| arrival.pixel as usize * slots + arrival.slot as usize;
        self.light.add_some(3, arrivals, at, |arrival, channel| f64::from(arrival.light[channel]));
        if let Some(squares) = &mut self.squares {
            squares.add_some(1, arrivals, at, |arrival, _| luminance_of(arrival.light).powi(2));
        }
    }

    pub(super) fn merge(&mut self, other: &BinSums) {
        self.light.merge(&other.light);
        if let (Some(own), Some(other)) = (&mut self.squares, &other.squares) {
            own.merge(other);
        }
    }

    /// The sum of what arrived in a slot of a pixel.
    pub(super) fn sum(&self, pixel: usize, slot: usize) -> [f64; 3] {
        let first = 3 * (pixel * self.slots + slot);
        [0, 1, 2].map(|channel| self.light.value(first + channel))
    }

    /// The sum of its squares, if it is known.
    pub(super) fn square(&self, pixel: usize, slot: usize) -> Option<f64> {
        Some(self.squares.as_ref()?.value(pixel * self.slots + slot))
    }
}
