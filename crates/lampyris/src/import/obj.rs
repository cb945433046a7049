//! Wavefront OBJ.
//!
//! Read by our own tokenizer and not by `tobj`, which the tests use as a second opinion: its errors name no line,
//! it stops at names that are not UTF-8, and it fans concave polygons, which then overlap.
//!
//! As a mesh, faces of all groups, objects and materials become one; as a scene ([`super::obj_scene`]) the materials
//! stay apart. Smoothing groups of meshes, curves, surfaces, points, lines,
//! vertex colours and statements of later dialects are passed over.

use std::borrow::Cow;
use std::cell::OnceCell;
use std::collections::HashMap;
use std::path::Path;

use super::mesh;
use super::source::Lines;
use crate::error::{Error, Place, Result};
use crate::geometry::MeshData;

/// Reads the OBJ file `name` (used in messages alone), whose content is `bytes`.
///
/// Polygons are cut into triangles, triangles that name a vertex twice are left out, and corners with the same
/// position, texture coordinate and normal share a vertex; vertices that no face uses are dropped. Without `vn` the
/// normals stay empty; a corner without one in a file with some gets a smooth one. A corner without texture
/// coordinates in a file with some gets (0, 0).
///
/// # Errors
/// With line and column: numbers that are none, too few of them, and indices out of range. Without: no faces.
pub fn read(name: &str, bytes: &[u8]) -> Result<MeshData> {
    if bytes.is_empty() {
        return Err(mesh::unreadable(name, "it is empty"));
    }
    let text = decode(bytes);
    let source = Source::new(name, &text);
    let lists = source.lists()?;
    let mut parts = source.faces(&lists, false)?.parts;
    mesh::finish(name, parts.pop().map(|part| part.mesh).unwrap_or_default())
}

/// The faces of one material.
#[derive(Debug, Default)]
pub(super) struct Part {
    /// What `usemtl` named; empty before the first.
    pub material: String,
    pub mesh: MeshData,
}

/// An OBJ file, its faces apart by their materials.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub parts: Vec<Part>,
    /// What stands after each `mtllib`, and where.
    pub libraries: Vec<(String, Place)>,
}

/// Reads the OBJ file `name` as [`read`] does, but its materials apart. Parts under a smoothing group that have no
/// normals get smooth ones.
pub(super) fn read_parts(name: &str, bytes: &[u8]) -> Result<Parts> {
    if bytes.is_empty() {
        return Err(mesh::unreadable(name, "it is empty"));
    }
    let text = decode(bytes);
    let source = Source::new(name, &text);
    let lists = source.lists()?;
    let mut found = source.faces(&lists, true)?;
    let (whole, points): (Vec<Part>, _) = found
        .parts
        .into_iter()
        .partition(|part| part.mesh.triangles.iter().any(|[a, b, c]| a != b && b != c && c != a));
    let finished = |part: Part| Ok(Part { mesh: mesh::finish(name, part.mesh)?, ..part });
    found.parts = match whole.is_empty() {
        // Says that there are no faces.
        true => points.into_iter().take(1).map(finished).collect::<Result<_>>()?,
        false => whole.into_iter().map(finished).collect::<Result<_>>()?,
    };
    match found.parts.is_empty() {
        true => mesh::finish(name, MeshData::default()).map(|_| Parts::default()),
        false => Ok(found),
    }
}

/// The text of a file by its byte order mark, or else UTF-8; what is neither becomes U+FFFD, which harms only names
/// and comments. Line ends of old Macs become ours, and so do lines count.
pub(super) fn decode(bytes: &[u8]) -> Cow<'_, str> {
    let utf16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.as_chunks().0.iter().map(|&pair| unit(pair)).collect();
        Cow::Owned(String::from_utf16_lossy(&units))
    };
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] => String::from_utf8_lossy(rest),
        _ => String::from_utf8_lossy(bytes),
    };
    if text.contains('\r') && !text.contains('\n') { Cow::Owned(text.replace('\r', "\n")) } else { text }
}

/// The lists that faces point into.
#[derive(Default)]
struct Lists {
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
}

/// How many positions, texture coordinates and normals stand before a line, for indices counted backwards.
type Counts = [usize; 3];

/// What a corner of a face points at, in the lists of positions, texture coordinates and normals.
type Corner = [Option<u32>; 3];

/// What the three numbers of a corner are called, in words and as statements.
const KINDS: [(&str, &str); 3] = [("vertex", "v"), ("texture coordinate", "vt"), ("normal", "vn")];

pub(super) struct Source<'a> {
    name: &'a str,
    text: &'a str,
    /// Counted when a place is asked for.
    lines: OnceCell<Lines>,
}

