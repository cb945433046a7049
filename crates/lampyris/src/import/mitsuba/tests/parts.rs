use super::*;
use crate::scene::description::{
    Color, FilterDescription, FovAxis, GeometryDescription, IntegratorDescription, Ior, LightDescription, Paint,
    TextureDescription,
};

#[test]
fn each_step_of_a_transform_comes_after_the_one_before() {
    let sphere = placed("sphere", "<translate x='1'/><scale value='3'/><rotate z='1' angle='90'/>");
    let GeometryDescription::Sphere { center, radius } = sphere.geometry else { panic!("not a sphere") };
    close(center, [0.0, 3.0, 0.0]);
    assert!((radius - 3.0).abs() < 1e-6);
}

#[test]
fn nine_values_are_the_linear_part() {
    let sphere = placed("sphere", "<matrix value='2 0 0 0 2 0 0 0 2'/>");
    assert!(matches!(sphere.geometry, GeometryDescription::Sphere { radius: 2.0, .. }));
}

#[test]
fn impossible_steps_are_errors() {
    for (step, word) in [
        ("<rotate angle='3'/>", "axis"),
        ("<matrix value='1 2 3'/>", "16 or 9"),
        ("<matrix value='1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 1'/>", "last row"),
        ("<lookat origin='0 0 0' target='0 0 0'/>", "must differ"),
        ("<lookat origin='0 0 0' target='0 0 1' up='0 0 1'/>", "along the view"),
        ("<wiggle x='1'/>", "not a step"),
    ] {
        let error = fault(&format!("<shape type='sphere'><transform name='to_world'>{step}</transform></shape>"));
        assert!(error.message.contains(word) && error.place.is_some(), "{error}");
    }
}

#[test]
fn a_rectangle_keeps_its_side_in_a_mirror_and_a_sphere_turns_inside_out() {
    // As Mitsuba's area light shows: which side of each emits.
    for (kind, flips) in [("rectangle", true), ("sphere", true), ("disk", false), ("cylinder", false), ("cube", false)]
    {
        assert!(!placed(kind, "<translate x='1'/>").flip_normal, "{kind}");
        assert_eq!(placed(kind, "<scale x='-1'/>").flip_normal, flips, "{kind}");
        let flipped = shape(&format!("type='{kind}'><boolean name='flip_normals' value='true'/>"));
        assert!(flipped.flip_normal, "{kind}");
    }
}

#[test]
fn a_rectangle_is_a_quad_from_minus_one_to_one() {
    let GeometryDescription::Quad { corner, u, v } = placed("rectangle", "<rotate x='1' angle='90'/>").geometry else {
        panic!("not a quad")
    };
    close(corner, [-1.0, 0.0, -1.0]);
    close(u, [2.0, 0.0, 0.0]);
    close(v, [0.0, 0.0, 2.0]);
}

#[test]
fn a_disk_points_as_its_plane_does_also_in_a_mirror() {
    let GeometryDescription::Disk { normal, radius, .. } = placed("disk", "<scale x='-2' y='2'/>").geometry else {
        panic!("not a disk")
    };
    close(normal, [0.0, 0.0, 1.0]);
    assert_eq!(radius, 2.0);
}

#[test]
fn a_mirrored_cube_is_never_handed_on_inside_out() {
    assert!(placed("cube", "<scale x='-1' y='2'/>").transform.0.determinant() > 0.0);
}

#[test]
fn a_cylinder_goes_from_one_point_to_the_other() {
    let points =
        "<point name='p0' x='0' y='0' z='0'/><point name='p1' x='0' y='2' z='0'/><float name='radius' value='0.5'/>";
    let cylinder = shape(&format!(
        "type='cylinder'>{points}<transform name='to_world'><scale value='2'/><translate x='5'/></transform>"
    ));
    let GeometryDescription::Cylinder { from, to, radius } = cylinder.geometry else { panic!("not a cylinder") };
    close(from, [5.0, 0.0, 0.0]);
    close(to, [5.0, 4.0, 0.0]);
    assert!((radius - 1.0).abs() < 1e-6);
}

#[test]
fn stretched_round_things_are_warned_of() {
    for kind in ["sphere", "disk", "cylinder"] {
        let imported =
            scene(&format!("<shape type='{kind}'><transform name='to_world'><scale x='2'/></transform></shape>"))
                .expect("valid");
        assert_eq!(imported.warnings.len(), 1, "{kind}");
    }
}

