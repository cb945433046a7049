//! The films and integrators of mitransient.

use super::{clean, messages, scene};
use crate::scene::description::{IntegratorDescription, TimeDescription};
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
        <boolean name=\"discard_direct_paths\" value=\"true\"/>
        <boolean name=\"nlos_laser_sampling\" value=\"true\"/>
        </integrator>";
    let told = messages(&scene(&(integrator.to_string() + &sensor(FILM))).expect("a scene")).join("; ");
    for expected in ["'discard_direct_paths'", "'nlos_laser_sampling'"] {
        assert!(told.contains(expected), "{told}");
    }
}
