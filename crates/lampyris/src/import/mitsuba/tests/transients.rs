//! The films and integrators of mitransient.

use super::{clean, messages, scene};
use crate::scene::description::{
    CaptureDescription, CaptureMode, FilterDescription, IntegratorDescription, LightDescription, TimeDescription,
};
use crate::transient::Unwarp;

fn sensor(film: &str) -> String {
    format!("<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/>{film}</sensor>")
}

const FILM: &str = "<film type=\"transient_hdr_film\">
    <integer name=\"temporal_bins\" value=\"400\"/>
    <float name=\"start_opl\" value=\"1000\"/>
    <float name=\"bin_width_opl\" value=\"6.5\"/>
    <rfilter type=\"box\"/>
    </film>";

#[test]
fn films_with_time_have_their_bins() {
    let integrator = "<integrator type=\"transient_path\">
        <boolean name=\"camera_unwarp\" value=\"true\"/>
        <integer name=\"max_depth\" value=\"8\"/>
        <string name=\"temporal_filter\" value=\"box\"/>
        <float name=\"gaussian_stddev\" value=\"2.0\"/>
        </integrator>";
    let description = clean(&(integrator.to_string() + &sensor(FILM))).description;
    let expected = TimeDescription {
        bins: 400,
        start: Some(1000.0),
        bin_width: Some(6.5),
        unwarp: Unwarp::FirstSurface,
        ..TimeDescription::default()
    };
    assert_eq!(description.film.time, Some(expected));
    assert!(matches!(description.integrator, IntegratorDescription::Auto(settings) if settings.max_bounces == 7));
}

#[test]
fn their_defaults_are_those_of_mitransient() {
    let text = "<integrator type=\"transient_path\"/>".to_string() + &sensor("<film type=\"transient_hdr_film\"/>");
    let description = clean(&text).description;
    let time = description.film.time.expect("time");
    assert_eq!((time.bins, time.bin_width, time.start), (2048, Some(0.003), Some(0.0)));
    assert_eq!((time.unwarp, description.integrator.max_bounces()), (Unwarp::None, 5));
}

/// Theirs begin to count at the near plane, and hide what lies before it.
#[test]
fn the_near_plane_matters_with_time_alone() {
    let clip = "<float name=\"near_clip\" value=\"10\"/>";
    let near =
        |film: &str| clean(&sensor(&(clip.to_string() + film))).description.camera.expect("a camera").near_distance;
    assert_eq!(near("<film type=\"transient_hdr_film\"/>"), 10.0);
    assert_eq!(near("<film type=\"hdrfilm\"/>"), 0.0);
}

#[test]
fn an_ordinary_film_has_no_time_whatever_the_integrator_says() {
    let text = "<integrator type=\"transient_path\"><boolean name=\"camera_unwarp\" value=\"true\"/></integrator>";
    assert_eq!(clean(&(text.to_string() + &sensor("<film type=\"hdrfilm\"/>"))).description.film.time, None);
}

#[test]
fn phasor_films_have_the_frequencies_of_theirs() {
    let film = "<film type=\"phasor_hdr_film\">
        <integer name=\"temporal_bins\" value=\"1000\"/>
        <float name=\"bin_width_opl\" value=\"0.01\"/>
        <float name=\"start_opl\" value=\"1.5\"/>
        <float name=\"wl_mean\" value=\"0.4\"/>
        <float name=\"wl_sigma\" value=\"5\"/>
        </film>";
    let time = clean(&sensor(film)).description.film.time.expect("time");
    // Mean 10 / 0.4 = 25, sigma 10 / 6 / 5 = 1/3: numbers 24 to 26 of multiples of 0.1.
    assert_eq!(time.amplitudes().expect("some"), [2.4, 2.5, 2.6]);
    assert_eq!(time.start(), Some(1.5));
    let time = clean(&sensor("<film type=\"phasor_hdr_film\"/>")).description.film.time.expect("time");
    // Theirs are 4096 bins of 0.003, and waves of 100 and 1000.
    assert_eq!(time.amplitudes().expect("some"), [0.0, 1.0 / 12.288]);
}

