//! Textures, by name and in place.

use std::collections::HashMap;
use std::mem;
use std::sync::Arc;

use glam::{Affine2, Mat2, Vec2};

use super::check;
use super::materials::unknown;
use crate::error::{Error, Result};
use crate::scene::Assets;
use crate::scene::description::{Paint, SceneDescription, TextureDescription, TextureFilter, Transform};
use crate::texture::{Asks, Bitmap, Checkerboard, Pyramid, Texture};

/// Textures can be made of textures, so deep. Three to a mix, they are some thousands at most.
const DEEPEST: usize = 8;

/// Textures with all that they are made of, each counted wherever it is used: what is named is made anew there, so that
/// a short file could ask for millions.
const MOST: usize = 1 << 20;

/// Resolves textures as materials and lights ask for them.
pub(super) struct Builder<'d> {
    description: &'d SceneDescription,
    assets: &'d dyn Assets,
    /// The named textures that are being built, each inside the one before it.
    under_way: Vec<&'d str>,
    pyramids: HashMap<Decoded<'d>, Arc<Pyramid>>,
    asked: Asks,
    /// Textures built so far.
    built: usize,
}

/// What makes two uses of one file differ in memory.
#[derive(PartialEq, Eq, Hash)]
struct Decoded<'d> {
    file: &'d str,
    raw: bool,
    mip: bool,
    quantity: Quantity,
}

/// What a texture gives, and so how large its values may be.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Quantity {
    /// A share of light, 0 to 1: pictures are cut there.
    Share,
    /// Light, of any strength.
    Light,
    /// A height: any number.
    Height,
}

