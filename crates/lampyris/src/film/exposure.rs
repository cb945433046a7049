//! What a pass brings to the film.

use rayon::prelude::*;

use crate::image::Image;
use crate::transient::Met;

/// A pass: its picture, and the features of its pixels if layers were asked for and the pass has them.
#[derive(Clone, Debug)]
pub struct Exposure {
    /// Linear radiance: the sum of the samples of each pixel, times what they weigh, over how many there are.
    pub image: Image,
    /// Of each pixel, row by row, or none at all.
    pub features: Vec<Features>,
    /// What the samples of a pixel weigh on average, which is 1 on average over passes; empty where it is 1 in each. A
    /// [`Film`](super::Film) divides by its mean, which takes away the noise that the weights have of themselves.
    pub weights: Vec<f32>,
    /// Camera samples of each pixel.
    pub samples: u32,
    /// The number of the pass, and the area over which it gathers photons, that of pass 0 being 1; none where it does not
    /// shrink from pass to pass. By it the [bias](super::Film::bias) is told.
    pub area: Option<(u32, f64)>,
    /// The light of the picture once more, by the time at which it arrived, where the film has time: in the order of pixels
    /// and slots, each pair once.
    pub arrivals: Vec<Arrival>,
}

/// Light that arrives at a pixel within one time bin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// The number of the pixel, row by row.
    pub pixel: u32,
    /// Its [slot](super::Clock::note) in time.
    pub slot: u32,
    /// Linear radiance in RGB, as in [`Exposure::image`].
    pub light: [f32; 3],
}

impl From<Image> for Exposure {
    fn from(image: Image) -> Exposure {
        Exposure { image, features: Vec::new(), weights: Vec::new(), samples: 0, area: None, arrivals: Vec::new() }
    }
}

impl Exposure {
    /// Adds radiance in linear RGB to a pixel, of light that has met this.
    pub fn add(&mut self, pixel: usize, light: [f32; 3], met: Met) {
        let add = |sum: &mut [f32; 3]| *sum = [0, 1, 2].map(|channel| sum[channel] + light[channel]);
        add(&mut self.image.pixels_mut()[pixel]);
        let Some(features) = self.features.get_mut(pixel) else { return };
        if met.events == 1 {
            add(&mut features.direct);
        }
        if met.is_caustic {
            add(&mut features.caustic);
        }
    }

    /// Adds arrivals in any order, whose order among those of the same pixel and slot decides about the last bit.
    pub fn add_arrivals(&mut self, arrivals: impl IntoIterator<Item = Arrival>) {
        self.arrivals.extend(arrivals);
        self.arrivals.par_sort_by_key(|arrival| (arrival.pixel, arrival.slot));
        self.arrivals.dedup_by(|next, sum| {
            let is_same = (next.pixel, next.slot) == (sum.pixel, sum.slot);
            if is_same {
                sum.light = [0, 1, 2].map(|channel| sum.light[channel] + next.light[channel]);
            }
            is_same
        });
    }
}

/// What the layers of a pixel are made of: means over all samples of a pass, weighted as its picture. Samples that meet
/// nothing count as 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Features {
    /// Radiance of lamps and surroundings in plain sight.
    pub emission: [f32; 3],
    /// Radiance of light scattered once.
    pub direct: [f32; 3],
    /// Radiance of light that mirrors and glass brought from a lamp to a smooth surface.
    pub caustic: [f32; 3],
    /// Share of the light that is not absorbed by the first surface with a smooth lobe, nor before it.
    pub albedo: [f32; 3],
    /// Its shading normal, in world coordinates.
    pub normal: [f32; 3],
    /// Where it is, in world coordinates.
    pub position: [f32; 3],
    /// How long the way to it is.
    pub depth: f32,
    /// Share of the samples that meet one.
    pub met: f32,
}
