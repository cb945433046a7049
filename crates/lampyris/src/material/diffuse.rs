//! Lambert's reflection.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::{Breadth, Event, Scatter, Shares};
use crate::math::warp;
use crate::spectrum::Spectrum;

/// Reflects equally in all directions, on both sides: f = ρ/π (theory §3.1).
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    /// Share of the light that is reflected, 0 to 1.
    pub reflectance: Spectrum,
}

impl Scatter for Diffuse {
    #[inline]
    fn shares(&self, _: Vec3) -> Shares {
        let mut shares = [Spectrum::ZERO; Event::ALL.len()];
        shares[Event::Diffuse.index()] = self.reflectance;
        shares
    }

    #[inline]
    fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        if same_side(to_previous, to_next) { self.reflectance / PI } else { Spectrum::ZERO }
    }

    #[inline]
    fn even(&self, _: Vec3) -> Option<Spectrum> {
        Some(self.reflectance / PI)
    }

    fn broad(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        self.eval(to_previous, to_next)
    }

    fn breadth(&self) -> Breadth {
        Breadth::Even
    }

    #[inline]
    fn pdf(&self, _: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        pdf(to_previous, to_next)
    }

    #[inline]
    fn sample(&self, _: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)> {
        Some((sample(to_previous, u.truncate()), 1.0))
    }
}

/// Whether both directions lie on one side of the surface.
#[inline]
pub(super) fn same_side(to_previous: Vec3, to_next: Vec3) -> bool {
    to_previous.z * to_next.z > 0.0
}

/// A direction, or its image above the surface.
#[inline]
pub(super) fn above(direction: Vec3) -> Vec3 {
    direction.with_z(direction.z.abs())
}

/// A direction on the side of `to_previous`, with a density proportional to its cosine.
#[inline]
pub(super) fn sample(to_previous: Vec3, u: Vec2) -> Vec3 {
    let up = warp::cosine_hemisphere(u);
    if to_previous.z < 0.0 { -up } else { up }
}

/// The density of [`sample`] per solid angle.
#[inline]
pub(super) fn pdf(to_previous: Vec3, to_next: Vec3) -> f32 {
    if same_side(to_previous, to_next) { warp::cosine_hemisphere_pdf(to_next.z.abs()) } else { 0.0 }
}