#[test]
fn meshes_keep_their_options() {
    let mesh =
        |kind: &str, more: &str| shape(&format!("type='{kind}'><string name='filename' value='m'/>{more}")).geometry;
    let GeometryDescription::Mesh { file, index, face_normals, flip_v, smooth: true } =
        mesh("serialized", "<integer name='shape_index' value='3'/><boolean name='face_normals' value='true'/>")
    else {
        panic!("not a mesh")
    };
    assert_eq!((file.as_str(), index, face_normals, flip_v), ("m", 3, true, false));
    assert!(matches!(mesh("obj", ""), GeometryDescription::Mesh { flip_v: true, face_normals: false, .. }));
    assert!(matches!(mesh("ply", ""), GeometryDescription::Mesh { flip_v: false, .. }));
    assert!(fault("<shape type='obj'/>").message.contains("filename"));
}

#[test]
fn an_unknown_shape_is_left_out_and_a_merged_one_taken_apart() {
    let imported = scene("<shape type='hair'/><shape type='merge'><shape type='cube'/><shape type='disk'/></shape>")
        .expect("valid");
    assert_eq!(imported.description.shapes.len(), 2);
    assert_eq!(messages(&imported), ["a.xml:2:1: shape 'hair' is not supported: this shape is left out"]);
}

#[test]
fn emission_belongs_to_its_shape() {
    let imported =
        clean("<shape type='cube'><emitter type='area'><rgb name='radiance' value='1 2 3'/></emitter></shape>");
    let shape = &imported.description.shapes[0];
    assert_eq!(
        shape.emission.as_ref().and_then(|emission| emission.radiance.clone()),
        Some(Color([1.0, 2.0, 3.0]).into())
    );
    assert_eq!(shape.material, None);
    assert!(imported.places.find("shapes[0].emission").expect("noted").column == 20);
}

#[test]
fn opaque_materials_are_black_from_behind_unless_twosided() {
    assert_eq!(material(""), one_sided(grey()));
    assert_eq!(material(GREY), one_sided(grey()));
    let mirror = MaterialDescription::Mirror { reflectance: Paint::grey(1.0) };
    assert_eq!(material("<bsdf type='conductor'/>"), one_sided(mirror));
    assert!(matches!(material("<bsdf type='plastic'/>"), MaterialDescription::TwoSided { back: Some(_), .. }));
    let both = MaterialDescription::TwoSided { front: MaterialRef::Inline(Box::new(grey())), back: None };
    assert_eq!(material(&format!("<bsdf type='twosided'>{GREY}</bsdf>")), both);
}

#[test]
fn a_twosided_has_its_own_back() {
    let two = material(&format!("<bsdf type='twosided'>{GREY}<bsdf type='conductor'/></bsdf>"));
    let MaterialDescription::TwoSided { back: Some(back), .. } = two else { panic!("not two-sided") };
    assert!(matches!(inner(&back), MaterialDescription::Mirror { .. }));
}

#[test]
fn light_passes_a_mask_from_both_sides() {
    let MaterialDescription::Mask { opacity, material } =
        material(&format!("<bsdf type='mask'><float name='opacity' value='0.25'/>{GREY}</bsdf>"))
    else {
        panic!("not a mask")
    };
    assert_eq!(opacity, Paint::grey(0.25));
    assert_eq!(inner(&material), &one_sided(grey()));
    let MaterialDescription::Mask { opacity, .. } = super::material("<bsdf type='null'/>") else {
        panic!("not a mask")
    };
    assert_eq!(opacity, Paint::grey(0.0));
}

#[test]
fn a_blend_is_black_from_behind_where_both_its_parts_are() {
    let blend = |second: &str| {
        material(&format!("<bsdf type='blendbsdf'><float name='weight' value='0.3'/>{GREY}{second}</bsdf>"))
    };
    let MaterialDescription::TwoSided { front, back: Some(_) } = blend("<bsdf type='conductor'/>") else {
        panic!("not one-sided")
    };
    assert!(matches!(inner(&front), MaterialDescription::Blend { weight: Paint::Color(Color([0.3, _, _])), .. }));
    let MaterialDescription::Blend { first, .. } = blend("<bsdf type='dielectric'/>") else { panic!("not a blend") };
    assert_eq!(inner(&first), &one_sided(grey()));
    assert!(
        fault(&format!("<shape type='cube'><bsdf type='blendbsdf'>{GREY}</bsdf></shape>"))
            .message
            .contains("two BSDFs")
    );
}

