//! The same light from everywhere.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::{Far, World};
use crate::math::warp;
use crate::spectrum::Spectrum;

/// The same radiance from everywhere infinitely far away.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    /// Radiance in W/(m² sr).
    pub radiance: Spectrum,
    /// What the photons must cover.
    pub world: World,
}

/// Density of a direction per solid angle, the same for all.
const PDF: f32 = 1.0 / (4.0 * PI);

impl Far for Constant {
    fn sample(&self, u: Vec2) -> Option<(Vec3, Spectrum, f32)> {
        Some((warp::sphere(u), self.radiance, PDF))
    }

    fn unsample(&self, toward: Vec3) -> Option<Vec2> {
        Some(warp::sphere_inverse(toward))
    }

    fn world(&self) -> &World {
        &self.world
    }

    fn power(&self) -> Spectrum {
        self.radiance * (self.world.cross_section() / PDF)
    }

    fn radiance(&self, _: Vec3) -> Spectrum {
        self.radiance
    }

    fn pdf(&self, _: Vec3) -> f32 {
        PDF
    }
}
