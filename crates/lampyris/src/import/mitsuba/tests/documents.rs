use super::*;
use crate::scene::description::{GeometryDescription, Ior};

fn size(imported: &Imported) -> [u32; 2] {
    imported.description.film.size
}

const SENSOR: &str =
    r#"<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="$res"/></film></sensor>"#;

#[test]
fn a_parameter_has_its_default_unless_it_is_defined() {
    let text = format!("<scene version='3.0.0'><default name='res' value='99'/>{SENSOR}</scene>");
    let read = |defines: &[_]| size(&read_files(&[("a.xml", &text)], defines).expect("valid"))[0];
    assert_eq!(read(&[]), 99);
    assert_eq!(read(&[("res", "7")]), 7);
}

#[test]
fn a_parameter_without_a_value_is_named_with_its_place_and_the_option() {
    let error = fault(SENSOR);
    assert!(error.to_string().starts_with("a.xml:2:"), "{error}");
    assert!(error.message.contains("'$res'"), "{error}");
    assert!(error.hint.expect("a hint").contains("--define res=value"));
}

#[test]
fn a_known_name_is_replaced_inside_a_longer_word() {
    let imported = clean("<default name='n' value='1'/><shape type='sphere' id='$n_x'/>");
    assert_eq!(imported.description.shapes[0].name.as_deref(), Some("1_x"));
}

#[test]
fn a_definition_that_nothing_uses_is_a_warning() {
    let imported = read_files(&[("a.xml", "<scene version='3.0.0'/>")], &[("nope", "1")]).expect("valid");
    assert!(messages(&imported)[0].contains("'$nope'"));
}

#[test]
fn parameters_cannot_grow_without_end() {
    let mut text = String::from("<default name='a0' value='0123456789'/>");
    for step in 1..60 {
        let before = step - 1;
        text.push_str(&format!("<default name='a{step}' value='$a{before} $a{before}'/>"));
    }
    assert!(fault(&text).message.contains("too long"));
}

#[test]
fn an_included_file_brings_its_objects_and_parameters() {
    let files = [
        (
            "a.xml",
            "<scene version='3.0.0'><include filename='sub/b.xml'/><shape type='sphere'><float name='radius' value='$r'/></shape></scene>",
        ),
        (
            "sub/b.xml",
            "<scene version='3.0.0'><default name='r' value='2'/><shape type='ply'><string name='filename' value='c.ply'/></shape></scene>",
        ),
        ("sub/c.ply", ""),
    ];
    let imported = read_files(&files, &[]).expect("valid");
    let shapes = &imported.description.shapes;
    assert!(matches!(&shapes[0].geometry, GeometryDescription::Mesh { file, .. } if file == "sub/c.ply"));
    assert!(matches!(shapes[1].geometry, GeometryDescription::Sphere { radius: 2.0, .. }));
    assert_eq!(imported.places.find("shapes[0]").expect("noted").file, Path::new("sub/b.xml"));
}

#[test]
fn a_file_is_looked_for_in_the_folders_of_path_and_beside_the_scene() {
    let files = [
        ("a.xml", "<scene version='3.0.0'><path value='../common'/><include filename='sub/b.xml'/></scene>"),
        (
            "sub/b.xml",
            "<scene version='3.0.0'><shape type='obj'><string name='filename' value='x.obj'/></shape><shape type='obj'><string name='filename' value='m\\y.obj'/></shape></scene>",
        ),
        ("../common/x.obj", ""),
        ("m/y.obj", ""),
    ];
    let imported = read_files(&files, &[]).expect("valid");
    let file = |index: usize| match &imported.description.shapes[index].geometry {
        GeometryDescription::Mesh { file, .. } => file.clone(),
        other => panic!("{other:?} is no mesh"),
    };
    assert_eq!((file(0).as_str(), file(1).as_str()), ("../common/x.obj", "m/y.obj"));
}

