//! Textures, resolved as materials ask for them: a picture or pattern times a constant.

use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

use glam::{Mat4, Vec3};

use super::super::source::Spot;
use super::super::spectrum::Role;
use super::Importer;
use super::material::color;
use super::statement::Statement;
use crate::error::{Result, did_you_mean};
use crate::scene::description::{Channel, Paint, TextureDescription, TextureFilter, Transform, Wrap};

/// What pbrt keeps apart: textures of numbers and of colours may share a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Sort {
    Number,
    Color,
}

/// All textures declared so far.
#[derive(Default)]
pub(super) struct Textures {
    declared: BTreeMap<(Sort, String), Rc<Statement>>,
    done: HashMap<(Sort, String), Option<Varying>>,
    /// The last number that made a name its own, by name.
    numbers: HashMap<String, usize>,
}

impl Textures {
    /// Takes a `Texture` statement.
    pub fn declare(&mut self, statement: Statement) {
        let [name, sort, _] = &statement.texts[..] else { return };
        let sort = if sort == "float" { Sort::Number } else { Sort::Color };
        let key = (sort, name.clone());
        self.declared.insert(key, Rc::new(statement));
    }
}

/// A texture of the description times a factor; without one, the factor alone.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Varying {
    pub texture: Option<String>,
    pub factor: [f64; 3],
}

impl Varying {
    pub fn constant(factor: [f64; 3]) -> Varying {
        Varying { texture: None, factor }
    }
}

/// How deep textures may lie in each other.
const DEEPEST_TEXTURE: usize = 32;

