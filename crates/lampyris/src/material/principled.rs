//! The principled material [Burley 2012, 2015], as Mitsuba 3 defines it.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::diffuse::above;
use super::microfacet::mirrored;
use super::rough_glass::refracted;
use super::{Event, MicrofacetDistribution, Microfacets, Scatter, Shares, diffuse};
use crate::math::{fresnel, warp};
use crate::spectrum::Spectrum;

/// See [`MaterialDescription::Principled`](crate::scene::description::MaterialDescription), and theory §3.9.
#[derive(Clone, Copy, Debug)]
pub struct Principled {
    /// The colour.
    pub base_color: Spectrum,
    /// The luminance of the colour.
    pub luminance: f32,
    /// Square root of α.
    pub roughness: f32,
    /// How much longer highlights are along y.
    pub anisotropic: f32,
    /// From dielectric to metal.
    pub metallic: f32,
    /// From diffuse to a clear substance.
    pub spec_trans: f32,
    /// Whether light can pass anywhere on the surface.
    pub transmits: bool,
    /// Index of refraction below the normal over that above it.
    pub eta: f32,
    /// Tints reflections.
    pub spec_tint: f32,
    /// Light on the edges of cloth.
    pub sheen: f32,
    /// Tints the sheen.
    pub sheen_tint: f32,
    /// From diffuse to an approximation of subsurface scattering.
    pub flatness: f32,
    /// A second coat.
    pub clearcoat: f32,
    /// How smooth that coat is.
    pub clearcoat_gloss: f32,
}

/// Schlick's (1 - cos)⁵.
#[inline]
fn schlick_weight(cos: f32) -> f32 {
    (1.0 - cos).clamp(0.0, 1.0).powi(5)
}

/// Schlick's reflectance from that at normal incidence; from the denser side by the angle of refraction.
#[inline]
fn schlick(normal: Spectrum, cos: f32, ior: f32) -> Spectrum {
    let ratio = if cos >= 0.0 { ior } else { 1.0 / ior };
    let cos = if ratio > 1.0 { cos.abs() } else { (1.0 - (1.0 - cos * cos) / (ratio * ratio)).max(0.0).sqrt() };
    let weight = schlick_weight(cos);
    normal * (1.0 - weight) + Spectrum::grey(weight)
}

#[inline]
fn normal_reflectance(ior: f32) -> f32 {
    ((ior - 1.0) / (ior + 1.0)).powi(2)
}

/// The luminance of a colour in linear RGB.
#[inline]
pub(super) fn luminance(color: Spectrum) -> f32 {
    let [r, g, b] = color.to_rgb();
    0.212_671 * r + 0.715_16 * g + 0.072_169 * b
}

/// The colour at luminance 1; white where there is none.
#[inline]
fn tint(color: Spectrum, luminance: f32) -> Spectrum {
    if luminance > 0.0 { color / luminance } else { Spectrum::ONE }
}

#[inline]
fn mix(a: Spectrum, b: Spectrum, share: f32) -> Spectrum {
    a * (1.0 - share) + b * share
}

/// GGX facets of this roughness.
#[inline]
fn facets(roughness: f32, anisotropic: f32) -> Microfacets {
    let (alpha, aspect) = (roughness * roughness, (1.0 - 0.9 * anisotropic).sqrt());
    let alpha = Vec2::new(alpha / aspect, alpha * aspect).max(Vec2::splat(1e-3));
    Microfacets::new(MicrofacetDistribution::Ggx, alpha)
}

/// Diffuse reflection with light thrown back at grazing angles, times π; `flatness` mixes in a thin scattering layer.
#[inline]
fn diffuse_and_retro(roughness: f32, flatness: f32, previous: f32, next: f32, difference: f32) -> f32 {
    let (p, n) = (schlick_weight(previous), schlick_weight(next));
    let retro = 2.0 * roughness * difference * difference;
    let diffuse = (1.0 - 0.5 * p) * (1.0 - 0.5 * n) + retro * (n + p + n * p * (retro - 1.0));
    if flatness == 0.0 {
        return diffuse;
    }
    let grazing = 0.5 * retro;
    let layer = (1.0 + (grazing - 1.0) * n) * (1.0 + (grazing - 1.0) * p);
    let layer = 1.25 * (layer * (1.0 / (previous + next) - 0.5) + 0.5);
    diffuse * (1.0 - flatness) + layer * flatness
}

