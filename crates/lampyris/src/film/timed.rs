//! The sink that notes when light arrives.

use super::{Clock, Features, Layered, Sink};
use crate::scene::SurfacePoint;
use crate::spectrum::{Basis, Spectrum};
use crate::transient::{Met, Unwarp};
use crate::transport::PathState;

/// All that [`Layered`] has, and the light once more by the time at which it arrived.
#[derive(Clone, Debug)]
pub struct Timed<'c> {
    layered: Layered,
    /// Whether it has features to tell.
    has_features: bool,
    clock: &'c Clock,
    way: Way,
    /// By slots: the first so many in their order, each once, and then some more.
    arrivals: Vec<(u32, Spectrum)>,
    settled: usize,
    /// Noted, but not yet added, with what it met, by optical length.
    noted: Vec<(f64, Met, Spectrum)>,
    /// Whether its light is only there for others: no time is known before these have it.
    is_apart: bool,
}

impl Timed<'_> {
    /// Without light; with features if layers are asked for.
    pub fn new(clock: &Clock, has_features: bool) -> Timed<'_> {
        Timed {
            layered: Layered::default(),
            has_features,
            clock,
            way: Way::default(),
            arrivals: Vec::new(),
            settled: 0,
            noted: Vec::new(),
            is_apart: false,
        }
    }

    /// Notes what is added, until others borrow it or at once.
    fn keep(&mut self, light: Spectrum, met: Met, optical_length: f64) {
        if self.is_apart {
            self.note(light, met, optical_length);
        } else {
            self.arrive(light, met, optical_length);
        }
    }

    fn arrive(&mut self, light: Spectrum, met: Met, optical_length: f64) {
        if light.is_zero() {
            return;
        }
        let clock = self.clock;
        let counted = self.way.counted(optical_length, clock.unwarp());
        clock.note(counted, met, |slot, share| self.push(slot, light * share));
    }

    fn push(&mut self, slot: u32, light: Spectrum) {
        if self.clock.is_dense() {
            if self.arrivals.is_empty() {
                let slots = 0..self.clock.slots().unwrap_or(0) as u32;
                self.arrivals.extend(slots.map(|slot| (slot, Spectrum::ZERO)));
                self.settled = self.arrivals.len();
            }
            self.arrivals[slot as usize].1 += light;
            return;
        }
        self.arrivals.push((slot, light));
        // As seldom as makes no more of them than twice what is needed.
        if self.arrivals.len() > 2 * self.settled + LEAST {
            self.tidy();
        }
    }

    /// Sums up what has the same slot, in the order in which it came.
    fn tidy(&mut self) {
        if self.settled == self.arrivals.len() {
            return;
        }
        self.arrivals.sort_by_key(|&(slot, _)| slot);
        self.arrivals.dedup_by(|next, sum| {
            let is_same = next.0 == sum.0;
            if is_same {
                sum.1 += next.1;
            }
            is_same
        });
        self.settled = self.arrivals.len();
    }
}

/// How much of the way of light to the camera counts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Way {
    /// Optical length of a sample's path from the camera to the first surface, or to the last hole on the way there; or to
    /// the particle before it from which the next light comes.
    first_leg: Option<f64>,
}

impl Way {
    /// The path of a sample has reached a surface.
    pub(crate) fn surface(&mut self, path: &PathState) {
        if path.bounce == 0 {
            self.first_leg = Some(path.optical_length);
        }
    }

    /// The path of a sample has met no surface, and light comes to it from a particle at this optical length.
    pub(crate) fn particle(&mut self, optical_length: f64) {
        self.first_leg = Some(optical_length);
    }

    /// What counts of a path of this optical length.
    pub(crate) fn counted(&self, optical_length: f64, unwarp: Unwarp) -> f64 {
        match unwarp {
            Unwarp::None => optical_length,
            // Of what comes from infinitely far away, and is met first, nothing does.
            Unwarp::FirstSurface | Unwarp::LastSegment => optical_length - self.first_leg.unwrap_or(optical_length),
        }
    }
}

/// Arrivals that are not worth the while.
const LEAST: usize = 64;

impl Sink for Timed<'_> {
    const LAYERED: bool = true;
    const TIMED: bool = true;

    fn clear(&mut self) {
        self.layered.clear();
        self.way = Way::default();
        self.arrivals.clear();
        self.settled = 0;
        self.noted.clear();
    }

    fn surface(&mut self, point: &SurfacePoint, path: &PathState) {
        self.layered.surface(point, path);
        self.way.surface(path);
    }

    fn particle(&mut self, optical_length: f64) {
        self.way.particle(optical_length);
    }

    fn add(&mut self, light: Spectrum, met: Met, optical_length: f64) {
        self.layered.add(light, met, optical_length);
        self.keep(light, met, optical_length);
    }

    fn note(&mut self, light: Spectrum, met: Met, optical_length: f64) {
        self.noted.push((optical_length, met, light));
    }

    fn add_noted(&mut self, light: Spectrum, events: u32, unit: Spectrum) {
        self.layered.add_noted(light, events, unit);
        let mut noted = std::mem::take(&mut self.noted);
        noted.drain(..).for_each(|(optical_length, met, light)| self.arrive(light * unit, met, optical_length));
        self.noted = noted;
    }

    fn apart(&self) -> Self {
        Timed { is_apart: true, ..self.clone() }
    }

    fn borrow(&mut self, other: &Self, share: Spectrum, longer: f64) {
        self.layered.borrow(&other.layered, share, longer);
        for &(optical_length, met, light) in &other.noted {
            self.keep(light * share, met, optical_length + longer);
        }
    }

    fn was_direct(&mut self, light: Spectrum) {
        self.layered.was_direct(light);
    }

    fn was_caustic(&mut self, light: Spectrum) {
        self.layered.was_caustic(light);
    }

    fn take(&mut self, other: &Self, share: f32) {
        self.layered.take(&other.layered, share);
        let arrivals = other.arrivals.iter().map(|&(slot, light)| (slot, light * share));
        if self.arrivals.is_empty() {
            self.arrivals.extend(arrivals);
            self.settled = self.arrivals.len();
        } else {
            arrivals.for_each(|(slot, light)| self.push(slot, light));
        }
    }

    fn radiance(&self) -> Spectrum {
        self.layered.radiance()
    }

    fn features(&self, samples: u32, basis: &Basis) -> Option<Features> {
        self.layered.features(samples, basis).filter(|_| self.has_features)
    }

    fn settle(&mut self) -> &[(u32, Spectrum)] {
        self.tidy();
        &self.arrivals
    }
}
