//! Passes cut into blocks that threads compute in any order and that are joined in one.

use std::ops::Range;

use glam::Vec2;
use rayon::prelude::*;

use super::groups::Groups;
use super::reuse::{Group, Lending};
use super::{Observer, Pass, Work};
use crate::film::{Arrival, Band, Clock, Exposure, Layered, Layers, Plain, Sink, Sums, Timed};
use crate::light::{Emission, LightId};
use crate::sampler::{Sampler, purpose};
use crate::scene::Scene;
use crate::scene::description::FilmDescription;
use crate::spectrum::Spectrum;
use crate::transport::{End, Limits, Origin, PathState, Visitor, Walked, walk};

/// What becomes of a path from the camera.
pub(super) trait Eye: Sync {
    /// What the paths of a strip have in common, such as lists that would otherwise be made anew for each.
    type Working: Default;

    /// Whether its paths lend each other what they find, in a scene that is the same for all of them.
    fn lends(&self, _scene: &Scene) -> bool {
        false
    }

    /// Follows a path in a scene as its pixel sees it, and leaves its light at `sink`, and at `lending` what it lends. Returns
    /// the number of rays that it traced.
    fn look<S: Sink>(
        &self,
        scene: &Scene,
        path: PathState,
        sampler: &mut Sampler,
        working: &mut Self::Working,
        sink: &mut S,
        lending: Option<Lending<S>>,
    ) -> u32;
}

/// Walks from the camera, row by row: what an integrator is asked for, and how many samples it takes of every pixel.
pub(super) struct CameraPass<'a> {
    pub scene: &'a Scene,
    pub film: &'a FilmDescription,
    pub pass: &'a Pass,
    pub samples: u32,
    pub layers: Layers,
    pub observer: &'a dyn Observer,
}

impl CameraPass<'_> {
    /// Shows `eye` every sample, and takes the mean by the film's filter, with the time at which light arrives where the film
    /// has time, of which `arrived` is told row by row, and with what the layers need.
    pub(super) fn expose(&self, eye: &impl Eye, arrived: &mut dyn FnMut(&[Arrival])) -> Exposure {
        let clock = Clock::of(self.film);
        match (&clock, self.layers.is_empty()) {
            (None, true) => self.expose_in(&Plain::default(), 0, eye, arrived),
            (None, false) => self.expose_in(&Layered::default(), 0, eye, arrived),
            (Some(clock), none) => self.expose_in(&Timed::new(clock, !none), clock.most_bytes(), eye, arrived),
        }
    }

    /// Every sample in a sink like `empty`, which takes up to so many bytes beside its own size.
    fn expose_in<S: Sink>(
        &self,
        empty: &S,
        most_bytes: usize,
        eye: &impl Eye,
        arrived: &mut dyn FnMut(&[Arrival]),
    ) -> Exposure {
        let [width, height] = self.film.size.map(|side| side as usize);
        // What is spread comes from pixels around the picture, too.
        let reach = if self.film.filter.spreads() { self.film.filter.reach() as usize } else { 0 };
        let mut sums = Sums::new(width, height, reach, empty);
        let groups = Groups::new(self.pass, width + 2 * reach, eye.lends(self.scene));
        let strips = groups.strips(height + 2 * reach);
        let of_row = width.saturating_mul(2 * reach + 1).saturating_mul(most_bytes + size_of::<(S, f32)>());
        let rows_of_strip = strips.iter().map(ExactSizeIterator::len).max().unwrap_or(1);
        let at_once = BYTES_AT_ONCE / of_row.saturating_mul(rows_of_strip).max(1);
        for strips in strips.chunks(at_once.max(rayon::current_num_threads())) {
            let strip = |rows: &Range<usize>| self.strip(rows.clone(), &groups, reach, empty, eye);
            let bands: Vec<Vec<Band<S>>> = strips.par_iter().map(strip).collect();
            bands.iter().flatten().for_each(|band| sums.add(band));
            arrived(&sums.finish(self.samples, self.scene.basis()));
        }
        sums.exposure(self.samples)
    }

    /// Some rows, counted from the topmost one that reaches the picture.
    fn strip<S: Sink>(
        &self,
        rows: Range<usize>,
        groups: &Groups,
        reach: usize,
        empty: &S,
        eye: &impl Eye,
    ) -> Vec<Band<S>> {
        let CameraPass { scene, film, pass, samples, observer, .. } = *self;
        let [width, height] = film.size.map(|side| side as usize);
        let (mut working, mut rays) = (Default::default(), 0);
        let mut bands: Vec<Band<S>> = rows.clone().map(|_| Band::new(width, reach, empty)).collect();
        let mut group = Group::new(empty, groups.most());
        let mut places = Vec::with_capacity(groups.most());
        let first = u64::from(pass.index) * u64::from(samples);
        let lends = eye.lends(scene);
        // A point of a wall has no extent; and rounding must not make it another pixel's.
        let is_point = scene.camera().wall().is_some();
        let middle = |[x, y]: [usize; 2]| Vec2::new(x as f32, y as f32) - reach as f32 + 0.5;
        for pixels in groups.of_strip(rows.clone()) {
            let scene = &*scene.of_pixel(middle(pixels[0]));
            for number in first..first + u64::from(samples) {
                group.clear();
                places.clear();
                for &[x, y] in &pixels {
                    let family = (y * (width + 2 * reach) + x) as u64;
                    let mut sampler = Sampler::even(pass.seed, purpose::CAMERA, family, number);
                    let place = film.filter.place(sampler.square());
                    let pixel = if is_point { middle([x, y]) } else { middle([x, y]) + place };
                    let path = PathState::from_camera(scene, pixel, &mut sampler);
                    let (sink, lending) = group.next();
                    let lending = lends.then_some(lending);
                    rays += u64::from(eye.look(scene, path, &mut sampler, &mut working, sink, lending));
                    places.push(place);
                }
                if lends {
                    group.share(scene);
                }
                for ((sink, &place), &[x, y]) in group.sinks().zip(&places).zip(&pixels) {
                    sink.settle();
                    bands[y - rows.start].add(x, place, &film.filter, sink);
                }
            }
        }
        for (band, y) in bands.iter_mut().zip(rows.clone()) {
            band.settle();
            if let Some(y) = y.checked_sub(reach).filter(|&y| y < height) {
                observer.row(y, &band.middle_row(scene.basis()));
            }
        }
        let share = rows.len() as f64 / (height + 2 * reach) as f64;
        observer.work(&Work { rays, share, ..Work::default() });
        bands
    }
}

