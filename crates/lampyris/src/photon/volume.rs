//! Photons in media, and the light that a ray gathers from them (theory §9.3).

use glam::Vec3;

use super::Kernel;
use super::tree::BoxTree;
use crate::geometry::{Bounds, Ray};
use crate::material::Lobes;
use crate::medium::{Flight, MediumId};
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;
use crate::transport::{PathState, Segment};

pub use crate::scene::description::VolumeName as Volume;

/// What light leaves in a medium: a beam along which it flies, as far as it does, or the point of length 0 where it has met
/// a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Where it begins.
    pub start: Vec3,
    /// Where it goes, unit length.
    pub direction: Vec3,
    /// How far, in scene units.
    pub length: f32,
    /// Length of the way straight before it, in scene units; infinite where its light came in parallel.
    pub reach: f32,
    /// Flux in W at the start, as if its path were the only one of its pass.
    pub flux: Spectrum,
    /// Optical length of its path as far as the start, in scene units.
    pub optical_length: f64,
    /// How much slower light is where it is than where its path began.
    pub slowness: f32,
    /// The medium.
    pub medium: MediumId,
    /// The number of its path in the pass.
    pub path: u32,
    /// Scattering events before.
    pub bounce: u16,
    /// Which events these were.
    pub history: Lobes,
    /// Whether its path began at a lamp that no shadow ray finds.
    pub hidden_lamp: bool,
}

impl Beam {
    /// Of the path of this number, from where it is.
    pub(super) fn new(number: u32, path: &PathState, start: Vec3, [reach, length]: [f32; 2], medium: MediumId) -> Beam {
        Beam {
            start,
            direction: path.ray.direction,
            length,
            reach,
            flux: path.throughput,
            optical_length: path.optical_length,
            slowness: path.slowness,
            medium,
            path: number,
            bounce: u16::try_from(path.bounce).unwrap_or(u16::MAX),
            history: path.history,
            hidden_lamp: path.hidden_lamp,
        }
    }

    /// How much farther its light has to come to a point near it: as a spherical wave from where its path turned last, or as
    /// a plane wave, so that a kernel's radius does not blur time to first order (theory §8).
    fn further(&self, at: Vec3) -> f32 {
        let offset = at - self.start;
        if self.reach.is_finite() {
            (offset + self.direction * self.reach).length() - self.reach
        } else {
            offset.dot(self.direction)
        }
    }

    /// Whether it came straight from a lamp that shadow rays find, too.
    pub fn is_rivalled(&self) -> bool {
        self.bounce == 0 && !self.hidden_lamp
    }

    /// Whether it came from the lamp by mirrors and glass alone, and by at least one of them.
    pub fn is_caustic(&self) -> bool {
        PathState::is_caustic_history(self.history)
    }
}

/// The photons of a pass in media, ready for rays. Immutable.
#[derive(Debug)]
pub struct VolumeMap {
    beams: Vec<Beam>,
    /// A part of a beam for each box of the tree, in its order.
    parts: Vec<Part>,
    tree: BoxTree,
    volume: Volume,
    kernel: Kernel,
    radius: f32,
    paths_emitted: u64,
}

/// A part of a beam, with all that tells whether a ray meets it: most are asked for nothing more.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// As of the beam.
    start: Vec3,
    direction: Vec3,
    from: f32,
    to: f32,
    /// The number of the beam.
    beam: u32,
}

/// A beam is cut into at most so many boxes, and not much shorter ones than its kernel is wide.
const MOST_PARTS: f32 = 64.0;
const WIDTHS: f32 = 8.0;
/// And all beams into about so many more than there are beams: of what memory can hold, and time can sort.
const ALL_PARTS: f64 = 524_288.0;

/// Rays closer to parallel than this (squared sine of their angle) have no crossing that could be told.
const PARALLEL: f32 = 1e-5;

