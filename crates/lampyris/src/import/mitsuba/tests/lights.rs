use glam::Vec3;

use super::*;
use crate::scene::description::{Color, LightDescription, TextureDescription, Transform};

fn light(emitter: &str) -> LightDescription {
    clean(&format!("<emitter {emitter}</emitter>")).description.lights.remove(0)
}

fn old_light(emitter: &str) -> LightDescription {
    let text = format!("<scene version='0.6.0'><emitter {emitter}</emitter></scene>");
    let mut imported = read_files(&[("a.xml", &text)], &[]).expect("valid");
    assert_eq!(messages(&imported), Vec::<String>::new());
    imported.description.lights.remove(0)
}

#[test]
fn a_light_we_lack_is_left_out() {
    let imported = scene("<emitter type='orthographicprojector'/>").expect("valid");
    assert!(imported.description.lights.is_empty());
    let wanted = "a.xml:2:1: emitter 'orthographicprojector' is not supported: this light is left out";
    assert_eq!(messages(&imported), [wanted]);
}

/// Where in the world lies what is in the middle of our picture, in the direction +z of it.
fn middle(transform: Transform) -> Vec3 {
    transform.0.transform_vector3(Vec3::Z)
}

#[test]
fn the_middle_of_an_environment_lies_along_z_with_x_to_its_left() {
    // As Mitsuba 3.9.1 evaluates it: u = 0.5 at +z, 0.25 at +x.
    let LightDescription::Environment { file, scale, transform, .. } =
        light("type='envmap'><string name='filename' value='sky.exr'/><float name='scale' value='3'/>")
    else {
        panic!("no environment")
    };
    assert_eq!((file.as_str(), scale), ("sky.exr", Color::grey(3.0)));
    close(middle(transform).to_array(), [0.0, 0.0, 1.0]);
    close(transform.0.transform_vector3(Vec3::X).to_array(), [1.0, 0.0, 0.0]);
    close(transform.0.transform_vector3(Vec3::Y).to_array(), [0.0, 1.0, 0.0]);
}

#[test]
fn an_environment_turns_with_its_matrix() {
    let turn = "<transform name='to_world'><rotate y='1' angle='90'/></transform>";
    let LightDescription::Environment { transform, .. } =
        light(&format!("type='envmap'><string name='filename' value='a.hdr'/>{turn}"))
    else {
        panic!("no environment")
    };
    close(middle(transform).to_array(), [1.0, 0.0, 0.0]);
}

#[test]
fn an_environment_may_hold_its_picture_as_a_texture() {
    let LightDescription::Environment { file, .. } =
        light("type='envmap'><texture type='bitmap' name='bitmap'><string name='filename' value='b.exr'/></texture>")
    else {
        panic!("no environment")
    };
    assert_eq!(file, "b.exr");
    assert!(fault("<emitter type='envmap'/>").message.contains("filename"));
}

/// The direction of the sun in the world.
fn sun(light: &LightDescription) -> [f32; 3] {
    let LightDescription::Sky { sun_direction, transform, .. } = light else { panic!("no sky") };
    transform.0.transform_vector3(Vec3::from_array(*sun_direction)).to_array()
}

fn zenith(light: &LightDescription) -> [f32; 3] {
    let LightDescription::Sky { transform, .. } = light else { panic!("no sky") };
    transform.0.transform_vector3(Vec3::Y).to_array()
}

#[test]
fn the_sky_is_above_z_in_version_3_and_above_y_before() {
    let direction = "<vector name='sun_direction' x='0' y='0.6' z='0.8'/>";
    let new = light(&format!("type='sunsky'>{direction}"));
    close(zenith(&new), [0.0, 0.0, 1.0]);
    close(sun(&new), [0.0, 0.6, 0.8]);
    let old = old_light(&format!("type='sunsky'>{}", direction.replace("sun_direction", "sunDirection")));
    close(zenith(&old), [0.0, 1.0, 0.0]);
    close(sun(&old), [0.0, 0.6, 0.8]);
}

#[test]
fn the_direction_of_the_sun_is_that_of_the_world_also_under_a_turned_sky() {
    let turned = light(
        "type='sunsky'><vector name='sun_direction' value='0.6 0.8 0'/><transform name='to_world'><rotate x='1' angle='-90'/></transform>",
    );
    close(zenith(&turned), [0.0, 1.0, 0.0]);
    close(sun(&turned), [0.6, 0.8, 0.0]);
}

#[test]
fn the_sun_of_tokyo_is_the_default() {
    // The numbers of version 3 are those of Mitsuba 3.9.1.
    let found = sun(&light("type='sunsky'>"));
    assert!(Vec3::from_array(found).distance(Vec3::new(0.0513854, 0.691748, 0.720308)) < 1e-3, "{found:?}");
    // In 0.x the same sun stands in the west, at -x.
    let found = sun(&old_light("type='sunsky'>"));
    assert!(Vec3::from_array(found).distance(Vec3::new(-0.691748, 0.720308, 0.0513854)) < 1e-3, "{found:?}");
    let turn = "<transform name='to_world'><rotate x='1' angle='-90'/></transform>";
    let found = sun(&light(&format!("type='sunsky'><float name='hour' value='9'/>{turn}")));
    assert!(Vec3::from_array(found).distance(Vec3::new(0.0956952, 0.782867, 0.614786)) < 1e-3, "{found:?}");
}

