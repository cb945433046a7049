//! The pilot of time: when light arrives, where the user does not say which times to keep.
//!
//! A few paths from the camera and from the lamps are traced, and the times are kept between the first light that either
//! brings and nearly the last. As with the other pilots, what comes out depends on scene, film, depth and seed alone, and
//! scales with the scene.

use glam::Vec2;

use super::blocks::light_pass;
use super::light::Splat;
use super::look::Look;
use super::path::CAMERA_ROULETTE_FROM;
use super::{Observer, Pass, Phase, Silent, pilot};
use crate::film::{Clock, Sink, Way};
use crate::sampler::{Sampler, purpose};
use crate::scene::Scene;
use crate::scene::SurfacePoint;
use crate::scene::description::{FilmDescription, IntegratorDescription};
use crate::spectrum::Spectrum;
use crate::transient::{Met, Unwarp};
use crate::transport::{Limits, Origin, PathState, walk};

/// Paths from the camera, and from the lamps.
const PATHS: [u64; 2] = [4096, 16_384];

/// The share of the light, of either kind of paths, that arrives before the last bin ends; later light may be too little and
/// much too late.
const KEPT: f64 = 0.999;

/// The first light may come a little earlier than any that was found, by this share of the range.
const MARGIN: f64 = 0.02;

/// The film with the range of its time bins: measured where it is not given.
pub fn timed(
    scene: &Scene,
    mut film: FilmDescription,
    integrator: &IntegratorDescription,
    seed: u64,
    observer: &dyn Observer,
) -> FilmDescription {
    let Some(time) = &film.time else { return film };
    // Amplitudes need no range.
    if Clock::of(&film).is_some() || time.keeps_amplitudes() {
        return film;
    }
    observer.phase(Phase::Pilot);
    let (bins, unwarp) = (f64::from(time.bins), time.unwarp);
    let max_bounces = integrator.max_bounces();
    let arrivals = [from_camera(scene, &film, unwarp, max_bounces, seed), from_lamps(scene, &film, max_bounces, seed)];
    let ranges = arrivals.into_iter().filter_map(range);
    let range = ranges.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let [first, last] = range.unwrap_or([0.0, 0.0]);
    let before = first - MARGIN * (last - first);
    // Light has travelled no less than nothing, unless it comes from infinitely far away.
    let before = if first >= 0.0 { before.max(0.0) } else { before };
    let start = time.start().unwrap_or(before);
    let bin_width = time.bin_width().unwrap_or_else(|| {
        let range = if last > start { last - start } else { f64::from(pilot::fallback(scene)) };
        range / bins
    });
    if let Some(time) = &mut film.time {
        time.fix(start, bin_width);
    }
    film
}

/// When light arrived, and how much.
type Arrivals = Vec<(f64, f64)>;

/// From the first arrival to that by which nearly all light is there.
fn range(mut arrivals: Arrivals) -> Option<[f64; 2]> {
    arrivals.retain(|(at, light)| at.is_finite() && light.is_finite() && *light > 0.0);
    arrivals.sort_by(|a, b| a.0.total_cmp(&b.0));
    let most = KEPT * arrivals.iter().map(|(_, light)| light).sum::<f64>();
    let mut sum = 0.0;
    let last = arrivals.iter().find(|(_, light)| {
        sum += light;
        sum >= most
    });
    Some([arrivals.first()?.0, last.or(arrivals.last())?.0])
}

fn from_camera(scene: &Scene, film: &FilmDescription, unwarp: Unwarp, max_bounces: u32, seed: u64) -> Arrivals {
    let [width, height] = film.size.map(|side| side as f32);
    let limits = Limits { max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
    let mut arrivals = Vec::new();
    for index in 0..PATHS[0] {
        let mut sampler = Sampler::new(seed, pilot::PASS, purpose::PILOT, index);
        let pixel = sampler.square() * Vec2::new(width, height);
        let scene = &*scene.of_pixel(pixel);
        let path = PathState::from_camera(scene, pixel, &mut sampler);
        let mut heard = Heard { unwarp, way: Way::default(), arrivals: Vec::new() };
        walk(scene, path, Origin::Camera, &limits, &mut sampler, &mut Look::alone(scene, max_bounces, &mut heard));
        arrivals.append(&mut heard.arrivals);
    }
    arrivals
}

fn from_lamps(scene: &Scene, film: &FilmDescription, max_bounces: u32, seed: u64) -> Arrivals {
    let pass = Pass { index: pilot::PASS, seed };
    let new = || Splat::new(scene, film, max_bounces);
    let blocks = light_pass(scene, &pass, PATHS[1], max_bounces, &Silent, new);
    let splats = blocks.into_iter().flat_map(|block| block.splats);
    splats.map(|splat| (splat.optical_length, f64::from(splat.light.mean()))).collect()
}

/// Notes when light arrives.
#[derive(Clone)]
struct Heard {
    unwarp: Unwarp,
    way: Way,
    arrivals: Arrivals,
}

impl Sink for Heard {
    const LAYERED: bool = false;

    fn clear(&mut self) {
        self.arrivals.clear();
    }

    fn surface(&mut self, _: &SurfacePoint, path: &PathState) {
        self.way.surface(path);
    }

    const TIMED: bool = true;

    fn particle(&mut self, optical_length: f64) {
        self.way.particle(optical_length);
    }

    fn add(&mut self, light: Spectrum, _: Met, optical_length: f64) {
        self.arrivals.push((self.way.counted(optical_length, self.unwarp), f64::from(light.mean())));
    }

    fn take(&mut self, _: &Heard, _: f32) {}

    fn borrow(&mut self, _: &Heard, _: Spectrum, _: f64) {}

    fn radiance(&self) -> Spectrum {
        Spectrum::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearly_all_light_is_between_the_first_and_the_last() {
        let even: Arrivals = (0..10_000).rev().map(|step| (f64::from(step), 1.0)).collect();
        assert_eq!(range(even), Some([0.0, 9989.0]));
        assert_eq!(range(vec![(3.0, 1.0), (f64::INFINITY, 1.0), (2.0, 0.0), (1.0, f64::NAN)]), Some([3.0, 3.0]));
        assert_eq!(range(Vec::new()), None);
    }
}
