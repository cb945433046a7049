//! Colours that vary over a surface.

mod bitmap;
mod checkerboard;

use glam::Vec2;
use schemars::JsonSchema;
use serde::Deserialize;

pub use bitmap::Bitmap;
pub use checkerboard::Checkerboard;

use crate::spectrum::Spectrum;

/// A colour at every point of a surface.
#[derive(Clone, Debug)]
pub enum Texture {
    /// The same everywhere.
    Constant(Spectrum),
    /// A picture.
    Bitmap(Bitmap),
    /// Squares of two colours.
    Checkerboard(Checkerboard),
}

impl Texture {
    /// The colour at these texture coordinates.
    #[inline]
    pub fn at(&self, uv: Vec2) -> Spectrum {
        match self {
            Texture::Constant(color) => *color,
            Texture::Bitmap(bitmap) => bitmap.at(uv),
            Texture::Checkerboard(checkerboard) => checkerboard.at(uv),
        }
    }
}

/// What a texture is outside the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture mirrored, then again.
    Mirror,
    /// The colour of the border.
    Clamp,
}