impl VolumeMap {
    /// Of the photons of so many light paths, in blocks, for estimates with this kernel and radius.
    pub fn new(
        blocks: impl IntoIterator<Item = Vec<Beam>>,
        paths_emitted: u64,
        volume: Volume,
        kernel: Kernel,
        radius: f32,
    ) -> VolumeMap {
        let beams: Vec<Beam> = blocks.into_iter().flatten().collect();
        let (mut parts, mut boxes) = (Vec::with_capacity(beams.len()), Vec::with_capacity(beams.len()));
        let whole: f64 = beams.iter().map(|beam| f64::from(beam.length.min(f32::MAX.sqrt()))).sum();
        let piece = (WIDTHS * radius).max((whole / ALL_PARTS) as f32);
        for (number, beam) in (0..).zip(&beams) {
            // What leaves the scene has no end that a box could have; nothing is seen there, either.
            let length = beam.length.min(f32::MAX.sqrt());
            let count = (length / piece).ceil().clamp(1.0, MOST_PARTS);
            for part in 0..count as u32 {
                let [from, to] = [part, part + 1].map(|end| length * end as f32 / count);
                let ends = [from, to].map(|along| beam.start + beam.direction * along);
                boxes.push(Bounds { min: ends[0].min(ends[1]) - radius, max: ends[0].max(ends[1]) + radius });
                parts.push(Part { start: beam.start, direction: beam.direction, from, to, beam: number });
            }
        }
        let (tree, order) = BoxTree::new(&boxes);
        let parts = order.into_iter().map(|part: u32| parts[part as usize]).collect();
        VolumeMap { tree, beams, parts, volume, kernel, radius, paths_emitted }
    }

    fn beam(&self, part: &Part) -> &Beam {
        &self.beams[part.beam as usize]
    }

    /// The parts of beams that a ray may meet before `max`.
    fn parts_along(&self, ray: &Ray, max: f32, mut visit: impl FnMut(&Part)) {
        self.tree.along(ray, max, |places| self.parts[places].iter().for_each(&mut visit));
    }

    /// All of them.
    pub fn beams(&self) -> &[Beam] {
        &self.beams
    }

    /// The kernel's radius in scene units.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// Tells of each photon that shines along a segment of a path from the camera: with the radiance that it sends to the
    /// segment's start, and the optical lengths of the way from where it shines to there, and of the whole way from the lamp,
    /// where light is so slow.
    pub fn gather(
        &self,
        segment: &Segment,
        slowness: f32,
        sampler: &mut Sampler,
        mut tell: impl FnMut(&Beam, Spectrum, [f64; 2]),
    ) {
        let unit = 1.0 / self.paths_emitted as f32;
        let mut tell = |beam: &Beam, light: Spectrum, t: f32, further: f32| {
            let way = beam.optical_length / f64::from(beam.slowness) + f64::from(t) + f64::from(further);
            tell(beam, light * unit, [f64::from(t), way].map(|way| f64::from(slowness) * way));
        };
        match self.volume {
            Volume::Beams => self.crossings(segment, sampler, tell),
            Volume::Points => self.points(segment, sampler, |beam, light, t| {
                tell(beam, light, t, beam.further(segment.ray.at(t)));
            }),
            Volume::Balls => self.around(segment, sampler, |beam, light, t| {
                tell(beam, light, t, beam.further(segment.ray.at(t)));
            }),
        }
    }

    /// The beam radiance estimate, 2D: Σ Tr(t) α p Φ K₂(d) [Jarosz et al. 2008, eq. 12].
    fn points(&self, segment: &Segment, sampler: &mut Sampler, mut tell: impl FnMut(&Beam, Spectrum, f32)) {
        let Segment { ray, length, matter } = segment;
        let fading = matter.fading(ray, *length, sampler);
        let kernel = self.kernel.weight::<2>(self.radius);
        self.parts_along(ray, *length, |part| {
            let offset = part.start - ray.origin;
            let t = offset.dot(ray.direction);
            let weight = kernel((offset - ray.direction * t).length_squared());
            if weight > 0.0 && t > 0.0 && t < *length && self.beam(part).medium == matter.id {
                let beam = self.beam(part);
                let phase = matter.phase.value(-beam.direction.dot(ray.direction));
                let light = fading.at(t) * matter.albedo_at(beam.start) * beam.flux;
                tell(beam, light * (phase * weight), t);
            }
        });
    }

