use super::*;

#[test]
fn a_required_extension_that_we_lack_is_named() {
    let error = fault(&[("/extensionsRequired", json!(["KHR_texture_transform", "KHR_draco_mesh_compression"]))]);
    assert_eq!(error.message, "the file requires the extension 'KHR_draco_mesh_compression', which is not supported");
    assert!(error.hint.is_some_and(|hint| hint.contains("without compression")));
}

#[test]
fn an_extension_that_the_file_can_do_without_is_a_warning() {
    let imported = good(&[("/extensionsUsed", json!(["KHR_materials_variants"]))]);
    assert_eq!(messages(&imported)[0], "the extension 'KHR_materials_variants' is not supported: left out");
}

#[test]
fn numbers_of_things_that_do_not_exist_are_refused_where_they_stand() {
    for (pointer, value, message) in [
        ("/scene", json!(3), "there is no scenes[3]: the file has only one, number 0"),
        ("/nodes/0/mesh", json!(1), "there is no meshes[1]: the file has only one, number 0"),
        ("/nodes/0/camera", json!(0), "there is no cameras[0]: the file has none"),
        ("/nodes/0/children", json!([5]), "there is no nodes[5]: the file has only one, number 0"),
        ("/meshes/0/primitives/0/material", json!(0), "there is no materials[0]: the file has none"),
        ("/meshes/0/primitives/0/indices", json!(9), "there is no accessors[9]: the file has 2, numbered from 0"),
        ("/accessors/0/bufferView", json!(9), "there is no bufferViews[9]: the file has 2, numbered from 0"),
        ("/bufferViews/0/buffer", json!(9), "there is no buffers[9]: the file has only one, number 0"),
    ] {
        assert_eq!(fault(&[(pointer, value)]).message, message, "{pointer}");
    }
}

#[test]
fn lists_that_do_not_lie_in_their_buffers_are_refused() {
    for (pointer, value) in [
        ("/accessors/0/count", json!(4)),
        ("/accessors/0/count", json!(u64::MAX)),
        ("/accessors/0/byteOffset", json!(1)),
        ("/accessors/0/byteOffset", json!(u64::MAX)),
        ("/accessors/0/componentType", json!(5130)),
        ("/accessors/0/type", json!("VEC2")),
        ("/accessors/0/type", json!("VEC9")),
        ("/bufferViews/0/byteLength", json!(61)),
        ("/bufferViews/0/byteOffset", json!(u64::MAX)),
        ("/bufferViews/0/byteStride", json!(4)),
        ("/bufferViews/0/byteStride", json!(u64::MAX)),
        ("/buffers/0/byteLength", json!(61)),
        ("/buffers/0/uri", json!("missing.bin")),
        ("/buffers/0/uri", json!("https://example.org/a.bin")),
        ("/buffers/0/uri", json!("data:;base64,####")),
        ("/buffers/0", json!({ "byteLength": 60 })),
        ("/accessors/1/count", json!(2)),
    ] {
        let error = fault(&[(pointer, value.clone())]);
        assert!(error.message.contains('['), "{pointer} {value}: {error}");
    }
}

#[test]
fn a_list_without_data_may_not_be_long() {
    let accessor = json!({ "componentType": 5126, "count": 4_000_000_000_u32, "type": "VEC3" });
    assert_eq!(fault(&[("/accessors/0", accessor)]).message, "accessors[0]: it has no data");
}

#[test]
fn many_meshes_over_the_same_bytes_are_refused() {
    // The weights make them different.
    let mesh = |weight: usize| {
        let primitive = json!({ "attributes": { "POSITION": 0 }, "targets": [{ "POSITION": 0 }] });
        json!({ "primitives": [primitive], "weights": [weight] })
    };
    let error = fault(&[
        ("/meshes", (0..4000).map(mesh).collect()),
        ("/nodes", (0..4000).map(|number| json!({ "mesh": number })).collect()),
        ("/scenes/0/nodes", json!((0..4000).collect::<Vec<_>>())),
    ]);
    assert!(error.message.contains("over and over"), "{error}");
}

#[test]
fn cycles_and_second_parents_are_refused() {
    let cycle = fault(&[("/nodes/0/children", json!([0]))]);
    assert_eq!(cycle.message, "nodes[0]: the node has two parents, or is its own ancestor");
    let twice = fault(&[("/scenes/0/nodes", json!([0, 0]))]);
    assert_eq!(twice.message, cycle.message);
}

#[test]
fn positions_that_are_no_numbers_are_refused() {
    let error = fault(&[("/buffers/0", buffer(&[0xff; 60]))]);
    assert_eq!(error.message, "meshes[0].primitives[0]: vertex 0 is not finite");
}

#[test]
fn singular_and_broken_matrices_are_sentences() {
    let imported =
        read(&changed(&[("/nodes/-", json!({ "mesh": 0, "scale": [0, 1, 1] })), ("/scenes/0/nodes", json!([0, 1]))]));
    let imported = imported.expect("it is valid");
    assert_eq!(imported.description.shapes.len(), 1);
    assert!(messages(&imported).contains(&"nodes that are scaled to nothing are left out"));
    let error = fault(&[("/nodes/0/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]))]);
    assert!(error.message.contains("affine"), "{error}");
}

#[test]
fn wrong_types_have_their_line_and_column() {
    let error = read_bytes(Path::new("a.gltf"), b"{\"asset\": {\"version\": \"2.0\"},\n \"scene\": -1}");
    let error = error.expect_err("a negative number");
    assert_eq!(error.to_string(), "a.gltf:2:12: invalid value: integer `-1`, expected a whole number, 0 or more");
}

#[test]
fn other_versions_and_other_files_are_refused() {
    let error = fault(&[("/asset/version", json!("1.0"))]);
    assert_eq!(error.message, "the file is of glTF 1.0; only version 2.0 can be read");
    let message = |bytes: &[u8]| read_bytes(Path::new("a.gltf"), bytes).expect_err("no glTF").to_string();
    assert_eq!(message(b"{}"), "a.gltf: this is no glTF file: it has no 'asset'");
    assert!(message(b"").contains("EOF"), "{}", message(b""));
    assert!(message(b"[1]").starts_with("a.gltf:1:"), "{}", message(b"[1]"));
    assert_eq!(message(b"\xff"), "a.gltf: the JSON is not UTF-8");
}

#[test]
fn binary_files_that_are_cut_short_are_refused() {
    let whole = triangle_glb();
    for length in 4..whole.len() {
        let error = read_bytes(Path::new("a.glb"), &whole[..length]).expect_err("it is cut short");
        assert!(error.message.contains("cut short"), "{length}: {error}");
    }
    let mut lying = whole.clone();
    lying[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = read_bytes(Path::new("a.glb"), &lying).expect_err("a chunk of 4 GB");
    assert_eq!(error.message, "a chunk of the binary glTF does not fit into it");
}
