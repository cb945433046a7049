//! What the pilot learns about which lights points see, for shadow rays (theory §4.6).
//!
//! Paths from the camera shoot shadow rays wherever they come, and note what came through. Points that lie together and face
//! the same way then share what they saw; where much was seen, smaller groups of them.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::path::CAMERA_ROULETTE_FROM;
use super::{Observer, Phase, Work, with};
use crate::light::{Node, Outlook, Parts, SIDES, Sightings, side};
use crate::material::Lobes;
use crate::sampler::{Sampler, purpose};
use crate::scene::description::FilmDescription;
use crate::scene::{Scene, SurfacePoint};
use crate::transport::{Limits, Origin, PathState, Visitor, light_from, walk};

/// Paths for each pixel, but no less and no more than so many. These shares of them shoot one after the other, the first as
/// if nothing were known, and each of the others by what those before it learned.
const PATHS_PER_PIXEL: f32 = 0.5;
const PATHS: [f32; 2] = [8192.0, 65_536.0];
const ROUNDS: [f32; 4] = [0.125, 0.125, 0.25, 0.5];
/// Paths that one thread follows before another may go on.
const GROUP: u64 = 256;
/// Shadow rays from each point, of those that a path reaches within so many scattering events: beyond, there are more of the
/// same, and each is a number to remember.
const SHADOW_RAYS: u32 = 4;
const DEEPEST: u32 = 12;

/// A group of points is parted in two where so many shadow rays brought something; and what the larger group that holds it
/// saw of a part of the lights counts as so many more of its own.
const ENOUGH: usize = 64;
const PRIOR: f64 = 1.0;
/// The most often that all points are parted, and the most weights in all.
const DEPTH: u32 = 24;
const WEIGHTS: usize = 1 << 22;

/// What is learned is used if even shadow rays typically have so many times its second moment.
const LEAST_GAIN: f64 = 1.3;
/// And nothing more is learned if the first that was learned brings less than this.
const HOPELESS: f64 = 1.1;

/// One shadow ray.
struct Shot {
    at: Vec3,
    side: u8,
    /// What it was shot at.
    part: u32,
    /// The irradiance that came through, as even shadow rays would count it: not what the surface makes of it, as that
    /// differs from point to point, and highlights are found by the walk's own directions.
    came: f32,
    /// By how much these would be more rarely shot there.
    factor: f32,
    /// The number of what was known to be seen, from where it was shot.
    vista: usize,
}

/// Learns what paths of at most so many scattering events see of the lights. None if it is not worth while.
pub(super) fn survey(
    scene: &Scene,
    film: &FilmDescription,
    max_bounces: u32,
    seed: u64,
    observer: &dyn Observer,
) -> Option<Sightings> {
    let parts = scene.parts_of_lights();
    if parts.len() < 2 || parts.len() > WEIGHTS / SIDES || scene.capture().is_some() {
        return None;
    }
    observer.phase(Phase::Pilot);
    let max_bounces = max_bounces.min(DEEPEST);
    let size = Vec2::new(film.size[0] as f32, film.size[1] as f32);
    let paths = (PATHS_PER_PIXEL * size.x * size.y).clamp(PATHS[0], PATHS[1]);
    let (mut shots, mut seen): (Vec<Shot>, Option<Sightings>) = (Vec::new(), None);
    let mut gain = 0.0;
    for (round, share) in (0..).zip(ROUNDS) {
        let known = seen.as_ref().and_then(|seen| outlook(scene, seen));
        let scene = &*with(scene, &known, Scene::with_outlook);
        let more = shoot(scene, size, (max_bounces, seed, round), (share * paths) as u64, &parts, observer);
        gain = gain_of(&more);
        shots.extend(more);
        if round > 0 && gain < HOPELESS {
            return None;
        }
        seen = Some(learn(scene, &shots, &parts));
    }
    seen.filter(|_| gain > LEAST_GAIN)
}

/// By how much the second moment of even shadow rays is larger than that of these: the geometric mean over all places, so
/// that those in the sun do not count more than those in the shade.
fn gain_of(shots: &[Shot]) -> f64 {
    let mut moments = BTreeMap::new();
    for shot in shots.iter().filter(|shot| shot.came.is_finite()) {
        let (count, even, learned) = moments.entry(shot.vista).or_insert((0.0, 0.0, 0.0));
        let square = f64::from(shot.came).powi(2);
        *count += 1.0;
        *even += square / f64::from(shot.factor);
        *learned += square / f64::from(shot.factor).powi(2);
    }
    let (mut total, mut sum) = (0.0, 0.0);
    for (count, even, learned) in moments.into_values().filter(|&(_, even, learned)| even > 0.0 && learned > 0.0) {
        total += count;
        sum += count * (even / learned).ln();
    }
    if total > 0.0 { (sum / total).exp() } else { 1.0 }
}

/// As shadow rays use it.
pub(super) fn outlook(scene: &Scene, seen: &Sightings) -> Option<Arc<Outlook>> {
    scene.outlook(seen).map(Arc::new)
}