#[test]
fn an_old_mixture_is_a_chain_of_blends() {
    let mixed = material(&format!(
        "<bsdf type='mixturebsdf'><string name='weights' value='0.5, 0.25, 0.25'/>{GREY}{GREY}{GREY}</bsdf>"
    ));
    let MaterialDescription::TwoSided { front, .. } = mixed else { panic!("not one-sided") };
    let MaterialDescription::Blend { weight, first, .. } = inner(&front) else { panic!("not a blend") };
    assert_eq!(weight, &Paint::grey(0.25));
    let MaterialDescription::Blend { weight, .. } = inner(first) else { panic!("not a blend") };
    assert_eq!(weight, &Paint::grey(1.0 / 3.0));
}

#[test]
fn substances_have_names() {
    let glass =
        |inside: &str| material(&format!("<bsdf type='dielectric'><string name='int_ior' value='{inside}'/></bsdf>"));
    assert!(matches!(
        glass("water"),
        MaterialDescription::Glass { ior: Ior::Number(1.333), exterior_ior: Ior::Number(1.000277), .. }
    ));
    assert!(matches!(material("<bsdf type='thindielectric'/>"), MaterialDescription::ThinGlass { ior: 1.5046, .. }));
    let error =
        fault("<shape type='cube'><bsdf type='dielectric'><string name='int_ior' value='diamont'/></bsdf></shape>");
    assert_eq!(error.hint.as_deref(), Some("did you mean 'diamond'?"));
    let MaterialDescription::TwoSided { front, .. } =
        material("<bsdf type='conductor'><string name='material' value='Au'/></bsdf>")
    else {
        panic!("not one-sided")
    };
    assert!(matches!(inner(&front), MaterialDescription::Conductor { eta: Some(Color([0.143, 0.3753, 1.442])), .. }));
}

#[test]
fn a_metal_in_a_medium_counts_by_its_ratio() {
    let metal = "<bsdf type='conductor'><rgb name='eta' value='3'/><rgb name='k' value='6'/><float name='ext_eta' value='1.5'/></bsdf>";
    let MaterialDescription::TwoSided { front, .. } = material(metal) else { panic!("not one-sided") };
    let MaterialDescription::Conductor { eta, k, .. } = inner(&front) else { panic!("not a conductor") };
    assert_eq!((eta.map(|eta| eta.0[0]), k.map(|k| k.0[0])), (Some(2.0), Some(4.0)));
}

#[test]
fn colours_are_written_in_many_ways() {
    let color = |element: &str| {
        let MaterialDescription::TwoSided { front, .. } = material(&format!("<bsdf type='diffuse'>{element}</bsdf>"))
        else {
            panic!("not one-sided")
        };
        match inner(&front) {
            MaterialDescription::Diffuse { reflectance: Paint::Color(color) } => color.0,
            other => panic!("{other:?} has no colour"),
        }
    };
    close(color("<rgb name='reflectance' value='.1, .2,.3'/>"), [0.1, 0.2, 0.3]);
    close(color("<rgb name='reflectance' value='0.2'/>"), [0.2; 3]);
    close(color("<rgb name='reflectance' value='#ffffff'/>"), [1.0; 3]);
    close(color("<srgb name='reflectance' value='0.5'/>"), [0.214_041; 3]);
    close(color("<spectrum name='reflectance' value='0.3'/>"), [0.3; 3]);
    close(color("<spectrum name='reflectance' value='.1 .2 .3'/>"), [0.1, 0.2, 0.3]);
    close(color("<float name='reflectance' value='0.7'/>"), [0.7; 3]);
    close(color("<spectrum type='uniform' name='reflectance'><float name='value' value='0.4'/></spectrum>"), [0.4; 3]);
    let listed = color("<spectrum name='reflectance' value='400:0.1, 500:0.2 600:0.7, 700:0.6'/>");
    assert!((listed[0] - 0.793).abs() < 2e-3);
    let error = fault(
        "<shape type='cube'><bsdf type='diffuse'><spectrum name='reflectance' value='500:1 400:1'/></bsdf></shape>",
    );
    assert!(error.message.contains("must rise"), "{error}");
}

