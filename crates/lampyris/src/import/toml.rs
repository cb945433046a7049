//! Lampyris's own scene files: [TOML](https://toml.io) whose tables and keys are those of a
//! [`SceneDescription`], in kebab-case.
//!
//! Where the description has a choice (of a shape, a light, a material, ...) the table's `type` says which, and
//! the keys of a shape's geometry stand beside those of the shape:
//!
//! ```toml
//! [[shapes]]
//! type = "sphere"
//! radius = 0.3
//! material = { type = "glass", ior = 1.5 }
//! ```

use std::ops::Range;
use std::path::Path;

use ::toml::Spanned;
use ::toml::de::{DeTable, DeValue};

use super::{Imported, Places, source};
use crate::error::{Error, Place, Result};
use crate::scene::SceneDescription;
use crate::scene::notation::{self, Fault};
use crate::scene::schema::Schema;

/// Reads the scene file at `path`.
///
/// # Errors
/// A file that cannot be read or is not UTF-8, and all errors of [`read_str`].
pub fn read(path: &Path) -> Result<Imported> {
    let bytes = source::read(path).map_err(|error| Error::io(path, "read", &error))?;
    match std::str::from_utf8(&bytes) {
        Ok(text) => read_str(path, text),
        Err(error) => {
            let at = error.valid_up_to();
            let before = String::from_utf8_lossy(&bytes[..at]);
            let message = format!("byte {at} of the file (0x{:02x}) is not UTF-8 text", bytes[at]);
            Err(Error::new(message).with_hint("save the file with the encoding UTF-8").with_place(Place::of(
                path,
                &before,
                at..at,
            )))
        }
    }
}

/// Reads `text`, the content of a scene file that messages call `file_name`.
///
/// # Errors
/// Text that is not TOML, that has an unknown key or type, lacks one that must be there, or has a value of
/// another form than its key asks for: each with line and column. Numbers that have the right form but make no
/// sense are found when the scene is built.
pub fn read_str(file_name: &Path, text: &str) -> Result<Imported> {
    let locate = |fault: Fault| fault.error.with_place(Place::of(file_name, text, fault.span));
    let tree = DeTable::parse(text).map_err(|error| locate(syntax(&error)))?;
    if tree.get_ref().is_empty() {
        return Err(Error::new("the scene file is empty").with_file(file_name).with_hint(
            "a scene needs a [camera], [[shapes]], and light: [[lights]], or 'emission' in one of the shapes",
        ));
    }
    let whole = tree.span();
    let tree = Spanned::new(whole, DeValue::Table(tree.into_inner()));
    let mut keys = Vec::new();
    let schema = Schema::of_scenes();
    let description: SceneDescription =
        notation::read(schema.scene(), "", tree, &mut |key, span| keys.push((key.to_string(), span)))
            .map_err(locate)?;
    Ok(Imported { description, places: places(file_name, text, keys), ..Imported::default() })
}

fn syntax(error: &::toml::de::Error) -> Fault {
    // The parser proposes a 'literal string' to whoever forgot the quotes; few know that term of TOML's.
    let message = error.message().trim().replace(", expected literal string", "");
    let message = message.replace("string values must be quoted", "a value is missing here, or a text without quotes");
    Fault { error: Error::new(message), span: error.span().unwrap_or_default() }
}

/// The places of `keys`, found in one walk through the text however many they are.
fn places(file_name: &Path, text: &str, mut keys: Vec<(String, Range<usize>)>) -> Places {
    keys.sort_by_key(|(_, span)| span.start);
    let mut places = Places::default();
    let (mut at, mut line, mut column) = (0, 1, 1);
    for (key, span) in keys {
        for character in text[at..span.start].chars() {
            (line, column) = if character == '\n' { (line + 1, 1) } else { (line, column + 1) };
        }
        at = span.start;
        places.note(key, Place { file: file_name.to_path_buf(), line, column, span });
    }
    places
}

#[cfg(test)]
mod tests;
