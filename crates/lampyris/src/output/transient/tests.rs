//! What is written is read, and damaged files are errors.

use std::io::Cursor;

use proptest::prelude::*;

use super::*;
use crate::transient::{Axis, Capture, IndexMode, SPEED_OF_LIGHT, Unwarp};

fn timing() -> impl Strategy<Value = Timing> {
    let modes = (proptest::sample::select(&Unwarp::ALL[..]), proptest::sample::select(&IndexMode::ALL[..]));
    let speed = prop_oneof![Just(SPEED_OF_LIGHT), Just(SPEED_OF_LIGHT * 1e3), 1e-3f64..1e20];
    (-1e3f64..1e3, 1e-9f64..1e3, modes, speed).prop_map(|(start, bin_width, (unwarp, index), light_speed)| Timing {
        axis: Axis { start, bin_width },
        unwarp,
        index,
        light_speed,
    })
}

fn transient() -> impl Strategy<Value = Transient> {
    ((1usize..6, 1usize..6, 1usize..9), timing()).prop_flat_map(|(size, timing)| {
        let value = prop_oneof![Just(0.0f32), 0.0f32..1e6, Just(f32::INFINITY), Just(-1.5)];
        proptest::collection::vec(value, size.0 * size.1 * size.2 * 3)
            .prop_map(move |values| Transient::from_values(size, timing, values).expect("as many as the size says"))
    })
}

/// What becomes of a file's bytes, without the disk.
fn decode(format: TransientFormat, bytes: &[u8]) -> Result<Transient> {
    match format {
        TransientFormat::Npy => decode_values(bytes, (Timing::new(0.0, 1.0), None)),
        TransientFormat::Npz => decode_npz(bytes, None, None),
    }
}

fn sample() -> Transient {
    let values = (0..36).map(|i| i as f32 * 0.5).collect();
    Transient::from_values((2, 3, 2), Timing::new(1.5, 0.25), values).expect("36 values")
}

fn encode_npz(transient: &Transient) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    write_npz(&mut file, &members(transient).expect("an axis")).expect("memory");
    file.into_inner()
}

fn files() -> [(TransientFormat, Vec<u8>); 2] {
    let npz = encode_npz(&sample());
    [(TransientFormat::Npy, encode_values(&sample())), (TransientFormat::Npz, npz)]
}

proptest! {
    #[test]
    fn files_give_back_every_bit(transient in transient()) {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["a.npy", "a.NPZ"] {
            let path = folder.path().join(name);
            write_transient(&path, &transient).expect("written");
            prop_assert_eq!(&read_transient(&path, None, None).expect("read"), &transient);
        }
    }

    #[test]
    fn damaged_files_do_not_panic(
        which in 0usize..2,
        damage in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<proptest::sample::Index>(),
    ) {
        let (format, mut bytes) = files()[which].clone();
        for (at, value) in damage {
            let length = bytes.len();
            bytes[at.index(length)] = value;
        }
        let _ = decode(format, &bytes);
        bytes.truncate(cut.index(bytes.len()));
        let _ = decode(format, &bytes);
    }

    #[test]
    fn arbitrary_sidecars_do_not_panic(bytes in proptest::collection::vec(any::<u8>(), 0..60)) {
        let _ = decode_sidecar(Path::new("a.json"), &bytes);
    }
}

#[test]
fn a_file_cut_short_anywhere_is_an_error() {
    for (format, bytes) in files() {
        for length in 0..bytes.len() {
            assert!(decode(format, &bytes[..length]).is_err(), "{format:?} cut to {length} of {}", bytes.len());
        }
    }
}

#[test]
fn the_array_is_that_of_numpy() {
    let bytes = encode_values(&sample());
    let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2, 2, 3), }";
    assert_eq!(&bytes[10..10 + text.len()], text.as_bytes());
    assert_eq!(bytes.len(), 128 + 36 * 4);
}

#[test]
fn one_channel_fills_three() {
    for shape in [&[1, 1, 2][..], &[1, 1, 2, 1]] {
        let read = decode(TransientFormat::Npy, &encode_array(shape, &[1.0, 2.0])).expect("valid");
        assert_eq!(read.profile(0, 0), [[1.0; 3], [2.0; 3]]);
    }
}