impl<'d> Builder<'d> {
    pub(super) fn new(description: &'d SceneDescription, assets: &'d dyn Assets) -> Builder<'d> {
        let (under_way, pyramids) = (Vec::new(), HashMap::new());
        Builder { description, assets, under_way, pyramids, asked: Asks::default(), built: 0 }
    }

    /// What the textures built since the last call of this ask for.
    pub(super) fn take_asked(&mut self) -> Asks {
        mem::take(&mut self.asked)
    }

    /// Adds to what [`Builder::take_asked`] will tell.
    pub(super) fn ask(&mut self, asks: Asks) {
        self.asked = self.asked | asks;
    }

    /// The texture that stands at `key`.
    pub(super) fn paint(&mut self, key: &str, paint: &'d Paint, quantity: Quantity) -> Result<Texture> {
        match paint {
            Paint::Color(color) => Ok(Texture::Constant(match quantity {
                Quantity::Share => check::share(key, *color)?,
                Quantity::Light => check::light(key, *color)?,
                Quantity::Height => check::number(key, *color)?,
            })),
            Paint::Texture(name) => {
                let texture = self.named(name, key, quantity)?;
                self.ask(texture.asks());
                Ok(texture)
            }
        }
    }

    /// The texture of this name, which `key` asks for.
    pub(super) fn named(&mut self, name: &'d str, key: &str, quantity: Quantity) -> Result<Texture> {
        let Some(texture) = self.description.textures.get(name) else {
            return Err(unknown("texture", name, self.description.textures.keys(), key));
        };
        if self.under_way.contains(&name) {
            return Err(Error::at_key(key, format!("the texture '{name}' contains itself")));
        }
        if self.under_way.len() == DEEPEST {
            return Err(Error::at_key(key, format!("the texture '{}' is too deep", self.under_way[0]))
                .with_hint(format!("textures can be made of textures made of textures, {DEEPEST} in all")));
        }
        self.under_way.push(name);
        // The fault lies where the texture is written, not where it is used.
        let texture = self.texture(texture, quantity, false);
        self.under_way.pop();
        texture.map_err(|error| error.under(&format!("textures.{name}")).at_root())
    }

    /// The texture of this name, which `key` asks for; if it is a picture, its numbers are no colours, whatever it says.
    pub(super) fn raw(&mut self, key: &str, name: &'d str) -> Result<Texture> {
        let texture = match self.description.textures.get(name) {
            Some(texture @ TextureDescription::Bitmap { .. }) => self
                .texture(texture, Quantity::Share, true)
                .map_err(|error| error.under(&format!("textures.{name}")).at_root())?,
            _ => self.named(name, key, Quantity::Share)?,
        };
        self.ask(texture.asks());
        Ok(texture)
    }

    fn texture(&mut self, texture: &'d TextureDescription, quantity: Quantity, is_raw: bool) -> Result<Texture> {
        self.built += 1;
        if self.built > MOST {
            return Err(Error::new(format!("the materials have more than {MOST} textures together"))
                .with_hint("let textures be made of fewer others, or materials share them"));
        }
        match texture {
            TextureDescription::Bitmap { file, raw, channel, filter, wrap, wrap_v, to_uv } => {
                let decoded = Decoded { file, raw: *raw || is_raw, mip: *filter == TextureFilter::Mip, quantity };
                let pyramid = self.pyramid(decoded).map_err(|error| error.under("file"))?;
                let wrap = [*wrap, wrap_v.unwrap_or(*wrap)];
                let to_uv = planar("to-uv", to_uv)?;
                Ok(Texture::Bitmap(Bitmap { pyramid, channel: *channel, filter: *filter, wrap, to_uv }))
            }
            TextureDescription::Checkerboard { color0, color1, to_uv } => {
                Ok(Texture::Checkerboard(Box::new(Checkerboard {
                    color0: self.paint("color0", color0, quantity)?,
                    color1: self.paint("color1", color1, quantity)?,
                    to_uv: planar("to-uv", to_uv)?,
                })))
            }
            TextureDescription::VertexColor {} => Ok(Texture::VertexColor),
            TextureDescription::Product { first, second } => {
                let factors = [self.factor("first", first, quantity)?, self.factor("second", second, quantity)?];
                let brightens = |factor: &Texture| matches!(factor, Texture::Constant(color) if color.max() > 1.0);
                let is_over = quantity == Quantity::Share && factors.iter().any(brightens);
                let product = Texture::Product(Box::new(factors));
                Ok(if is_over { Texture::AtMostOne(Box::new(product)) } else { product })
            }
            TextureDescription::Mix { weight, first, second } => Ok(Texture::Mix(Box::new([
                self.paint("weight", weight, Quantity::Share)?,
                self.paint("first", first, quantity)?,
                self.paint("second", second, quantity)?,
            ]))),
            TextureDescription::Threshold { texture, least } => {
                let least = check::at_least_zero("least", *least)?;
                Ok(Texture::Threshold(Box::new(self.paint("texture", texture, quantity)?), least))
            }
        }
    }

    /// A factor of a product. A constant may brighten what is dark; the product is what is cut.
    fn factor(&mut self, key: &str, paint: &'d Paint, quantity: Quantity) -> Result<Texture> {
        match (paint, quantity) {
            (Paint::Color(_), Quantity::Share) => self.paint(key, paint, Quantity::Light),
            _ => self.paint(key, paint, quantity),
        }
    }

    fn pyramid(&mut self, decoded: Decoded<'d>) -> Result<Arc<Pyramid>> {
        if let Some(pyramid) = self.pyramids.get(&decoded) {
            return Ok(Arc::clone(pyramid));
        }
        let picture = self.assets.picture(decoded.file, decoded.raw)?;
        let bounds = match decoded.quantity {
            Quantity::Share => [0.0, 1.0],
            Quantity::Light => [0.0, f32::MAX],
            Quantity::Height => [f32::MIN, f32::MAX],
        };
        let pyramid = Arc::new(Pyramid::new(picture, decoded.mip, bounds));
        self.pyramids.insert(decoded, Arc::clone(&pyramid));
        Ok(pyramid)
    }
}

