//! STL, triangles without anything else: binary and ASCII.

use std::collections::HashMap;

use super::mesh;
use super::ply::place;
use crate::error::{Error, Result};
use crate::geometry::MeshData;

/// Bytes before the triangles of a binary file, and of each triangle.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Reads the STL file `name` (used in messages alone), whose content is `bytes`.
///
/// Corners at the same place become one vertex, so that the mesh may be smoothed. The normals of the file are not
/// read: they are those of the triangles. A file is binary if its length is what its count of triangles asks for, even
/// if it begins with `solid`, as some programs write it.
///
/// # Errors
/// With line and column in ASCII files: what is no number. Without: a file that ends too early, no triangles,
/// positions that are not finite.
pub fn read(name: &str, bytes: &[u8]) -> Result<MeshData> {
    if bytes.is_empty() {
        return Err(mesh::unreadable(name, "it is empty"));
    }
    let count = bytes.get(80..HEADER).and_then(|count| count.try_into().ok()).map_or(0, u32::from_le_bytes) as usize;
    let is_text = bytes.trim_ascii_start().starts_with(b"solid");
    let fits = bytes.len() >= HEADER && (bytes.len() - HEADER) / TRIANGLE >= count;
    let exact = fits && bytes.len() == HEADER + count * TRIANGLE;
    let corners = match (exact, is_text) {
        (false, true) => ascii(name, bytes)?,
        _ if fits => binary(&bytes[HEADER..HEADER + count * TRIANGLE]),
        _ if bytes.len() < HEADER => return Err(mesh::unreadable(name, "it is too short for an STL file")),
        _ => {
            let reason =
                format!("its header promises {count} triangles, but only {} bytes follow", bytes.len() - HEADER);
            return Err(mesh::unreadable(name, reason).with_hint("is the file complete?"));
        }
    };
    mesh::finish(name, joined(&corners))
}

fn binary(bytes: &[u8]) -> Vec<[f32; 3]> {
    let triangles = bytes.as_chunks::<TRIANGLE>().0.iter();
    let number = |bytes: &[u8; 4]| f32::from_le_bytes(*bytes);
    let corners = triangles.flat_map(|triangle| {
        let (numbers, _) = triangle[12..48].as_chunks::<4>();
        [0, 3, 6].map(|at| [number(&numbers[at]), number(&numbers[at + 1]), number(&numbers[at + 2])])
    });
    corners.collect()
}

/// All `vertex` lines; the words around them say nothing more.
fn ascii(name: &str, bytes: &[u8]) -> Result<Vec<[f32; 3]>> {
    let mut corners = Vec::new();
    let mut words = words(bytes);
    while let Some((_, word)) = words.next() {
        if !word.eq_ignore_ascii_case(b"vertex") {
            continue;
        }
        let mut corner = [0.0; 3];
        for value in &mut corner {
            let Some((at, word)) = words.next() else {
                return Err(mesh::unreadable(name, "it ends within a vertex").with_hint("is the file complete?"));
            };
            *value = str::from_utf8(word).ok().and_then(|word| word.parse().ok()).ok_or_else(|| {
                let message = format!("'{}' is not a number", String::from_utf8_lossy(word));
                Error::new(message).with_place(place(name, bytes, at, word.len()))
            })?;
        }
        corners.push(corner);
    }
    Ok(corners)
}

/// The words of a text, each with where it begins.
fn words(bytes: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let mut at = 0;
    std::iter::from_fn(move || {
        at += bytes[at..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let start = at;
        at += bytes[at..].iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        (at > start).then(|| (start, &bytes[start..at]))
    })
}

/// Triangles of three corners each, equal corners joined.
fn joined(corners: &[[f32; 3]]) -> MeshData {
    let mut mesh = MeshData::default();
    let mut vertices: HashMap<[u32; 3], u32> = HashMap::new();
    for triangle in corners.as_chunks::<3>().0 {
        let triangle = triangle.map(|corner| {
            // Negative zero is the same place as zero.
            let key = corner.map(|x| (x + 0.0).to_bits());
            *vertices.entry(key).or_insert_with(|| {
                mesh.positions.push(corner);
                mesh.positions.len() as u32 - 1
            })
        });
        mesh.triangles.push(triangle);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const ASCII: &str = "solid two\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n\
        endloop endfacet\nfacet normal 0 0 1 outer loop vertex 1 0 0 VERTEX 1e0 1. -0 vertex 0 1 0 endloop endfacet\nendsolid";

    /// A binary file of these triangles, its header beginning with `title`.
    fn binary_file(title: &str, triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = title.as_bytes().to_vec();
        bytes.resize(80, b' ');
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; 12]);
            bytes.extend(triangle.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    const TWO: [[[f32; 3]; 3]; 2] =
        [[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], [[1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]];

    #[test]
    fn text_and_binary_hold_the_same_mesh() {
        let text = read("a", ASCII.as_bytes()).expect("it is fine");
        assert_eq!((text.triangles.len(), text.positions.len()), (2, 4));
        for title in ["two", "solid two"] {
            assert_eq!(read("a", &binary_file(title, &TWO)).expect("it is fine"), text, "{title}");
        }
    }

    #[test]
    fn faults_are_told() {
        let error = |bytes: &[u8]| read("a", bytes).expect_err("it is broken").to_string();
        assert!(error(b"").contains("it is empty"));
        assert!(error(b"not an stl").contains("too short"));
        assert!(error(b"solid\nendsolid").contains("it has no faces"));
        assert_eq!(error(b"solid\n vertex 1 x 0"), "a:2:11: 'x' is not a number");
        assert!(error(b"solid\n vertex 1 2").contains("ends within a vertex"));
        let mut promise = binary_file("two", &TWO);
        promise[80..84].copy_from_slice(&1_000_000_000u32.to_le_bytes());
        assert!(error(&promise).contains("promises 1000000000 triangles, but only 100 bytes follow"));
    }

    proptest! {
        #[test]
        fn damaged_files_never_panic(at in any::<prop::sample::Index>(), byte in any::<u8>(), cut in any::<prop::sample::Index>()) {
            for file in [ASCII.as_bytes().to_vec(), binary_file("two", &TWO)] {
                let mut file = file;
                let place = at.index(file.len());
                file[place] = byte;
                file.truncate(cut.index(file.len() + 1));
                let _ = read("a", &file);
            }
        }
    }
}
