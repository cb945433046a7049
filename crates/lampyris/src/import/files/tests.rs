use super::*;
use crate::shared_tests::shared;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A folder with these files, and the assets of a scene in it.
fn folder(files: &[(&str, &str)]) -> (tempfile::TempDir, Files<'static>) {
    let folder = tempfile::tempdir().expect("there is room");
    for (name, content) in files {
        fs::write(folder.path().join(name), content).expect("there is room");
    }
    let assets = Files::beside(&folder.path().join("scene.xml"));
    (folder, assets)
}

#[test]
fn nothing_is_kept_that_nobody_uses() {
    let (_folder, files) = folder(&[("a.obj", TRIANGLE)]);
    let mesh = Arc::downgrade(&files.mesh("a.obj", 0).expect("it is fine"));
    assert!(mesh.upgrade().is_none());
}

#[test]
fn a_picture_is_shared_by_all_that_decode_it_in_the_same_way() {
    let (_folder, files) = folder(&[("a.ppm", "P3 1 1 255\n128 128 128\n")]);
    let picture = |raw| files.picture("a.ppm", raw).expect("it is fine");
    let [first, second, raw] = [false, false, true].map(picture);
    assert!(Arc::ptr_eq(&first, &second) && !Arc::ptr_eq(&first, &raw));
    assert_eq!((first.bytes(), raw.bytes()), (1, 1));
}

#[test]
fn a_mesh_is_read_once() {
    let (_folder, files) = folder(&[("a.obj", TRIANGLE)]);
    let first = files.mesh("a.obj", 0).expect("it is fine");
    let second = files.mesh("a.obj", 0).expect("it is fine");
    assert!(Arc::ptr_eq(&first, &second));
}

#[test]
fn the_extension_tells_the_format_in_any_case() {
    let (_folder, files) = folder(&[
        ("a.OBJ", TRIANGLE),
        ("a.ply", "ply"),
        ("a.serialized", "ply!"),
        ("a.stl", ""),
        ("a.3ds", ""),
        ("a", ""),
    ]);
    assert_eq!(files.mesh("a.OBJ", 0).expect("it is fine").triangles.len(), 1);
    let error = |name| files.mesh(name, 0).expect_err("it is broken").to_string();
    assert!(error("a.ply").contains("header"));
    assert!(error("a.serialized").contains("serialized mesh"));
    assert!(error("a.stl").contains("it is empty"));
    for name in ["a.3ds", "a"] {
        assert!(
            error(name).ends_with("not a known mesh format; known are .obj, .ply, .stl and .serialized"),
            "{}",
            error(name)
        );
    }
}

#[test]
fn a_missing_file_and_a_folder_are_named() {
    let (folder, files) = folder(&[]);
    fs::create_dir(folder.path().join("b.obj")).expect("there is room");
    let missing = files.mesh("models/a.obj", 0).expect_err("it is missing").to_string();
    assert!(
        missing.starts_with("cannot read '") && missing.ends_with("models/a.obj': no such file or folder"),
        "{missing}"
    );
    assert!(files.mesh("b.obj", 0).expect_err("it is a folder").to_string().contains("b.obj"));
}

#[test]
fn only_serialized_files_have_several_meshes() {
    let (_folder, files) = folder(&[("a.obj", TRIANGLE)]);
    assert!(files.mesh("a.obj", 1).expect_err("there is one").to_string().contains("it has only one"));
}

/// Files made to break readers: how many triangles each has, or what must be said about it.
const ODD_FILES: [(&str, Result<usize, &str>); 32] = [
    ("OBJ/WusonOBJ.obj", Ok(3732)),
    ("OBJ/box.obj", Ok(12)),
    ("OBJ/box_UTF16BE.obj", Ok(12)),
    // One of its faces runs around the same square again and again.
    ("OBJ/box_longline.obj", Ok(478)),
    ("OBJ/box_mat_with_spaces.obj", Ok(12)),
    ("OBJ/box_without_lineending.obj", Ok(12)),
    ("OBJ/concave_polygon.obj", Ok(64)),
    ("OBJ/cube_mtllib_after_g.obj", Ok(12)),
    ("OBJ/cube_usemtl.obj", Ok(12)),
    ("OBJ/cube_with_vertexcolors.obj", Ok(12)),
    ("OBJ/cube_with_vertexcolors_uni.obj", Ok(12)),
    ("OBJ/empty_mat.obj", Ok(256)),
    ("OBJ/multiple_spaces.obj", Ok(1)),
    ("OBJ/number_formats.obj", Err(".obj:11:14: '3.1+e2' is not a number")),
    ("OBJ/point_cloud.obj", Err("no faces")),
    ("OBJ/regr01.obj", Ok(2710)),
    ("OBJ/regr_3429812.obj", Ok(4)),
    ("OBJ/space_in_material_name.obj", Ok(64)),
    ("OBJ/spider.obj", Ok(1368)),
    ("OBJ/testline.obj", Err("no faces")),
    ("OBJ/testmixed.obj", Ok(12)),
    ("OBJ/testpoints.obj", Err("no faces")),
    ("PLY/cube.ply", Ok(12)),
    ("PLY/cube_binary.ply", Ok(12)),
    ("PLY/cube_uv.ply", Ok(12)),
    ("PLY/float-color.ply", Ok(1)),
    // The line that declares the faces is missing.
    ("PLY/issue623.ply", Err(".ply:14:1: a list 'vertex_indices' of 7.941797 numbers")),
    ("PLY/points.ply", Err("no faces")),
    ("invalid/empty.obj", Err("it is empty")),
    ("invalid/empty.ply", Err("it is empty")),
    ("invalid/malformed.obj", Err(".obj:23:5: there is no vertex 12; the file has only 8 'v' lines")),
    ("invalid/malformed2.obj", Err(".obj:23:1: this face has no corners")),
];