impl<'a> Source<'a> {
    /// `text`, the content of the file `name`.
    pub(super) fn new(name: &'a str, text: &'a str) -> Source<'a> {
        Source { name, text, lines: OnceCell::new() }
    }

    /// Calls `visit` with the words of each statement, comments and continued lines resolved.
    pub(super) fn statements(&self, mut visit: impl FnMut(&[&'a str]) -> Result<()>) -> Result<()> {
        let mut words: Vec<&str> = Vec::new();
        for line in self.text.split('\n') {
            let before = words.len();
            words.extend(line.split_ascii_whitespace());
            if let Some(comment) = words[before..].iter().position(|word| word.starts_with('#')) {
                words.truncate(before + comment);
            } else if let Some(start) = words.last().and_then(|word| word.strip_suffix('\\')) {
                words.pop();
                words.extend((!start.is_empty()).then_some(start));
                continue;
            }
            if !words.is_empty() {
                visit(&words)?;
                words.clear();
            }
        }
        if words.is_empty() { Ok(()) } else { visit(&words) }
    }

    /// The first reading: all lists, so that faces may stand before their vertices.
    fn lists(&self) -> Result<Lists> {
        let mut lists = Lists::default();
        self.statements(|words| {
            match words[0] {
                "v" => lists.positions.push(self.position(words)?),
                "vt" => lists.uvs.push(self.numbers(words, 1)?),
                "vn" => lists.normals.push(self.numbers(words, 3)?),
                _ => {}
            }
            Ok(())
        })?;
        Ok(lists)
    }

    /// The second reading: the faces, of each material apart if `split`.
    fn faces(&self, lists: &Lists, split: bool) -> Result<Parts> {
        let mut counts = Counts::default();
        let mut meshes = vec![(String::new(), Collector::new(lists))];
        let mut by_name = HashMap::from([(String::new(), 0)]);
        let mut current = 0;
        let mut smoothing = false;
        let mut libraries = Vec::new();
        let mut corners: Vec<Corner> = Vec::new();
        self.statements(|words| {
            match words[0] {
                "v" => counts[0] += 1,
                "vt" => counts[1] += 1,
                "vn" => counts[2] += 1,
                "usemtl" if split => {
                    let name = words[1..].join(" ");
                    current = *by_name.entry(name.clone()).or_insert_with(|| {
                        meshes.push((name, Collector::new(lists)));
                        meshes.len() - 1
                    });
                }
                "mtllib" if words.len() > 1 => libraries.push((words[1..].join(" "), self.place(words[1]))),
                "s" => smoothing = !matches!(words.get(1), None | Some(&"off" | &"0")),
                // `fo` is what version 2 of the format called a face.
                "f" | "fo" => {
                    if words.len() == 1 {
                        let hint = "a face needs three corners or more, such as 'f 1 2 3'";
                        return Err(self.error(words[0], "this face has no corners").with_hint(hint));
                    }
                    corners.clear();
                    for word in &words[1..] {
                        corners.push(self.corner(word, counts, lists)?);
                    }
                    let mesh = &mut meshes[current].1;
                    mesh.smooth |= split && smoothing;
                    mesh.add(&corners);
                }
                _ => {}
            }
            Ok(())
        })?;
        let parts = meshes.into_iter().map(|(material, mesh)| Part { material, mesh: mesh.into_mesh() }).collect();
        Ok(Parts { parts, libraries })
    }

    /// The numbers of a `v`: finite, whereas `vt` and `vn` that are not can be mended.
    fn position(&self, words: &[&str]) -> Result<[f32; 3]> {
        let position: [f32; 3] = self.numbers(words, 3)?;
        match position.iter().position(|x| !x.is_finite()) {
            Some(index) => Err(self.error(words[1 + index], format!("'{}' is not a finite number", words[1 + index]))),
            None => Ok(position),
        }
    }

    /// The first `N` numbers after the keyword, of which `needed` must be there; the others are 0 then.
    fn numbers<const N: usize>(&self, words: &[&str], needed: usize) -> Result<[f32; N]> {
        let mut numbers = [0.0; N];
        for (number, word) in numbers.iter_mut().zip(&words[1..]) {
            *number = word.parse().map_err(|_| self.error(word, format!("'{word}' is not a number")))?;
        }
        let present = words.len() - 1;
        if present < needed {
            let message = format!("'{}' needs {needed} numbers, but has {present}", words[0]);
            return Err(self.error(words[words.len() - 1], message));
        }
        Ok(numbers)
    }

    /// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &str, counts: Counts, lists: &Lists) -> Result<Corner> {
        let sizes = [lists.positions.len(), lists.uvs.len(), lists.normals.len()];
        let mut corner = Corner::default();
        if word.starts_with('/') || word.matches('/').count() > 2 {
            return Err(self.no_corner(word));
        }
        for (kind, part) in word.split('/').enumerate() {
            if !part.is_empty() {
                let index = part.parse::<i64>().map_err(|_| self.no_corner(word))?;
                let resolved = resolve(index, counts[kind], sizes[kind]);
                corner[kind] = Some(resolved.ok_or_else(|| self.out_of_range(word, kind, index, counts, sizes))?);
            }
        }
        Ok(corner)
    }

    fn no_corner(&self, word: &str) -> Error {
        self.error(word, format!("'{word}' is not a corner of a face"))
            .with_hint("corners are written v, v/vt, v//vn or v/vt/vn with whole numbers")
    }

    fn out_of_range(&self, word: &str, kind: usize, index: i64, counts: Counts, sizes: Counts) -> Error {
        let (what, keyword) = KINDS[kind];
        let hint = match (index, sizes[kind]) {
            (0, _) => "indices count from 1; negative ones count back from the last one read".to_string(),
            (_, 0) => format!("the file has no '{keyword}' lines"),
            (..0, _) => format!("only {} '{keyword}' lines stand before this one", counts[kind]),
            (_, size) => format!("the file has only {size} '{keyword}' lines"),
        };
        self.error(word, format!("there is no {what} {index}")).with_hint(hint)
    }

    /// An error at `word`, which is a part of the text.
    pub(super) fn error(&self, word: &str, message: impl Into<String>) -> Error {
        Error::new(message).with_place(self.place(word))
    }

    /// Where `word` stands, which is a part of the text.
    pub(super) fn place(&self, word: &str) -> Place {
        let start = word.as_ptr() as usize - self.text.as_ptr() as usize;
        let lines = self.lines.get_or_init(|| Lines::of(self.text));
        lines.place(Path::new(self.name), self.text, start..start + word.len())
    }
}

