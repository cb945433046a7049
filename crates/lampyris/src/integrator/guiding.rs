//! What the pilot learns about where photons should leave for (theory §5.5).
//!
//! It aims at what may cast caustics first. Then it reads the photons of a pass of its own as the camera would, and asks of
//! each how much of a pixel it brought: photons should leave in proportion to that.

use glam::{Vec2, Vec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::Pass;
use super::alone::{Beginning, Place};
use super::blocks::emitted;
use super::look::Look;
use super::merge::{Brought, Found, Merge, Merging};
use super::path::CAMERA_ROULETTE_FROM;
use super::photons::Maps;
use super::sharing::Sharing;
use crate::film::{Plain, Sink};
use crate::light::{Focus, Guide, Lesson, LightId};
use crate::material::Event;
use crate::sampler::{Sampler, purpose};
use crate::scene::Scene;
use crate::scene::description::{AutoSettings, FilmDescription};
use crate::texture::Lookup;
use crate::transport::{Limits, Origin, PathState, walk};

/// How often the pilot learns.
pub(super) const ROUNDS: u32 = 2;

/// Pairs of paths from the camera that judge photons, in groups.
const PAIRS: u64 = 4096;
const GROUP: u64 = 256;

/// At most so many ways for photons to leave are told apart, and so many foci.
const WAYS: usize = 64;
const FOCI: usize = 8;

/// A light of so little, over the mean of the picture, is not missed.
const DARK: f32 = 0.1;

/// Two paths that differ by more than this do not count more: they are too rare for their number to be known.
pub(super) const MOST: f32 = 2.0;

/// See the module.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Learned {
    foci: Vec<Focus>,
    even: f32,
    lessons: Vec<Lesson>,
}

impl Learned {
    /// Before the first lesson: half of the photons go towards what may cast caustics.
    pub(super) fn nothing(scene: &Scene) -> Learned {
        let foci = foci(scene);
        let mut lights: Vec<(LightId, f32)> = scene.aimed_lights().collect();
        lights.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        lights.truncate(WAYS / (1 + foci.len()));
        let lesson = |light, focus: Option<usize>, share| Lesson {
            share,
            cells: vec![1.0; Lesson::CELLS],
            ..Lesson::empty(light, focus.map(|focus| focus as u32))
        };
        let of_light = |&(light, power): &(LightId, f32)| {
            let share = power / foci.len() as f32;
            let towards = (0..foci.len()).map(move |focus| lesson(light, Some(focus), share));
            towards.chain([lesson(light, None, 0.5 * power)])
        };
        let lessons = lights.iter().flat_map(of_light).collect();
        Learned { foci, even: 0.5, lessons }
    }

    /// Whether it can have been learned of this scene.
    pub(super) fn is_fit(&self, scene: &Scene) -> bool {
        let amount = |number: f32| number.is_finite() && number >= 0.0;
        let focus = |focus: &Focus| focus.center.is_finite() && focus.radius.is_finite() && focus.radius > 0.0;
        let lesson = |lesson: &Lesson| {
            scene.aimed_lights().any(|(light, _)| light == lesson.light)
                && lesson.focus.is_none_or(|focus| (focus as usize) < self.foci.len())
                && lesson.cells.len() == Lesson::CELLS
                && [lesson.share].iter().chain(&lesson.cells).all(|&number| amount(number))
        };
        let shares: f32 = self.lessons.iter().map(|lesson| lesson.share).sum();
        self.foci.len() <= FOCI
            && self.lessons.len() <= WAYS
            && self.foci.iter().all(focus)
            && self.lessons.iter().all(lesson)
            && amount(self.even)
            && amount(shares)
            && self.even + shares > 0.0
    }

    /// The guide that follows.
    pub(super) fn guide(&self) -> Guide {
        Guide::new(&self.foci, self.even, &self.lessons)
    }

    /// What the photons of a pass that was guided so have to teach.
    pub(super) fn more(self, scene: &Scene, pass: &Pass, worth: &[Worth]) -> Learned {
        let guide = self.guide();
        let mut lessons: Vec<Lesson> =
            self.lessons.iter().map(|lesson| Lesson::empty(lesson.light, lesson.focus)).collect();
        let mut even = 0.0;
        for (path, worth) in (0..).zip(worth).filter(|(_, worth)| worth.brought > 0.0) {
            if let Some((light, emission, _)) = emitted(scene, pass, path) {
                let leaving = scene.leaving(light, emission.ray, emission.normal());
                even += guide.teach(&mut lessons, worth.brought, &leaving);
            }
        }
        if even + lessons.iter().map(|lesson| lesson.share).sum::<f32>() > 0.0 {
            Learned { even, lessons, ..self }
        } else {
            self
        }
    }

