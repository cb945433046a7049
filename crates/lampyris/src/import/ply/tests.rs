use ply_rs_bw::ply::{
    Addable, DefaultElement, ElementDef, Encoding as Written, Ply, Property as Value, PropertyDef, PropertyType,
    ScalarType,
};
use ply_rs_bw::writer::Writer;
use proptest::collection::vec;
use proptest::prelude::*;

use super::*;

fn error(bytes: &[u8]) -> String {
    read("a.ply", bytes).expect_err("the file is broken").to_string()
}

/// A file with these lines after the first.
fn ascii(lines: &str) -> Vec<u8> {
    format!("ply\nformat ascii 1.0\n{lines}").into_bytes()
}

const VERTICES: &str = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
const FACE: &str = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const POSITIONS: &str = "0 0 0\n1 0 0\n0 1 0\n";
const CORNERS: [[f32; 3]; 3] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];

fn triangle() -> MeshData {
    MeshData { positions: CORNERS.to_vec(), triangles: vec![[0, 1, 2]], ..MeshData::default() }
}

const ENCODINGS: [Written; 3] = [Written::Ascii, Written::BinaryLittleEndian, Written::BinaryBigEndian];

/// A mesh as another library writes it, with an element and properties before, between and behind that mean nothing
/// to us, and vertex indices of the given type.
fn encode(mesh: &MeshData, encoding: Written, index: &ScalarType) -> Vec<u8> {
    let mut ply = Ply::<DefaultElement>::new();
    ply.header.encoding = encoding;
    ply.header.comments.push("vertex 7".into());
    let list = |of| PropertyType::List(ScalarType::UChar, of);
    let mut define = |name: &str, properties: Vec<(&str, PropertyType)>| {
        let mut element = ElementDef::new(name.into());
        for (name, kind) in properties {
            element.properties.add(PropertyDef::new(name.into(), kind));
        }
        ply.header.elements.add(element);
    };
    let scalar = |names: &[&'static str]| -> Vec<(&'static str, PropertyType)> {
        names.iter().map(|&name| (name, PropertyType::Scalar(ScalarType::Float))).collect()
    };
    define("camera", vec![("zoom", PropertyType::Scalar(ScalarType::Double)), ("lens", list(ScalarType::Short))]);
    let mut vertex = scalar(&["z"]);
    vertex.push(("red", PropertyType::Scalar(ScalarType::UChar)));
    vertex.extend(scalar(&["x", "y"]));
    vertex.push(("bones", list(ScalarType::UShort)));
    if !mesh.normals.is_empty() {
        vertex.extend(scalar(&["nx", "ny", "nz"]));
    }
    if !mesh.uvs.is_empty() {
        vertex.extend(scalar(&["s", "t"]));
    }
    define("vertex", vertex);
    define("face", vec![("quality", PropertyType::Scalar(ScalarType::Char)), ("vertex_index", list(index.clone()))]);

    let element = |values: Vec<(&str, Value)>| -> DefaultElement {
        values.into_iter().map(|(name, value)| (name.to_string(), value)).collect()
    };
    let camera = element(vec![("zoom", Value::Double(1.5)), ("lens", Value::ListShort(vec![-1, 7]))]);
    let vertices = (0..mesh.positions.len()).map(|i| {
        let [x, y, z] = mesh.positions[i].map(Value::Float);
        let mut values = vec![("x", x), ("y", y), ("z", z), ("red", Value::UChar(200))];
        values.push(("bones", Value::ListUShort(vec![9; i % 3])));
        if let Some(normal) = mesh.normals.get(i) {
            values.extend(["nx", "ny", "nz"].into_iter().zip(normal.map(Value::Float)));
        }
        if let Some(uv) = mesh.uvs.get(i) {
            values.extend(["s", "t"].into_iter().zip(uv.map(Value::Float)));
        }
        element(values)
    });
    let faces = mesh.triangles.iter().map(|triangle| {
        let list = match index {
            ScalarType::UChar => Value::ListUChar(triangle.map(|i| i as u8).to_vec()),
            ScalarType::Short => Value::ListShort(triangle.map(|i| i as i16).to_vec()),
            ScalarType::UInt => Value::ListUInt(triangle.to_vec()),
            _ => Value::ListInt(triangle.map(|i| i as i32).to_vec()),
        };
        element(vec![("quality", Value::Char(-3)), ("vertex_index", list)])
    });
    ply.payload.insert("camera".into(), vec![camera]);
    ply.payload.insert("vertex".into(), vertices.collect());
    ply.payload.insert("face".into(), faces.collect());
    let mut bytes = Vec::new();
    Writer::new().write_ply(&mut bytes, &mut ply).expect("memory takes all");
    bytes
}

