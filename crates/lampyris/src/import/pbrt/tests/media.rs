use super::*;
use crate::scene::description::{Color, MediumDescription, PhaseDescription};

const FOG: &str =
    "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [1 2 3] \"rgb sigma_a\" [0.5 0.5 0]
    \"float g\" 0.25 \"float scale\" 2\n";

#[test]
fn a_homogeneous_medium_keeps_its_coefficients() {
    let description = clean(&format!(
        "{FOG} MediumInterface \"fog\" \"\" Material \"interface\" Shape \"sphere\" MediumInterface \"\" Shape \"sphere\""
    ))
    .description;
    let expected = MediumDescription::Homogeneous {
        sigma_t: None,
        albedo: None,
        sigma_s: Some(Color([1.0, 2.0, 3.0])),
        sigma_a: Some(Color([0.5, 0.5, 0.0])),
        scale: 2.0,
        phase: PhaseDescription::HenyeyGreenstein { g: 0.25 },
        delay: 0.0,
        delay_seconds: None,
    };
    assert_eq!(description.media["fog"], expected);
    // The second is a border of nothing.
    assert_eq!(description.shapes.len(), 1);
    assert_eq!(description.shapes[0].interior.as_deref(), Some("fog"));
    assert!(matches!(inner(description.shapes[0].material.as_ref().expect("one")), MaterialDescription::None {}));
    assert_eq!(description.medium, None);
}

#[test]
fn the_camera_stands_in_what_is_around_everything_and_shapes_can_be_clear_of_it() {
    let description = clean(&format!(
        "{FOG} MediumInterface \"\" \"fog\" Camera \"perspective\" WorldBegin Material \"dielectric\" Shape \"sphere\""
    ))
    .description;
    assert_eq!(description.medium.as_deref(), Some("fog"));
    assert_eq!(description.shapes[0].interior.as_deref(), Some("clear"));
}

#[test]
fn a_uniform_grid_lies_inside_the_scene() {
    let imported = clean(
        "WorldBegin Translate 1 0 0 MakeNamedMedium \"smoke\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"integer ny\" 1
         \"integer nz\" 1 \"float density\" [0.5 2] \"point3 p0\" [-1 -1 -1] \"point3 p1\" [1 1 1]",
    );
    let MediumDescription::Grid { file, sigma_t, albedo, transform, .. } = &imported.description.media["smoke"] else {
        panic!("no grid");
    };
    assert_eq!((*sigma_t, *albedo), (Some(Color::grey(2.0)), Some(Color::grey(0.5))));
    assert_eq!(transform.0.transform_point3(glam::Vec3::ZERO), glam::Vec3::new(0.0, -1.0, -1.0));
    let data = crate::import::vol::read(file, &imported.embedded[file]).expect("a grid");
    assert_eq!((data.size, data.values), ([2, 1, 1], vec![0.5, 2.0]));
}

#[test]
fn faults_in_media_are_told() {
    for (text, word) in [
        ("MakeNamedMedium \"a\" \"float g\" 1", "'g'"),
        ("MakeNamedMedium \"a\" \"string type\" \"uniformgrid\" \"integer nx\" 3 \"float density\" [1 2]", "densities"),
        (
            "MakeNamedMedium \"a\" \"string type\" \"uniformgrid\" \"integer nx\" 2000000000 \"integer ny\" 2000000000 \"integer nz\" 2000000000",
            "densities",
        ),
        ("MakeNamedMedium \"a\" \"string type\" \"uniformgrid\" \"float density\" -1", "no density"),
    ] {
        let error = fault(text);
        assert!(error.to_string().contains(word), "{error}");
    }
}
