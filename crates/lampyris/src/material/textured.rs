//! Materials of many textures, looked up at one point.

use glam::Vec2;

use super::{MicrofacetDistribution, Microfacets, Principled, PrincipledThin, principled};
use crate::texture::{Lookup, Texture};

/// How rough a boundary is, everywhere.
#[derive(Clone, Debug)]
pub struct RoughTextures {
    /// The distribution.
    pub distribution: MicrofacetDistribution,
    /// α along x.
    pub alpha_u: Texture,
    /// α along y, if it is another one.
    pub alpha_v: Option<Texture>,
}

impl RoughTextures {
    /// The facets there.
    #[inline]
    pub fn at(&self, at: &Lookup) -> Microfacets {
        let u = self.alpha_u.at(at).mean();
        let v = self.alpha_v.as_ref().map_or(u, |texture| texture.at(at).mean());
        Microfacets::new(self.distribution, Vec2::new(u, v))
    }

    /// Whether tangents matter.
    pub fn is_anisotropic(&self) -> bool {
        self.alpha_v.is_some()
    }
}

/// The textures of [`Principled`], which says what they mean.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the fields of `Principled` by the same names")]
pub struct PrincipledTextures {
    pub base_color: Texture,
    pub roughness: Texture,
    pub anisotropic: Texture,
    pub metallic: Texture,
    pub spec_trans: Texture,
    pub transmits: bool,
    pub eta: f32,
    pub spec_tint: Texture,
    pub sheen: Texture,
    pub sheen_tint: Texture,
    pub flatness: Texture,
    pub clearcoat: Texture,
    pub clearcoat_gloss: Texture,
}

impl PrincipledTextures {
    pub(super) fn at(&self, at: &Lookup) -> Principled {
        let base_color = self.base_color.at(at);
        Principled {
            base_color: at.basis.lanes(base_color),
            luminance: principled::luminance(base_color),
            roughness: self.roughness.at(at).mean(),
            anisotropic: self.anisotropic.at(at).mean(),
            metallic: self.metallic.at(at).mean(),
            spec_trans: self.spec_trans.at(at).mean(),
            transmits: self.transmits,
            eta: self.eta,
            spec_tint: self.spec_tint.at(at).mean(),
            sheen: self.sheen.at(at).mean(),
            sheen_tint: self.sheen_tint.at(at).mean(),
            flatness: self.flatness.at(at).mean(),
            clearcoat: self.clearcoat.at(at).mean(),
            clearcoat_gloss: self.clearcoat_gloss.at(at).mean(),
        }
    }
}

/// The textures of [`PrincipledThin`], which says what they mean; `diff_trans` is from 0 to 2.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the fields of `PrincipledThin` by the same names")]
pub struct PrincipledThinTextures {
    pub base_color: Texture,
    pub roughness: Texture,
    pub anisotropic: Texture,
    pub spec_trans: Texture,
    pub eta: f32,
    pub spec_tint: Texture,
    pub sheen: Texture,
    pub sheen_tint: Texture,
    pub flatness: Texture,
    pub diff_trans: Texture,
}

impl PrincipledThinTextures {
    pub(super) fn at(&self, at: &Lookup) -> PrincipledThin {
        let base_color = self.base_color.at(at);
        PrincipledThin {
            base_color: at.basis.lanes(base_color),
            luminance: principled::luminance(base_color),
            roughness: self.roughness.at(at).mean(),
            anisotropic: self.anisotropic.at(at).mean(),
            spec_trans: self.spec_trans.at(at).mean(),
            eta: self.eta,
            spec_tint: self.spec_tint.at(at).mean(),
            sheen: self.sheen.at(at).mean(),
            sheen_tint: self.sheen_tint.at(at).mean(),
            flatness: self.flatness.at(at).mean(),
            diff_trans: 0.5 * self.diff_trans.at(at).mean(),
        }
    }
}