#[test]
fn a_missing_include_and_a_cycle_are_errors_at_the_include() {
    let error = fault("<include filename='b.xml'/>");
    assert!(error.to_string().starts_with("a.xml:2:20: cannot read 'b.xml'"), "{error}");
    let error = fault("<include filename='a.xml'/>");
    assert!(error.message.contains("includes itself"), "{error}");
}

#[test]
fn references_reach_forward_and_through_an_alias() {
    let imported = clean(
        "<shape type='sphere'><ref id='m'/></shape><bsdf type='dielectric' id='m'/>
         <alias id='m' as='n'/><shape type='sphere'><ref id='n'/></shape>",
    );
    let named = Some(MaterialRef::Named("m".to_string()));
    assert_eq!(imported.description.shapes[0].material, named);
    assert_eq!(imported.description.shapes[1].material, named);
    assert_eq!(imported.description.materials.len(), 1);
}

#[test]
fn an_unknown_id_is_an_error_with_the_nearest_one() {
    let error = fault("<bsdf type='diffuse' id='marble'/><shape type='sphere'><ref id='marbel'/></shape>");
    assert_eq!(error.hint.as_deref(), Some("did you mean 'marble'?"));
    assert_eq!(error.place.expect("a place").line, 2);
}

#[test]
fn an_id_stands_for_one_object() {
    assert!(fault("<bsdf type='diffuse' id='x'/><bsdf type='diffuse' id='x'/>").message.contains("'x'"));
}

#[test]
fn a_wrong_number_is_an_error_at_its_line_and_column() {
    let error = fault("<shape type='sphere'>\n <float name='radius' value='1.x'/></shape>");
    assert_eq!(error.to_string(), "a.xml:3:30: '1.x' is not a number");
    let error = fault("<shape type='sphere'><float name='radius' value='1e99'/></shape>");
    assert!(error.message.contains("too large"));
}

#[test]
fn a_value_of_the_wrong_sort_is_an_error_that_says_which_is_right() {
    let error = fault("<shape type='sphere'><string name='radius' value='1'/></shape>");
    assert!(error.message.contains("must be a float, not a string"), "{error}");
}

#[test]
fn numbers_may_be_written_in_many_ways() {
    let imported = clean(
        "<shape type='sphere'><transform name='to_world'><matrix value='1,0 0\t1.5e+000
          0 1 0, 0  -2.81996e-008 0 1 0 0 0 0 1'/></transform></shape>",
    );
    let GeometryDescription::Sphere { center, .. } = imported.description.shapes[0].geometry else {
        panic!("not a sphere")
    };
    assert_eq!(center, [1.5, 0.0, 0.0]);
}

#[test]
fn dashes_in_comments_are_taken_and_places_stay_right() {
    let error = fault("<!-- ü -- <shape> --->\n<shape type='sphere'><float name='radius' value='x'/></shape>");
    assert_eq!(error.place.map(|place| (place.line, place.column)), Some((3, 50)));
}

#[test]
fn a_byte_order_mark_is_taken() {
    read_files(&[("a.xml", "\u{feff}<?xml version='1.0' encoding='utf-8'?><scene version='3.0.0'/>")], &[])
        .expect("valid");
}

#[test]
fn text_in_another_encoding_is_refused_at_its_place() {
    let read = |bytes: &[u8]| {
        let files = HashMap::from([(PathBuf::from("a.xml"), bytes.to_vec())]);
        read_from(&Memory(files), Path::new("a.xml"), &Options::default()).expect_err("wrong").to_string()
    };
    assert!(read(b"<scene>\n \xe4").starts_with("a.xml:2:2: this is not UTF-8"));
    assert!(read(b"\xff\xfe<\0").contains("UTF-16"));
}

#[test]
fn broken_xml_is_an_error_at_its_place() {
    let error = fault("<shape type='sphere'></bsdf>");
    assert!(error.message.starts_with("this is not well-formed XML"), "{error}");
    assert_eq!(error.place.expect("a place").line, 2);
}

