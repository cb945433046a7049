//! What else could have made a path: the weights of path tracing with merging (theory §5.4).
//!
//! The same path from lamp to camera can be made in several ways: a walk from the camera meets the lamp; a shadow ray
//! from its last point but one finds it; or a photon that has gone part of it is merged with a walk from the camera that
//! has gone the rest, at any point that scatters smoothly. The power heuristic [Veach & Guibas 1995] weighs each by its
//! density. Ratios of densities are kept as the walks grow, from both ends, after [Georgiev et al. 2012, appendix].

use crate::material::{Lobes, Scattered};
use crate::scene::SurfacePoint;

/// The [norm](norm) of the densities of other techniques over that of the walk so far, for techniques whose last common
/// point lies behind the current segment; per cosine at its end. Densities per area of the geometry.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rivals(f32);

impl Rivals {
    /// At the end of the segment: to be multiplied by the density per solid angle, at this point and from its other side, of
    /// the direction back along the segment.
    #[inline]
    pub fn at(self, point: &SurfacePoint) -> f32 {
        self.0 / point.geometric_cos(point.to_previous)
    }

    /// Of photons of this density, per area across the ray and per solid angle, that leave a lamp at the end of the segment.
    #[inline]
    pub fn at_lamp(self, emission: impl FnOnce() -> f32) -> f32 {
        if self.0 > 0.0 { self.0 * emission() } else { 0.0 }
    }

    /// After a scattering event at `point`, where `at` is what [`Rivals::at`] said of the point, and `smooth` the norm of
    /// the densities of all techniques that begin or join walks here or before, as seen from the other side, if the event is
    /// smooth. The walk goes on with probability `on`.
    #[inline]
    pub fn after(at: f32, smooth: f32, on: f32, point: &SurfacePoint, scattered: &Scattered) -> Rivals {
        if Lobes::SMOOTH.contains(scattered.event) {
            return Rivals(smooth * point.geometric_cos(scattered.to_next) / (on * scattered.pdf));
        }
        // Both walks choose the event alike; what refraction does to the solid angle is undone on the way back, but for
        // the indices: cos dω n² is the same on both sides. A smooth boundary has sent one wavelength on, and its index is
        // that of all lanes.
        let [ior_ratio, ..] = scattered.ior_ratio.lanes();
        Rivals(at * point.geometric_cos(point.to_previous) / (ior_ratio * ior_ratio))
    }
}

/// What several densities count together: the root of the sum of their squares. Of squares alone, whose unit is a length to
/// the fourth power or its inverse, single precision would hold only those of middling lengths.
#[inline]
pub fn norm<const COUNT: usize>(densities: [f32; COUNT]) -> f32 {
    densities.iter().map(|&density| f64::from(density).powi(2)).sum::<f64>().sqrt() as f32
}

/// What a ratio of densities counts in the weights: the power heuristic with β = 2 [Veach & Guibas 1995].
#[inline]
pub fn squared(ratio: f32) -> f32 {
    ratio * ratio
}