    /// Beam × beam, 1D, with beams as long as light flew: Σ σ_s p Φ Tr(t) K₁(d) / sin θ [Jarosz et al. 2011, eq. 38].
    fn crossings(&self, segment: &Segment, sampler: &mut Sampler, mut tell: impl FnMut(&Beam, Spectrum, f32, f32)) {
        let Segment { ray, length, matter } = segment;
        let fading = matter.fading(ray, *length, sampler);
        let kernel = self.kernel.weight::<1>(self.radius);
        self.parts_along(ray, *length, |part| {
            let Part { start, direction, from, to, .. } = *part;
            let across = ray.direction.cross(direction);
            let (sin2, cos) = (across.length_squared(), ray.direction.dot(direction));
            if sin2 < PARALLEL {
                return;
            }
            let offset = start - ray.origin;
            let (a, b) = (offset.dot(ray.direction), offset.dot(direction));
            let (t, u) = ((a - cos * b) / sin2, (cos * a - b) / sin2);
            let weight = kernel(offset.dot(across).powi(2) / sin2);
            // Each crossing belongs to one part of the beam.
            let is_met = weight > 0.0 && t > 0.0 && t < *length && u >= from && u < to;
            if is_met && self.beam(part).medium == matter.id {
                let beam = self.beam(part);
                let flux = beam.flux * matter.left_of_beam(beam.flux, u);
                let phase = matter.phase.value(-cos);
                let light = fading.at(t) * matter.scattering_at(beam.start + beam.direction * u) * flux;
                tell(beam, light * (phase * weight / sin2.sqrt()), t, u);
            }
        });
    }

    /// Points around a point of the ray, 3D: Tr / pdf Σ α p Φ K₃(d) [Jensen & Christensen 1998, eq. 11].
    fn around(&self, segment: &Segment, sampler: &mut Sampler, mut tell: impl FnMut(&Beam, Spectrum, f32)) {
        let Segment { ray, length, matter } = segment;
        let Flight::Collided { distance, weight, albedo } = matter.fly(ray, Spectrum::ONE, *length, sampler) else {
            return;
        };
        let center = ray.at(distance);
        let factor = weight.divided(matter.extinction_at(center)) * albedo;
        let kernel = self.kernel.weight::<3>(self.radius);
        self.parts_along(&Ray { origin: center, ..*ray }, 0.0, |part| {
            let weight = kernel(part.start.distance_squared(center));
            if weight > 0.0 && self.beam(part).medium == matter.id {
                let beam = self.beam(part);
                let phase = matter.phase.value(-beam.direction.dot(ray.direction));
                tell(beam, factor * beam.flux * (phase * weight), distance);
            }
        });
    }

    /// The distances, in its dimension, of the photons that could count for a segment, whatever the radius: for who chooses
    /// one.
    pub fn distances(&self, segment: &Segment) -> Vec<f32> {
        let Segment { ray, length, matter } = segment;
        let of = |beam: &Beam| {
            let offset = beam.start - ray.origin;
            let (t, distance) = match self.volume {
                Volume::Points | Volume::Balls => {
                    let t = offset.dot(ray.direction);
                    (t, (offset - ray.direction * t).length())
                }
                Volume::Beams => {
                    let across = ray.direction.cross(beam.direction);
                    let (sin2, cos) = (across.length_squared().max(PARALLEL), ray.direction.dot(beam.direction));
                    let (a, b) = (offset.dot(ray.direction), offset.dot(beam.direction));
                    let u = (cos * a - b) / sin2;
                    let reaches = u >= 0.0 && u < beam.length;
                    (if reaches { (a - cos * b) / sin2 } else { -1.0 }, offset.dot(across).abs() / sin2.sqrt())
                }
            };
            (beam.medium == matter.id && t > 0.0 && t < *length).then_some(distance)
        };
        self.beams.iter().filter_map(of).collect()
    }
}
