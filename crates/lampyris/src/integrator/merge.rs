//! Paths from the camera that are merged with photons (theory §5.4).

use std::f32::consts::{FRAC_1_PI, PI};

use crate::film::Sink;
use crate::material::{Event, Lobes, Scattered};
use crate::photon::{Estimate, Kernel, Nearest, Photon, PhotonMap, Radius};
use crate::scene::SurfacePoint;
use crate::spectrum::Spectrum;
use crate::transient::Met;
use crate::transport::{PathState, Rivals, norm, squared};

/// How paths from the camera are merged with the photons of a pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Merging {
    /// Light paths of the pass.
    pub paths: u64,
    /// How far photons are looked for in the first pass: on the first smooth surface that a path meets, over the width of
    /// what the path stands for there.
    pub first: f32,
    /// And on all further ones, in scene units.
    pub further: f32,
    /// Where photons are denser than that, as in a caustic, the nearest of so many are enough.
    pub nearest: usize,
    /// What is left of these radii.
    pub shrunk: f32,
    /// The probability with which a path goes on after scattering smoothly on the first smooth surface.
    pub on_from_first: f32,
    /// And on all further ones.
    pub on_from_further: f32,
}

/// So much of their density photons count in the weights: their light is noisier than that of as many paths. The kernel alone makes
/// of the area where they are found three quarters, 1 / ∫ K² / (π r²), and paths from the camera are even; measured.
pub(super) const COUNTED: f32 = 0.5;

impl Merging {
    /// How many photons would lie within what has become of this radius, if each light path left one in each square unit:
    /// the density of merging a path with a photon, over that of the two halves, as far as it is [counted](COUNTED).
    pub(super) fn density(&self, radius: f32) -> f32 {
        COUNTED * PI * (self.shrunk * radius).powi(2) * self.paths as f32
    }
}

/// Photons that were found on first smooth surfaces, and on all further ones: each search begins where the one before it ended,
/// and these two have other radii.
pub(super) type Found = [Nearest; 2];

/// What a photon has brought to a path from the camera: means over all wavelengths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Brought {
    /// The number of its light path, and how many events that had had.
    pub path: u32,
    pub bounce: u16,
    pub light: f32,
    /// What a path without photons would bring if it came to this light; it would come as much more rarely.
    pub by_chance: f32,
}

impl Brought {
    /// Paths that merge meet no particles by chance.
    pub(super) fn in_a_medium(path: u32, light: f32) -> Brought {
        Brought { path, bounce: 0, light, by_chance: f32::INFINITY }
    }
}

/// A path from the camera that is merged with photons.
pub(super) struct Merge<'a> {
    map: &'a PhotonMap,
    merging: Merging,
    found: &'a mut Found,
    /// What photons have brought, for those who ask.
    pub(super) tally: Option<&'a mut Vec<Brought>>,
    /// What else could have made the path so far.
    pub(super) rivals: Rivals,
    /// The same without merging at the last smooth point, for lamps that shine on it directly.
    pub(super) rivals_of_lamps: Rivals,
    /// Whether the path has met mirrors and glass alone.
    first: bool,
    /// [`Merging::density`] at the last point.
    here: f32,
    /// The probability with which the path went on after its last event.
    pub(super) went_on: f32,
    /// And after all events so far.
    came: f32,
}

