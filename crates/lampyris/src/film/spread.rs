//! Sums over the samples of a pass, spread over the pixels by a film's filter: bands around rows, which threads make in
//! any order, and the picture that they are added up to in one.

use std::collections::VecDeque;

use glam::Vec2;

use super::{Arrival, Exposure, Features, Sink};
use crate::image::Image;
use crate::scene::description::FilterDescription;
use crate::spectrum::Basis;

/// What the samples of one row leave in the rows around it: as far up and down, and to both sides, as the filter reaches.
pub(crate) struct Band<S> {
    width: usize,
    reach: usize,
    /// Row by row, each with the weight of what it was given.
    pixels: Vec<(S, f32)>,
}

impl<S: Sink> Band<S> {
    /// Of such sinks.
    pub(crate) fn new(width: usize, reach: usize, empty: &S) -> Band<S> {
        Band { width, reach, pixels: vec![(empty.clone(), 0.0); width * (2 * reach + 1)] }
    }

    /// Spreads a sample of the pixel in column `x` at this place from its centre. Columns are counted from the leftmost
    /// one that reaches the picture.
    #[inline]
    pub(crate) fn add(&mut self, x: usize, place: Vec2, filter: &FilterDescription, sink: &S) {
        if self.reach == 0 {
            let (sum, weight) = &mut self.pixels[x];
            sum.take(sink, 1.0);
            *weight += 1.0;
            return;
        }
        let reach = self.reach;
        let columns = x.saturating_sub(2 * reach)..(x + 1).min(self.width);
        for row in 0..=2 * reach {
            for column in columns.clone() {
                let to = Vec2::new((column + reach) as f32 - x as f32, row as f32 - reach as f32);
                let share = filter.value(to - place);
                if share > 0.0 {
                    let (sum, weight) = &mut self.pixels[row * self.width + column];
                    sum.take(sink, share);
                    *weight += share;
                }
            }
        }
    }

    /// Brings all that it was given into the form in which [`Sums::add`] takes it.
    pub(crate) fn settle(&mut self) {
        self.pixels.iter_mut().for_each(|(sum, _)| {
            sum.settle();
        });
    }

    /// The row itself, for those who cannot wait for its neighbours.
    pub(crate) fn middle_row(&self, basis: &Basis) -> Vec<[f32; 3]> {
        let middle = &self.pixels[self.reach * self.width..][..self.width];
        let mean = |(sum, weight): &(S, f32)| basis.to_rgb(sum.radiance() / weight.max(f32::MIN_POSITIVE));
        middle.iter().map(mean).collect()
    }
}

/// What all rows leave in the picture.
pub(crate) struct Sums<S> {
    width: usize,
    height: usize,
    reach: usize,
    empty: S,
    /// How many bands were added.
    bands: usize,
    /// The rows that bands were added to and that are not finished.
    rows: VecDeque<Vec<(S, f32)>>,
    /// What those have that are.
    pixels: Vec<[f32; 3]>,
    weights: Vec<f32>,
    features: Vec<Features>,
}

impl<S: Sink> Sums<S> {
    /// Of such sinks.
    pub(crate) fn new(width: usize, height: usize, reach: usize, empty: &S) -> Sums<S> {
        let (empty, rows) = (empty.clone(), VecDeque::new());
        let (pixels, weights, features) = (Vec::with_capacity(width * height), Vec::new(), Vec::new());
        Sums { width, height, reach, empty, bands: 0, rows, pixels, weights, features }
    }

    /// Adds the band around the next row, from the uppermost one on that reaches the picture.
    pub(crate) fn add(&mut self, band: &Band<S>) {
        let first = self.pixels.len() / self.width.max(1);
        for (row, from) in band.pixels.chunks(self.width.max(1)).enumerate() {
            let row = (self.bands + row).checked_sub(2 * self.reach).filter(|&row| row < self.height);
            // Those that are finished are out of reach.
            let Some(place) = row.and_then(|row| row.checked_sub(first)) else { continue };
            while self.rows.len() <= place {
                self.rows.push_back(vec![(self.empty.clone(), 0.0); self.width]);
            }
            for ((sum, weight), (more, of)) in self.rows[place].iter_mut().zip(from) {
                sum.take(more, 1.0);
                *weight += of;
            }
        }
        self.bands += 1;
    }

    /// Finishes the rows that no other band reaches, and returns what arrived in their pixels.
    pub(crate) fn finish(&mut self, samples: u32, basis: &Basis) -> Vec<Arrival> {
        let n = samples as f32;
        // What four wavelengths make of white is known: the picture need not have its noise.
        let white = basis.white();
        let has_weights = self.reach > 0 || white != 1.0;
        let mut arrivals = Vec::new();
        while self.pixels.len() + 2 * self.reach * self.width < self.bands * self.width {
            let Some(row) = self.rows.pop_front() else { break };
            for (mut sum, weight) in row {
                let pixel = self.pixels.len() as u32;
                self.pixels.push(basis.to_rgb(sum.radiance() / n));
                self.weights.extend(has_weights.then_some(weight / n * white));
                self.features.extend(sum.features(samples, basis));
                let settled = sum.settle().iter();
                arrivals.extend(settled.map(|&(slot, light)| Arrival { pixel, slot, light: basis.to_rgb(light / n) }));
            }
        }
        arrivals
    }

    /// The picture, when all rows are finished, without its arrivals.
    pub(crate) fn exposure(self, samples: u32) -> Exposure {
        let Sums { width, height, pixels, weights, features, .. } = self;
        let image = Image::from_pixels(width, height, pixels).unwrap_or_else(|| Image::new(width, height));
        Exposure { image, features, weights, samples, area: None, arrivals: Vec::new() }
    }
}
