//! Colours as people write them.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserialize, Deserializer, SeqAccess, Visitor};
use serde::{Serialize, Serializer};

use crate::spectrum::srgb_to_linear;

/// Linear RGB (BT.709 primaries): three numbers, one number for all three, or `"#rrggbb"` in sRGB.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Color(pub [f32; 3]);

impl Color {
    /// The same value in all channels.
    pub const fn grey(value: f32) -> Color {
        Color([value; 3])
    }

    pub(super) fn one() -> Color {
        Color::grey(1.0)
    }

    /// From the six hexadecimal digits of an sRGB colour, with or without `#`.
    pub fn from_hex(text: &str) -> Option<Color> {
        let digits = text.strip_prefix('#').unwrap_or(text);
        if digits.len() != 6 || !digits.is_ascii() {
            return None;
        }
        let channel = |at: usize| {
            let byte = u8::from_str_radix(&digits[at..at + 2], 16).ok()?;
            Some(srgb_to_linear(f32::from(byte) / 255.0))
        };
        Some(Color([channel(0)?, channel(2)?, channel(4)?]))
    }
}

impl<'de> Deserialize<'de> for Color {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Color, D::Error> {
        match Paint::deserialize(deserializer)? {
            Paint::Color(color) => Ok(color),
            Paint::Texture(name) => Err(de::Error::custom(format!(
                "a texture ('{name}') cannot stand here; write a number, three numbers, or \"#rrggbb\""
            ))),
        }
    }
}

impl Serialize for Color {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            [r, g, b] if r == g && g == b => serializer.serialize_f32(r),
            channels => channels.serialize(serializer),
        }
    }
}

impl JsonSchema for Color {
    fn schema_name() -> Cow<'static, str> {
        "Color".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "Linear RGB: three numbers, one number for all three, or \"#rrggbb\" in sRGB.",
            "anyOf": [
                { "type": "number" },
                { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 },
                { "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" }
            ]
        })
    }
}

/// A colour, or the name of a texture that gives one at every point.
#[derive(Clone, Debug, PartialEq)]
pub enum Paint {
    /// The same everywhere.
    Color(Color),
    /// The name of one of the scene's `textures`.
    Texture(String),
}

impl Paint {
    /// The same value in all channels, everywhere.
    pub const fn grey(value: f32) -> Paint {
        Paint::Color(Color::grey(value))
    }

    pub(super) fn one() -> Paint {
        Paint::grey(1.0)
    }

    pub(super) fn half() -> Paint {
        Paint::grey(0.5)
    }

    pub(super) fn quarter() -> Paint {
        Paint::grey(0.25)
    }

    pub(super) fn fifth() -> Paint {
        Paint::grey(0.2)
    }

    pub(super) fn tenth() -> Paint {
        Paint::grey(0.1)
    }

    pub(super) fn dark() -> Paint {
        Paint::grey(0.4)
    }

    pub(super) fn darker() -> Paint {
        Paint::grey(0.2)
    }
}

impl From<Color> for Paint {
    fn from(color: Color) -> Paint {
        Paint::Color(color)
    }
}

impl<'de> Deserialize<'de> for Paint {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Paint, D::Error> {
        deserializer.deserialize_any(PaintVisitor)
    }
}

impl Serialize for Paint {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Paint::Color(color) => color.serialize(serializer),
            Paint::Texture(name) => serializer.serialize_str(name),
        }
    }
}

impl JsonSchema for Paint {
    fn schema_name() -> Cow<'static, str> {
        "Paint".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let color = generator.subschema_for::<Color>();
        json_schema!({
            "description": "A colour, or the name of a texture.",
            "anyOf": [color, { "type": "string" }]
        })
    }
}

struct PaintVisitor;

impl<'de> Visitor<'de> for PaintVisitor {
    type Value = Paint;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, three numbers, \"#rrggbb\", or the name of a texture")
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Paint, E> {
        Ok(Paint::grey(value as f32))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Paint, E> {
        Ok(Paint::grey(value as f32))
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<Paint, E> {
        Ok(Paint::grey(value as f32))
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Paint, E> {
        match (text.starts_with('#'), Color::from_hex(text)) {
            (true, Some(color)) => Ok(color.into()),
            (true, None) => Err(E::custom(format!("'{text}' is not a colour: write \"#rrggbb\""))),
            (false, _) => Ok(Paint::Texture(text.to_string())),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Paint, A::Error> {
        let mut channels = [0.0; 3];
        for (index, channel) in channels.iter_mut().enumerate() {
            *channel = seq.next_element()?.ok_or_else(|| de::Error::invalid_length(index, &self))?;
        }
        match seq.next_element::<f32>()? {
            Some(_) => Err(de::Error::invalid_length(4, &"three numbers")),
            None => Ok(Color(channels).into()),
        }
    }
}
