//! Colours, and textures where one may stand.

mod pictures;

use super::Importer;
use super::document::{Spectrum, Value};
use super::query::Query;
use super::spectrum::{Role, to_rgb};
use super::value;
use crate::error::Result;
use crate::scene::description::{Color, Paint};

impl Importer<'_> {
    /// The colour `name`, or `default`. A texture there becomes a warning and its default.
    pub(super) fn color(&mut self, query: Query, name: &str, role: Role, default: f32) -> Result<Color> {
        let part = query.named_part(name).map(|part| part.object);
        // One that varies is not even looked at, lest it stay in the description.
        let varies = part.is_some_and(|object| self.varies(object));
        if !varies && let Paint::Color(color) = self.paint(query, name, role, default)? {
            return Ok(color);
        }
        self.warn(query.spot(name), format!("a texture cannot stand for '{name}': {default} is used instead"));
        Ok(Color::grey(default))
    }

    /// The colour or texture `name`, or `default`.
    pub(super) fn paint(&mut self, query: Query, name: &str, role: Role, default: f32) -> Result<Paint> {
        if let Some(part) = query.named_part(name) {
            return self.painted(part.object, role, default);
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

    /// Whether a texture plugin gives different colours at different points.
    fn varies(&self, object: usize) -> bool {
        matches!(
            self.document.objects[object].plugin.as_str(),
            "bitmap" | "checkerboard" | "scale" | "mesh_attribute" | "vertexcolors"
        )
    }

    /// A texture or spectrum plugin.
    pub(super) fn painted(&mut self, object: usize, role: Role, default: f32) -> Result<Paint> {
        let query = self.query(object);
        self.visit(query, self.texture_depth)?;
        self.texture_depth += 1;
        let paint = self.painted_inside(object, query, role, default);
        self.texture_depth -= 1;
        paint
    }

    fn painted_inside(&mut self, object: usize, query: Query, role: Role, default: f32) -> Result<Paint> {
        let paint = match query.object.plugin.as_str() {
            "bitmap" | "checkerboard" | "mesh_attribute" | "vertexcolors" => self.texture(object, role)?,
            "scale" => self.product(object, role, default)?,
            // Daylight is what (1, 1, 1) means.
            "d65" => {
                let color = self.color(query, "color", role, 1.0)?;
                let scale = query.float("scale", 1.0)? as f32;
                Color(color.0.map(|channel| channel * scale)).into()
            }
            "srgb" | "rgb" => self.paint(query, "color", role, default)?,
            "rawconstant" => match query.vector_or_float("value")? {
                Some(value) => Color(value.as_vec3().to_array()).into(),
                None => Paint::grey(default),
            },
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
            // Lines on a ground, thin by default: the ground alone.
            plugin @ ("gridtexture" | "wireframe") => {
                let (name, ground) = if plugin == "wireframe" { ("interior_color", 0.5) } else { ("color0", 0.2) };
                self.left_out(object, &format!("its '{name}' is used everywhere"));
                return self.paint(query, name, role, ground);
            }
            _ => {
                self.left_out(object, &format!("{default} is used instead"));
                return Ok(Paint::grey(default));
            }
        };
        self.leftovers(query);
        Ok(paint)
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
