//! PLY, the Stanford polygon format: ASCII and binary of either byte order.
//!
//! Read by our own reader and not by `ply-rs-bw`, with which the tests write their files: it refuses numbers such as
//! `.5` and `nan`, values spread over several lines and comments that are not UTF-8, and it takes the later of two
//! properties with the same name for the only one, so that everything after it is misread.

mod header;

pub(super) use header::place;
use header::{Element, Encoding, Header, Property, Type};

use super::mesh;
use crate::error::{Error, Result};
use crate::geometry::MeshData;
use crate::spectrum::srgb_to_linear;

/// Reads the PLY file `name` (used in messages alone), whose content is `bytes`.
///
/// Of the element `vertex` the properties `x y z`, `nx ny nz`, `u v` (or `s t`, `texture_u texture_v`) and
/// `red green blue` (or `r g b`) are read, of the element `face` the list `vertex_indices` or `vertex_index`; everything else is passed over. Polygons are cut
/// into triangles, and triangles that name a vertex twice are left out. All vertices are kept.
///
/// # Errors
/// With line and column in the header and in ASCII files: what cannot be read, indices out of range. Without: a file
/// that ends too early, no faces, positions that are not finite.
pub fn read(name: &str, bytes: &[u8]) -> Result<MeshData> {
    if bytes.is_empty() {
        return Err(mesh::unreadable(name, "it is empty"));
    }
    let (header, body) = Header::read(name, bytes)?;
    let mut body = Body { name, bytes, at: body, encoding: header.encoding };
    let mut mesh = MeshData::default();
    let mut faces = Faces::default();
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        body.check_room(element)?;
        match element.name.as_str() {
            "vertex" => read_vertices(&mut body, element, &mut mesh)?,
            "face" => faces.read(&mut body, element)?,
            _ => skip(&mut body, element)?,
        }
    }
    faces.cut_into(&mut mesh, &body)?;
    mesh::finish(name, mesh)
}

/// The values after the header, one after the other.
struct Body<'a> {
    name: &'a str,
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
}

impl<'a> Body<'a> {
    /// Refuses an element of which the header promises more than the rest of the file can hold, before anything is
    /// kept for it.
    fn check_room(&self, element: &Element) -> Result<()> {
        // A number in ASCII takes a digit and, but for the last one, a separator.
        let least = |property: &Property| match self.encoding {
            Encoding::Ascii => 2,
            _ => property.length.unwrap_or(property.value).size(),
        };
        let row: usize = element.properties.iter().map(least).sum();
        let left = self.bytes.len() - self.at;
        if element.count.saturating_mul(row) > left + 1 {
            let promise = format!("its header promises {} of '{}'", element.count, element.name);
            let reason = format!("{promise}, but only {left} bytes follow");
            return Err(mesh::unreadable(self.name, reason).with_hint("is the file complete?"));
        }
        Ok(())
    }

    /// The next value.
    fn number(&mut self, kind: Type) -> Result<f64> {
        if self.encoding == Encoding::Ascii {
            return self.word(kind);
        }
        Ok(match kind {
            Type::I8 => i8::from_ne_bytes(self.take()?).into(),
            Type::U8 => u8::from_ne_bytes(self.take()?).into(),
            Type::I16 => i16::from_ne_bytes(self.take()?).into(),
            Type::U16 => u16::from_ne_bytes(self.take()?).into(),
            Type::I32 => i32::from_ne_bytes(self.take()?).into(),
            Type::U32 => u32::from_ne_bytes(self.take()?).into(),
            Type::F32 => f32::from_ne_bytes(self.take()?).into(),
            Type::F64 => f64::from_ne_bytes(self.take()?),
        })
    }