/// What a transform does to (u, v, 0).
fn planar(key: &str, transform: &Transform) -> Result<Affine2> {
    let m = transform.0;
    if !m.is_finite() {
        return Err(Error::at_key(key, "the transform has a number that is not finite"));
    }
    let linear = Mat2::from_cols(Vec2::new(m.x_axis.x, m.x_axis.y), Vec2::new(m.y_axis.x, m.y_axis.y));
    Ok(Affine2::from_mat2_translation(linear, Vec2::new(m.w_axis.x, m.w_axis.y)))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::Vec2;

    use super::{Builder, Quantity};
    use crate::error::Error;
    use crate::import::toml::read_str;
    use crate::scene::{NoAssets, build};
    use crate::texture::Lookup;

    /// What is wrong with a scene whose one shape has the texture `a` of these.
    fn fault(textures: &str) -> Error {
        let text = format!(
            "camera = {{ origin = [0, 0, 5], target = [0, 0, 0] }}
             lights = [{{ type = 'constant' }}]
             shapes = [{{ type = 'sphere', material = {{ type = 'diffuse', reflectance = 'a' }} }}]
             {textures}"
        );
        let imported = read_str(Path::new("scene.toml"), &text).expect("it reads");
        build(&imported.description, &NoAssets).expect_err("it is wrong")
    }

    #[test]
    fn a_texture_that_contains_itself_is_named() {
        let error = fault(
            "[textures]
             a = { type = 'product', first = 'b', second = 1 }
             b = { type = 'mix', weight = 0.5, first = 1, second = 'a' }",
        );
        assert_eq!(error.message, "the texture 'a' contains itself");
        assert_eq!(error.key.as_deref(), Some("/textures.b.second"));
    }

    #[test]
    fn a_tower_of_textures_ends_somewhere() {
        let level = |n: usize| format!("a{n} = {{ type = 'product', first = 'a{0}', second = 'a{0}' }}\n", n + 1);
        let tower: String = (0..30).map(level).collect();
        let error = fault(&format!(
            "[textures]\na = {{ type = 'product', first = 'a0', second = 1 }}\n{tower}a30 = {{ type = 'checkerboard' }}"
        ));
        assert_eq!(error.message, "the texture 'a' is too deep");
    }

    #[test]
    fn a_missing_texture_and_a_missing_picture_are_said_with_their_keys() {
        let error = fault(
            "[textures]\na = { type = 'product', first = 'tile', second = 1 }\ntiles = { type = 'checkerboard' }",
        );
        assert_eq!(
            (error.key.as_deref(), error.hint.as_deref()),
            (Some("/textures.a.first"), Some("did you mean 'tiles'?"))
        );
        assert_eq!(
            fault("textures = { a = { type = 'bitmap', file = 'a.png' } }").key.as_deref(),
            Some("/textures.a.file")
        );
    }

    #[test]
    fn what_a_factor_brightens_beyond_one_is_cut() {
        let text = "textures = { a = { type = 'product', first = [4, 1.5, 0.5], second = 'b' },
                                 b = { type = 'checkerboard', color0 = 0.5, color1 = 0.5 },
                                 c = { type = 'threshold', texture = 'a', least = 0.6 } }";
        let imported = read_str(Path::new("scene.toml"), text).expect("it reads");
        let mut builder = Builder::new(&imported.description, &NoAssets);
        let mut at = |name| builder.named(name, "", Quantity::Share).expect("a texture").at(&Lookup::point(Vec2::ZERO));
        assert_eq!(at("a").to_rgb(), [1.0, 0.75, 0.25]);
        assert_eq!(at("c").to_rgb(), [1.0, 1.0, 0.0]);
    }

    #[test]
    fn a_share_of_more_than_one_inside_a_texture_is_refused() {
        let error = fault("[textures]\na = { type = 'checkerboard', color0 = 2 }");
        assert_eq!(error.key.as_deref(), Some("/textures.a.color0"));
    }
}