    /// How many times more photons, if they leave by the power of the lights, would be as good as those of a pass that was
    /// guided so.
    pub(super) fn gain(&self, scene: &Scene, pass: &Pass, worth: &[Worth]) -> f32 {
        let guide = self.guide();
        let (mut guided, mut even) = (0.0, 0.0);
        for (path, worth) in (0..).zip(worth).filter(|(_, worth)| worth.squares > 0.0) {
            if let Some((light, emission, _)) = emitted(scene, pass, path) {
                let factor = guide.factor(&scene.leaving(light, emission.ray, emission.normal()));
                // A photon would be so much rarer and bring so much more.
                guided += f64::from(worth.squares);
                even += f64::from(worth.squares) * f64::from(factor);
            }
        }
        if guided > 0.0 { (even / guided) as f32 } else { 1.0 }
    }
}

/// What one light path brings to paths from the camera, each time over all light of that path.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Worth {
    brought: f32,
    squares: f32,
}

/// What the photons of a pass do for the camera.
#[derive(Debug)]
pub(super) struct Judgement {
    /// Of each light path.
    pub worth: Vec<Worth>,
    /// The share of the light that photons bring, mean over the pixels.
    pub share: f32,
    /// Relative variance of a pixel's light, which comes from where the photons of a pass happen to lie.
    pub of_photons: f32,
    /// And what comes from where a path from the camera happens to go.
    pub of_camera: f32,
    /// Rays of a path from the camera.
    pub rays: f32,
    /// Where it was looked.
    pub places: Vec<Place>,
}

/// Of two values from one place, where this is one over the mean.
pub(super) fn variance([a, b]: [f32; 2], unit: f32) -> f64 {
    f64::from((0.5 * ((a - b) * unit).powi(2)).min(MOST))
}

