//! Colours, and textures where one may stand.

use glam::{DMat4, DVec3};

use super::Importer;
use super::document::{Object, Spectrum, Value};
use super::query::Query;
use super::spectrum::{Role, to_rgb};
use super::value;
use crate::error::Result;
use crate::scene::description::{Channel, Color, Paint, TextureDescription, TextureFilter, Transform, Wrap};

impl Importer<'_> {
    /// The colour `name`, or `default`. A texture there becomes a warning and its default.
    pub(super) fn color(&mut self, query: Query, name: &str, role: Role, default: f32) -> Result<Color> {
        let plugin = query.named_part(name).map(|part| self.document.objects[part.object].plugin.as_str());
        let texture = matches!(plugin, Some("bitmap" | "checkerboard"));
        if !texture && let Paint::Color(color) = self.paint(query, name, role, default)? {
            return Ok(color);
        }
        self.warn(query.spot(name), format!("a texture cannot stand for '{name}': {default} is used instead"));
        Ok(Color::grey(default))
    }

    /// The colour or texture `name`, or `default`.
    pub(super) fn paint(&mut self, query: Query, name: &str, role: Role, default: f32) -> Result<Paint> {
        if let Some(part) = query.named_part(name) {
            return self.painted_object(part.object, role, default);
        }
        let Some(property) = query.property(name) else { return Ok(Paint::grey(default)) };
        let color = match &property.value {
            Value::Rgb(rgb) => Color(rgb.map(|channel| channel as f32)),
            Value::Float(value) => Color::grey(*value as f32),
            Value::Integer(value) => Color::grey(*value as f32),
            Value::Spectrum(spectrum) => self.spectrum(query, name, spectrum, role),
            other => return Err(query.fault(name, format!("'{name}' must be a colour, not {}", other.sort()))),
        };
        Ok(color.into())
    }

    fn spectrum(&mut self, query: Query, name: &str, spectrum: &Spectrum, role: Role) -> Color {
        let (rgb, clamped) = to_rgb(spectrum, role);
        if clamped {
            let message =
                format!("the spectrum of '{name}' is a colour that RGB cannot hold: its negative part is left out");
            self.warn(query.spot(name), message);
        }
        Color(rgb.map(|channel| channel as f32))
    }

    /// A texture or spectrum plugin.
    fn painted_object(&mut self, object: usize, role: Role, default: f32) -> Result<Paint> {
        let query = self.query(object);
        let paint = match query.object.plugin.as_str() {
            "bitmap" | "checkerboard" => Paint::Texture(self.texture(object)?),
            // Daylight is what (1, 1, 1) means.
            "d65" => Paint::grey(query.float("scale", 1.0)? as f32),
            "srgb" | "rgb" => self.paint(query, "color", role, default)?,
            "uniform" => {
                let value = Spectrum::Constant(query.float("value", 1.0)?);
                // As a plugin, unlike as a value, a constant is grey even in a light.
                self.spectrum(query, "value", &value, Role::Surface).into()
            }
            "blackbody" => {
                let temperature = query.float("temperature", 5000.0)?;
                let spectrum = Spectrum::BlackBody { temperature, scale: query.float("scale", 1.0)? };
                self.spectrum(query, "temperature", &spectrum, role).into()
            }
            "regular" | "irregular" => {
                let spectrum = listed(query)?;
                self.spectrum(query, "values", &spectrum, role).into()
            }
            _ => {
                self.left_out(object, &format!("{default} is used instead"));
                return Ok(Paint::grey(default));
            }
        };
        self.leftovers(query);
        Ok(paint)
    }

    /// The name in the description of a bitmap or checkerboard.
    fn texture(&mut self, object: usize) -> Result<String> {
        if let Some(name) = self.textures.get(&object) {
            return Ok(name.clone());
        }
        let query = self.query(object);
        let texture = match query.object.plugin.as_str() {
            "bitmap" => self.bitmap(query)?,
            _ => TextureDescription::Checkerboard {
                color0: self.paint(query, "color0", Role::Surface, 0.4)?,
                color1: self.paint(query, "color1", Role::Surface, 0.2)?,
                to_uv: single(to_uv(query)?),
            },
        };
        let name = self.texture_name(query.object);
        self.note(format!("textures.{name}"), query.object.spot);
        self.note_all(&format!("textures.{name}"), query, &[("file", "filename"), ("to-uv", "to_uv")]);
        self.description().textures.insert(name.clone(), texture);
        self.textures.insert(object, name.clone());
        Ok(name)
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

    fn bitmap(&mut self, query: Query) -> Result<TextureDescription> {
        let Some(file) = query.text("filename")? else {
            return Err(query.fault("filename", "a bitmap needs a 'filename'"));
        };
        let wrap = query.text("wrap_mode")?.or(query.text("wrap_mode_u")?).unwrap_or("repeat");
        let wrap = match wrap {
            "repeat" => Wrap::Repeat,
            "mirror" => Wrap::Mirror,
            "clamp" => Wrap::Clamp,
            other => {
                self.warn(query.spot("wrap_mode"), format!("wrap mode '{other}' is not supported: repeat is used"));
                Wrap::Repeat
            }
        };
        // Mitsuba 0.x also has trilinear and ewa, which agree with bilinear up to their blur.
        let nearest = query.text("filter_type")?.is_some_and(|filter| filter == "nearest");
        let filter = if nearest { TextureFilter::Nearest } else { TextureFilter::Bilinear };
        // Its gamma of 1 means that the numbers are linear; -1 that the file knows.
        let raw = query.boolean("raw", false)? || query.optional_float("gamma")?.is_some_and(|gamma| gamma == 1.0);
        // Its (0, 0) is the top left corner of the picture, ours the bottom left.
        let upside_down = DMat4::from_translation(DVec3::Y) * DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0));
        let to_uv = single(upside_down * to_uv(query)?);
        query.ignore(&["max_anisotropy", "cache", "accel", "format", "wrap_mode_v"]);
        Ok(TextureDescription::Bitmap {
            file: file.to_string(),
            raw,
            channel: Channel::Color,
            filter,
            wrap,
            wrap_v: None,
            to_uv,
        })
    }
}

fn listed(query: Query) -> Result<Spectrum> {
    let numbers = |name: &str| match query.text(name)? {
        Some(text) => value::numbers(text).map_err(|message| query.fault(name, message)),
        None => Err(query.fault(name, format!("the spectrum needs '{name}'"))),
    };
    let values = numbers("values")?;
    let wavelengths = match query.object.plugin.as_str() {
        "irregular" => numbers("wavelengths")?,
        _ => {
            let (first, last) = (query.float("wavelength_min", 360.0)?, query.float("wavelength_max", 830.0)?);
            let step = (last - first) / (values.len().max(2) - 1) as f64;
            (0..values.len()).map(|index| first + step * index as f64).collect()
        }
    };
    value::spectrum_of(&wavelengths, &values).map_err(|message| query.fault("values", message))
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
