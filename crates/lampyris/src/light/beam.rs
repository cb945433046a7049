//! A beam of parallel light.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Emission, Emit, Illumination};
use crate::geometry::{Ray, Surfaces};
use crate::math::{Frame, warp};
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// Parallel light that leaves a disk, even over it, as from a laser. An infinitely thin beam, of radius 0, is met by no
/// shadow ray: only photons carry its light.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// The middle of the disk.
    pub position: Vec3,
    /// A frame whose normal is where the light goes.
    pub direction: Frame,
    /// Radius of the disk in scene units.
    pub radius: f32,
    /// Flux in W.
    pub power: Spectrum,
}

impl Emit for Beam {
    fn emit(&self, _: &Surfaces, sampler: &mut Sampler) -> Option<Emission> {
        let on_disk = self.direction.to_world(warp::disk(sampler.square()).extend(0.0));
        let ray = Ray { origin: self.position + on_disk * self.radius, direction: self.direction.normal };
        Some(Emission { ray, flux: self.power, hidden: self.radius == 0.0 })
    }

    fn illuminate(&self, _: &Surfaces, at: Vec3, _: &mut Sampler) -> Option<Illumination> {
        let along = (at - self.position).dot(self.direction.normal);
        let start = at - self.direction.normal * along;
        let inside = along > 0.0 && start.distance_squared(self.position) < self.radius * self.radius;
        inside.then(|| Illumination {
            to_light: -self.direction.normal,
            target: Some(start),
            irradiance: self.power / (PI * self.radius * self.radius),
            pdf: None,
        })
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.power
    }
}
