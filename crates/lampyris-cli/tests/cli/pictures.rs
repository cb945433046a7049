//! What the commands write when all is well.

use super::{Folder, SCENE};

#[test]
fn every_format_is_written_and_read_back() {
    let folder = Folder::with_scene(SCENE);
    let names = ["a.png", "a.ppm", "a.pfm", "a.hdr", "a.exr", "a.npy"];
    let outputs: Vec<String> = names.iter().map(|name| format!("-o {name}")).collect();
    let (stdout, stderr) = folder.run(&format!("render scene.toml {}", outputs.join(" ")));
    assert!(stdout.is_empty() && stderr.ends_with("wrote a.png, a.ppm, a.pfm, a.hdr, a.exr, a.npy\n"), "{stderr}");
    for name in names {
        let (table, _) = folder.run(&format!("compare {name} a.npy"));
        assert!(table.starts_with("relMSE "), "{name}: {table}");
    }
}

#[test]
fn without_an_output_the_picture_has_the_scenes_name() {
    let folder = Folder::with_scene(SCENE);
    let (_, stderr) = folder.run("render scene.toml");
    assert!(stderr.ends_with("wrote scene.png\n"), "{stderr}");
    assert_eq!(folder.names(), ["scene.png", "scene.toml"]);
}

#[test]
fn the_picture_is_the_same_for_any_number_of_threads() {
    let folder = Folder::with_scene(SCENE);
    for integrator in ["auto", "photon-map", "path", "light"] {
        let render = |threads: u32| {
            folder.run(&format!("render scene.toml -q --integrator {integrator} --threads {threads} -o {threads}.npy"));
            folder.read(&format!("{threads}.npy"))
        };
        let one = render(1);
        assert!(one == render(2) && one == render(5), "{integrator}");
    }
}

#[test]
fn size_seed_and_settings_change_the_picture() {
    let folder = Folder::with_scene(SCENE);
    let render = |arguments: &str| {
        folder.run(&format!("render scene.toml -q -o a.npy {arguments}"));
        folder.read("a.npy")
    };
    let plain = render("");
    assert_eq!(plain, render("--seed 0"));
    assert_eq!(plain, render("--passes 2"));
    for other in ["--seed 1", "--passes 1", "--set kernel=cone", "--size 8x7", "--set fov=50"] {
        assert_ne!(plain, render(other), "{other}");
    }
    assert_eq!(render("--size 5x4").len() - 128, 5 * 4 * 3 * 4);
}

#[test]
fn a_render_by_time_makes_at_least_one_pass() {
    let folder = Folder::with_scene(SCENE);
    let (_, stderr) = folder.run("render scene.toml --time 1ms -o a.png --stats s.json");
    assert!(stderr.contains("photon-map, 0.00 s, "), "{stderr}");
    assert!(stats(&folder)["passes"].as_u64() >= Some(1));
}

fn stats(folder: &Folder) -> serde_json::Value {
    serde_json::from_slice(&folder.read("s.json")).expect("JSON")
}

#[test]
fn statistics_say_what_the_render_did() {
    let folder = Folder::with_scene(SCENE);
    folder.run("render scene.toml -o a.png --stats s.json --passes 3 --seed 7 --threads 2 --set k=9");
    let stats = stats(&folder);
    assert_eq!(stats["integrator"], "photon-map");
    assert_eq!((&stats["settings"]["k"], &stats["seed"]), (&9.into(), &7.into()));
    assert_eq!((&stats["threads"], &stats["passes"], &stats["light_paths"]), (&2.into(), &3.into(), &900.into()));
    assert_eq!((&stats["size"], &stats["interrupted"]), (&serde_json::json!([8, 6]), &false.into()));
    let number = |value: &serde_json::Value| value.as_f64().unwrap_or(f64::NAN);
    assert!((number(&stats["flux"]["emitted"]) - 100.0).abs() < 0.1, "{stats}");
    assert!(number(&stats["relative_error"]) > 0.0 && number(&stats["rays"]) > 900.0, "{stats}");
    let stages = ["load", "build", "pilot", "photons", "map", "camera", "write"];
    let sum: f64 = stages.iter().map(|stage| number(&stats["seconds"][stage])).sum();
    let total = number(&stats["seconds"]["total"]);
    assert!((sum - total).abs() <= 1e-6 * total, "{sum} of {total}");
    if cfg!(target_os = "linux") {
        assert!(number(&stats["peak_memory_bytes"]) > 1e5, "{stats}");
    }
}

