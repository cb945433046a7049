//! Syntax, files in files, and the graphics state.

use std::io::Write;

use super::*;
use crate::scene::description::GeometryDescription;

fn center(shape: &ShapeDescription) -> [f32; 3] {
    match shape.geometry {
        GeometryDescription::Sphere { center, .. } => center.map(|x| (x * 1e4).round() / 1e4),
        _ => panic!("a sphere"),
    }
}

#[test]
fn an_error_names_file_line_and_column() {
    let error = fault("WorldBegin\n  Shape \"sphere\" \"float radius\" [ x ]");
    assert_eq!(
        error.to_string(),
        "a.pbrt:2:35: a number must stand here, not 'x'; is a bracket, a quote or a number missing before this?"
    );
}

#[test]
fn broken_syntax_is_told_in_one_sentence() {
    for (text, words) in [
        ("Shape", "Shape needs a name in quotes"),
        ("Shape sphere", "but 'sphere' stands here"),
        ("Translate 1 2", "Translate needs 3 numbers, but the file ends"),
        ("Translate [1 2 3 4]", "Translate needs a closing bracket, but '4' stands here"),
        ("Shape \"sphere\" \"radius\" 1", "'radius' declares no parameter"),
        ("Shape \"sphere\" \"float radius\"", "'radius' has no value"),
        ("Shape \"sphere\" \"float radius\" [1", "no closing bracket"),
        ("Shape \"sphere\" \"float radius\" [1 \"a\"]", "of different sorts"),
        ("Shape \"sphere\" \"float radius\" [1 2]", "must be one number"),
        ("Shape \"sphere\" \"float radius\" 1e99", "not a finite number or too large"),
        ("Shape \"sphe\nre\"", "no closing quote"),
        ("3 Shape \"sphere\"", "a statement such as Shape must stand here, not '3'"),
        ("\"float radius\" 3", "not \"float radius\""),
        ("Rotate 3 0 0 0", "axis of a rotation"),
        ("LookAt 0 0 0 0 0 1 0 0 1", "LookAt does not say where to look"),
        ("AttributeEnd", "AttributeEnd has no AttributeBegin"),
        ("AttributeBegin TransformEnd", "opened by AttributeBegin"),
    ] {
        let error = fault(text);
        assert!(error.message.contains(words), "{text}: {error}");
        assert!(error.place.is_some(), "{text}: {error}");
    }
}

#[test]
fn unknown_statements_and_parameters_are_told_with_what_may_be_meant() {
    let imported = scene("Shpae \"sphere\" \"float radius\" [1]\nShape \"sphere\" \"float radiu\" 2").expect("valid");
    assert_eq!(imported.description.shapes.len(), 1);
    assert_eq!(
        messages(&imported),
        [
            "a.pbrt:1:1: 'Shpae' is no statement of pbrt and is passed over; did you mean Shape?",
            "a.pbrt:2:17: 'radiu' of Shape 'sphere' is not known and is ignored; did you mean 'radius'?"
        ]
    );
}

#[test]
fn comments_numbers_and_brackets_may_be_written_as_people_do() {
    let text =
        "\u{feff}# a comment \"\nShape\"sphere\"\"float radius\"[.5]# end\nTranslate 1. -2e0 +3 Shape \"sphere\"";
    let shapes = clean(text).description.shapes;
    assert_eq!(center(&shapes[1]), [1.0, -2.0, 3.0]);
}

#[test]
fn transforms_compose_from_right_to_left_and_end_with_their_block() {
    let text =
        "AttributeBegin Translate 1 0 0 Rotate 90 0 0 1 Scale 2 2 2 Translate 1 0 0 Shape \"sphere\" AttributeEnd
        Transform [1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1] ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 1 1 1 1]
        CoordinateSystem \"here\" Identity Shape \"sphere\" CoordSysTransform \"here\" Shape \"sphere\"
        TransformBegin Translate 1 1 1 ReverseOrientation TransformEnd Shape \"sphere\"";
    let shapes = clean(text).description.shapes;
    let centers: Vec<_> = shapes.iter().map(center).collect();
    assert_eq!(centers, [[1.0, 2.0, 0.0], [0.0; 3], [6.0, 7.0, 8.0], [6.0, 7.0, 8.0]]);
    assert!(shapes[3].flip_normal && !shapes[2].flip_normal);
}

#[test]
fn attributes_hold_for_what_follows_and_own_parameters_win() {
    let text =
        "AttributeBegin Attribute \"shape\" \"float radius\" 3 Shape \"sphere\" Shape \"sphere\" \"float radius\" 2
        AttributeEnd Shape \"sphere\"";
    let radius = |shape: &ShapeDescription| match shape.geometry {
        GeometryDescription::Sphere { radius, .. } => radius,
        _ => 0.0,
    };
    let radii: Vec<f32> = clean(text).description.shapes.iter().map(radius).collect();
    assert_eq!(radii, [3.0, 2.0, 1.0]);
}

