//! The time bins of a film: which of them light belongs to, by the optical length of its path; or what it adds to complex
//! amplitudes, which a film can have in place of bins.

use serde::{Deserialize, Serialize};

use crate::scene::description::{FilmDescription, TimeDescription};
use crate::spectrum::Spectrum;
use crate::transient::{IndexMode, Met, TimeLayer, TimeLayers, Timing, Unwarp, phase};

/// What a film keeps of every pixel by time, in slots: bins of one width, with one more slot before and one after them for
/// what falls outside; or amplitudes, with a slot for the real and one for the imaginary part of each. For all light, and once
/// more for each layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    /// Optical path length in scene units.
    #[serde(with = "bits")]
    start: f64,
    kept: Kept,
    unwarp: Unwarp,
    index: IndexMode,
    has_variance: bool,
    layers: TimeLayers,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Kept {
    Bins {
        count: u32,
        /// As an optical path length in scene units.
        #[serde(with = "bits")]
        width: f64,
    },
    /// Of frequencies in cycles per scene unit, at least one.
    Amplitudes(Vec<Frequency>),
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
struct Frequency(#[serde(with = "bits")] f64);

impl Clock {
    /// That of a film whose first bin and whose width are given, or whose frequencies are; none of a film without time, or if
    /// they are not.
    pub fn of(film: &FilmDescription) -> Option<Clock> {
        let time = film.time.as_ref()?;
        let kept = if time.keeps_amplitudes() {
            Kept::Amplitudes(time.amplitudes().ok()?.into_iter().map(Frequency).collect())
        } else {
            Kept::Bins { count: time.bins, width: time.bin_width()? }
        };
        let TimeDescription { unwarp, index, variance, .. } = *time;
        Some(Clock { start: time.start()?, kept, unwarp, index, has_variance: variance, layers: time.layers() })
    }

    /// How many bins there are; none where amplitudes are kept.
    pub fn bins(&self) -> usize {
        match self.kept {
            Kept::Bins { count, .. } => count as usize,
            Kept::Amplitudes(_) => 0,
        }
    }

    /// The frequencies of the amplitudes, in cycles per scene unit; none where bins are kept.
    pub fn frequencies(&self) -> Vec<f64> {
        match &self.kept {
            Kept::Bins { .. } => Vec::new(),
            Kept::Amplitudes(frequencies) => frequencies.iter().map(|frequency| frequency.0).collect(),
        }
    }

    /// Whether light adds to every slot, and not to one.
    pub(super) fn is_dense(&self) -> bool {
        matches!(self.kept, Kept::Amplitudes(_))
    }

    /// Where the first bin begins, or where phases are 0, as an optical path length in scene units.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// The width of a bin, as an optical path length in scene units; 0 where amplitudes are kept.
    pub fn bin_width(&self) -> f64 {
        match self.kept {
            Kept::Bins { width, .. } => width,
            Kept::Amplitudes(_) => 0.0,
        }
    }

    /// What the bins mean, of a scene in metres.
    pub fn timing(&self) -> Timing {
        Timing { unwarp: self.unwarp, index: self.index, ..Timing::new(self.start, self.bin_width()) }
    }

    /// What of the way does not count.
    pub fn unwarp(&self) -> Unwarp {
        self.unwarp
    }

    /// Which index makes lengths optical.
    pub fn index(&self) -> IndexMode {
        self.index
    }

    /// Whether the variance of the bins is kept.
    pub(super) fn has_variance(&self) -> bool {
        self.has_variance
    }

    /// The parts of the light that have bins of their own.
    pub fn layers(&self) -> &TimeLayers {
        &self.layers
    }

    /// Slots of a pixel, for all light and for each layer. None of more than can be.
    pub(super) fn slots(&self) -> Option<usize> {
        self.slots_each().checked_mul(self.layers.count().checked_add(1)?).filter(|&slots| u32::try_from(slots).is_ok())
    }

    /// Most bytes that light in all slots of a pixel takes while a pass has it in hand.
    pub(crate) fn most_bytes(&self) -> usize {
        self.slots().unwrap_or(usize::MAX).saturating_mul(size_of::<(u32, Spectrum)>())
    }

    /// The number of the first slot of a layer, if it is kept; of all light, if none is named.
    pub(super) fn first_slot(&self, layer: Option<TimeLayer>) -> Option<usize> {
        match layer {
            None => Some(0),
            Some(layer) => Some((self.layers.iter().position(|own| own == layer)? + 1) * self.slots_each()),
        }
    }

    fn slots_each(&self) -> usize {
        match &self.kept {
            Kept::Bins { count, .. } => (*count as usize).saturating_add(2),
            Kept::Amplitudes(frequencies) => frequencies.len().saturating_mul(2),
        }
    }

    /// Tells which slots light belongs to that has met this on a path of this optical length, and how much of it: those of all
    /// light, and of layers.
    #[inline]
    pub fn note(&self, optical_length: f64, met: Met, mut tell: impl FnMut(u32, f32)) {
        let each = self.slots_each();
        let parts =
            || [0].into_iter().chain(self.layers.of(met).map(|layer| layer + 1)).map(|part| (part * each) as u32);
        match &self.kept {
            &Kept::Bins { count, width } => {
                let slot = slot(count, (optical_length - self.start) / width);
                parts().for_each(|first| tell(first + slot, 1.0));
            }
            // What never arrives has no phase.
            Kept::Amplitudes(_) if !optical_length.is_finite() => {}
            Kept::Amplitudes(frequencies) => {
                for (place, frequency) in (0..).step_by(2).zip(frequencies) {
                    let [real, imaginary] = phase(frequency.0, optical_length - self.start).map(|part| part as f32);
                    for first in parts() {
                        tell(first + place, real);
                        tell(first + place + 1, imaginary);
                    }
                }
            }
        }
    }
}

/// The slot of light at this place, in bins from the start: 0 before the first bin, then the bins from 1, then one more. A bin
/// has its beginning, and not its end.
#[inline]
fn slot(bins: u32, place: f64) -> u32 {
    if place < 0.0 {
        0
    } else if place < f64::from(bins) {
        place as u32 + 1
    } else {
        // What is infinitely late, and what is no number.
        bins + 1
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
        let kept = Kept::Bins { count: bins, width: bin_width };
        Clock { start, kept, unwarp: Unwarp::None, index: IndexMode::Phase, has_variance: false, layers }
    }

    /// The slots of light on a surface, with what they get.
    fn noted(clock: &Clock, optical_length: f64, events: u32) -> Vec<(u32, f32)> {
        let mut noted = Vec::new();
        clock.note(optical_length, Met::surfaces(events), |slot, share| noted.push((slot, share)));
        noted
    }

    /// The only slot.
    fn slot_at(clock: &Clock, optical_length: f64) -> u32 {
        noted(clock, optical_length, 1)[0].0
    }

    #[test]
    fn layers_have_slots_of_their_own() {
        let layers = TimeLayers::new(&[LightKind::Direct, LightKind::Indirect], Some(1));
        let clock = Clock { layers, ..clock(4, 1.0, 0.5) };
        assert_eq!(clock.slots(), Some(6 * 6));
        let slots = |events| noted(&clock, 1.6, events).into_iter().map(|(slot, _)| slot).collect::<Vec<_>>();
        assert_eq!([slots(0), slots(1), slots(2)], [vec![2, 20], vec![2, 8, 26], vec![2, 14, 32]]);
        let first = |layer| clock.first_slot(Some(layer));
        assert_eq!(first(TimeLayer::MoreBounces), Some(30));
        assert_eq!([first(TimeLayer::Kind(LightKind::Volume)), first(TimeLayer::Bounces(2))], [None, None]);
    }

    #[test]
    fn bins_have_their_beginning_and_what_is_outside_has_slots_of_its_own() {
        let clock = clock(4, 1.0, 0.5);
        let slots =
            [0.0, 0.99, 1.0, 1.49, 1.5, 2.99, 3.0, 1e300, f64::INFINITY, f64::NAN].map(|at| slot_at(&clock, at));
        assert_eq!(slots, [0, 0, 1, 1, 2, 4, 5, 5, 5, 5]);
    }

    #[test]
    fn halves_of_bins_are_halves() {
        let (whole, halves) = (clock(7, 0.3, 0.07), clock(14, 0.3, 0.035));
        for step in 0..10_000 {
            let at = 0.25 + 1e-4 * f64::from(step);
            let half = slot_at(&halves, at);
            assert_eq!(slot_at(&whole, at), half.div_ceil(2), "{at}");
        }
    }

    #[test]
    fn amplitudes_have_two_slots_for_each_frequency() {
        let kept = Kept::Amplitudes(vec![Frequency(0.0), Frequency(0.25)]);
        let clock = Clock { kept, layers: TimeLayers::new(&[LightKind::Direct], None), ..clock(1, 1.0, 1.0) };
        // A quarter of a turn back.
        let found = noted(&clock, 2.0, 1);
        let expected = [(0, 1.0), (1, 0.0), (4, 1.0), (5, 0.0), (2, 0.0), (3, -1.0), (6, 0.0), (7, -1.0)];
        assert!(found.iter().zip(expected).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-6), "{found:?}");
        assert_eq!((clock.slots(), noted(&clock, f64::INFINITY, 1)), (Some(8), Vec::new()));
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
