//! The one random walk. Both ends of light call it; what differs is the visitor (theory §4.1).

use glam::Vec3;

use super::{Crossing, MediumPoint, Origin, PathState, Segment, survive};
use crate::light::{Emission, LightId};
use crate::material::{Bsdf, Event, Lobes, Scattered};
use crate::medium::Matter;
use crate::sampler::Sampler;
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;

/// What is done along a path, and where the path may go on.
pub trait Visitor {
    /// How the path goes through media.
    const CROSSING: Crossing = Crossing::Collide;

    /// The path of this number begins with this photon of a light.
    fn emitted(&mut self, _path: u64, _light: LightId, _emission: &Emission) {}

    /// The path has reached a surface. Returns the lobes that the walk may follow from here; [`Lobes::NONE`] ends it.
    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, sampler: &mut Sampler) -> Lobes;

    /// The path is about to go through a medium: so far, to a surface or to where it will collide.
    fn segment(&mut self, _segment: &Segment, _path: &PathState, _sampler: &mut Sampler) {}

    /// The path has met a particle of a medium. Returns whether the walk may go on from here.
    fn medium_vertex(&mut self, _point: &MediumPoint, _path: &PathState, _sampler: &mut Sampler) -> bool {
        true
    }

    /// The path has chosen a direction (world) at a particle; `path` is about to leave it.
    fn scattered_by_particle(&mut self, _to_next: Vec3, _point: &MediumPoint, _path: &PathState) {}

    /// The path has chosen a direction (world) at `point`; `path` is about to leave it.
    fn scattered(&mut self, _scattered: &Scattered, _point: &SurfacePoint, _path: &PathState) {}

    /// The path has chosen an event at `point` that leads nowhere, and ends.
    fn lost(&mut self, _point: &SurfacePoint, _path: &PathState) {}

    /// The path has left the scene.
    fn escaped(&mut self, _path: &PathState) {}

    /// What the rest of the path is worth to the visitor, 0 to 1: with this probability roulette lets it go on, beside
    /// that by its throughput. Asked after [`Visitor::scattered`].
    fn worth(&self) -> f32 {
        1.0
    }
}

/// How long paths may become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Paths are cut after this many scattering events.
    pub max_bounces: u32,
    /// Roulette begins after this many rays: 0 for photons, so that all carry about the same flux; later for paths from
    /// the camera, where the first bounces matter most.
    pub roulette_from: u32,
}

/// How a path ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// It left the scene.
    Escaped,
    /// Roulette, a black surface, or a visitor that follows nothing.
    Absorbed,
    /// [`Limits::max_bounces`] was reached.
    Cut,
}

/// A path that has ended.
#[derive(Clone, Copy, Debug)]
pub struct Walked {
    /// How it ended.
    pub end: End,
    /// In what state.
    pub path: PathState,
    /// Rays that were traced for it.
    pub rays: u32,
}

/// The sampler's steps before it belong to the beginning of a path; each vertex has two: one for what is done there, one
/// for where the path goes on.
const FIRST_STEP: u32 = 2;

