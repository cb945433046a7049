//! Colours that vary over a surface.

mod bitmap;
mod checkerboard;
mod pyramid;
mod raster;

use std::ops::BitOr;

use glam::Vec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use bitmap::Bitmap;
pub use checkerboard::Checkerboard;
pub use pyramid::Pyramid;
pub use raster::{Curve, Raster, Texels};

use crate::spectrum::{Basis, Spectrum};

/// A colour at every point of a surface.
#[derive(Clone, Debug)]
pub enum Texture {
    /// The same everywhere.
    Constant(Spectrum),
    /// A picture.
    Bitmap(Bitmap),
    /// Squares of two colours.
    Checkerboard(Box<Checkerboard>),
    /// The colours of the vertices.
    VertexColor,
    /// Two textures multiplied.
    Product(Box<[Texture; 2]>),
    /// A linear mix: weight of the second, the first, the second.
    Mix(Box<[Texture; 3]>),
    /// A texture whose values above 1 are cut.
    AtMostOne(Box<Texture>),
    /// 1 where a texture is at least as bright as this number, 0 elsewhere, by channel.
    Threshold(Box<Texture>, f32),
}

/// What a texture is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookup<'a> {
    /// Texture coordinates.
    pub uv: Vec2,
    /// The colour that the vertices around the point give it; white without such colours.
    pub vertex_color: Spectrum,
    /// Across what the ray sees there, in texture coordinates; 0 for a point.
    pub footprint: f32,
    /// What the lanes of the pass are.
    pub basis: &'a Basis,
    /// What the path that looks carries in each lane, up to a factor.
    pub carried: &'a Spectrum,
}

impl Lookup<'_> {
    /// At a point without extent or vertex colour, in an RGB pass.
    pub fn point(uv: Vec2) -> Lookup<'static> {
        Lookup { uv, vertex_color: Spectrum::ONE, footprint: 0.0, basis: &Basis::Rgb, carried: &Spectrum::ONE }
    }
}

/// What of a [`Lookup`] must be filled in besides the texture coordinates, for a look-up to be right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asks {
    /// Its footprint.
    pub footprint: bool,
    /// Its vertex colour.
    pub vertex_color: bool,
}

impl Asks {
    /// Whether texture coordinates are enough.
    #[inline]
    pub fn is_none(self) -> bool {
        self == Asks::default()
    }
}

impl BitOr for Asks {
    type Output = Asks;

    fn bitor(self, other: Asks) -> Asks {
        let footprint = self.footprint || other.footprint;
        Asks { footprint, vertex_color: self.vertex_color || other.vertex_color }
    }
}

impl Texture {
    /// What its look-ups need.
    pub fn asks(&self) -> Asks {
        match self {
            Texture::Constant(_) => Asks::default(),
            Texture::Bitmap(bitmap) => Asks { footprint: bitmap.filter == TextureFilter::Mip, ..Asks::default() },
            Texture::Checkerboard(checkerboard) => checkerboard.color0.asks() | checkerboard.color1.asks(),
            Texture::VertexColor => Asks { vertex_color: true, ..Asks::default() },
            Texture::Product(factors) => factors[0].asks() | factors[1].asks(),
            Texture::Mix(mix) => mix[0].asks() | mix[1].asks() | mix[2].asks(),
            Texture::AtMostOne(inner) | Texture::Threshold(inner, _) => inner.asks(),
        }
    }

    /// Columns and rows of the largest picture in it; 0 without pictures.
    pub fn texels(&self) -> [usize; 2] {
        let larger = |[a, b]: [usize; 2], [c, d]: [usize; 2]| [a.max(c), b.max(d)];
        match self {
            Texture::Constant(_) | Texture::VertexColor => [0; 2],
            Texture::Bitmap(bitmap) => {
                let picture = bitmap.pyramid.picture(0);
                [picture.width(), picture.height()]
            }
            Texture::Checkerboard(checkerboard) => larger(checkerboard.color0.texels(), checkerboard.color1.texels()),
            Texture::Product(factors) => factors.iter().map(Texture::texels).fold([0; 2], larger),
            Texture::Mix(mix) => mix.iter().map(Texture::texels).fold([0; 2], larger),
            Texture::AtMostOne(inner) | Texture::Threshold(inner, _) => inner.texels(),
        }
    }

    /// The colour there, in the lanes of the pass.
    #[inline]
    pub fn lanes(&self, lookup: &Lookup) -> Spectrum {
        lookup.basis.lanes(self.at(lookup))
    }

    /// The colour there, in linear RGB.
    #[inline]
    pub fn at(&self, lookup: &Lookup) -> Spectrum {
        match self {
            Texture::Constant(color) => *color,
            _ => self.varying(lookup),
        }
    }

    /// [`Texture::at`] of textures that are not the same everywhere.
    fn varying(&self, lookup: &Lookup) -> Spectrum {
        match self {
            Texture::Constant(color) => *color,
            Texture::Bitmap(bitmap) => bitmap.at(lookup),
            Texture::Checkerboard(checkerboard) => checkerboard.at(lookup),
            Texture::VertexColor => lookup.vertex_color,
            Texture::Product(factors) => factors[0].at(lookup) * factors[1].at(lookup),
            Texture::Mix(mix) => {
                let [weight, first, second] = &**mix;
                let weight = weight.at(lookup);
                let rest = weight.map(|weight| 1.0 - weight);
                first.at(lookup) * rest + second.at(lookup) * weight
            }
            Texture::AtMostOne(inner) => inner.at(lookup).map(|value| value.min(1.0)),
            Texture::Threshold(inner, least) => inner.at(lookup).map(|value| if value >= *least { 1.0 } else { 0.0 }),
        }
    }
}

impl Texture {
    /// Width over height of the picture, if it is one.
    pub fn aspect(&self) -> Option<f32> {
        match self {
            Texture::Bitmap(bitmap) => {
                let picture = bitmap.pyramid.picture(0);
                Some(picture.width() as f32 / picture.height() as f32)
            }
            _ => None,
        }
    }
}

/// What a texture is outside the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture mirrored, then again.
    Mirror,
    /// The colour of the border.
    Clamp,
    /// Black.
    Black,
    /// White.
    White,
}

/// How the pixels of a picture become a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TextureFilter {
    /// The nearest pixel.
    Nearest,
    /// Linear between pixels.
    #[default]
    Bilinear,
    /// Linear between pixels of the picture, made smaller by halves as far as a ray sees it [Williams 1983].
    Mip,
}

/// What of a picture a texture takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Channel {
    /// Red, green and blue.
    #[default]
    Color,
    /// The red channel alone, as grey.
    Red,
    /// The green channel alone, as grey.
    Green,
    /// The blue channel alone, as grey.
    Blue,
    /// The opacity, as grey; 1 where the file has none.
    Alpha,
}
