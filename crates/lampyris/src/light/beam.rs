//! A beam of parallel light.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Emission, Emit, Illumination, Source, Span};
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

impl Beam {
    /// Density of a photon per area across the beam.
    fn density(&self) -> f32 {
        1.0 / (PI * self.radius * self.radius)
    }
}

impl Emit for Beam {
    fn emit(&self, _: &Surfaces, sampler: &mut Sampler) -> Option<Emission> {
        let on_disk = self.direction.to_world(warp::disk(sampler.square()).extend(0.0));
        let ray = Ray { origin: self.position + on_disk * self.radius, direction: self.direction.normal };
        let source = if self.radius > 0.0 { Source::Parallel } else { Source::Hidden };
        Some(Emission { ray, flux: self.power, source, density: self.density() })
    }

    fn illuminate(&self, _: &Surfaces, at: Vec3, _: &mut Sampler) -> Option<Illumination> {
        let along = (at - self.position).dot(self.direction.normal);
        let start = at - self.direction.normal * along;
        let inside = along > 0.0 && start.distance_squared(self.position) < self.radius * self.radius;
        inside.then(|| Illumination {
            to_light: -self.direction.normal,
            target: Some(start),
            irradiance: self.power * self.density(),
            pdf: None,
            emission: self.density(),
            normal: Vec3::ZERO,
        })
    }

    fn span(&self, ray: &Ray, length: f32) -> Option<Span> {
        Span::whole(length, None).in_cylinder(ray, (self.position, self.direction.normal), self.radius)
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.power
    }
}