impl Importer<'_> {
    /// A parameter that may vary; `None` without it.
    pub(super) fn varying(&mut self, statement: &Statement, name: &'static str, sort: Sort) -> Result<Option<Varying>> {
        self.varying_at(statement, name, sort, 0)
    }

    fn varying_at(
        &mut self,
        statement: &Statement,
        name: &'static str,
        sort: Sort,
        depth: usize,
    ) -> Result<Option<Varying>> {
        let Some(parameter) = statement.parameter(name) else { return Ok(None) };
        // v3 writes "string" as well where a texture is named by it.
        let named = parameter.text().filter(|_| matches!(parameter.kind.as_str(), "texture" | "string"));
        match named {
            Some(texture) => {
                let (texture, spot) = (texture.to_string(), parameter.spot);
                self.texture(sort, &texture, spot, depth).map(Some)
            }
            None => Ok(self.color(statement, name, Role::Surface)?.map(Varying::constant)),
        }
    }

    /// The same as a paint of shares from 0 to 1.
    pub(super) fn paint(&mut self, statement: &Statement, name: &'static str, default: f64) -> Result<Paint> {
        let found = self.varying(statement, name, Sort::Color)?.unwrap_or(Varying::constant([default; 3]));
        let spot = statement.spot_of(name);
        Ok(self.share(found, spot))
    }

    /// A weight from 0 to 1.
    pub(super) fn weight(&mut self, statement: &Statement, name: &'static str, default: f64) -> Result<Paint> {
        let found = self.varying(statement, name, Sort::Number)?.unwrap_or(Varying::constant([default; 3]));
        let spot = statement.spot_of(name);
        Ok(self.share(found, spot))
    }

    /// A paint of shares from 0 to 1. A factor above 1 brightens a picture; what it overdoes is cut in the product, as pbrt
    /// does.
    pub(super) fn share(&mut self, varying: Varying, spot: Spot) -> Paint {
        let most = if varying.texture.is_some() { f64::from(f32::MAX) } else { 1.0 };
        let factor = varying.factor.map(|channel| channel.clamp(0.0, most));
        if factor != varying.factor {
            self.warn(spot, "a share of light must lie between 0 and 1: it is cut");
        }
        match varying.texture {
            None => Paint::Color(color(factor)),
            Some(texture) if factor == [1.0; 3] => Paint::Texture(texture),
            Some(texture) => {
                let name = self.free_name(&format!("{texture}-scaled"));
                let product =
                    TextureDescription::Product { first: Paint::Texture(texture), second: Paint::Color(color(factor)) };
                self.add_texture(&name, product, spot);
                Paint::Texture(name)
            }
        }
    }

    fn texture(&mut self, sort: Sort, name: &str, spot: Spot, depth: usize) -> Result<Varying> {
        let key = (sort, name.to_string());
        match self.textures.done.get(&key) {
            Some(Some(done)) => return Ok(done.clone()),
            Some(None) => return Err(self.reader.fault(spot, format!("the texture '{name}' contains itself"))),
            None if depth > DEEPEST_TEXTURE => return Err(self.reader.fault(spot, "textures are nested too deeply")),
            None => {}
        }
        let Some(statement) = self.textures.declared.get(&key).cloned() else {
            let error = self.reader.fault(spot, format!("there is no texture named '{name}'"));
            let names = self.textures.declared.keys().filter(|(other, _)| *other == sort);
            return Err(match did_you_mean(name, names.map(|(_, name)| name.as_str())) {
                Some(near) => error.with_hint(format!("did you mean '{near}'?")),
                None => error,
            });
        };
        self.textures.done.insert(key.clone(), None);
        let found = self.described(&statement, sort, name, depth + 1)?;
        self.leftovers(&statement);
        self.textures.done.insert(key, Some(found.clone()));
        Ok(found)
    }

    fn described(&mut self, statement: &Statement, sort: Sort, name: &str, depth: usize) -> Result<Varying> {
        let part = |importer: &mut Self, part: &'static str, default: f64| -> Result<Varying> {
            let found = importer.varying_at(statement, part, sort, depth)?;
            Ok(found.unwrap_or(Varying::constant([default; 3])))
        };
        let description = match statement.texts.get(2).map_or("", String::as_str) {
            "constant" => return part(self, "value", 1.0),
            "scale" => {
                let (first, second) = if statement.has("tex1") || statement.has("tex2") {
                    // The way of pbrt-v3.
                    (part(self, "tex1", 1.0)?, part(self, "tex2", 1.0)?)
                } else {
                    let scale = self.varying_at(statement, "scale", Sort::Number, depth)?;
                    (part(self, "tex", 1.0)?, scale.unwrap_or(Varying::constant([1.0; 3])))
                };
                let factor = [0, 1, 2].map(|channel| first.factor[channel] * second.factor[channel]);
                let (first, second) = match (first.texture, second.texture) {
                    (Some(first), Some(second)) => (first, second),
                    (texture, None) | (None, texture) => return Ok(Varying { texture, factor }),
                };
                let product =
                    TextureDescription::Product { first: Paint::Texture(first), second: Paint::Texture(second) };
                let texture = self.free_name(name);
                self.add_texture(&texture, product, statement.spot);
                return Ok(Varying { texture: Some(texture), factor });
            }
            "mix" => {
                let (first, second) = (part(self, "tex1", 0.0)?, part(self, "tex2", 1.0)?);
                let weight = self.varying_at(statement, "amount", Sort::Number, depth)?;
                let weight = weight.unwrap_or(Varying::constant([0.5; 3]));
                let spot = statement.spot;
                TextureDescription::Mix {
                    weight: self.share(weight, spot),
                    first: self.share(first, spot),
                    second: self.share(second, spot),
                }
            }
            "checkerboard" => {
                let (first, second) = (part(self, "tex1", 1.0)?, part(self, "tex2", 0.0)?);
                if self.placed(statement.count("dimension"))? == Some(3) {
                    let spot = statement.spot_of("dimension");
                    self.warn(spot, "a checkerboard in space is not supported: it lies on (u, v)");
                }
                statement.ignore(&["aamode"]);
                let spot = statement.spot;
                TextureDescription::Checkerboard {
                    color0: self.share(first, spot),
                    color1: self.share(second, spot),
                    // A square is one unit wide there and half a unit here.
                    to_uv: Transform(Mat4::from_scale(Vec3::new(0.5, 0.5, 1.0)) * self.mapping(statement)?),
                }
            }
            "imagemap" => return self.image_map(statement, name),
            other => return Ok(self.unsupported(statement, other)),
        };
        let texture = self.free_name(name);
        self.add_texture(&texture, description, statement.spot);
        Ok(Varying { texture: Some(texture), factor: [1.0; 3] })
    }

    fn unsupported(&mut self, statement: &Statement, sort: &str) -> Varying {
        const SORTS: [&str; 5] = ["checkerboard", "constant", "imagemap", "mix", "scale"];
        let message = format!("texture '{sort}' is not supported: a flat grey of 0.5 is used");
        match did_you_mean(sort, SORTS) {
            Some(near) => self.warn_with(statement.spot, message, &format!("did you mean '{near}'?")),
            None => self.warn(statement.spot, message),
        }
        // What it says of the texture that we do not draw needs no word.
        statement.leftovers();
        Varying::constant([0.5; 3])
    }

    fn image_map(&mut self, statement: &Statement, name: &str) -> Result<Varying> {
        let spot = statement.spot_of("filename");
        let Some(file) = self.placed(statement.text("filename"))?.map(str::to_string) else {
            return Err(self.reader.fault(spot, "an imagemap needs a 'filename'"));
        };
        let wrap = match self.placed(statement.text("wrap"))?.unwrap_or("repeat") {
            "repeat" => Wrap::Repeat,
            "black" => Wrap::Black,
            "clamp" => Wrap::Clamp,
            other => {
                let message = format!("wrapping '{other}' is not supported: 'clamp' is used");
                self.warn(statement.spot_of("wrap"), message);
                Wrap::Clamp
            }
        };
        let filter = match self.placed(statement.text("filter"))?.unwrap_or("bilinear") {
            "point" => TextureFilter::Nearest,
            "trilinear" | "ewa" | "EWA" => TextureFilter::Mip,
            _ => TextureFilter::Bilinear,
        };
        let filter = if self.placed(statement.boolean("trilinear", false))? { TextureFilter::Mip } else { filter };
        let encoding = self.placed(statement.text("encoding"))?.unwrap_or("sRGB");
        // The way of pbrt-v3: "bool gamma" "false" is linear.
        let gamma = !statement.has("gamma") || statement.boolean("gamma", true).unwrap_or(true);
        let raw = encoding == "linear" || !gamma;
        if encoding.starts_with("gamma") {
            self.warn(statement.spot_of("encoding"), "an encoding by a power is not supported: sRGB is used");
        }
        statement.ignore(&["maxanisotropy", "gamma"]);
        let to_uv = Transform(self.mapping(statement)?);
        let factor = [self.placed(statement.number("scale", 1.0))?; 3];
        let texture = self.free_name(name);
        let picture =
            TextureDescription::Bitmap { file, raw, channel: Channel::Color, filter, wrap, wrap_v: None, to_uv };
        self.add_texture(&texture, picture, spot);
        if !self.placed(statement.boolean("invert", false))? {
            return Ok(Varying { texture: Some(texture), factor });
        }
        let inverted = self.free_name(&format!("{name}-inverted"));
        let weight = self.share(Varying { texture: Some(texture), factor }, statement.spot_of("scale"));
        let mix = TextureDescription::Mix { weight, first: Paint::grey(1.0), second: Paint::grey(0.0) };
        self.add_texture(&inverted, mix, spot);
        Ok(Varying { texture: Some(inverted), factor: [1.0; 3] })
    }

    /// From the surface's (u, v) to those of the look-up.
    fn mapping(&mut self, statement: &Statement) -> Result<Mat4> {
        let mapping = self.placed(statement.text("mapping"))?.unwrap_or("uv").to_string();
        if mapping != "uv" {
            let message = format!("the mapping '{mapping}' is not supported: the surface's (u, v) are used");
            self.warn(statement.spot_of("mapping"), message);
            statement.ignore(&["v1", "v2"]);
        }
        let number = |name, default| -> Result<f32> { Ok(self.placed(statement.number(name, default))? as f32) };
        let scale = Vec3::new(number("uscale", 1.0)?, number("vscale", 1.0)?, 1.0);
        let delta = Vec3::new(number("udelta", 0.0)?, number("vdelta", 0.0)?, 0.0);
        Ok(Mat4::from_translation(delta) * Mat4::from_scale(scale))
    }

    /// A picture that is named without a `Texture` statement, as light.
    pub(super) fn picture(&mut self, file: &str, spot: Spot) -> String {
        self.plain_picture(file, false, spot)
    }

    /// A picture over the unit square, linear if `raw`.
    pub(super) fn plain_picture(&mut self, file: &str, raw: bool, spot: Spot) -> String {
        let name = self.free_name(file);
        let picture = TextureDescription::Bitmap {
            file: file.to_string(),
            raw,
            channel: Channel::Color,
            filter: TextureFilter::Bilinear,
            wrap: Wrap::Repeat,
            wrap_v: None,
            to_uv: Transform::default(),
        };
        self.add_texture(&name, picture, spot);
        name
    }

    fn add_texture(&mut self, name: &str, texture: TextureDescription, spot: Spot) {
        self.note(format!("textures.{name}"), spot);
        self.description().textures.insert(name.to_string(), texture);
    }

    /// `name`, or with a number behind it if there is such a texture already.
    fn free_name(&mut self, name: &str) -> String {
        let taken = &self.imported.description.textures;
        let number = self.textures.numbers.entry(name.to_string()).or_insert(0);
        loop {
            *number += 1;
            let free = if *number == 1 { name.to_string() } else { format!("{name}-{number}") };
            if !taken.contains_key(&free) {
                return free;
            }
        }
    }
}
