//! `lampyris transient`, on light by time that is made by hand.

use super::{Folder, WALL};

/// A file of one pixel for each of `light`'s columns, with its bins of a tenth of a scene unit.
fn folder_with(light: &[&[f32]]) -> Folder {
    let folder = Folder::with_scene("");
    folder.write("light.npy", array(light));
    folder.write("light.json", br#"{"start_opl": 2, "bin_width_opl": 0.1}"#);
    folder
}

/// An array of NumPy: a row of grey pixels with their bins.
fn array(light: &[&[f32]]) -> Vec<u8> {
    let header =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': (1, {}, {}, 1), }}\n", light.len(), light[0].len());
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.into_bytes());
    bytes.extend(light.iter().copied().flatten().flat_map(|value| value.to_le_bytes()));
    bytes
}

const LIGHT: &[&[f32]] = &[&[0.0, 4.0, 2.0, 0.0], &[0.0, 0.0, 0.0, 8.0]];

/// The numbers of the last column of a table.
fn last_column(table: &[u8]) -> Vec<f64> {
    let text = String::from_utf8_lossy(table).into_owned();
    text.lines().skip(1).filter_map(|line| line.rsplit(',').next()?.parse().ok()).collect()
}

#[test]
fn films_are_animated_and_begin_as_their_formats_do() {
    let folder = folder_with(LIGHT);
    let (stdout, stderr) = folder.run("transient light.npy -o a.gif -o a.apng -o b.png --video --fps 10");
    assert_eq!((stdout.as_str(), stderr.as_str()), ("", "wrote a.gif\nwrote a.apng\nwrote b.png\n"));
    assert!(folder.read("a.gif").starts_with(b"GIF89a"));
    for name in ["a.apng", "b.png"] {
        let bytes = folder.read(name);
        assert!(bytes.windows(4).any(|chunk| chunk == b"acTL") && bytes.starts_with(b"\x89PNG"), "{name}");
    }
}

#[test]
fn pictures_are_what_the_options_say() {
    let folder = folder_with(LIGHT);
    let (stdout, _) = folder.run("transient light.npy -o r.png");
    assert_eq!(stdout, "peaks from 2.15 (red) to 2.35 (violet)\n");
    for (options, expected) in [("--steady", "1 6 8"), ("--gate 2.1..2.25", "1 5 0"), ("--row 0", "4 0 0 4 0 2 0 0 8")]
    {
        folder.run(&format!("transient light.npy -o a.ppm {options}"));
        // Height and values, without the width, in units of 1.
        let text = String::from_utf8(folder.read("a.ppm")).expect("text");
        let largest: f64 =
            text.lines().nth(1).and_then(|l| l.strip_prefix("#MAX=")?.parse().ok()).expect("a largest value");
        let mut numbers =
            text.lines().skip(2).flat_map(str::split_whitespace).map(|n| n.parse::<f64>().expect("a number"));
        let (height, whole) = (numbers.nth(1).expect("a height"), numbers.next().expect("a largest integer"));
        let values: Vec<f64> = numbers.step_by(3).map(|value| (value * largest / whole).round()).collect();
        let found = [vec![height], values].concat().iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
        assert_eq!(found, expected, "{options}");
    }
}

#[test]
fn a_pixel_has_a_table_and_a_plot() {
    let folder = folder_with(LIGHT);
    folder.run("transient light.npy -o p.csv -o p.svg --pixel 0,0 -q");
    assert_eq!(last_column(&folder.read("p.csv")), [0.0, 4.0, 2.0, 0.0]);
    assert!(folder.read("p.svg").starts_with(b"<svg "));
}

#[test]
fn bins_go_to_a_folder_and_back_to_an_array() {
    let folder = folder_with(LIGHT);
    folder.run("transient light.npy -o bins/ -o again.npz --rebin 2 -q");
    assert!(folder.path("bins/000.exr").exists() && folder.path("bins/001.exr").exists());
    folder.run("transient again.npz -o p.csv --pixel 0,0 -q");
    assert_eq!(last_column(&folder.read("p.csv")), [4.0, 2.0]);
}

#[test]
fn a_pulse_spreads_light_and_keeps_it() {
    let folder = folder_with(&[&[0.0, 0.0, 0.0, 0.0, 6.0, 0.0, 0.0, 0.0, 0.0]]);
    folder.run("transient light.npy -o p.csv --pixel 0,0 --pulse gaussian:0.15 -q");
    let spread = last_column(&folder.read("p.csv"));
    assert!((spread.iter().sum::<f64>() - 6.0).abs() < 1e-5 && spread[4] < 5.0 && spread[3] > 0.5, "{spread:?}");
    folder.write("late.csv", b"length,strength\n0.0999999,1\n0.1000001,1\n");
    folder.run("transient light.npy -o p.csv --pixel 0,0 --pulse late.csv -q");
    let late = last_column(&folder.read("p.csv"));
    assert!((late[5] - 6.0).abs() < 1e-3, "{late:?}");
}

