//! Files that ask for more than they give. Where one of them were read in time that grows with the square of its length,
//! its test would not end.

use super::*;
use crate::scene::description::GeometryDescription;

#[test]
fn of_very_many_warnings_a_thousand_are_told() {
    for text in ["a ".repeat(300_000), "\"float a\" 1 ".repeat(100_000)] {
        let imported = scene(&format!("Shape \"sphere\" {text}")).expect("nothing but warnings");
        assert!(imported.warnings.len() <= 1001);
    }
}

#[test]
fn attributes_do_not_pile_up() {
    let again = "Attribute \"shape\" \"float radius\" 2 Shape \"sphere\" ".repeat(1000);
    assert_eq!(clean(&again).description.shapes.len(), 1000);
    let many: String = (0..1000).map(|number| format!("Attribute \"shape\" \"float r{number}\" 2 ")).collect();
    let error = fault(&many);
    assert!(error.message.contains("too many parameters are set by 'Attribute'") && error.place.is_some(), "{error}");
}

#[test]
fn a_file_that_is_included_again_and_again_is_refused() {
    let part = " ".repeat(1 << 20);
    let main = "Include \"b.pbrt\"\n".repeat(1000);
    let error = read_files(&[("a.pbrt", main.as_bytes()), ("b.pbrt", part.as_bytes())]).expect_err("too often");
    assert!(error.message.contains("too many files are included") && error.place.is_some(), "{error}");
}

#[test]
fn all_meshes_of_a_file_share_what_subdivision_may_make() {
    let mesh =
        "Shape \"loopsubdiv\" \"integer levels\" 9 \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n";
    let imported = scene(&mesh.repeat(20)).expect("with warnings");
    let triangles = imported.description.shapes.iter().map(|shape| match &shape.geometry {
        GeometryDescription::Triangles(mesh) => mesh.triangles.len(),
        _ => 0,
    });
    assert!(triangles.sum::<usize>() <= (1 << 21) + 20);
    assert!(messages(&imported).iter().all(|message| message.contains("levels of subdivision are done")));
    assert!(!imported.warnings.is_empty());
}

#[test]
fn names_of_scaled_textures_are_found_at_once() {
    let scaled: String = (1..20_000)
        .map(|number| {
            format!(
                "Texture \"s{number}\" \"spectrum\" \"scale\" \"texture tex\" \"a\" \"float scale\" {}\n\
            Material \"diffuse\" \"texture reflectance\" \"s{number}\" Shape \"sphere\"\n",
                1.0 / number as f32
            )
        })
        .collect();
    let text = format!("Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" {scaled}");
    assert!(scene(&text).expect("valid").description.textures.len() > 10_000);
}

#[test]
fn instances_of_very_many_unknown_objects_are_left_out() {
    let objects: String = (0..20_000)
        .map(|number| format!("ObjectBegin \"a{number}\" Shape \"sphere\" ObjectEnd ObjectInstance \"b{number}\"\n"))
        .collect();
    let imported = scene(&objects).expect("with warnings");
    assert_eq!((imported.description.shapes.len(), imported.warnings.len()), (0, 1001));
}