/// Follows `path` until it ends, telling `visitor` of every vertex.
pub fn walk<V: Visitor>(
    scene: &Scene,
    mut path: PathState,
    origin: Origin,
    limits: &Limits,
    sampler: &mut Sampler,
    visitor: &mut V,
) -> Walked {
    let reference = path.throughput.max();
    let mut rays = 0;
    let mut bsdf = Bsdf::default();
    loop {
        rays += 1;
        let reached = scene.closest_carrying(&path.ray, path.cone, &path.throughput, &mut bsdf);
        // Counted by rays, not by events: a hole is a vertex, too, whose numbers must not be used again.
        let step = FIRST_STEP + 2 * (rays - 1);
        if let Some(matter) = scene.matter(&path.inside, reached.is_some()) {
            let distance = reached.map_or(f32::INFINITY, |point| point.distance);
            if let Some(point) = cross(&mut path, matter, distance, sampler, visitor) {
                sampler.step(step);
                if !visitor.medium_vertex(&point, &path, sampler) {
                    return Walked { end: End::Absorbed, path, rays };
                }
                if path.bounce >= limits.max_bounces {
                    return Walked { end: End::Cut, path, rays };
                }
                sampler.step(step + 1);
                let to_next = point.sample(sampler);
                visitor.scattered_by_particle(to_next, &point, &path);
                path.scatter(&point, to_next);
                let early = rays <= limits.roulette_from;
                if goes_on(&mut path, origin, reference, visitor.worth(), early, sampler) {
                    continue;
                }
                return Walked { end: End::Absorbed, path, rays };
            }
        }
        let Some(point) = reached else {
            visitor.escaped(&path);
            return Walked { end: End::Escaped, path, rays };
        };
        path.optical_length += f64::from(path.slowness * point.distance);
        sampler.step(step);
        path.cone = path.cone.after(point.distance);
        let mut follow = visitor.vertex(&point, &path, sampler);
        if follow.is_none() {
            return Walked { end: End::Absorbed, path, rays };
        }
        if path.bounce >= limits.max_bounces {
            // What goes through a hole is no event, and never too many.
            follow = follow.and(point.bsdf.lobes()).and(Lobes::HOLES);
            if follow.is_none() {
                return Walked { end: End::Cut, path, rays };
            }
        }
        sampler.step(step + 1);
        let Some(scattered) = scene.scatter(&point, follow, sampler) else {
            visitor.lost(&point, &path);
            return Walked { end: End::Absorbed, path, rays };
        };
        if scattered.event == Event::Pass {
            path.throughput = path.throughput * scattered.weight;
            path.ray = point.surface.spawn(scattered.to_next);
        } else {
            visitor.scattered(&scattered, &point, &path);
            path.turn(&point, &scattered, origin);
        }
        if scene.has_media() {
            scene.cross(&point, scattered.to_next, &mut path.inside);
        }
        // A hole is no event, but it may absorb.
        let worth = if scattered.event == Event::Pass { 1.0 } else { visitor.worth() };
        if !goes_on(&mut path, origin, reference, worth, rays <= limits.roulette_from, sampler) {
            return Walked { end: End::Absorbed, path, rays };
        }
    }
}

/// Goes through a medium to the surface at this distance. Returns the point where the path collides before, if it does.
#[inline(never)]
fn cross<'m, V: Visitor>(
    path: &mut PathState,
    matter: Matter<'m>,
    distance: f32,
    sampler: &mut Sampler,
    visitor: &mut V,
) -> Option<MediumPoint<'m>> {
    let start = *path;
    let point = match V::CROSSING {
        // Where nothing is scattered, there is nothing to collide for.
        Crossing::Collide if !matter.scattering.is_zero() => path.fly(matter, distance, sampler),
        _ => {
            path.throughput = path.throughput * matter.transmittance(&path.ray, distance, sampler);
            None
        }
    };
    let length = point.map_or(distance, |point| point.distance);
    visitor.segment(&Segment { ray: start.ray, length, matter }, &start, sampler);
    point
}

/// Roulette, from the ray on with which it begins. What is worth less than 1 to the visitor is always at stake.
#[inline]
fn goes_on(
    path: &mut PathState,
    origin: Origin,
    reference: f32,
    worth: f32,
    early: bool,
    sampler: &mut Sampler,
) -> bool {
    // What refraction does to radiance by the solid angle is undone for the decision: it will be undone on the way out of
    // the glass.
    let level = match origin {
        Origin::Camera => path.throughput.max() * path.ior * path.ior,
        Origin::Light => path.throughput.max(),
    };
    let level = match early && level > 0.0 {
        true if worth >= 1.0 => return true,
        true => reference,
        false => level,
    };
    match survive(reference, level.min(reference) * worth, sampler) {
        Some(boost) => {
            path.throughput *= boost;
            true
        }
        None => false,
    }
}

impl PathState {
    /// Leaves `point` in the direction that was chosen there.
    #[inline]
    pub fn turn(&mut self, point: &SurfacePoint, scattered: &Scattered, origin: Origin) {
        self.throughput = self.throughput * scattered.weight;
        match origin {
            // Radiance over index squared is what a boundary keeps [Veach 1997, §5.2].
            Origin::Camera => {
                let unshadowed = Spectrum::grey(point.unshadowed(scattered.to_next));
                self.throughput = self.throughput * (unshadowed / (scattered.ior_ratio * scattered.ior_ratio));
            }
            // The adjoint of a BSDF that reckons with a shading normal [Veach 1997, eq. 5.17].
            Origin::Light => {
                self.throughput *= point.unshadowed(point.to_previous)
                    * point.geometric_over_shading(scattered.to_next)
                    / point.geometric_over_shading_back();
            }
        }
        self.ior *= scattered.ior_ratio.lanes()[0];
        self.slowness *= scattered.slowness;
        // Mirrors and glass keep the cone, as if they were flat.
        if Lobes::SMOOTH.contains(scattered.event) {
            self.cone = self.cone.scattered();
        }
        self.ray = point.surface.spawn(scattered.to_next);
        self.bounce += 1;
        self.history = self.history | scattered.event.into();
    }
}
