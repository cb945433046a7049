//! Asking an object for its parameters, and noticing those nobody asked for.

use std::collections::HashSet;

use glam::{DMat4, DVec3};

use super::document::{Document, Kind, Object, Part, Property, Spectrum, Spot, Value};
use crate::error::{Error, Result};

/// An object being read. Whatever is asked for counts as understood.
#[derive(Clone, Copy)]
pub(super) struct Query<'a> {
    pub document: &'a Document,
    pub object: &'a Object,
}

impl<'a> Query<'a> {
    pub fn new(document: &'a Document, object: usize) -> Query<'a> {
        Query { document, object: &document.objects[object] }
    }

    pub fn property(&self, name: &str) -> Option<&'a Property> {
        let property = self.object.properties.iter().find(|property| property.name == name)?;
        property.used.set(true);
        Some(property)
    }

    /// Whether a value or an object stands under `name`.
    pub fn has(&self, name: &str) -> bool {
        self.object.properties.iter().any(|property| property.name == name)
            || self.object.parts.iter().any(|part| part.name == name)
    }

    /// Where `name` stands, or the object itself without it.
    pub fn spot(&self, name: &str) -> Spot {
        let property = self.object.properties.iter().find(|property| property.name == name);
        let part = self.object.parts.iter().find(|part| part.name == name);
        property.map(|property| property.spot).or(part.map(|part| part.spot)).unwrap_or(self.object.spot)
    }

    /// An error about `name`.
    pub fn fault(&self, name: &str, message: impl Into<String>) -> Error {
        Error::new(message).with_place(self.document.place(self.spot(name)))
    }

    fn wrong_sort(&self, property: &Property, wanted: &str) -> Error {
        let Property { name, value, .. } = property;
        self.fault(name, format!("'{name}' of '{}' must be {wanted}, not {}", self.object.plugin, value.sort()))
    }

    pub fn optional_float(&self, name: &str) -> Result<Option<f64>> {
        let Some(property) = self.property(name) else { return Ok(None) };
        match property.value {
            Value::Float(value) => Ok(Some(value)),
            Value::Integer(value) => Ok(Some(value as f64)),
            _ => Err(self.wrong_sort(property, "a float")),
        }
    }

    /// A number, if that is what stands there.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.property(name)?.value {
            Value::Float(value) | Value::Spectrum(Spectrum::Constant(value)) => Some(value),
            Value::Integer(value) => Some(value as f64),
            _ => None,
        }
    }

    pub fn float(&self, name: &str, default: f64) -> Result<f64> {
        Ok(self.optional_float(name)?.unwrap_or(default))
    }

    pub fn integer(&self, name: &str) -> Result<Option<i64>> {
        let Some(property) = self.property(name) else { return Ok(None) };
        match property.value {
            Value::Integer(value) => Ok(Some(value)),
            Value::Float(value) if value.fract() == 0.0 && value.abs() < 9e15 => Ok(Some(value as i64)),
            _ => Err(self.wrong_sort(property, "an integer")),
        }
    }

    /// A count that must fit and be at least `least`.
    pub fn count(&self, name: &str, least: u32) -> Result<Option<u32>> {
        let Some(value) = self.integer(name)? else { return Ok(None) };
        match u32::try_from(value) {
            Ok(count) if count >= least => Ok(Some(count)),
            _ => Err(self.fault(name, format!("'{name}' must be at least {least} and below 2^32, not {value}"))),
        }
    }

    pub fn boolean(&self, name: &str, default: bool) -> Result<bool> {
        let Some(property) = self.property(name) else { return Ok(default) };
        match property.value {
            Value::Boolean(value) => Ok(value),
            _ => Err(self.wrong_sort(property, "a boolean")),
        }
    }

    pub fn text(&self, name: &str) -> Result<Option<&'a str>> {
        let Some(property) = self.property(name) else { return Ok(None) };
        match &property.value {
            Value::Text(value) => Ok(Some(value)),
            _ => Err(self.wrong_sort(property, "a string")),
        }
    }

    pub fn vector(&self, name: &str) -> Result<Option<DVec3>> {
        let Some(property) = self.property(name) else { return Ok(None) };
        match property.value {
            Value::Vector(value) => Ok(Some(value)),
            _ => Err(self.wrong_sort(property, "a point or vector")),
        }
    }

    /// Three numbers, or one for all three.
    pub fn vector_or_float(&self, name: &str) -> Result<Option<DVec3>> {
        let Some(property) = self.property(name) else { return Ok(None) };
        match property.value {
            Value::Vector(value) => Ok(Some(value)),
            Value::Rgb(value) => Ok(Some(DVec3::from_array(value))),
            _ => self.optional_float(name).map(|value| value.map(DVec3::splat)),
        }
    }

    pub fn transform(&self, name: &str) -> Result<Option<DMat4>> {
        let Some(property) = self.property(name) else { return Ok(None) };
        match property.value {
            Value::Transform(value) => Ok(Some(value)),
            _ => Err(self.wrong_sort(property, "a transform")),
        }
    }

    /// Marks parameters that make no difference to us.
    pub fn ignore(&self, names: &[&str]) {
        for name in names {
            self.property(name);
            self.object.parts.iter().filter(|part| part.name == *name).for_each(|part| part.used.set(true));
        }
    }

    /// The part in the role `name`.
    pub fn named_part(&self, name: &str) -> Option<&'a Part> {
        let part = self.object.parts.iter().find(|part| part.name == name)?;
        part.used.set(true);
        Some(part)
    }

    /// All parts of one kind.
    pub fn parts(&self, kind: Kind) -> Vec<&'a Part> {
        let parts = self.object.parts.iter().filter(|part| self.document.objects[part.object].kind == kind);
        parts.inspect(|part| part.used.set(true)).collect()
    }

    /// The first part of one kind; others stay unused.
    pub fn part(&self, kind: Kind) -> Option<&'a Part> {
        let part = self.object.parts.iter().find(|part| self.document.objects[part.object].kind == kind)?;
        part.used.set(true);
        Some(part)
    }

    /// What nobody asked for, once.
    pub fn leftovers(&self) -> Vec<(Spot, String)> {
        let Object { kind, plugin, .. } = self.object;
        let of = format!("{} '{plugin}'", kind.tag());
        let unused = self.object.properties.iter().filter(|property| !property.used.replace(true));
        let mut seen = HashSet::new();
        let mut found: Vec<_> = unused
            .filter(|property| seen.insert(property.name.as_str()))
            .map(|property| (property.spot, format!("'{}' of {of} is not known and is ignored", property.name)))
            .collect();
        for part in self.object.parts.iter().filter(|part| !part.used.replace(true)) {
            let inner = &self.document.objects[part.object];
            let what = format!("{} '{}' in {of} is left out", inner.kind.tag(), inner.plugin);
            found.push((part.spot, what));
        }
        found
    }
}