#[test]
fn entities_are_refused() {
    let text = "<!DOCTYPE a [<!ENTITY b 'c'>]><scene version='3.0.0'>&b;</scene>";
    let error = read_files(&[("a.xml", text)], &[]).expect_err("wrong");
    assert!(error.message.contains("document type"), "{error}");
}

#[test]
fn deep_nesting_is_refused() {
    let open = "<bsdf type='twosided'>".repeat(50_000);
    let close = "</bsdf>".repeat(50_000);
    assert!(fault(&format!("{open}{close}")).message.contains("too deep"));
}

#[test]
fn a_material_that_contains_itself_is_refused() {
    let error = fault("<bsdf type='twosided' id='a'><ref id='a'/></bsdf>");
    assert!(error.message.contains("contains itself"), "{error}");
    let error = fault("<integrator type='moment' id='a'><ref id='a'/></integrator>");
    assert!(error.message.contains("contains itself"), "{error}");
}

#[test]
fn a_net_of_materials_cannot_grow_without_end() {
    let mut text = String::from("<bsdf type='diffuse' id='a0'/>");
    for step in 1..16 {
        let parts = format!("<ref id='a{}'/>", step - 1).repeat(8);
        text.push_str(&format!(
            "<bsdf type='mixturebsdf' id='a{step}'><string name='weights' value='1 1 1 1 1 1 1 1'/>{parts}</bsdf>"
        ));
    }
    assert!(fault(&text).message.contains("nested too deeply"));
}

#[test]
fn another_root_or_version_is_refused() {
    let error = read_files(&[("a.xml", "<bsdf type='diffuse'/>")], &[]).expect_err("wrong");
    assert!(error.message.contains("must hold a <scene>"));
    let error = read_files(&[("a.xml", "<scene version='x'/>")], &[]).expect_err("wrong");
    assert!(error.message.contains("version"));
    let imported = read_files(&[("a.xml", "<scene/>")], &[]).expect("valid");
    assert!(messages(&imported)[0].contains("no version"));
}

#[test]
fn names_of_the_old_version_are_in_camel_case() {
    let content = "<shape type='obj'><string name='filename' value='a.obj'/><boolean name='faceNormals' value='true'/>
        <transform name='toWorld'><translate x='1'/></transform>
        <bsdf type='dielectric'><float name='intIOR' value='1.7'/></bsdf></shape>";
    let imported = read_files(&[("a.xml", &format!("<scene version='0.6.0'>{content}</scene>"))], &[]).expect("valid");
    assert_eq!(messages(&imported), Vec::<String>::new());
    let shape = &imported.description.shapes[0];
    assert!(matches!(shape.geometry, GeometryDescription::Mesh { face_normals: true, .. }));
    assert_eq!(shape.transform.0.w_axis.x, 1.0);
    assert!(matches!(
        inner(shape.material.as_ref().expect("glass")),
        MaterialDescription::Glass { ior: Ior::Number(1.7), .. }
    ));
    // In version 3 they are not known.
    assert_eq!(scene(content).expect("valid").warnings.len(), 3);
}

#[test]
fn what_nobody_knows_is_a_warning_with_its_place() {
    let imported = scene(
        "<shape type='sphere'>\n<float name='wobble' value='1'/><medium type='fog' name='interior'/></shape>\n<thing/>",
    )
    .expect("valid");
    let found = messages(&imported);
    assert!(
        found.contains(&"a.xml:3:29: 'wobble' of shape 'sphere' is not known and is ignored".to_string()),
        "{found:?}"
    );
    assert!(found.iter().any(|message| message.contains("medium 'fog' is not supported: it is left out")), "{found:?}");
    assert!(found.iter().any(|message| message.contains("<thing> in the scene is left out")), "{found:?}");
}
