//! Text files as an importer sees them: where they lie, what they say, and what line a byte is on.

use std::fs::{self, File};
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{Error, Place, Result};

/// The folder of the scene file. Names are relative to it, so that tests can do without a file system.
pub(super) trait Folder {
    fn read(&self, file: &Path) -> io::Result<Vec<u8>>;
    fn has(&self, file: &Path) -> bool;
    /// The name to show in messages.
    fn shown(&self, file: &Path) -> PathBuf;
}

/// A folder on the disk.
pub(super) struct Disk(pub PathBuf);

impl Folder for Disk {
    fn read(&self, file: &Path) -> io::Result<Vec<u8>> {
        read(&self.0.join(file))
    }

    fn has(&self, file: &Path) -> bool {
        self.0.join(file).exists()
    }

    fn shown(&self, file: &Path) -> PathBuf {
        self.0.join(file)
    }
}

/// All of an ordinary file, see [`open`].
pub(super) fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    io::Read::read_to_end(&mut open(path)?, &mut bytes)?;
    Ok(bytes)
}

/// Opens an ordinary file. A scene may come from anyone, and what it names need not be one: to open a pipe may wait for
/// ever, and some devices never end.
pub(super) fn open(path: &Path) -> io::Result<File> {
    let found = fs::metadata(path)?;
    if found.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !found.is_file() {
        return Err(io::Error::other("it is a pipe or a device, not a file"));
    }
    File::open(path)
}

/// A stretch of one of an importer's text files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Spot {
    /// Which file, in the order of reading.
    pub source: usize,
    pub start: usize,
    pub end: usize,
}

/// A file's text and where its lines are.
pub(super) struct Source {
    file: PathBuf,
    pub text: String,
    lines: Lines,
}

/// Where the lines of a text begin, and stations on the way through long ones: a file can have all it says on one line,
/// and something to be told of every word.
pub(super) struct Lines(Vec<Station>);

/// A byte of a text with its line and column, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Station {
    at: usize,
    line: usize,
    column: usize,
}

/// Characters between two stations on one line.
const STATION: usize = 512;

impl Lines {
    /// Of `text`.
    pub fn of(text: &str) -> Lines {
        let mut here = Station { at: 0, line: 1, column: 1 };
        let mut stations = vec![here];
        for (at, character) in text.char_indices() {
            if character == '\n' {
                here = Station { at: at + 1, line: here.line + 1, column: 1 };
                stations.push(here);
            } else if character != '\u{feff}' {
                here = Station { at: at + character.len_utf8(), column: here.column + 1, ..here };
                if here.column.is_multiple_of(STATION) {
                    stations.push(here);
                }
            }
        }
        Lines(stations)
    }

    /// The place of these bytes of `text`, whose lines these are, in `file`.
    pub fn place(&self, file: &Path, text: &str, span: Range<usize>) -> Place {
        let mut start = span.start.min(text.len());
        while !text.is_char_boundary(start) {
            start -= 1;
        }
        let Station { at, line, column } = self.0[self.0.partition_point(|station| station.at <= start) - 1];
        let column = column + text[at..start].chars().filter(|&character| character != '\u{feff}').count();
        Place { file: file.to_path_buf(), line, column, span: start..span.end.clamp(start, text.len()) }
    }

    /// Where a line begins, from 1.
    fn line(&self, line: usize) -> Option<usize> {
        let first = self.0.partition_point(|station| station.line < line);
        self.0.get(first).filter(|station| station.line == line).map(|station| station.at)
    }
}

impl Source {
    /// Takes the bytes of `file`: UTF-8, with or without a byte-order mark.
    pub fn new(file: PathBuf, bytes: Vec<u8>) -> Result<Source> {
        if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
            let error = Error::new("the file is in UTF-16").with_hint("save it as UTF-8");
            return Err(error.with_file(file));
        }
        let text = match String::from_utf8(bytes) {
            Ok(text) => text,
            Err(error) => {
                let at = error.utf8_error().valid_up_to();
                let lossy = String::from_utf8_lossy(error.as_bytes());
                let place = Place::of(file, &lossy, at..at);
                return Err(Error::new("this is not UTF-8 text").with_place(place).with_hint("save the file as UTF-8"));
            }
        };
        let lines = Lines::of(&text);
        Ok(Source { file, text, lines })
    }

    /// The place of these bytes.
    pub fn place(&self, span: Range<usize>) -> Place {
        self.lines.place(&self.file, &self.text, span)
    }

    /// The place of a line and column, both from 1, as XML errors name it.
    pub fn place_at(&self, line: usize, column: usize) -> Place {
        let begin = self.lines.line(line.max(1)).unwrap_or(self.text.len());
        let rest = &self.text[begin..];
        let at = begin + rest.char_indices().nth(column.saturating_sub(1)).map_or(rest.len(), |(at, _)| at);
        self.place(at..at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_those_of_counting() {
        let text = format!("\u{feff}one\n\nä{} b\n{}é c", "xy".repeat(2000), "ö".repeat(1500));
        let source = Source::new(PathBuf::from("a"), text.clone().into_bytes()).expect("UTF-8");
        for (at, _) in text.char_indices().skip(1) {
            let counted = Place::of("a", text.trim_start_matches('\u{feff}'), at - 3..at - 3);
            let place = source.place(at..at);
            assert_eq!((place.line, place.column), (counted.line, counted.column), "{at}");
            assert_eq!(source.place_at(place.line, place.column + usize::from(place.line == 1)).span, at..at);
        }
    }
}
