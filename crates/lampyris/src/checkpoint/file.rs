//! The bytes of a film.
//!
//! A file is, all numbers in little-endian order:
//!
//! | bytes | what |
//! |---|---|
//! | 16 | `LAMPYRIS FILM 5` and a line feed; the number is the version of this table |
//! | 8 | the length of the header |
//! | | the header, in JSON: the [`Identity`], the passes, the layers, how a wall is captured |
//! | 8 | the length of the pilot |
//! | | what the integrator measured before the first pass, in a form of its own |
//! | | the sums: for each of them, the higher limbs of all pixels, the lower limbs, and the numbers of the limbs |
//! | 4 | CRC-32 of all before |

use std::io::{self, Read, Write};

use serde::{Deserialize, Serialize};

use super::{Checkpoint, Identity};
use crate::error::{Error, Result};
use crate::film::{Film, FilmShape, PassSet, Storage};

/// The header of a file.
#[derive(Serialize, Deserialize)]
struct Header {
    identity: Identity,
    passes: PassSet,
    film: FilmShape,
}

pub(super) const MAGIC: &[u8; 16] = b"LAMPYRIS FILM 5\n";
/// What the files of all versions begin with.
const ANY_VERSION: usize = 14;
pub(super) const CHECKSUM: usize = 4;

impl Checkpoint {
    /// Whether bytes begin as those of a film do.
    pub fn is_in(bytes: &[u8]) -> bool {
        bytes.starts_with(&MAGIC[..ANY_VERSION])
    }

    /// The bytes of a file.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        // There is always room in memory.
        let _ = self.write(&mut bytes);
        bytes
    }

    /// Writes the bytes of a file, a part at a time.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn write(&self, to: &mut dyn Write) -> io::Result<()> {
        write(&self.identity, &self.pilot, &self.passes, &self.film, to)
    }

    /// What [`Checkpoint::encode`] made, in memory.
    ///
    /// # Errors
    /// Bytes that are no film, of another version, cut short or damaged.
    pub fn decode(mut bytes: &[u8]) -> Result<Checkpoint> {
        let length = bytes.len() as u64;
        Checkpoint::read(&mut bytes, length, |_| Storage::Memory)
    }

    /// What [`Checkpoint::write`] wrote, in so many bytes. `storage` says where its time bins are to be, which take so many.
    ///
    /// # Errors
    /// Bytes that are no film, of another version, cut short or damaged; those of `from`, and files for which there is no
    /// room.
    pub fn read(from: &mut dyn Read, length: u64, storage: impl FnOnce(u64) -> Storage) -> Result<Checkpoint> {
        Checkpoint::read_shaped(from, length, |shape| storage(shape.bytes_of_bins() as u64))
    }

    /// [`Checkpoint::read`] without time bins, for those who ask for the picture alone.
    ///
    /// # Errors
    /// As there.
    pub fn read_picture(from: &mut dyn Read, length: u64) -> Result<Checkpoint> {
        Checkpoint::read_shaped(from, length, |shape| {
            shape.drop_time();
            Storage::Memory
        })
    }

    /// `keep` may take from the shape what comes last.
    fn read_shaped(
        from: &mut dyn Read,
        length: u64,
        keep: impl FnOnce(&mut FilmShape) -> Storage,
    ) -> Result<Checkpoint> {
        let mut from = Hashed { inner: from, hash: crc32fast::Hasher::new(), left: length };
        let mut magic = [0; MAGIC.len()];
        let known = MAGIC.len().min(usize::try_from(length).unwrap_or(MAGIC.len()));
        from.read_exact(&mut magic[..known]).map_err(unread)?;
        if !Checkpoint::is_in(&magic) {
            return Err(Error::new("not a film of Lampyris").with_hint("films are what --checkpoint and merge write"));
        }
        if magic != *MAGIC {
            return Err(Error::new("a film of another version of Lampyris")
                .with_hint("go on with the version that wrote it, or begin anew"));
        }
        let mut header: Header = serde_json::from_slice(&part(&mut from)?).map_err(|_| damaged())?;
        let pilot = part(&mut from)?;
        // Before any memory is taken.
        let claimed = header.film.bytes().and_then(|bytes| u64::try_from(bytes).ok()?.checked_add(CHECKSUM as u64));
        if claimed != Some(from.left) || header.passes.count() != u64::from(header.film.passes()) {
            return Err(damaged());
        }
        let storage = keep(&mut header.film);
        let mut film = header.film.empty(&storage)?.ok_or_else(damaged)?;
        film.read_sums(&mut from).map_err(unread)?;
        let left = from.left.saturating_sub(CHECKSUM as u64);
        io::copy(&mut (&mut from).take(left), &mut io::sink()).map_err(unread)?;
        let hash = from.hash.clone().finalize();
        let mut checksum = [0; CHECKSUM];
        from.read_exact(&mut checksum).map_err(unread)?;
        if hash != u32::from_le_bytes(checksum) {
            return Err(damaged());
        }
        Ok(Checkpoint { identity: header.identity, pilot, passes: header.passes, film })
    }
}

/// Writes the bytes of a file with a film that holds these passes; `pilot` is what the integrator measured.
pub(crate) fn write(
    identity: &Identity,
    pilot: &[u8],
    passes: &PassSet,
    film: &Film,
    to: &mut dyn Write,
) -> io::Result<()> {
    let header = Header { identity: identity.clone(), passes: passes.clone(), film: film.shape() };
    let header = serde_json::to_vec(&header)?;
    let mut to = Hashed { inner: to, hash: crc32fast::Hasher::new(), left: u64::MAX };
    to.write_all(MAGIC)?;
    for part in [&header, pilot] {
        to.write_all(&(part.len() as u64).to_le_bytes())?;
        to.write_all(part)?;
    }
    film.write_sums(&mut to)?;
    let checksum = to.hash.finalize();
    to.inner.write_all(&checksum.to_le_bytes())
}

/// Bytes on their way from or to a file.
struct Hashed<I> {
    inner: I,
    /// Of all that have passed.
    hash: crc32fast::Hasher,
    /// How many are still to come.
    left: u64,
}

impl<R: Read> Read for Hashed<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let most = bytes.len().min(usize::try_from(self.left).unwrap_or(usize::MAX));
        let count = self.inner.read(&mut bytes[..most])?;
        self.hash.update(&bytes[..count]);
        self.left -= count as u64;
        Ok(count)
    }
}

impl<W: Write> Write for Hashed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.inner.write(bytes)?;
        self.hash.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// A part with its length before it, which takes no more memory than there are bytes.
fn part<R: Read>(from: &mut Hashed<R>) -> Result<Vec<u8>> {
    let mut length = [0; 8];
    from.read_exact(&mut length).map_err(unread)?;
    let length = u64::from_le_bytes(length);
    if length > from.left {
        return Err(damaged());
    }
    let mut part = Vec::new();
    from.take(length).read_to_end(&mut part).map_err(unread)?;
    if part.len() as u64 == length { Ok(part) } else { Err(damaged()) }
}

fn damaged() -> Error {
    Error::new("the film is damaged or cut short")
}

/// Why a film cannot be read on.
fn unread(error: io::Error) -> Error {
    match error.kind() {
        io::ErrorKind::UnexpectedEof | io::ErrorKind::InvalidData => damaged(),
        _ => Error::new(format!("the film cannot be read: {error}")),
    }
}
