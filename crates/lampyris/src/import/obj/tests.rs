use std::fmt::Write;

use proptest::collection::vec;
use proptest::prelude::*;

use super::*;

fn mesh(text: &str) -> MeshData {
    read("a.obj", text.as_bytes()).expect("the file is fine")
}

fn error(text: &str) -> String {
    read("a.obj", text.as_bytes()).expect_err("the file is broken").to_string()
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const CORNERS: [[f32; 3]; 3] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];

#[test]
fn a_triangle_is_read_however_its_lines_end() {
    for end in ["\n", "\r\n", "\r"] {
        for last in ["", end] {
            let text = format!("{TRIANGLE}f 1 2 3{last}").replace('\n', end);
            let expected = MeshData { positions: CORNERS.to_vec(), triangles: vec![[0, 1, 2]], ..MeshData::default() };
            assert_eq!(mesh(&text), expected, "{text:?}");
        }
    }
}

#[test]
fn every_form_of_a_corner_is_read() {
    let lists = format!("{TRIANGLE}vt 0.5 0.25\nvn 0 0 2\n");
    let plain = mesh(&format!("{lists}f 1 2 3"));
    assert_eq!((plain.uvs.len(), plain.normals.len()), (0, 0));
    let uvs = mesh(&format!("{lists}f 1/1 2/1 3/-1/"));
    assert_eq!((uvs.uvs, uvs.normals.len()), (vec![[0.5, 0.25]; 3], 0));
    let normals = mesh(&format!("{lists}f 1//1 2//-1 3//1"));
    assert_eq!((normals.uvs.len(), normals.normals), (0, vec![[0., 0., 1.]; 3]));
    let both = mesh(&format!("{lists}f 1/1/1 2/1/1 3/1/1"));
    assert_eq!((both.uvs.len(), both.normals.len()), (3, 3));
}

#[test]
fn corners_that_lack_what_others_have_get_a_default() {
    let mesh = mesh(&format!("{TRIANGLE}vt 0.5 0.5\nvn 1 0 0\nf 1/1/1 2//1 3"));
    assert_eq!(mesh.uvs, [[0.5, 0.5], [0., 0.], [0., 0.]]);
    assert_eq!(mesh.normals, [[1., 0., 0.], [1., 0., 0.], [0., 0., 1.]]);
}

#[test]
fn negative_indices_count_back_from_where_they_stand() {
    let text = format!("{TRIANGLE}f -3 -2 -1\nv 5 5 5\nf -4 -3 -1\n");
    let mesh = mesh(&text);
    assert_eq!(mesh.positions, [CORNERS[0], CORNERS[1], CORNERS[2], [5., 5., 5.]]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 3]]);
}

#[test]
fn faces_may_stand_before_their_vertices() {
    assert_eq!(mesh(&format!("f 1 2 3\n{TRIANGLE}")).triangles, [[0, 1, 2]]);
}

#[test]
fn corners_share_a_vertex_only_if_all_three_numbers_agree() {
    let text = format!("{TRIANGLE}v 1 1 0\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 2/1 4/1 3/2\n");
    let mesh = mesh(&text);
    assert_eq!(mesh.triangles, [[0, 1, 2], [1, 3, 4]]);
    assert_eq!(mesh.positions[2], mesh.positions[4]);
}

#[test]
fn all_that_faces_do_not_need_is_passed_over() {
    let text = "# C:\\models\\\nmtllib a.mtl\no thing\n\tv  0.0\t0 -0 1 0.5 0 # red\ng\ns off\nv +1. 0e5 .0\n\
                usemtl a b\nv 0 1E0 0\np 1\nl 1 2 3\nf 1 2\nf 1\nvp 0 0\nf\t1  2 3 \nend\n";
    assert_eq!(mesh(text).positions, CORNERS);
}

