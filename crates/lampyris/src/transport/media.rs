//! What a walk does between surfaces (theory §9.1).

use glam::Vec3;

use crate::geometry::Ray;
use crate::material::Event;
use crate::medium::{Flight, Matter, Phase};
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

use super::PathState;

/// How a walk goes through media.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossing {
    /// As a photon does: until it meets a particle, by chance.
    Collide,
    /// As a look does that gathers on its way: to the next surface, and it fades.
    Fade,
}

/// A point in a medium that a path has reached.
#[derive(Clone, Copy, Debug)]
pub struct MediumPoint<'m> {
    /// Where.
    pub position: Vec3,
    /// Back along the path, unit length.
    pub to_previous: Vec3,
    /// Along the segment that led here, scene units.
    pub distance: f32,
    /// The share of the light that is scattered here.
    pub albedo: Spectrum,
    /// The medium.
    pub matter: Matter<'m>,
    /// By how much the particle holds back the light that it scatters, as an optical path length in scene units; the path's
    /// own has it already.
    pub delay: f64,
}

impl MediumPoint<'_> {
    /// The value of the phase function in 1/sr for light that comes from, or leaves in, this direction (unit length); also
    /// the density per solid angle with which the walk goes on there.
    #[inline]
    pub fn value(&self, to_next: Vec3) -> f32 {
        self.phase().value(-self.to_previous.dot(to_next))
    }

    /// The phase function.
    #[inline]
    pub fn phase(&self) -> &Phase {
        self.matter.phase
    }

    /// A direction in which the path goes on.
    pub(super) fn sample(&self, sampler: &mut Sampler) -> Vec3 {
        let choice = sampler.uniform();
        self.phase().sample(-self.to_previous, choice, sampler.square())
    }
}

/// A segment of a path through a medium.
#[derive(Clone, Copy, Debug)]
pub struct Segment<'m> {
    /// Where it begins and goes.
    pub ray: Ray,
    /// Its length in scene units, to the collision or surface at its end; infinite if there is none.
    pub length: f32,
    /// The medium.
    pub matter: Matter<'m>,
}

impl PathState {
    /// Flies to the next surface, which is at this distance, or collides on the way. Returns the point of the collision.
    pub(super) fn fly<'m>(
        &mut self,
        matter: Matter<'m>,
        distance: f32,
        sampler: &mut Sampler,
    ) -> Option<MediumPoint<'m>> {
        match matter.fly(&self.ray, self.throughput, distance, sampler) {
            Flight::Through { weight } => {
                self.throughput = self.throughput * weight;
                None
            }
            Flight::Collided { distance, weight, albedo } => {
                self.throughput = self.throughput * weight;
                self.optical_length += f64::from(self.slowness * distance);
                self.cone = self.cone.after(distance);
                let (position, to_previous) = (self.ray.at(distance), -self.ray.direction);
                let delay = matter.delay(|| sampler.aside().uniform([self.bounce, 0]));
                self.optical_length += delay;
                Some(MediumPoint { position, to_previous, distance, albedo, matter, delay })
            }
        }
    }

    /// Leaves a particle in this direction.
    pub(super) fn scatter(&mut self, point: &MediumPoint, to_next: Vec3) {
        self.throughput = self.throughput * point.albedo;
        self.cone = self.cone.scattered();
        self.ray = Ray { origin: point.position, direction: to_next };
        self.bounce += 1;
        self.history = self.history | Event::Scatter.into();
    }
}
