//! What rough boundaries do to light on average: small tables by the angle, computed when a scene is built.

use glam::{Vec2, Vec3};

use super::microfacet::mirrored;
use super::{MicrofacetDistribution, Microfacets};
use crate::math::fresnel;

/// How many cosines a row has, from 0 to 1.
const COSINES: usize = 64;
/// How many rows cover all α from 0 to 1, evenly in √α, where α comes from a texture.
const ALPHAS: usize = 25;
/// Normals per side of the square over which is averaged.
const NORMALS: usize = 48;

/// Shares of light by the cosine under which it comes, for facets of one α.
#[derive(Clone, Debug)]
pub struct Row {
    values: [f32; COSINES],
    /// Of diffuse light: 2 ∫ share cos d(cos).
    pub mean: f32,
}

impl Row {
    fn new(share: impl Fn(Vec3) -> f32) -> Row {
        let values = std::array::from_fn(|index| {
            let cos = (index as f32 / (COSINES - 1) as f32).max(1e-4);
            share(Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos))
        });
        let mut row = Row { values, mean: 0.0 };
        let steps = 8 * COSINES;
        let cosines = (0..steps).map(|step| (step as f32 + 0.5) / steps as f32);
        row.mean = cosines.map(|cos| 2.0 * row.at(cos) * cos).sum::<f32>() / steps as f32;
        row
    }

    /// Both shares together.
    pub(super) fn plus(&self, other: &Row) -> Row {
        let values = std::array::from_fn(|index| self.values[index] + other.values[index]);
        Row { values, mean: self.mean + other.mean }
    }

    /// The share at a cosine from 0 to 1, linear between entries.
    #[inline]
    pub fn at(&self, cos: f32) -> f32 {
        let place = cos.clamp(0.0, 1.0) * (COSINES - 1) as f32;
        let index = (place as usize).min(COSINES - 2);
        let t = place - index as f32;
        self.values[index] * (1.0 - t) + self.values[index + 1] * t
    }
}

/// Rows for every α that a material has: one, or many where a texture gives it.
#[derive(Clone, Debug)]
pub struct Table<R>(Vec<R>);

impl<R> Table<R> {
    /// `row` at the `constant` α, or at many.
    pub fn new(constant: Option<f32>, row: impl Fn(f32) -> R) -> Table<R> {
        match constant {
            Some(alpha) => Table(vec![row(alpha)]),
            None => Table((0..ALPHAS).map(|index| row((index as f32 / (ALPHAS - 1) as f32).powi(2))).collect()),
        }
    }

    /// The row whose α is nearest.
    #[inline]
    pub fn row(&self, alpha: f32) -> &R {
        let place = alpha.clamp(0.0, 1.0).sqrt() * (self.0.len() - 1) as f32;
        &self.0[place.round() as usize]
    }
}

/// Share of the light that white facets reflect at once, without a second facet in the way.
pub fn white_reflection(facets: &Microfacets) -> Row {
    Row::new(|to_previous| reflection(facets, to_previous, |_| 1.0))
}

/// What a rough boundary of `ior` (below over above) reflects at once, and sends through at once, from above.
pub fn boundary(facets: &Microfacets, ior: f32) -> (Row, Row) {
    let reflected = |cos: f32| fresnel::dielectric(cos, ior).reflectance;
    let above = Row::new(|to_previous| reflection(facets, to_previous, reflected));
    (above, Row::new(|to_previous| transmission(facets, to_previous, ior)))
}

/// The mean of a function of the normals that are visible from a direction.
fn mean(facets: &Microfacets, to_previous: Vec3, value: impl Fn(Vec3) -> f32) -> f32 {
    let at = |index: usize| (index as f32 + 0.5) / NORMALS as f32;
    let mut sum = 0.0;
    for (i, j) in (0..NORMALS).flat_map(|i| (0..NORMALS).map(move |j| (i, j))) {
        sum += f64::from(value(facets.sample(to_previous, Vec2::new(at(i), at(j)))));
    }
    (sum / (NORMALS * NORMALS) as f64) as f32
}

fn reflection(facets: &Microfacets, to_previous: Vec3, reflected: impl Fn(f32) -> f32) -> f32 {
    mean(facets, to_previous, |normal| {
        let to_next = mirrored(to_previous, normal);
        if to_next.z <= 0.0 {
            return 0.0;
        }
        facets.visible(to_next, normal) * reflected(to_previous.dot(normal))
    })
}

fn transmission(facets: &Microfacets, to_previous: Vec3, ior: f32) -> f32 {
    mean(facets, to_previous, |normal| {
        let boundary = fresnel::dielectric(to_previous.dot(normal), ior);
        match super::rough_glass::refracted(to_previous, normal, &boundary) {
            Some(to_next) => facets.visible(to_next, normal) * (1.0 - boundary.reflectance),
            None => 0.0,
        }
    })
}

/// What rough plastic needs of its coat.
#[derive(Clone, Debug)]
pub struct Coat {
    /// Share of the light that enters, by the cosine outside.
    pub entering: Row,
    /// Share of diffuse light from below that stays below.
    pub kept: f32,
}

impl Coat {
    /// As Mitsuba 3 computes both; with `whole` what its single scattering loses between facets enters instead.
    pub fn new(distribution: MicrofacetDistribution, alpha: f32, ior: f32, whole: bool) -> Coat {
        let facets = Microfacets::new(distribution, Vec2::splat(alpha));
        let (above, through) = boundary(&facets, ior);
        if whole {
            let entering = Row { values: above.values.map(|share| 1.0 - share), mean: 1.0 - above.mean };
            // What leaves is what enters, but for the solid angle: nothing is lost.
            let kept = 1.0 - entering.mean / (ior * ior);
            return Coat { entering, kept };
        }
        let inside = Row::new(|to_previous| {
            reflection(&facets, to_previous, |cos| fresnel::dielectric(cos, 1.0 / ior).reflectance)
        });
        // Mitsuba's mean is that of the entries, and a little darker than the integral.
        let entries = inside.values.iter().enumerate();
        let kept = entries.map(|(index, share)| 2.0 * share * index as f32 / (COSINES - 1) as f32).sum::<f32>();
        Coat { entering: through, kept: kept / COSINES as f32 }
    }
}
