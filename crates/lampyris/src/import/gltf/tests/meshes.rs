use super::*;

#[test]
fn a_triangle_is_read_with_v_turned_up() {
    let imported = good(&[]);
    let data = mesh(&imported, 0);
    assert_eq!(data.positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(data.uvs, [[0.0, 1.0], [1.0, 1.0], [0.0, 0.75]]);
    assert_eq!(data.triangles, [[0, 1, 2]]);
    assert!(data.normals.is_empty());
}

#[test]
fn a_binary_file_is_the_same_as_its_text() {
    let binary = read_bytes(Path::new("a.glb"), &triangle_glb()).expect("it is valid");
    assert_eq!(mesh(&binary, 0), mesh(&good(&[]), 0));
}

/// The triangle with four vertices, drawn by `indices` in `mode`.
fn drawn(mode: u32, indices: &[u8]) -> Vec<[u32; 3]> {
    let positions = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    let imported = good(&[
        ("/buffers/0", buffer(&floats(&positions))),
        ("/buffers/-", buffer(indices)),
        ("/bufferViews/0", json!({ "buffer": 0, "byteLength": 48 })),
        ("/bufferViews/1", json!({ "buffer": 1, "byteLength": indices.len() })),
        ("/accessors/0/count", json!(4)),
        ("/accessors/1", json!({ "bufferView": 1, "componentType": 5121, "count": indices.len(), "type": "SCALAR" })),
        ("/meshes/0/primitives/0", json!({ "attributes": { "POSITION": 0 }, "indices": 1, "mode": mode })),
    ]);
    mesh(&imported, 0).triangles.clone()
}

#[test]
fn lists_strips_and_fans_become_triangles() {
    assert_eq!(drawn(4, &[0, 1, 2, 2, 1, 3, 0]), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(drawn(5, &[0, 1, 2, 3]), [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(drawn(6, &[0, 1, 3, 2]), [[1, 3, 0], [3, 2, 0]]);
}

#[test]
fn triangles_that_name_a_vertex_twice_are_left_out() {
    assert_eq!(drawn(5, &[0, 1, 2, 2, 3, 1]), [[0, 1, 2], [2, 1, 3]]);
}

#[test]
fn only_vertices_that_are_used_are_kept() {
    assert_eq!(drawn(4, &[3, 1, 2]), [[2, 0, 1]]);
}

#[test]
fn quantized_positions_and_interleaved_normals_are_read() {
    // Three vertices of i16 positions with two bytes of padding and i8 normals with one.
    let mut bytes = Vec::new();
    for position in [[0_i16, 0, 0], [16383, 0, 0], [0, -32768, 0]] {
        bytes.extend(position.iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend([0, 0, 0, 0, 127, 0]);
    }
    let accessor = |offset: usize, component: u32| {
        json!({ "bufferView": 0, "byteOffset": offset, "componentType": component, "normalized": true, "count": 3,
                "type": "VEC3" })
    };
    let imported = good(&[
        ("/extensionsRequired", json!(["KHR_mesh_quantization"])),
        ("/buffers/0", buffer(&bytes)),
        ("/bufferViews/0", json!({ "buffer": 0, "byteLength": 36, "byteStride": 12 })),
        ("/accessors/0", accessor(0, 5122)),
        ("/accessors/1", accessor(8, 5120)),
        ("/meshes/0/primitives/0/attributes", json!({ "POSITION": 0, "NORMAL": 1 })),
    ]);
    let data = mesh(&imported, 0);
    assert_eq!(data.normals, [[0.0, 0.0, 1.0]; 3]);
    assert!((data.positions[1][0] - 16383.0 / 32767.0).abs() < 1e-6);
    assert_eq!(data.positions[2][1], -1.0);
}

#[test]
fn sparse_accessors_replace_some_elements() {
    let values = [floats(&[5.0, 6.0, 7.0]), vec![2]].concat();
    let sparse = json!({
        "count": 1,
        "indices": { "bufferView": 3, "componentType": 5121 },
        "values": { "bufferView": 2 }
    });
    let imported = good(&[
        ("/buffers/-", buffer(&values)),
        ("/bufferViews/-", json!({ "buffer": 1, "byteLength": 12 })),
        ("/bufferViews/-", json!({ "buffer": 1, "byteOffset": 12, "byteLength": 1 })),
        ("/accessors/0/sparse", sparse),
    ]);
    assert_eq!(mesh(&imported, 0).positions[1..], [[1.0, 0.0, 0.0], [5.0, 6.0, 7.0]]);
}

#[test]
fn morph_targets_are_applied_with_their_weights() {
    let imported =
        good(&[("/meshes/0/primitives/0/targets", json!([{ "POSITION": 0 }])), ("/meshes/0/weights", json!([0.5]))]);
    assert_eq!(mesh(&imported, 0).positions[1], [1.5, 0.0, 0.0]);
}

#[test]
fn vertex_colours_multiply_the_base_colour() {
    let colors = [255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 51, 255];
    let imported = good(&[
        ("/buffers/-", buffer(&colors)),
        ("/bufferViews/-", json!({ "buffer": 1, "byteLength": 12 })),
        (
            "/accessors/-",
            json!({ "bufferView": 2, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4" }),
        ),
        ("/meshes/0/primitives/0/attributes/COLOR_0", json!(2)),
    ]);
    assert_eq!(mesh(&imported, 0).colors, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.2]]);
    let MaterialDescription::Principled(principled) = front(material(&imported)) else { panic!("principled") };
    assert_eq!(principled.base_color, crate::scene::description::Paint::Texture("vertex-colours".into()));
}

#[test]
fn a_mesh_in_two_nodes_is_stored_once_and_turned_round_in_a_mirror() {
    let imported = good(&[
        ("/nodes/-", json!({ "mesh": 0, "translation": [0, 0, 1] })),
        ("/nodes/-", json!({ "mesh": 0, "scale": [-1, 1, 1] })),
        ("/scenes/0/nodes", json!([0, 1, 2])),
    ]);
    assert!(std::ptr::eq(mesh(&imported, 0), mesh(&imported, 1)));
    assert_eq!(mesh(&imported, 2).triangles, [[0, 2, 1]]);
}

#[test]
fn many_copies_become_instances_of_a_group() {
    let translations: Vec<f32> = (0..1000).flat_map(|at| [at as f32, 0.0, 0.0]).collect();
    let imported = good(&[
        ("/buffers/-", buffer(&floats(&translations))),
        ("/bufferViews/-", json!({ "buffer": 1, "byteLength": 12000 })),
        ("/accessors/-", json!({ "bufferView": 2, "componentType": 5126, "count": 1000, "type": "VEC3" })),
        ("/nodes/0/extensions", json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 2 } } })),
        ("/nodes/0/translation", json!([0, 2, 0])),
    ]);
    let description = &imported.description;
    assert_eq!((description.shapes.len(), description.groups["mesh0"].len()), (1000, 1));
    let shape = &description.shapes[7];
    assert_eq!(shape.geometry, GeometryDescription::Instance { group: "mesh0".into() });
    assert_eq!(shape.transform.0.w_axis.truncate().to_array(), [7.0, 2.0, 0.0]);
}

#[test]
fn a_mirror_does_not_turn_instances_round_as_they_see_to_it_themselves() {
    let mut changes = vec![("/scenes/0/nodes", json!((0..1000).collect::<Vec<_>>()))];
    changes.extend((1..1000).map(|_| ("/nodes/-", json!({ "mesh": 0, "scale": [-1, 1, 1] }))));
    let imported = good(&changes);
    let GeometryDescription::Triangles(data) = &imported.description.groups["mesh0"][0].geometry else {
        panic!("triangles")
    };
    assert_eq!((imported.description.groups.len(), &data.triangles[..]), (1, &[[0, 1, 2]][..]));
}