#[test]
fn ascii_is_read_however_its_lines_end_and_its_values_are_laid_out() {
    let text = format!("ply\nformat ascii 1.0\ncomment a\nobj_info b\n{VERTICES}{FACE}{POSITIONS}3 0 1 2");
    for end in ["\n", "\r\n", "\r"] {
        assert_eq!(read("a.ply", text.replace('\n', end).as_bytes()), Ok(triangle()), "{end:?}");
    }
    let loose = ascii(&format!("{VERTICES}{FACE} .0 +0 0.\n1 0\n0 0 1e0 0 3 0 1 2 and so on"));
    assert_eq!(read("a.ply", &loose), Ok(triangle()));
}

#[test]
fn a_binary_file_may_begin_with_a_byte_that_looks_like_a_line_end() {
    let header = format!("ply\nformat binary_little_endian 1.0\n{VERTICES}{FACE}");
    let x = f32::from_le_bytes(*b"\n\r\n?");
    let mut bytes = header.into_bytes();
    for number in [x, 0., 0., 1., 0., 0., 0., 1., 0.] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.push(3);
    for index in 0..3i32 {
        bytes.extend(index.to_le_bytes());
    }
    assert_eq!(read("a.ply", &bytes).expect("it is fine").positions[0], [x, 0., 0.]);
}

#[test]
fn comments_need_not_be_utf_8() {
    let bytes =
        [&ascii("comment ")[..], b"gr\xf6\xdfer\n", &ascii(&format!("{VERTICES}{FACE}{POSITIONS}3 0 1 2"))[21..]];
    assert_eq!(read("a.ply", &bytes.concat()), Ok(triangle()));
}

#[test]
fn texture_coordinates_go_by_three_pairs_of_names() {
    for [u, v] in [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]] {
        let text =
            format!("{VERTICES}property float {u}\nproperty double {v}\n{FACE}0 0 0 1 2 1 0 0 3 4 0 1 0 5 6 3 0 1 2");
        assert_eq!(read("a.ply", &ascii(&text)).expect("it is fine").uvs, [[1., 2.], [3., 4.], [5., 6.]]);
    }
}

#[test]
fn colours_of_bytes_are_display_values_and_those_of_floats_are_linear() {
    let colors = |kind: &str, [r, g, b]: [&str; 3], values: &str| {
        let text = format!("{VERTICES}property {kind} {r}\nproperty {kind} {g}\nproperty {kind} {b}\n{FACE}");
        let rows: String = POSITIONS.lines().map(|position| format!("{position} {values}\n")).collect();
        read("a.ply", &ascii(&format!("{text}{rows}3 0 1 2"))).expect("it is fine").colors
    };
    let long = ["red", "green", "blue"];
    assert_eq!(colors("uchar", long, "0 128 255"), [[0.0, srgb_to_linear(128.0 / 255.0), 1.0]; 3]);
    assert_eq!(colors("ushort", long, "0 32768 65535"), [[0.0, srgb_to_linear(32768.0 / 65535.0), 1.0]; 3]);
    assert_eq!(colors("float", ["r", "g", "b"], "0 0.5 2"), [[0.0, 0.5, 2.0]; 3]);
    assert!(colors("float", ["red", "green", "alpha"], "0 0.5 2").is_empty());
}

