//! The time bins of a film: which of them light belongs to, by the optical length of its path.

use serde::{Deserialize, Serialize};

use crate::scene::description::{FilmDescription, TimeDescription};
use crate::transient::Unwarp;

/// The bins of every pixel, all of one width, and one more slot before and one after them for what falls outside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    bins: u32,
    /// Optical path lengths in scene units.
    #[serde(with = "bits")]
    start: f64,
    #[serde(with = "bits")]
    bin_width: f64,
    unwarp: Unwarp,
    has_variance: bool,
}

impl Clock {
    /// That of a film whose first bin and whose width are given; none of a film without time, or if they are not.
    pub fn of(film: &FilmDescription) -> Option<Clock> {
        let time = film.time.as_ref()?;
        let (start, bin_width) = (time.start()?, time.bin_width()?);
        let TimeDescription { bins, unwarp, variance, .. } = *time;
        Some(Clock { bins, start, bin_width, unwarp, has_variance: variance })
    }

    /// How many bins there are.
    pub fn bins(&self) -> usize {
        self.bins as usize
    }

    /// Where the first bin begins, as an optical path length in scene units.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// The width of a bin, as an optical path length in scene units.
    pub fn bin_width(&self) -> f64 {
        self.bin_width
    }

    /// What of the way does not count.
    pub fn unwarp(&self) -> Unwarp {
        self.unwarp
    }

    /// Whether the variance of the bins is kept.
    pub fn has_variance(&self) -> bool {
        self.has_variance
    }

    /// Slots of a pixel: what came before the first bin, the bins, what came after the last. None of more than can be.
    pub(super) fn slots(&self) -> Option<usize> {
        (self.bins as usize).checked_add(2)
    }

    /// The slot of light whose path has this optical length: 0 before the first bin, then the bins from 1, then one more.
    /// A bin has its beginning, and not its end.
    #[inline]
    pub fn slot(&self, optical_length: f64) -> u32 {
        let place = (optical_length - self.start) / self.bin_width;
        if place < 0.0 {
            0
        } else if place < f64::from(self.bins) {
            place as u32 + 1
        } else {
            // What is infinitely late, and what is no number.
            self.bins + 1
        }
    }
}

/// Doubles in JSON, where the last bit could be lost.
mod bits {
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(value.to_bits())
    }

    pub(super) fn deserialize<'d, D: Deserializer<'d>>(deserializer: D) -> Result<f64, D::Error> {
        u64::deserialize(deserializer).map(f64::from_bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clock(bins: u32, start: f64, bin_width: f64) -> Clock {
        Clock { bins, start, bin_width, unwarp: Unwarp::None, has_variance: false }
    }

    #[test]
    fn bins_have_their_beginning_and_what_is_outside_has_slots_of_its_own() {
        let clock = clock(4, 1.0, 0.5);
        let slots = [0.0, 0.99, 1.0, 1.49, 1.5, 2.99, 3.0, 1e300, f64::INFINITY, f64::NAN].map(|at| clock.slot(at));
        assert_eq!(slots, [0, 0, 1, 1, 2, 4, 5, 5, 5, 5]);
    }

    #[test]
    fn halves_of_bins_are_halves() {
        let (whole, halves) = (clock(7, 0.3, 0.07), clock(14, 0.3, 0.035));
        for step in 0..10_000 {
            let at = 0.25 + 1e-4 * f64::from(step);
            let half = halves.slot(at);
            assert_eq!(whole.slot(at), half.div_ceil(2), "{at}");
        }
    }

    #[test]
    fn it_is_known_only_with_its_range() {
        let film = |time| FilmDescription { time, ..FilmDescription::default() };
        assert_eq!(Clock::of(&film(None)), None);
        assert_eq!(Clock::of(&film(Some(TimeDescription::default()))), None);
        let seconds = TimeDescription { start_seconds: Some(1e-9), bin_width: Some(0.5), ..Default::default() };
        let start = Clock::of(&film(Some(seconds))).expect("a range").start();
        assert!((start - 0.299_792_458).abs() < 1e-15, "{start}");
    }
}
