use std::io::{Cursor, Write};

use flate2::Compression;
use flate2::write::ZlibEncoder;
use proptest::collection::vec;
use proptest::prelude::*;

use super::*;

fn open(bytes: &[u8], index: u32) -> Result<MeshData> {
    read("a.serialized", Cursor::new(bytes), index)
}

fn error(bytes: &[u8], index: u32) -> String {
    open(bytes, index).expect_err("the file is broken").to_string()
}

fn triangle() -> MeshData {
    let positions = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.5]];
    MeshData { positions, triangles: vec![[0, 1, 2]], ..MeshData::default() }
}

#[derive(Clone, Copy, Debug)]
struct Layout {
    version: u16,
    double: bool,
    colors: bool,
}

const PLAIN: Layout = Layout { version: 4, double: false, colors: false };

/// What is compressed of a mesh, with the counts of vertices and triangles that it claims.
fn content(mesh: &MeshData, layout: Layout, counts: [u64; 2]) -> Vec<u8> {
    let flag = |present: bool, flag: u32| if present { flag } else { 0 };
    let flags = flag(!mesh.normals.is_empty(), HAS_NORMALS)
        | flag(!mesh.uvs.is_empty(), HAS_UVS)
        | flag(layout.colors, HAS_COLORS)
        | if layout.double { DOUBLE_PRECISION } else { 0x1000 };
    let mut bytes = flags.to_le_bytes().to_vec();
    if layout.version == 4 {
        bytes.extend(b"a mesh\0");
    }
    bytes.extend(counts.iter().flat_map(|count| count.to_le_bytes()));
    let colors = vec![[0.5f32; 3]; if layout.colors { mesh.positions.len() } else { 0 }];
    let lists =
        [mesh.positions.as_flattened(), mesh.normals.as_flattened(), mesh.uvs.as_flattened(), colors.as_flattened()];
    for &number in lists.into_iter().flatten() {
        match layout.double {
            true => bytes.extend(f64::from(number).to_le_bytes()),
            false => bytes.extend(number.to_le_bytes()),
        }
    }
    bytes.extend(mesh.triangles.as_flattened().iter().flat_map(|index| index.to_le_bytes()));
    bytes
}

/// A file of these contents.
fn file(version: u16, contents: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut table = Vec::new();
    for content in contents {
        match version {
            3 => table.extend((bytes.len() as u32).to_le_bytes()),
            _ => table.extend((bytes.len() as u64).to_le_bytes()),
        }
        bytes.extend(MAGIC.to_le_bytes());
        bytes.extend(version.to_le_bytes());
        let mut encoder = ZlibEncoder::new(&mut bytes, Compression::default());
        encoder.write_all(content).expect("memory takes all");
        encoder.finish().expect("memory takes all");
    }
    bytes.extend(table);
    bytes.extend((contents.len() as u32).to_le_bytes());
    bytes
}

fn encode(meshes: &[MeshData], layout: Layout) -> Vec<u8> {
    let counts = |mesh: &MeshData| [mesh.positions.len() as u64, mesh.triangles.len() as u64];
    let contents: Vec<_> = meshes.iter().map(|mesh| content(mesh, layout, counts(mesh))).collect();
    file(layout.version, &contents)
}

#[test]
fn a_mesh_that_is_not_there_is_refused_with_how_many_there_are() {
    let bytes = encode(&[triangle(), triangle()], PLAIN);
    assert_eq!(error(&bytes, 2), "cannot read 'a.serialized': it has no mesh 2; it has 2, numbered from 0");
}

#[test]
fn other_files_are_refused() {
    assert!(error(b"", 0).contains("ends too early"));
    assert!(error(b"ply\nformat ascii 1.0\n", 0).contains("no serialized mesh of Mitsuba"));
    let mut bytes = encode(&[triangle()], PLAIN);
    bytes[2] = 5;
    assert!(error(&bytes, 0).contains("version 5"));
}

#[test]
fn counts_that_the_file_cannot_hold_are_refused_before_they_are_believed() {
    for counts in [[u64::MAX, 1], [1, u64::MAX], [u64::MAX, u64::MAX], [1 << 32, 0], [3, 1 << 40]] {
        let bytes = file(4, &[content(&triangle(), PLAIN, counts)]);
        assert!(error(&bytes, 0).contains("too short for"), "{}", error(&bytes, 0));
    }
    let bytes = file(4, &[content(&triangle(), PLAIN, [3, 2])]);
    assert!(error(&bytes, 0).contains("ends too early"));
}

