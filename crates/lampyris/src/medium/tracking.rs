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
    /// From each of these distances on, what is left: an estimate, without bias at every distance. There is something from
    /// the first of the ends to the last alone.
    Steps(Vec<(f32, Spectrum)>, [f32; 2]),
}

impl Fading {
    /// The share that is left at a distance.
    #[inline]
    pub fn at(&self, distance: f32) -> Spectrum {
        match self {
            Fading::Even(extinction) => super::flight::beer_lambert(*extinction, distance),
            Fading::Steps(steps, _) => match steps.partition_point(|(from, _)| *from <= distance).checked_sub(1) {
                Some(step) => steps[step].1,
                None => Spectrum::ONE,
            },
        }
    }
}

/// Where along a ray to ask for light: densely where something scatters that is still seen. What light carries in each lane
/// says what is seen; what was estimated of a cloud says what scatters there.
#[derive(Clone, Debug)]
pub struct Depth {
    /// In even fog one for each lane, all between the same ends; in a cloud one after the other.
    pieces: Vec<Piece>,
}

#[derive(Clone, Copy, Debug)]
struct Piece {
    from: f32,
    to: f32,
    /// Of a density that falls by e^(−rate t).
    rate: f32,
    /// The share of the whole that it has.
    weight: f32,
}

impl Piece {
    /// 1 − e^(−rate × length), which is 1 without an end.
    fn share(&self) -> f32 {
        -(-self.rate * (self.to - self.from)).exp_m1()
    }

    fn sample(&self, u: f32) -> f32 {
        let at = match self.rate {
            0.0 => self.from + u * (self.to - self.from),
            rate => self.from - (-u * self.share()).ln_1p() / rate,
        };
        at.clamp(self.from, self.to.min(f32::MAX))
    }

    fn pdf(&self, at: f32) -> f32 {
        match self.rate {
            _ if !(self.from..=self.to).contains(&at) => 0.0,
            0.0 => 1.0 / (self.to - self.from),
            rate => rate * (-rate * (at - self.from)).exp() / self.share(),
        }
    }
}

impl Depth {
    /// Between two distances, for light of these lanes; none if there is nothing to ask for.
    pub fn new(fading: &Fading, carried: Spectrum, [from, to]: [f32; 2]) -> Option<Depth> {
        let pieces: Vec<Piece> = match fading {
            Fading::Even(extinction) => {
                let lanes = extinction.lanes().into_iter().zip(carried.lanes());
                let piece = |(rate, weight): (f32, f32)| {
                    (rate > 0.0 && weight > 0.0).then_some(Piece { from, to, rate, weight })
                };
                let mut pieces: Vec<Piece> = lanes.filter_map(piece).collect();
                if pieces.iter().all(|piece| piece.rate == pieces[0].rate) {
                    pieces.truncate(1);
                }
                pieces
            }
            Fading::Steps(steps, ends) => {
                let (from, to) = (from.max(ends[0]), to.min(ends[1]));
                let begins = [(from, fading.at(from))].into_iter();
                let begins: Vec<_> =
                    begins.chain(steps.iter().copied().filter(|(at, _)| *at > from && *at < to)).collect();
                let ends = begins.iter().skip(1).map(|(at, _)| *at).chain([to]);
                let pieces = begins.iter().zip(ends);
                let piece = |(&(from, left), to): (&(f32, Spectrum), f32)| {
                    let weight = (left * carried).mean();
                    (weight > 0.0 && from < to).then_some(Piece { from, to, rate: 0.0, weight })
                };
                pieces.filter_map(piece).collect()
            }
        };
        let total: f32 = pieces.iter().map(|piece| piece.weight).sum();
        let even = |piece: Piece| Piece { weight: piece.weight / total, ..piece };
        (total > 0.0).then(|| Depth { pieces: pieces.into_iter().map(even).collect() })
    }

    /// A distance in scene units, by a number in 0..1.
    pub fn sample(&self, u: f32) -> f32 {
        let mut left = u;
        let mut last = 0.0;
        for piece in &self.pieces {
            if left < piece.weight {
                return piece.sample(left / piece.weight);
            }
            left -= piece.weight;
            last = piece.to.min(f32::MAX);
        }
        // What rounding leaves.
        last
    }

    /// The density at a distance, per scene unit.
    pub fn pdf(&self, at: f32) -> f32 {
        self.pieces.iter().map(|piece| piece.weight * piece.pdf(at)).sum()
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
    let ends = cloud.extent(ray, distance).map_or([0.0; 2], |(from, to)| [from, to]);
    tentative(matter, cloud, ray, distance, sampler, |t, share, _| {
        left = left * share.map(|share| (1.0 - share).max(0.0));
        steps.push((t, left));
        !left.is_zero()
    });
    Fading::Steps(steps, ends)
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
