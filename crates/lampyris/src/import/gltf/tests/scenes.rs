use super::*;
use crate::scene::description::{Color, FovAxis, LightDescription, Projection};

#[test]
fn nodes_move_what_is_below_them() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let imported = good(&[
        ("/nodes/0", json!({ "children": [1], "translation": [1, 2, 3], "scale": [2, 2, 2] })),
        ("/nodes/-", json!({ "mesh": 0, "rotation": [0, 0, half, half] })),
    ]);
    let matrix = imported.description.shapes[0].transform.0;
    let moved = matrix.transform_point3(glam::Vec3::X);
    assert!(moved.abs_diff_eq(glam::Vec3::new(1.0, 4.0, 3.0), 1e-6), "{moved}");
}

#[test]
fn a_perspective_camera_keeps_its_view_and_the_shape_of_its_picture() {
    let imported = good(&[
        ("/cameras", json!([{ "type": "perspective", "perspective": { "yfov": 0.5, "aspectRatio": 2, "znear": 1 } }])),
        ("/nodes/0/camera", json!(0)),
        ("/nodes/0/translation", json!([0, 0, 5])),
    ]);
    let camera = imported.description.camera.expect("a camera");
    assert_eq!((camera.origin, camera.target), ([0.0, 0.0, 5.0], Some([0.0, 0.0, 4.0])));
    assert_eq!((camera.fov, camera.fov_axis), (Some(0.5_f32.to_degrees()), FovAxis::Y));
    assert_eq!(imported.description.film.size, [512, 256]);
}

#[test]
fn an_orthographic_camera_is_as_wide_as_it_says() {
    let imported = good(&[
        ("/cameras", json!([{ "type": "orthographic", "orthographic": { "xmag": 3, "ymag": 1.5 } }])),
        ("/nodes/0/camera", json!(0)),
    ]);
    let camera = imported.description.camera.expect("a camera");
    assert_eq!((camera.projection, camera.width), (Projection::Orthographic, Some(6.0)));
    assert_eq!(imported.description.film.size, [512, 256]);
}

#[test]
fn without_camera_and_light_there_are_stated_defaults() {
    let imported = good(&[]);
    let description = &imported.description;
    assert_eq!(description.lights, [LightDescription::Constant { radiance: Color::grey(1.0) }]);
    assert_eq!(
        messages(&imported),
        [
            "the file has no light: a white sky of radiance 1 is used",
            "the file has no camera: one in front of the scene that sees all of it is used"
        ]
    );
}

#[test]
fn the_camera_of_our_own_looks_at_where_the_nodes_put_their_meshes() {
    let imported = good(&[("/nodes/0/scale", json!([10, 4, 1])), ("/nodes/0/translation", json!([100, 0, 0]))]);
    let camera = imported.description.camera.expect("a camera");
    assert_eq!(camera.target, Some([105.0, 2.0, 0.0]));
}

#[test]
fn punctual_lights_stand_where_their_nodes_are() {
    let lights = json!([
        { "type": "point", "intensity": 3, "color": [1, 0.5, 0] },
        { "type": "directional" },
        { "type": "spot", "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.2 } },
        { "type": "point", "intensity": 0 }
    ]);
    let node = |light: usize| {
        json!({ "extensions": { "KHR_lights_punctual": { "light": light } }, "translation": [0, 0, 2],
                "rotation": [1, 0, 0, 0] })
    };
    let imported = good(&[
        ("/extensions", json!({ "KHR_lights_punctual": { "lights": lights } })),
        ("/nodes/-", node(0)),
        ("/nodes/-", node(1)),
        ("/nodes/-", node(2)),
        ("/nodes/-", node(3)),
        ("/scenes/0/nodes", json!([0, 1, 2, 3, 4])),
    ]);
    let expected = [
        LightDescription::Point { position: [0.0, 0.0, 2.0], intensity: Some(Color([3.0, 1.5, 0.0])), power: None },
        LightDescription::Directional { direction: [0.0, 0.0, 1.0], irradiance: Color::grey(1.0), angle: 0.0 },
        LightDescription::Spot {
            position: [0.0, 0.0, 2.0],
            target: [0.0, 0.0, 3.0],
            intensity: Some(Color::grey(1.0)),
            power: None,
            cutoff: 0.2_f32.to_degrees(),
            beam_width: Some(0.1_f32.to_degrees()),
        },
    ];
    assert_eq!(imported.description.lights, expected);
}

#[test]
fn a_skinned_mesh_stands_where_its_bones_are() {
    let mut matrix = [0.0; 16];
    (0..4).for_each(|at| matrix[5 * at] = 1.0);
    matrix[12] = -1.0;
    let imported = good(&[
        ("/buffers/-", buffer(&floats(&matrix))),
        ("/bufferViews/-", json!({ "buffer": 1, "byteLength": 64 })),
        ("/accessors/-", json!({ "bufferView": 2, "componentType": 5126, "count": 1, "type": "MAT4" })),
        ("/skins", json!([{ "joints": [1], "inverseBindMatrices": 2 }])),
        ("/nodes/0", json!({ "mesh": 0, "skin": 0, "translation": [9, 9, 9] })),
        ("/nodes/-", json!({ "translation": [1, 5, 0] })),
        ("/scenes/0/nodes", json!([0, 1])),
    ]);
    let matrix = imported.description.shapes[0].transform.0;
    assert_eq!(matrix.w_axis.truncate().to_array(), [0.0, 5.0, 0.0]);
    assert!(messages(&imported)[0].contains("skins"));
}

#[test]
fn without_scenes_all_nodes_are_seen() {
    let imported = good(&[("/scenes", json!([])), ("/nodes/-", json!({ "mesh": 0 }))]);
    assert_eq!(imported.description.shapes.len(), 2);
}

#[test]
fn parts_of_the_description_have_their_places() {
    let text = "{\"asset\": {\"version\": \"2.0\"},\n\"nodes\": [\n{\"mesh\": 0}],";
    let rest = triangle().to_string();
    let rest = rest.replace("\"nodes\":[{\"mesh\":0}],", "").replace("\"asset\":{\"version\":\"2.0\"},", "");
    let file = format!("{text}{}", &rest[1..]);
    let imported = read_bytes(Path::new("a.gltf"), file.as_bytes()).expect("it is valid");
    let place = imported.places.find("shapes[0].transform").expect("a place");
    assert_eq!((place.line, place.column), (3, 1));
}
