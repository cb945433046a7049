//! What real files hold that a strict reader would refuse; counted in public repositories.

use super::*;
use crate::scene::description::{GeometryDescription, IntegratorDescription};

/// Reads content that is taken with this many warnings.
fn taken(content: &str, warnings: usize) -> Imported {
    let imported = scene(content).expect("it is taken");
    assert_eq!(imported.warnings.len(), warnings, "{:#?}", messages(&imported));
    imported
}

#[test]
fn unknown_integrators_leave_their_depth() {
    for plugin in [
        "path_guiding_integrator",
        "path_sms_ss",
        "path_filtered_ss",
        "vcm",
        "bdpt",
        "transient_path",
        "manylights",
        "lpm",
    ] {
        let content = format!(
            "<integrator type='{plugin}'><integer name='max_depth' value='7'/><boolean name='caustic_bounces' value='true'/></integrator>"
        );
        let imported = taken(&content, 1);
        let IntegratorDescription::Auto(path) = imported.description.integrator else { panic!("no path tracer") };
        assert_eq!(path.max_bounces, 6, "{plugin}");
    }
}

#[test]
fn unknown_attributes_are_passed_over_with_a_word() {
    taken("<sensor type='perspective'><float name='caustic_blur' value='1'/></sensor>", 1);
    taken("<shape type='sphere'><bsdf type='dielectric'><float name='extEta' value='1'/></bsdf></shape>", 1);
    taken("<shape type='sphere'><bsdf type='conductor'><float name='alpha' value='0.1'/></bsdf></shape>", 1);
    taken("<emitter type='sunsky'><float name='sunRadiusScale' value='1'/></emitter>", 1);
    taken(
        "<shape type='sphere'><bsdf type='normalmap'><boolean name='use_slopes' value='true'/><string name='filename' value='n.png'/><bsdf type='diffuse'/></bsdf></shape>",
        1,
    );
}

#[test]
fn what_films_say_of_their_files_does_not_matter() {
    for film in [
        "<film type='ldrfilm'><string name='fileFormat' value='png'/><float name='gamma' value='2.2'/><boolean name='banner' value='false'/></film>",
        "<film type='hdrfilm'><string name='fileFormat' value='png'/><boolean name='highQualityEdges' value='true'/><string name='pixelFormat' value='rgb'/></film>",
    ] {
        let text = format!("<scene version='0.6.0'><sensor type='perspective'>{film}</sensor></scene>");
        let imported = read_files(&[("a.xml", &text)], &[]).expect("valid");
        assert_eq!(messages(&imported), Vec::<String>::new());
    }
}

#[test]
fn look_at_is_spelt_in_three_ways() {
    for step in ["lookat", "lookAt", "look_at"] {
        let content = format!(
            "<sensor type='perspective'><transform name='to_world'><{step} origin='0, 0 5' target='0 0 0' up    =' 0 1 0 '/></transform></sensor>"
        );
        assert_eq!(clean(&content).description.camera.expect("one").origin, [0.0, 0.0, 5.0]);
    }
}

#[test]
fn steps_of_a_transform_may_give_one_value() {
    let sphere = shape(
        "type='sphere'><transform name='to_world'><scale value='2'/><rotate value='0 0 1' angle='90'/><translate value='1 2 3'/></transform>",
    );
    assert!(matches!(sphere.geometry, GeometryDescription::Sphere { center: [1.0, 2.0, 3.0], radius: 2.0 }));
}

#[test]
fn numbers_may_have_exponents_of_three_digits_and_odd_spacing() {
    let sphere = shape(
        "type='sphere'><float name='radius' value=' 2.5e+000 '/><point name='center' x='-2.81996e-008' y='1.' z='.5'/>",
    );
    assert!(matches!(sphere.geometry, GeometryDescription::Sphere { center: [_, 1.0, 0.5], radius: 2.5 }));
}

#[test]
fn shapes_may_be_written_in_capitals() {
    assert!(matches!(shape("type='Sphere'>").geometry, GeometryDescription::Sphere { .. }));
    assert!(matches!(shape("type='Rectangle'>").geometry, GeometryDescription::Quad { .. }));
}

#[test]
fn curves_and_grids_are_left_out() {
    for plugin in ["bsplinecurve", "linearcurve", "hair", "sdfgrid"] {
        let shape = format!("<shape type='{plugin}'><string name='filename' value='x'/></shape>");
        assert!(taken(&shape, 1).description.shapes.is_empty());
    }
}

#[test]
fn of_several_materials_of_a_mesh_the_first_is_used() {
    let bsdfs = "<bsdf type='dielectric' name='a'/><bsdf type='diffuse' name='b'/>";
    let imported = taken(&format!("<shape type='obj'><string name='filename' value='m.obj'/>{bsdfs}</shape>"), 1);
    let material = imported.description.shapes[0].material.as_ref().expect("one");
    assert!(matches!(inner(material), MaterialDescription::Glass { .. }));
}

#[test]
fn an_angle_of_smoothing_is_warned_of() {
    let mesh =
        "<shape type='obj'><string name='filename' value='m.obj'/><float name='max_smooth_angle' value='30'/></shape>";
    assert!(messages(&taken(mesh, 1))[0].contains("max_smooth_angle"));
}

#[test]
fn a_parameter_may_stand_for_a_plugin() {
    let text =
        "<scene version='3.0.0'><default name='integrator' value='direct'/><integrator type='$integrator'/></scene>";
    let with = |defines: &[_]| read_files(&[("a.xml", text)], defines).expect("valid").description.integrator;
    assert!(matches!(with(&[]), IntegratorDescription::Auto(path) if path.max_bounces == 1));
    assert!(matches!(with(&[("integrator", "ptracer")]), IntegratorDescription::Light(_)));
}

#[test]
fn a_medium_of_an_unknown_kind_is_left_out_with_one_word_for_each_shape() {
    let medium = "<medium type='smoke' id='fog'><float name='scale' value='2'/></medium>";
    let imported =
        taken(&format!("{medium}<shape type='cube'><ref name='interior' id='fog'/><bsdf type='null'/></shape>"), 1);
    assert!(messages(&imported)[0].contains("medium 'smoke'"));
}
