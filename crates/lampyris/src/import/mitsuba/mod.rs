//! Mitsuba 3 and 0.6 scene files.
//!
//! A file becomes a `Document` first: objects with typed properties, with parameters filled in, includes
//! read and references resolved. Each kind of object then has its file here that turns it into its part of the
//! [`SceneDescription`]. What a plugin asks for counts as understood; the rest is a warning.
//!
//! Where we differ on purpose: points and lookats may leave out axes and `up`; the camera may be scaled; colours
//! above 1 and unknown parameters are not refused here; clip planes hide nothing; black bodies and `uniform`,
//! `regular` and `irregular` spectra work in RGB; a blend of mirror and diffuse keeps its energy.
//!
//! Facts about Mitsuba in comments were found by asking Mitsuba 3.9.1 (`scalar_rgb`).

mod bsdf;
mod capture;
mod document;
mod emitter;
mod integrator;
mod medium;
mod parse;
mod query;
mod sensor;
mod shape;
#[cfg(test)]
mod tests;
mod texture;
mod transform;

use std::collections::{HashMap, HashSet};
use std::path::Path;

use glam::{DMat4, DVec3};

use self::document::{Document, Kind, Spot};
use self::query::Query;
use super::source::{Disk, Folder};
use super::{Imported, named, source, spectrum, value};
use crate::error::{Error, Result, Warning};
use crate::scene::SceneDescription;
use crate::scene::description::{CaptureDescription, ShapeDescription};

/// How to read a Mitsuba file.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Values for the file's `$name` parameters, before its own `default`s: name without `$`, and value.
    pub defines: Vec<(String, String)>,
}

/// Reads a Mitsuba scene file, version 3, 2 or 0.x. Files that it names stay relative to its folder.
///
/// # Errors
/// Where the file cannot be read, is not XML, uses a parameter without a value or an id that does not exist, or
/// holds a value of the wrong sort; with the place. What Mitsuba can and we cannot is a warning.
pub fn read(path: &Path, options: &Options) -> Result<Imported> {
    let folder = Disk(path.parent().unwrap_or(Path::new("")).to_path_buf());
    match path.file_name() {
        Some(name) => read_from(&folder, Path::new(name), options),
        None => Err(Error::new(format!("'{}' is not a file", path.display()))),
    }
}

fn read_from(folder: &dyn Folder, main: &Path, options: &Options) -> Result<Imported> {
    let (document, warnings) = parse::parse(folder, main, &options.defines)?;
    let imported = Imported { warnings, ..Imported::default() };
    let importer = Importer {
        document: &document,
        imported,
        materials: HashMap::new(),
        textures: HashMap::new(),
        texture_depth: 0,
        parent: DMat4::IDENTITY,
        group: None,
        groups: HashMap::new(),
        media: HashMap::new(),
        interiors: HashSet::new(),
        exteriors: Vec::new(),
        meters: Vec::new(),
        capture: None,
        warned: HashSet::new(),
        visits: 0,
    };
    importer.scene()
}

/// How deep an object may lie in objects of its kind.
const DEEPEST_NESTING: usize = 16;

/// A description in the making.
struct Importer<'a> {
    document: &'a Document,
    imported: Imported,
    /// Names in the description of materials that are in it already, by object.
    materials: HashMap<usize, String>,
    /// Likewise of textures.
    textures: HashMap<usize, String>,
    /// How many textures the one at hand lies in.
    texture_depth: usize,
    /// What the shapes at hand lie in.
    parent: DMat4,
    /// The group at hand, which gathers shapes in place of the scene.
    group: Option<Group>,
    /// Names in the description of groups that are in it already, by object.
    groups: HashMap<usize, String>,
    /// Names in the description of media that are in it already, by object.
    media: HashMap<usize, String>,
    /// Those that shapes hold.
    interiors: HashSet<String>,
    /// Those that something stands in.
    exteriors: Vec<(String, Spot)>,
    /// Sensors on shapes, and the shapes' names.
    meters: Vec<(usize, String)>,
    /// What the integrator says of how a wall is captured.
    capture: Option<CaptureDescription>,
    /// Warnings given already, by file, offset and message.
    warned: HashSet<(usize, usize, String)>,
    /// Objects visited inside others.
    visits: usize,
}

/// A group of shapes in the making.
struct Group {
    name: String,
    shapes: Vec<ShapeDescription>,
}

impl<'a> Importer<'a> {
    fn scene(mut self) -> Result<Imported> {
        let mut sensors = Vec::new();
        let mut integrators = Vec::new();
        for &object in &self.document.scene {
            match self.document.objects[object].kind {
                Kind::Sensor => sensors.push(object),
                Kind::Integrator => integrators.push(object),
                Kind::Shape => self.shape(object)?,
                Kind::Bsdf => self.named_bsdf(object)?,
                Kind::Emitter => self.light(object)?,
                // Media wait for what they are in; textures for their BSDF.
                Kind::Medium | Kind::Texture | Kind::Spectrum | Kind::Volume | Kind::Phase => {}
                Kind::Sampler | Kind::Film | Kind::Filter | Kind::Subsurface => {
                    self.left_out(object, "left out");
                }
            }
        }
        self.integrator(&integrators)?;
        self.sensor(&sensors)?;
        self.medium_around();
        Ok(self.imported)
    }

    fn query(&self, object: usize) -> Query<'a> {
        Query::new(self.document, object)
    }

    fn description(&mut self) -> &mut SceneDescription {
        &mut self.imported.description
    }

    /// Counts a visit to an object inside others. References make nets of them, whose paths may be far more than
    /// the file has bytes.
    fn visit(&mut self, query: Query, depth: usize) -> Result<()> {
        self.visits += 1;
        if depth >= DEEPEST_NESTING || self.visits > 10_000 + 16 * self.document.objects.len() {
            let kind = query.object.kind.tag();
            return Err(query.fault("", format!("this {kind} is nested too deeply; perhaps it contains itself")));
        }
        Ok(())
    }

    /// Warns, once for each place and message.
    fn warn(&mut self, spot: Spot, message: impl Into<String>) {
        let message = message.into();
        let has_room = super::has_room(&self.imported.warnings);
        if has_room && self.warned.insert((spot.source, spot.start, message.clone())) {
            let place = self.document.place(spot);
            super::warn(&mut self.imported.warnings, || Warning::new(message).with_place(place));
        }
    }

    /// Warns that a plugin is not what it should be: `instead` says what was done.
    fn left_out(&mut self, object: usize, instead: &str) {
        let object = &self.document.objects[object];
        self.warn(object.spot, format!("{} '{}' is not supported: {instead}", object.kind.tag(), object.plugin));
    }

    /// Warns of all that `query` was not asked for.
    fn leftovers(&mut self, query: Query) {
        for (spot, message) in query.leftovers() {
            self.warn(spot, message);
        }
    }

    fn note(&mut self, key: impl Into<String>, spot: Spot) {
        let place = self.document.place(spot);
        self.imported.places.note(key, place);
    }

    /// Notes the places of properties whose names in the description differ from the file's: `(ours, theirs)`.
    fn note_all(&mut self, key: &str, query: Query, names: &[(&str, &str)]) {
        for (ours, theirs) in names {
            self.note(format!("{key}.{ours}"), query.spot(theirs));
        }
    }
}

/// A point or vector in the precision of a description.
fn single(vector: DVec3) -> [f32; 3] {
    vector.as_vec3().to_array()
}
