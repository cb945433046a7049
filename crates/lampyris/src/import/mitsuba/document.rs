//! A Mitsuba file as objects with typed properties: parameters filled in, files included, references resolved.

use std::cell::Cell;
use std::rc::Rc;

use glam::{DMat4, DVec3};

use super::source::Source;
pub(super) use super::source::Spot;
pub(super) use super::spectrum::Spectrum;
use crate::error::Place;

/// What sort of thing an object is; its tag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Integrator,
    Sensor,
    Sampler,
    Film,
    Filter,
    Shape,
    Bsdf,
    Emitter,
    Texture,
    Spectrum,
    Medium,
    Volume,
    Phase,
    Subsurface,
}

impl Kind {
    const TAGS: [(&'static str, Kind); 14] = [
        ("integrator", Kind::Integrator),
        ("sensor", Kind::Sensor),
        ("sampler", Kind::Sampler),
        ("film", Kind::Film),
        ("rfilter", Kind::Filter),
        ("shape", Kind::Shape),
        ("bsdf", Kind::Bsdf),
        ("emitter", Kind::Emitter),
        ("texture", Kind::Texture),
        ("spectrum", Kind::Spectrum),
        ("medium", Kind::Medium),
        ("volume", Kind::Volume),
        ("phase", Kind::Phase),
        ("subsurface", Kind::Subsurface),
    ];

    pub fn of_tag(tag: &str) -> Option<Kind> {
        Kind::TAGS.iter().find(|(name, _)| *name == tag).map(|(_, kind)| *kind)
    }

    pub fn tag(self) -> &'static str {
        Kind::TAGS.iter().find(|(_, kind)| *kind == self).map_or("object", |(name, _)| name)
    }
}

/// The value of a property.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Float(f64),
    Integer(i64),
    Boolean(bool),
    Text(String),
    Vector(DVec3),
    Rgb([f64; 3]),
    Spectrum(Spectrum),
    Transform(DMat4),
}

impl Value {
    pub fn sort(&self) -> &'static str {
        match self {
            Value::Float(_) => "a float",
            Value::Integer(_) => "an integer",
            Value::Boolean(_) => "a boolean",
            Value::Text(_) => "a string",
            Value::Vector(_) => "a point or vector",
            Value::Rgb(_) => "an rgb colour",
            Value::Spectrum(_) => "a spectrum",
            Value::Transform(_) => "a transform",
        }
    }
}

/// A named value.
#[derive(Debug)]
pub(super) struct Property {
    pub name: String,
    pub value: Value,
    pub spot: Spot,
    /// Whether anyone has asked for it.
    pub used: Cell<bool>,
}

/// An object inside an object, written there or referred to.
#[derive(Debug)]
pub(super) struct Part {
    /// Its role, or empty.
    pub name: String,
    /// Its number in the document.
    pub object: usize,
    pub spot: Spot,
    /// Whether anyone has asked for it.
    pub used: Cell<bool>,
}

/// A plugin with its parameters.
#[derive(Debug)]
pub(super) struct Object {
    pub kind: Kind,
    pub plugin: String,
    /// Whether its file is of version 0.x, whose defaults may differ.
    pub old: bool,
    pub id: Option<String>,
    pub spot: Spot,
    pub properties: Vec<Property>,
    pub parts: Vec<Part>,
}

/// All objects of a scene file and of the files it includes.
#[derive(Default)]
pub(super) struct Document {
    pub sources: Vec<Rc<Source>>,
    pub objects: Vec<Object>,
    /// The objects of the scene itself, in the order of the file.
    pub scene: Vec<usize>,
}

impl Document {
    /// The file, line and column of `spot`.
    pub fn place(&self, spot: Spot) -> Place {
        self.sources[spot.source].place(spot.start..spot.end)
    }
}