#[test]
fn what_is_left_out_is_told() {
    let integrator = "<integrator type=\"transient_nlos_path\">
        <integer name=\"filter_bounces\" value=\"3\"/>
        <boolean name=\"nlos_laser_sampling\" value=\"true\"/>
        </integrator>";
    let told = messages(&scene(&(integrator.to_string() + &sensor(FILM))).expect("a scene")).join("; ");
    for expected in ["'filter_bounces'", "'nlos_capture_meter'"] {
        assert!(told.contains(expected), "{told}");
    }
}

/// A wall with a sensor on it, and a projector that shines on it.
fn capture(integrator: &str, film: &str) -> String {
    format!(
        "<integrator type=\"transient_nlos_path\">{integrator}<integer name=\"max_depth\" value=\"4\"/></integrator>
        <emitter type=\"projector\">
            <rgb name=\"irradiance\" value=\"2, 2, 2\"/><float name=\"fov\" value=\"0.2\"/>
            <transform name=\"to_world\"><lookat origin=\"0,0,1\" target=\"0.5,0,0\" up=\"0,1,0\"/></transform>
        </emitter>
        <shape type=\"rectangle\" id=\"relay_wall\">
            <sensor type=\"nlos_capture_meter\">
                <point name=\"sensor_origin\" x=\"-0.5\" y=\"0.0\" z=\"0.25\"/>
                <film type=\"transient_hdr_film\">
                    <integer name=\"width\" value=\"4\"/><integer name=\"height\" value=\"2\"/>{film}
                </film>
            </sensor>
        </shape>"
    )
}

#[test]
fn a_capture_meter_looks_at_points_of_its_wall() {
    let integrator = "<boolean name=\"nlos_laser_sampling\" value=\"true\"/>
        <boolean name=\"nlos_hidden_geometry_sampling\" value=\"true\"/>
        <boolean name=\"discard_direct_paths\" value=\"true\"/>
        <boolean name=\"account_first_and_last_bounces\" value=\"true\"/>
        <string name=\"capture_type\" value=\"Confocal\"/>";
    let description = clean(&capture(integrator, "")).description;
    let camera = description.camera.expect("a camera");
    let expected = CaptureDescription {
        wall: "relay_wall".into(),
        mode: CaptureMode::Confocal,
        laser_grid: None,
        legs: true,
        hidden_geometry: true,
    };
    assert_eq!((camera.origin, camera.capture), ([-0.5, 0.0, 0.25], Some(expected)));
    assert_eq!((description.film.size, description.film.filter), ([4, 2], FilterDescription::default()));
    assert!(matches!(&description.integrator, IntegratorDescription::Path(path) if path.max_bounces == 3));
    let [LightDescription::Laser { position, target: Some(target), power }] = &description.lights[..] else {
        panic!("not a laser: {:?}", description.lights);
    };
    // π by what Mitsuba calls irradiance, over the square that the beam covers at a distance of 1.
    let flux = 2.0 * std::f32::consts::PI * 4.0 * 0.1_f32.to_radians().tan().powi(2);
    assert!((power.0[0] / flux - 1.0).abs() < 1e-5, "{power:?}");
    let along = [0, 1, 2].map(|axis| target[axis] - position[axis]);
    assert!((along[0] / along[2] + 0.5).abs() < 1e-5 && along[1].abs() < 1e-6, "{along:?}");
}

#[test]
fn an_exhaustive_capture_has_a_film_for_all_pairs_of_points() {
    let integrator = "<integer name=\"capture_type\" value=\"3\"/>";
    let film = "<boolean name=\"exhaustive_scan\" value=\"true\"/>
        <integer name=\"laser_scan_width\" value=\"3\"/><integer name=\"laser_scan_height\" value=\"5\"/>";
    let description = clean(&capture(integrator, film)).description;
    let captured = description.camera.and_then(|camera| camera.capture).expect("a capture");
    assert_eq!((captured.mode, captured.laser_grid), (CaptureMode::Exhaustive, Some([3, 5])));
    assert_eq!(description.film.size, [12, 10]);
    let wrong = scene(&capture("<string name=\"capture_type\" value=\"twice\"/>", "")).expect_err("no such mode");
    assert!(wrong.message.contains("'capture_type' must be single"), "{}", wrong.message);
}
