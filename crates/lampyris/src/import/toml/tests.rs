use super::*;
use crate::scene::description::*;
use proptest::prelude::*;

const CORNELL_BOX: &str = include_str!("../../../../../scenes/cornell-box/cornell-box.toml");
const AREA: &str = include_str!("../../../../../scenes/cornell-box/cornell-box-area.toml");
const TEN_LINES: &str = include_str!("../../../../../scenes/minimal/ten-lines.toml");

fn imported(text: &str) -> Imported {
    read_str(Path::new("s.toml"), text).unwrap_or_else(|error| panic!("{error}"))
}

fn scene(text: &str) -> SceneDescription {
    imported(text).description
}

/// Asserts the whole sentence with its place.
fn fails(text: &str, expected: &str) {
    let error = read_str(Path::new("s.toml"), text).expect_err("it must not be read");
    assert_eq!(error.to_string(), expected);
}

#[test]
fn the_cornell_box_is_that_of_the_course() {
    let scene = scene(CORNELL_BOX);
    let camera = scene.camera.expect("a camera");
    assert_eq!((camera.origin, camera.forward), ([0.0, 0.0, -3.5], Some([0.0, 0.0, 3.0])));
    assert_eq!(scene.film.size, [256, 256]);
    let planes = scene.shapes.iter().filter(|shape| matches!(shape.geometry, GeometryDescription::Plane { .. }));
    assert_eq!(planes.count(), 5);
    assert_eq!(
        scene.shapes[0].geometry,
        GeometryDescription::Plane { normal: [1.0, 0.0, 0.0], distance: 1.0 },
        "the left wall"
    );
    assert_eq!(
        scene.shapes[5].geometry,
        GeometryDescription::Sphere { center: [-0.5, -0.7, 0.25], radius: 0.3 },
        "the left ball"
    );
    let MaterialDescription::Coefficients { kd, ks, kt, .. } = scene.materials["blue-shiny"] else {
        panic!("the left ball mixes coefficients");
    };
    assert_eq!((kd, ks, kt), (Color([0.14, 0.28, 0.56]), Color::grey(0.3), Color::grey(0.0)));
    assert_eq!(
        scene.lights,
        [LightDescription::Point { position: [0.0, 0.5, 0.0], intensity: Some(Color::grey(1.0)), power: None }]
    );
}

#[test]
fn the_two_cornell_boxes_differ_only_in_their_lamp() {
    let (mut point, mut area) = (scene(CORNELL_BOX), scene(AREA));
    point.lights.clear();
    let lamp = area.shapes.pop().expect("the lamp comes last");
    assert_eq!(point, area);
    let GeometryDescription::Quad { u, v, .. } = lamp.geometry else { panic!("the lamp is a quad") };
    assert!(glam::Vec3::from(u).cross(v.into()).y < 0.0, "it faces down");
}

#[test]
fn the_ten_lines_are_ten() {
    assert_eq!(TEN_LINES.lines().count(), 10);
    assert_eq!(scene(TEN_LINES).shapes.len(), 4);
}

#[test]
fn an_integrator_without_type_is_auto() {
    let IntegratorDescription::Auto(settings) = scene("integrator.samples = 7").integrator else {
        panic!("auto is the default");
    };
    assert_eq!(settings.samples, 7);
}

#[test]
fn a_material_may_stand_in_place_and_nest() {
    let scene = scene("[[shapes]]\ntype='cube'\nmaterial={type='two-sided', front={type='glass', ior=2}, back='x'}");
    let Some(MaterialRef::Inline(material)) = &scene.shapes[0].material else { panic!("a material in place") };
    let MaterialDescription::TwoSided { front: MaterialRef::Inline(front), back } = &**material else {
        panic!("two sides");
    };
    assert!(matches!(**front, MaterialDescription::Glass { ior: Ior::Number(2.0), .. }));
    assert_eq!(*back, Some(MaterialRef::Named("x".into())));
}