#[test]
fn sun_and_sky_have_factors_and_the_sun_a_size() {
    let LightDescription::Sky { turbidity, albedo, sky_scale, sun_scale, sun_angle, .. } = light("type='sunsky'>")
    else {
        panic!("no sky")
    };
    assert_eq!((turbidity, albedo, sky_scale, sun_scale), (3.0, Color::grey(0.3), 1.0, 1.0));
    assert!((sun_angle - 0.5358).abs() < 1e-6);
    let of = |emitter: &str| match old_light(emitter) {
        LightDescription::Sky { sky_scale, sun_scale, albedo, .. } => (sky_scale, sun_scale, albedo),
        other => panic!("{other:?} is no sky"),
    };
    assert_eq!(of("type='sky'><float name='scale' value='2'/>"), (2.0, 0.0, Color::grey(0.15)));
    assert_eq!(of("type='sun'><float name='scale' value='2'/>"), (0.0, 2.0, Color::grey(0.15)));
    let both = "type='sunsky'><float name='scale' value='2'/><float name='sunScale' value='5'/>";
    assert_eq!(of(both), (2.0, 5.0, Color::grey(0.15)));
    let LightDescription::Sky { sun_angle, .. } = old_light("type='sunsky'><float name='sunRadiusScale' value='10'/>")
    else {
        panic!("no sky")
    };
    assert!((sun_angle - 5.358).abs() < 1e-5);
}

#[test]
fn an_impossible_date_is_an_error() {
    assert!(fault("<emitter type='sunsky'><integer name='month' value='13'/></emitter>").message.contains("date"));
}

#[test]
fn a_projector_throws_its_picture_upright_and_a_pi_brighter() {
    let imported = clean(
        "<emitter type='projector'><float name='fov' value='60'/><float name='scale' value='2'/>
          <texture name='irradiance' type='bitmap'><string name='filename' value='p.png'/></texture>
          <transform name='to_world'><lookat origin='1 0 0' target='0 0 0' up='0 0 1'/></transform></emitter>",
    );
    let LightDescription::Projector { position, target, up, texture, aspect, fov, scale } =
        &imported.description.lights[0]
    else {
        panic!("no projector")
    };
    close(*position, [1.0, 0.0, 0.0]);
    close(*target, [0.0, 0.0, 0.0]);
    close(*up, [0.0, 0.0, 1.0]);
    assert_eq!((*aspect, *fov), (None, 60.0));
    assert!((scale.0[0] - 2.0 * std::f32::consts::PI).abs() < 1e-5);
    let picture = &imported.description.textures[texture.as_ref().expect("a texture")];
    assert!(matches!(picture, TextureDescription::Bitmap { to_uv, .. } if to_uv.is_identity()), "{picture:?}");
}

#[test]
fn a_projector_of_one_colour_has_no_texture() {
    let LightDescription::Projector { texture, fov, scale, .. } =
        light("type='projector'><rgb name='irradiance' value='1 2 3'/>")
    else {
        panic!("no projector")
    };
    assert_eq!(texture, None);
    assert!((scale.0[2] / scale.0[0] - 3.0).abs() < 1e-5);
    // Mitsuba 3.9.1 says x_fov = 34.0221.
    assert!((fov - 34.0221).abs() < 1e-4);
}

#[test]
fn a_collimated_beam_runs_along_z() {
    let beam = light(
        "type='collimated'><spectrum name='power' value='1, 2, 3'/><transform name='to_world'><translate y='4'/></transform>",
    );
    let wanted = LightDescription::Beam {
        position: [0.0, 4.0, 0.0],
        direction: [0.0, 0.0, 1.0],
        power: Color([1.0, 2.0, 3.0]),
        radius: 0.0,
    };
    assert_eq!(beam, wanted);
}

#[test]
fn a_texture_may_give_the_radiance_of_a_lamp() {
    let lamp = |radiance: &str| {
        let shape = clean(&format!("<shape type='rectangle'><emitter type='area'>{radiance}</emitter></shape>"))
            .description
            .shapes
            .remove(0);
        let emission = shape.emission.expect("a lamp");
        (emission.radiance, emission.scale)
    };
    let texture = Some(Paint::Texture("texture-1".into()));
    let bitmap = "type='bitmap'><string name='filename' value='l.png'/></texture>";
    assert_eq!(lamp(&format!("<texture name='radiance' {bitmap}")), (texture.clone(), 1.0));
    let scaled =
        format!("<texture name='radiance' type='scale'><float name='scale' value='9'/><texture {bitmap}</texture>");
    assert_eq!(lamp(&scaled), (texture, 9.0));
}

#[test]
fn a_lamp_of_some_angles_shines_in_all_with_a_word() {
    let imported = scene("<shape type='disk'><emitter type='angulararea'/></shape>").expect("valid");
    assert!(imported.description.shapes[0].emission.is_some());
    assert!(messages(&imported)[0].contains("angulararea"));
    let imported = scene("<shape type='disk'><emitter type='directionalarea'/></shape>").expect("valid");
    assert!(imported.description.shapes[0].emission.is_none());
}

#[test]
fn a_texture_where_only_a_colour_may_stand_is_a_warning() {
    let emitter = "<emitter type='point'><texture type='bitmap' name='intensity'><string name='filename' value='t.png'/></texture></emitter>";
    let imported = scene(emitter).expect("valid");
    assert_eq!(imported.warnings.len(), 1);
    assert!(imported.description.textures.is_empty());
}