/// What the rows that wait to be summed may take; where that is less than one strip for each thread, it is these.
const BYTES_AT_ONCE: usize = 1 << 28;

/// Light paths are traced in blocks of this many: few enough that threads end together where a pass has ten thousand.
pub(super) const BLOCK: u64 = 512;

/// How light path `index` of a pass begins, and the numbers that are left for it.
#[inline]
pub(super) fn emitted(scene: &Scene, pass: &Pass, index: u64) -> Option<(LightId, Emission, Sampler)> {
    let mut sampler = Sampler::new(pass.seed, pass.index, purpose::LIGHT, index);
    let (light, emission) = scene.emit(&mut sampler)?;
    Some((light, emission, sampler))
}

/// Follows light path `index` of a pass; returns the flux with which it began, and how it ended.
pub(super) fn light_path<V: Visitor>(
    scene: &Scene,
    pass: &Pass,
    index: u64,
    max_bounces: u32,
    visitor: &mut V,
) -> Option<(Spectrum, Walked)> {
    let (light, emission, mut sampler) = emitted(scene, pass, index)?;
    visitor.emitted(index, light, &emission);
    let path = PathState {
        hidden_lamp: emission.is_hidden(),
        inside: scene.inside_at(emission.ray.origin),
        optical_length: scene.traveled(light).into(),
        ..PathState::new(emission.ray, emission.flux)
    };
    let limits = Limits { max_bounces, roulette_from: 0 };
    Some((emission.flux, walk(scene, path, Origin::Light, &limits, &mut sampler, visitor)))
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
    let block = |range: Range<u64>| {
        let mut visitor = new();
        let light_paths = range.end - range.start;
        let mut work = Work { light_paths, share: light_paths as f64 / paths as f64, ..Work::default() };
        for index in range {
            let Some((flux, walked)) = light_path(scene, pass, index, max_bounces, &mut visitor) else { continue };
            work.rays += u64::from(walked.rays);
            let watts = |flux: Spectrum| f64::from(Spectrum::from_rgb(scene.basis().to_rgb(flux)).mean());
            work.flux_emitted += watts(flux) / paths as f64;
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
