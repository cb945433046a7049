//! Scenes that others wrote.

use crate::shared_tests::shared;

/// Shapes, lights and warnings of a scene in the shared folder, or nothing where it is not there.
fn counts(file: &str) -> Option<(usize, usize, Vec<String>)> {
    let imported = crate::import::pbrt::read(&shared(&format!("scenes/{file}"))?).expect("the scene is valid");
    let description = &imported.description;
    assert!((0..description.shapes.len()).all(|index| imported.places.find(&format!("shapes[{index}]")).is_some()));
    let lamps = description.shapes.iter().filter(|shape| shape.emission.is_some()).count();
    let warnings = imported.warnings.iter().map(|warning| warning.message.clone()).collect();
    Some((description.shapes.len(), description.lights.len() + lamps, warnings))
}

#[test]
fn scenes_that_we_can_do_in_full_are_read_without_a_word() {
    for (file, shapes, lights) in [
        ("cornell-box/pbrt-v4/scene-v4.pbrt", 8, 1),
        ("coffee/pbrt-v4/scene-v4.pbrt", 23, 3),
        ("water-caustic/pbrt-v4/scene-v4.pbrt", 10, 1),
    ] {
        if let Some(found) = counts(file) {
            assert_eq!(found, (shapes, lights, Vec::new()), "{file}");
        }
    }
}

#[test]
fn what_is_done_otherwise_is_said() {
    if let Some((shapes, lights, warnings)) = counts("veach-bidir/pbrt-v4/scene-v4.pbrt") {
        assert_eq!((shapes, lights), (14, 2));
        assert!(warnings.len() == 1 && warnings[0].contains("integrator 'bdpt'"), "{warnings:?}");
    }
}
