//! What can go wrong, said so that the person who can mend it knows where and how.

use std::fmt;
use std::path::PathBuf;

/// The result of everything that reads what a user wrote.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// A place in a user's file. Lines and columns count from 1; columns count characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file as the user named it.
    pub file: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The bytes of the file that are meant, to underline them; empty where only a point is known.
    pub span: std::ops::Range<usize>,
}

impl Place {
    /// The place of `span` (byte offsets, clamped to the text) in `text`, the content of `file`.
    pub fn of(file: impl Into<PathBuf>, text: &str, span: std::ops::Range<usize>) -> Place {
        let mut start = span.start.min(text.len());
        while !text.is_char_boundary(start) {
            start -= 1;
        }
        let before = &text[..start];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        let end = span.end.clamp(start, text.len());
        Place { file: file.into(), line, column, span: start..end }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file.display(), self.line, self.column)
    }
}

/// One thing that is wrong with what the user gave, in one sentence, with its place and a way out.
///
/// Displayed as `file:line:column: message; hint`, each part where it is known.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Error {
    /// What is wrong: lower case, no full stop.
    pub message: String,
    /// What to try, where we know.
    pub hint: Option<String>,
    /// The file, where the fault is in one but no line is known (a binary mesh, a missing file).
    pub file: Option<PathBuf>,
    /// The line and column, where known; its `file` wins over [`Error::file`].
    pub place: Option<Box<Place>>,
    /// The key in the [`SceneDescription`](crate::scene::SceneDescription), such as `shapes[2].radius`,
    /// from which an importer finds the place; with a `/` before it once it is complete.
    pub key: Option<String>,
}

impl Error {
    /// An error with a message alone; add to it with the `with_` methods.
    pub fn new(message: impl Into<String>) -> Error {
        Error { message: message.into(), hint: None, file: None, place: None, key: None }
    }

    /// An error about the value of `key` in the scene description.
    pub fn at_key(key: impl Into<String>, message: impl Into<String>) -> Error {
        Error { key: Some(key.into()), ..Error::new(message) }
    }

    /// What went wrong in reading or writing `file`.
    pub fn io(file: impl Into<PathBuf>, doing: &str, error: &std::io::Error) -> Error {
        let file = file.into();
        let message = match error.kind() {
            std::io::ErrorKind::NotFound => format!("cannot {doing} '{}': no such file or folder", file.display()),
            std::io::ErrorKind::PermissionDenied => format!("cannot {doing} '{}': permission denied", file.display()),
            std::io::ErrorKind::StorageFull => format!("cannot {doing} '{}': the disk is full", file.display()),
            std::io::ErrorKind::IsADirectory => format!("cannot {doing} '{}': it is a folder", file.display()),
            _ => format!("cannot {doing} '{}': {error}", file.display()),
        };
        Error::new(message)
    }

    /// The same error with what to try.
    #[must_use]
    pub fn with_hint(mut self, hint: impl Into<String>) -> Error {
        self.hint = Some(hint.into());
        self
    }

    /// The same error, of this file.
    #[must_use]
    pub fn with_file(mut self, file: impl Into<PathBuf>) -> Error {
        self.file.get_or_insert_with(|| file.into());
        self
    }

    /// The same error at this place, unless a more exact one is known already.
    #[must_use]
    pub fn with_place(mut self, place: Place) -> Error {
        self.place.get_or_insert_with(|| Box::new(place));
        self
    }

    /// The same error with `prefix.` put before its key, as the caller knows where the part belongs. A key that
    /// [starts at the root](Error::at_root) stays as it is.
    #[must_use]
    pub fn under(mut self, prefix: &str) -> Error {
        self.key = Some(match self.key {
            Some(key) if key.starts_with('/') => key,
            Some(key) if key.starts_with('[') => format!("{prefix}{key}"),
            Some(key) => format!("{prefix}.{key}"),
            None => prefix.to_string(),
        });
        self
    }
}

impl Error {
    /// The same error, its key now complete: what is wrong stands elsewhere than where it is used.
    #[must_use]
    pub fn at_root(self) -> Error {
        Error { key: self.key.map(|key| if key.starts_with('/') { key } else { format!("/{key}") }), ..self }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.place, &self.file) {
            (Some(place), _) => write!(f, "{place}: ")?,
            (None, Some(file)) => write!(f, "{}: ", file.display())?,
            (None, None) => {}
        }
        write!(f, "{}", self.message)?;
        if let Some(hint) = &self.hint {
            write!(f, "; {hint}")?;
        }
        Ok(())
    }
}

/// Something the user should know of that did not stop the work; shown like an [`Error`].
pub type Warning = Error;

/// `; did you mean 'x'?` material: the candidate nearest to `word`, if one is near.
pub fn did_you_mean<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // To compare two words takes the product of their lengths, and nobody mistypes a page; and a file may ask for
    // thousands of names that it does not have among thousands that it has.
    const LONGEST: usize = 100;
    const MOST: usize = 1000;
    let candidates = candidates.into_iter().take(if word.len() <= LONGEST { MOST } else { 0 });
    let candidates = candidates.filter(|candidate| candidate.len() <= LONGEST);
    candidates
        .map(|candidate| {
            // The first measure knows common beginnings, the second swapped letters.
            let likeness = strsim::jaro_winkler(word, candidate);
            let swaps = strsim::normalized_damerau_levenshtein(word, candidate);
            (likeness.max(swaps + 0.15), candidate)
        })
        .filter(|(likeness, _)| *likeness > 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_counts_lines_and_characters_from_one() {
        let text = "one\nzwei ä drei\n";
        let at = text.find("drei").expect("the word is there");
        let place = Place::of("a.toml", text, at..at + 4);
        assert_eq!((place.line, place.column), (2, 8));
        assert_eq!(place.to_string(), "a.toml:2:8");
    }

    #[test]
    fn a_near_word_is_proposed_and_a_far_one_is_not() {
        assert_eq!(did_you_mean("radus", ["center", "radius"]), Some("radius"));
        assert_eq!(did_you_mean("iro", ["center", "ior"]), Some("ior"));
        assert_eq!(did_you_mean("zzz", ["center", "radius"]), None);
    }

    #[test]
    fn long_words_are_not_compared() {
        let (word, near) = ("a".repeat(1 << 20), format!("{}b", "a".repeat(1 << 20)));
        assert_eq!(did_you_mean(&word, [near.as_str()]), None);
        assert_eq!(did_you_mean("radus", [near.as_str(), "radius"]), Some("radius"));
    }

    #[test]
    fn keys_nest() {
        let error = Error::at_key("radius", "must be positive").under("shapes[2]");
        assert_eq!(error.key.as_deref(), Some("shapes[2].radius"));
    }
}
