//! From XML to a [`Document`]: parameters, includes, references.

use std::cell::Cell;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use glam::{DMat4, DVec3};
use roxmltree::Node;

use super::document::{Document, Kind, Object, Part, Property, Spectrum, Spot, Value};
use super::source::{Folder, Source};
use super::transform;
use super::value::{self, SpectrumText};
use crate::error::{Error, Result, Warning, did_you_mean};

const MOST_NODES: u32 = 50_000_000;
const MOST_INCLUDES: usize = 4096;
const DEEPEST_INCLUDE: usize = 16;
const DEEPEST_OBJECT: usize = 32;
/// Bytes of an attribute with its parameters filled in: parameters made of parameters may grow without end.
const LONGEST_VALUE: usize = 1 << 20;

/// Reads `main` and all it includes. `defines` go before the file's own `default`s.
pub(super) fn parse(
    folder: &dyn Folder,
    main: &Path,
    defines: &[(String, String)],
) -> Result<(Document, Vec<Warning>)> {
    let mut parser = Parser {
        folder,
        document: Document::default(),
        parameters: defines.iter().cloned().collect(),
        needed: HashSet::new(),
        ids: HashMap::new(),
        references: Vec::new(),
        search: Vec::new(),
        including: Vec::new(),
        includes: 0,
        warnings: Vec::new(),
    };
    parser.file(main, None, true)?;
    parser.resolve()?;
    for (name, _) in defines.iter().filter(|(name, _)| !parser.needed.contains(name)) {
        parser.warnings.push(Warning::new(format!("no parameter '${name}' is used in the scene file")));
    }
    Ok((parser.document, parser.warnings))
}

struct Parser<'a> {
    folder: &'a dyn Folder,
    document: Document,
    parameters: HashMap<String, String>,
    /// Parameters that the file uses or gives a default.
    needed: HashSet<String>,
    ids: HashMap<String, usize>,
    /// Parts still without their object: owner, number of the part, and the id they name.
    references: Vec<(usize, usize, String)>,
    /// Folders named by `path`, relative to the scene's.
    search: Vec<PathBuf>,
    including: Vec<PathBuf>,
    includes: usize,
    warnings: Vec<Warning>,
}

/// The file at hand.
struct File {
    source: Rc<Source>,
    index: usize,
    folder: PathBuf,
    /// Version 0.x: names in camelCase.
    old: bool,
}

/// An attribute with its parameters filled in.
struct Attribute<'a> {
    name: &'a str,
    text: String,
    spot: Spot,
}

/// What `<default>`, a property or an object is made from.
struct Element<'a> {
    attributes: Vec<Attribute<'a>>,
    spot: Spot,
}

impl Element<'_> {
    fn get(&self, name: &str) -> Option<&Attribute<'_>> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    fn text(&self, name: &str) -> Option<&str> {
        self.get(name).map(|attribute| attribute.text.as_str())
    }

    fn spot(&self, name: &str) -> Spot {
        self.get(name).map_or(self.spot, |attribute| attribute.spot)
    }
}

