//! Textures that vary, with their place in texture coordinates.
//!
//! Those coordinates stay as Mitsuba has them, with (0, 0) at the top left corner of a picture; ours is at the
//! bottom left, so that every bitmap turns v round once more.

use glam::{DMat4, DVec3};

use crate::error::Result;
use crate::import::mitsuba::Importer;
use crate::import::mitsuba::document::{Kind, Object};
use crate::import::mitsuba::query::Query;
use crate::import::mitsuba::spectrum::Role;
use crate::scene::description::{Channel, Color, Paint, TextureDescription, TextureFilter, Transform, Wrap};

impl Importer<'_> {
    /// A texture of the description; white where the mesh attribute is none that we have.
    pub(super) fn texture(&mut self, object: usize, role: Role) -> Result<Paint> {
        if let Some(name) = self.textures.get(&object) {
            return Ok(Paint::Texture(name.clone()));
        }
        let query = self.query(object);
        let texture = match query.object.plugin.as_str() {
            "bitmap" => self.bitmap(query, false)?,
            "checkerboard" => TextureDescription::Checkerboard {
                color0: self.paint(query, "color0", role, 0.4)?,
                color1: self.paint(query, "color1", role, 0.2)?,
                to_uv: single(to_uv(query)?),
            },
            _ => {
                let attribute = query.text("name")?.unwrap_or("vertex_color");
                if !attribute.starts_with("vertex_") {
                    self.warn(query.spot("name"), format!("the mesh attribute '{attribute}' is not supported"));
                }
                TextureDescription::VertexColor {}
            }
        };
        let name = self.add_texture(query, texture);
        let scale = query.float("scale", 1.0)?;
        let paint = self.multiplied(query, Paint::Texture(name), Color::grey(scale as f32));
        if let Paint::Texture(name) = &paint {
            self.textures.insert(object, name.clone());
        }
        Ok(paint)
    }

    fn add_texture(&mut self, query: Query, texture: TextureDescription) -> String {
        let name = self.texture_name(query.object);
        self.note(format!("textures.{name}"), query.object.spot);
        self.note_all(&format!("textures.{name}"), query, &[("file", "filename"), ("to-uv", "to_uv")]);
        self.description().textures.insert(name.clone(), texture);
        name
    }

    fn texture_name(&mut self, object: &Object) -> String {
        let taken = &self.imported.description.textures;
        match &object.id {
            Some(id) if !taken.contains_key(id) => id.clone(),
            _ => (taken.len() + 1..)
                .map(|number| format!("texture-{number}"))
                .find(|name| !taken.contains_key(name))
                .unwrap_or_default(),
        }
    }

    /// 0.x: a texture times a colour.
    pub(super) fn product(&mut self, object: usize, role: Role, default: f32) -> Result<Paint> {
        if let Some(name) = self.textures.get(&object) {
            return Ok(Paint::Texture(name.clone()));
        }
        let query = self.query(object);
        let factor = self.color(query, "scale", role, 1.0)?;
        let inner = match query.part(Kind::Texture) {
            Some(part) => self.painted(part.object, role, default)?,
            None => self.paint(query, "value", role, default)?,
        };
        let product = self.multiplied(query, inner, factor);
        if let Paint::Texture(name) = &product {
            self.textures.insert(object, name.clone());
        }
        Ok(product)
    }

    fn multiplied(&mut self, query: Query, paint: Paint, factor: Color) -> Paint {
        match paint {
            Paint::Color(color) => Color([0, 1, 2].map(|channel| color.0[channel] * factor.0[channel])).into(),
            paint if factor == Color::grey(1.0) => paint,
            first => {
                let product = TextureDescription::Product { first, second: factor.into() };
                Paint::Texture(self.add_texture(query, product))
            }
        }
    }

    /// The texture inside those of 0.x that only scale it by a number, and the product of these numbers.
    pub(in crate::import::mitsuba) fn unscaled(&mut self, mut object: usize) -> Result<(usize, f64)> {
        let mut factor = 1.0;
        for depth in self.texture_depth.. {
            let query = self.query(object);
            if query.object.plugin != "scale" {
                break;
            }
            self.visit(query, depth)?;
            let constant = query.number("scale");
            let (Some(scale), Some(inner)) =
                (constant.or((!query.has("scale")).then_some(1.0)), query.part(Kind::Texture))
            else {
                break;
            };
            factor *= scale;
            object = inner.object;
        }
        Ok((object, factor))
    }

    /// A picture of numbers, as a BSDF names it without a texture around it.
    pub(in crate::import::mitsuba) fn raw_picture(&mut self, query: Query) -> Result<String> {
        let picture = self.bitmap(query, true)?;
        let name = self.description().textures.len() + 1;
        let name = format!("picture-{name}");
        self.note(format!("textures.{name}"), query.object.spot);
        self.note_all(&format!("textures.{name}"), query, &[("file", "filename")]);
        self.description().textures.insert(name.clone(), picture);
        Ok(name)
    }

    /// The same texture upright in coordinates whose v runs upwards, as a projector's do.
    pub(in crate::import::mitsuba) fn upright(&mut self, name: String, shared: bool) -> String {
        let Some(mut texture) = self.description().textures.get(&name).cloned() else { return name };
        if let TextureDescription::Bitmap { to_uv, .. } | TextureDescription::Checkerboard { to_uv, .. } = &mut texture
        {
            *to_uv = Transform(to_uv.0 * upside_down().as_mat4());
        }
        let name = if shared { format!("{name}-upright") } else { name };
        self.description().textures.insert(name.clone(), texture);
        name
    }

    fn bitmap(&mut self, query: Query, numbers: bool) -> Result<TextureDescription> {
        let Some(file) = query.text("filename")? else {
            return Err(query.fault("filename", "a bitmap needs a 'filename'"));
        };
        let both = self.wrap(query, "wrap_mode")?;
        let wrap = self.wrap(query, "wrap_mode_u")?.or(both).unwrap_or_default();
        let wrap_v = self.wrap(query, "wrap_mode_v")?.or(both).unwrap_or_default();
        let filter = self.texture_filter(query)?;
        let raw = self.linear(query)? || numbers;
        let channel = self.channel(query)?;
        let to_uv = single(upside_down() * to_uv(query)?);
        query.ignore(&["max_anisotropy", "cache", "accel", "format"]);
        let wrap_v = (wrap_v != wrap).then_some(wrap_v);
        Ok(TextureDescription::Bitmap { file: file.to_string(), raw, channel, filter, wrap, wrap_v, to_uv })
    }

    fn wrap(&mut self, query: Query, name: &str) -> Result<Option<Wrap>> {
        let Some(mode) = query.text(name)? else { return Ok(None) };
        Ok(Some(match mode {
            "repeat" => Wrap::Repeat,
            "mirror" => Wrap::Mirror,
            "clamp" => Wrap::Clamp,
            "zero" => Wrap::Black,
            "one" => Wrap::White,
            other => {
                self.warn(query.spot(name), format!("wrap mode '{other}' is not supported: repeat is used"));
                Wrap::Repeat
            }
        }))
    }

    /// 0.x blurs what is far away unless told otherwise, 3 never does.
    fn texture_filter(&mut self, query: Query) -> Result<TextureFilter> {
        let default = if query.object.old { "ewa" } else { "bilinear" };
        Ok(match query.text("filter_type")?.unwrap_or(default).to_ascii_lowercase().as_str() {
            "nearest" => TextureFilter::Nearest,
            "bilinear" => TextureFilter::Bilinear,
            "trilinear" | "ewa" | "isotropic" => TextureFilter::Mip,
            other => {
                let message = format!("the filter type '{other}' is not supported: bilinear is used");
                self.warn(query.spot("filter_type"), message);
                TextureFilter::Bilinear
            }
        })
    }

    /// Whether the numbers of the file are linear: 3 says so by `raw`, 0.x by a `gamma` of 1. Its -1 and 0 leave it to
    /// the file.
    fn linear(&mut self, query: Query) -> Result<bool> {
        let raw = query.boolean("raw", false)?;
        Ok(match query.optional_float("gamma")? {
            Some(1.0) => true,
            Some(gamma) if gamma > 0.0 && (gamma - 2.2).abs() > 0.05 => {
                self.warn(query.spot("gamma"), format!("a gamma of {gamma} is not supported: that of sRGB is used"));
                raw
            }
            _ => raw,
        })
    }

    fn channel(&mut self, query: Query) -> Result<Channel> {
        Ok(match query.text("channel")?.unwrap_or("all").to_ascii_lowercase().as_str() {
            "r" | "x" => Channel::Red,
            "g" | "y" => Channel::Green,
            "b" | "z" => Channel::Blue,
            "a" => Channel::Alpha,
            "all" | "rgb" | "" => Channel::Color,
            other => {
                self.warn(query.spot("channel"), format!("the channel '{other}' is not known: the colour is used"));
                Channel::Color
            }
        })
    }
}

fn upside_down() -> DMat4 {
    DMat4::from_translation(DVec3::Y) * DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0))
}

/// `to_uv`, or the scales and offsets of 0.x.
fn to_uv(query: Query) -> Result<DMat4> {
    let scale = DVec3::new(query.float("uscale", 1.0)?, query.float("vscale", 1.0)?, 1.0);
    let offset = DVec3::new(query.float("uoffset", 0.0)?, query.float("voffset", 0.0)?, 0.0);
    let old = DMat4::from_translation(offset) * DMat4::from_scale(scale);
    Ok(query.transform("to_uv")?.unwrap_or(DMat4::IDENTITY) * old)
}

fn single(matrix: DMat4) -> Transform {
    Transform(matrix.as_mat4())
}
