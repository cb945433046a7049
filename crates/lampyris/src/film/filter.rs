//! Reconstruction filters. A wide one spreads every sample over the pixels around it, so that each pixel is the mean of
//! many samples; a narrow one chooses where in a pixel the samples lie, and they count for that pixel alone
//! [Ernst et al. 2006, "Filter importance sampling"].

use std::f32::consts::{PI, TAU};

use glam::Vec2;

use crate::scene::description::{FilmDescription, FilterDescription as Filter};

impl Filter {
    /// Where a sample of a pixel lies, in pixels from its centre.
    pub fn place(&self, u: Vec2) -> Vec2 {
        if self.spreads() { u - 0.5 } else { self.sample(u) }
    }

    /// Whether samples are spread over pixels: where that makes the variance of a pixel less, as the filter squared has an
    /// integral below 1.
    pub fn spreads(&self) -> bool {
        match *self {
            Filter::Box { radius } => radius > 0.5,
            Filter::Tent { radius } => radius > 2.0 / 3.0,
            Filter::Gaussian { stddev } => 4.0 * PI * stddev * stddev > 1.0,
        }
    }

    /// Over how many pixels in each direction a point of a pixel can be spread.
    pub fn reach(&self) -> u32 {
        (self.radius() - 0.5).ceil().max(0.0) as u32
    }

    /// The filter's value, of integral 1 over the plane of pixels, at this offset from its middle.
    pub fn value(&self, offset: Vec2) -> f32 {
        match *self {
            Filter::Box { radius } => {
                let inside = offset.abs().cmple(Vec2::splat(radius)).all();
                if inside { 0.25 / (radius * radius) } else { 0.0 }
            }
            Filter::Tent { radius } => {
                let tents = (1.0 - offset.abs() / radius).max(Vec2::ZERO) / radius;
                tents.x * tents.y
            }
            Filter::Gaussian { stddev } => {
                let half2 = 0.5 * offset.length_squared() / (stddev * stddev);
                if half2 < HALF_CUT2 { (-half2).exp() / (TAU * stddev * stddev * kept()) } else { 0.0 }
            }
        }
    }

    /// Offset in pixels from the centre of a pixel, distributed like the filter.
    fn sample(&self, u: Vec2) -> Vec2 {
        match *self {
            Filter::Box { radius } => (2.0 * u - 1.0) * radius,
            Filter::Tent { radius } => Vec2::new(tent(u.x), tent(u.y)) * radius,
            Filter::Gaussian { stddev } => {
                let radius = (-2.0 * (1.0 - u.x * kept()).ln()).sqrt();
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

    /// The pixels that light at a point of the picture belongs to, by number, each with the share it takes, which are 1
    /// together but for what lies outside.
    pub fn pixels_at(&self, at: Vec2) -> impl Iterator<Item = (u32, f32)> {
        let reach = self.filter.reach() as f32;
        let [width, height] = self.size.map(|side| side as f32);
        let middle = at.floor();
        // What lies far outside, or is not even a number, has no pixels.
        let first = (middle - reach).max(Vec2::ZERO).as_uvec2();
        let last = (middle + reach + 1.0).min(Vec2::new(width, height)).max(Vec2::ZERO).as_uvec2();
        let last = if at.is_nan() { first } else { last };
        (first.y..last.y).flat_map(move |y| (first.x..last.x).map(move |x| (x, y))).filter_map(move |(x, y)| {
            let share = self.filter.value(Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - at);
            (share > 0.0).then_some((y * self.size[0] + x, share))
        })
    }
}

/// Half the squared number of standard deviations at which the Gaussian is cut.
const HALF_CUT2: f32 = 0.5 * Filter::GAUSSIAN_CUT * Filter::GAUSSIAN_CUT;

/// The share of a Gaussian that is not cut.
fn kept() -> f32 {
    1.0 - (-HALF_CUT2).exp()
}

/// Distributed like 1 - |x| on -1..1.
fn tent(u: f32) -> f32 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::Sampler;

    const FILTERS: [Filter; 6] = [
        Filter::Box { radius: 0.5 },
        Filter::Box { radius: 1.3 },
        Filter::Tent { radius: 0.5 },
        Filter::Tent { radius: 1.0 },
        Filter::Gaussian { stddev: 0.2 },
        Filter::Gaussian { stddev: 0.6 },
    ];

    #[test]
    fn light_is_shared_out_among_pixels_and_none_is_lost() {
        for filter in FILTERS {
            let film = FilmDescription { size: [12, 12], filter, time: None };
            // Over all places in a pixel in the middle: every pixel gets its integral, and together they get 1.
            let (n, mut sum) = (64, 0.0);
            for (x, y) in (0..n * n).map(|i| ((i % n) as f32 + 0.5, (i / n) as f32 + 0.5)) {
                let at = Vec2::new(6.0, 6.0) + Vec2::new(x, y) / n as f32;
                sum += film.pixels_at(at).map(|(_, share)| f64::from(share)).sum::<f64>();
            }
            let mean = sum / f64::from(n * n);
            assert!((mean - 1.0).abs() < 0.02, "{filter:?}: {mean}");
        }
    }

    #[test]
    fn light_outside_reaches_pixels_at_the_edge_alone() {
        let film = |filter| FilmDescription { size: [3, 2], filter, time: None };
        let pixels = |filter, x, y| film(filter).pixels_at(Vec2::new(x, y)).map(|(pixel, _)| pixel).collect::<Vec<_>>();
        let (tent, pixel) = (Filter::Tent { radius: 1.0 }, Filter::Box { radius: 0.5 });
        assert_eq!(pixels(tent, -0.3, 0.6), [0, 3]);
        assert_eq!(pixels(tent, 3.2, 1.9), [5]);
        assert_eq!(pixels(pixel, 1.2, 1.7), [4]);
        for (x, y) in [(-0.6, 1.0), (3.6, 0.0), (1.0, 1e30), (f32::NEG_INFINITY, 0.0), (f32::NAN, 1.0)] {
            assert!(pixels(tent, x, y).is_empty(), "{x}, {y}");
        }
    }

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