/// Sheen: light at grazing angles between the directions.
#[inline]
fn sheen(amount: f32, tinted: f32, (color, luminance): (Spectrum, f32), difference: f32) -> Spectrum {
    if amount == 0.0 {
        return Spectrum::ZERO;
    }
    mix(Spectrum::ONE, tint(color, luminance), tinted) * (amount * schlick_weight(difference))
}

/// The clear coat's facets: Burley's distribution with the longest tails, GTR1, of this α.
fn coat_density(alpha: f32, cos: f32) -> f32 {
    let alpha2 = alpha * alpha;
    (alpha2 - 1.0) / (PI * alpha2.ln() * (1.0 + (alpha2 - 1.0) * cos * cos))
}

fn sample_coat(alpha: f32, u: Vec2) -> Vec3 {
    let alpha2 = alpha * alpha;
    let cos2 = ((1.0 - alpha2.powf(1.0 - u.y)) / (1.0 - alpha2)).clamp(0.0, 1.0);
    (Vec2::from_angle(2.0 * PI * u.x) * (1.0 - cos2).sqrt()).extend(cos2.sqrt())
}

impl Principled {
    fn facets(&self) -> Microfacets {
        facets(self.roughness, self.anisotropic)
    }

    /// Weight of the clear substance, and of what is neither it nor metal.
    fn clear_and_opaque(&self) -> (f32, f32) {
        let dielectric = 1.0 - self.metallic;
        (dielectric * self.spec_trans, dielectric * (1.0 - self.spec_trans))
    }

    fn coat_alpha(&self) -> f32 {
        0.1 + (0.001 - 0.1) * self.clearcoat_gloss
    }

    /// The normal of the facet between the directions, above the surface; none where no facet shows the sides that they
    /// lie on.
    fn facet(&self, to_previous: Vec3, to_next: Vec3) -> Option<Vec3> {
        let ratio = if diffuse::same_side(to_previous, to_next) {
            1.0
        } else if to_previous.z > 0.0 {
            self.eta
        } else {
            1.0 / self.eta
        };
        let normal = (to_previous + to_next * ratio).try_normalize()?;
        let normal = if normal.z < 0.0 { -normal } else { normal };
        let shows = |direction: Vec3| direction.dot(normal) * direction.z > 0.0;
        (shows(to_previous) && shows(to_next)).then_some(normal)
    }

    /// Share that facets reflect: of metal by Schlick, of a dielectric exactly, tinted or not.
    fn reflected(&self, cos: f32, front: bool) -> Spectrum {
        let dielectric = fresnel::dielectric(cos, self.eta).reflectance;
        if !front {
            return Spectrum::grey(self.clear_and_opaque().0 * dielectric);
        }
        let mut reflected = Spectrum::grey((1.0 - self.metallic) * (1.0 - self.spec_tint) * dielectric);
        if self.metallic > 0.0 {
            reflected += schlick(self.base_color, cos, self.eta) * self.metallic;
        }
        if self.spec_tint > 0.0 {
            let ratio = if cos >= 0.0 { self.eta } else { 1.0 / self.eta };
            let normal = tint(self.base_color, self.luminance) * normal_reflectance(ratio);
            reflected += schlick(normal, cos, self.eta) * ((1.0 - self.metallic) * self.spec_tint);
        }
        reflected
    }

    /// The lobes above the surface that no facets make.
    fn cloth(&self, previous: f32, next: f32, difference: f32) -> Spectrum {
        let (_, opaque) = self.clear_and_opaque();
        if opaque <= 0.0 {
            return Spectrum::ZERO;
        }
        let diffuse = diffuse_and_retro(self.roughness, self.flatness, previous, next, difference);
        let sheen =
            sheen(self.sheen, self.sheen_tint, (self.base_color, self.luminance), difference) * (1.0 - self.metallic);
        self.base_color * (opaque * diffuse / PI) + sheen
    }

    /// The second coat, which shadows as if it had α = 1/4.
    fn coat(&self, to_previous: Vec3, to_next: Vec3, normal: Vec3) -> f32 {
        if self.clearcoat <= 0.0 {
            return 0.0;
        }
        let shadowing = Microfacets::new(MicrofacetDistribution::Ggx, Vec2::splat(0.25));
        let visible = shadowing.visible(to_previous, normal) * shadowing.visible(to_next, normal);
        let reflected = schlick(Spectrum::grey(0.04), to_previous.dot(normal), self.eta).max();
        0.25 * self.clearcoat * reflected * coat_density(self.coat_alpha(), normal.z) * visible
    }

