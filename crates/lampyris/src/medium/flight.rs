//! How far light flies through a medium, and how much of it (theory §9.1).

use glam::Vec3;

use super::{Cloud, Fading, MediumId, Phase, tracking};
use crate::geometry::Ray;
use crate::math::ONE_MINUS_EPSILON;
use crate::sampler::Sampler;
use crate::spectrum::{Basis, Spectrum};

/// A medium in the lanes of a pass.
#[derive(Clone, Copy, Debug)]
pub struct Matter<'m> {
    /// The number of the medium.
    pub id: MediumId,
    /// Extinction coefficient σ_t in 1/(scene unit).
    pub extinction: Spectrum,
    /// Scattering coefficient σ_s in 1/(scene unit).
    pub scattering: Spectrum,
    /// Where scattered light goes.
    pub phase: &'m Phase,
    /// What the coefficients are multiplied by, where that is not the same everywhere.
    pub cloud: Option<&'m Cloud>,
    /// What the lanes are.
    pub basis: &'m Basis,
    /// Mean optical path length, in scene units, by which a particle holds back the light that it scatters.
    pub delay: f32,
}

/// What became of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flight {
    /// It went all the way.
    Through {
        /// Transmittance over the probability of that.
        weight: Spectrum,
    },
    /// It met a particle.
    Collided {
        /// After this distance, in scene units.
        distance: f32,
        /// Transmittance × extinction coefficient over the density of the distance: the flux that arrives.
        weight: Spectrum,
        /// The share of it that is scattered, σ_s / σ_t.
        albedo: Spectrum,
    },
}

impl Matter<'_> {
    /// By how much a particle holds back the light that it scatters, as an optical path length in scene units: of the density
    /// exp(-Δ/τ)/τ, by a number uniform in 0..1 that is asked for if it matters.
    #[inline]
    pub fn delay(&self, uniform: impl FnOnce() -> f64) -> f64 {
        if self.delay > 0.0 { -f64::from(self.delay) * (-uniform()).ln_1p() } else { 0.0 }
    }

    /// The share of the light that goes so far along the ray without meeting a particle; in a cloud an estimate.
    #[inline]
    pub fn transmittance(&self, ray: &Ray, distance: f32, sampler: &mut Sampler) -> Spectrum {
        match self.cloud {
            None => beer_lambert(self.extinction, distance),
            Some(cloud) => tracking::transmittance(self, cloud, ray, distance, sampler),
        }
    }

    /// The same for all distances up to this one.
    pub fn fading(&self, ray: &Ray, distance: f32, sampler: &mut Sampler) -> Fading {
        match self.cloud {
            None => Fading::Even(self.extinction),
            Some(cloud) => tracking::fading(self, cloud, ray, distance, sampler),
        }
    }

    /// The share of the light that collisions scatter at a point.
    #[inline]
    pub fn albedo_at(&self, point: Vec3) -> Spectrum {
        let own = || self.scattering.divided(self.extinction);
        match self.cloud.and_then(|cloud| cloud.albedo(point)) {
            Some(albedo) => self.basis.lanes(albedo),
            None => own(),
        }
    }

    /// Scattering coefficient σ_s in 1/(scene unit) at a point.
    #[inline]
    pub fn scattering_at(&self, point: Vec3) -> Spectrum {
        match self.cloud {
            None => self.scattering,
            Some(_) => self.extinction_at(point) * self.albedo_at(point),
        }
    }

    /// Extinction coefficient σ_t in 1/(scene unit) at a point.
    #[inline]
    pub fn extinction_at(&self, point: Vec3) -> Spectrum {
        match self.cloud {
            None => self.extinction,
            Some(cloud) => self.extinction * self.basis.lanes(cloud.density(point)),
        }
    }

    /// The largest extinction coefficient anywhere, in any lane.
    pub fn most_extinction(&self) -> f32 {
        self.extinction.max() * self.cloud.map_or(1.0, Cloud::most)
    }

    /// What of light of these lanes is left after so much way through an even medium, over the probability that
    /// [`Matter::fly`] goes so far. In clouds, lanes must be alike.
    #[inline]
    pub fn left_of_beam(&self, carried: Spectrum, distance: f32) -> Spectrum {
        let [first, ..] = self.extinction.lanes();
        if self.cloud.is_some() || self.extinction == Spectrum::grey(first) {
            return Spectrum::ONE;
        }
        over_mean(beer_lambert(self.extinction, distance), carried)
    }

    /// Flies along the ray until a collision, at most so far, with light of these lanes.
    ///
    /// Where lanes differ, one of them, chosen by what it carries, gives the distance, and the weight is that of the mean of
    /// all their densities: the balance heuristic of a single sample over wavelengths [Wilkie et al. 2014].
    pub fn fly(&self, ray: &Ray, carried: Spectrum, distance: f32, sampler: &mut Sampler) -> Flight {
        if let Some(cloud) = self.cloud {
            return tracking::fly(self, cloud, ray, carried, distance, sampler);
        }
        let albedo = || self.scattering.divided(self.extinction);
        let u = sampler.spare();
        let extinction = self.extinction.lanes();
        if extinction == [extinction[0]; 4] {
            return match -(1.0 - u).ln() / extinction[0] {
                flown if flown < distance => {
                    Flight::Collided { distance: flown, weight: Spectrum::ONE, albedo: albedo() }
                }
                _ => Flight::Through { weight: Spectrum::ONE },
            };
        }
        let (lane, u) = choose(carried.lanes(), u);
        let flown = -(1.0 - u).ln() / extinction[lane];
        // A lane that is never hindered gives no number for u = 0.
        if flown < distance {
            let weight = beer_lambert(self.extinction, flown) * self.extinction;
            Flight::Collided { distance: flown, weight: over_mean(weight, carried), albedo: albedo() }
        } else {
            Flight::Through { weight: over_mean(beer_lambert(self.extinction, distance), carried) }
        }
    }
}

