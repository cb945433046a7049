//! Reconstruction filters, drawn from rather than weighted with: every sample lands in one pixel with weight one, so that
//! pixels are independent of each other [Ernst et al. 2006, "Filter importance sampling"].

use std::f32::consts::TAU;

use glam::Vec2;

use crate::scene::description::{FilmDescription, FilterDescription as Filter};

/// The Gaussian is cut at this many standard deviations.
const GAUSSIAN_CUT: f32 = 4.0;

impl Filter {
    /// Offset in pixels from the centre of a pixel, distributed like the filter.
    pub fn sample(&self, u: Vec2) -> Vec2 {
        match *self {
            Filter::Box { radius } => (2.0 * u - 1.0) * radius,
            Filter::Tent { radius } => Vec2::new(tent(u.x), tent(u.y)) * radius,
            Filter::Gaussian { stddev } => {
                let kept = 1.0 - (-0.5 * GAUSSIAN_CUT * GAUSSIAN_CUT).exp();
                let radius = (-2.0 * (1.0 - u.x * kept).ln()).sqrt();
                Vec2::from_angle(TAU * u.y) * (radius * stddev)
            }
        }
    }
}

impl FilmDescription {
    /// The number of the pixel, row by row, that a point of the picture lies in; none outside.
    pub fn pixel_number(&self, at: Vec2) -> Option<u32> {
        let [width, height] = self.size;
        let inside = at.x >= 0.0 && at.y >= 0.0 && at.x < width as f32 && at.y < height as f32;
        inside.then(|| at.y as u32 * width + at.x as u32)
    }
}

/// Distributed like 1 - |x| on -1..1.
fn tent(u: f32) -> f32 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::Sampler;

    #[test]
    fn offsets_have_the_filters_variance() {
        let mut sampler = Sampler::new(3, 0, 0, 0);
        let n = 100_000;
        // Variance along one axis: box r²/3, tent r²/6, Gaussian σ² less a cut tail of 0.3 %.
        let filters = [
            (Filter::Box { radius: 0.5 }, 1.0 / 12.0),
            (Filter::Tent { radius: 1.0 }, 1.0 / 6.0),
            (Filter::Gaussian { stddev: 0.5 }, 0.25 * (1.0 - 8.0 * (-8.0f32).exp() / (1.0 - (-8.0f32).exp()))),
        ];
        for (filter, expected) in filters {
            let (mut sum, mut squares) = (0.0f64, 0.0f64);
            for _ in 0..n {
                let square = f64::from(filter.sample(sampler.square()).x).powi(2);
                sum += square;
                squares += square * square;
            }
            let mean = sum / f64::from(n);
            let error = 6.0 * ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt(); // false alarm 2e-9
            assert!((mean - f64::from(expected)).abs() < error, "{filter:?}: {mean} is not {expected} ± {error}");
        }
    }
}
