//! What a film has in its time bins.

use super::exact::ExactSums;
use super::{Arrival, Clock, luminance_of};

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
    pub(super) fn new(clock: Clock, pixels: usize) -> BinSums {
        let slots = clock.slots().unwrap_or(usize::MAX);
        let squares = clock.has_variance().then(|| ExactSums::new(slots * pixels));
        BinSums { clock, slots, light: ExactSums::new(3 * slots * pixels), squares }
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

    /// With sums from `read`, which is asked for so many at a time in the same order.
    pub(super) fn read(
        clock: Clock,
        pixels: usize,
        mut read: impl FnMut(usize) -> Option<ExactSums>,
    ) -> Option<BinSums> {
        let slots = clock.slots()?;
        let light = read(3 * slots * pixels)?;
        let squares = if clock.has_variance() { Some(read(slots * pixels)?) } else { None };
        Some(BinSums { clock, slots, light, squares })
    }

    /// Adds those of a pass, in the order of pixels and slots.
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