#[test]
fn a_detector_counts_the_same_for_the_same_seed_and_coates_undoes_its_pile_up() {
    let folder = folder_with(&[&[0.0, 0.5, 0.5, 0.5, 0.5]]);
    let spad = "--spad efficiency=1,pulses=1000000,first-photon=true --pixel 0,0 -q";
    let counts = |seed: u32| {
        folder.run(&format!("transient light.npy -o c.csv {spad} --seed {seed}"));
        last_column(&folder.read("c.csv"))
    };
    assert!(counts(1) == counts(1) && counts(1) != counts(2) && counts(1)[4] < counts(1)[1] / 3.0);
    folder.run(&format!("transient light.npy -o l.csv {spad} --coates"));
    // The last has the standard deviation √((e^0.5 - 1) / (10⁶ e^-1.5)) = 0.0017: 0.02 is twelve of it.
    assert!(
        last_column(&folder.read("l.csv")).iter().zip([0.0, 0.5, 0.5, 0.5, 0.5]).all(|(a, b)| (a - b).abs() < 0.02)
    );
    // The counts in a file, and back in a second run.
    folder.run("transient light.npy -o counts.npz --spad pulses=1000000,first-photon=true -q");
    folder.run(&format!("transient counts.npz -o again.csv {spad} --coates --counted"));
    assert_eq!(folder.read("again.csv"), folder.read("l.csv"));
}

#[test]
fn depths_and_phasors() {
    let folder = folder_with(LIGHT);
    let (stdout, _) = folder.run("transient light.npy -o d.csv -o d.exr --tof 100MHz");
    assert!(stdout.starts_with("depths begin again at 1.4989623\ndepths from "), "{stdout}");
    let depths = last_column(&folder.read("d.csv"));
    assert!((depths[1] - 1.175).abs() < 1e-5 && depths[0] < depths[1], "{depths:?}");
    folder.run("transient light.npy -o p.npy --phasor 0.25,1 -q");
    assert!(String::from_utf8(folder.read("p.json")).expect("text").contains("frequencies"));
}

#[test]
fn a_capture_becomes_hdf5_and_anything_else_is_told_why_not() {
    let folder = folder_with(LIGHT);
    let error = folder.refuse("transient light.npy -o a.hdf5");
    assert!(error.contains("does not tell where the wall was lit") && error.contains("\"capture\""), "{error}");
    let grid = "[[[0,0,0],[1,0,0]]]";
    let capture = format!(
        r#"{{"bin_width_opl": 0.1, "capture": {{"sensor_grid_xyz": {grid}, "sensor_grid_normals": {grid},
        "laser_grid_xyz": [[[0,0,0]]], "laser_grid_normals": [[[0,0,1]]], "t_accounts_first_and_last_bounces": false}}}}"#
    );
    folder.write("light.json", capture.as_bytes());
    folder.run("transient light.npy -o a.hdf5 -q");
    assert!(folder.read("a.hdf5").starts_with(b"\x89HDF"));
}

#[test]
fn a_render_of_a_wall_knows_where_it_was_lit_and_one_of_anything_else_is_no_capture() {
    let folder = Folder::with_scene(&WALL.replace("'single'", "'exhaustive', laser-grid = [2, 1]"));
    folder.run("render scene.toml --passes 1 -o a.hdf5 -o a.npy -q");
    folder.run("transient a.npy -o b.hdf5 -q");
    assert!(folder.read("a.hdf5") == folder.read("b.hdf5"), "straight, and by way of the array");
    let sidecar = String::from_utf8(folder.read("a.json")).expect("text");
    assert!(sidecar.contains("laser_grid_xyz") && sidecar.contains("0.5"), "{sidecar}");
    let folder = Folder::with_scene(super::SCENE);
    let error = folder.refuse("render scene.toml --set time.bins=4 -o a.hdf5");
    assert!(error.contains("the camera captures no wall"), "{error}");
}

