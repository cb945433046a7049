//! From tokens to statements, file by file.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::super::gzip;
use super::super::source::{Folder, Source, Spot};
use super::lexer::{self, Kind, Token};
use super::statement::{Parameter, Statement, Values};
use crate::error::{Error, Place, Result, did_you_mean};

/// What follows the keyword of a statement.
struct Form {
    keyword: &'static str,
    /// How many strings at least and at most.
    texts: (usize, usize),
    numbers: usize,
    /// Whether a bare word follows, as in `ActiveTransform All`.
    word: bool,
    parameters: bool,
}

const fn form(keyword: &'static str, texts: (usize, usize), numbers: usize, parameters: bool) -> Form {
    Form { keyword, texts, numbers, word: false, parameters }
}

/// All statements of pbrt-v4, and those of pbrt-v3 that it dropped.
const FORMS: [Form; 44] = [
    form("Accelerator", (1, 1), 0, true),
    Form { keyword: "ActiveTransform", texts: (0, 0), numbers: 0, word: true, parameters: false },
    form("AreaLightSource", (1, 1), 0, true),
    form("Attribute", (1, 1), 0, true),
    form("AttributeBegin", (0, 0), 0, false),
    form("AttributeEnd", (0, 0), 0, false),
    form("Camera", (1, 1), 0, true),
    form("ColorSpace", (1, 1), 0, false),
    form("ConcatTransform", (0, 0), 16, false),
    form("CoordinateSystem", (1, 1), 0, false),
    form("CoordSysTransform", (1, 1), 0, false),
    form("Film", (1, 1), 0, true),
    form("Identity", (0, 0), 0, false),
    form("Import", (1, 1), 0, false),
    form("Include", (1, 1), 0, false),
    form("Integrator", (1, 1), 0, true),
    form("LightSource", (1, 1), 0, true),
    form("LookAt", (0, 0), 9, false),
    form("MakeNamedMaterial", (1, 1), 0, true),
    form("MakeNamedMedium", (1, 1), 0, true),
    form("Material", (1, 1), 0, true),
    form("MediumInterface", (1, 2), 0, false),
    form("NamedMaterial", (1, 1), 0, false),
    form("ObjectBegin", (1, 1), 0, false),
    form("ObjectEnd", (0, 0), 0, false),
    form("ObjectInstance", (1, 1), 0, false),
    form("Option", (0, 0), 0, true),
    form("PixelFilter", (1, 1), 0, true),
    form("Renderer", (1, 1), 0, true),
    form("ReverseOrientation", (0, 0), 0, false),
    form("Rotate", (0, 0), 4, false),
    form("Sampler", (1, 1), 0, true),
    form("Scale", (0, 0), 3, false),
    form("Shape", (1, 1), 0, true),
    form("SurfaceIntegrator", (1, 1), 0, true),
    form("Texture", (3, 3), 0, true),
    form("Transform", (0, 0), 16, false),
    form("TransformBegin", (0, 0), 0, false),
    form("TransformEnd", (0, 0), 0, false),
    form("TransformTimes", (0, 0), 2, false),
    form("Translate", (0, 0), 3, false),
    form("VolumeIntegrator", (1, 1), 0, true),
    form("WorldBegin", (0, 0), 0, false),
    form("WorldEnd", (0, 0), 0, false),
];

/// How deep includes may lie in each other, and how many there may be.
const DEEPEST_INCLUDE: usize = 32;
const MOST_INCLUDES: usize = 10_000;
/// Bytes that files may have in all which are included again.
const MOST_REPEATED: usize = 1 << 24;

/// What comes next.
pub(super) enum Event {
    Statement(Statement),
    /// A word that is no statement of pbrt; what follows it has been passed over.
    Unknown(Spot),
    /// The end of a file that was included (`false`) or imported (`true`).
    Left(bool),
}

/// A file being read.
struct Open {
    path: PathBuf,
    source: usize,
    at: usize,
    imported: bool,
}

/// All files read so far.
pub(super) struct Reader<'a> {
    pub folder: &'a dyn Folder,
    sources: Vec<Source>,
    open: Vec<Open>,
    includes: usize,
    /// The number of each file's source.
    read: HashMap<PathBuf, usize>,
    /// Bytes of files that were read before.
    repeated: usize,
}

