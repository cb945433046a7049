//! Phong's highlight.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::{Breadth, Event, Scatter, Shares, diffuse};
use crate::math::{Frame, fresnel};
use crate::spectrum::Spectrum;

/// A diffuse lobe and a power of the cosine around the mirrored direction [Lafortune & Willems 1994] (theory §3.8). Black
/// from behind.
#[derive(Clone, Copy, Debug)]
pub struct Phong {
    /// Share that is reflected diffusely.
    pub diffuse: Spectrum,
    /// Share that is reflected around the mirrored direction; less at grazing angles.
    pub specular: Spectrum,
    /// The power.
    pub exponent: f32,
}

impl Scatter for Phong {
    fn shares(&self, to_previous: Vec3) -> Shares {
        let mut shares = [Spectrum::ZERO; Event::ALL.len()];
        if to_previous.z > 0.0 {
            shares[Event::Diffuse.index()] = self.diffuse;
            shares[Event::Glossy.index()] = self.specular;
        }
        shares
    }

    fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        if to_previous.z <= 0.0 || to_next.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let cos = fresnel::reflect(to_previous).dot(to_next).max(0.0);
        self.diffuse / PI + self.specular * ((self.exponent + 2.0) / TAU * cos.powf(self.exponent))
    }

    fn even(&self, _: Vec3) -> Option<Spectrum> {
        None
    }

    fn broad(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        if to_previous.z > 0.0 && to_next.z > 0.0 { self.diffuse / PI } else { Spectrum::ZERO }
    }

    fn breadth(&self) -> Breadth {
        Breadth::Even
    }

    fn pdf(&self, event: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        if event == Event::Diffuse {
            return diffuse::pdf(to_previous, to_next);
        }
        if to_previous.z <= 0.0 || to_next.z <= 0.0 {
            return 0.0;
        }
        let cos = fresnel::reflect(to_previous).dot(to_next).max(0.0);
        (self.exponent + 1.0) / TAU * cos.powf(self.exponent)
    }

    fn sample(&self, event: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)> {
        if event == Event::Diffuse {
            return Some((diffuse::sample(to_previous, u.truncate()), 1.0));
        }
        // 1 - u, which is never 0.
        let cos = (1.0 - u.y).powf(1.0 / (self.exponent + 1.0));
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let around = Frame::around(fresnel::reflect(to_previous));
        let to_next = around.to_world((Vec2::from_angle(TAU * u.x) * sin).extend(cos)).normalize();
        (to_next.z > 0.0).then_some((to_next, 1.0))
    }
}
