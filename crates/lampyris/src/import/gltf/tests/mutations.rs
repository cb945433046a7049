use proptest::prelude::*;

use super::*;

/// A file with something of everything.
fn rich() -> Value {
    let lights = json!([{ "type": "spot", "spot": { "outerConeAngle": 0.5 } }, { "type": "point" }]);
    changed(&[
        ("/extensionsUsed", json!(["KHR_lights_punctual"])),
        ("/extensions", json!({ "KHR_lights_punctual": { "lights": lights } })),
        (
            "/nodes/0/extensions",
            json!({ "KHR_lights_punctual": { "light": 0 },
            "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 0 } } }),
        ),
        ("/nodes/0/children", json!([1])),
        ("/nodes/-", json!({ "camera": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1] })),
        ("/cameras", json!([{ "type": "perspective", "perspective": { "yfov": 0.7, "aspectRatio": 1.5 } }])),
        ("/images", json!([{ "uri": "a.png" }, { "bufferView": 1 }])),
        ("/samplers", json!([{ "wrapS": 33648 }])),
        ("/textures", json!([{ "source": 0, "sampler": 0 }, { "source": 1 }])),
        (
            "/materials",
            json!([{
                "pbrMetallicRoughness": { "roughnessFactor": 0.5, "metallicRoughnessTexture": { "index": 1 },
                    "baseColorTexture": { "index": 0, "extensions": { "KHR_texture_transform": { "rotation": 1 } } } },
                "normalTexture": { "index": 1 }, "alphaMode": "BLEND", "emissiveFactor": [1, 0, 2],
                "extensions": { "KHR_materials_transmission": { "transmissionFactor": 0.5 },
                    "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 2 } }
            }]),
        ),
        ("/meshes/0/primitives/0/material", json!(0)),
        ("/meshes/0/primitives/0/targets", json!([{ "POSITION": 0 }])),
        ("/meshes/0/weights", json!([0.5])),
    ])
}

/// Numbers that files lie with, and other things.
fn odd_value() -> impl Strategy<Value = String> {
    prop::sample::select(vec![
        "0",
        "1",
        "2",
        "-1",
        "1e9",
        "4294967295",
        "18446744073709551615",
        "1e300",
        "null",
        "[]",
        "{}",
        "\"x\"",
        "0.5",
        "[0]",
        "[1,2,3]",
        "65536",
        "5121",
        "5123",
        "5125",
    ])
    .prop_map(str::to_string)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_file_with_other_numbers_never_panics(
        edits in proptest::collection::vec((any::<prop::sample::Index>(), odd_value()), 1..4),
    ) {
        let mut text = rich().to_string();
        for (at, value) in &edits {
            let data = text.find("base64").unwrap_or(0);
            let numbers: Vec<(usize, &str)> = text
                .match_indices(|c: char| c.is_ascii_digit())
                .filter(|(at, _)| !(data..data + 90).contains(at))
                .collect();
            let start = numbers[at.index(numbers.len())].0;
            let end = start + text[start..].find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(1);
            text.replace_range(start..end, value);
        }
        if let Err(error) = read_bytes(Path::new("a.gltf"), text.as_bytes()) {
            prop_assert!(!error.to_string().is_empty());
        }
    }

    #[test]
    fn a_damaged_text_never_panics(
        edits in proptest::collection::vec((any::<prop::sample::Index>(), 0usize..12, "[ -~]{0,4}|\"|\\[|\\{|9e9|-1|é"), 1..4),
    ) {
        let mut text = rich().to_string();
        for (at, removed, inserted) in &edits {
            let from = at.index(text.len());
            let to = (from + removed).min(text.len());
            if text.is_char_boundary(from) && text.is_char_boundary(to) {
                text.replace_range(from..to, inserted);
            }
        }
        if let Err(error) = read_bytes(Path::new("a.gltf"), text.as_bytes()) {
            prop_assert!(!error.to_string().is_empty());
        }
    }

    #[test]
    fn a_damaged_container_never_panics(
        edits in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let mut bytes = triangle_glb();
        for (at, byte) in &edits {
            let at = at.index(bytes.len());
            bytes[at] = *byte;
        }
        let _ = read_bytes(Path::new("a.glb"), &bytes);
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = read_bytes(Path::new("a.glb"), &[b"glTF\x02\0\0\0", &bytes[..]].concat());
    }
}

#[test]
fn the_file_they_damage_is_valid() {
    read(&rich()).expect("valid");
}