    /// The probabilities of diffuse reflection, coat, refraction; reflection has the rest.
    fn chances(&self, front: bool, reflectance: f32) -> [f32; 3] {
        if !front {
            return [0.0, 0.0, if self.transmits { 1.0 - reflectance } else { 0.0 }];
        }
        let (clear, opaque) = self.clear_and_opaque();
        let coat = 0.25 * self.clearcoat;
        let refraction = if self.transmits { clear * (1.0 - reflectance) } else { 0.0 };
        [opaque, coat, refraction].map(|weight| weight / (1.0 + coat + opaque))
    }
}

impl Scatter for Principled {
    fn shares(&self, to_previous: Vec3) -> Shares {
        let mut shares = [Spectrum::ZERO; Event::ALL.len()];
        let clear = self.clear_and_opaque().0;
        if to_previous.z > 0.0 || clear > 0.0 {
            let reflected = self.reflected(to_previous.z, to_previous.z > 0.0);
            let rest = self.base_color * (1.0 - reflected.mean()).max(0.0);
            shares[Event::Glossy.index()] = reflected + rest + Spectrum::grey(0.05);
        }
        shares
    }

    fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        let (front, reflects) = (to_previous.z > 0.0, diffuse::same_side(to_previous, to_next));
        let (clear, _) = self.clear_and_opaque();
        if !reflects && clear <= 0.0 || to_previous.z == 0.0 || to_next.z == 0.0 {
            return Spectrum::ZERO;
        }
        let cosines = (to_previous.z * to_next.z).abs();
        let facet = self.facet(to_previous, to_next);
        let Some(normal) = facet else { return Spectrum::ZERO };
        let facets = self.facets();
        let masking = facets.visible(to_previous, normal) * facets.visible(to_next, normal);
        let density = facets.density(normal) * masking;
        let (previous, next) = (to_previous.dot(normal), to_next.dot(normal));
        if !reflects {
            let boundary = fresnel::dielectric(previous, self.eta);
            let ratio = boundary.ior_ratio;
            let stretch = ratio * ratio * (previous * next).abs() / (previous + ratio * next).powi(2);
            let value = clear * (1.0 - boundary.reflectance) * density * stretch / cosines;
            return self.base_color.map(f32::sqrt) * value;
        }
        let mut value = self.reflected(previous, front) * (density / (4.0 * cosines));
        if front {
            value += Spectrum::grey(self.coat(to_previous, to_next, normal));
            value += self.cloth(to_previous.z, to_next.z, next);
        }
        value
    }

    fn even(&self, _: Vec3) -> Option<Spectrum> {
        None
    }

    fn pdf(&self, _: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        let (front, reflects) = (to_previous.z > 0.0, diffuse::same_side(to_previous, to_next));
        let Some(normal) = self.facet(to_previous, to_next) else { return 0.0 };
        let (previous, next) = (to_previous.dot(normal), to_next.dot(normal));
        let boundary = fresnel::dielectric(previous, self.eta);
        let [diffuse, coat, refraction] = self.chances(front, boundary.reflectance);
        let density = self.facets().pdf(if front { to_previous } else { -to_previous }, normal);
        if !reflects {
            let ratio = boundary.ior_ratio;
            return refraction * density * ratio * ratio * next.abs() / (previous + ratio * next).powi(2);
        }
        let reflection = 1.0 - diffuse - coat - refraction;
        let mut pdf = reflection * density / (4.0 * next.abs());
        if front {
            pdf += diffuse * warp::cosine_hemisphere_pdf(to_next.z);
            pdf += coat * coat_density(self.coat_alpha(), normal.z) * normal.z / (4.0 * next.abs());
        }
        pdf
    }

    fn sample(&self, _: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)> {
        let front = to_previous.z > 0.0;
        let facet = self.facets().sample(if front { to_previous } else { -to_previous }, u.truncate());
        let boundary = fresnel::dielectric(to_previous.dot(facet), self.eta);
        let [diffuse, coat, refraction] = self.chances(front, boundary.reflectance);
        if u.z < diffuse {
            return Some((warp::cosine_hemisphere(u.truncate()), 1.0));
        }
        if u.z < diffuse + coat {
            let to_next = mirrored(to_previous, sample_coat(self.coat_alpha(), u.truncate()));
            return (to_next.z > 0.0).then_some((to_next, 1.0));
        }
        if u.z < diffuse + coat + refraction {
            return refracted(to_previous, facet, &boundary).map(|to_next| (to_next, boundary.ior_ratio));
        }
        let to_next = mirrored(to_previous, facet);
        diffuse::same_side(to_previous, to_next).then_some((to_next, 1.0))
    }
}

