//! Passes cut into blocks that threads compute in any order and that are joined in one.

use std::ops::Range;

use glam::Vec2;
use rayon::prelude::*;

use super::{Observer, Pass, Work};
use crate::film::{Exposure, Features, Sink};
use crate::image::Image;
use crate::sampler::{Sampler, purpose};
use crate::scene::Scene;
use crate::scene::description::FilmDescription;
use crate::spectrum::Spectrum;
use crate::transport::{End, Limits, Origin, PathState, Visitor, walk};

/// Walks from the camera: calls `sample` for every sample of every pixel, with its path at the start, the working space of
/// its row that `new` makes, and the pixel's sink, and takes the mean. `sample` returns the number of rays that it traced.
pub(super) fn camera_pass<W, S: Sink>(
    scene: &Scene,
    film: &FilmDescription,
    pass: &Pass,
    samples: u32,
    observer: &dyn Observer,
    new: impl Fn() -> W + Sync,
    sample: impl Fn(PathState, &mut Sampler, &mut W, &mut S) -> u32 + Sync,
) -> Exposure {
    let [width, height] = film.size.map(|side| side as usize);
    let rows: Vec<(Vec<[f32; 3]>, Vec<Features>)> = (0..height)
        .into_par_iter()
        .map(|y| {
            let (mut working, mut rays) = (new(), 0);
            let mut pixels = Vec::with_capacity(width);
            let mut features = Vec::with_capacity(if S::LAYERED { width } else { 0 });
            for x in 0..width {
                let family = (y * width + x) as u64;
                let first = u64::from(pass.index) * u64::from(samples);
                let center = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let mut sink = S::default();
                for number in first..first + u64::from(samples) {
                    let mut sampler = Sampler::even(pass.seed, purpose::CAMERA, family, number);
                    let at = center + film.filter.sample(sampler.square());
                    let (ray, response) = scene.view(at, &mut sampler);
                    let path = PathState { cone: scene.cone(), ..PathState::new(ray, Spectrum::grey(response)) };
                    rays += u64::from(sample(path, &mut sampler, &mut working, &mut sink));
                }
                pixels.push((sink.radiance() / samples as f32).to_rgb());
                features.extend(sink.features(samples));
            }
            observer.row(y, &pixels);
            observer.work(&Work { rays, share: 1.0 / height as f64, ..Work::default() });
            (pixels, features)
        })
        .collect();
    let (pixels, features): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
    let image = Image::from_pixels(width, height, pixels.concat()).unwrap_or_else(|| Image::new(width, height));
    Exposure { image, features: features.concat() }
}

/// Light paths are traced in blocks of this many.
pub(super) const BLOCK: u64 = 4096;

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
            let mut sampler = Sampler::new(pass.seed, pass.index, purpose::LIGHT, index);
            let Some(emission) = scene.emit(&mut sampler) else { continue };
            let path = PathState { hidden_lamp: emission.hidden, ..PathState::new(emission.ray, emission.flux) };
            let walked = walk(scene, path, Origin::Light, &limits, &mut sampler, &mut visitor);
            work.rays += u64::from(walked.rays);
            work.flux_emitted += f64::from(emission.flux.mean()) / paths as f64;
            if walked.end == End::Cut {
                work.flux_cut += f64::from(walked.path.throughput.mean()) / paths as f64;
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
