//! Attributes, and the values of property elements.

use glam::{DMat4, DVec3};
use roxmltree::Node;

use super::super::document::{Spectrum, Spot, Value};
use super::super::transform;
use super::super::value::{self, SpectrumText};
use super::{File, Parser};
use crate::error::{Error, Result, did_you_mean};

/// Bytes by which parameters may make all values of a file longer: parameters made of parameters may grow without end.
const MOST_GROWTH: usize = 1 << 22;

/// Bytes of the longest name of a parameter that is looked for.
const LONGEST_NAME: usize = 256;

/// An attribute with its parameters filled in.
pub(super) struct Attribute<'a> {
    name: &'a str,
    text: String,
    spot: Spot,
}

/// What `<default>`, a property or an object is made from.
pub(super) struct Element<'a> {
    attributes: Vec<Attribute<'a>>,
    pub spot: Spot,
}

impl Element<'_> {
    pub fn get(&self, name: &str) -> Option<&Attribute<'_>> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    pub fn text(&self, name: &str) -> Option<&str> {
        self.get(name).map(|attribute| attribute.text.as_str())
    }

    pub fn spot(&self, name: &str) -> Spot {
        self.get(name).map_or(self.spot, |attribute| attribute.spot)
    }
}

impl Parser<'_> {
    /// The attributes of `node`, with parameters filled in.
    pub(super) fn element<'n>(&mut self, file: &File, node: Node<'n, '_>) -> Result<Element<'n>> {
        let mut attributes = Vec::new();
        for attribute in node.attributes() {
            let range = attribute.range_value();
            let spot = Spot { source: file.index, start: range.start, end: range.end };
            let text = self.filled_in(attribute.value(), spot)?;
            attributes.push(Attribute { name: attribute.name(), text, spot });
        }
        Ok(Element { attributes, spot: tag_spot(file, node) })
    }

    /// `text` with every `$name` replaced by its value.
    fn filled_in(&mut self, text: &str, spot: Spot) -> Result<String> {
        let mut parts = text.split('$');
        let mut filled = parts.next().unwrap_or("").to_string();
        for part in parts {
            let length = part.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(part.len());
            if length == 0 {
                filled.push('$');
                filled.push_str(part);
                continue;
            }
            // Mitsuba replaces known names wherever they stand, so "$res_x" may be "$res" and "_x".
            let known = (1..=length.min(LONGEST_NAME)).rev().find(|&end| self.parameters.contains_key(&part[..end]));
            let Some(end) = known else {
                let name = &part[..length];
                let near = did_you_mean(name, self.parameters.keys().map(String::as_str));
                let hint = match near {
                    Some(near) => format!("did you mean '${near}'? or give it by --define {name}=value"),
                    None => format!("give it by --define {name}=value"),
                };
                return Err(self.fault(spot, format!("the parameter '${name}' has no value here")).with_hint(hint));
            };
            self.needed.insert(part[..end].to_string());
            filled.push_str(&self.parameters[&part[..end]]);
            filled.push_str(&part[end..]);
            self.grown += self.parameters[&part[..end]].len();
            if self.grown > MOST_GROWTH {
                return Err(self.fault(spot, "the parameters make the values too long"));
            }
        }
        Ok(filled)
    }

    /// The value of a property element, `None` for an element we do not know.
    pub(super) fn value(
        &mut self,
        file: &File,
        node: Node,
        element: &Element,
        name: &str,
    ) -> Result<Option<(Value, Spot)>> {
        let tag = node.tag_name().name();
        if tag == "transform" {
            return Ok(Some((Value::Transform(self.transform(file, node)?), element.spot)));
        }
        if tag == "blackbody" || (tag == "spectrum" && element.get("filename").is_some()) {
            return Ok(Some((Value::Spectrum(self.special_spectrum(file, element)?), element.spot)));
        }
        let parsed = match tag {
            "point" | "vector" if element.get("value").is_none() => self.axes(element)?,
            "float" | "integer" | "boolean" | "string" | "point" | "vector" | "rgb" | "srgb" | "spectrum" => {
                let Some(Attribute { text, spot, .. }) = element.get("value") else {
                    return Err(self.fault(element.spot, format!("<{tag}> needs the attribute 'value'")));
                };
                let parsed = match tag {
                    "float" => value::number(text).map(Value::Float),
                    "integer" => value::integer(text).map(Value::Integer),
                    "boolean" => value::boolean(text).map(Value::Boolean),
                    "string" if name == "filename" => {
                        Ok(Value::Text(self.find(file, text).to_string_lossy().into_owned()))
                    }
                    "string" => Ok(Value::Text(text.clone())),
                    "rgb" => value::rgb(text).map(Value::Rgb),
                    "srgb" => value::srgb(text).map(Value::Rgb),
                    "spectrum" => value::spectrum(text).map(|spectrum| match spectrum {
                        SpectrumText::Spectrum(spectrum) => Value::Spectrum(spectrum),
                        SpectrumText::Rgb(rgb) => Value::Rgb(rgb),
                    }),
                    _ => value::triple(text).map(|xyz| Value::Vector(DVec3::from_array(xyz))),
                };
                parsed.map_err(|message| self.fault(*spot, message))?
            }
            _ => return Ok(None),
        };
        Ok(Some((parsed, element.spot("value"))))
    }

    /// A point or vector from `x`, `y` and `z`, 0 where one is missing.
    fn axes(&self, element: &Element) -> Result<Value> {
        let mut xyz = [0.0; 3];
        for (slot, axis) in xyz.iter_mut().zip(["x", "y", "z"]) {
            if let Some(text) = element.text(axis) {
                *slot = value::number(text).map_err(|message| self.fault(element.spot(axis), message))?;
            }
        }
        Ok(Value::Vector(DVec3::from_array(xyz)))
    }

    /// A black body, or a spectrum from a file.
    fn special_spectrum(&self, file: &File, element: &Element) -> Result<Spectrum> {
        let Some(Attribute { text: name, spot, .. }) = element.get("filename") else {
            let number = |name: &str, default: f64| match element.get(name) {
                // 0.6 writes "5000K" as well.
                Some(Attribute { text, spot, .. }) => {
                    value::number(text.trim_end_matches(['K', 'k'])).map_err(|message| self.fault(*spot, message))
                }
                None => Ok(default),
            };
            return Ok(Spectrum::BlackBody {
                temperature: number("temperature", 5000.0)?,
                scale: number("scale", 1.0)?,
            });
        };
        let path = self.find(file, name);
        let bytes = self.folder.read(&path).map_err(|error| {
            Error::io(self.folder.shown(&path), "read", &error).with_place(self.document.place(*spot))
        })?;
        value::spectrum_file(&String::from_utf8_lossy(&bytes))
            .map_err(|message| self.fault(*spot, format!("'{name}' is not a spectrum: {message}")))
    }

    fn transform(&mut self, file: &File, node: Node) -> Result<DMat4> {
        let mut all = DMat4::IDENTITY;
        for child in node.children().filter(Node::is_element) {
            let element = self.element(file, child)?;
            let step = transform::step(child.tag_name().name(), |name| element.text(name));
            let step = step.map_err(|fault| self.fault(element.spot(fault.attribute), fault.message))?;
            all = step * all;
        }
        match all.to_cols_array().iter().all(|value| value.is_finite() && value.abs() <= f64::from(f32::MAX)) {
            true => Ok(all),
            false => Err(self.fault(tag_spot(file, node), "the transform is not finite")),
        }
    }
}

/// The start tag's name, without the content.
pub(super) fn tag_spot(file: &File, node: Node) -> Spot {
    let range = node.range();
    let text = &file.source.text[range.clone()];
    let length = text.find('>').map_or(text.len(), |at| at + 1);
    Spot { source: file.index, start: range.start, end: range.start + length }
}

/// `toWorld` as Mitsuba 3 names it, `to_world`; `intIOR` as `int_ior`.
pub(super) fn with_underscores(name: &str) -> String {
    let mut out = String::new();
    let mut before_is_small = false;
    for c in name.chars() {
        if c.is_uppercase() && before_is_small {
            out.push('_');
        }
        before_is_small = c.is_lowercase() || c.is_ascii_digit();
        out.extend(c.to_lowercase());
    }
    out
}
