//! What paths from the camera would do without photons, by which the pilot tells whether photons are worth their price
//! (theory §5.6).
//!
//! Light that such paths hardly ever find does not show where some thousand of them look. But photons have found it, and
//! their weights tell how often, and how brightly, a path would come to it by chance.

use rayon::prelude::*;

use super::Pass;
use super::blocks::light_path;
use super::glimpse::{BOUNDARIES, leaves_to_glimpses};
use super::guiding::{MOST, variance};
use super::look::Look;
use super::merge::Brought;
use super::path::CAMERA_ROULETTE_FROM;
use super::reuse::Group;
use crate::film::Plain;
use crate::material::{Event, Lobes, Scattered};
use crate::sampler::Sampler;
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transport::{Limits, Origin, PathState, Visitor, walk};

/// What paths without photons do for the camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alone {
    /// Relative variance of a pixel's light.
    pub variance: f32,
    /// Rays of a path.
    pub rays: f32,
}

/// So many times less variance is left of light that paths lend each other; measured.
const LENT: f64 = 6.0;

/// To lend takes so many rays' time of a path; measured.
const LENDING: f32 = 1.5;

/// How a path from the camera begins: its first ray, and the numbers that it has.
pub(super) type Beginning = (PathState, Sampler);

/// What the photons of a pass brought to a place that the camera sees.
#[derive(Debug)]
pub(super) struct Place {
    /// Two paths that looked there.
    pub begins: [Beginning; 2],
    /// One over the light there.
    pub unit: f32,
    /// To both paths.
    pub brought: Vec<Brought>,
}

/// Looks at the same places without photons.
pub(super) fn alone(scene: &Scene, pass: &Pass, max_bounces: u32, reuse: bool, places: &[Place]) -> Alone {
    let limits = Limits { max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
    let see = |(path, sampler): &Beginning| {
        let (mut group, mut sampler) = (Group::new(&Plain::default(), 1), sampler.clone());
        let (sink, lending) = group.next();
        let mut look = Look::alone(scene, max_bounces, sink).lending(reuse.then_some(lending));
        let rays = walk(scene, *path, Origin::Camera, &limits, &mut sampler, &mut look).rays;
        (group.kept_and_lent().map(Spectrum::mean), rays)
    };
    let look = |place: &Place| {
        let [([a, lent_a], rays), ([b, lent_b], more)] = [see(&place.begins[0]), see(&place.begins[1])];
        (variance([a, b], place.unit) + variance([lent_a, lent_b], place.unit) / LENT, rays + more)
    };
    let seen: Vec<(f64, u32)> = places.par_iter().map(look).collect();
    let number = places.len() as f64;
    let variance = seen.iter().map(|(variance, _)| variance).sum::<f64>() / number;
    let rays = seen.iter().map(|&(_, rays)| f64::from(rays)).sum::<f64>() / (2.0 * number);
    let rare = rare(scene, pass, max_bounces, reuse, places) / (2.0 * number);
    let rays = rays as f32 + if reuse { LENDING } else { 0.0 };
    Alone { variance: (variance + rare) as f32, rays }
}

/// Light that a path would have come to by chance, in the unit of its place.
struct Rare {
    path: u32,
    bounce: u16,
    /// What photons brought of it.
    brought: f32,
    by_chance: f32,
}

/// The second moment, over all places, of light that is so bright and rare that [`variance`] is cut where it is seen.
pub(super) fn rare(scene: &Scene, pass: &Pass, max_bounces: u32, reuse: bool, places: &[Place]) -> f64 {
    let bright = (2.0 * MOST).sqrt();
    let of_place = |place: &Place| {
        let unit = place.unit;
        let rare = |&Brought { path, bounce, light, by_chance }: &Brought| {
            let rare = Rare { path, bounce, brought: light * unit, by_chance: by_chance * unit };
            (rare.brought > 0.0 && rare.by_chance > bright).then_some(rare)
        };
        place.brought.iter().filter_map(rare).collect::<Vec<_>>()
    };
    let mut all: Vec<Rare> = places.iter().flat_map(of_place).collect();
    all.par_sort_by_key(|rare| rare.path);
    let of_path = |lights: &[Rare]| {
        let mut choices = Choices::new(scene);
        light_path(scene, pass, lights[0].path.into(), max_bounces, &mut choices);
        let excess = |rare: &Rare| {
            let before = choices.before.get(usize::from(rare.bounce));
            let Before { probability, is_smooth } =
                before.copied().unwrap_or(Before { probability: 1.0, is_smooth: false });
            let by_chance = rare.by_chance * probability;
            // As many times as bright, and as much rarer; less what is seen of it.
            let excess = f64::from(rare.brought * (by_chance - bright * bright / by_chance).max(0.0));
            if reuse && is_smooth { excess / LENT } else { excess }
        };
        lights.iter().map(excess).sum::<f64>()
    };
    let paths: Vec<&[Rare]> = all.chunk_by(|a, b| a.path == b.path).collect();
    let sums: Vec<f64> = paths.into_par_iter().map(of_path).collect();
    sums.into_iter().sum()
}

/// Follows a light path again, and asks at each vertex which choices before it glimpses would have made needless on the way
/// back from there to the lamp.
struct Choices<'s> {
    scene: &'s Scene,
    /// By the number of events.
    before: Vec<Before>,
    now: Before,
    /// Through so many boundaries more a glimpse would go on.
    boundaries: u32,
}

/// What came before a vertex.
#[derive(Clone, Copy, Debug)]
struct Before {
    /// Of the choices that glimpses would have made needless.
    probability: f32,
    /// Whether the last event was: light from there is lent.
    is_smooth: bool,
}

impl<'s> Choices<'s> {
    fn new(scene: &'s Scene) -> Choices<'s> {
        let now = Before { probability: 1.0, is_smooth: false };
        Choices { scene, before: Vec::new(), now, boundaries: BOUNDARIES + 1 }
    }
}

impl Visitor for Choices<'_> {
    fn vertex(&mut self, _: &SurfacePoint, path: &PathState, _: &mut Sampler) -> Lobes {
        self.before.resize(path.bounce as usize + 1, self.now);
        Lobes::ALL
    }

    fn scattered(&mut self, scattered: &Scattered, point: &SurfacePoint, _: &PathState) {
        self.now.is_smooth = Lobes::SMOOTH.contains(scattered.event);
        if self.now.is_smooth {
            // Beyond, it is no lamp that shines.
            (self.now.probability, self.boundaries) = (1.0, 0);
        } else if self.boundaries > 0 && leaves_to_glimpses(self.scene, point) {
            self.now.probability *= scattered.pdf;
            let goes_on = scattered.event == Event::Refraction && point.is_clear();
            self.boundaries = if goes_on { self.boundaries - 1 } else { 0 };
        }
    }
}