#[test]
fn photons_are_written_as_ply_and_csv() {
    let folder = Folder::with_scene(SCENE);
    folder.run("photons scene.toml -q -o a.csv --set photons=3000");
    folder.run("photons scene.toml -q -o a.ply --set photons=3000");
    let csv = String::from_utf8(folder.read("a.csv")).expect("text");
    let mut lines = csv.lines();
    let names = lines.next().expect("a line of names");
    assert!(names.starts_with("x,y,z,nx,ny,nz,dx,dy,dz,red,green,blue,flux_r,"), "{names}");
    let rows: Vec<Vec<f32>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect()).collect();
    assert!(rows.len() > 50 && rows.iter().all(|row| row.len() == 18), "{}", rows.len());
    // The light hits the floor directly, and through the ball.
    assert!(rows.iter().any(|row| row[16] == 0.0) && rows.iter().any(|row| row[17] == 1.0));

    let ply = folder.read("a.ply");
    let end = ply.windows(11).position(|window| window == b"end_header\n").expect("a header") + 11;
    let header = String::from_utf8(ply[..end].to_vec()).expect("text");
    assert!(header.contains(&format!("element vertex {}\n", rows.len())), "{header}");
    assert_eq!(ply.len() - end, rows.len() * (9 * 4 + 3 + 4 * 4 + 4 + 1));

    let caustics = |settings: &str| {
        folder.run(&format!("photons scene.toml -q -o a.csv --set photons=3000 {settings}"));
        folder.read("a.csv").iter().filter(|&&byte| byte == b'\n').count() - 1
    };
    assert!(caustics("--set direct=next-event") < rows.len(), "direct photons are left out on demand");
}

#[test]
fn tone_mapping_and_comparing_work_on_what_a_render_wrote() {
    let folder = Folder::with_scene(SCENE);
    folder.run("render scene.toml -q -o a.exr");
    folder.run("render scene.toml -q -o b.exr --seed 1");
    let operators = "clamp equalize equalize-clamp gamma gamma-clamp reinhard reinhard-local filmic";
    for operator in operators.split(' ') {
        folder.run(&format!("tonemap a.exr -o {operator}.png --operator {operator} --exposure -0.5"));
        assert!(folder.read(&format!("{operator}.png")).starts_with(b"\x89PNG"));
    }
    let (same, _) = folder.run("compare a.exr a.exr");
    assert!(same.contains("relMSE              0\n") && same.contains("mean ratio          1\n"), "{same}");
    let (other, _) = folder.run("compare a.exr b.exr -o difference.pfm");
    assert!(!other.contains("relMSE              0\n"), "{other}");
    assert!(folder.read("difference.pfm").starts_with(b"PF"));
}

#[test]
fn info_and_check_tell_of_the_scene() {
    let folder = Folder::with_scene(SCENE);
    let (checked, _) = folder.run("check scene.toml");
    assert_eq!(checked, "ok: scene.toml: 2 shapes, 0 triangles, 1 light\n");
    let (info, stderr) = folder.run("info scene.toml");
    for row in [
        "integrator    photon-map: ",
        "passes        2, seed 0\n",
        "film          8 × 6 pixels, box filter",
        "camera        pinhole at (0, 1, -4), looks along (0, -0.124, 0.9923)\n",
        "shapes        2 (quad 1, sphere 1)\n",
        "bounds        (-3, 0, -3) to (3, 1.5, 3)\n",
        "materials     2 (diffuse 1, glass 1)\n",
        "lights        1, 100 W (100, 100, 100) in all\n",
        "warnings      none\n",
    ] {
        assert!(info.contains(row), "no '{row}' in:\n{info}");
    }
    assert!(stderr.is_empty(), "{stderr}");
}

#[test]
fn progress_is_plain_lines_without_a_terminal_and_nothing_if_quiet() {
    let folder = Folder::with_scene(SCENE);
    let (_, stderr) = folder.run("render scene.toml --passes 5 -o a.png --threads 1");
    let starts: Vec<&str> = stderr.lines().map(|line| line.split([',', ':', ';']).next().unwrap_or("")).collect();
    let passes = &starts[1..starts.len() - 2];
    assert_eq!(passes, ["pass 1 of 5", "pass 2 of 5", "pass 4 of 5"], "{stderr}");
    assert_eq!(starts[0], "rendering scene.toml");
    assert!(!stderr.contains('\u{1b}') && !stderr.contains('\r'), "{stderr:?}");
    assert_eq!(folder.run("render scene.toml -q -o a.png"), (String::new(), String::new()));
}

#[test]
fn the_schema_is_json() {
    let (schema, _) = Folder::with_scene(SCENE).run("schema");
    serde_json::from_str::<serde_json::Value>(&schema).expect("JSON");
}