/// The index from 0, if it exists: 1 is the first of `size`, -1 the last of the `count` read so far.
fn resolve(index: i64, count: usize, size: usize) -> Option<u32> {
    let resolved = match index {
        0 => return None,
        1.. => usize::try_from(index - 1).ok()?,
        _ => count.checked_sub(usize::try_from(index.unsigned_abs()).ok()?)?,
    };
    u32::try_from(resolved).ok().filter(|_| resolved < size)
}

/// Corners become vertices, one for each combination, and polygons triangles.
struct Collector<'a> {
    lists: &'a Lists,
    mesh: MeshData,
    vertices: HashMap<Corner, u32>,
    outline: Vec<[f32; 3]>,
    cut: Vec<[u32; 3]>,
    /// Whether some face asked for smooth normals.
    smooth: bool,
}

impl<'a> Collector<'a> {
    fn new(lists: &'a Lists) -> Collector<'a> {
        let mesh = MeshData::default();
        Collector { lists, mesh, vertices: HashMap::new(), outline: Vec::new(), cut: Vec::new(), smooth: false }
    }

    fn add(&mut self, corners: &[Corner]) {
        let positions = &self.lists.positions;
        self.outline.clear();
        self.outline.extend(corners.iter().filter_map(|corner| Some(positions[corner[0]? as usize])));
        self.cut.clear();
        mesh::triangulate(&self.outline, &mut self.cut);
        for i in 0..self.cut.len() {
            let triangle = self.cut[i].map(|corner| self.vertex(corners[corner as usize]));
            self.mesh.triangles.push(triangle);
        }
    }

    /// The mesh, without lists that no corner pointed into.
    fn into_mesh(mut self) -> MeshData {
        if self.vertices.keys().all(|corner| corner[1].is_none()) {
            self.mesh.uvs.clear();
        }
        if self.vertices.keys().all(|corner| corner[2].is_none()) {
            self.mesh.normals.clear();
        }
        if self.smooth && self.mesh.normals.is_empty() && self.mesh.fault().is_none() {
            self.mesh.compute_normals();
        }
        self.mesh
    }

    /// The number of the vertex that a corner is, new if there is none like it.
    fn vertex(&mut self, corner: Corner) -> u32 {
        let Lists { positions, uvs, normals } = self.lists;
        let mesh = &mut self.mesh;
        *self.vertices.entry(corner).or_insert_with(|| {
            let [position, uv, normal] = corner.map(|index| index.map(|index| index as usize));
            mesh.positions.push(position.map_or([0.0; 3], |index| positions[index]));
            if !uvs.is_empty() {
                mesh.uvs.push(uv.map_or([0.0; 2], |index| uvs[index]));
            }
            if !normals.is_empty() {
                mesh.normals.push(normal.map_or([0.0; 3], |index| normals[index]));
            }
            mesh.positions.len() as u32 - 1
        })
    }
}

#[cfg(test)]
mod tests;
