//! A round disk in the sky, such as the sun.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::{Far, World};
use crate::math::{Frame, warp};
use crate::spectrum::Spectrum;

/// The same radiance from all directions within a cone, infinitely far away.
#[derive(Clone, Copy, Debug)]
pub struct SkyDisk {
    /// Towards the middle of the disk.
    toward: Frame,
    radiance: Spectrum,
    /// Twice the square of the sine of half the angle between axis and edge: 1 minus their cosine, without its rounding.
    height: f32,
    world: World,
}

impl SkyDisk {
    /// The disk whose middle lies `toward` there, whose edge is `half_angle` away from it (radians, at most π/2), and
    /// which casts `irradiance` (W/m²) on a surface that faces it.
    pub fn new(toward: Vec3, half_angle: f32, irradiance: Spectrum, world: World) -> SkyDisk {
        let sine = half_angle.sin();
        let height = 2.0 * (0.5 * half_angle).sin().powi(2);
        SkyDisk { toward: Frame::around(toward), radiance: irradiance / (PI * sine * sine), height, world }
    }

    fn solid_angle(&self) -> f32 {
        TAU * self.height
    }
}

impl Far for SkyDisk {
    fn sample(&self, u: Vec2) -> Option<(Vec3, Spectrum, f32)> {
        let toward = self.toward.to_world(warp::cap(u, self.height));
        Some((toward, self.radiance, 1.0 / self.solid_angle()))
    }

    fn world(&self) -> &World {
        &self.world
    }

    fn power(&self) -> Spectrum {
        self.radiance * (self.solid_angle() * self.world.cross_section())
    }

    fn radiance(&self, toward: Vec3) -> Spectrum {
        if self.pdf(toward) > 0.0 { self.radiance } else { Spectrum::ZERO }
    }

    fn pdf(&self, toward: Vec3) -> f32 {
        // 1 - cos is half the square of the chord, which keeps its digits for small angles.
        let inside = 0.5 * (toward - self.toward.normal).length_squared() <= self.height;
        if inside { 1.0 / self.solid_angle() } else { 0.0 }
    }
}