#[cfg(unix)]
#[test]
fn mp4_is_written_by_ffmpeg_where_it_is() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder_with(LIGHT);
    let run = |path: &std::path::Path| {
        let mut command = std::process::Command::new(super::program());
        command.args(["transient", "light.npy", "-o", "a.mp4", "-q"]).current_dir(folder.path(""));
        command.env("PATH", path).output().expect("it runs")
    };
    let refused = run(&folder.path("nowhere"));
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("written by ffmpeg, which is not there"), "{said}");
    assert!(said.contains("hint: install ffmpeg, or write .apng or .gif"), "{said}");
    // One that writes down what it is given.
    folder.write(
        "ffmpeg",
        b"#!/bin/sh\n[ \"$1\" = -version ] && exit 0\nfor last; do :; done\nexec /bin/cat > \"$last\"\n",
    );
    std::fs::set_permissions(folder.path("ffmpeg"), std::fs::Permissions::from_mode(0o755)).expect("allowed");
    assert!(run(&folder.path("")).status.success());
    let bytes = folder.read("a.mp4");
    // Four pictures of two pixels; the last one has the second pixel white.
    assert_eq!((bytes.len(), &bytes[18..]), (24, &[0, 0, 0, 255, 255, 255][..]));
    // One that fails, after which nothing is left.
    folder.write("ffmpeg", b"#!/bin/sh\n[ \"$1\" = -version ] && exit 0\necho 'no such codec' >&2\nexit 1\n");
    let failed = run(&folder.path(""));
    assert!(String::from_utf8_lossy(&failed.stderr).contains("ffmpeg says: no such codec"));
    assert!(!folder.names().iter().any(|name| name.starts_with(".lampyris")), "{:?}", folder.names());
}

#[test]
fn what_cannot_be_done_is_a_sentence() {
    let folder = folder_with(LIGHT);
    folder.write("bare.npy", array(LIGHT));
    folder.write("short.npy", &array(LIGHT)[..100]);
    folder.run("transient light.npy -o light.npz");
    folder.write("broken.csv", b"0,1\n0,2\n");
    folder.write("words.csv", b"0,1\n1,x\n");
    for (arguments, expected) in [
        ("no.npy -o a.gif", "cannot read 'no.npy': no such file or folder"),
        ("scene.toml -o a.gif", "'scene.toml' names no file for light by pixel and time"),
        ("bare.npy -o a.gif", "there is no 'bare.json'"),
        ("short.npy -o a.gif --bin-width 1", "short.npy: "),
        ("light.npy -o a.gif --bin-width 1", "'light.json' tells what the bins are already"),
        ("light.npz -o a.gif --bin-width 1", "'transient.json' tells what the bins are already"),
        ("light.npy -o a.csv -o a.exr --gate 3..2 --pixel 0,0", "a gate must open before it closes"),
        ("light.npy -o a.csv -o a.exr --row 9 --pixel 0,0", "there is no row 9"),
        ("light.npy -o a.csv -o a.npy --phasor=-1,1 --pixel 0,0", "wavelengths must be numbers above 0"),
        ("light.npy -o a.csv -o b.mp4 --fps 1e9 --pixel 0,0", "between 0.1 and 240 pictures a second"),
        ("no.npy -o a.bins/", "cannot read 'no.npy'"),
        ("light.npy -o light.npy/bins/", "'light.npy' is not a folder"),
        ("bare.npy -o a.gif --bin-width 0", "the width of a bin must be a number above 0"),
        ("light.npy -o a.tiff", "known are .gif .apng .mp4"),
        ("light.npy -o a.csv", "'a.csv' needs --pixel X,Y or --tof FREQUENCY"),
        ("light.npy -o a.svg", "'a.svg' needs --pixel X,Y"),
        ("light.npy -o a.csv --pixel 2,0", "there is no pixel 2,0: the picture is 2 × 1"),
        ("light.npy -o no/a.gif", "there is no folder 'no'"),
        ("light.npy -o a.exr --row 1", "there is no row 1"),
        ("light.npy -o a.exr --gate 3..2", "a gate must open before it closes"),
        ("light.npy -o a.exr --gate 3", "a gate is two lengths or times"),
        ("light.npy -o a.exr --gate 1..2 --row 0", "cannot be used with"),
        ("light.npy -o a.gif --operator gama", "did you mean 'gamma'?"),
        ("light.npy -o a.gif --quantile 2", "the quantile must be from 0 to 1"),
        ("light.npy -o a.gif --fps 0", "between 0.1 and 240 pictures a second"),
        ("light.npy -o a.gif --spad puls=3", "did you mean 'pulses'?"),
        ("light.npy -o a.gif --spad pulses=0.5", "'pulses' of --spad must be a whole number from 1 on"),
        ("light.npy -o a.gif --spad efficiency=-1", "the efficiency of a detector must be a number from 0 on"),
        ("light.npy -o a.gif --pulse broken.csv", "the path lengths of a pulse must rise"),
        ("light.npy -o a.gif --pulse words.csv", "line 2 of the pulse is not a length and a strength"),
        ("light.npy -o a.npy --phasor 0.001,1", "cannot tell waves of 0.001"),
        ("light.npy -o a.exr --phasor 1,1", "'a.exr' cannot hold phasors"),
        ("light.npy -o a.exr --tof 0", "a frequency is a number above 0"),
    ] {
        let told = folder.refuse(&format!("transient {arguments}"));
        assert!(told.contains(expected), "{arguments}: {told}");
    }
    assert!(!folder.names().iter().any(|name| name.starts_with("a.")), "{:?}", folder.names());
}