#[test]
fn faces_may_come_first_and_be_polygons_and_lines() {
    let faces = "element face 3\nproperty list uint uint vertex_indices\n";
    let text = format!("{faces}{}end_header\n4 0 1 2 3\n2 0 1\n3 3 3 1\n{POSITIONS}1 1 0", VERTICES.replace('3', "4"));
    // A bow tie in this order of corners, so a fan.
    assert_eq!(read("a.ply", &ascii(&text)).expect("it is fine").triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn a_property_declared_twice_takes_its_room_twice() {
    let text = format!("{VERTICES}property float x\n{FACE}9 0 0 0\n9 0 0 1\n9 1 0 0\n3 0 1 2");
    assert_eq!(read("a.ply", &ascii(&text)), Ok(triangle()));
}

#[test]
fn elements_without_properties_take_no_time() {
    let text = format!("element nothing 18446744073709551615\n{VERTICES}{FACE}{POSITIONS}3 0 1 2");
    assert_eq!(read("a.ply", &ascii(&text)), Ok(triangle()));
}

#[test]
fn errors_name_line_and_column() {
    let whole = |body: &str| format!("{VERTICES}{FACE}{body}");
    let cases = [
        ("comment\nelement vertex three\n".to_string(), "a.ply:4:1: 'three' is no number of elements"),
        ("property float x\n".into(), "a.ply:3:1: this property stands before the first 'element' line"),
        ("element vertex 1\nproperty real x\n".into(), "a.ply:4:1: 'real' is no type of PLY"),
        ("element vertex 1\nproperty x\n".into(), "a.ply:4:1: a property is declared as"),
        ("vertices 3\n".into(), "a.ply:3:1: 'vertices 3' is no line of a PLY header"),
        (whole("0 0 0\n1 zero 0\n0 1 0\n3 0 1 2"), "a.ply:11:3: 'zero' is not a number"),
        (whole("0 0 0\n1 0 0\n0 1 0\n3 0 1 3"), "a.ply:13:1: a face names vertex 3, but there are only 3"),
        (whole("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1"), "a.ply:13:7: a face names vertex -1"),
        (whole("0 0 0\n1 0 0\n0 1 0\n3 0 0.5 2"), "a.ply:13:5: a face names vertex 0.5"),
        (whole("0 0 0\n1 0 0\n0 1 0\n-3 0 1 2"), "a.ply:13:1: a list 'vertex_indices' of -3 numbers"),
        (whole("0 0 0\n1 0 0\n0 nan 0\n3 0 1 2"), "cannot read 'a.ply': vertex 2 is not finite"),
        (whole("0 0 0\n1 0 0\n0 1 0 3 0 1"), "cannot read 'a.ply': it ends before all that its header promises"),
        (whole("0 0 0\n1 0 0\n0 1 0\n900 1"), "cannot read 'a.ply': it ends before all that its header promises"),
        (whole("0 0"), "cannot read 'a.ply': its header promises 3 of 'vertex', but only 3 bytes follow"),
    ];
    for (text, expected) in cases {
        let error = error(&ascii(&text));
        assert!(error.starts_with(expected), "{error}");
    }
    assert!(error(b"solid cube").starts_with("a.ply:1:1: a PLY file begins with the line 'ply'"));
    assert!(error(b"ply\nformat utf8 1.0\n").starts_with("a.ply:2:1: the format 'utf8' is none of PLY"));
    assert!(error(b"ply\nend_header\n").starts_with("a.ply:2:1: the header has no 'format' line"));
    assert!(error(b"ply\nformat ascii 1.0\n").contains("its header has no end"));
    assert!(error(b"").contains("it is empty"));
}

#[test]
fn points_alone_are_refused() {
    assert!(error(&ascii(&format!("{VERTICES}end_header\n{POSITIONS}"))).contains("no faces"));
    assert!(error(&ascii("end_header\n")).contains("no faces"));
}

#[test]
fn a_header_that_promises_billions_is_refused_at_once() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for count in ["4294967295", "18446744073709551615"] {
            let header =
                format!("ply\nformat {encoding} 1.0\n{VERTICES}{FACE}").replace("vertex 3", &format!("vertex {count}"));
            assert!(error(header.as_bytes()).contains("promises"), "{encoding}");
        }
    }
}

fn any_mesh() -> impl Strategy<Value = MeshData> {
    (3..30usize, any::<bool>(), any::<bool>()).prop_flat_map(|(count, with_normals, with_uvs)| {
        let positions = vec(prop::array::uniform3(-1e6f32..1e6), count);
        let uvs = vec(prop::array::uniform2(-2f32..2.), if with_uvs { count } else { 0 });
        let normal = (0..3usize).prop_map(|axis| std::array::from_fn(|i| if i == axis { -1.0 } else { 0.0 }));
        let normals = vec(normal, if with_normals { count } else { 0 });
        let triangle =
            prop::array::uniform3(0..count as u32).prop_filter("three corners", |[a, b, c]| a != b && b != c && c != a);
        (positions, normals, uvs, vec(triangle, 1..30)).prop_map(|(positions, normals, uvs, triangles)| MeshData {
            positions,
            normals,
            uvs,
            triangles,
            ..MeshData::default()
        })
    })
}

const INDEX_TYPES: [ScalarType; 4] = [ScalarType::UChar, ScalarType::Short, ScalarType::Int, ScalarType::UInt];

proptest! {
    #[test]
    fn what_another_library_writes_is_read_to_the_bit(mesh in any_mesh(), index in prop::sample::select(INDEX_TYPES.to_vec())) {
        for encoding in ENCODINGS {
            prop_assert_eq!(read("a.ply", &encode(&mesh, encoding, &index)), Ok(mesh.clone()));
        }
    }

    #[test]
    fn truncated_files_are_refused(mesh in any_mesh(), end: prop::sample::Index) {
        for encoding in [Written::BinaryLittleEndian, Written::BinaryBigEndian] {
            let bytes = encode(&mesh, encoding, &ScalarType::Int);
            prop_assert!(read("a.ply", &bytes[..end.index(bytes.len())]).is_err());
        }
    }

    #[test]
    fn arbitrary_bytes_do_not_panic(bytes in vec(any::<u8>(), 0..300)) {
        let _ = read("a.ply", &bytes);
        let _ = read("a.ply", &[format!("ply\nformat binary_big_endian 1.0\n{VERTICES}{FACE}").as_bytes(), &bytes].concat());
        let _ = read("a.ply", &[&ascii(&format!("{VERTICES}{FACE}")), &bytes[..]].concat());
    }

    #[test]
    fn damaged_files_do_not_panic(mesh in any_mesh(), hits in vec(any::<(prop::sample::Index, u8)>(), 1..8)) {
        for encoding in ENCODINGS {
            let mut bytes = encode(&mesh, encoding, &ScalarType::Int);
            for (index, byte) in &hits {
                let at = index.index(bytes.len());
                bytes[at] = *byte;
            }
            let _ = read("a.ply", &bytes);
        }
    }
}
