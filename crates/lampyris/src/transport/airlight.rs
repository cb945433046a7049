//! Light that a medium scatters once, straight from a lamp into a segment of a path: next-event estimation at a point of the
//! segment (theory §9.6).

use super::{PathState, Segment};
use crate::light::{Equiangular, Illumination};
use crate::medium::{Depth, Fading};
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::spectrum::Spectrum;

/// What a medium scatters into a path.
#[derive(Clone, Copy, Debug)]
pub struct Airlight {
    /// Radiance at the segment's start, for a path that carries 1.
    pub light: Spectrum,
    /// Where on the segment it is scattered, and how far from there the lamp is, in scene units.
    pub way: [f32; 2],
}

/// Of so many points, each with its lamp, one gets a shadow ray, by what it would bring if nothing stood between:
/// resampling [Talbot et al. 2005].
const CANDIDATES: u32 = 8;

struct Candidate {
    at: f32,
    illumination: Illumination,
    light: Spectrum,
    worth: f32,
}

/// Light of one of the lamps, chosen at random, that reaches a random point of the segment on a straight way and is
/// scattered back along the path.
pub fn airlight(scene: &Scene, segment: &Segment, path: &PathState, sampler: &mut Sampler) -> Option<Airlight> {
    let Segment { ray, length, matter } = segment;
    if matter.scattering.is_zero() {
        return None;
    }
    let offset = sampler.spare();
    let mut own = sampler.apart();
    let fading = matter.fading(ray, *length, &mut own);
    let (mut chosen, mut total) = (None, 0.0);
    for number in 0..CANDIDATES {
        let u = (number as f32 + offset) / CANDIDATES as f32;
        if let Some(candidate) = candidate(scene, segment, path, &fading, u, &mut own) {
            total += candidate.worth;
            if own.uniform() * total < candidate.worth {
                chosen = Some(candidate);
            }
        }
    }
    let Candidate { at, illumination, light, worth } = chosen?;
    let passage = scene.passage(ray.at(at), path.inside, &illumination, &mut own);
    let light = light * passage * (total / (worth * CANDIDATES as f32));
    (!light.is_zero()).then(|| Airlight { light, way: [at, scene.distance_of(ray.at(at), &illumination)] })
}

fn candidate(
    scene: &Scene,
    segment: &Segment,
    path: &PathState,
    fading: &Fading,
    u: f32,
    sampler: &mut Sampler,
) -> Option<Candidate> {
    let Segment { ray, length, matter } = segment;
    let lamp = scene.lamp(sampler);
    let span = lamp.span(ray, *length)?;
    let (toward_lamp, depth) = (span.equiangular(ray), Depth::new(fading, path.throughput, [span.from, span.to])?);
    let (at, pdf) = distance(toward_lamp, &depth, u);
    let position = ray.at(at);
    let illumination = lamp.illuminate(position, sampler)?;
    let scattered = fading.at(at) * matter.scattering_at(position) / pdf;
    let phase = matter.phase.value(ray.direction.dot(illumination.to_light));
    let light = scattered * illumination.irradiance * phase;
    let worth = (path.throughput * light).mean();
    (worth > 0.0 && worth.is_finite()).then_some(Candidate { at, illumination, light, worth })
}

/// A distance with its density: where a lamp is near or where the medium is seen, by halves.
fn distance(toward_lamp: Option<Equiangular>, depth: &Depth, u: f32) -> (f32, f32) {
    match toward_lamp {
        None => {
            let at = depth.sample(u);
            (at, depth.pdf(at))
        }
        Some(lamp) => {
            let at = if u < 0.5 { lamp.sample(2.0 * u) } else { depth.sample(2.0 * u - 1.0) };
            (at, 0.5 * (lamp.pdf(at) + depth.pdf(at)))
        }
    }
}
