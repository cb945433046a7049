//! What the sums of a film tell of light by time.

use super::{Clock, Film, luminance_of};
use crate::error::{Error, Result};
use crate::image::luminance;
use crate::transient::{Phasors, TimeLayer, Transient};

impl Film {
    /// The mean over the passes of what arrived at a pixel, counted row by row, within each time bin: linear radiance, of
    /// which the picture is the sum over all time. Empty without time.
    pub fn bins(&self, pixel: usize) -> Vec<[f32; 3]> {
        self.bins_from(pixel, 0)
    }

    /// [`Film::bins`] of a layer, or of all light if none is named.
    ///
    /// # Errors
    /// A film without time bins or without this layer in time.
    pub fn bins_of(&self, pixel: usize, layer: Option<TimeLayer>) -> Result<Vec<[f32; 3]>> {
        Ok(self.bins_from(pixel, first_slot(self.clock_of_bins()?, layer)?))
    }

    fn bins_from(&self, pixel: usize, first: usize) -> Vec<[f32; 3]> {
        let Some(bins) = &self.bins else { return Vec::new() };
        let (weight, slots) = (self.weight(pixel), first + 1..=first + bins.clock().bins());
        slots.map(|slot| bins.sum(pixel, slot).map(|sum| (sum / weight) as f32)).collect()
    }

    fn clock_of_bins(&self) -> Result<&Clock> {
        let clock = self.clock().filter(|clock| !clock.is_dense());
        clock.ok_or_else(|| Error::new("the film has no time bins"))
    }

    /// [`Film::bins`] of all pixels; of a layer, or of all light if none is named. It is a copy in memory.
    ///
    /// # Errors
    /// A film without time or without this layer in time, or bins that are too many.
    pub fn transient(&self, layer: Option<TimeLayer>) -> Result<Transient> {
        let clock = self.clock_of_bins()?;
        let mut transient = Transient::new(self.width, self.height, clock.bins(), clock.timing())?;
        for (pixel, profile) in transient.profiles_mut().enumerate() {
            profile.copy_from_slice(&self.bins_of(pixel, layer)?);
        }
        match self.capture() {
            Some(capture) => transient.with_capture(capture.clone()),
            None => Ok(transient),
        }
    }

    /// The mean over the passes of the complex amplitudes of a pixel, real and imaginary part of each frequency: linear
    /// radiance times exp(-2πi f (s - start)). Of a layer, or of all light if none is named.
    ///
    /// # Errors
    /// A film without amplitudes or without this layer in time.
    pub fn amplitudes(&self, pixel: usize, layer: Option<TimeLayer>) -> Result<Vec<[[f32; 3]; 2]>> {
        let none = || Error::new("the film has no amplitudes");
        let bins = self.bins.as_ref().filter(|bins| bins.clock().is_dense()).ok_or_else(none)?;
        let (first, weight) = (first_slot(bins.clock(), layer)?, self.weight(pixel));
        let part = |slot: usize| bins.sum(pixel, first + slot).map(|sum| (sum / weight) as f32);
        Ok((0..bins.clock().frequencies().len()).map(|place| [part(2 * place), part(2 * place + 1)]).collect())
    }

    /// The luminance of [`Film::amplitudes`] of all pixels.
    ///
    /// # Errors
    /// As there.
    pub fn phasors(&self, layer: Option<TimeLayer>) -> Result<Phasors> {
        let mut values = Vec::new();
        for pixel in 0..self.width * self.height {
            values.extend(self.amplitudes(pixel, layer)?.into_iter().flatten().map(luminance));
        }
        let (frequencies, start) = self.clock().map(|clock| (clock.frequencies(), clock.start())).unwrap_or_default();
        Ok(Phasors { width: self.width, height: self.height, frequencies, start, values })
    }

    /// The mean over the passes of what arrived at a pixel before the first time bin, and after the last. None without
    /// time.
    pub fn outside_bins(&self, pixel: usize) -> Option<[[f32; 3]; 2]> {
        let (bins, weight) = (self.bins.as_ref().filter(|bins| !bins.clock().is_dense())?, self.weight(pixel));
        Some([0, bins.clock().bins() + 1].map(|slot| bins.sum(pixel, slot).map(|sum| (sum / weight) as f32)))
    }

    /// The variance of the luminance of [`Film::bins`], as the differences between passes tell it; what the weights of the
    /// passes do to it is left out, so that it may be too large where samples are spread. None before the second pass, or
    /// where it is not kept.
    pub fn variance_of_bins(&self, pixel: usize) -> Option<Vec<f32>> {
        let (bins, weight, n) = (self.bins.as_ref()?, self.weight(pixel), f64::from(self.passes));
        if self.passes < 2 {
            return None;
        }
        let variance = |slot: usize| {
            let sum = luminance_of(bins.sum(pixel, slot).map(|sum| sum as f32));
            let squares = (bins.square(pixel, slot)? - sum * sum / n).max(0.0);
            Some((squares * n / (weight * weight * (n - 1.0))) as f32)
        };
        (1..=bins.clock().bins()).map(variance).collect()
    }

    /// The shares of all light that arrived before the first time bin, and after the last. None without time or light.
    pub fn share_outside_bins(&self) -> Option<[f64; 2]> {
        let mut sums = [0.0; 2];
        for pixel in 0..self.width * self.height {
            let outside = self.outside_bins(pixel)?;
            sums.iter_mut().zip(outside).for_each(|(sum, light)| *sum += luminance_of(light));
        }
        let all = self.mean_luminance() * (self.width * self.height) as f64;
        (all > 0.0).then(|| sums.map(|sum| sum / all))
    }
}

fn first_slot(clock: &Clock, layer: Option<TimeLayer>) -> Result<usize> {
    clock.first_slot(layer).ok_or_else(|| {
        let layer = layer.map(|layer| layer.to_string()).unwrap_or_default();
        Error::new(format!("the film has no layer '{layer}' in time"))
    })
}