/// As `lampyris info scene.toml | head -0` does.
#[test]
fn a_reader_who_leaves_early_is_no_error() {
    let folder = Folder::with_scene(SCENE);
    let mut child = std::process::Command::new(super::program())
        .args(["info".as_ref(), folder.path("scene.toml").as_os_str()])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("it runs");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!((output.status.code(), output.stderr), (Some(0), Vec::new()));
}

#[test]
fn snapshots_are_the_picture_at_each_doubling_of_passes() {
    let folder = Folder::with_scene(SCENE);
    let (_, stderr) = folder.run("render scene.toml -o a.exr -o b.png --passes 5 --snapshots --stats s.json");
    assert!(stderr.ends_with("wrote a.exr, b.png and 3 snapshots\n"), "{stderr}");
    let names = ["a.pass0001.png", "a.pass0002.png", "a.pass0004.png"];
    assert_eq!(stats(&folder)["snapshots"], serde_json::json!(names));
    assert_eq!(folder.names(), [&["a.exr"], &names[..], &["b.png", "s.json", "scene.toml"]].concat());
    for (name, passes) in names.iter().zip([1, 2, 4]) {
        folder.run(&format!("render scene.toml -q -o c.png --passes {passes}"));
        assert_eq!(folder.read(name), folder.read("c.png"), "{name}");
    }
}

#[test]
fn layers_are_in_exr_files_unless_unwanted() {
    let folder = Folder::with_scene(SCENE);
    let layer = |file: &str, name: &str| {
        let output = folder.lampyris(&format!("tonemap {file} -o l.pfm --operator clamp --layer {name}")).output();
        output.expect("it runs").status.code()
    };
    folder.run("render scene.toml -q -o a.exr");
    folder.run("render scene.toml -q -o b.exr --layers none");
    folder.run("render scene.toml -q -o c.exr --layers depth,normal");
    for name in
        ["albedo", "normal", "depth", "position", "direct", "indirect", "caustic", "emission", "variance", "samples"]
    {
        let is_asked = matches!(name, "depth" | "normal");
        let codes = ["a.exr", "b.exr", "c.exr"].map(|file| layer(file, name));
        assert_eq!(codes, [Some(0), Some(2), Some(if is_asked { 0 } else { 2 })], "{name}");
    }
    for other in ["b.exr", "c.exr"] {
        let (table, _) = folder.run(&format!("compare a.exr {other}"));
        assert!(table.contains("largest difference  0\n"), "{other}: {table}");
    }
    let message = folder.refuse("render scene.toml -o d.png --layers depth");
    assert!(message.starts_with("error: only .exr files hold layers"), "{message}");
}

#[test]
fn exr_files_say_where_they_come_from() {
    let folder = Folder::with_scene(SCENE);
    folder.run("render scene.toml -q -o a.exr --seed 7 --passes 3");
    let bytes = folder.read("a.exr");
    let has = |text: &str| bytes.windows(text.len()).any(|window| window == text.as_bytes());
    for text in ["lampyris:scene", "render scene.toml -q -o a.exr --seed 7 --passes 3", "photon-map", "Lampyris 0."] {
        assert!(has(text), "{text}");
    }
    for name in ["command", "version", "integrator", "seed", "passes", "seconds"] {
        assert!(has(&format!("lampyris:{name}\0")), "{name}");
    }
}

const COMMANDS: [&str; 8] = ["render", "photons", "info", "check", "tonemap", "compare", "completions", "man"];

#[test]
fn completions_know_every_command() {
    let folder = Folder::with_scene(SCENE);
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let (script, _) = folder.run(&format!("completions {shell}"));
        for word in COMMANDS.iter().chain(&["integrator", "snapshots"]) {
            assert!(script.contains(word), "{shell} knows no {word}");
        }
    }
}

#[test]
fn man_pages_are_written_for_every_command() {
    let folder = Folder::with_scene(SCENE);
    folder.run("man -o share/man1");
    let page = |name: &str| String::from_utf8(folder.read(&format!("share/man1/{name}.1"))).expect("text");
    let main = page("lampyris");
    for command in COMMANDS {
        assert!(main.contains(&format!("lampyris\\-{command}")), "{command}");
        assert!(page(&format!("lampyris-{command}")).contains(&format!(".TH lampyris-{command} 1")), "{command}");
    }
    assert!(page("lampyris-render").contains("snapshots"));
    assert!(!folder.path("share/man1/lampyris-schema.1").exists(), "hidden commands stay hidden");
}