#[test]
fn transforms_and_textures_are_read() {
    let scene = scene(
        "[[shapes]]\ntype='cube'\ntransform=[{scale=2}, {translate=[1,0,0]}]\n\
         [textures.floor]\ntype='bitmap'\nfile='floor.png'\nto-uv=[{scale=[4,4,1]}]",
    );
    let moved = scene.shapes[0].transform.0.transform_point3(glam::Vec3::ONE);
    assert_eq!(moved, glam::Vec3::new(3.0, 2.0, 2.0), "scaled first, then moved");
    assert!(
        matches!(&scene.textures["floor"], TextureDescription::Bitmap { file, raw: false, .. } if file == "floor.png")
    );
}

#[test]
fn every_key_has_its_place() {
    let text = "[camera]\norigin = [0, 0, 1]\n[materials.red]\ntype = 'glass'\nior = 1.3\n\
                [[shapes]]\ntype = 'cube'\n[[shapes]]\ntype = 'sphere'\nradius = 2\nemission.power = 3\n\
                [[lights]]\ntype = 'point'\nposition = [0, 0, 0]\npower = 'ä'\n";
    let text = text.replace("'ä'", "\"#ffffff\"");
    let imported = imported(&text);
    let place = |key: &str| {
        let place = imported.places.find(key).unwrap_or_else(|| panic!("{key} has a place"));
        (place.line, place.column, &text[place.span.clone()])
    };
    assert_eq!(place("camera"), (1, 1, "[camera]"));
    assert_eq!(place("camera.origin"), (2, 10, "[0, 0, 1]"));
    assert_eq!(place("camera.origin[2]"), (2, 10, "[0, 0, 1]"));
    assert_eq!(place("materials.red.ior"), (5, 7, "1.3"));
    assert_eq!(place("shapes[1]"), (8, 1, "[[shapes]]"));
    assert_eq!(place("shapes[1].radius"), (10, 10, "2"));
    assert_eq!(place("shapes[1].emission.power"), (11, 18, "3"));
    assert_eq!(place("lights[0].type"), (13, 8, "'point'"));
    assert_eq!(place("lights[0].power"), (15, 9, "\"#ffffff\""));
}

#[test]
fn an_unknown_key_proposes_the_near_one() {
    fails(
        "[[shapes]]\ntype = 'sphere'\n  radus = 2\n",
        "s.toml:3:3: unknown key 'radus' in sphere; did you mean 'radius'?",
    );
}

#[test]
fn an_unknown_key_far_from_all_lists_them() {
    fails("[film]\nzzz = 2\n", "s.toml:2:1: unknown key 'zzz' in film; the keys are filter, size and time");
}

#[test]
fn an_unknown_table_is_told_of_the_scene() {
    fails("[shape]\n", "s.toml:1:2: unknown key 'shape' in the scene; did you mean 'shapes'?");
}

#[test]
fn an_unknown_key_deep_in_a_material_keeps_its_place() {
    fails(
        "[[shapes]]\ntype='cube'\nmaterial={type='mask', material={type='glass', iors=2}}",
        "s.toml:3:48: unknown key 'iors' in glass; did you mean 'ior'?",
    );
}

#[test]
fn the_first_fault_of_the_file_is_told_first() {
    fails("[film]\nzzz = 2\naaa = 1\n", "s.toml:2:1: unknown key 'zzz' in film; the keys are filter, size and time");
}

#[test]
fn an_unknown_type_proposes_the_near_one() {
    fails("[[shapes]]\ntype = 'spere'\n", "s.toml:2:8: unknown shape type 'spere'; did you mean 'sphere'?");
}

#[test]
fn an_unknown_type_far_from_all_lists_them() {
    fails(
        "[[lights]]\ntype = 'zzz'\n",
        "s.toml:2:8: unknown light type 'zzz'; the types are point, spot, directional, constant, environment, sky, projector, beam and laser",
    );
}

#[test]
fn a_missing_type_lists_the_types() {
    fails(
        "[[shapes]]\nradius = 1\n",
        "s.toml:1:1: a shape without 'type'; \
         the types are plane, sphere, quad, disk, cylinder, cube, mesh and instance",
    );
}

#[test]
fn a_material_without_type_is_a_fault_of_the_material() {
    let error = read_str(Path::new("s.toml"), "materials.red = { reflectance = 1 }").expect_err("no type");
    assert!(error.to_string().starts_with("s.toml:1:17: a material without 'type'; the types are none, diffuse"));
}

