//! The models that know one direction only: mirror, metal, hole.

use glam::{Vec2, Vec3};

use super::{Event, Scatter, Shares};
use crate::math::fresnel;
use crate::spectrum::Spectrum;

/// Reflects perfectly, on both sides, the same share under all angles.
#[derive(Clone, Copy, Debug)]
pub struct Mirror {
    /// Share of the light that is reflected, 0 to 1.
    pub reflectance: Spectrum,
}

/// A smooth metal (theory §3.3).
#[derive(Clone, Copy, Debug)]
pub struct Conductor {
    /// Real part of the index of refraction.
    pub eta: Spectrum,
    /// Imaginary part of the index of refraction.
    pub k: Spectrum,
    /// Tint, 0 to 1.
    pub reflectance: Spectrum,
}

/// Where there is no surface: light passes straight through.
#[derive(Clone, Copy, Debug)]
pub struct Hole;

impl Mirror {
    fn share(&self, _: Vec3) -> (Event, Spectrum) {
        (Event::Specular, self.reflectance)
    }
}

impl Conductor {
    fn share(&self, to_previous: Vec3) -> (Event, Spectrum) {
        let ([er, eg, eb], [kr, kg, kb]) = (self.eta.to_rgb(), self.k.to_rgb());
        let reflected = [(er, kr), (eg, kg), (eb, kb)].map(|(eta, k)| fresnel::conductor(to_previous.z, eta, k));
        (Event::Specular, Spectrum::from_rgb(reflected) * self.reflectance)
    }
}

impl Hole {
    fn share(&self, _: Vec3) -> (Event, Spectrum) {
        (Event::Refraction, Spectrum::ONE)
    }
}

/// A model of this file as what it does: all its light in one event, and nothing to gather.
macro_rules! one_direction {
    ($model:ty, $direction:expr) => {
        impl Scatter for $model {
            fn shares(&self, to_previous: Vec3) -> Shares {
                let mut shares = [Spectrum::ZERO; 4];
                let (event, share) = self.share(to_previous);
                shares[event.index()] = share;
                shares
            }

            fn eval(&self, _: Vec3, _: Vec3) -> Spectrum {
                Spectrum::ZERO
            }

            fn even(&self, _: Vec3) -> Option<Spectrum> {
                Some(Spectrum::ZERO)
            }

            fn pdf(&self, _: Event, _: Vec3, _: Vec3) -> f32 {
                0.0
            }

            fn sample(&self, _: Event, to_previous: Vec3, _: Vec2) -> Option<(Vec3, f32)> {
                Some(($direction(to_previous), 1.0))
            }
        }
    };
}

one_direction!(Mirror, fresnel::reflect);
one_direction!(Conductor, fresnel::reflect);
one_direction!(Hole, |to_previous: Vec3| -to_previous);
