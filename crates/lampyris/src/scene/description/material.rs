//! Materials as a file gives them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Color, Ior, Paint, one};
pub use crate::material::{MicrofacetDistribution, WardVariant};

/// A material written in place or the name of one in `materials`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum MaterialRef {
    /// A name in `materials`.
    Named(String),
    /// A material of this place alone.
    Inline(Box<MaterialDescription>),
}

/// How a surface scatters light.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(tag = "type")]
pub enum MaterialDescription {
    /// Nothing: light goes straight through, as at the border of a medium in air.
    #[serde(rename_all = "kebab-case")]
    None {},
    /// Reflects equally in all directions (Lambert), on both sides unless wrapped otherwise.
    #[serde(rename_all = "kebab-case")]
    Diffuse {
        /// Share of the light that is reflected, 0 to 1 (default 0.5).
        #[serde(default = "Paint::half")]
        reflectance: Paint,
    },
    /// Reflects perfectly, without Fresnel, on both sides.
    #[serde(rename_all = "kebab-case")]
    Mirror {
        /// Share of the light that is reflected, 0 to 1 (default 1).
        #[serde(default = "Paint::one")]
        reflectance: Paint,
    },
    /// A boundary between two clear substances, with Fresnel; the normal points to the outside.
    #[serde(rename_all = "kebab-case")]
    Glass {
        /// Index of refraction inside (default 1.5): a number, the name of a substance, or a formula over the wavelength.
        #[serde(default = "Ior::glass")]
        ior: Ior,
        /// Index of refraction outside (default 1).
        #[serde(default = "Ior::one")]
        exterior_ior: Ior,
        /// Tint of the reflected light (default 1).
        #[serde(default = "Paint::one")]
        reflectance: Paint,
        /// Tint of the refracted light (default 1).
        #[serde(default = "Paint::one")]
        transmittance: Paint,
        /// How rough the boundary is; smooth by default.
        roughness: Option<Roughness>,
    },
    /// A thin pane: both surfaces and all reflections between them at once; light goes straight through.
    #[serde(rename_all = "kebab-case")]
    ThinGlass {
        /// Index of refraction of the pane (default 1.5).
        #[serde(default = "glass_ior")]
        ior: f32,
        /// Index of refraction around it (default 1).
        #[serde(default = "one")]
        exterior_ior: f32,
        /// Tint of the reflected light (default 1).
        #[serde(default = "Paint::one")]
        reflectance: Paint,
        /// Tint of the transmitted light (default 1).
        #[serde(default = "Paint::one")]
        transmittance: Paint,
    },
    /// A metal, by its name or its complex index of refraction per channel: give `metal`, or `eta` and `k`.
    #[serde(rename_all = "kebab-case")]
    Conductor {
        /// Name of a measured metal: a chemical symbol such as "Au", "Ag", "Cu", "Al".
        metal: Option<String>,
        /// Real part of the index of refraction.
        eta: Option<Color>,
        /// Imaginary part of the index of refraction.
        k: Option<Color>,
        /// Tint (default 1).
        #[serde(default = "Paint::one")]
        reflectance: Paint,
        /// How rough the surface is; smooth by default.
        roughness: Option<Roughness>,
    },
    /// A diffuse base under a clear coat, with Fresnel and the light that the coat sends back
    /// down; seen from the front only.
    #[serde(rename_all = "kebab-case")]
    Plastic {
        /// Colour of the base (default 0.5).
        #[serde(default = "Paint::half")]
        reflectance: Paint,
        /// Tint of the reflection on the coat (default 1).
        #[serde(default = "Paint::one")]
        specular: Paint,
        /// Index of refraction of the coat (default 1.5).
        #[serde(default = "glass_ior")]
        ior: f32,
        /// Index of refraction outside (default 1).
        #[serde(default = "one")]
        exterior_ior: f32,
        /// Whether repeated reflection under the coat saturates the colour (default false).
        #[serde(default)]
        nonlinear: bool,
        /// How rough the coat is; smooth by default.
        roughness: Option<Roughness>,
    },
    /// The course's mix of three coefficients, whose sum must not exceed 1 in any channel.
    #[serde(rename_all = "kebab-case")]
    Coefficients {
        /// Share that is reflected diffusely (default 0).
        #[serde(default)]
        kd: Color,
        /// Share that is mirrored (default 0).
        #[serde(default)]
        ks: Color,
        /// Share that meets a refractive boundary (default 0).
        #[serde(default)]
        kt: Color,
        /// Index of refraction inside (default 1.5).
        #[serde(default = "glass_ior")]
        ior: f32,
        /// With Fresnel (the default) the share `kt` is split by angle into reflection and refraction; without,
        /// all of it is refracted, and mirrored only under total internal reflection.
        #[serde(default = "yes")]
        fresnel: bool,
    },
    /// A rough diffuse surface of V-shaped grooves [Oren & Nayar 1994].
    #[serde(rename_all = "kebab-case")]
    RoughDiffuse {
        /// Share of the light that is reflected, 0 to 1 (default 0.5).
        #[serde(default = "Paint::half")]
        reflectance: Paint,
        /// Standard deviation of the grooves' slope angle times √2, in radians (default 0.2).
        #[serde(default = "rough_alpha")]
        alpha: Paint,
        /// The authors' qualitative model instead of the full one (default false).
        #[serde(default)]
        fast: bool,
    },
    /// Reflects and transmits diffusely, as paper and leaves do.
    #[serde(rename_all = "kebab-case")]
    DiffuseTransmission {
        /// Share that is reflected (default 0.25).
        #[serde(default = "Paint::quarter")]
        reflectance: Paint,
        /// Share that is transmitted (default 0.25).
        #[serde(default = "Paint::quarter")]
        transmittance: Paint,
    },
    /// Phong's model as Lafortune and Willems made it keep energy; seen from the front only.
    #[serde(rename_all = "kebab-case")]
    Phong {
        /// Share that is reflected diffusely (default 0.5).
        #[serde(default = "Paint::half")]
        diffuse: Paint,
        /// Share that is reflected glossily (default 0.2).
        #[serde(default = "Paint::fifth")]
        specular: Paint,
        /// The exponent of the cosine (default 30).
        #[serde(default = "phong_exponent")]
        exponent: Paint,
    },
    /// Ward's anisotropic model; seen from the front only.
    #[serde(rename_all = "kebab-case")]
    Ward {
        /// Which normalisation (default balanced).
        #[serde(default)]
        variant: WardVariant,
        /// Share that is reflected diffusely (default 0.5).
        #[serde(default = "Paint::half")]
        diffuse: Paint,
        /// Share that is reflected glossily (default 0.2).
        #[serde(default = "Paint::fifth")]
        specular: Paint,
        /// Roughness along the first texture coordinate (default 0.1).
        #[serde(default = "Paint::tenth")]
        alpha_u: Paint,
        /// Roughness along the second texture coordinate (default 0.1).
        #[serde(default = "Paint::tenth")]
        alpha_v: Paint,
    },
    /// The principled material [Burley 2012, 2015] with the parameters of Mitsuba 3's `principled`.
    Principled(Box<Principled>),
    /// The principled material of a thin sheet [Burley 2015] with the parameters of Mitsuba 3's `principledthin`.
    PrincipledThin(Box<PrincipledThin>),
    /// A material whose normal a picture turns.
    #[serde(rename_all = "kebab-case")]
    NormalMap {
        /// Name of the texture; its colours, read as raw numbers, are (n + 1) / 2 in the frame of tangents.
        normals: String,
        /// Factor of the first two coordinates of the normal (default 1).
        #[serde(default = "one")]
        strength: f32,
        /// What is turned.
        material: MaterialRef,
    },
    /// A material whose normal follows the slope of a height map.
    #[serde(rename_all = "kebab-case")]
    BumpMap {
        /// Name of the texture of heights, in scene units.
        height: String,
        /// Factor of the heights (default 1).
        #[serde(default = "one")]
        scale: f32,
        /// What is turned.
        material: MaterialRef,
    },
    /// The material on both sides of a surface, or another one on its back.
    #[serde(rename_all = "kebab-case")]
    TwoSided {
        /// On the side of the normal.
        front: MaterialRef,
        /// On the other side; the same by default.
        back: Option<MaterialRef>,
    },
    /// A material with holes.
    #[serde(rename_all = "kebab-case")]
    Mask {
        /// 1 where the material is, 0 where light passes straight through (default 0.5).
        #[serde(default = "Paint::half")]
        opacity: Paint,
        /// What is not hole.
        material: MaterialRef,
    },
    /// A linear mix of two materials.
    #[serde(rename_all = "kebab-case")]
    Blend {
        /// Share of the second, 0 to 1.
        weight: Paint,
        /// The material at weight 0.
        first: MaterialRef,
        /// The material at weight 1.
        second: MaterialRef,
    },
}

