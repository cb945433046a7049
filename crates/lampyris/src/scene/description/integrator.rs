//! The integrators and their settings, as files and `--set` give them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the light is computed.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(tag = "type")]
pub enum IntegratorDescription {
    /// Path tracing that merges with photons where they help.
    Auto(AutoSettings),
    /// Photon mapping: walks from the lamps leave photons, walks from the camera gather them.
    PhotonMap(PhotonMapSettings),
    /// Path tracing with next-event estimation and multiple importance sampling: the reference.
    Path(PathSettings),
    /// Light tracing: walks from the lamps, each vertex connected to the camera.
    Light(LightSettings),
}

impl Default for IntegratorDescription {
    fn default() -> IntegratorDescription {
        IntegratorDescription::Auto(AutoSettings::default())
    }
}

/// Settings of `photon-map`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct PhotonMapSettings {
    /// Light paths a pass (default 100,000).
    pub photons: u32,
    /// Camera samples per pixel and pass (default 1).
    pub samples: u32,
    /// The weight of a photon by its distance (default epanechnikov).
    pub kernel: KernelName,
    /// How the radius is chosen (default shrinking).
    pub bandwidth: BandwidthRule,
    /// Number of photons for `bandwidth = "nearest"`, and for the choice of a radius where none is given (default 50).
    pub k: u32,
    /// The radius in scene units: of `fixed`, at the first pass of `shrinking`, at most of `nearest`. By default it
    /// is chosen so that a typical estimate finds `k` photons in the first pass.
    pub radius: Option<f32>,
    /// How slowly `shrinking` shrinks, 0 to 1 (default 2/3, the optimum on surfaces).
    pub alpha: f32,
    /// Whether direct light comes from next-event estimation or from photons (default next-event).
    pub direct: Direct,
    /// The longest path, counted in scattering events (default 256).
    pub max_bounces: u32,
    /// How light in media is estimated; by default beams, or points where the medium is dense beside the radius.
    pub volume: Option<VolumeName>,
    /// The radius in media at the first pass, in scene units. By default it is chosen so that a typical ray finds `k` photons
    /// in the first pass.
    pub volume_radius: Option<f32>,
    /// How slowly that shrinks, 0 to 1; by default the optimum: 4/5 for beams, 2/3 for points, 4/7 for balls. A fixed
    /// `bandwidth` keeps it fixed.
    pub volume_alpha: Option<f32>,
    /// The picture, or the photon map itself.
    pub show: Show,
}

impl Default for PhotonMapSettings {
    fn default() -> PhotonMapSettings {
        PhotonMapSettings {
            photons: 100_000,
            samples: 1,
            kernel: KernelName::Epanechnikov,
            bandwidth: BandwidthRule::Shrinking,
            k: 50,
            radius: None,
            alpha: 2.0 / 3.0,
            direct: Direct::NextEvent,
            max_bounces: DEFAULT_MAX_BOUNCES,
            volume: None,
            volume_radius: None,
            volume_alpha: None,
            show: Show::Radiance,
        }
    }
}

const DEFAULT_MAX_BOUNCES: u32 = 256;

/// Settings of `auto`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct AutoSettings {
    /// Light paths a pass; by default chosen by what they are worth, none or 1/8 to 4 times half as many as the picture has
    /// pixels.
    pub photons: Option<u32>,
    /// Camera samples per pixel and pass (default 1).
    pub samples: u32,
    /// How far photons are looked for in the first pass, over the width of a pixel on the surface that it shows. By
    /// default it is chosen so that a typical point finds 20 photons, if that takes no more than 8, and smaller again where
    /// it does; at least 3.
    pub radius: Option<f32>,
    /// How slowly the radius shrinks, 0 to 1 (default 2/3, the optimum on surfaces).
    pub alpha: f32,
    /// How light in media is estimated; by default beams, or points where the medium is dense beside the radius.
    pub volume: Option<VolumeName>,
    /// The radius in media at the first pass, in scene units; by default it is chosen so that a typical ray finds 30 photons.
    pub volume_radius: Option<f32>,
    /// Whether photons leave for where they count, and shadow rays for what is likely to be seen (default), or only by the power
    /// of the lights.
    pub guiding: bool,
    /// Whether paths of pixels nearby lend each other what they find (default), where no photons are left.
    pub reuse: bool,
    /// The longest path, counted in scattering events (default 256).
    pub max_bounces: u32,
}

impl Default for AutoSettings {
    fn default() -> AutoSettings {
        let (alpha, max_bounces) = (2.0 / 3.0, DEFAULT_MAX_BOUNCES);
        AutoSettings {
            photons: None,
            samples: 1,
            radius: None,
            alpha,
            volume: None,
            volume_radius: None,
            guiding: true,
            reuse: true,
            max_bounces,
        }
    }
}

/// Settings of `path`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct PathSettings {
    /// Camera samples per pixel and pass (default 1).
    pub samples: u32,
    /// Whether shadow rays are shot at what points are likely to see of the lights (default), or at all of them alike.
    pub guiding: bool,
    /// Whether paths of pixels nearby lend each other what they find (default), or the noise of every pixel is its own.
    pub reuse: bool,
    /// The longest path, counted in scattering events (default 256).
    pub max_bounces: u32,
}

impl Default for PathSettings {
    fn default() -> PathSettings {
        PathSettings { samples: 1, guiding: true, reuse: true, max_bounces: DEFAULT_MAX_BOUNCES }
    }
}

/// Settings of `light`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct LightSettings {
    /// Light paths a pass; as many as the picture has pixels by default.
    pub photons: Option<u32>,
    /// The longest path, counted in scattering events (default 256).
    pub max_bounces: u32,
}

impl Default for LightSettings {
    fn default() -> LightSettings {
        LightSettings { photons: None, max_bounces: DEFAULT_MAX_BOUNCES }
    }
}

/// The name of a density-estimation kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum KernelName {
    /// The same weight everywhere.
    Box,
    /// Falls linearly to zero.
    Cone,
    /// A Gaussian, cut at the radius.
    Gaussian,
    /// A parabola, 1 − s²: the least mean squared error.
    #[default]
    Epanechnikov,
    /// (1 − s²)²: smooth at the edge.
    Biweight,
    /// A quarter wave of a cosine.
    Cosine,
}

/// How light in media is estimated from photons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum VolumeName {
    /// Where a ray crosses the ways of light: a blur in one dimension.
    Beams,
    /// Around a ray, where light has met particles: a blur in two dimensions.
    Points,
    /// Around a point of a ray, where light has met particles: a blur in three dimensions.
    Balls,
}

/// How the radius of an estimate is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BandwidthRule {
    /// Always `radius`.
    Fixed,
    /// The distance of the k-th nearest photon, at most `radius`.
    Nearest,
    /// From `radius` downwards, pass by pass, so that the picture converges [Knaus & Zwicker 2011].
    #[default]
    Shrinking,
}

/// Where direct light comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Direct {
    /// Shadow rays to the lights.
    #[default]
    NextEvent,
    /// Photons, as all other light.
    Photons,
}

/// What `photon-map` draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Show {
    /// The picture.
    #[default]
    Radiance,
    /// Every photon as a dot.
    Photons,
    /// Only photons that met glass or a mirror before they landed.
    Caustics,
}