#[test]
fn odd_files_are_read_or_refused_as_a_user_would_want() {
    let Some(folder) = shared("scenes/odd-files") else { return };
    let files = Files::beside(&folder.join("scene.xml"));
    let mut surprises = Vec::new();
    for (name, expected) in ODD_FILES {
        match (files.mesh(name, 0), expected) {
            (Ok(mesh), Ok(triangles)) if mesh.triangles.len() == triangles => {}
            (Err(error), Err(part)) if error.to_string().contains(part) => {}
            (Ok(mesh), _) => surprises.push(format!("{name}: {} triangles", mesh.triangles.len())),
            (Err(error), _) => surprises.push(format!("{name}: {error}")),
        }
    }
    assert!(surprises.is_empty(), "{surprises:#?}");
}

#[test]
fn no_odd_file_is_forgotten() {
    let Some(folder) = shared("scenes/odd-files") else { return };
    for kind in ["OBJ", "PLY", "invalid"] {
        for entry in fs::read_dir(folder.join(kind)).expect("it is a folder") {
            let name = format!("{kind}/{}", entry.expect("it is readable").file_name().to_string_lossy());
            let is_mesh = name.ends_with(".obj") || name.ends_with(".ply");
            assert!(!is_mesh || ODD_FILES.iter().any(|(known, _)| *known == name), "{name}");
        }
    }
}

/// All meshes of a folder and those below it.
fn meshes(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("it is a folder") {
        let path = entry.expect("it is readable").path();
        if path.is_dir() {
            meshes(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "obj" || extension == "ply") {
            found.push(path);
        }
    }
}

#[test]
fn the_meshes_of_whole_scenes_load() {
    for scene in ["veach-bidir", "water-caustic", "transient-cbox", "obj-cornell", "coffee", "mitsuba-media-tests"] {
        let Some(folder) = shared(&format!("scenes/{scene}")) else { return };
        let mut found = Vec::new();
        meshes(&folder, &mut found);
        assert!(!found.is_empty(), "{scene}");
        for path in found {
            let mesh = read_mesh(&path, 0).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(mesh.fault(), None, "{}", path.display());
        }
    }
}

#[test]
fn a_concave_outline_keeps_its_area() {
    let Some(folder) = shared("scenes/odd-files") else { return };
    let mesh = read_mesh(&folder.join("OBJ/concave_polygon.obj"), 0).expect("it is fine");
    // It lies in a plane of constant x: the shoelace formula over its one face, in file order of its corners.
    let text = fs::read_to_string(folder.join("OBJ/concave_polygon.obj")).expect("it is text");
    let rows = |keyword: &str| -> Vec<Vec<f64>> {
        let words = text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
        let numbers = |words: Vec<&str>| words[1..].iter().map(|word| word.split('/').next()?.parse().ok()).collect();
        words.filter(|words| words.first() == Some(&keyword)).filter_map(numbers).collect()
    };
    let (vertices, face) = (rows("v"), &rows("f")[0]);
    let corner = |i: usize| &vertices[face[i % face.len()] as usize - 1];
    let cross = |a: &[f64], b: &[f64]| a[1] * b[2] - a[2] * b[1];
    let outline: f64 = (0..face.len()).map(|i| cross(corner(i), corner(i + 1))).sum();
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].map(f64::from));
        (cross(&a, &b) + cross(&b, &c) + cross(&c, &a)).abs()
    };
    let triangles: f64 = mesh.triangles.iter().map(area).sum();
    assert!((triangles - outline.abs()).abs() < 1e-5 * triangles, "{triangles} for {outline}");
}

#[cfg(unix)]
#[test]
fn what_never_ends_is_not_read() {
    use crate::import::load::{LoadOptions, load};
    let scene = |text: &str| format!("<scene version='3.0.0'>{text}</scene>");
    let (folder, files) = folder(&[
        ("a.xml", &scene("<include filename='/dev/zero'/>")),
        ("b.pbrt", "WorldBegin Shape \"plymesh\" \"string filename\" \"zero.ply\""),
        (
            "c.gltf",
            r#"{ "asset": { "version": "2.0" }, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
            "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
            "bufferViews": [{ "buffer": 0, "byteLength": 36 }], "buffers": [{ "uri": "zero.ply", "byteLength": 36 }] }"#,
        ),
    ]);
    let link = |name: &&str| std::os::unix::fs::symlink("/dev/zero", folder.path().join(name)).expect("a link");
    ["zero.ply", "zero.serialized", "zero.toml", "zero.glb", "zero.xml", "zero.pbrt", "zero.obj"].iter().for_each(link);
    let refused = |error: Error| assert!(error.message.contains("a pipe or a device"), "{error}");
    refused(files.picture("/dev/zero", false).expect_err("endless"));
    refused(files.mesh("zero.serialized", 0).expect_err("endless"));
    for name in ["a.xml", "b.pbrt", "c.gltf", "zero.toml", "zero.glb", "zero.xml", "zero.pbrt", "zero.obj", "zero.ply"]
    {
        refused(load(&folder.path().join(name), &LoadOptions::default()).expect_err("endless"));
    }
}