impl<'a> Merge<'a> {
    pub(super) fn new(map: &'a PhotonMap, merging: Merging, found: &'a mut Found) -> Merge<'a> {
        let nothing = Rivals::default();
        let (first, here, went_on, came) = (true, 0.0, 1.0, 1.0);
        Merge {
            map,
            merging,
            found,
            tally: None,
            rivals: nothing,
            rivals_of_lamps: nothing,
            first,
            here,
            went_on,
            came,
        }
    }

    /// The same, which writes down what each photon brings.
    pub(super) fn tallied(self, tally: &'a mut Vec<Brought>) -> Merge<'a> {
        Merge { tally: Some(tally), ..self }
    }

    /// The probability with which the path goes on after it has scattered smoothly here.
    pub(super) fn goes_on(&self) -> f32 {
        if self.first { self.merging.on_from_first } else { self.merging.on_from_further }
    }

    /// The path leaves a point. Returns the probability with which it does.
    pub(super) fn scattered(&mut self, scattered: &Scattered, point: &SurfacePoint, smooth: bool) -> f32 {
        let at = self.rivals.at(point);
        self.went_on = if smooth { self.goes_on() } else { 1.0 };
        self.came *= self.went_on;
        let back = if smooth && at > 0.0 { at * point.pdf_back(scattered.to_next, Lobes::ALL) } else { 0.0 };
        let after = |smooth| Rivals::after(at, smooth, self.went_on, point, scattered);
        (self.rivals, self.rivals_of_lamps) = (after(norm([back, self.here])), after(back));
        self.first &= !smooth;
        self.went_on
    }

    /// Radiance back along the path of the light of photons that have been scattered at most so often; the second set has
    /// that of those among them that came by mirrors and glass alone. What each photon brings is noted in the sink; the unit
    /// of that comes last.
    pub(super) fn radiance<const SETS: usize, S: Sink>(
        &mut self,
        point: &SurfacePoint,
        path: &PathState,
        max_bounces: u32,
        sink: &mut S,
    ) -> ([Spectrum; SETS], Spectrum) {
        let most = if self.first { self.merging.first * path.cone.width } else { self.merging.further };
        // Not by the radius that is found: weights must not depend on the photons that they weigh.
        self.here = self.merging.density(most);
        if !self.here.is_normal() {
            // Beyond all reason in size: nothing can be found so near, or told apart so far away.
            self.here = 0.0;
            return ([Spectrum::ZERO; SETS], Spectrum::ZERO);
        }
        let estimate = Estimate {
            map: self.map,
            kernel: Kernel::Epanechnikov,
            radius: Radius::Nearest { count: self.merging.nearest, max_radius: most },
        };
        let found = &mut self.found[usize::from(!self.first)];
        let radius = self.merging.shrunk * estimate.find(point, found);
        let (at, on, per_photon) = (self.rivals.at(point), self.goes_on(), 1.0 / self.here);
        let counts = |photon: &Photon| u32::from(photon.bounce) <= max_bounces;
        if point.is_lambertian() {
            // The same as below, for the most frequent case.
            let nearer = at * point.cos(point.to_previous) * (FRAC_1_PI * per_photon);
            let farther = on * FRAC_1_PI * per_photon;
            self.sum(&estimate, (point, path, radius), sink, counts, |photon| {
                [nearer, farther * photon.rivals * point.cos(photon.direction)]
            })
        } else {
            self.sum(&estimate, (point, path, radius), sink, counts, |photon| {
                let to_light = -photon.direction;
                let nearer = if at > 0.0 { at * point.pdf_back(to_light, Lobes::ALL) } else { 0.0 };
                let farther = on * photon.rivals * point.pdf(to_light, Lobes::ALL);
                [nearer * per_photon, farther * per_photon]
            })
        }
    }

    /// The light of the photons that were found within a radius and that count, in sets, and its unit in the sink. `rivals`
    /// tells of a photon how dense the other ways to make its path are over that of merging here: those that merge nearer to
    /// the eye, and those that go on from here.
    fn sum<const SETS: usize, S: Sink>(
        &mut self,
        estimate: &Estimate,
        (point, path, radius): (&SurfacePoint, &PathState, f32),
        sink: &mut S,
        counts: impl Fn(&Photon) -> bool,
        rivals: impl Fn(&Photon) -> [f32; 2],
    ) -> ([Spectrum; SETS], Spectrum) {
        let on = self.goes_on();
        let found = &mut self.found[usize::from(!self.first)];
        let sets = |photon: &Photon| {
            let weight = if counts(photon) { weight(rivals(photon)) } else { 0.0 };
            std::array::from_fn(|set| if set == 0 || photon.is_caustic() { weight } else { 0.0 })
        };
        let Some(tally) = &mut self.tally else {
            return estimate
                .weighted(point, radius, found, sets, |photon, light| note(sink, photon, light, point, path));
        };
        let mut light_of = Vec::new();
        let (sums, unit) = estimate.weighted(point, radius, found, sets, |photon, light| {
            let rivals = rivals(photon);
            light_of.push((photon.path, photon.bounce, light, weight(rivals) * rivals[1]));
        });
        let seen = unit * path.throughput;
        // Of merging as it is, where the mean square of the kernel is that of 3/4 of its disk, over what it counts in weights;
        // and a path without photons always comes here and goes on.
        let disk = 0.75 * PI * radius * radius;
        let density = disk * self.merging.paths as f32 / self.here * (self.came * on);
        tally.extend(light_of.into_iter().map(|(path, bounce, light, of_paths)| {
            let light = (light * seen).mean();
            Brought { path, bounce, light, by_chance: light * density / of_paths }
        }));
        (sums, unit)
    }
}

/// Notes the light of a photon that is read at `point`, where `path` from the camera has come, by its time.
#[inline]
pub(super) fn note<S: Sink>(sink: &mut S, photon: &Photon, light: Spectrum, point: &SurfacePoint, path: &PathState) {
    if S::TIMED {
        let slowness = path.slowness * point.slowness_toward(-photon.direction);
        let read = path.met(1 + u32::from(photon.bounce));
        let met = Met {
            is_caustic: photon.is_caustic() && !path.history.meets(Lobes::SMOOTH),
            particles: read.particles || photon.history.contains(Event::Scatter),
            ..read
        };
        sink.note(light, met, path.optical_length + photon.optical_length_at(point.surface.position, slowness));
    }
}

/// The weight of merging, where the densities of all other ways to make the path, over its own, are these.
#[inline]
fn weight([nearer, farther]: [f32; 2]) -> f32 {
    1.0 / (1.0 + squared(nearer) + squared(farther))
}