fn glass_ior() -> f32 {
    1.5
}

fn yes() -> bool {
    true
}

fn rough_alpha() -> Paint {
    Paint::grey(0.2)
}

fn phong_exponent() -> Paint {
    Paint::grey(30.0)
}

/// How rough a boundary is: the distribution of the normals of its microfacets.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Roughness {
    /// Roughness α along the first texture coordinate, and along the second too unless `alpha-v` is given
    /// (default 0.1).
    #[serde(default = "Paint::tenth")]
    pub alpha: Paint,
    /// Roughness α along the second texture coordinate.
    pub alpha_v: Option<Paint>,
    /// The distribution (default ggx).
    #[serde(default)]
    pub distribution: MicrofacetDistribution,
    /// Gives back the light that a model of single scattering loses between the facets (default false).
    #[serde(default)]
    pub multiple_scattering: bool,
}

/// See [`MaterialDescription::Principled`]. All are shares from 0 to 1 but for `eta`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct Principled {
    /// The colour (default 0.5).
    pub base_color: Paint,
    /// Square root of the microfacets' α (default 0.5).
    pub roughness: Paint,
    /// Stretches highlights along the second texture coordinate (default 0).
    pub anisotropic: Paint,
    /// From dielectric to metal (default 0).
    pub metallic: Paint,
    /// From diffuse to a clear substance (default 0).
    pub spec_trans: Paint,
    /// Index of refraction; by default that which `specular` gives.
    pub eta: Option<f32>,
    /// Reflectance at normal incidence over 0.08, in place of `eta` (default 0.5).
    pub specular: f32,
    /// Tints reflections with the base colour (default 0).
    pub spec_tint: Paint,
    /// Light on the edges of cloth (default 0).
    pub sheen: Paint,
    /// Tints the sheen with the base colour (default 0).
    pub sheen_tint: Paint,
    /// From diffuse to an approximation of subsurface scattering (default 0).
    pub flatness: Paint,
    /// A second, clear coat (default 0).
    pub clearcoat: Paint,
    /// How smooth that coat is (default 0).
    pub clearcoat_gloss: Paint,
}

