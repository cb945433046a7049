//! Archives of arrays, as NumPy makes them: zip files.

use std::io::{self, Cursor, Read, Seek, Write};

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use crate::error::{Error, Result};

/// Writes what a file holds.
type Content<'a> = dyn Fn(&mut dyn Write) -> io::Result<()> + 'a;

/// A file within another.
pub(super) struct Member<'a> {
    pub name: String,
    /// Bytes that it has.
    pub length: u64,
    pub write: Box<Content<'a>>,
}

impl Member<'_> {
    /// With these bytes.
    pub(super) fn of_bytes<'a>(name: &str, bytes: Vec<u8>) -> Member<'a> {
        let length = bytes.len() as u64;
        Member { name: name.into(), length, write: Box::new(move |to| to.write_all(&bytes)) }
    }
}

/// The members are written one after the other, so that not all of them need be in memory at once.
pub(super) fn write_npz(to: impl Write + Seek, members: &[Member<'_>]) -> io::Result<()> {
    let mut file = ZipWriter::new(to);
    for Member { name, length, write } in members {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .compression_level(Some(1))
            .large_file(*length > u64::from(u32::MAX));
        file.start_file(name.as_str(), options)?;
        write(&mut file)?;
    }
    file.finish()?;
    Ok(())
}

/// An archive that is read.
pub(super) struct Archive<'a> {
    file: ZipArchive<Cursor<&'a [u8]>>,
    /// Bytes that a member may have.
    most: u64,
}

impl<'a> Archive<'a> {
    /// What these bytes hold.
    ///
    /// # Errors
    /// Bytes that are no archive.
    pub(super) fn of(bytes: &'a [u8]) -> Result<Archive<'a>> {
        let file = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
        // Deflate makes at most 1032 bytes of one, and what claims more is not believed.
        Ok(Archive { file, most: (bytes.len() as u64).saturating_mul(1032) })
    }

    /// The bytes of a member; none if there is none of this name.
    ///
    /// # Errors
    /// A member that is damaged.
    pub(super) fn member(&mut self, name: &str) -> Result<Option<Vec<u8>>> {
        let member = match self.file.by_name(name) {
            Err(ZipError::FileNotFound) => return Ok(None),
            found => found.map_err(damaged)?,
        };
        let mut content = Vec::new();
        member.take(self.most).read_to_end(&mut content).map_err(damaged)?;
        Ok(Some(content))
    }
}

fn damaged(error: impl std::fmt::Display) -> Error {
    Error::new(format!("the NPZ file is damaged: {error}"))
}