impl<'a> Reader<'a> {
    pub fn new(folder: &'a dyn Folder, main: &Path) -> Result<Reader<'a>> {
        let (sources, open, read) = (Vec::new(), Vec::new(), HashMap::new());
        let mut reader = Reader { folder, sources, open, includes: 0, read, repeated: 0 };
        reader.open(main, false)?;
        Ok(reader)
    }

    /// The file, line and column of `spot`.
    pub fn place(&self, spot: Spot) -> Place {
        self.sources[spot.source].place(spot.start..spot.end)
    }

    pub fn fault(&self, spot: Spot, message: impl Into<String>) -> Error {
        Error::new(message).with_place(self.place(spot))
    }

    /// The text at `spot`.
    pub fn text(&self, spot: Spot) -> &str {
        &self.sources[spot.source].text[spot.start..spot.end]
    }

    /// The bytes of a file that the scene names, unpacked.
    pub fn bytes(&self, file: &Path, from: Spot) -> Result<Vec<u8>> {
        let shown = self.folder.shown(file);
        let placed = |error: Error| error.with_place(self.place(from));
        let bytes = self.folder.read(file).map_err(|error| placed(Error::io(&shown, "read", &error)))?;
        Ok(gzip::unpacked(&shown.to_string_lossy(), &bytes).map_err(placed)?.into_owned())
    }

    /// Goes on in another file, named relative to the folder of the main one, as in pbrt.
    pub fn include(&mut self, file: &str, from: Spot, imported: bool) -> Result<()> {
        let path = Path::new(file);
        self.includes += 1;
        if self.open.iter().any(|open| open.path == path) {
            return Err(self.fault(from, format!("'{file}' includes itself")));
        }
        if let Some(&source) = self.read.get(path) {
            self.repeated += self.sources[source].text.len();
        }
        if self.open.len() > DEEPEST_INCLUDE || self.includes > MOST_INCLUDES || self.repeated > MOST_REPEATED {
            return Err(self.fault(from, "too many files are included, or too deeply"));
        }
        self.open(path, imported).map_err(|error| error.with_place(self.place(from)))
    }

    fn open(&mut self, path: &Path, imported: bool) -> Result<()> {
        let source = match self.read.get(path) {
            Some(&source) => source,
            None => self.source(path)?,
        };
        let at = if self.sources[source].text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        self.open.push(Open { path: path.to_path_buf(), source, at, imported });
        Ok(())
    }

    /// Reads a file that was not read before; the number of its source.
    fn source(&mut self, path: &Path) -> Result<usize> {
        let shown = self.folder.shown(path);
        let bytes = self.folder.read(path).map_err(|error| Error::io(&shown, "read", &error))?;
        let bytes = gzip::unpacked(&shown.to_string_lossy(), &bytes)?;
        // Bytes that are not UTF-8 harm only names and comments.
        let text = String::from_utf8_lossy(&bytes).into_owned();
        self.sources.push(Source::new(shown, text.into_bytes())?);
        self.read.insert(path.to_path_buf(), self.sources.len() - 1);
        Ok(self.sources.len() - 1)
    }

    /// The statement that an unknown word may have been meant for.
    pub fn near(&self, unknown: Spot) -> Option<&'static str> {
        did_you_mean(self.text(unknown), FORMS.iter().map(|form| form.keyword))
    }

    /// The next statement; `None` at the end of the main file.
    pub fn next(&mut self) -> Result<Option<Event>> {
        let Some(token) = self.token()? else {
            let left = self.open.pop();
            return Ok(left.filter(|_| !self.open.is_empty()).map(|left| Event::Left(left.imported)));
        };
        if token.kind != Kind::Word {
            let found = self.shown(token);
            return Err(self
                .fault(token.spot, format!("a statement such as Shape must stand here, not {found}"))
                .with_hint("is a value left over, or a bracket missing, before this?"));
        }
        let word = self.text(token.spot);
        match FORMS.iter().find(|form| form.keyword == word) {
            Some(form) => Ok(Some(Event::Statement(self.statement(form, token.spot)?))),
            None if is_value(word) => {
                let message = format!("a statement such as Shape must stand here, not '{word}'");
                Err(self.fault(token.spot, message).with_hint("is a bracket missing before this?"))
            }
            None => {
                while self.peek()?.is_some_and(|next| next.kind != Kind::Word || is_value(self.text(next.spot))) {
                    self.token()?;
                }
                Ok(Some(Event::Unknown(token.spot)))
            }
        }
    }

    fn statement(&mut self, form: &Form, spot: Spot) -> Result<Statement> {
        let mut statement = Statement::new(form.keyword, spot);
        while statement.texts.len() < form.texts.1 {
            match self.peek()? {
                Some(token) if token.kind == Kind::Text => {
                    self.token()?;
                    statement.texts.push(lexer::unescaped(self.text(token.spot)));
                }
                _ if statement.texts.len() >= form.texts.0 => break,
                other => return Err(self.missing(form.keyword, "a name in quotes", other, spot)),
            }
        }
        if form.word {
            match self.token()? {
                Some(token) if token.kind == Kind::Word => statement.texts.push(self.text(token.spot).to_string()),
                other => return Err(self.missing(form.keyword, "a word", other, spot)),
            }
        }
        if form.numbers > 0 {
            statement.numbers = self.numbers(form, spot)?;
        }
        while form.parameters && self.peek()?.is_some_and(|token| token.kind == Kind::Text) {
            let parameter = self.parameter()?;
            statement.parameters.push(parameter);
        }
        Ok(statement)
    }