/// Looks at the photons of a pass as the camera would.
pub(super) fn judge(
    scene: &Scene,
    film: &FilmDescription,
    settings: &AutoSettings,
    pass: &Pass,
    maps: &Maps,
    (merging, sharing): (Merging, Sharing),
) -> Judgement {
    let limits = Limits { max_bounces: settings.max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
    let size = Vec2::new(film.size[0] as f32, film.size[1] as f32);
    let family = u64::from(pass.index);
    let group = |group: u64| {
        let mut found = Found::default();
        let mut see = |&(path, ref sampler): &Beginning| {
            let (mut sink, mut tally, mut sampler) = (Plain::default(), Vec::new(), sampler.clone());
            let merge = Merge::new(&maps.surface, merging, &mut found).tallied(&mut tally);
            let volume = maps.volume.as_ref().map(|map| (map, sharing));
            let mut look = Look::merging(scene, limits.max_bounces, &mut sink, merge, volume);
            let rays = walk(scene, path, Origin::Camera, &limits, &mut sampler, &mut look).rays;
            Seen { light: sink.radiance().mean(), tally, rays }
        };
        // Twice from the same place: then what differs is the camera's.
        let pair = |pair: u64| {
            let pixel = Sampler::even(pass.seed, purpose::PILOT, family, pair).square() * size;
            let begins = [2 * pair, 2 * pair + 1].map(|ray| {
                let mut sampler = Sampler::new(pass.seed, pass.index, purpose::CAMERA, ray);
                (PathState::from_camera(scene, pixel, &mut sampler), sampler)
            });
            let seen = [see(&begins[0]), see(&begins[1])];
            (begins, seen)
        };
        (group * GROUP..(group + 1) * GROUP).map(pair).collect::<Vec<_>>()
    };
    let pairs: Vec<([Beginning; 2], [Seen; 2])> = (0..PAIRS / GROUP).into_par_iter().flat_map_iter(group).collect();
    let all = || pairs.iter().flat_map(|(_, seen)| seen);
    let mean = all().map(|seen| f64::from(seen.light)).sum::<f64>() / (2 * PAIRS) as f64;
    let mut worth = vec![Worth::default(); maps.surface.paths_emitted() as usize];
    let (mut brought_in_all, mut of_photons, mut of_camera) = (0.0, 0.0, 0.0);
    let rays = all().map(|seen| u64::from(seen.rays)).sum::<u64>() as f32 / (2 * PAIRS) as f32;
    let mut places = Vec::with_capacity(pairs.len());
    for (begins, [a, b]) in pairs {
        let unit = 1.0 / (0.5 * (a.light + b.light) + DARK * mean as f32);
        of_camera += variance([a.light, b.light], unit);
        let brought = [a.tally, b.tally].concat();
        for photon in &brought {
            let share = photon.light * unit;
            let worth = &mut worth[photon.path as usize];
            worth.brought += share;
            worth.squares += share * share;
            brought_in_all += f64::from(share);
            of_photons += f64::from(share * share);
        }
        places.push(Place { begins, unit, brought });
    }
    let [share, of_photons] = [brought_in_all, of_photons].map(|sum| (sum / (2 * PAIRS) as f64) as f32);
    Judgement { worth, share, of_photons, of_camera: (of_camera / PAIRS as f64) as f32, rays, places }
}

/// What one path from the camera saw.
struct Seen {
    light: f32,
    /// What each photon brought.
    tally: Vec<Brought>,
    rays: u32,
}

/// Balls around what may cast caustics: few, and small where that can be.
fn foci(scene: &Scene) -> Vec<Focus> {
    let mut heaps = vec![caster_points(scene)];
    heaps.retain(|points| !points.is_empty());
    while heaps.len() < FOCI {
        // The split that saves most of what the balls cover.
        let saving = |points: &Vec<Vec3>| {
            let halves = split(points);
            let area = |points: &[Vec3]| around(points).radius.powi(2);
            let saved = area(points) - halves.iter().map(|half| area(half)).sum::<f32>();
            (saved > 0.5 * area(points)).then_some(saved)
        };
        let best = (0..heaps.len()).filter_map(|heap| Some((heap, saving(&heaps[heap])?)));
        let Some((best, _)) = best.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        let halves = split(&heaps.swap_remove(best));
        heaps.extend(halves);
    }
    heaps.iter().map(|points| around(points)).filter(|focus| focus.radius > 0.0).collect()
}

/// Points on all that scatters otherwise than evenly and stands at a finite place.
fn caster_points(scene: &Scene) -> Vec<Vec3> {
    const PLACES: usize = 4096;
    const POINTS: usize = 8192;
    let surfaces = scene.surfaces();
    let casts: Vec<bool> = (0..scene.shapes().len()).map(|shape| may_cast(scene, shape)).collect();
    let all: Vec<_> = surfaces.places().filter(|&(shape, _)| casts[shape as usize]).collect();
    let step = all.len().div_ceil(PLACES).max(1);
    let each = (POINTS / all.len().clamp(1, PLACES)).clamp(2, 1024) as u64;
    let mut points = Vec::new();
    for (number, &place) in (0..).zip(&all).step_by(step) {
        for point in 0..each {
            let mut sampler = Sampler::even(0, purpose::PILOT, number, point);
            points.extend(surfaces.sample_place(place, sampler.square()).map(|surface| surface.position));
        }
    }
    points
}

/// Whether a shape scatters otherwise than evenly on either side, in its middle.
fn may_cast(scene: &Scene, shape: usize) -> bool {
    let Some(surface) = scene.surfaces().sample(shape as u32, Vec2::splat(0.5)) else { return false };
    let lookup = Lookup { basis: scene.basis(), ..Lookup::point(surface.uv) };
    [true, false].into_iter().any(|front| {
        let lobes = scene.materials().bsdf(scene.shapes()[shape].material, &lookup, front).lobes();
        [Event::Specular, Event::Refraction, Event::Glossy].into_iter().any(|event| lobes.contains(event))
    })
}

/// In two, at the middle of the longest side of their box.
fn split(points: &[Vec3]) -> [Vec<Vec3>; 2] {
    let (low, high) = bounds(points);
    let axis = (high - low).max_position();
    let (first, second) = points.iter().partition(|point| point[axis] < 0.5 * (low + high)[axis]);
    [first, second]
}

/// The ball around points, from the middle of their box; a little larger, as there are points between them.
fn around(points: &[Vec3]) -> Focus {
    let (low, high) = bounds(points);
    let center = 0.5 * (low + high);
    let radius = points.iter().map(|point| point.distance(center)).fold(0.0, f32::max);
    Focus { center, radius: 1.02 * radius }
}

fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    let far = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    points.iter().fold(far, |(low, high), &point| (low.min(point), high.max(point)))
}
