//! What a scene file says: names unresolved, numbers unchecked. Every importer ends in a
//! [`SceneDescription`]; [`build`](crate::scene::build) turns it into a [`Scene`](crate::scene::Scene) or an error.
//!
//! Enums here are written in TOML as a table with a `type`; `import::toml` rewrites that to serde's
//! external tags, which keep the place of every value.

mod camera;
mod color;
mod film;
mod integrator;
mod ior;
mod light;
mod material;
mod medium;
mod shape;
mod texture;
mod transform;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use camera::{CameraDescription, CaptureDescription, CaptureMode, FovAxis, Projection};
pub use color::{Color, Paint};
pub use film::{FilmDescription, FilterDescription, PhasorDescription, RenderDescription, TimeDescription};
pub use integrator::{
    AutoSettings, BandwidthRule, Direct, IntegratorDescription, KernelName, LightSettings, PathSettings,
    PhotonMapSettings, Show, VolumeName,
};
pub use ior::{Ior, IorFormula};
pub use light::{EnvironmentMapping, LightDescription};
pub use material::{
    MaterialDescription, MaterialRef, MicrofacetDistribution, Principled, PrincipledThin, Roughness, WardVariant,
};
pub use medium::{MediumDescription, PhaseDescription};
pub use shape::{EmissionDescription, GeometryDescription, ShapeDescription};
pub use texture::{Channel, TextureDescription, TextureFilter, Wrap};
pub use transform::Transform;

/// A whole scene.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct SceneDescription {
    /// Where we look from. A scene must have one.
    pub camera: Option<CameraDescription>,
    /// Size and filter of the picture.
    #[serde(default)]
    pub film: FilmDescription,
    /// How the light is computed; photon mapping by default.
    #[serde(default)]
    pub integrator: IntegratorDescription,
    /// How much work and which random numbers.
    #[serde(default)]
    pub render: RenderDescription,
    /// Textures by name.
    #[serde(default)]
    pub textures: BTreeMap<String, TextureDescription>,
    /// Materials by name.
    #[serde(default)]
    pub materials: BTreeMap<String, MaterialDescription>,
    /// Media by name: what fills space inside of shapes, or all around.
    #[serde(default)]
    pub media: BTreeMap<String, MediumDescription>,
    /// The name of the medium around everything; none by default.
    pub medium: Option<String>,
    /// All surfaces.
    #[serde(default)]
    pub shapes: Vec<ShapeDescription>,
    /// Groups of shapes by name, which stand in the scene only through shapes of the type `instance`. They hold no
    /// instances and emit no light.
    #[serde(default)]
    pub groups: BTreeMap<String, Vec<ShapeDescription>>,
    /// All lights that are not the emission of a shape.
    #[serde(default)]
    pub lights: Vec<LightDescription>,
}

fn one() -> f32 {
    1.0
}