impl Parser<'_> {
    fn fault(&self, spot: Spot, message: impl Into<String>) -> Error {
        Error::new(message).with_place(self.document.place(spot))
    }

    fn warn(&mut self, spot: Spot, message: impl Into<String>) {
        let warning = self.fault(spot, message);
        self.warnings.push(warning);
    }

    /// Reads one file, its objects becoming those of the scene.
    fn file(&mut self, path: &Path, from: Option<Spot>, old: bool) -> Result<()> {
        let shown = self.folder.shown(path);
        let placed = |error: Error, parser: &Self| match from {
            Some(spot) => error.with_place(parser.document.place(spot)),
            None => error,
        };
        let bytes = self.folder.read(path).map_err(|error| placed(Error::io(shown.clone(), "read", &error), self))?;
        let source = Rc::new(Source::new(shown, bytes)?);
        let options = roxmltree::ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..Default::default() };
        let xml = roxmltree::Document::parse_with_options(&source.text, options)
            .map_err(|error| not_well_formed(&source, &error))?;
        let index = self.document.sources.len();
        self.document.sources.push(Rc::clone(&source));
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let mut file = File { source: Rc::clone(&source), index, folder, old };
        let root = xml.root_element();
        if root.tag_name().name() != "scene" {
            let message = format!("the file must hold a <scene>, not a <{}>", root.tag_name().name());
            return Err(self.fault(tag_spot(&file, root), message));
        }
        match root.attribute("version").map(|version| version.split('.').next().unwrap_or("").parse::<u32>()) {
            Some(Ok(major)) => file.old = major < 2,
            Some(Err(_)) => {
                return Err(self.fault(tag_spot(&file, root), "the version must be written like '3.0.0'"));
            }
            None if from.is_none() => {
                file.old = false;
                self.warn(tag_spot(&file, root), "the scene has no version; it is read as version 3");
            }
            None => {}
        }
        self.including.push(path.to_path_buf());
        for node in root.children().filter(Node::is_element) {
            self.scene_child(&file, node)?;
        }
        self.including.pop();
        Ok(())
    }

    fn scene_child(&mut self, file: &File, node: Node) -> Result<()> {
        let tag = node.tag_name().name();
        if self.setting(file, node)? {
            return Ok(());
        }
        if tag == "include" {
            return self.include(file, node);
        }
        match Kind::of_tag(tag) {
            Some(kind) => {
                let element = self.element(file, node)?;
                let object = self.object(file, node, &element, kind, 0)?;
                self.document.scene.push(object);
            }
            None => self.warn(tag_spot(file, node), format!("<{tag}> in the scene is left out")),
        }
        Ok(())
    }

    /// Elements that may stand anywhere and make no object.
    fn setting(&mut self, file: &File, node: Node) -> Result<bool> {
        let required = |parser: &Self, element: &Element, name: &str| match element.text(name) {
            Some(text) => Ok(text.to_string()),
            None => {
                let message = format!("<{}> needs the attribute '{name}'", node.tag_name().name());
                Err(parser.fault(element.spot, message))
            }
        };
        match node.tag_name().name() {
            "default" => {
                let element = self.element(file, node)?;
                let name = required(self, &element, "name")?;
                let value = required(self, &element, "value")?;
                self.needed.insert(name.clone());
                self.parameters.entry(name).or_insert(value);
            }
            "path" => {
                let element = self.element(file, node)?;
                let path = element.text("value").or(element.text("filename")).unwrap_or(".");
                self.search.push(file.folder.join(path.replace('\\', "/")));
            }
            "alias" => {
                let element = self.element(file, node)?;
                let (id, other) = (required(self, &element, "id")?, required(self, &element, "as")?);
                match self.ids.get(&id) {
                    Some(&object) => self.name(other, object, element.spot)?,
                    None => return Err(self.unknown_id(&id, element.spot("id"))),
                }
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn include(&mut self, file: &File, node: Node) -> Result<()> {
        let element = self.element(file, node)?;
        let spot = element.spot("filename");
        let name = element.text("filename").ok_or(self.fault(spot, "<include> needs the attribute 'filename'"))?;
        let path = self.find(file, name);
        self.includes += 1;
        if self.including.contains(&path) {
            return Err(self.fault(spot, format!("'{name}' includes itself")));
        }
        if self.including.len() >= DEEPEST_INCLUDE || self.includes > MOST_INCLUDES {
            return Err(self.fault(spot, "the files include each other too often"));
        }
        self.file(&path, Some(spot), file.old)
    }

    /// The file `name`, relative to the scene's folder: beside the file that names it, in a folder that a
    /// `path` names, or beside the scene file. One that is nowhere stays as it is written.
    fn find(&self, file: &File, name: &str) -> PathBuf {
        let forward = name.replace('\\', "/");
        let folders = std::iter::once(&file.folder).chain(&self.search);
        let mut candidates = folders.map(|folder| folder.join(&forward)).chain([PathBuf::from(&forward), name.into()]);
        candidates.find(|candidate| self.folder.has(candidate)).unwrap_or_else(|| file.folder.join(&forward))
    }

    /// The attributes of `node`, with parameters filled in.
    fn element<'n>(&mut self, file: &File, node: Node<'n, '_>) -> Result<Element<'n>> {
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
            let known = (1..=length).rev().find(|&end| self.parameters.contains_key(&part[..end]));
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
            if filled.len() > LONGEST_VALUE + text.len() {
                return Err(self.fault(spot, "the parameters make this value too long"));
            }
        }
        Ok(filled)
    }

    fn name(&mut self, id: String, object: usize, spot: Spot) -> Result<()> {
        if let Some(&other) = self.ids.get(&id) {
            let first = self.document.place(self.document.objects[other].spot);
            return Err(self.fault(spot, format!("the id '{id}' stands for another object already, at {first}")));
        }
        self.ids.insert(id, object);
        Ok(())
    }

    fn unknown_id(&self, id: &str, spot: Spot) -> Error {
        let error = self.fault(spot, format!("no object has the id '{id}'"));
        match did_you_mean(id, self.ids.keys().map(String::as_str)) {
            Some(near) => error.with_hint(format!("did you mean '{near}'?")),
            None => error,
        }
    }

    /// An object with all that is in it.
    fn object(&mut self, file: &File, node: Node, element: &Element, kind: Kind, depth: usize) -> Result<usize> {
        if depth >= DEEPEST_OBJECT {
            return Err(self.fault(element.spot, "the objects are nested too deeply"));
        }
        let Some(plugin) = element.text("type") else {
            return Err(self.fault(element.spot, format!("<{}> needs the attribute 'type'", kind.tag())));
        };
        let id = element.text("id").map(str::to_string);
        let number = self.document.objects.len();
        let object = Object {
            kind,
            plugin: plugin.to_string(),
            id: id.clone(),
            spot: element.spot,
            properties: Vec::new(),
            parts: Vec::new(),
        };
        self.document.objects.push(object);
        if let Some(id) = id {
            self.name(id, number, element.spot("id"))?;
        }
        for child in node.children().filter(Node::is_element) {
            self.object_child(file, child, number, depth)?;
        }
        Ok(number)
    }

    fn object_child(&mut self, file: &File, node: Node, owner: usize, depth: usize) -> Result<()> {
        if self.setting(file, node)? {
            return Ok(());
        }
        let tag = node.tag_name().name();
        let element = self.element(file, node)?;
        let written = element.text("name").unwrap_or("");
        let name = if file.old { with_underscores(written) } else { written.to_string() };
        if tag == "ref" {
            let Some(id) = element.text("id") else {
                return Err(self.fault(element.spot, "<ref> needs the attribute 'id'"));
            };
            let parts = &mut self.document.objects[owner].parts;
            self.references.push((owner, parts.len(), id.to_string()));
            parts.push(Part { name, object: owner, spot: element.spot("id"), used: Cell::new(false) });
            return Ok(());
        }
        let kind = Kind::of_tag(tag).filter(|&kind| kind != Kind::Spectrum || element.get("type").is_some());
        if let Some(kind) = kind {
            let object = self.object(file, node, &element, kind, depth + 1)?;
            let part = Part { name, object, spot: element.spot, used: Cell::new(false) };
            self.document.objects[owner].parts.push(part);
            return Ok(());
        }
        match self.value(file, node, &element, &name)? {
            Some((value, spot)) => {
                let property = Property { name, value, spot, used: Cell::new(false) };
                self.document.objects[owner].properties.push(property);
            }
            None => {
                let Object { kind, plugin, .. } = &self.document.objects[owner];
                let message = format!("<{tag}> in {} '{plugin}' is left out", kind.tag());
                self.warn(element.spot, message);
            }
        }
        Ok(())
    }

    /// The value of a property element, `None` for an element we do not know.
    fn value(&mut self, file: &File, node: Node, element: &Element, name: &str) -> Result<Option<(Value, Spot)>> {
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

    /// Gives every reference its object.
    fn resolve(&mut self) -> Result<()> {
        for (owner, part, id) in std::mem::take(&mut self.references) {
            let spot = self.document.objects[owner].parts[part].spot;
            match self.ids.get(&id) {
                Some(&object) => self.document.objects[owner].parts[part].object = object,
                None => return Err(self.unknown_id(&id, spot)),
            }
        }
        Ok(())
    }
}

/// The start tag's name, without the content.
fn tag_spot(file: &File, node: Node) -> Spot {
    let range = node.range();
    let text = &file.source.text[range.clone()];
    let length = text.find('>').map_or(text.len(), |at| at + 1);
    Spot { source: file.index, start: range.start, end: range.start + length }
}

fn not_well_formed(source: &Source, error: &roxmltree::Error) -> Error {
    let place = source.place_at(error.pos().row as usize, error.pos().col as usize);
    if matches!(error, roxmltree::Error::DtdDetected) {
        let error = Error::new("document type declarations are not read").with_place(place);
        return error.with_hint("remove <!DOCTYPE ...> and the entities it declares");
    }
    let message = error.to_string();
    let message = message.rsplit_once(" at ").map_or(message.as_str(), |(message, _)| message);
    Error::new(format!("this is not well-formed XML: {message}")).with_place(place)
}

/// `toWorld` as Mitsuba 3 names it, `to_world`; `intIOR` as `int_ior`.
fn with_underscores(name: &str) -> String {
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
