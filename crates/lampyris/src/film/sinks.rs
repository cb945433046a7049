//! What a path adds to its pixel: light, for the layers what the light was and what the path has met, and for bins in time
//! when the light arrived.

use glam::Vec3;

use super::Features;
use crate::material::Lobes;
use crate::scene::SurfacePoint;
use crate::spectrum::{Basis, Spectrum};
use crate::transient::Met;
use crate::transport::PathState;

/// Where the samples of a pixel leave the light that they find. Whatever else it notes, the radiance is the same to the
/// last bit. A sink without light is the model of all others: they are made as its clones.
pub trait Sink: Clone + Send + Sync {
    /// Whether it has features to tell.
    const LAYERED: bool;

    /// Whether it asks when light arrives.
    const TIMED: bool = false;

    /// Makes room for another sample: forgets all light.
    fn clear(&mut self);

    /// The path of a sample has reached a surface; it is told of all, in their order.
    fn surface(&mut self, _point: &SurfacePoint, _path: &PathState) {}

    /// The path of a sample has met no surface yet, and the light that follows comes to it from a particle of a medium, at this
    /// optical length. Only for those that are [`Sink::TIMED`].
    fn particle(&mut self, _optical_length: f64) {}

    /// Adds radiance of light that has met this on a path of this optical length, in scene units.
    fn add(&mut self, light: Spectrum, met: Met, optical_length: f64);

    /// Notes light, in a unit of its own, that has met this on a path of this optical length, for [`Sink::add_noted`]. Only
    /// for those that are [`Sink::TIMED`].
    fn note(&mut self, _light: Spectrum, _met: Met, _optical_length: f64) {}

    /// [`Sink::add`] of all light that was noted, which is this in sum, of at least so many events; `unit` is that in which
    /// it was noted.
    fn add_noted(&mut self, light: Spectrum, events: u32, _unit: Spectrum) {
        self.add(light, Met::surfaces(events), 0.0);
    }

    /// Of what was noted as light of two events or more, this part had only one.
    fn was_direct(&mut self, _light: Spectrum) {}

    /// Of what was noted, this part is [caustic](super::Layer::Caustic).
    fn was_caustic(&mut self, _light: Spectrum) {}

    /// Takes this share of all that was left at another one, which has [settled](Sink::settle).
    fn take(&mut self, other: &Self, share: f32);

    /// One like this, without light, for light that only others [borrow](Sink::borrow).
    fn apart(&self) -> Self {
        self.clone()
    }

    /// Adds all light of one that is [apart](Sink::apart), so much of each lane, on paths that are longer by this optical
    /// length, in scene units.
    fn borrow(&mut self, other: &Self, share: Spectrum, longer: f64);

    /// The sum of what was added, in the lanes of the pass.
    fn radiance(&self) -> Spectrum;

    /// The features as means over so many samples.
    fn features(&self, _samples: u32, _basis: &Basis) -> Option<Features> {
        None
    }

    /// When what was added arrived: the [slots](super::Clock::note) that have light, in their order, in the lanes of the
    /// pass.
    fn settle(&mut self) -> &[(u32, Spectrum)] {
        &[]
    }
}

/// Radiance and nothing else.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plain(Spectrum);

impl Sink for Plain {
    const LAYERED: bool = false;

    #[inline]
    fn clear(&mut self) {
        *self = Plain::default();
    }

    #[inline]
    fn add(&mut self, light: Spectrum, _: Met, _: f64) {
        self.0 += light;
    }

    #[inline]
    fn take(&mut self, other: &Plain, share: f32) {
        self.0 += other.0 * share;
    }

    #[inline]
    fn borrow(&mut self, other: &Plain, share: Spectrum, _: f64) {
        self.0 += other.0 * share;
    }

    #[inline]
    fn radiance(&self) -> Spectrum {
        self.0
    }
}

/// Radiance, and all that the layers need.
#[derive(Clone, Copy, Debug, Default)]
pub struct Layered {
    radiance: Spectrum,
    emission: Spectrum,
    direct: Spectrum,
    caustic: Spectrum,
    albedo: Spectrum,
    normal: Vec3,
    position: Vec3,
    depth: f32,
    met: f32,
    /// Of one sample: its throughput at the start, and how far it has come.
    start: f32,
    way: f32,
}

impl Sink for Layered {
    const LAYERED: bool = true;

    fn clear(&mut self) {
        *self = Layered::default();
    }

    fn surface(&mut self, point: &SurfacePoint, path: &PathState) {
        if self.met > 0.0 {
            return;
        }
        if self.way == 0.0 {
            self.start = path.throughput.max();
        }
        self.way += point.distance;
        let lobes = point.bsdf.lobes();
        if lobes.meets(Lobes::DELTA) && !lobes.meets(Lobes::SMOOTH) {
            return;
        }
        let normal = point.frame.normal;
        // What refraction does to radiance by the solid angle is undone: it is not absorbed.
        let share = path.ior * path.ior / self.start.max(f32::MIN_POSITIVE);
        self.albedo += path.throughput * share * point.albedo();
        self.normal += if normal.dot(point.to_previous) < 0.0 { -normal } else { normal };
        self.position += point.surface.position;
        self.depth += self.way;
        self.met += 1.0;
    }

    fn add(&mut self, light: Spectrum, met: Met, _: f64) {
        self.radiance += light;
        match met.events {
            0 => self.emission += light,
            1 => self.direct += light,
            _ => {}
        }
        if met.is_caustic {
            self.caustic += light;
        }
    }

    fn was_direct(&mut self, light: Spectrum) {
        self.direct += light;
    }

    fn was_caustic(&mut self, light: Spectrum) {
        self.caustic += light;
    }

    fn take(&mut self, other: &Layered, share: f32) {
        self.radiance += other.radiance * share;
        self.emission += other.emission * share;
        self.direct += other.direct * share;
        self.caustic += other.caustic * share;
        self.albedo += other.albedo * share;
        self.normal += other.normal * share;
        self.position += other.position * share;
        self.depth += other.depth * share;
        self.met += other.met * share;
    }

    fn borrow(&mut self, other: &Layered, share: Spectrum, _: f64) {
        self.radiance += other.radiance * share;
        self.emission += other.emission * share;
        self.direct += other.direct * share;
        self.caustic += other.caustic * share;
    }

    fn radiance(&self) -> Spectrum {
        self.radiance
    }

    fn features(&self, samples: u32, basis: &Basis) -> Option<Features> {
        let n = samples as f32;
        Some(Features {
            emission: basis.to_rgb(self.emission / n),
            direct: basis.to_rgb(self.direct / n),
            caustic: basis.to_rgb(self.caustic / n),
            albedo: basis.to_rgb(self.albedo / n),
            // As the weight of the pass has it.
            normal: (self.normal * (basis.white() / n)).to_array(),
            position: (self.position / n).to_array(),
            depth: self.depth / n,
            met: self.met / n,
        })
    }
}