    /// The numbers of a transform, in brackets or not.
    fn numbers(&mut self, form: &Form, spot: Spot) -> Result<Vec<f64>> {
        let bracket = self.peek()?.filter(|token| token.kind == Kind::Open);
        if bracket.is_some() {
            self.token()?;
        }
        let mut numbers = Vec::with_capacity(form.numbers);
        while numbers.len() < form.numbers {
            match self.token()? {
                Some(token) if token.kind == Kind::Word => numbers.push(self.number(token)?),
                other => return Err(self.missing(form.keyword, &format!("{} numbers", form.numbers), other, spot)),
            }
        }
        if bracket.is_some() {
            match self.token()? {
                Some(token) if token.kind == Kind::Close => {}
                other => return Err(self.missing(form.keyword, "a closing bracket", other, spot)),
            }
        }
        Ok(numbers)
    }

    /// `"type name"` and a value, or several in brackets.
    fn parameter(&mut self) -> Result<Parameter> {
        let Some(declared) = self.token()? else { return Err(Error::new("a parameter must stand here")) };
        let text = lexer::unescaped(self.text(declared.spot));
        let mut words = text.split_ascii_whitespace();
        let (Some(kind), Some(name)) = (words.next(), words.next()) else {
            let message = format!("'{text}' declares no parameter");
            return Err(self
                .fault(declared.spot, message)
                .with_hint("write a type and a name, such as \"float radius\""));
        };
        let mut parameter = Parameter::new(kind, name, declared.spot);
        match self.token()? {
            Some(token) if token.kind == Kind::Open => loop {
                match self.token()? {
                    Some(token) if token.kind == Kind::Close => break,
                    Some(token) if token.kind != Kind::Open => self.value(&mut parameter, token)?,
                    _ => {
                        let message = format!("the values of '{name}' have no closing bracket");
                        return Err(self.fault(declared.spot, message));
                    }
                }
            },
            Some(token) if token.kind != Kind::Close => self.value(&mut parameter, token)?,
            _ => return Err(self.fault(declared.spot, format!("the parameter '{name}' has no value"))),
        }
        Ok(parameter)
    }

    fn value(&self, parameter: &mut Parameter, token: Token) -> Result<()> {
        let text = self.text(token.spot);
        let mixed = match (&mut parameter.values, token.kind, text) {
            (Values::Empty, Kind::Text, _) => {
                parameter.values = Values::Texts(vec![lexer::unescaped(text)]);
                false
            }
            (Values::Texts(texts), Kind::Text, _) => {
                texts.push(lexer::unescaped(text));
                false
            }
            (Values::Empty, _, "true" | "false") => {
                parameter.values = Values::Booleans(vec![text == "true"]);
                false
            }
            (Values::Booleans(booleans), _, "true" | "false") => {
                booleans.push(text == "true");
                false
            }
            (Values::Empty, Kind::Word, _) => {
                parameter.values = Values::Numbers(vec![self.number(token)?]);
                false
            }
            (Values::Numbers(numbers), Kind::Word, _) => {
                numbers.push(self.number(token)?);
                false
            }
            _ => true,
        };
        match mixed {
            true => Err(self.fault(token.spot, format!("the values of '{}' are of different sorts", parameter.name))),
            false => Ok(()),
        }
    }

    fn number(&self, token: Token) -> Result<f64> {
        let text = self.text(token.spot);
        match text.parse::<f64>() {
            Ok(value) if value.abs() <= f64::from(f32::MAX) => Ok(value),
            Ok(_) => Err(self.fault(token.spot, format!("'{text}' is not a finite number or too large"))),
            Err(_) => {
                let error = self.fault(token.spot, format!("a number must stand here, not '{text}'"));
                Err(match text.starts_with(|c: char| c.is_ascii_alphabetic()) {
                    true => error.with_hint("is a bracket, a quote or a number missing before this?"),
                    false => error,
                })
            }
        }
    }

    fn missing(&self, keyword: &str, wanted: &str, found: Option<Token>, from: Spot) -> Error {
        match found {
            Some(token) => {
                let found = self.shown(token);
                self.fault(token.spot, format!("{keyword} needs {wanted}, but {found} stands here"))
            }
            None => self.fault(from, format!("{keyword} needs {wanted}, but the file ends")),
        }
    }

    fn shown(&self, token: Token) -> String {
        let text: String = self.text(token.spot).chars().take(40).collect();
        if token.kind == Kind::Text { format!("\"{text}\"") } else { format!("'{text}'") }
    }

    fn token(&mut self) -> Result<Option<Token>> {
        let Some(open) = self.open.last_mut() else { return Ok(None) };
        let next = lexer::next(&self.sources[open.source], open.source, open.at)?;
        if let Some((_, end)) = next {
            open.at = end;
        }
        Ok(next.map(|(token, _)| token))
    }

    fn peek(&self) -> Result<Option<Token>> {
        let Some(open) = self.open.last() else { return Ok(None) };
        Ok(lexer::next(&self.sources[open.source], open.source, open.at)?.map(|(token, _)| token))
    }
}

/// Whether a bare word is a value and not the start of a statement.
fn is_value(word: &str) -> bool {
    matches!(word, "true" | "false") || !word.starts_with(|c: char| c.is_ascii_alphabetic())
}