impl Default for Principled {
    fn default() -> Principled {
        let none = || Paint::grey(0.0);
        Principled {
            base_color: Paint::half(),
            roughness: Paint::half(),
            anisotropic: none(),
            metallic: none(),
            spec_trans: none(),
            eta: None,
            specular: 0.5,
            spec_tint: none(),
            sheen: none(),
            sheen_tint: none(),
            flatness: none(),
            clearcoat: none(),
            clearcoat_gloss: none(),
        }
    }
}

/// See [`MaterialDescription::PrincipledThin`]. All are shares from 0 to 1 but for `eta` and `diff_trans`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct PrincipledThin {
    /// The colour (default 0.5).
    pub base_color: Paint,
    /// Square root of the microfacets' α (default 0.5).
    pub roughness: Paint,
    /// Stretches highlights along the second texture coordinate (default 0).
    pub anisotropic: Paint,
    /// From diffuse to a clear sheet (default 0).
    pub spec_trans: Paint,
    /// Index of refraction (default 1.5).
    pub eta: f32,
    /// Tints reflections with the base colour (default 0).
    pub spec_tint: Paint,
    /// Light on the edges of cloth (default 0).
    pub sheen: Paint,
    /// Tints the sheen with the base colour (default 0).
    pub sheen_tint: Paint,
    /// From diffuse to an approximation of subsurface scattering (default 0).
    pub flatness: Paint,
    /// Diffuse light that passes through: 0 none, 1 half, 2 all (default 0).
    pub diff_trans: Paint,
}

impl Default for PrincipledThin {
    fn default() -> PrincipledThin {
        let none = || Paint::grey(0.0);
        PrincipledThin {
            base_color: Paint::half(),
            roughness: Paint::half(),
            anisotropic: none(),
            spec_trans: none(),
            eta: 1.5,
            spec_tint: none(),
            sheen: none(),
            sheen_tint: none(),
            flatness: none(),
            diff_trans: none(),
        }
    }
}
