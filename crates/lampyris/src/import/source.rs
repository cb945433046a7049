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

/// A file's text and the beginnings of its lines.
pub(super) struct Source {
    file: PathBuf,
    pub text: String,
    lines: Vec<usize>,
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
        let mut lines = vec![0];
        lines.extend(text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at + 1));
        Ok(Source { file, text, lines })
    }

    /// The place of these bytes; cheap, as it looks at one line only.
    pub fn place(&self, span: Range<usize>) -> Place {
        let mut start = span.start.min(self.text.len());
        while !self.text.is_char_boundary(start) {
            start -= 1;
        }
        let line = self.lines.partition_point(|&begin| begin <= start);
        let column = self.text[self.lines[line - 1]..start].trim_start_matches('\u{feff}').chars().count() + 1;
        Place { file: self.file.clone(), line, column, span: start..span.end.clamp(start, self.text.len()) }
    }

    /// The place of a line and column, both from 1, as XML errors name it.
    pub fn place_at(&self, line: usize, column: usize) -> Place {
        let begin = self.lines.get(line.saturating_sub(1)).copied().unwrap_or(self.text.len());
        let rest = &self.text[begin..];
        let at = begin + rest.char_indices().nth(column.saturating_sub(1)).map_or(rest.len(), |(at, _)| at);
        self.place(at..at)
    }
}
