use super::*;
use crate::import::mitsuba::read;
use crate::shared_tests::shared;

/// Shapes, lights and warnings of a scene in the shared folder, or nothing where it is not there.
fn counts(file: &str) -> Option<(usize, usize, Vec<String>)> {
    let path = shared(&format!("scenes/{file}"))?;
    let imported = read(&path, &Options::default()).expect("the scene is valid");
    let description = &imported.description;
    let folder = path.parent().expect("it is in a folder");
    for (index, shape) in description.shapes.iter().enumerate() {
        assert!(imported.places.find(&format!("shapes[{index}]")).is_some());
        if let crate::scene::description::GeometryDescription::Mesh { file, .. } = &shape.geometry {
            let named = folder.join(file);
            let there = named.exists() || !folder.join("models").exists();
            assert!(there, "'{file}' should be found");
        }
    }
    let lamps = description.shapes.iter().filter(|shape| shape.emission.is_some()).count();
    let warnings = imported.warnings.iter().map(|warning| warning.message.clone()).collect();
    Some((description.shapes.len(), description.lights.len() + lamps, warnings))
}

#[test]
fn scenes_that_we_can_do_in_full_are_read_without_a_word() {
    for (file, shapes, lights) in [
        ("lab/lab.xml", 7, 1),
        ("lab/lab-d.xml", 7, 1),
        ("lab/lab-area.xml", 8, 1),
        ("lab/lab-area-d.xml", 8, 1),
        ("cornell-box/mitsuba3/scene_v3.xml", 8, 1),
        ("cornell-box/mitsuba0.6/scene_v0.6.xml", 8, 1),
        ("water-caustic/mitsuba3/scene.xml", 10, 1),
        ("living-room/mitsuba0.6/scene.xml", 65, 1),
        ("transient-cbox/transient/cbox_diffuse.xml", 8, 1),
        ("transient-cbox/transient/cbox_mirror.xml", 8, 1),
        ("transient-cbox/nlos/nlos_Z.xml", 2, 1),
    ] {
        if let Some(found) = counts(file) {
            assert_eq!(found, (shapes, lights, Vec::new()), "{file}");
        }
    }
}

#[test]
fn what_is_done_otherwise_is_said() {
    for (file, shapes, lights, words) in [
        ("veach-bidir/mitsuba3/scene.xml", 14, 2, vec!["path_guiding_integrator"]),
        (
            "mitsuba-media-tests/tests/scenes/participating_media/test_homo_roughdielectric_spot_volpath.xml",
            2,
            1,
            vec!["moment"],
        ),
    ] {
        if let Some((found_shapes, found_lights, warnings)) = counts(file) {
            assert_eq!((found_shapes, found_lights), (shapes, lights), "{file}: {warnings:#?}");
            for word in &words {
                assert!(warnings.iter().any(|warning| warning.contains(word)), "{file}: {word} in {warnings:#?}");
            }
            let expected = |warning: &String| words.iter().any(|word| warning.contains(word));
            assert!(warnings.iter().all(expected), "{file}: {warnings:#?}");
        }
    }
}
