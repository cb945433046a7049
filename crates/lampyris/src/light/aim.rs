//! Photons that are aimed: rays of a light towards a part of the scene.

use std::f32::consts::{FRAC_1_PI, TAU};

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use super::{Emission, Source, World};
use crate::geometry::{Ray, Surfaces};
use crate::math::{Frame, warp};
use crate::sampler::Sampler;

/// A ball that photons are aimed at.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Focus {
    /// Its centre.
    pub center: Vec3,
    /// Its radius in scene units.
    pub radius: f32,
}

/// Rays that have their beginning or their direction in common and are spread by some measure, as images of the unit
/// square.
#[derive(Clone, Copy, Debug)]
pub enum Section {
    /// From a point, even in solid angle, over a cap of all directions.
    Cap {
        /// The point.
        origin: Vec3,
        /// Around the middle of the cap.
        axis: Frame,
        /// 1 minus the cosine at its edge.
        height: f32,
    },
    /// From a point, by the cosine to a normal.
    Hemisphere {
        /// The point.
        origin: Vec3,
        /// Around the normal.
        axis: Frame,
        /// The probability of this side of the surface.
        side: f32,
    },
    /// Parallel, even over a disk across them.
    Disk {
        /// Around their direction.
        direction: Frame,
        /// The middle of the disk.
        center: Vec3,
        /// Radius of the disk.
        radius: f32,
        /// What they start in front of.
        world: World,
    },
}

/// What a light chooses of a photon first: one of its sections.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// All rays that can still become of it.
    pub section: Section,
    /// What the photon comes from.
    pub source: Source,
}

/// A light whose photons can be aimed.
pub trait Aim {
    /// The first choice. None if this draw has no light.
    fn start(&self, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Start>;

    /// The photon of this start on this ray, with the density and the flux that it has if the ray is drawn from
    /// [`Start::section`]. None if there is no light on it.
    fn send(&self, surfaces: &Surfaces, start: &Start, ray: Ray) -> Option<Emission>;

    /// The section of [`Aim::start`] that a ray belongs to, where `normal` is that of the light's surface where the ray
    /// leaves it.
    fn section(&self, ray: &Ray, normal: Vec3) -> Section;
}

/// A photon that is not aimed at anything: [`Emit::emit`](super::Emit::emit) for lights that can.
pub(super) fn evenly(light: &impl Aim, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Emission> {
    let start = light.start(surfaces, sampler)?;
    light.send(surfaces, &start, start.section.ray(sampler.square()))
}

impl Section {
    /// Those rays through a focus that belong to the same light; all, where the focus cannot be told apart.
    pub(super) fn toward(&self, focus: &Focus) -> Section {
        match *self {
            Section::Cap { origin, .. } | Section::Hemisphere { origin, .. } => {
                let to = focus.center - origin;
                let sin2 = focus.radius * focus.radius / to.length_squared();
                match to.try_normalize() {
                    Some(axis) if sin2 < 1.0 => {
                        let height = sin2 / (1.0 + (1.0 - sin2).sqrt());
                        Section::Cap { origin, axis: Frame::around(axis), height }
                    }
                    _ => *self,
                }
            }
            Section::Disk { direction, world, .. } => {
                Section::Disk { direction, center: focus.center, radius: focus.radius, world }
            }
        }
    }

    /// The ray that a point of the square stands for.
    pub fn ray(&self, u: Vec2) -> Ray {
        match self {
            Section::Cap { origin, axis, height } => {
                Ray { origin: *origin, direction: axis.to_world(warp::cap(u, *height)).normalize() }
            }
            Section::Hemisphere { origin, axis, .. } => {
                Ray { origin: *origin, direction: axis.to_world(warp::cosine_hemisphere(u)) }
            }
            Section::Disk { direction, center, radius, world } => {
                world.entry(direction.normal, center + direction.to_world(warp::disk(u).extend(0.0)) * *radius)
            }
        }
    }

    /// The point of the square that stands for a ray; none if it is not one of them.
    pub fn place(&self, ray: &Ray) -> Option<Vec2> {
        match self {
            Section::Cap { axis, height, .. } => warp::cap_inverse(axis.to_local(ray.direction), *height),
            Section::Hemisphere { axis, .. } => warp::cosine_hemisphere_inverse(axis.to_local(ray.direction)),
            Section::Disk { direction, center, radius, .. } => {
                let across = direction.to_local(ray.origin - *center).truncate() / *radius;
                (across.length_squared() <= 1.0).then(|| warp::disk_inverse(across))
            }
        }
    }

    /// Density of a ray of the section, drawn from the even square: per solid angle, or of parallel ones per area across.
    pub fn density(&self, ray: &Ray) -> f32 {
        match self {
            Section::Cap { height, .. } => 1.0 / (TAU * height),
            Section::Hemisphere { axis, side, .. } => side * axis.normal.dot(ray.direction).max(0.0) * FRAC_1_PI,
            Section::Disk { radius, .. } => FRAC_1_PI / (radius * radius),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_ray_of_a_section_leads_back_to_its_point_of_the_square() {
        let origin = Vec3::new(0.3, -2.0, 5.0);
        let axis = Frame::around(Vec3::new(0.6, -0.8, 0.0));
        let world = World { center: Vec3::ONE, radius: 30.0 };
        let all = [
            Section::Cap { origin, axis, height: 2.0 },
            Section::Hemisphere { origin, axis, side: 1.0 },
            world.rays(axis),
        ];
        let foci = [(Vec3::new(4.0, -1.0, 3.0), 0.5), (Vec3::new(0.5, -2.0, 4.0), 0.01), (origin, 1.0)];
        let aimed =
            all.iter().flat_map(|section| foci.map(|(center, radius)| section.toward(&Focus { center, radius })));
        let mut sampler = Sampler::new(1, 0, 0, 0);
        for section in all.into_iter().chain(aimed) {
            for _ in 0..100 {
                let u = Vec2::splat(0.01) + 0.98 * sampler.square();
                let ray = section.ray(u);
                let back = section.place(&ray).expect("one of its rays");
                assert!((back - u).length() < 2e-3, "{section:?}: {u} {back}");
            }
        }
    }

    #[test]
    fn rays_towards_a_focus_meet_it() {
        let focus = Focus { center: Vec3::new(4.0, -1.0, 3.0), radius: 0.5 };
        let world = World { center: Vec3::ONE, radius: 30.0 };
        let axis = Frame::around(Vec3::X);
        for section in [Section::Cap { origin: Vec3::ZERO, axis, height: 2.0 }, world.rays(axis)] {
            for u in [Vec2::ZERO, Vec2::new(0.5, 0.02), Vec2::new(0.3, 0.7)] {
                let ray = section.toward(&focus).ray(u);
                let to = focus.center - ray.origin;
                let across = (to - ray.direction * to.dot(ray.direction)).length();
                assert!(across <= 0.5005, "{section:?}, {u}: {across}");
            }
        }
    }
}