#[test]
fn a_backslash_continues_a_line() {
    assert_eq!(mesh(&format!("{TRIANGLE}f 1 \\\n2\\\r\n  3")).triangles, [[0, 1, 2]]);
    assert_eq!(mesh(&format!("{TRIANGLE}f 1 2 3 \\")).triangles, [[0, 1, 2]]);
}

#[test]
fn byte_order_marks_tell_the_encoding() {
    let text = format!("{TRIANGLE}g größer\nf 1 2 3\n");
    let utf16 = |bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(bytes).collect()
    };
    for bytes in [utf16(u16::to_le_bytes), utf16(u16::to_be_bytes), format!("\u{feff}{text}").into_bytes()] {
        assert_eq!(read("a.obj", &bytes), Ok(mesh(&text)));
    }
}

#[test]
fn names_need_not_be_utf_8() {
    let bytes = [b"g gr\xf6\xdfer\n".as_slice(), TRIANGLE.as_bytes(), b"f 1 2 3"].concat();
    assert_eq!(read("a.obj", &bytes), Ok(mesh(&format!("{TRIANGLE}f 1 2 3"))));
}

#[test]
fn triangles_that_name_a_vertex_twice_are_left_out() {
    assert_eq!(mesh(&format!("{TRIANGLE}f 1 1 2\nf 1 2 3\n")).triangles.len(), 1);
    assert!(error(&format!("{TRIANGLE}f 1 1 2")).contains("no faces"));
}