#[test]
fn an_index_of_refraction_is_a_number_a_name_or_a_formula() {
    let read = |ior: &str| {
        let glass = format!("materials.clear = {{ type = 'glass', ior = {ior} }}\n");
        match scene(&glass).materials.remove("clear") {
            Some(MaterialDescription::Glass { ior, .. }) => ior,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(read("2"), Ior::Number(2.0));
    assert_eq!(read("'sf11'"), Ior::Substance("sf11".into()));
    assert_eq!(read("{ cauchy = [1.5, 0.004] }"), Ior::Formula(IorFormula::Cauchy([1.5, 0.004])));
    let terms = [1.0, 0.2, 1.0, 0.006, 0.02, 100.0];
    assert_eq!(read("{ sellmeier = [1, 0.2, 1, 0.006, 0.02, 100] }"), Ior::Formula(IorFormula::Sellmeier(terms)));
    let fault = |ior: &str, expected: &str| {
        fails(&format!("[materials.a]\ntype = 'glass'\nior = {ior}\n"), &format!("s.toml:3:{expected}"));
    };
    let formulas = "a table with one of the keys 'sellmeier', 'cauchy' or 'abbe'";
    fault("true", &format!("7: 'ior' must be a number, the name of a substance, or {formulas}, not true"));
    fault("{ cauhcy = [1, 2] }", "9: unknown key 'cauhcy' in ior; did you mean 'cauchy'?");
    fault("{ abbe = [1.5] }", "16: 'abbe' must be a list of 2 numbers, not 1");
}

#[test]
fn a_missing_key_is_named_with_all_that_are_needed() {
    fails(
        "\n[[shapes]]\ntype = 'quad'\ncorner = [0, 0, 0]\nu = [1, 0, 0]\n",
        "s.toml:2:1: missing key 'v' in quad; a quad needs 'corner', 'u' and 'v'",
    );
}

#[test]
fn a_wrong_value_is_told_in_the_words_of_a_user() {
    let sphere = "[[shapes]]\ntype='sphere'\n";
    let cases = [
        ("radius = 'big'", "3:10: 'radius' must be a number, not the text \"big\""),
        ("radius = true", "3:10: 'radius' must be a number, not true"),
        ("radius = nan", "3:10: 'radius' must be a number, not nan"),
        ("radius = 1e99", "3:10: 'radius' must be a number, not 1e99"),
        ("center = [0, 1]", "3:10: 'center' must be a list of 3 numbers, not 2"),
        ("center = [0, 1, 'z']", "3:17: 'center[2]' must be a number, not the text \"z\""),
        ("center = 3", "3:10: 'center' must be a list of 3 numbers, not 3"),
        ("center = 2020-01-01", "3:10: 'center' must be a list of 3 numbers, not a date"),
        ("flip-normal = 1", "3:15: 'flip-normal' must be true or false, not 1"),
        ("name = 3", "3:8: 'name' must be a text, not 3"),
        ("material = 3", "3:12: 'material' must be the name of a material or a material in place, not 3"),
        (
            "emission = { power = '#12' }",
            "3:22: 'power' must be a number, three numbers, or \"#rrggbb\", not the text \"#12\"",
        ),
        ("emission = 4", "3:12: 'emission' must be a table, not 4"),
        (
            "transform = [{ spin = 3 }]",
            "3:16: unknown key 'spin' in transform[0]; the keys are translate, scale, rotate and matrix",
        ),
        (
            "transform = [{ scale = '#ffffff' }]",
            "3:24: 'scale' must be a number or three numbers, not the text \"#ffffff\"",
        ),
        (
            "transform = [{ scale = 3, translate = [0, 0, 0] }]",
            "3:14: 'transform[0]' must have one key, not 2; it is one of translate, scale, rotate or matrix",
        ),
        (
            "transform = [{ rotate = { axis = [0, 0, 0], degrees = 3 } }]",
            "3:13: the axis of a rotation must not be zero",
        ),
        ("type = 3", "3:1: duplicate key"),
    ];
    for (line, expected) in cases {
        fails(&format!("{sphere}{line}\n"), &format!("s.toml:{expected}"));
    }
}

#[test]
fn whole_numbers_and_words_are_told_with_their_choice() {
    fails("[integrator]\nsamples = -3\n", "s.toml:2:11: 'samples' must be a whole number from 0 to 4294967295, not -3");
    fails(
        "[integrator]\nphotons = 1e6\n",
        "s.toml:2:11: 'photons' must be a whole number from 0 to 4294967295, not 1e6; write it as 1000000",
    );
    fails(
        "[integrator]\ntype = 'photon-map'\ndirect = 'photon'\n",
        "s.toml:3:10: 'direct' must be 'next-event' or 'photons', not 'photon'; did you mean 'photons'?",
    );
}

#[test]
fn a_list_of_tables_with_one_bracket_too_few_is_explained() {
    fails(
        "[shapes]\ntype = 'cube'\n",
        "s.toml:1:1: 'shapes' must be a list, not a table; write [[shapes]] with two brackets",
    );
}

#[test]
fn a_seed_may_have_all_of_its_64_bits() {
    assert_eq!(scene("render.seed = 18446744073709551615").render.seed, u64::MAX);
}

#[test]
fn a_syntax_error_has_its_place() {
    fails("[camera]\norigin = [0,,1]\n", "s.toml:2:13: extra comma in array, expected value");
    fails("a = ", "s.toml:1:5: a value is missing here, or a text without quotes");
    fails("[camera\n", "s.toml:1:8: unclosed table, expected `]`");
}

#[test]
fn an_empty_file_says_what_a_scene_needs() {
    for text in ["", "\n \n", "# nothing\n"] {
        let error = read_str(Path::new("s.toml"), text).expect_err("nothing in it");
        assert!(error.to_string().starts_with("s.toml: the scene file is empty; a scene needs a [camera]"), "{error}");
    }
}

#[test]
fn bytes_that_are_not_text_have_a_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.toml");
    std::fs::write(&path, b"[camera]\norigin = \xff\n").expect("a file");
    let error = read(&path).expect_err("not UTF-8");
    assert_eq!(error.message, "byte 18 of the file (0xff) is not UTF-8 text");
    assert_eq!(error.place.map(|place| (place.line, place.column)), Some((2, 10)));
}

#[test]
fn deep_nesting_is_an_error_and_not_the_end_of_the_stack() {
    let deep = format!("materials.{}type = 'glass'", "front.".repeat(100_000));
    read_str(Path::new("s.toml"), &deep).expect_err("too deep");
    let deep = format!("camera = {}{}", "[".repeat(100_000), "]".repeat(100_000));
    read_str(Path::new("s.toml"), &deep).expect_err("too deep");
}

#[test]
fn many_values_in_one_line_are_read_in_one_walk() {
    let materials: Vec<String> = (0..20_000).map(|i| format!("m{i}={{type='glass',ior=2}}")).collect();
    let imported = imported(&format!("materials={{{}}}", materials.join(",")));
    assert!(imported.places.find("materials.m19999.ior").is_some_and(|place| place.column > 400_000));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, rng_seed: proptest::test_runner::RngSeed::Fixed(5), ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_text_never_panics(text in "\\PC{0,80}") {
        let _ = read_str(Path::new("s.toml"), &text);
    }

    /// Cuts a piece out of the Cornell box and puts another in its place.
    #[test]
    fn a_damaged_cornell_box_never_panics(
        at in 0..CORNELL_BOX.len(),
        length in 0_usize..40,
        piece in prop_oneof![
            "[\\[\\]{}=\",.'0-9a-z\\n -]{0,12}",
            prop::sample::select(vec!["type", "\"path\"", "radius = ", "[[shapes]]\n", "{", "nan", "-1", "[[[", "ä"])
                .prop_map(String::from),
        ],
    ) {
        let floor = |at: usize| (0..=at.min(CORNELL_BOX.len())).rev().find(|&i| CORNELL_BOX.is_char_boundary(i)).unwrap_or(0);
        let text = format!("{}{piece}{}", &CORNELL_BOX[..floor(at)], &CORNELL_BOX[floor(at + length)..]);
        if let Err(error) = read_str(Path::new("s.toml"), &text) {
            prop_assert!(error.place.is_some() || error.file.is_some(), "no place: {error}");
        }
    }
}
