//! The time bins of a film: which of them light belongs to, by the optical length of its path.

use serde::{Deserialize, Serialize};

use crate::scene::description::{FilmDescription, TimeDescription};
use crate::transient::{Met, TimeLayer, TimeLayers, Unwarp};

/// The bins of every pixel, all of one width, and one more slot before and one after them for what falls outside; for all
/// light, and once more for each layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    bins: u32,
    /// Optical path lengths in scene units.
    #[serde(with = "bits")]
    start: f64,
    #[serde(with = "bits")]
    bin_width: f64,
    unwarp: Unwarp,
    has_variance: bool,
    layers: TimeLayers,
}

impl Clock {
    /// That of a film whose first bin and whose width are given; none of a film without time, or if they are not.
    pub fn of(film: &FilmDescription) -> Option<Clock> {
        let time = film.time.as_ref()?;
        let (start, bin_width) = (time.start()?, time.bin_width()?);
        let TimeDescription { bins, unwarp, variance, .. } = *time;
        Some(Clock { bins, start, bin_width, unwarp, has_variance: variance, layers: time.layers() })
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

    /// The parts of the light that have bins of their own.
    pub fn layers(&self) -> &TimeLayers {
        &self.layers
    }

    /// Slots of a pixel: what came before the first bin, the bins, what came after the last; and the same for each layer.
    /// None of more than can be.
    pub(super) fn slots(&self) -> Option<usize> {
        self.slots_each().checked_mul(self.layers.count().checked_add(1)?).filter(|&slots| u32::try_from(slots).is_ok())
    }

    /// The number of the first slot of a layer, if it is kept; of all light, if none is named.
    pub(super) fn first_slot(&self, layer: Option<TimeLayer>) -> Option<usize> {
        match layer {
            None => Some(0),
            Some(layer) => Some((self.layers.iter().position(|own| own == layer)? + 1) * self.slots_each()),
        }
    }

    fn slots_each(&self) -> usize {
        (self.bins as usize).saturating_add(2)
    }

    /// The slots of light that has met this on a path of this optical length: that of all light, and those of layers.
    #[inline]
    pub fn slots_of(&self, optical_length: f64, met: Met) -> impl Iterator<Item = u32> {
        let (slot, each) = (self.slot(optical_length), self.slots_each());
        [0].into_iter().chain(self.layers.of(met).map(|layer| layer + 1)).map(move |part| (part * each) as u32 + slot)
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
    use crate::transient::LightKind;

    fn clock(bins: u32, start: f64, bin_width: f64) -> Clock {
        let layers = TimeLayers::default();
        Clock { bins, start, bin_width, unwarp: Unwarp::None, has_variance: false, layers }
    }

    #[test]
    fn layers_have_slots_of_their_own() {
        let layers = TimeLayers::new(&[LightKind::Direct, LightKind::Indirect], Some(1));
        let clock = Clock { layers, ..clock(4, 1.0, 0.5) };
        assert_eq!(clock.slots(), Some(6 * 6));
        let slots = |events| clock.slots_of(1.6, Met::surfaces(events)).collect::<Vec<_>>();
        assert_eq!([slots(0), slots(1), slots(2)], [vec![2, 20], vec![2, 8, 26], vec![2, 14, 32]]);
        let first = |layer| clock.first_slot(Some(layer));
        assert_eq!(first(TimeLayer::MoreBounces), Some(30));
        assert_eq!([first(TimeLayer::Kind(LightKind::Volume)), first(TimeLayer::Bounces(2))], [None, None]);
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
