//! Phase functions: where light goes that a particle scatters (theory §9.2).
//!
//! All are normalised over the sphere and drawn from exactly, so that the value is the density, too. The angle is that
//! between the direction of travel before and after: its cosine is 1 forward.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use glam::{Vec2, Vec3};

use crate::math::{Distribution, Frame, ONE_MINUS_EPSILON, warp};

/// The closed set of phase functions.
#[derive(Clone, Debug)]
pub enum Phase {
    /// The same in all directions.
    Isotropic,
    /// Of one parameter, the mean cosine g, between −1 (backward) and 1 (forward) [Henyey & Greenstein 1941].
    HenyeyGreenstein {
        /// The mean cosine.
        g: f32,
    },
    /// Of particles much smaller than the wavelength.
    Rayleigh,
    /// Any, by a table.
    Tabulated(Arc<Table>),
    /// Two, of which the second has this share.
    Blend {
        /// The share of the second, 0 to 1.
        weight: f32,
        /// Both.
        of: Arc<[Phase; 2]>,
    },
}

impl Phase {
    /// The share of the scattered light in 1/sr at this cosine; also the density of [`Phase::sample`] per solid angle.
    pub fn value(&self, cos: f32) -> f32 {
        match self {
            Phase::Isotropic => 1.0 / (4.0 * PI),
            Phase::HenyeyGreenstein { g } => {
                let base = 1.0 + g * g - 2.0 * g * cos;
                (1.0 - g * g) / (4.0 * PI * base * base.sqrt())
            }
            Phase::Rayleigh => 3.0 / (16.0 * PI) * (1.0 + cos * cos),
            Phase::Tabulated(table) => table.value(cos),
            Phase::Blend { weight, of } => (1.0 - weight) * of[0].value(cos) + weight * of[1].value(cos),
        }
    }

    /// A direction for light that travels in the direction `travel` (unit length), by three numbers uniform in 0..1.
    pub fn sample(&self, travel: Vec3, choice: f32, u: Vec2) -> Vec3 {
        if let Phase::Isotropic = self {
            return warp::sphere(u);
        }
        let cos = self.sample_cos(choice, u.x);
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (y, x) = (TAU * u.y).sin_cos();
        Frame::around(travel).to_world(Vec3::new(sin * x, sin * y, cos))
    }

    fn sample_cos(&self, choice: f32, u: f32) -> f32 {
        match self {
            Phase::Isotropic => 1.0 - 2.0 * u,
            Phase::HenyeyGreenstein { g } if g.abs() < 1e-3 => 2.0 * u - 1.0 + 6.0 * g * u * (1.0 - u),
            Phase::HenyeyGreenstein { g } => {
                let ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
                ((1.0 + g * g - ratio * ratio) / (2.0 * g)).clamp(-1.0, 1.0)
            }
            // The root of x³ + 3x = 8u − 4, by Cardano's formula.
            Phase::Rayleigh => {
                let half = 4.0 * u - 2.0;
                let root = (half + (half * half + 1.0).sqrt()).cbrt();
                (root - 1.0 / root).clamp(-1.0, 1.0)
            }
            Phase::Tabulated(table) => table.sample(u),
            Phase::Blend { weight, of } => {
                let (which, rest) =
                    if choice < *weight { (1, choice / weight) } else { (0, (choice - weight) / (1.0 - weight)) };
                of[which].sample_cos(rest.clamp(0.0, ONE_MINUS_EPSILON), u)
            }
        }
    }
}

/// Values at cosines evenly from −1 to 1, linear between them, and normalised over the sphere.
#[derive(Clone, Debug)]
pub struct Table {
    values: Vec<f32>,
    cells: Distribution,
}

impl Table {
    /// From values of any scale; none if there are fewer than two, one is negative or not finite, or all are zero.
    pub fn new(values: &[f32]) -> Option<Table> {
        let good = values.iter().all(|value| value.is_finite() && *value >= 0.0);
        let cells: Vec<f64> = values.windows(2).map(|pair| 0.5 * (f64::from(pair[0]) + f64::from(pair[1]))).collect();
        let sum: f64 = cells.iter().sum();
        if !good || cells.is_empty() || sum <= 0.0 {
            return None;
        }
        let integral = std::f64::consts::TAU * sum * 2.0 / cells.len() as f64;
        let values = values.iter().map(|&value| (f64::from(value) / integral) as f32).collect();
        Some(Table { values, cells: Distribution::new(&cells) })
    }

    fn value(&self, cos: f32) -> f32 {
        let cells = self.cells.len();
        let place = 0.5 * (cos + 1.0) * cells as f32;
        let cell = (place.max(0.0) as usize).min(cells - 1);
        let t = (place - cell as f32).clamp(0.0, 1.0);
        self.values[cell] * (1.0 - t) + self.values[cell + 1] * t
    }

    fn sample(&self, u: f32) -> f32 {
        let (cell, _, rest) = self.cells.sample(u);
        let (a, b) = (self.values[cell], self.values[cell + 1]);
        // The root of the integral of a line, in the form that loses no digits.
        let t = rest * (a + b) / (a + (a * a * (1.0 - rest) + b * b * rest).sqrt()).max(f32::MIN_POSITIVE);
        (2.0 * (cell as f32 + t.min(1.0)) / self.cells.len() as f32 - 1.0).clamp(-1.0, 1.0)
    }
}
