//! Clear dielectrics with a rough boundary.

use std::f32::consts::PI;

use glam::Vec3;

use super::diffuse;
use super::microfacet::mirrored;
use super::table::{Row, boundary};
use super::{Event, Fan, Microfacets, Scatter, Shares};
use crate::math::fresnel::{self, Boundary};
use crate::math::warp;
use crate::spectrum::Spectrum;

/// Microfacets between two clear substances [Walter et al. 2007] (theory §3.6).
#[derive(Clone, Copy, Debug)]
pub struct RoughGlass<'a> {
    /// How rough it is.
    pub facets: Microfacets,
    /// Index of refraction below the normal over that above it; not 1.
    pub ior: f32,
    /// The indices of the lanes, where they differ.
    pub fan: Option<Fan>,
    /// How much slower light is below than above, if there is no fan.
    pub slowness: f32,
    /// Tint of the reflected light, 0 to 1.
    pub reflectance: Spectrum,
    /// Tint of the refracted light, 0 to 1.
    pub transmittance: Spectrum,
    /// What the facets scatter at once, to give back what they do not (theory §3.7).
    pub once: Option<&'a BothSides>,
}

/// The share of light that a rough boundary scatters at once, from above and from below, and how what is left is divided.
#[derive(Clone, Debug)]
pub struct BothSides {
    above: Row,
    below: Row,
    /// Share of the light left over that is refracted, from above and from below.
    through: [f32; 2],
}

impl BothSides {
    /// Of these facets and this index, below over above.
    pub fn new(facets: &Microfacets, ior: f32) -> BothSides {
        let sum = |ior: f32| {
            let (reflected, through) = boundary(facets, ior);
            reflected.plus(&through)
        };
        let (above, below) = (sum(ior), sum(1.0 / ior));
        // Each side's share is in proportion to what a smooth boundary lets through, so that what goes one way and what
        // goes back agree; the proportion is the largest that exceeds the light left over on neither side.
        let left = [1.0 - above.mean, 1.0 - below.mean].map(|left| left.max(1e-6));
        let least = left[0].min(left[1]);
        let through = [ior, 1.0 / ior].map(|ior| (1.0 - fresnel::diffuse_reflectance(ior)) * least);
        BothSides { above, below, through: [through[0] / left[0], through[1] / left[1]] }
    }

    fn row(&self, up: bool) -> &Row {
        if up { &self.above } else { &self.below }
    }

    /// Share of the light from a direction that is left over.
    fn left(&self, direction: Vec3) -> f32 {
        (1.0 - self.row(direction.z > 0.0).at(direction.z.abs())).max(0.0)
    }
}

/// The direction behind a facet into which a boundary refracts, if it leads through the surface.
#[inline]
pub(super) fn refracted(direction: Vec3, normal: Vec3, boundary: &Boundary) -> Option<Vec3> {
    if boundary.cos_refracted == 0.0 {
        return None;
    }
    let toward = direction.dot(normal);
    let along = toward / boundary.ior_ratio - boundary.cos_refracted.copysign(toward);
    let to_next = (normal * along - direction / boundary.ior_ratio).normalize();
    (to_next.z * direction.z < 0.0).then_some(to_next)
}

/// What a facet of this normal (above the surface) means to two directions.
struct Facet {
    normal: Vec3,
    density: f32,
    boundary: Boundary,
    /// Cosines to the normal, of the sign that the side has.
    previous: f32,
    next: f32,
    reflects: bool,
}

impl RoughGlass<'_> {
    #[inline]
    fn facet(&self, to_previous: Vec3, to_next: Vec3) -> Option<Facet> {
        let reflects = diffuse::same_side(to_previous, to_next);
        let middle = to_previous + if reflects { to_next } else { to_next * self.ior_ratio(to_previous) };
        let normal = middle.try_normalize()?;
        let normal = if normal.z < 0.0 { -normal } else { normal };
        let (previous, next) = (to_previous.dot(normal), to_next.dot(normal));
        // No facet shows one side to a direction on the other.
        if previous * to_previous.z <= 0.0 || next * to_next.z <= 0.0 {
            return None;
        }
        let (density, boundary) = (self.facets.density(normal), fresnel::dielectric(previous, self.ior));
        Some(Facet { normal, density, boundary, previous, next, reflects })
    }

    /// The probability with which a facet reflects rather than refracts.
    #[inline]
    fn chance(&self, boundary: &Boundary) -> f32 {
        let reflected = boundary.reflectance * self.reflectance.max();
        let sum = reflected + (1.0 - boundary.reflectance) * self.transmittance.max();
        if sum > 0.0 { reflected / sum } else { 1.0 }
    }

    fn ior_ratio(&self, to_previous: Vec3) -> f32 {
        if to_previous.z > 0.0 { self.ior } else { 1.0 / self.ior }
    }

    /// The boundary as one lane has it.
    fn lane(&self, fan: &Fan, lane: usize) -> RoughGlass<'_> {
        RoughGlass { ior: fan.iors[lane], fan: None, ..*self }
    }

    /// The density over the facets of all lanes, each with this share.
    fn mean_pdf(&self, fan: &Fan, shares: [f32; 4], to_previous: Vec3, to_next: Vec3) -> f32 {
        let of_lane = |(lane, share)| match share {
            0.0 => 0.0,
            share => share * self.lane(fan, lane).pdf(Event::Glossy, to_previous, to_next),
        };
        shares.into_iter().enumerate().map(of_lane).sum()
    }

    /// The density with which this very path draws a direction. [`Scatter::pdf`], by which ways to find light are weighed
    /// against each other, must not depend on what the path carries: others that find the same light carry something else.
    pub(super) fn drawn_pdf(&self, event: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        match &self.fan {
            Some(fan) if event != Event::Diffuse => self.mean_pdf(fan, fan.chances, to_previous, to_next),
            _ => self.pdf(event, to_previous, to_next),
        }
    }

    /// Index of refraction on the far side over that on the near side, by lane, or `once` for all of them; and how much slower
    /// light of the first is there.
    pub(super) fn ior_ratios(&self, to_previous: Vec3, once: f32) -> (Spectrum, f32) {
        let across = |below: f32| if to_previous.z > 0.0 { below } else { 1.0 / below };
        match &self.fan {
            Some(fan) => (fan.lanes(across), across(fan.slowness[0])),
            None => (Spectrum::grey(once), across(self.slowness)),
        }
    }

    /// Value of the light that leaves after more than one facet.
    fn repeated(&self, both: &BothSides, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        let from_above = to_previous.z > 0.0;
        let through = both.through[usize::from(!from_above)];
        let tint = if diffuse::same_side(to_previous, to_next) {
            self.reflectance * (1.0 - through)
        } else {
            self.transmittance * through
        };
        let mean = both.row(to_next.z > 0.0).mean;
        tint * (both.left(to_previous) * both.left(to_next) / (PI * (1.0 - mean).max(1e-6)))
    }
}

