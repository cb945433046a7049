//! Distributions of microfacet normals, with the masking that goes with them (theory §3.6).

use std::f32::consts::PI;

use glam::{Vec2, Vec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::math::{erf, erf_inverse};

/// A distribution of microfacet normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MicrofacetDistribution {
    /// Trowbridge and Reitz's, with long tails [Walter et al. 2007].
    #[default]
    Ggx,
    /// Beckmann's, of Gaussian slopes.
    Beckmann,
}

/// A rough surface as a distribution of the normals of its facets. Directions are local and lie above the surface
/// (z > 0), as do facet normals, unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets {
    distribution: MicrofacetDistribution,
    alpha: Vec2,
}

/// The smallest roughness; below it single precision fails, and nobody sees a difference.
const SMALLEST_ALPHA: f32 = 1e-4;

impl Microfacets {
    /// With the roughness α along x and along y.
    pub fn new(distribution: MicrofacetDistribution, alpha: Vec2) -> Microfacets {
        Microfacets { distribution, alpha: alpha.max(Vec2::splat(SMALLEST_ALPHA)) }
    }

    /// The density of facets of this normal per solid angle and area of the surface, D: ∫ D cos = 1.
    #[inline]
    pub fn density(&self, normal: Vec3) -> f32 {
        let slope2 = (normal.truncate() / self.alpha).length_squared();
        let (area, cos2) = (PI * self.alpha.x * self.alpha.y, normal.z * normal.z);
        let density = match self.distribution {
            MicrofacetDistribution::Ggx => 1.0 / (area * (slope2 + cos2).powi(2)),
            MicrofacetDistribution::Beckmann => (-slope2 / cos2).exp() / (area * cos2 * cos2),
        };
        // Where there is next to nothing, quotients of nothings would follow.
        if density * normal.z > 1e-20 { density } else { 0.0 }
    }

    /// Share of the facets of this normal, turned towards a direction on any side, that is visible from it, G₁
    /// [Smith 1967; Walter et al. 2007, eq. 27 and 34].
    #[inline]
    pub fn visible(&self, direction: Vec3, normal: Vec3) -> f32 {
        if direction.dot(normal) * direction.z <= 0.0 {
            return 0.0;
        }
        match self.distribution {
            MicrofacetDistribution::Ggx => self.visible_exactly(direction),
            MicrofacetDistribution::Beckmann => {
                let tan2 = self.tan2(direction);
                if tan2 <= 1.0 / (1.6 * 1.6) {
                    return 1.0;
                }
                // Walter's rational approximation of Smith's function, as all who write pictures to compare have it.
                let a = 1.0 / tan2.sqrt();
                (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a)
            }
        }
    }

    /// The density of [`Microfacets::sample`] per solid angle of normals.
    #[inline]
    pub fn pdf(&self, direction: Vec3, normal: Vec3) -> f32 {
        let toward = direction.dot(normal);
        if toward <= 0.0 || direction.z <= 0.0 {
            return 0.0;
        }
        self.visible_exactly(direction) * self.density(normal) * toward / direction.z
    }

    /// G₁ without an approximation, since a density has to integrate to 1.
    fn visible_exactly(&self, direction: Vec3) -> f32 {
        let tan2 = self.tan2(direction);
        match self.distribution {
            MicrofacetDistribution::Ggx => 2.0 / (1.0 + (1.0 + tan2).sqrt()),
            MicrofacetDistribution::Beckmann => {
                let a = 1.0 / tan2.sqrt();
                if a > 4.0 { 1.0 } else { 2.0 / (1.0 + erf(a) + (-a * a).exp() / (a * PI.sqrt())) }
            }
        }
    }

    /// Squared tangent of a direction's angle, times its roughness.
    #[inline]
    fn tan2(&self, direction: Vec3) -> f32 {
        (direction.truncate() * self.alpha).length_squared() / (direction.z * direction.z)
    }

    /// A normal among those visible from `direction`, each as often as it is seen.
    #[inline]
    pub fn sample(&self, direction: Vec3, u: Vec2) -> Vec3 {
        let stretched = Vec3::new(self.alpha.x * direction.x, self.alpha.y * direction.y, direction.z).normalize();
        let normal = match self.distribution {
            MicrofacetDistribution::Ggx => visible_cap(stretched, u),
            MicrofacetDistribution::Beckmann => visible_gaussian(stretched, u),
        };
        (normal * self.alpha.extend(1.0)).normalize_or(Vec3::Z)
    }
}

