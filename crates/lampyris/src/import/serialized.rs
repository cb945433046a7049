//! Mitsuba's `.serialized` meshes: several compressed meshes in a file, with a table of where they start at its end.
//!
//! Versions 3 (Mitsuba 0.5) and 4 (since 0.6) are read. The flag for flat shading is not heeded, as in Mitsuba 3.

use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};

use flate2::read::ZlibDecoder;

use super::mesh::{finish, unreadable};
use crate::error::Result;
use crate::geometry::MeshData;

/// What each mesh starts with.
const MAGIC: u16 = 0x041c;

const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLORS: u32 = 0x0008;
const DOUBLE_PRECISION: u32 = 0x2000;

/// A mesh may unpack to this many bytes for each packed one, and [`UNPACKED_FLOOR`]: many times what real ones do,
/// a quarter of what a file made to exhaust memory can.
const UNPACKED_PER_PACKED: u64 = 256;
const UNPACKED_FLOOR: u64 = 1 << 20;

/// Values are taken from the decompressor in portions, so that what is kept grows with what really comes.
const PORTION: usize = 1 << 16;

/// Reads mesh number `index` (from 0) of the file `name` (used in messages alone) from `source`.
///
/// Without stored normals they stay empty. Vertex colours are passed over.
///
/// # Errors
/// If there is no such mesh, or the file is not what it says: too short, a wrong mark, damaged, more vertices
/// promised than it can hold.
pub fn read(name: &str, mut source: impl Read + Seek, index: u32) -> Result<MeshData> {
    let failed = |error: std::io::Error| unreadable(name, reason(&error));
    let range = locate(name, &mut source, index)?;
    source.seek(SeekFrom::Start(range.start)).map_err(failed)?;
    let packed = range.end.saturating_sub(range.start + 4);
    let [magic, version] = [read_u16(&mut source).map_err(failed)?, read_u16(&mut source).map_err(failed)?];
    check_mark(name, magic, version)?;
    let unpacked = BufReader::new(ZlibDecoder::new(source.take(packed)));
    let limit = UNPACKED_FLOOR + packed.saturating_mul(UNPACKED_PER_PACKED);
    let mesh = unpack(unpacked, version, limit).map_err(|fault| match fault {
        Fault::Io(error) => failed(error),
        Fault::Promise(reason) => unreadable(name, reason).with_hint("is the file complete?"),
    })?;
    finish(name, mesh)
}

/// The bytes of mesh number `index`, by the table at the end of the file.
fn locate(name: &str, source: &mut (impl Read + Seek), index: u32) -> Result<std::ops::Range<u64>> {
    let failed = |error: std::io::Error| unreadable(name, reason(&error));
    source.rewind().map_err(failed)?;
    let [magic, version] = [read_u16(source).map_err(failed)?, read_u16(source).map_err(failed)?];
    check_mark(name, magic, version)?;
    let size = source.seek(SeekFrom::End(0)).map_err(failed)?;
    source.seek(SeekFrom::Start(size.saturating_sub(4))).map_err(failed)?;
    let count = read_u32(source).map_err(failed)?;
    let entry = if version == 3 { 4 } else { 8 };
    let table = size.checked_sub(4 + u64::from(count) * entry).filter(|_| count > 0);
    let Some(table) = table else {
        let hint = "is the file complete?";
        return Err(unreadable(name, format!("its table of {count} meshes does not fit in it")).with_hint(hint));
    };
    if index >= count {
        return Err(
            unreadable(name, format!("it has no mesh {index}")).with_hint(format!("it has {count}, numbered from 0"))
        );
    }
    let mut offset = |index: u32| -> std::io::Result<u64> {
        source.seek(SeekFrom::Start(table + u64::from(index) * entry))?;
        if version == 3 { read_u32(source).map(u64::from) } else { read_u64(source) }
    };
    let start = offset(index).map_err(failed)?;
    let end = if index + 1 < count { offset(index + 1).map_err(failed)? } else { table };
    if start >= end || end > table {
        return Err(unreadable(name, format!("its table puts mesh {index} at byte {start}, where it cannot be")));
    }
    Ok(start..end)
}

fn check_mark(name: &str, magic: u16, version: u16) -> Result<()> {
    if magic != MAGIC {
        return Err(unreadable(name, "it is no serialized mesh of Mitsuba"));
    }
    if version != 3 && version != 4 {
        return Err(unreadable(name, format!("version {version} of serialized meshes is not known (only 3 and 4)")));
    }
    Ok(())
}