impl Facet {
    /// Solid angle of normals per solid angle of directions `to_next`.
    #[inline]
    fn stretch(&self) -> f32 {
        if self.reflects {
            return 1.0 / (4.0 * self.previous.abs());
        }
        let ratio = self.boundary.ior_ratio;
        let sum = self.previous + ratio * self.next;
        ratio * ratio * self.next.abs() / (sum * sum)
    }
}

impl Scatter for RoughGlass<'_> {
    fn shares(&self, to_previous: Vec3) -> Shares {
        let mut shares = [Spectrum::ZERO; Event::ALL.len()];
        let reflected = fresnel::dielectric(to_previous.z, self.ior).reflectance;
        // A facet may let pass what the surface as a whole would mirror, and the other way round.
        shares[Event::Glossy.index()] = (self.reflectance * reflected + self.transmittance * (1.0 - reflected)) * 0.9
            + (self.reflectance + self.transmittance) * 0.05;
        if let Some(both) = self.once {
            shares[Event::Diffuse.index()] = Spectrum::grey(both.left(to_previous));
        }
        shares
    }

    fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        if let Some(fan) = &self.fan {
            let value = |lane: usize| self.lane(fan, lane).eval(to_previous, to_next).only(lane);
            return (0..4).fold(Spectrum::ZERO, |sum, lane| sum + value(lane));
        }
        let repeated = self.once.map_or(Spectrum::ZERO, |both| self.repeated(both, to_previous, to_next));
        let Some(facet) = self.facet(to_previous, to_next) else { return repeated };
        let masking = self.facets.visible(to_previous, facet.normal) * self.facets.visible(to_next, facet.normal);
        let share = facet.boundary.reflectance;
        let tint = if facet.reflects { self.reflectance * share } else { self.transmittance * (1.0 - share) };
        let value = facet.density * masking * facet.stretch() * facet.previous.abs();
        repeated + tint * (value / (to_previous.z * to_next.z).abs())
    }

    fn even(&self, _: Vec3) -> Option<Spectrum> {
        None
    }

    fn pdf(&self, event: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        if event == Event::Diffuse {
            let Some(both) = self.once else { return 0.0 };
            let through = both.through[usize::from(to_previous.z <= 0.0)];
            let share = if diffuse::same_side(to_previous, to_next) { 1.0 - through } else { through };
            return share * warp::cosine_hemisphere_pdf(to_next.z.abs());
        }
        if let Some(fan) = &self.fan {
            return self.mean_pdf(fan, [0.25; 4], to_previous, to_next);
        }
        let Some(facet) = self.facet(to_previous, to_next) else { return 0.0 };
        let chance = self.chance(&facet.boundary);
        let chance = if facet.reflects { chance } else { 1.0 - chance };
        self.facets.pdf(to_previous * to_previous.z.signum(), facet.normal) * chance * facet.stretch()
    }

    fn sample(&self, event: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)> {
        if event == Event::Diffuse {
            let through = self.once?.through[usize::from(to_previous.z <= 0.0)];
            let same = diffuse::sample(to_previous, u.truncate());
            return Some(if u.z < through { (-same, self.ior_ratio(to_previous)) } else { (same, 1.0) });
        }
        if let Some(fan) = &self.fan {
            let (lane, rest) = fan.choose(u.z);
            return self.lane(fan, lane).sample(event, to_previous, u.truncate().extend(rest));
        }
        let normal = self.facets.sample(to_previous * to_previous.z.signum(), u.truncate());
        let boundary = fresnel::dielectric(to_previous.dot(normal), self.ior);
        if u.z < self.chance(&boundary) {
            let to_next = mirrored(to_previous, normal);
            return diffuse::same_side(to_previous, to_next).then_some((to_next, 1.0));
        }
        refracted(to_previous, normal, &boundary).map(|to_next| (to_next, boundary.ior_ratio))
    }
}
