//! Scene files of pbrt-v4, and of pbrt-v3 as far as they are alike.
//!
//! Statements are read one after the other (`reader`) under a graphics state (`state`). Meshes are kept at once;
//! materials, textures and what hangs on them wait for the end of the file, since pbrt lets a shape name a material
//! that comes later. What a statement's part of the description asks for counts as understood; the rest is a warning.
//!
//! Colours are RGB here and not spectra. A light's `L` or `I` is scaled to luminance 1 before `scale` applies, but for
//! RGB colours, which stay as they are: so it is in pbrt, whose film shows an RGB radiance as the same RGB.

mod camera;
mod film;
mod integrator;
mod lexer;
mod light;
mod loopsubdiv;
mod material;
mod medium;
mod meshes;
mod reader;
mod shape;
mod spectrum;
mod state;
mod statement;

#[cfg(test)]
mod tests;
mod texture;
mod v3;

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

use self::medium::Sides;
use self::reader::{Event, Reader};
use self::shape::Pending;
use self::state::State;
use self::statement::{Statement, Wrong};
use self::texture::Textures;
use super::Imported;
use super::source::{Disk, Folder, Spot};
use crate::error::{Error, Result, Warning};
use crate::geometry::MeshData;
use crate::scene::SceneDescription;

/// Reads a pbrt scene file. Files that it names are relative to its folder, as in pbrt.
///
/// # Errors
/// Where the file cannot be read, its syntax is broken, a value is of the wrong sort, or a mesh, a material or an
/// object that it names does not exist; with the place. What pbrt can and we cannot is a warning.
pub fn read(path: &Path) -> Result<Imported> {
    let folder = Disk(path.parent().unwrap_or(Path::new("")).to_path_buf());
    match path.file_name() {
        Some(name) => read_from(&folder, Path::new(name)),
        None => Err(Error::new(format!("'{}' is not a file", path.display()))),
    }
}

fn read_from(folder: &dyn Folder, main: &Path) -> Result<Imported> {
    Importer {
        reader: Reader::new(folder, main)?,
        imported: Imported::default(),
        warned: HashSet::new(),
        state: State::default(),
        saved: Vec::new(),
        systems: HashMap::new(),
        in_world: false,
        is_v3: false,
        options: HashMap::new(),
        exposure: 1.0,
        group: None,
        groups: BTreeMap::new(),
        pending: Vec::new(),
        named_materials: BTreeMap::new(),
        own_materials: Vec::new(),
        textures: Textures::default(),
        meshes: HashMap::new(),
        subdivided: 0,
        eye: Sides::default(),
    }
    .scene()
}

/// A description in the making.
struct Importer<'a> {
    reader: Reader<'a>,
    imported: Imported,
    /// Warnings given already, by place and message.
    warned: HashSet<(usize, usize, String)>,
    state: State,
    /// States to go back to, with what opened each.
    saved: Vec<(Opened, State, Spot)>,
    /// Named coordinate systems.
    systems: HashMap<String, glam::DMat4>,
    in_world: bool,
    /// Whether something showed that the file is of version 3.
    is_v3: bool,
    /// `Camera`, `Film`, `Sampler` and the like, by keyword, with the transform at that place.
    options: HashMap<&'static str, (Statement, glam::DMat4)>,
    /// Pixel value over radiance, from the film's `iso` and the camera's shutter.
    exposure: f64,
    /// The object being defined.
    group: Option<String>,
    /// Where each object is defined.
    groups: BTreeMap<String, Spot>,
    pending: Vec<Pending>,
    named_materials: BTreeMap<String, Rc<Statement>>,
    /// Materials without a name, by number.
    own_materials: Vec<Rc<Statement>>,
    textures: Textures,
    /// Meshes read already, by file.
    meshes: HashMap<String, Arc<MeshData>>,
    /// Triangles made by subdivision so far.
    subdivided: usize,
    /// What the camera stands in.
    eye: Sides,
}

/// What saved a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Opened {
    Attribute,
    Transform,
    Object,
    Import,
}

/// How deep states may be saved.
const DEEPEST_STATE: usize = 4096;

impl<'a> Importer<'a> {
    fn scene(mut self) -> Result<Imported> {
        while let Some(event) = self.reader.next()? {
            match event {
                Event::Statement(statement) => self.statement(statement)?,
                Event::Left(true) => self.restore(Opened::Import, None)?,
                Event::Left(false) => {}
                Event::Unknown(spot) if super::has_room(&self.imported.warnings) => {
                    let message = format!("'{}' is no statement of pbrt and is passed over", self.reader.text(spot));
                    match self.reader.near(spot) {
                        Some(near) => self.warn_with(spot, message, &format!("did you mean {near}?")),
                        None => self.warn(spot, message),
                    }
                }
                Event::Unknown(_) => {}
            }
        }
        if let Some(&(opened, _, spot)) = self.saved.last() {
            self.warn(spot, format!("{opened:?}Begin has no {opened:?}End"));
        }
        self.finish_options()?;
        self.finish_materials()?;
        self.finish_shapes()?;
        self.medium_around();
        Ok(self.imported)
    }