/// What can go wrong in the compressed part.
enum Fault {
    Io(std::io::Error),
    Promise(String),
}

impl From<std::io::Error> for Fault {
    fn from(error: std::io::Error) -> Fault {
        Fault::Io(error)
    }
}

/// Reads the compressed part of a mesh, at most `limit` bytes of it.
fn unpack(mut from: impl Read, version: u16, limit: u64) -> Result<MeshData, Fault> {
    let flags = read_u32(&mut from)?;
    if version == 4 {
        skip_name(&mut from)?;
    }
    let [vertices, triangles] = [read_u64(&mut from)?, read_u64(&mut from)?];
    let has = |flag| flags & flag != 0;
    let precision = if has(DOUBLE_PRECISION) { 8 } else { 4 };
    let numbers = [(true, 3), (has(HAS_NORMALS), 3), (has(HAS_UVS), 2), (has(HAS_COLORS), 3)];
    let per_vertex: u64 = numbers.iter().map(|&(present, count)| u64::from(present) * count * precision).sum();
    let promised = vertices.saturating_mul(per_vertex).saturating_add(triangles.saturating_mul(12));
    if promised > limit || vertices > u64::from(u32::MAX) {
        return Err(Fault::Promise(format!("it is too short for {vertices} vertices and {triangles} triangles")));
    }
    let (vertices, triangles) = (vertices as usize, triangles as usize);
    let mut mesh = MeshData { positions: read_floats(&mut from, vertices, precision)?, ..MeshData::default() };
    if has(HAS_NORMALS) {
        mesh.normals = read_floats(&mut from, vertices, precision)?;
    }
    if has(HAS_UVS) {
        mesh.uvs = read_floats(&mut from, vertices, precision)?;
    }
    if has(HAS_COLORS) {
        read_floats::<3>(&mut from, vertices, precision)?;
    }
    mesh.triangles = read_rows(&mut from, triangles, |bytes: [u8; 4]| u32::from_le_bytes(bytes))?;
    Ok(mesh)
}

/// Reads past the name of a mesh. It counts as nothing against the limit, for nothing of it is kept.
fn skip_name(from: &mut impl Read) -> std::io::Result<()> {
    let mut byte = [1];
    while byte != [0] {
        from.read_exact(&mut byte)?;
    }
    Ok(())
}

/// `count` rows of `N` numbers of 4 or 8 bytes.
fn read_floats<const N: usize>(from: &mut impl Read, count: usize, precision: u64) -> std::io::Result<Vec<[f32; N]>> {
    match precision {
        8 => read_rows(from, count, |bytes: [u8; 8]| f64::from_le_bytes(bytes) as f32),
        _ => read_rows(from, count, |bytes: [u8; 4]| f32::from_le_bytes(bytes)),
    }
}

/// `count` rows of `N` values of `SIZE` bytes.
fn read_rows<T: Copy + Default, const N: usize, const SIZE: usize>(
    from: &mut impl Read,
    count: usize,
    value: impl Fn([u8; SIZE]) -> T,
) -> std::io::Result<Vec<[T; N]>> {
    let mut rows = Vec::new();
    let mut buffer = vec![0; PORTION.min(count) * N * SIZE];
    while rows.len() < count {
        let portion = PORTION.min(count - rows.len());
        let bytes = &mut buffer[..portion * N * SIZE];
        from.read_exact(bytes)?;
        let mut values = bytes.as_chunks::<SIZE>().0.iter().map(|&bytes| value(bytes));
        rows.extend((0..portion).map(|_| [T::default(); N].map(|zero| values.next().unwrap_or(zero))));
    }
    Ok(rows)
}

fn read_u16(from: &mut impl Read) -> std::io::Result<u16> {
    read_bytes(from).map(u16::from_le_bytes)
}

fn read_u32(from: &mut impl Read) -> std::io::Result<u32> {
    read_bytes(from).map(u32::from_le_bytes)
}

fn read_u64(from: &mut impl Read) -> std::io::Result<u64> {
    read_bytes(from).map(u64::from_le_bytes)
}

fn read_bytes<const N: usize>(from: &mut impl Read) -> std::io::Result<[u8; N]> {
    let mut bytes = [0; N];
    from.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// What an error in reading means to the user.
fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::UnexpectedEof => "it ends too early".into(),
        ErrorKind::InvalidInput | ErrorKind::InvalidData => "it is damaged: its meshes do not unpack".into(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests;
