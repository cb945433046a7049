//! Textures as a file gives them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Paint, Transform};
pub use crate::texture::{Channel, TextureFilter, Wrap};

/// A texture: a colour that varies over a surface.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(tag = "type")]
pub enum TextureDescription {
    /// A picture. 8-bit and 16-bit files are decoded from sRGB unless `raw`.
    #[serde(rename_all = "kebab-case")]
    Bitmap {
        /// The picture's file, relative to the scene's folder.
        file: String,
        /// Take the numbers as linear, as for a map of weights (default false).
        #[serde(default)]
        raw: bool,
        /// What of the picture is taken (default color).
        #[serde(default)]
        channel: Channel,
        /// What happens between pixels and where they are smaller than what a ray sees (default bilinear).
        #[serde(default)]
        filter: TextureFilter,
        /// What happens outside 0..1 (default repeat).
        #[serde(default)]
        wrap: Wrap,
        /// Another such rule for the second texture coordinate; the same by default.
        wrap_v: Option<Wrap>,
        /// Maps the surface's (u, v, 0) before the look-up.
        #[serde(default)]
        to_uv: Transform,
    },
    /// Two colours in squares: `color0` where floor(u) + floor(v) is even after `to-uv` and a doubling of
    /// (u, v), as Mitsuba has it.
    #[serde(rename_all = "kebab-case")]
    Checkerboard {
        /// Colour of the even squares (default 0.4).
        #[serde(default = "Paint::dark")]
        color0: Paint,
        /// Colour of the odd squares (default 0.2).
        #[serde(default = "Paint::darker")]
        color1: Paint,
        /// Maps the surface's (u, v, 0) before the look-up.
        #[serde(default)]
        to_uv: Transform,
    },
    /// The colours of the vertices of a mesh, white on all else.
    #[serde(rename_all = "kebab-case")]
    VertexColor {},
    /// Two textures multiplied.
    #[serde(rename_all = "kebab-case")]
    Product {
        /// One.
        first: Paint,
        /// The other.
        second: Paint,
    },
    /// A linear mix of two textures.
    #[serde(rename_all = "kebab-case")]
    Mix {
        /// Share of the second, 0 to 1.
        weight: Paint,
        /// The texture at weight 0.
        first: Paint,
        /// The texture at weight 1.
        second: Paint,
    },
    /// 1 where a texture is at least as bright as a number, 0 elsewhere, channel by channel: holes with sharp edges.
    #[serde(rename_all = "kebab-case")]
    Threshold {
        /// What is compared.
        texture: Paint,
        /// The number, at least 0 (default 0.5).
        #[serde(default = "half")]
        least: f32,
    },
}

fn half() -> f32 {
    0.5
}
