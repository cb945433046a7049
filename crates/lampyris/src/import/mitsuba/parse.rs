//! From XML to a [`Document`]: parameters, includes, references.

mod property;

use std::cell::Cell;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use roxmltree::Node;

use self::property::{Element, tag_spot, with_underscores};
use super::super::warn;
use super::document::{Document, Kind, Object, Part, Property, Spot};
use super::source::{Folder, Source};
use crate::error::{Error, Result, Warning, did_you_mean};

const MOST_NODES: u32 = 50_000_000;
/// Folders in which a `path` may tell us to look: each is asked for each file.
const MOST_FOLDERS: usize = 64;
const MOST_INCLUDES: usize = 4096;
const DEEPEST_INCLUDE: usize = 16;
/// The XML reader compares each attribute of an element with all others.
const MOST_ATTRIBUTES: usize = 1000;
/// Bytes that files may have in all which are included again.
const MOST_REPEATED: usize = 1 << 24;
const DEEPEST_OBJECT: usize = 32;

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
        sources: HashMap::new(),
        repeated: 0,
        grown: 0,
        warnings: Vec::new(),
    };
    parser.file(main, None, true)?;
    parser.resolve()?;
    for (name, _) in defines.iter().filter(|(name, _)| !parser.needed.contains(name)) {
        warn(&mut parser.warnings, || Warning::new(format!("no parameter '${name}' is used in the scene file")));
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
    /// The files read so far.
    sources: HashMap<PathBuf, Rc<Source>>,
    /// Bytes of files that were read before.
    repeated: usize,
    /// Bytes by which parameters have made values longer.
    grown: usize,
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

impl Parser<'_> {
    fn fault(&self, spot: Spot, message: impl Into<String>) -> Error {
        Error::new(message).with_place(self.document.place(spot))
    }

    fn warn(&mut self, spot: Spot, message: impl Into<String>) {
        let Parser { document, warnings, .. } = self;
        warn(warnings, || Warning::new(message).with_place(document.place(spot)));
    }

    /// Reads one file, its objects becoming those of the scene.
    fn file(&mut self, path: &Path, from: Option<Spot>, old: bool) -> Result<()> {
        let source = match self.sources.get(path) {
            Some(source) => Rc::clone(source),
            None => self.source(path, from)?,
        };
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

    /// Reads a file that was not read before.
    fn source(&mut self, path: &Path, from: Option<Spot>) -> Result<Rc<Source>> {
        let shown = self.folder.shown(path);
        let mut bytes = self.folder.read(path).map_err(|error| {
            let error = Error::io(shown.clone(), "read", &error);
            match from {
                Some(spot) => error.with_place(self.document.place(spot)),
                None => error,
            }
        })?;
        blank_comments(&mut bytes);
        let source = Rc::new(Source::new(shown, bytes)?);
        if let Some(at) = crowded(source.text.as_bytes()) {
            let message = format!("this element has more than {MOST_ATTRIBUTES} attributes");
            return Err(Error::new(message).with_place(source.place(at..at + 1)));
        }
        self.sources.insert(path.to_path_buf(), Rc::clone(&source));
        Ok(source)
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
                if self.search.len() == MOST_FOLDERS {
                    return Err(self.fault(element.spot, format!("there are more than {MOST_FOLDERS} <path>")));
                }
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
        self.repeated += self.sources.get(&path).map_or(0, |source| source.text.len());
        let too_deep = self.including.len() >= DEEPEST_INCLUDE;
        if too_deep || self.includes > MOST_INCLUDES || self.repeated > MOST_REPEATED {
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
            old: file.old,
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

/// Overwrites what stands in comments with blanks: real files hold `--` there, which XML forbids but Mitsuba's
/// reader takes. Offsets and lines stay as they are.
fn blank_comments(bytes: &mut [u8]) {
    let mut at = 0;
    while at < bytes.len() {
        let rest = &bytes[at..];
        let (opening, closing): (usize, &[u8]) = if rest.starts_with(b"<!--") {
            (4, b"-->")
        } else if rest.starts_with(b"<![CDATA[") {
            (9, b"]]>")
        } else {
            at += 1;
            continue;
        };
        let Some(length) = rest[opening..].windows(3).position(|three| three == closing) else { return };
        let content = at + opening..at + opening + length;
        if opening == 4 {
            bytes[content.clone()].iter_mut().filter(|byte| !matches!(byte, b'\n' | b'\r')).for_each(|b| *b = b' ');
        }
        at = content.end + 3;
    }
}

/// Where an element begins that has more attributes than are read, or what it has of them; in text without comments.
fn crowded(bytes: &[u8]) -> Option<usize> {
    let mut at = 0;
    while let Some(start) = bytes[at..].iter().position(|&byte| byte == b'<').map(|length| at + length) {
        let (mut quote, mut values) = (None, 0);
        at = start + 1;
        if bytes[at..].starts_with(b"![CDATA[") {
            at += bytes[at..].windows(3).position(|three| three == b"]]>")?;
            continue;
        }
        for &byte in &bytes[at..] {
            at += 1;
            match (quote, byte) {
                (None, b'>') => break,
                (None, b'"' | b'\'') => (quote, values) = (Some(byte), values + 1),
                (Some(open), _) if byte == open => quote = None,
                _ => {}
            }
        }
        if values > MOST_ATTRIBUTES {
            return Some(start);
        }
    }
    None
}