/// Reflection, of directions above the surface.
impl Microfacets {
    /// D G / (4 cos cos): the value of reflection on facets that absorb nothing, and the normal of these facets.
    #[inline]
    pub(super) fn reflection(&self, to_previous: Vec3, to_next: Vec3) -> Option<(f32, Vec3)> {
        if to_previous.z <= 0.0 || to_next.z <= 0.0 {
            return None;
        }
        let normal = (to_previous + to_next).normalize_or(Vec3::Z);
        let masking = self.visible(to_previous, normal) * self.visible(to_next, normal);
        Some((self.density(normal) * masking / (4.0 * to_previous.z * to_next.z), normal))
    }

    /// The density of [`Microfacets::sample_reflection`] per solid angle.
    #[inline]
    pub(super) fn reflection_pdf(&self, to_previous: Vec3, to_next: Vec3) -> f32 {
        if to_previous.z <= 0.0 || to_next.z <= 0.0 {
            return 0.0;
        }
        let normal = (to_previous + to_next).normalize_or(Vec3::Z);
        self.pdf(to_previous, normal) / (4.0 * to_previous.dot(normal)).max(f32::MIN_POSITIVE)
    }

    /// `to_previous` mirrored on a visible facet; none where that leads below the surface.
    #[inline]
    pub(super) fn sample_reflection(&self, to_previous: Vec3, u: Vec2) -> Option<Vec3> {
        let to_next = mirrored(to_previous, self.sample(to_previous, u));
        (to_next.z > 0.0).then_some(to_next)
    }

    /// The roughness that these facets have on average over all azimuths, for tables.
    pub(super) fn mean_alpha(&self) -> f32 {
        (self.alpha.x * self.alpha.y).sqrt()
    }
}

/// A direction mirrored on a facet, of unit length.
#[inline]
pub(super) fn mirrored(direction: Vec3, normal: Vec3) -> Vec3 {
    (normal * (2.0 * direction.dot(normal)) - direction).normalize()
}

/// A normal of the half sphere, seen from `direction` [Dupuy & Benyoub 2023]: the mirrored direction is uniform on a cap.
/// Not of unit length.
fn visible_cap(direction: Vec3, u: Vec2) -> Vec3 {
    let z = (1.0 - u.y) * (1.0 + direction.z) - direction.z;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let mirrored = (Vec2::from_angle(2.0 * PI * u.x) * radius).extend(z);
    let normal = mirrored + direction;
    normal.with_z(normal.z.max(1e-7))
}

/// A normal of a surface of Gaussian slopes of α = 1, seen from `direction` [Heitz & D'Eon 2014]. Not of unit length.
fn visible_gaussian(direction: Vec3, u: Vec2) -> Vec3 {
    let sin = direction.truncate().length();
    let around = if sin > 0.0 { direction.truncate() / sin } else { Vec2::X };
    let along = visible_slope(sin / direction.z.max(1e-7), u.x.clamp(1e-6, 1.0 - 1e-6));
    let across = erf_inverse(2.0 * u.y.clamp(1e-6, 1.0 - 1e-6) - 1.0);
    let slope = around * along + around.perp() * across;
    Vec3::new(-slope.x, -slope.y, 1.0)
}

/// The slope towards a direction of this tangent whose distribution function has the value `u`.
fn visible_slope(tan: f32, u: f32) -> f32 {
    // The distribution function over y = erf(slope) is (1 + y + tan exp(-slope²) / √π) / total on -1..erf(cot).
    let weight = tan / PI.sqrt();
    let value = |y: f32, slope: f32| 1.0 + y + weight * (-slope * slope).exp();
    let cot = 1.0 / tan.max(1e-7);
    let (mut low, mut high) = (-1.0, erf(cot));
    let goal = u * value(high, cot);
    let mut y = low + u * (high - low);
    for _ in 0..12 {
        let slope = erf_inverse(y);
        let off = value(y, slope) - goal;
        if off.abs() < 1e-6 {
            break;
        }
        if off > 0.0 {
            high = y
        } else {
            low = y
        }
        let newton = y - off / (1.0 - slope * tan);
        y = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
    }
    erf_inverse(y)
}