#[test]
fn what_unpacks_to_more_than_any_mesh_does_is_refused() {
    let zeros = MeshData { positions: vec![[0.; 3]; 1 << 20], ..triangle() };
    let bytes = encode(&[zeros], PLAIN);
    assert!(bytes.len() < 20_000);
    assert!(error(&bytes, 0).contains("too short for 1048576 vertices"));
}

#[test]
fn a_table_that_points_elsewhere_is_refused() {
    let whole = encode(&[triangle(), triangle()], PLAIN);
    let table = whole.len() - 4 - 16;
    for (entry, offset) in [(0, u64::MAX), (0, table as u64), (1, 0), (1, u64::MAX)] {
        let mut bytes = whole.clone();
        bytes[table + 8 * entry..][..8].copy_from_slice(&offset.to_le_bytes());
        assert!(error(&bytes, 0).contains("its table puts mesh 0"), "{entry} {offset}");
    }
    for count in [0, 40, u32::MAX] {
        let mut bytes = whole.clone();
        bytes[table + 16..].copy_from_slice(&count.to_le_bytes());
        assert!(error(&bytes, 0).contains("does not fit"), "{count}");
    }
}

#[test]
fn damaged_data_and_indices_out_of_range_are_refused() {
    let mut bytes = encode(&[triangle()], PLAIN);
    bytes[5] ^= 0xff;
    assert!(error(&bytes, 0).contains("damaged"));
    let far = MeshData { triangles: vec![[0, 1, 3]], ..triangle() };
    assert!(error(&encode(&[far], PLAIN), 0).contains("triangle 0 names vertex 3"));
    let none = MeshData { triangles: Vec::new(), ..triangle() };
    assert!(error(&encode(&[none], PLAIN), 0).contains("no faces"));
}

fn any_mesh() -> impl Strategy<Value = MeshData> {
    (3..30usize, any::<bool>(), any::<bool>()).prop_flat_map(|(count, with_normals, with_uvs)| {
        let positions = vec(prop::array::uniform3(-1e6f32..1e6), count);
        let uvs = vec(prop::array::uniform2(-2f32..2.), if with_uvs { count } else { 0 });
        let normals = vec(Just([0., 0., 1.]), if with_normals { count } else { 0 });
        let indices = (0..count as u32 - 2).prop_map(|first| [first, first + 2, first + 1]);
        (positions, normals, uvs, vec(indices, 1..30)).prop_map(|(positions, normals, uvs, triangles)| MeshData {
            positions,
            normals,
            uvs,
            triangles,
            ..MeshData::default()
        })
    })
}

fn any_layout() -> impl Strategy<Value = Layout> {
    (3..=4u16, any::<bool>(), any::<bool>()).prop_map(|(version, double, colors)| Layout { version, double, colors })
}

proptest! {
    #[test]
    fn what_is_written_is_read_to_the_bit(meshes in vec(any_mesh(), 1..4), layout in any_layout()) {
        let bytes = encode(&meshes, layout);
        for (index, mesh) in meshes.into_iter().enumerate() {
            prop_assert_eq!(open(&bytes, index as u32), Ok(mesh));
        }
    }

    #[test]
    fn truncated_files_are_refused(mesh in any_mesh(), layout in any_layout(), end: prop::sample::Index) {
        let bytes = encode(&[mesh], layout);
        prop_assert!(open(&bytes[..end.index(bytes.len())], 0).is_err());
    }

    #[test]
    fn arbitrary_bytes_do_not_panic(bytes in vec(any::<u8>(), 0..300), version in 3..=4u16) {
        let _ = open(&bytes, 0);
        let _ = open(&file(version, std::slice::from_ref(&bytes)), 0);
        let _ = open(&[&MAGIC.to_le_bytes()[..], &version.to_le_bytes(), &bytes].concat(), 0);
    }

    #[test]
    fn damaged_files_do_not_panic(mesh in any_mesh(), layout in any_layout(), hits in vec(any::<(prop::sample::Index, u8)>(), 1..8)) {
        let mut bytes = encode(&[mesh], layout);
        for (index, byte) in hits {
            let at = index.index(bytes.len());
            bytes[at] = byte;
        }
        let _ = open(&bytes, 0);
    }
}