    /// The next bytes of a binary file, in the order of this machine.
    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let Some(&(mut bytes)) = self.bytes[self.at..].first_chunk::<N>() else { return Err(self.ends_early()) };
        self.at += N;
        if (self.encoding == Encoding::BigEndian) == cfg!(target_endian = "little") {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// The next word of an ASCII file. Line ends mean nothing.
    fn word(&mut self, kind: Type) -> Result<f64> {
        let blank = self.bytes[self.at..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let start = self.at + blank;
        let length = self.bytes[start..].iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        if length == 0 {
            return Err(self.ends_early());
        }
        self.at = start + length;
        let word = &self.bytes[start..self.at];
        let number = str::from_utf8(word).ok().and_then(|word| match kind {
            Type::F32 => word.parse::<f32>().ok().map(f64::from),
            _ => word.parse().ok(),
        });
        number.ok_or_else(|| {
            let message = format!("'{}' is not a number", String::from_utf8_lossy(word));
            Error::new(message).with_place(place(self.name, self.bytes, start, length))
        })
    }

    /// The length of a list, which the rest of the file can hold.
    fn length(&mut self, property: &Property, kind: Type) -> Result<usize> {
        let before = self.at;
        let length = self.number(kind)?;
        if length < 0.0 || length.fract() != 0.0 {
            let message = format!("a list '{}' of {length} numbers", property.name);
            return Err(self.fault(before, message).with_hint("the values are not those that the header declares"));
        }
        let size = if self.encoding == Encoding::Ascii { 1 } else { property.value.size() };
        match length * size as f64 <= (self.bytes.len() - self.at) as f64 {
            true => Ok(length as usize),
            false => Err(self.ends_early()),
        }
    }

    /// Reads past one property.
    fn pass(&mut self, property: &Property) -> Result<()> {
        let length = match property.length {
            Some(kind) => self.length(property, kind)?,
            None => 1,
        };
        for _ in 0..length {
            self.number(property.value)?;
        }
        Ok(())
    }

    fn ends_early(&self) -> Error {
        mesh::unreadable(self.name, "it ends before all that its header promises").with_hint("is the file complete?")
    }

    /// An error about the value at or after `at`: with its line in a text.
    fn fault(&self, at: usize, message: impl std::fmt::Display) -> Error {
        if self.encoding != Encoding::Ascii {
            return mesh::unreadable(self.name, message);
        }
        let at = at.min(self.bytes.len());
        let start = at + self.bytes[at..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let length = self.bytes[start..].iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        Error::new(message.to_string()).with_place(place(self.name, self.bytes, start, length))
    }
}

/// The names of the vertex properties that we read, by where their value goes.
const WANTED: [&[&str]; 11] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx"],
    &["ny"],
    &["nz"],
    &["u", "s", "texture_u"],
    &["v", "t", "texture_v"],
    &["red", "r"],
    &["green", "g"],
    &["blue", "b"],
];

/// A channel of a colour in linear light: whole numbers are display values, as all programs write them; floats are
/// linear, as in Mitsuba.
fn color_channel(value: f64, kind: Type) -> f32 {
    match kind {
        Type::U8 => srgb_to_linear((value / 255.0) as f32),
        Type::U16 => srgb_to_linear((value / 65535.0) as f32),
        _ => value as f32,
    }
}

fn read_vertices(body: &mut Body, element: &Element, mesh: &mut MeshData) -> Result<()> {
    let slot = |property: &Property| match property.length {
        Some(_) => None,
        None => WANTED.iter().position(|names| names.contains(&property.name.as_str())),
    };
    let slots: Vec<Option<usize>> = element.properties.iter().map(slot).collect();
    let has = |wanted: std::ops::Range<usize>| wanted.into_iter().all(|slot| slots.contains(&Some(slot)));
    if !has(0..3) {
        return Err(mesh::unreadable(body.name, "its vertices lack one of the properties 'x', 'y' and 'z'"));
    }
    let (with_normals, with_uvs, with_colors) = (has(3..6), has(6..8), has(8..11));
    for _ in 0..element.count {
        let mut values = [0.0f32; 11];
        for (property, slot) in element.properties.iter().zip(&slots) {
            match *slot {
                Some(slot @ 8..) => values[slot] = color_channel(body.number(property.value)?, property.value),
                Some(slot) => values[slot] = body.number(property.value)? as f32,
                None => body.pass(property)?,
            }
        }
        let [x, y, z, nx, ny, nz, u, v, r, g, b] = values;
        mesh.positions.push([x, y, z]);
        if with_normals {
            mesh.normals.push([nx, ny, nz]);
        }
        if with_uvs {
            mesh.uvs.push([u, v]);
        }
        if with_colors {
            mesh.colors.push([r, g, b]);
        }
    }
    Ok(())
}

/// Polygons, kept until the vertices are known, which may come later in the file.
#[derive(Default)]
struct Faces {
    indices: Vec<u32>,
    /// The end of each polygon in `indices`, and where it stands in the file.
    polygons: Vec<(usize, usize)>,
}

impl Faces {
    fn read(&mut self, body: &mut Body, element: &Element) -> Result<()> {
        let is_wanted = |property: &Property| matches!(property.name.as_str(), "vertex_indices" | "vertex_index");
        for _ in 0..element.count {
            for property in &element.properties {
                match property.length {
                    Some(length) if is_wanted(property) => self.polygon(body, property, length)?,
                    _ => body.pass(property)?,
                }
            }
        }
        Ok(())
    }

    fn polygon(&mut self, body: &mut Body, property: &Property, length: Type) -> Result<()> {
        let (start, place) = (self.indices.len(), body.at);
        for _ in 0..body.length(property, length)? {
            let before = body.at;
            let index = body.number(property.value)?;
            let is_index = index >= 0.0 && index.fract() == 0.0 && index <= f64::from(u32::MAX);
            if !is_index {
                return Err(body.fault(before, format!("a face names vertex {index}")));
            }
            self.indices.push(index as u32);
        }
        // Points and lines take no room, however many there are.
        match self.indices.len() - start {
            ..3 => self.indices.truncate(start),
            _ => self.polygons.push((self.indices.len(), place)),
        }
        Ok(())
    }

    /// Adds the triangles of the polygons to the mesh.
    fn cut_into(&self, mesh: &mut MeshData, body: &Body) -> Result<()> {
        let mut start = 0;
        let (mut outline, mut cut) = (Vec::new(), Vec::new());
        for &(end, place) in &self.polygons {
            let polygon = &self.indices[start..end];
            start = end;
            outline.clear();
            for &index in polygon {
                let Some(&position) = mesh.positions.get(index as usize) else {
                    let count = mesh.positions.len();
                    let message = format!("a face names vertex {index}, but there are only {count} (numbered from 0)");
                    return Err(body.fault(place, message));
                };
                outline.push(position);
            }
            cut.clear();
            mesh::triangulate(&outline, &mut cut);
            mesh.triangles.extend(cut.iter().map(|triangle| triangle.map(|corner| polygon[corner as usize])));
        }
        Ok(())
    }
}

/// Reads past an element that we have no use for.
fn skip(body: &mut Body, element: &Element) -> Result<()> {
    (0..element.count).try_for_each(|_| element.properties.iter().try_for_each(|property| body.pass(property)))
}

#[cfg(test)]
mod tests;
