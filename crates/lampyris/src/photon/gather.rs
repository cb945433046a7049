//! Density estimation: radiance from the photons around a point (theory §5.1).

use super::{Kernel, Photon, PhotonMap, Radius};
use crate::scene::SurfacePoint;
use crate::spectrum::Spectrum;

/// Space for the search of nearest photons, to be used again.
#[derive(Debug, Default)]
pub struct Nearest {
    /// Squared distance and number of each photon within reach.
    pub(super) candidates: Vec<(f32, u32)>,
    pub(super) distances: Vec<f32>,
}

/// How radiance is estimated from photons.
#[derive(Debug)]
pub struct Estimate<'m> {
    /// The photons.
    pub map: &'m PhotonMap,
    /// Their weight by distance.
    pub kernel: Kernel,
    /// How far to look.
    pub radius: Radius,
}

/// Photons whose normal differs by more than this (cosine of 60°) lie on another surface: across the edge of a box, on
/// the other side of a thin wall. A ball still counts all its photons up to a chord of its radius.
const SAME_SURFACE: f32 = 0.5;

impl Estimate<'_> {
    /// Radiance that the smooth lobes at `point` reflect back along the path, of light whose photons have had at most
    /// `max_bounces` scattering events: Σ f Φ K / paths [Jensen 2001, eq. 7.6, with a kernel].
    pub fn radiance(&self, point: &SurfacePoint, max_bounces: u32, found: &mut Nearest) -> Spectrum {
        let center = point.surface.position;
        let normal = if point.surface.normal.dot(point.to_previous) < 0.0 {
            -point.surface.normal
        } else {
            point.surface.normal
        };
        let mut sum = Spectrum::ZERO;
        let mut add = |photon: &Photon, distance_squared: f32, radius: f32| {
            if photon.bounce <= max_bounces && photon.normal.dot(normal) > SAME_SURFACE {
                let to_light = -photon.direction;
                // A photon is flux per area of the geometry, the BSDF wants it per area of the shading normal's.
                let weight =
                    self.kernel.density::<2>(distance_squared, radius) / point.geometric_over_shading(to_light);
                sum += point.eval(to_light) * photon.flux * weight;
            }
        };
        match self.radius {
            Radius::Fixed(radius) => {
                self.map.within(center, radius, |photon, distance_squared| add(photon, distance_squared, radius));
            }
            Radius::Nearest { count, max_radius } => {
                let (radius, photons) = self.map.nearest(center, count, max_radius, found);
                photons.for_each(|(photon, distance_squared)| add(photon, distance_squared, radius));
            }
        }
        sum / self.map.paths_emitted() as f32
    }
}