/// Beer and Lambert's e^(−σ_t d), which is 1 at any distance where there is nothing.
#[inline]
pub(super) fn beer_lambert(extinction: Spectrum, distance: f32) -> Spectrum {
    extinction.map(|extinction| if extinction > 0.0 { (-extinction * distance).exp() } else { 1.0 })
}

/// A lane with a probability proportional to what it carries, and `u` stretched to 0..1.
fn choose(carried: [f32; 4], u: f32) -> (usize, f32) {
    let mut left = u * carried.iter().sum::<f32>();
    let mut chosen = (0, u);
    for (lane, &weight) in carried.iter().enumerate() {
        if weight > 0.0 {
            chosen = (lane, (left / weight).clamp(0.0, ONE_MINUS_EPSILON));
            if left < weight {
                break;
            }
            left -= weight;
        }
    }
    chosen
}

/// What is sampled over the mean of its lanes, weighted by what they carry.
pub(super) fn over_mean(value: Spectrum, carried: Spectrum) -> Spectrum {
    let sum = |spectrum: Spectrum| spectrum.lanes().iter().sum::<f32>();
    let mean = sum(value * carried) / sum(carried);
    if mean > 0.0 { value / mean } else { Spectrum::ZERO }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    const RAY: Ray = Ray { origin: Vec3::ZERO, direction: Vec3::Z };

    /// Flights through coloured matter: Σ weights of those that go through is the transmittance, and of the collisions the
    /// rest, in every lane.
    #[test]
    fn weights_of_flights_add_up_to_what_goes_through_and_what_does_not_in_every_lane() {
        let matter = Matter {
            id: 0,
            extinction: Spectrum::from_rgb([0.2, 1.0, 5.0]),
            scattering: Spectrum::from_rgb([0.1, 1.0, 0.0]),
            phase: &Phase::Isotropic,
            cloud: None,
            basis: &Basis::Rgb,
            delay: 0.0,
        };
        let (carried, distance, count) = (Spectrum::from_rgb([2.0, 0.5, 1.0]), 0.7, 400_000_u32);
        let mut sampler = Sampler::new(3, 0, 0, 0);
        let (mut through, mut collided) = ([0.0_f64; 3], [0.0_f64; 3]);
        for _ in 0..count {
            let (sums, weight) = match matter.fly(&RAY, carried, distance, &mut sampler) {
                Flight::Through { weight } => (&mut through, weight),
                Flight::Collided { distance: flown, weight, albedo } => {
                    assert!(flown < distance && albedo.to_rgb() == [0.5, 1.0, 0.0]);
                    (&mut collided, weight)
                }
            };
            sums.iter_mut().zip(weight.to_rgb()).for_each(|(sum, lane)| *sum += f64::from(lane));
        }
        for lane in 0..3 {
            let expected = f64::from(-matter.extinction.to_rgb()[lane] * distance).exp();
            // Weights are bounded by the sum of what is carried over the lane's own, 8: six standard errors, odds 2e-9.
            let bound = 6.0 * 8.0 / f64::from(count).sqrt();
            let [through, collided] = [through, collided].map(|sums| sums[lane] / f64::from(count));
            assert!((through - expected).abs() < bound * 0.5, "{lane}: {through} is not {expected}");
            assert!((collided - (1.0 - expected)).abs() < bound * 0.5, "{lane}: {collided} is not {}", 1.0 - expected);
        }
    }

    #[test]
    fn what_is_not_there_hinders_no_lane_at_any_distance() {
        let matter = Matter {
            id: 0,
            extinction: Spectrum::from_rgb([0.0, 0.0, 1.0]),
            scattering: Spectrum::ZERO,
            phase: &Phase::Isotropic,
            cloud: None,
            basis: &Basis::Rgb,
            delay: 0.0,
        };
        let mut sampler = Sampler::new(3, 0, 0, 0);
        assert_eq!(matter.transmittance(&RAY, f32::INFINITY, &mut sampler).to_rgb(), [1.0, 1.0, 0.0]);
        for _ in 0..100 {
            let red = Spectrum::from_rgb([1.0, 0.0, 0.0]);
            assert!(matches!(matter.fly(&RAY, red, f32::INFINITY, &mut sampler), Flight::Through { .. }));
        }
    }
}