#[test]
fn a_spectrum_may_stand_in_a_file() {
    let text = "<scene version='3.0.0'><emitter type='constant'><spectrum name='radiance' filename='x.spd'/></emitter></scene>";
    let imported = read_files(&[("a.xml", text), ("x.spd", "# nm\n360 2\n830 2\n")], &[]).expect("valid");
    let LightDescription::Constant { radiance } = imported.description.lights[0] else { panic!("not constant") };
    assert!((radiance.0[0] - 2.0 * 1.2048).abs() < 2e-3, "{radiance:?}");
    let error = read_files(&[("a.xml", text), ("x.spd", "360 a")], &[]).expect_err("wrong");
    assert!(error.message.contains("line 1"), "{error}");
}

#[test]
fn lights_are_placed_and_measured_as_there() {
    let lights = clean(
        "<emitter type='point'><transform name='to_world'><translate x='1'/></transform><rgb name='intensity' value='5'/></emitter>
         <emitter type='spot'><float name='cutoff_angle' value='40'/><transform name='to_world'><lookat origin='0 1 0' target='0 0 0' up='1 0 0'/></transform></emitter>
         <emitter type='directional'><vector name='direction' value='0 -1 0'/></emitter>
         <emitter type='constant'><spectrum name='radiance' value='1'/></emitter>",
    )
    .description
    .lights;
    let LightDescription::Point { position, intensity, .. } = lights[0] else { panic!("not a point") };
    assert_eq!((position, intensity), ([1.0, 0.0, 0.0], Some(Color::grey(5.0))));
    let LightDescription::Spot { position, target, cutoff, beam_width, intensity, .. } = lights[1] else {
        panic!("not a spot")
    };
    close(position, [0.0, 1.0, 0.0]);
    close(target, [0.0, 0.0, 0.0]);
    assert_eq!((cutoff, beam_width, intensity), (40.0, Some(30.0), Some(Color::grey(1.0))));
    let LightDescription::Directional { direction, irradiance, .. } = lights[2] else { panic!("not directional") };
    assert_eq!((direction, irradiance), ([0.0, -1.0, 0.0], Color::grey(1.0)));
    // A light of equal energy is a little red.
    let LightDescription::Constant { radiance } = lights[3] else { panic!("not constant") };
    assert!((radiance.0[0] - 1.2048).abs() < 1e-3);
}

#[test]
fn textures_are_named_and_shared() {
    let description = clean(
        "<texture type='checkerboard' id='board'><rgb name='color0' value='1'/><transform name='to_uv'><scale value='4'/></transform></texture>
         <shape type='cube'><bsdf type='diffuse'><ref name='reflectance' id='board'/></bsdf></shape>
         <shape type='cube'><bsdf type='diffuse'><ref name='reflectance' id='board'/></bsdf></shape>
         <shape type='cube'><bsdf type='diffuse'><texture name='reflectance' type='bitmap'><string name='filename' value='t.png'/>
           <boolean name='raw' value='true'/><string name='filter_type' value='nearest'/><string name='wrap_mode' value='clamp'/></texture></bsdf></shape>",
    )
    .description;
    assert_eq!(description.textures.keys().collect::<Vec<_>>(), ["board", "texture-2"]);
    let TextureDescription::Checkerboard { color0, color1, to_uv } = &description.textures["board"] else {
        panic!("not a checkerboard")
    };
    assert_eq!((color0, color1, to_uv.0.x_axis.x), (&Paint::grey(1.0), &Paint::grey(0.2), 4.0));
    assert!(matches!(
        &description.textures["texture-2"],
        TextureDescription::Bitmap { file, raw: true, filter: crate::scene::description::TextureFilter::Nearest, wrap: crate::scene::description::Wrap::Clamp, .. } if file == "t.png"
    ));
}

#[test]
fn the_camera_looks_along_z_with_x_to_the_left() {
    let camera = |steps: &str| {
        clean(&format!("<sensor type='perspective'><float name='fov' value='90'/><transform name='to_world'>{steps}</transform></sensor>"))
            .description
            .camera
            .expect("a camera")
    };
    let plain = camera("<lookat origin='1 2 3' target='1 2 9' up='0 2 0'/>");
    close(plain.origin, [1.0, 2.0, 3.0]);
    close(plain.forward.expect("set"), [0.0, 0.0, 1.0]);
    close(plain.left.expect("set"), [1.0, 0.0, 0.0]);
    close(plain.up.expect("set"), [0.0, 1.0, 0.0]);
    let without_up = camera("<lookat origin='0 0 0' target='0 0 1'/>");
    close(without_up.up.expect("set"), [1.0, 0.0, 0.0]);
    close(without_up.left.expect("set"), [0.0, -1.0, 0.0]);
    // The lab's camera is mirrored: left is -x.
    let lab = camera("<scale x='-1'/><lookat origin='0, 0, -3.5' target='0, 0, 0' up='0, 1, 0'/>");
    close(lab.left.expect("set"), [-1.0, 0.0, 0.0]);
    assert_eq!((lab.fov, lab.fov_axis), (Some(90.0), FovAxis::X));
    assert_eq!(
        fault("<sensor type='perspective'><transform name='to_world'><scale x='0'/></transform></sensor>")
            .place
            .map(|p| p.line),
        Some(2)
    );
}