fn shoot(
    scene: &Scene,
    size: Vec2,
    (max_bounces, seed, round): (u32, u64, u64),
    paths: u64,
    parts: &Parts,
    observer: &dyn Observer,
) -> Vec<Shot> {
    let limits = Limits { max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
    let group = |group: u64| {
        let mut surveyor = Surveyor { scene, parts, max_bounces, shots: Vec::new() };
        let mut rays = 0;
        for path in group * GROUP..((group + 1) * GROUP).min(paths) {
            let mut sampler = Sampler::even(seed, purpose::PILOT, u64::MAX - round, path);
            let pixel = sampler.square() * size;
            let path = PathState::from_camera(scene, pixel, &mut sampler);
            // What comes now takes any number of numbers.
            rays += walk(scene, path, Origin::Camera, &limits, &mut sampler.apart(), &mut surveyor).rays;
        }
        observer.work(&Work { rays: u64::from(rays) + surveyor.shots.len() as u64, ..Work::default() });
        surveyor.shots
    };
    (0..paths.div_ceil(GROUP)).into_par_iter().flat_map_iter(group).collect()
}

/// Shoots shadow rays from where a walk comes.
struct Surveyor<'a> {
    scene: &'a Scene,
    parts: &'a Parts,
    max_bounces: u32,
    shots: Vec<Shot>,
}

impl Visitor for Surveyor<'_> {
    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, sampler: &mut Sampler) -> Lobes {
        if path.bounce >= self.max_bounces || !point.bsdf.lobes().meets(Lobes::SMOOTH) {
            return Lobes::ALL;
        }
        let (at, vista) = (point.surface.position, self.scene.vista(&point.surface));
        for _ in 0..SHADOW_RAYS {
            let Some((lamp, illumination)) = self.scene.illuminate(at, vista, sampler) else { continue };
            let (light, _) = light_from(self.scene, point, (lamp, &illumination), path, sampler, |_, _| 1.0);
            let to_light = illumination.to_light;
            let number = vista.map_or(0, |vista| vista.number());
            let factor = self.scene.aim_factor(vista, lamp, to_light);
            let irradiance = illumination.irradiance.mean() * point.cos(to_light);
            let came = if light.is_zero() { 0.0 } else { irradiance * factor };
            let part = self.parts.at(lamp, self.scene.place_on(lamp, to_light)) as u32;
            self.shots.push(Shot { at, side: side(point.surface.normal) as u8, part, came, factor, vista: number });
        }
        Lobes::ALL
    }
}

/// What the shots saw, together.
fn learn(scene: &Scene, shots: &[Shot], parts: &Parts) -> Sightings {
    let all: Vec<&Shot> = shots.iter().filter(|shot| shot.came.is_finite()).collect();
    let shares = scene.shares_of_parts(parts);
    let nothing = vec![0.0; parts.len()];
    let whole = mean_squares(&all, parts, &nothing);
    let mut sightings = Sightings { trees: Default::default(), vistas: Vec::new() };
    let leaves = (WEIGHTS / parts.len() / SIDES).max(1);
    for side in 0..SIDES {
        let of_side = all.iter().filter(|shot| usize::from(shot.side) == side).copied().collect();
        let most = sightings.vistas.len() + leaves;
        let mut growing = Growing { parts, shares: &shares, nodes: Vec::new(), vistas: &mut sightings.vistas, most };
        growing.grow(of_side, &whole, 0);
        sightings.trees[side] = growing.nodes;
    }
    sightings
}

struct Growing<'a> {
    parts: &'a Parts,
    /// How often even shadow rays are shot at each part.
    shares: &'a [f32],
    nodes: Vec<Node>,
    vistas: &'a mut Vec<Vec<f32>>,
    /// So many of these in all.
    most: usize,
}

impl Growing<'_> {
    /// Adds a node for these shots, which are some of those that saw so much. Returns its number.
    fn grow(&mut self, shots: Vec<&Shot>, of_all: &[f64], depth: u32) -> u32 {
        let seen = mean_squares(&shots, self.parts, of_all);
        let number = self.nodes.len();
        self.nodes.push(Node::Vista(self.vistas.len() as u32));
        let useful = shots.iter().filter(|shot| shot.came > 0.0).count();
        if useful >= 2 * ENOUGH && depth < DEPTH && self.vistas.len() + 2 <= self.most {
            let far = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            let (low, high) = shots.iter().fold(far, |(low, high), shot| (low.min(shot.at), high.max(shot.at)));
            let axis = (high - low).max_position();
            let at = 0.5 * (low[axis] + high[axis]);
            if low[axis] < at && at <= high[axis] {
                let (below, above): (Vec<&Shot>, Vec<&Shot>) = shots.into_iter().partition(|shot| shot.at[axis] < at);
                let children = [below, above].map(|part| self.grow(part, &seen, depth + 1));
                self.nodes[number] = Node::Split { axis: axis as u8, at, children };
                return number as u32;
            }
        }
        // The least variance of parts that are each shot at evenly.
        let weights = || seen.iter().zip(self.shares).map(|(square, &share)| f64::from(share) * square.sqrt());
        let largest = weights().fold(f64::MIN_POSITIVE, f64::max);
        self.vistas.push(weights().map(|weight| (weight / largest) as f32).collect());
        number as u32
    }
}

/// The mean square of what comes from each part of the lights, by the shots at it, and by what more of them saw.
fn mean_squares(shots: &[&Shot], parts: &Parts, of_all: &[f64]) -> Vec<f64> {
    let (mut sums, mut counts) = (vec![0.0; parts.len()], vec![0.0; parts.len()]);
    for shot in shots {
        sums[shot.part as usize] += f64::from(shot.came).powi(2);
        counts[shot.part as usize] += 1.0;
    }
    let [sums, counts] = [sums, counts].map(|numbers| parts.blurred(&numbers));
    let mean = |((sum, count), of_all): ((f64, f64), &f64)| (sum + PRIOR * of_all) / (count + PRIOR);
    sums.into_iter().zip(counts).zip(of_all).map(mean).collect()
}
