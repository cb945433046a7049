use super::*;
use crate::scene::description::{CameraDescription, Projection};

const FILM: &str =
    "<film type='hdrfilm'><integer name='width' value='200'/><integer name='height' value='100'/>CROP</film>";

fn camera_of(imported: &Imported) -> CameraDescription {
    imported.description.camera.clone().expect("a camera")
}

fn with_film(sensor: &str, crop: &str) -> Imported {
    clean(&format!("<sensor {sensor}{}</sensor>", FILM.replace("CROP", crop)))
}

const QUARTER: &str = "<integer name='crop_offset_x' value='100'/><integer name='crop_offset_y' value='0'/>
    <integer name='crop_width' value='100'/><integer name='crop_height' value='50'/>";

fn vectors(camera: &CameraDescription) -> [[f32; 3]; 3] {
    [camera.left, camera.up, camera.forward].map(|vector| vector.expect("set"))
}

/// The corners of the picture: top left, top right, bottom left; as vectors from the origin.
fn corners(camera: &CameraDescription) -> [[f32; 3]; 3] {
    let [left, up, forward] = vectors(camera).map(glam::Vec3::from_array);
    [forward + left + up, forward - left + up, forward + left - up].map(|corner| corner.to_array())
}

#[test]
fn a_crop_window_is_the_picture() {
    let imported = with_film("type='perspective'><float name='fov' value='90'/>", QUARTER);
    assert_eq!(imported.description.film.size, [100, 50]);
    // Rays of Mitsuba 3.9.1 through the corners of this window, at a distance of 1.
    let [top_left, top_right, bottom_left] = corners(&camera_of(&imported));
    close(top_left, [0.0, 0.5, 1.0]);
    close(top_right, [-1.0, 0.5, 1.0]);
    close(bottom_left, [0.0, 0.0, 1.0]);
}

#[test]
fn a_crop_of_everything_changes_nothing() {
    let whole = "<integer name='crop_width' value='200'/><integer name='crop_height' value='100'/>";
    let imported = with_film("type='perspective'><float name='fov' value='90'/>", whole);
    assert_eq!(camera_of(&imported).fov, Some(90.0));
}

#[test]
fn a_crop_outside_the_picture_is_an_error() {
    for crop in ["<integer name='crop_width' value='300'/>", "<integer name='crop_offset_x' value='200'/>"] {
        let error = fault(&format!("<sensor type='perspective'>{}</sensor>", FILM.replace("CROP", crop)));
        assert!(error.message.contains("crop"), "{error}");
    }
}

#[test]
fn a_shifted_principal_point_shifts_the_picture() {
    let shifted =
        "type='perspective'><float name='fov' value='90'/><float name='principal_point_offset_x' value='0.25'/>
        <float name='principal_point_offset_y' value='0.1'/>";
    // Rays of Mitsuba 3.9.1.
    let [top_left, top_right, bottom_left] = corners(&camera_of(&with_film(shifted, "")));
    close(top_left, [0.5, 0.4, 1.0]);
    close(top_right, [-1.5, 0.4, 1.0]);
    close(bottom_left, [0.5, -0.6, 1.0]);
}

#[test]
fn an_orthographic_camera_spans_the_width_that_its_matrix_gives_it() {
    let tall = "<film type='hdrfilm'><integer name='width' value='100'/><integer name='height' value='200'/></film>";
    let scaled = "<transform name='to_world'><scale x='3' y='3'/><translate z='7'/></transform>";
    let imported = clean(&format!("<sensor type='orthographic'>{scaled}{tall}</sensor>"));
    let camera = camera_of(&imported);
    // As the rays of Mitsuba 3.9.1 begin.
    assert_eq!((camera.projection, camera.fov), (Projection::Orthographic, None));
    close(camera.origin, [0.0, 0.0, 7.0]);
    let [left, up, forward] = vectors(&camera);
    close(left, [3.0, 0.0, 0.0]);
    close(up, [0.0, 6.0, 0.0]);
    close(forward, [0.0, 0.0, 1.0]);
}

#[test]
fn a_cropped_orthographic_camera_moves_aside() {
    let camera = camera_of(&with_film("type='orthographic'>", QUARTER));
    close(camera.origin, [-0.5, 0.25, 0.0]);
    let [left, up, forward] = vectors(&camera);
    close(left, [0.5, 0.0, 0.0]);
    close(up, [0.0, 0.25, 0.0]);
    close(forward, [0.0, 0.0, 1.0]);
}

#[test]
fn a_lens_is_in_focus_far_away_by_default() {
    // Mitsuba's default is its far plane.
    let lens = "<float name='aperture_radius' value='0.1'/>";
    let camera = camera_of(&clean(&format!("<sensor type='thinlens'>{lens}</sensor>")));
    assert_eq!(camera.focus_distance, Some(1e4));
}

#[test]
fn a_radiance_meter_sees_along_one_ray() {
    let camera = camera_of(&clean(
        "<sensor type='radiancemeter'><point name='origin' value='1 2 3'/><vector name='direction' value='0 2 0'/></sensor>",
    ));
    assert_eq!((camera.projection, camera.origin), (Projection::Orthographic, [1.0, 2.0, 3.0]));
    let [left, _, forward] = vectors(&camera);
    close(forward, [0.0, 1.0, 0.0]);
    assert!(glam::Vec3::from_array(left).length() < 1e-5);
}

#[test]
fn an_irradiance_meter_names_its_shape() {
    let meter = "<sensor type='irradiancemeter'><film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/></film></sensor>";
    let imported = clean(&format!("<shape type='cube'/><shape type='rectangle'>{meter}</shape>"));
    assert_eq!(imported.description.shapes[1].name.as_deref(), Some("shapes-1"));
    assert_eq!(camera_of(&imported).irradiance_of.as_deref(), Some("shapes-1"));
    assert_eq!(imported.description.film.size, [1, 1]);
    let imported = clean(&format!("<shape type='rectangle' id='wall'>{meter}</shape>"));
    assert_eq!(camera_of(&imported).irradiance_of.as_deref(), Some("wall"));
}

#[test]
fn a_camera_goes_before_a_meter() {
    let meter = "<shape type='rectangle'><sensor type='irradiancemeter'/></shape>";
    let imported = scene(&format!("{meter}<sensor type='perspective'/>")).expect("valid");
    assert_eq!(camera_of(&imported).irradiance_of, None);
    assert!(messages(&imported)[0].contains("only the first sensor"));
}

#[test]
fn of_a_batch_the_first_sensor_is_used() {
    let imported = scene(
        "<sensor type='batch'><sensor type='perspective'><float name='fov' value='33'/></sensor><sensor type='perspective'/></sensor>",
    )
    .expect("valid");
    assert_eq!(camera_of(&imported).fov, Some(33.0));
    assert!(messages(&imported)[0].contains("batch"));
}

#[test]
fn a_sensor_we_lack_is_a_camera_with_a_word() {
    for (plugin, projection) in
        [("spherical", Projection::Perspective), ("codedOrthographic", Projection::Orthographic)]
    {
        let imported = scene(&format!("<sensor type='{plugin}'/>")).expect("valid");
        assert_eq!(camera_of(&imported).projection, projection);
        assert_eq!(imported.warnings.len(), 1);
    }
}