#[test]
fn a_focal_length_spans_the_diagonal_of_35_mm_film() {
    let camera = clean("<sensor type='perspective'><string name='focal_length' value='50mm'/></sensor>")
        .description
        .camera
        .expect("one");
    assert_eq!(camera.fov_axis, FovAxis::Diagonal);
    // Mitsuba: at 200×100 the left edge is at 0.38701 of the distance.
    let diagonal = f64::from(camera.fov.expect("set")).to_radians() / 2.0;
    assert!((diagonal.tan() * 2.0 / 5f64.sqrt() - 0.387_012).abs() < 1e-4);
}

#[test]
fn a_thin_lens_has_a_radius_and_a_focus() {
    let lens = "<float name='aperture_radius' value='0.1'/><float name='focus_distance' value='7'/>";
    let camera = clean(&format!("<sensor type='thinlens'>{lens}</sensor>")).description.camera.expect("one");
    assert_eq!((camera.aperture_radius, camera.focus_distance), (0.1, Some(7.0)));
    assert!(fault("<sensor type='thinlens'/>").message.contains("aperture_radius"));
}

#[test]
fn film_filter_and_sampler_are_taken() {
    let sensor = |film: &str| {
        format!(
            "<sensor type='perspective'>{film}<sampler type='ldsampler'><integer name='sample_count' value='9'/></sampler></sensor>"
        )
    };
    let description = clean(&sensor("<film type='ldrfilm'><integer name='width' value='20'/><integer name='height' value='10'/><rfilter type='tent'/></film>")).description;
    assert_eq!((description.film.size, description.render.passes), ([20, 10], Some(9)));
    assert_eq!(description.film.filter, FilterDescription::Tent { radius: 1.0 });
    assert_eq!(clean(&sensor("")).description.film.filter, FilterDescription::Gaussian { stddev: 0.5 });
    let other = scene(&sensor("<film type='hdrfilm'><rfilter type='lanczos'/></film>")).expect("valid");
    assert_eq!(other.warnings.len(), 1);
    assert!(fault(&sensor("<film type='hdrfilm'><integer name='width' value='-1'/></film>")).message.contains("width"));
}

#[test]
fn depths_become_bounces() {
    let integrator = |content: &str| clean(&format!("<integrator {content}</integrator>")).description.integrator;
    let depth = |depth: i32| match integrator(&format!("type='path'><integer name='max_depth' value='{depth}'/>")) {
        IntegratorDescription::Auto(settings) => settings.max_bounces,
        other => panic!("{other:?} is no path tracer"),
    };
    assert_eq!([depth(1), depth(2), depth(64), depth(-1)], [0, 1, 63, 256]);
    assert!(matches!(integrator("type='direct'>"), IntegratorDescription::Auto(settings) if settings.max_bounces == 1));
    assert!(matches!(integrator("type='ptracer'>"), IntegratorDescription::Light(_)));
    let sppm = "type='sppm'><integer name='max_depth' value='9'/><integer name='photon_count' value='77'/>";
    assert!(
        matches!(integrator(sppm), IntegratorDescription::PhotonMap(settings) if settings.max_bounces == 8 && settings.photons == 77)
    );
    let unknown = scene("<integrator type='vcm'><integer name='max_depth' value='5'/></integrator>").expect("valid");
    assert!(
        matches!(unknown.description.integrator, IntegratorDescription::Auto(settings) if settings.max_bounces == 4)
    );
    assert_eq!(unknown.warnings.len(), 1);
}

#[test]
fn hidden_emitters_are_warned_of() {
    let imported =
        scene("<integrator type='path'><boolean name='hide_emitters' value='true'/></integrator>").expect("valid");
    assert!(messages(&imported)[0].contains("hide_emitters"));
}
