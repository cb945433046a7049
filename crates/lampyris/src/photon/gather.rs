//! Density estimation: radiance from the photons around a point (theory §5.1).

use super::{Kernel, Nearest, Photon, PhotonMap, Radius};
use crate::scene::SurfacePoint;
use crate::spectrum::Spectrum;

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

/// Photons whose normal is turned away by more than this (cosine of 96°) lie on another surface: the back of a thin wall.
/// Those of the next wall of a corner do count: they stand in for the part of the disk that the corner cuts off, where
/// otherwise a dark line would follow every inner edge until the radius is small.
const SAME_SURFACE: f32 = -0.1;

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
        let even = point.even();
        let mut sum = Spectrum::ZERO;
        let mut add = |photon: &Photon, weight: f32| {
            let to_light = -photon.direction;
            let same_surface = photon.normal.dot(normal) > SAME_SURFACE || point.bsdf.transmits();
            if photon.bounce <= max_bounces && same_surface {
                // A photon is flux per area of the geometry, the BSDF wants it per area of the shading normal's.
                let light = photon.flux * (weight / point.geometric_over_shading(to_light));
                sum += match even {
                    Some(_) if point.same_side(to_light) => light,
                    Some(_) => Spectrum::ZERO,
                    None => point.eval_radiance(to_light) * light,
                };
            }
        };
        let radius = self.map.search(center, self.radius, found);
        self.kernel.weigh::<2>(radius, found.hits.distances_squared_mut());
        let photons = self.map.photons();
        for (&index, &weight) in found.hits.indices().iter().zip(found.hits.distances_squared()) {
            add(&photons[index as usize], weight);
        }
        sum * even.unwrap_or(Spectrum::ONE) / self.map.paths_emitted() as f32
    }
}
