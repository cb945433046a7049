//! Sums over the samples of a pass, spread over the pixels by a film's filter: bands around rows, which threads make in
//! any order, and the picture that they are added up to in one.

use glam::Vec2;

use super::{Arrival, Exposure, Sink};
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
    pixels: Vec<(S, f32)>,
}

impl<S: Sink> Sums<S> {
    /// Of such sinks.
    pub(crate) fn new(width: usize, height: usize, reach: usize, empty: &S) -> Sums<S> {
        Sums { width, height, reach, pixels: vec![(empty.clone(), 0.0); width * height] }
    }

    /// Adds the band around row `y`, counted from the uppermost one that reaches the picture; in the order of the rows.
    pub(crate) fn add(&mut self, y: usize, band: &Band<S>) {
        for (row, from) in band.pixels.chunks(self.width.max(1)).enumerate() {
            let Some(row) = (y + row).checked_sub(2 * self.reach).filter(|&row| row < self.height) else { continue };
            let to = &mut self.pixels[row * self.width..][..self.width];
            for ((sum, weight), (more, of)) in to.iter_mut().zip(from) {
                sum.take(more, 1.0);
                *weight += of;
            }
        }
    }

    pub(crate) fn exposure(self, samples: u32, basis: &Basis) -> Exposure {
        let n = samples as f32;
        let pixels = self.pixels.iter().map(|(sum, _)| basis.to_rgb(sum.radiance() / n)).collect();
        let image =
            Image::from_pixels(self.width, self.height, pixels).unwrap_or_else(|| Image::new(self.width, self.height));
        // What four wavelengths make of white is known: the picture need not have its noise.
        let white = basis.white();
        let weights = if self.reach == 0 && white == 1.0 {
            Vec::new()
        } else {
            self.pixels.iter().map(|(_, weight)| weight / n * white).collect()
        };
        let features = self.pixels.iter().filter_map(|(sum, _)| sum.features(samples, basis)).collect();
        let mut arrivals = Vec::new();
        for (pixel, (mut sum, _)) in (0..).zip(self.pixels) {
            let settled = sum.settle().iter();
            arrivals.extend(settled.map(|&(slot, light)| Arrival { pixel, slot, light: basis.to_rgb(light / n) }));
        }
        Exposure { image, features, weights, samples, area: None, arrivals }
    }
}
