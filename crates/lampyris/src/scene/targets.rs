//! Hidden geometry: what paths that leave a relay wall are aimed at (theory §8.1).

use super::{Scene, SurfacePoint};
use crate::geometry::{Ray, Surface};
use crate::material::{Event, Lobes, Scattered};
use crate::math::Distribution;
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

use glam::Vec3;

/// All shapes of finite size beside a wall, by their area.
#[derive(Debug)]
pub(super) struct Targets {
    /// The number of the wall.
    wall: u32,
    /// Which shape, by its number.
    choice: Distribution,
    /// Density of a point of each shape per area: as the choice has it, which rounds the shares of small shapes.
    densities: Vec<f32>,
}

/// The share of paths that are aimed.
const AIMED: f32 = 0.5;

impl Targets {
    /// None if there is nothing beside the wall. Shapes of groups are no targets.
    fn new(scene: &Scene, wall: u32) -> Option<Targets> {
        let mut areas = vec![0.0; scene.shapes.len()];
        for (shape, instance) in scene.surfaces.places() {
            if instance.is_none() && shape != wall {
                areas[shape as usize] = f64::from(scene.surfaces.area(shape));
            }
        }
        if areas.iter().all(|&area| area <= 0.0) {
            return None;
        }
        let choice = Distribution::new(&areas);
        let density =
            |(shape, &area): (usize, &f64)| if area > 0.0 { choice.probability(shape) / area as f32 } else { 0.0 };
        let densities = areas.iter().enumerate().map(density).collect();
        Some(Targets { wall, choice, densities })
    }

    /// Density per solid angle, at a point at this distance, of a point of a shape.
    fn density(&self, shape: u32, surface: &Surface, to_next: Vec3, distance: f32) -> f32 {
        let cos = surface.normal.dot(to_next).abs();
        let density = self.densities[shape as usize] * distance * distance / cos;
        if density.is_finite() { density } else { 0.0 }
    }
}

impl Scene {
    /// Lets paths that leave the wall of this number be aimed at all that is not the wall.
    pub(super) fn set_targets(&mut self, wall: u32) {
        self.targets = Targets::new(self, wall).map(std::sync::Arc::new);
    }

    /// A direction (world) in which a path goes on by one of these lobes: as the material says, or, where paths are aimed,
    /// by one-sample multiple importance sampling of both [Veach & Guibas 1995, balance heuristic].
    #[inline]
    pub fn scatter(&self, point: &SurfacePoint, follow: Lobes, sampler: &mut Sampler) -> Option<Scattered> {
        match &self.targets {
            Some(targets) if targets.wall == point.shape => self.scatter_aimed(targets, point, follow, sampler),
            _ => point.sample(follow, sampler),
        }
    }

    /// The density per solid angle with which [`Scene::scatter`] by all lobes leads there (world).
    #[inline]
    pub fn scattering_pdf(&self, point: &SurfacePoint, to_next: Vec3) -> f32 {
        let own = point.pdf(to_next, Lobes::ALL);
        match &self.targets {
            Some(targets) if targets.wall == point.shape => {
                mixed(own, self.aimed_pdf(targets, &point.surface.spawn(to_next)))
            }
            _ => own,
        }
    }

    #[inline(never)]
    fn scatter_aimed(
        &self,
        targets: &Targets,
        point: &SurfacePoint,
        follow: Lobes,
        sampler: &mut Sampler,
    ) -> Option<Scattered> {
        let lobes = point.bsdf.lobes().and(follow);
        if !lobes.meets(Lobes::SMOOTH) {
            return point.sample(follow, sampler);
        }
        let choice = sampler.uniform();
        if choice >= AIMED {
            let scattered = point.sample(follow, sampler)?;
            if !Lobes::SMOOTH.contains(scattered.event) {
                return Some(Scattered { weight: scattered.weight / (1.0 - AIMED), ..scattered });
            }
            let pdf = mixed(scattered.pdf, self.aimed_pdf(targets, &point.surface.spawn(scattered.to_next)));
            return Some(Scattered { weight: scattered.weight * (scattered.pdf / pdf), pdf, ..scattered });
        }
        let (shape, ..) = targets.choice.sample(choice / AIMED);
        let surface = self.surfaces.sample(shape as u32, sampler.square())?;
        let between = surface.position - point.surface.position;
        let to_next = between.try_normalize()?;
        let weight = point.weight(to_next);
        // What stands before the target is found by other draws.
        let is_hidden = || self.surfaces.occluded(point.surface.offset(to_next), surface.offset(-to_next));
        if weight.is_zero() || is_hidden() {
            return None;
        }
        let aimed = targets.density(shape as u32, &surface, to_next, between.length());
        let pdf = mixed(point.pdf(to_next, follow), aimed);
        let event = if lobes.contains(Event::Diffuse) { Event::Diffuse } else { Event::Glossy };
        // The index of a wall that lets light through, too: with group indices it is a little off.
        let slowness = point.slowness_toward(to_next);
        let (weight, ior_ratio) = (weight / pdf, Spectrum::grey(slowness));
        let slot = event.index() as u8;
        (aimed > 0.0).then_some(Scattered { to_next, weight, pdf, event, ior_ratio, slowness, slot })
    }

    /// The density per solid angle with which a path is aimed along a ray: at the first thing there.
    fn aimed_pdf(&self, targets: &Targets, ray: &Ray) -> f32 {
        self.surfaces.closest(ray, f32::INFINITY).filter(|hit| !hit.is_in_instance()).map_or(0.0, |hit| {
            let surface = self.surfaces.surface(ray, &hit);
            targets.density(hit.shape, &surface, ray.direction, hit.distance)
        })
    }
}

/// The density of the mixture of both ways.
fn mixed(own: f32, aimed: f32) -> f32 {
    (1.0 - AIMED) * own + AIMED * aimed
}