/// The principled material of a thin sheet, the same from both sides: see
/// [`MaterialDescription::PrincipledThin`](crate::scene::description::MaterialDescription), and theory §3.9.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledThin {
    /// The colour.
    pub base_color: Spectrum,
    /// The luminance of the colour.
    pub luminance: f32,
    /// Square root of α.
    pub roughness: f32,
    /// How much longer highlights are along y.
    pub anisotropic: f32,
    /// From diffuse to a clear sheet.
    pub spec_trans: f32,
    /// Index of refraction of the sheet.
    pub eta: f32,
    /// Tints reflections.
    pub spec_tint: f32,
    /// Light on the edges of cloth.
    pub sheen: f32,
    /// Tints the sheen.
    pub sheen_tint: f32,
    /// From diffuse to an approximation of subsurface scattering.
    pub flatness: f32,
    /// Share of the diffuse light that passes, 0 to 1.
    pub diff_trans: f32,
}

impl PrincipledThin {
    /// The facets of reflection, or those that widen what passes as two refractions would [Burley 2015].
    fn facets(&self, reflects: bool) -> Microfacets {
        let scale = if reflects { 1.0 } else { 0.65 * self.eta - 0.35 };
        facets(scale * self.roughness, self.anisotropic)
    }

    /// The probabilities of reflection on facets, passing them, and diffuse reflection; diffuse passing has the rest.
    fn chances(&self) -> [f32; 3] {
        let clear = 0.5 * self.spec_trans;
        [clear, clear, (1.0 - self.spec_trans) * (1.0 - self.diff_trans)]
    }
}

impl Scatter for PrincipledThin {
    fn shares(&self, _: Vec3) -> Shares {
        let mut shares = [Spectrum::ZERO; Event::ALL.len()];
        shares[Event::Glossy.index()] = self.base_color * 0.9 + Spectrum::grey(0.1);
        shares
    }

    fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        let reflects = diffuse::same_side(to_previous, to_next);
        let (a, b) = (above(to_previous), above(to_next));
        let facets = self.facets(reflects);
        let Some((clear, normal)) = facets.reflection(a, b) else { return Spectrum::ZERO };
        let cos = a.dot(normal);
        let dielectric = fresnel::dielectric(cos, self.eta).reflectance;
        let opaque = 1.0 - self.spec_trans;
        if !reflects {
            let passing = self.base_color * (opaque * self.diff_trans / PI);
            return passing + self.base_color * (self.spec_trans * (1.0 - dielectric) * clear);
        }
        let mut reflected = Spectrum::grey(dielectric);
        if self.spec_tint > 0.0 {
            let normal = tint(self.base_color, self.luminance) * normal_reflectance(self.eta);
            reflected = mix(reflected, schlick(normal, cos, self.eta), self.spec_tint);
        }
        let diffuse = diffuse_and_retro(self.roughness, self.flatness, a.z, b.z, cos);
        let cloth = self.base_color * (diffuse / PI)
            + sheen(self.sheen, self.sheen_tint, (self.base_color, self.luminance), cos);
        reflected * (self.spec_trans * clear) + cloth * (opaque * (1.0 - self.diff_trans))
    }

    fn even(&self, _: Vec3) -> Option<Spectrum> {
        None
    }

    fn pdf(&self, _: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        let reflects = diffuse::same_side(to_previous, to_next);
        let (a, b) = (above(to_previous), above(to_next));
        let [reflection, passing, diffuse] = self.chances();
        let (clear, diffuse) =
            if reflects { (reflection, diffuse) } else { (passing, 1.0 - reflection - passing - diffuse) };
        clear * self.facets(reflects).reflection_pdf(a, b) + diffuse.max(0.0) * warp::cosine_hemisphere_pdf(b.z)
    }

    fn sample(&self, _: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)> {
        let above = above(to_previous);
        let [reflection, passing, diffuse] = self.chances();
        let reflects = u.z < reflection || (u.z >= reflection + passing && u.z < reflection + passing + diffuse);
        let to_next = if u.z < reflection + passing {
            self.facets(reflects).sample_reflection(above, u.truncate())?
        } else {
            warp::cosine_hemisphere(u.truncate())
        };
        let side = if reflects { to_previous.z } else { -to_previous.z };
        Some((to_next.with_z(to_next.z.copysign(side)), 1.0))
    }
}
