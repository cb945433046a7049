use super::*;
use crate::import::gltf::read as read_file;
use crate::shared_tests::shared;

/// Shapes, lights that are none of them, lamps, and warnings of a scene in the shared folder, or nothing where it is
/// not there.
fn counts(file: &str) -> Option<(usize, usize, usize, String)> {
    let imported = read_file(&shared(&format!("scenes/{file}"))?).expect("the scene is valid");
    assert!(imported.description.camera.is_some(), "{file}");
    let description = &imported.description;
    let lamps = description.shapes.iter().filter(|shape| shape.emission.is_some()).count();
    Some((description.shapes.len(), description.lights.len(), lamps, messages(&imported).join("; ")))
}

#[test]
fn samples_are_read_and_what_is_done_otherwise_is_said() {
    for (file, shapes, lights, lamps, words) in [
        ("gltf-transmission/AttenuationTest/AttenuationTest.gltf", 23, 1, 0, &["absorption", "no light"][..]),
        ("gltf-transmission/BoxVertexColors/BoxVertexColors.glb", 1, 1, 0, &["no light"]),
        ("gltf-transmission/Cameras/Cameras.gltf", 1, 1, 0, &["only the first camera", "no light"]),
        ("gltf-transmission/EmissiveStrengthTest/EmissiveStrengthTest.glb", 6, 0, 5, &["no camera"]),
        ("gltf-transmission/IridescenceSuzanne/IridescenceSuzanne.gltf", 3, 1, 0, &["iridescence", "no camera"]),
        ("gltf-transmission/TransmissionRoughnessTest/TransmissionRoughnessTest.glb", 9, 1, 0, &["no light"]),
        ("odd-files/glTF2/BoxBadNormals-glTF-Binary/BoxBadNormals.glb", 1, 1, 0, &[]),
        ("odd-files/glTF2/BoxTextured-glTF/BoxTextured.gltf", 1, 1, 0, &[]),
        ("odd-files/glTF2/BoxTextured-glTF-Binary/BoxTextured.glb", 1, 1, 0, &[]),
        ("odd-files/glTF2/BoxTextured-glTF-Embedded/BoxTextured.gltf", 1, 1, 0, &[]),
        ("odd-files/glTF2/cameras/Cameras.gltf", 1, 1, 0, &["only the first camera"]),
        ("odd-files/glTF2/textureTransform/TextureTransformTest.gltf", 12, 1, 0, &[]),
        ("odd-files/glTF2/IncorrectVertexArrays/Cube.gltf", 4, 1, 0, &["points and lines", "do not make a triangle"]),
        // What is wrong is the name of a scene, which no one needs.
        ("odd-files/glTF2/wrongTypes/badString.gltf", 1, 1, 0, &[]),
    ] {
        if let Some(found) = counts(file) {
            assert_eq!((found.0, found.1, found.2), (shapes, lights, lamps), "{file}: {}", found.3);
            assert!(words.iter().all(|word| found.3.contains(word)), "{file}: {}", found.3);
        }
    }
}

#[test]
fn broken_samples_are_refused_with_a_sentence() {
    for (file, words) in [
        ("BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb", "is not finite"),
        ("IndexOutOfRange/IndexOutOfRange.gltf", "but there are only"),
        ("IndexOutOfRange/AllIndicesOutOfRange.gltf", "but there are only"),
        ("MissingBin/BoxTextured.gltf", "no such file"),
        ("RecursiveNodes/RecursiveNodes.gltf", "its own ancestor"),
        ("SchemaFailures/sceneWrongType.gltf", "expected a whole number"),
        ("TestNoRootNode/NoScene.gltf", "there is no scenes[0]"),
        ("TestNoRootNode/SceneWithoutNodes.gltf", "the scene is empty"),
        ("wrongTypes/badArray.gltf", "invalid type: map, expected a sequence"),
        ("wrongTypes/badExtension.gltf", "invalid type: string"),
        ("wrongTypes/badNumber.gltf", "invalid type: string"),
        ("wrongTypes/badObject.gltf", "invalid type: string \"not an object\""),
        ("wrongTypes/badUint.gltf", "invalid value: integer `-1`"),
    ] {
        let Some(path) = shared(&format!("scenes/odd-files/glTF2/{file}")) else { continue };
        let error = match read_file(&path) {
            Ok(imported) => panic!("{file} is read: {:?}", messages(&imported)),
            Err(error) => error.to_string(),
        };
        assert!(error.contains(words), "{file}: {error}");
    }
}