#[test]
fn errors_name_line_and_column() {
    let cases = [
        ("f 1 2 4", "a.obj:4:7: there is no vertex 4; the file has only 3 'v' lines"),
        (
            "f 1 2 0",
            "a.obj:4:7: there is no vertex 0; indices count from 1; negative ones count back from the last one read",
        ),
        ("f -4 2 3", "a.obj:4:3: there is no vertex -4; only 3 'v' lines stand before this one"),
        ("f 1/7 2 3", "a.obj:4:3: there is no texture coordinate 7; the file has no 'vt' lines"),
        ("f 1 2//1 3", "a.obj:4:5: there is no normal 1; the file has no 'vn' lines"),
        ("f 1 2 99999999999999999999", "a.obj:4:7: '99999999999999999999' is not a corner of a face"),
        ("f 1 2 3/1/1/1", "a.obj:4:7: '3/1/1/1' is not a corner of a face"),
        ("f 1 2 //1", "a.obj:4:7: '//1' is not a corner of a face"),
        ("f 1 2 drei", "a.obj:4:7: 'drei' is not a corner of a face"),
        ("f", "a.obj:4:1: this face has no corners"),
        ("v 1 2", "a.obj:4:5: 'v' needs 3 numbers, but has 2"),
        ("v 1 2 3,5", "a.obj:4:7: '3,5' is not a number"),
        ("v 1 nan 3", "a.obj:4:5: 'nan' is not a finite number"),
        ("v 1 2 \\\n 1e99", "a.obj:5:2: '1e99' is not a finite number"),
        ("vt", "a.obj:4:1: 'vt' needs 1 numbers, but has 0"),
    ];
    for (line, expected) in cases {
        let error = error(&format!("{TRIANGLE}{line}\nf 1 2 3"));
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn files_without_faces_are_refused_by_name() {
    for text in ["", TRIANGLE, "<html>not here</html>", "# v\n"] {
        assert!(error(text).starts_with("cannot read 'a.obj': it "), "{}", error(text));
    }
}

#[test]
fn texture_coordinates_and_normals_that_are_not_finite_are_mended() {
    let mesh = mesh(&format!("{TRIANGLE}vt nan 1\nvn nan nan nan\nf 1/1/1 2/1/1 3/1/1"));
    assert_eq!((mesh.uvs[0], mesh.normals[0]), ([0., 1.], [0., 0., 1.]));
}

/// A mesh in which each corner has its own vertex.
fn any_mesh() -> impl Strategy<Value = MeshData> {
    let corner = (prop::array::uniform3(-1e6f32..1e6), prop::array::uniform2(-2f32..2.), 0..3usize);
    let corners = vec(corner, 1..40).prop_map(|mut corners| {
        let whole = corners.len().next_multiple_of(3);
        corners.resize(whole, corners[0]);
        corners
    });
    (corners, any::<bool>(), any::<bool>()).prop_map(|(corners, with_uvs, with_normals)| {
        let normal = |axis: usize| std::array::from_fn(|i| if i == axis { 1.0 } else { 0.0 });
        MeshData {
            positions: corners.iter().map(|corner| corner.0).collect(),
            uvs: if with_uvs { corners.iter().map(|corner| corner.1).collect() } else { Vec::new() },
            normals: if with_normals { corners.iter().map(|corner| normal(corner.2)).collect() } else { Vec::new() },
            triangles: (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            ..MeshData::default()
        }
    })
}

fn encode(mesh: &MeshData) -> String {
    let mut text = String::new();
    let mut list = |keyword: &str, rows: Vec<&[f32]>| {
        for row in rows {
            let numbers: Vec<String> = row.iter().map(|x| format!("{x:e}")).collect();
            writeln!(text, "{keyword} {}", numbers.join(" ")).expect("strings take all");
        }
    };
    list("v", mesh.positions.iter().map(|row| row.as_slice()).collect());
    list("vt", mesh.uvs.iter().map(|row| row.as_slice()).collect());
    list("vn", mesh.normals.iter().map(|row| row.as_slice()).collect());
    for triangle in &mesh.triangles {
        let corner = |i: &u32| match (mesh.uvs.is_empty(), mesh.normals.is_empty(), i + 1) {
            (true, true, i) => format!("{i}"),
            (false, true, i) => format!("{i}/{i}"),
            (true, false, i) => format!("{i}//{i}"),
            (false, false, i) => format!("{i}/{i}/{i}"),
        };
        let corners: Vec<String> = triangle.iter().map(corner).collect();
        writeln!(text, "f {}", corners.join(" ")).expect("strings take all");
    }
    text
}

/// What `tobj` makes of a file.
fn second_opinion(text: &str) -> MeshData {
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ..Default::default() };
    let materials = |_: &std::path::Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, materials).expect("tobj reads it");
    let mesh = &models[0].mesh;
    MeshData {
        positions: mesh.positions.as_chunks().0.to_vec(),
        normals: mesh.normals.as_chunks().0.to_vec(),
        uvs: mesh.texcoords.as_chunks().0.to_vec(),
        triangles: mesh.indices.as_chunks().0.to_vec(),
        ..MeshData::default()
    }
}

proptest! {
    #[test]
    fn what_is_written_is_read_to_the_bit(mesh in any_mesh()) {
        prop_assert_eq!(read("a.obj", encode(&mesh).as_bytes()), Ok(mesh));
    }

    #[test]
    fn tobj_reads_the_same(mesh in any_mesh()) {
        prop_assert_eq!(second_opinion(&encode(&mesh)), mesh);
    }

    #[test]
    fn arbitrary_bytes_do_not_panic(bytes in vec(any::<u8>(), 0..300)) {
        let _ = read("a.obj", &bytes);
    }

    #[test]
    fn arbitrary_statements_do_not_panic(text in "((v|vt|vn|f|fo|g|#)([ \t][-0-9e./\\\\]{0,4}){0,5}\r?\n){0,30}") {
        let _ = read("a.obj", text.as_bytes());
    }

    #[test]
    fn damaged_files_do_not_panic(mesh in any_mesh(), end: prop::sample::Index, hits in vec(any::<(prop::sample::Index, u8)>(), 0..8)) {
        let mut bytes = encode(&mesh).into_bytes();
        for (index, byte) in hits {
            let at = index.index(bytes.len());
            bytes[at] = byte;
        }
        bytes.truncate(end.index(bytes.len()));
        let _ = read("a.obj", &bytes);
    }
}