    fn statement(&mut self, mut statement: Statement) -> Result<()> {
        let spot = statement.spot;
        if self.transform_statement(&statement)? {
            return Ok(());
        }
        self.state.inherit(&mut statement);
        match statement.keyword {
            "WorldBegin" => self.world_begin(),
            "WorldEnd" => self.note_v3(spot),
            "Include" => self.reader.include(statement.sort(), spot, false)?,
            "Import" => {
                self.save(Opened::Import, spot)?;
                self.reader.include(statement.sort(), spot, true)?;
            }
            "AttributeBegin" => self.save(Opened::Attribute, spot)?,
            "AttributeEnd" => self.restore(Opened::Attribute, Some(spot))?,
            "TransformBegin" => self.save(Opened::Transform, spot)?,
            "TransformEnd" => self.restore(Opened::Transform, Some(spot))?,
            "Attribute" => {
                let fault = |_| self.reader.fault(spot, "too many parameters are set by 'Attribute'");
                self.state.attribute(statement).map_err(fault)?;
            }
            "ReverseOrientation" => self.state.reverse = !self.state.reverse,
            "ObjectBegin" => self.object_begin(&statement)?,
            "ObjectEnd" => {
                self.group = None;
                self.restore(Opened::Object, Some(spot))?;
            }
            "ObjectInstance" => self.instance(&statement)?,
            "Shape" => self.shape(statement)?,
            "LightSource" => self.light(&statement)?,
            "AreaLightSource" => self.state.area_light = Some(Rc::new(statement)),
            "Material" => self.material(statement),
            "MakeNamedMaterial" => self.make_named_material(statement)?,
            "NamedMaterial" => self.state.material = material::Use::Named(statement.sort().to_string(), spot),
            "Texture" => self.textures.declare(statement),
            "MakeNamedMedium" | "MediumInterface" | "VolumeIntegrator" => self.medium_statement(&statement)?,
            "ColorSpace" if statement.sort() != "srgb" => {
                let message =
                    format!("the colour space '{}' is not supported: colours are taken for sRGB", statement.sort());
                self.warn(spot, message);
            }
            "Camera" => {
                self.eye = self.state.media.clone();
                self.options.insert(statement.keyword, (statement, self.state.ctm));
            }
            "Film" | "Sampler" | "PixelFilter" | "Integrator" => {
                self.options.insert(statement.keyword, (statement, self.state.ctm));
            }
            "SurfaceIntegrator" => {
                statement.keyword = "Integrator";
                self.options.insert("Integrator", (statement, self.state.ctm));
            }
            // What only makes pbrt faster or changes its output beside the picture.
            _ => {}
        }
        Ok(())
    }

    /// The transforms so far were the camera's; the world begins without any.
    fn world_begin(&mut self) {
        if let Some((_, matrix)) = self.options.get("Camera") {
            self.systems.insert("camera".to_string(), matrix.inverse());
        }
        self.systems.insert("world".to_string(), glam::DMat4::IDENTITY);
        self.state.ctm = glam::DMat4::IDENTITY;
        self.in_world = true;
        self.find_exposure();
    }

    fn note_v3(&mut self, spot: Spot) {
        if !self.is_v3 {
            self.is_v3 = true;
            self.warn(spot, "this is a file of pbrt-v3: what pbrt-v4 does differently may look different");
        }
    }

    fn save(&mut self, opened: Opened, spot: Spot) -> Result<()> {
        if self.saved.len() >= DEEPEST_STATE {
            return Err(self.reader.fault(spot, "blocks are nested too deeply"));
        }
        self.saved.push((opened, self.state.clone(), spot));
        Ok(())
    }

    fn restore(&mut self, opened: Opened, spot: Option<Spot>) -> Result<()> {
        match (self.saved.last().map(|(saved, ..)| *saved), spot) {
            (Some(saved), _) if saved == opened => {
                if let Some((_, state, _)) = self.saved.pop() {
                    match opened {
                        Opened::Transform => self.state.ctm = state.ctm,
                        _ => self.state = state,
                    }
                }
                Ok(())
            }
            (Some(saved), Some(spot)) => {
                let message = format!("{opened:?}End stands here, but the last block was opened by {saved:?}Begin");
                Err(self.reader.fault(spot, message))
            }
            (None, Some(spot)) => Err(self.reader.fault(spot, format!("{opened:?}End has no {opened:?}Begin"))),
            // An imported file that left blocks open: its states go with it.
            (Some(_), None) => {
                while let Some((saved, state, _)) = self.saved.pop() {
                    self.state = state;
                    if saved == opened {
                        break;
                    }
                }
                Ok(())
            }
            (None, None) => Ok(()),
        }
    }

    fn description(&mut self) -> &mut SceneDescription {
        &mut self.imported.description
    }

    /// Warns, once for each place and message.
    fn warn(&mut self, spot: Spot, message: impl Into<String>) {
        self.push_warning(spot, Warning::new(message));
    }

    fn warn_with(&mut self, spot: Spot, message: impl Into<String>, hint: &str) {
        self.push_warning(spot, Warning::new(message).with_hint(hint));
    }

    fn push_warning(&mut self, spot: Spot, warning: Warning) {
        let has_room = super::has_room(&self.imported.warnings);
        if has_room && self.warned.insert((spot.source, spot.start, warning.message.clone())) {
            let place = self.reader.place(spot);
            super::warn(&mut self.imported.warnings, || warning.with_place(place));
        }
    }

    /// Warns of all that `statement` was not asked for.
    fn leftovers(&mut self, statement: &Statement) {
        if super::has_room(&self.imported.warnings) {
            statement.leftovers().into_iter().for_each(|(spot, warning)| self.push_warning(spot, warning));
        }
    }

    /// An answer of a statement, its fault with the place.
    fn placed<T>(&self, answer: Result<T, Wrong>) -> Result<T> {
        answer.map_err(|(spot, message)| self.reader.fault(spot, message))
    }

    fn note(&mut self, key: impl Into<String>, spot: Spot) {
        let place = self.reader.place(spot);
        self.imported.places.note(key, place);
    }
}