#[test]
fn an_include_goes_on_in_the_same_state_and_an_import_in_its_own() {
    let inside: &[u8] = b"Translate 1 0 0 Shape \"sphere\"";
    let main: &[u8] = b"Include \"sub/b.pbrt\" Import \"sub/b.pbrt\" Shape \"sphere\"";
    let shapes = read_files(&[("a.pbrt", main), ("sub/b.pbrt", inside)]).expect("valid").description.shapes;
    let places: Vec<f32> = shapes.iter().map(|shape| center(shape)[0]).collect();
    assert_eq!(places, [1.0, 2.0, 1.0]);
}

#[test]
fn an_include_may_be_packed() {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(b"Shape \"sphere\"").expect("memory");
    let packed = packed.finish().expect("memory");
    let imported = read_files(&[("a.pbrt", b"Include \"b.pbrt.gz\""), ("b.pbrt.gz", &packed)]).expect("valid");
    assert_eq!(imported.description.shapes.len(), 1);
}

#[test]
fn circles_of_includes_and_missing_ones_are_refused_with_their_place() {
    let error =
        read_files(&[("a.pbrt", b"Include \"b.pbrt\""), ("b.pbrt", b"\nInclude \"a.pbrt\"")]).expect_err("a circle");
    assert_eq!(error.to_string(), "b.pbrt:2:1: 'a.pbrt' includes itself");
    let error = fault("Include \"b.pbrt\"");
    assert_eq!(error.to_string(), "a.pbrt:1:1: cannot read 'b.pbrt': no such file or folder");
}

#[test]
fn includes_that_double_at_each_level_end() {
    let names: Vec<String> = (0..30).map(|number| format!("{number}.pbrt")).collect();
    let texts: Vec<String> = (1..=30).map(|next| format!("Include \"{next}.pbrt\" Include \"{next}.pbrt\"")).collect();
    let mut files: Vec<(&str, &[u8])> =
        names.iter().zip(&texts).map(|(name, text)| (name.as_str(), text.as_bytes())).collect();
    files.push(("30.pbrt", b""));
    assert!(read_files(&files).expect_err("too many").message.contains("too many files"));
}

#[test]
fn an_object_stands_where_its_instances_put_it() {
    let text = "ObjectBegin \"o\" Translate 0 1 0 Shape \"sphere\" ObjectEnd Translate 2 0 0 ObjectInstance \"o\"";
    let description = clean(text).description;
    assert_eq!(center(&description.groups["o"][0]), [0.0, 1.0, 0.0]);
    let [instance] = &description.shapes[..] else { panic!("one instance") };
    assert_eq!(instance.geometry, GeometryDescription::Instance { group: "o".into() });
    assert_eq!(instance.transform.0.w_axis.truncate().to_array(), [2.0, 0.0, 0.0]);
}

#[test]
fn instances_of_nothing_are_left_out_and_objects_do_not_shine() {
    let text = "ObjectBegin \"empty\" ObjectEnd ObjectInstance \"empty\" ObjectInstance \"emptie\"
        ObjectBegin \"lamp\" AreaLightSource \"diffuse\" Shape \"sphere\" ObjectEnd ObjectInstance \"lamp\"";
    let imported = scene(text).expect("valid");
    assert_eq!(imported.description.shapes.len(), 1);
    assert!(imported.description.groups["lamp"][0].emission.is_none());
    let messages = messages(&imported);
    assert!(messages[0].contains("there is no object 'emptie': this instance is left out; did you mean 'empty'?"));
    assert!(messages[1].contains("cannot emit light"));
    assert!(fault("ObjectBegin \"a\" ObjectBegin \"b\"").message.contains("inside another"));
}

#[test]
fn clouds_and_motion_are_said_to_be_missing_once() {
    let text =
        "MakeNamedMedium \"fog\" \"string type\" \"nanovdb\" MediumInterface \"fog\" \"\" MediumInterface \"fog\"
        ActiveTransform EndTime Translate 9 9 9 ActiveTransform All Shape \"sphere\"";
    let imported = scene(text).expect("valid");
    assert_eq!(center(&imported.description.shapes[0]), [0.0; 3]);
    let messages = messages(&imported);
    assert_eq!(messages.len(), 2, "{messages:?}");
    assert!(messages[0].contains("medium 'nanovdb' is not supported") && messages[1].contains("motion"));
}