#[test]
fn sizes_that_the_bytes_cannot_hold_are_refused() {
    for shape in [[1 << 20, 1 << 20, 1 << 20, 3], [1 << 31, 1, 1, 3], [1, 1, 2, 3]] {
        let error = decode(TransientFormat::Npy, &encode_array(&shape, &[0.0; 3])).expect_err("too short");
        assert!(error.message.contains("too short"), "{error}");
    }
    assert!(decode(TransientFormat::Npy, &encode_array(&[0, 1, 1, 3], &[])).is_err());
}

#[test]
fn sidecars_say_what_is_wrong_with_them() {
    let read = |text: &str| decode_sidecar(Path::new("a.json"), text.as_bytes()).map(|(timing, _)| timing);
    let millimetres = read(r#"{"bin_width_opl": 3, "unit": "mm"}"#).expect("valid");
    assert_eq!(millimetres, Timing { light_speed: SPEED_OF_LIGHT / 1e-3, ..Timing::new(0.0, 3.0) });
    for (text, expected) in [
        ("", "a.json:1:0: the file does not tell the axis of time"),
        ("{\n\"start_opl\": 0}", "bin_width_opl"),
        (r#"{"bin_width_opl": 0}"#, "'bin_width_opl': the width of a bin"),
        (r#"{"bin_width_opl": 1, "unwarp": "last_segmnt"}"#, "did you mean 'last_segment'?"),
        (r#"{"bin_width_opl": 1, "unit": "parsec"}"#, "known are m, cm, mm, km"),
        (r#"{"bin_width_opl": 1, "c": -1}"#, "speed of light"),
        (r#"{"bin_width_opl": 1, "version": 9}"#, "version 9"),
        (r#"{"bin_width": 1}"#, "unknown field `bin_width`"),
    ] {
        let error = read(text).expect_err(text).to_string();
        assert!(error.contains(expected), "{text}: {error}");
    }
}

#[test]
fn the_capture_of_a_wall_stays_with_its_light_and_must_fit_it() {
    let row = |y: f64| (0..2).map(|x| [f64::from(x), y, 0.1]).collect::<Vec<_>>();
    let grid: Vec<_> = (0..3).map(|y| row(f64::from(y))).collect();
    let capture = Capture {
        sensor_xyz: Some([0.0, 0.1, 1.0]),
        laser_xyz: None,
        sensor_grid_xyz: grid.clone(),
        sensor_grid_normals: grid.clone(),
        laser_grid_xyz: vec![vec![[0.0; 3]]],
        laser_grid_normals: vec![vec![[0.0, 0.0, 1.0]]],
        t_accounts_first_and_last_bounces: false,
    };
    let transient = sample().with_capture(capture.clone()).expect("it fits");
    let npz = encode_npz(&transient);
    assert_eq!(decode(TransientFormat::Npz, &npz).expect("read").capture(), Some(&capture));
    for broken in [
        Capture { sensor_grid_xyz: grid[..2].to_vec(), ..capture.clone() },
        Capture { laser_grid_xyz: grid.clone(), ..capture.clone() },
        Capture { sensor_grid_normals: vec![vec![[f64::NAN; 3]; 2]; 3], ..capture.clone() },
        Capture { t_accounts_first_and_last_bounces: true, ..capture.clone() },
    ] {
        assert!(sample().with_capture(broken.clone()).is_err(), "{broken:?}");
    }
}

#[test]
fn phasors_are_real_and_imaginary_parts() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("p.npy");
    write_phasors(&path, &sample().phasors(&[0.5]).expect("finite")).expect("written");
    assert_eq!(Array::of(&read_whole(&path).expect("there")).expect("an array").shape, [3, 2, 1, 2]);
    let facts = String::from_utf8(read_whole(&sidecar_path(&path)).expect("there")).expect("text");
    assert!(facts.contains("\"frequencies\": [\n    0.5\n  ]"), "{facts}");
    assert!(write_phasors(Path::new("a.npz"), &sample().phasors(&[0.5]).expect("finite")).is_err());
}

#[test]
fn an_array_without_an_axis_takes_the_one_that_is_given_or_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.npy");
    std::fs::write(&path, encode_values(&sample())).expect("written");
    let error = read_transient(&path, None, None).expect_err("no axis");
    assert!(error.to_string().contains("there is no") && error.to_string().contains("--bin-width"), "{error}");
    let timing = Timing::new(7.0, 0.5);
    assert_eq!(*read_transient(&path, None, Some(timing)).expect("read").timing(), timing);
}
