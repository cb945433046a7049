//! Passes cut into blocks that threads compute in any order and that are joined in one.

use std::ops::Range;

use glam::Vec2;
use rayon::prelude::*;

use super::{Observer, Pass, Work};
use crate::film::{Band, Exposure, Sink, Sums};
use crate::light::{Emission, LightId};
use crate::sampler::{Sampler, purpose};
use crate::scene::Scene;
use crate::scene::description::FilmDescription;
use crate::spectrum::Spectrum;
use crate::transport::{End, Limits, Origin, PathState, Visitor, walk};

/// Walks from the camera: calls `sample` for every sample of every pixel, with its path at the start, the working space of
/// its row that `new` makes, and a sink like `empty`, and takes the mean by the film's filter. `sample` returns the number of
/// rays that it traced.
#[allow(clippy::too_many_arguments, reason = "each is another part of what a pass is")]
pub(super) fn camera_pass<W, S: Sink>(
    scene: &Scene,
    film: &FilmDescription,
    pass: &Pass,
    samples: u32,
    observer: &dyn Observer,
    new: impl Fn() -> W + Sync,
    empty: S,
    sample: impl Fn(PathState, &mut Sampler, &mut W, &mut S) -> u32 + Sync,
) -> Exposure {
    let [width, height] = film.size.map(|side| side as usize);
    // What is spread comes from pixels around the picture, too.
    let reach = if film.filter.spreads() { film.filter.reach() as usize } else { 0 };
    let row = |y: usize| {
        let (mut working, mut rays) = (new(), 0);
        let (mut band, mut sink) = (Band::new(width, reach, &empty), empty.clone());
        for x in 0..width + 2 * reach {
            let family = (y * (width + 2 * reach) + x) as u64;
            let first = u64::from(pass.index) * u64::from(samples);
            let corner = Vec2::new(x as f32, y as f32) - reach as f32;
            for number in first..first + u64::from(samples) {
                let mut sampler = Sampler::even(pass.seed, purpose::CAMERA, family, number);
                let place = film.filter.place(sampler.square());
                let (ray, response) = scene.view(corner + 0.5 + place, &mut sampler);
                let path = PathState { cone: scene.cone(), ..PathState::new(ray, Spectrum::grey(response)) };
                sink.clear();
                rays += u64::from(sample(path, &mut sampler, &mut working, &mut sink));
                band.add(x, place, &film.filter, &sink);
            }
        }
        if let Some(y) = y.checked_sub(reach).filter(|&y| y < height) {
            observer.row(y, &band.middle_row(scene.basis()));
        }
        observer.work(&Work { rays, share: 1.0 / (height + 2 * reach) as f64, ..Work::default() });
        band
    };
    let mut sums = Sums::new(width, height, reach, &empty);
    let rows = height + 2 * reach;
    let at_once = (ROWS_AT_ONCE / (2 * reach + 1)).max(rayon::current_num_threads());
    for first in (0..rows).step_by(at_once) {
        let bands: Vec<Band<S>> = (first..(first + at_once).min(rows)).into_par_iter().map(row).collect();
        (first..).zip(&bands).for_each(|(y, band)| sums.add(y, band));
    }
    sums.exposure(samples, scene.basis())
}

/// Rows of pixels that wait to be summed, so that they need little memory; a band around a row has several.
const ROWS_AT_ONCE: usize = 128;

/// Light paths are traced in blocks of this many.
pub(super) const BLOCK: u64 = 4096;

/// How light path `index` of a pass begins, and the numbers that are left for it.
#[inline]
pub(super) fn emitted(scene: &Scene, pass: &Pass, index: u64) -> Option<(LightId, Emission, Sampler)> {
    let mut sampler = Sampler::new(pass.seed, pass.index, purpose::LIGHT, index);
    let (light, emission) = scene.emit(&mut sampler)?;
    Some((light, emission, sampler))
}

/// Walks from the lamps: `paths` of them, each block of them told to a visitor that `new` makes. Returns the visitors in
/// the order of the paths.
pub(super) fn light_pass<V: Visitor + Send>(
    scene: &Scene,
    pass: &Pass,
    paths: u64,
    max_bounces: u32,
    observer: &dyn Observer,
    new: impl Fn() -> V + Sync,
) -> Vec<V> {
    let limits = Limits { max_bounces, roulette_from: 0 };
    let block = |range: Range<u64>| {
        let mut visitor = new();
        let light_paths = range.end - range.start;
        let mut work = Work { light_paths, share: light_paths as f64 / paths as f64, ..Work::default() };
        for index in range {
            let Some((light, emission, mut sampler)) = emitted(scene, pass, index) else { continue };
            visitor.emitted(index, light, &emission);
            let path = PathState { hidden_lamp: emission.is_hidden(), ..PathState::new(emission.ray, emission.flux) };
            let walked = walk(scene, path, Origin::Light, &limits, &mut sampler, &mut visitor);
            work.rays += u64::from(walked.rays);
            let watts = |flux: Spectrum| f64::from(Spectrum::from_rgb(scene.basis().to_rgb(flux)).mean());
            work.flux_emitted += watts(emission.flux) / paths as f64;
            if walked.end == End::Cut {
                work.flux_cut += watts(walked.path.throughput) / paths as f64;
            }
        }
        observer.work(&work);
        visitor
    };
    (0..paths.div_ceil(BLOCK))
        .into_par_iter()
        .map(|number| block(number * BLOCK..((number + 1) * BLOCK).min(paths)))
        .collect()
}
