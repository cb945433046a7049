//! Flights through clouds, by particles that change nothing: null collisions (theory §9.5).

use super::flight::{Flight, over_mean};
use super::{Cloud, Matter};
use crate::geometry::Ray;
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// How light fades along a ray.
#[derive(Clone, Debug)]
pub enum Fading {
    /// By e^(−σ_t t).
    Even(Spectrum),
    /// From each of these distances on, what is left: an estimate, without bias at every distance.
    Steps(Vec<(f32, Spectrum)>),
}

impl Fading {
    /// The share that is left at a distance.
    #[inline]
    pub fn at(&self, distance: f32) -> Spectrum {
        match self {
            Fading::Even(extinction) => super::flight::beer_lambert(*extinction, distance),
            Fading::Steps(steps) => match steps.partition_point(|(from, _)| *from <= distance).checked_sub(1) {
                Some(step) => steps[step].1,
                None => Spectrum::ONE,
            },
        }
    }
}

/// Goes along a ray from one tentative collision to the next, which lie as densely as the extinction's upper bound says:
/// tells `visit` of the distance and of how much of the bound is extinction, until it has enough (false).
fn tentative(
    matter: &Matter,
    cloud: &Cloud,
    ray: &Ray,
    distance: f32,
    sampler: &mut Sampler,
    mut visit: impl FnMut(f32, Spectrum, &mut Sampler) -> bool,
) {
    let most = matter.extinction.max();
    cloud.along(ray, distance, |from, to, bound| {
        let bound = bound * most;
        if bound <= 0.0 {
            return true;
        }
        let mut t = from;
        loop {
            t -= (1.0 - sampler.independent()).ln() / bound;
            if t >= to {
                return true;
            }
            let share = matter.extinction_at(ray.at(t)) / bound;
            if !visit(t, share, sampler) {
                return false;
            }
        }
    });
}

/// Ratio tracking [Novák et al. 2014]: the product of what tentative collisions would let through.
pub(super) fn transmittance(
    matter: &Matter,
    cloud: &Cloud,
    ray: &Ray,
    distance: f32,
    sampler: &mut Sampler,
) -> Spectrum {
    let mut left = Spectrum::ONE;
    tentative(matter, cloud, ray, distance, sampler, |_, share, _| {
        left = left * share.map(|share| (1.0 - share).max(0.0));
        !left.is_zero()
    });
    left
}

/// The same with all that comes before.
pub(super) fn fading(matter: &Matter, cloud: &Cloud, ray: &Ray, distance: f32, sampler: &mut Sampler) -> Fading {
    let (mut steps, mut left) = (Vec::new(), Spectrum::ONE);
    tentative(matter, cloud, ray, distance, sampler, |t, share, _| {
        left = left * share.map(|share| (1.0 - share).max(0.0));
        steps.push((t, left));
        !left.is_zero()
    });
    Fading::Steps(steps)
}

/// Delta tracking [Woodcock et al. 1965]: each tentative collision is one, or changes nothing. Where lanes differ, the mean of
/// their probabilities decides, weighted by what the path carries, and the lanes' weights say by how much they differ.
pub(super) fn fly(
    matter: &Matter,
    cloud: &Cloud,
    ray: &Ray,
    carried: Spectrum,
    distance: f32,
    sampler: &mut Sampler,
) -> Flight {
    let mut weight = Spectrum::ONE;
    let mut flight = None;
    tentative(matter, cloud, ray, distance, sampler, |t, share, sampler| {
        let now = carried * weight;
        let sum = |spectrum: Spectrum| spectrum.lanes().iter().sum::<f32>();
        let probability = sum(now * share) / sum(now);
        if sampler.independent() < probability {
            let albedo = matter.albedo_at(ray.at(t));
            flight = Some(Flight::Collided { distance: t, weight: weight * over_mean(share, now), albedo });
            return false;
        }
        weight = weight * over_mean(share.map(|share| (1.0 - share).max(0.0)), now);
        true
    });
    flight.unwrap_or(Flight::Through { weight })
}
