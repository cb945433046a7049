//! Bad input is a sentence: what is wrong, where, what to try; exit code 2; nothing half-written.

use super::{Folder, SCENE};

/// The message about the scene after `from`, which is in it, became `to`; rendering and checking must agree on it.
fn changed(from: &str, to: &str) -> String {
    assert!(SCENE.contains(from), "{from}");
    scene(&SCENE.replacen(from, to, 1))
}

fn scene(text: &str) -> String {
    let folder = Folder::with_scene(text);
    let message = folder.refuse("render scene.toml -o a.png");
    assert_eq!(folder.refuse("check scene.toml"), message);
    message
}

/// Asserts that a message has all of these parts, in this order.
fn says(message: &str, parts: &[&str]) {
    let mut rest = message;
    for part in parts {
        match rest.find(part) {
            Some(at) => rest = &rest[at + part.len()..],
            None => panic!("no '{part}' in:\n{message}"),
        }
    }
}

#[test]
fn a_missing_file() {
    let message = Folder::with_scene(SCENE).refuse("render missing.toml");
    assert_eq!(message, "error: cannot read 'missing.toml': no such file or folder\n");
}

#[test]
fn an_empty_file() {
    says(&scene(""), &["error: scene.toml: the scene file is empty\n", "hint: a scene needs"]);
}

#[test]
fn bytes_that_are_not_text() {
    let folder = Folder::with_scene("");
    folder.write("scene.toml", b"# caf\xe9\n[camera]\n");
    let message = folder.refuse("render scene.toml -o a.png");
    says(&message, &["error: byte 5 of the file (0xe9) is not UTF-8 text\n", "scene.toml:1:6\n", "hint: save"]);
}

#[test]
fn a_line_that_is_not_toml() {
    says(&changed("radius = 0.5", "radius = "), &["error: ", "scene.toml:26:", "radius = "]);
}

#[test]
fn a_value_of_another_type() {
    let message = changed("radius = 0.5", "radius = \"big\"");
    says(&message, &["error: 'radius' must be a number", "scene.toml:26:10\n", "26 | radius = \"big\"\n", "^^^^^\n"]);
}

#[test]
fn an_unknown_key() {
    let message = changed("radius = 0.5", "radus = 0.5");
    says(&message, &["error: unknown key 'radus'", "scene.toml:26:1\n", "^^^^^", "hint: did you mean 'radius'?"]);
}

#[test]
fn a_sphere_without_radius() {
    says(&changed("radius = 0.5", "radius = 0"), &["radius must be greater than 0, not 0", "scene.toml:26:10\n"]);
}

#[test]
fn numbers_that_are_none() {
    let nan = changed("center = [0, 1, 0]", "center = [0, nan, 0]");
    says(&nan, &["error: 'center[1]' must be a number, not nan\n", "scene.toml:25:14\n"]);
    let infinity = changed("origin = [0, 1, -4]", "origin = [0, inf, -4]");
    says(&infinity, &["error: 'origin[1]' must be a number, not inf\n", "scene.toml:2:14\n"]);
    let power = changed("power = 100", "power = 1e99");
    says(&power, &["error: ", "scene.toml:32:"]);
}

#[test]
fn a_surface_that_makes_light() {
    let message = changed("{ type = \"glass\" }", "{ type = \"coefficients\", kd = 0.5, ks = 0.4, kt = 0.3 }");
    says(&message, &["kd + ks + kt is 1.2", "scene.toml:27:", "hint: a surface cannot send back more light"]);
}

#[test]
fn a_camera_without_directions() {
    let camera = "target = [0, 0.5, 0]";
    let parallel = changed(camera, "left = [1, 0, 0]\nup = [2, 0, 0]\nforward = [0, 0, 1]");
    says(&parallel, &["error: the camera's axes lie in one plane", "scene.toml:4:", "hint: "]);
    let along_up = changed(camera, "target = [0, 5, -4]");
    says(&along_up, &["error: the camera looks along its own up direction", "scene.toml:", "hint: "]);
    let nowhere = changed(camera, "target = [0, 1, -4]");
    says(&nowhere, &["error: the camera's target is the camera itself", "scene.toml:3:"]);
}

#[test]
fn no_camera_and_no_light() {
    let shapes = &SCENE[SCENE.find("[film]").expect("it is there")..];
    says(&scene(shapes), &["error: scene.toml: the scene has no camera\n", "hint: add one"]);
    let dark = &SCENE[..SCENE.find("[[lights]]").expect("it is there")];
    says(&scene(dark), &["error: scene.toml: the scene has no light\n", "hint: add a light"]);
}

#[test]
fn a_light_without_power() {
    says(&changed("power = 100", "power = 0"), &["error: the light has no power", "scene.toml:32:", "hint: "]);
    let neither = changed("power = 100", "");
    says(&neither, &["error: the light needs either an intensity or a power", "scene.toml:29:"]);
}

#[test]
fn a_mesh_with_a_corner_that_is_not_there() {
    let folder = Folder::with_scene(&SCENE.replace("type = \"sphere\"\ncenter = [0, 1, 0]\nradius = 0.5", MESH));
    folder.write("ball.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    says(&folder.refuse("render scene.toml -o a.png"), &["error: there is no vertex 4\n", "ball.obj:4:7\n", "hint: "]);
    let message = Folder::with_scene(&SCENE.replace("type = \"sphere\"\ncenter = [0, 1, 0]\nradius = 0.5", MESH))
        .refuse("render scene.toml -o a.png");
    says(&message, &["error: cannot read 'ball.obj': no such file or folder\n", "scene.toml:25:8\n"]);
}

const MESH: &str = "type = \"mesh\"\nfile = \"ball.obj\"";

#[test]
fn a_mesh_that_promises_more_than_it_has() {
    let folder = Folder::with_scene(
        &SCENE.replace("type = \"sphere\"\ncenter = [0, 1, 0]\nradius = 0.5", "type = \"mesh\"\nfile = \"ball.ply\""),
    );
    folder.write(
        "ball.ply",
        "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n\
         property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n1234",
    );
    says(
        &folder.refuse("render scene.toml -o a.png"),
        &["error: ", "'ball.ply'", "promises 4000000000", "only 4 bytes", "scene.toml:25:8\n"],
    );
}

#[test]
fn places_where_nothing_can_be_written() {
    let folder = Folder::with_scene(SCENE);
    std::fs::create_dir(folder.path("folder.png")).expect("a folder");
    let refuse = |arguments: &str| folder.refuse(&format!("render scene.toml {arguments}"));
    let missing = "cannot write 'no/a.png': there is no folder 'no'";
    says(&refuse("-o no/a.png"), &["error: ", missing, "hint: create it first"]);
    says(&refuse("-o folder.png"), &["error: cannot write 'folder.png': it is a folder\n"]);
    says(&refuse("-o scene.toml/a.png"), &["error: cannot write 'scene.toml/a.png'"]);
    says(&refuse("-o a.jpg"), &["error: ", "'.jpg' names no picture format", "hint: known are .exr"]);
    says(&refuse("-o a"), &["error: ", "no extension", "hint: known are .exr"]);
    says(&refuse("-o a.png --stats no/s.json"), &["error: cannot write 'no/s.json': there is no folder 'no'"]);
    says(&refuse("-o a.png --stats folder.png"), &["error: cannot write 'folder.png': it is a folder"]);
    says(&refuse("-o a.png --stats a.png"), &["error: 'a.png' cannot hold both", "hint: give --stats another file"]);
    let photons = folder.refuse("photons scene.toml -o a.obj");
    says(&photons, &["error: cannot write photons to 'a.obj'", "hint: photons can be written as .ply or .csv"]);
}

#[cfg(target_os = "linux")]
#[test]
fn disks_that_are_full_and_folders_that_take_no_files() {
    let folder = Folder::with_scene(SCENE);
    let proc = folder.refuse("render scene.toml -o /proc/a.png -q");
    says(&proc, &["error: cannot write '/proc/a.png': no file can be made in '/proc'\n"]);
    std::os::unix::fs::symlink("/dev/full", folder.path("full.png")).expect("a link");
    let full = folder.refuse("render scene.toml -o full.png -q");
    assert_eq!(full, "error: cannot write 'full.png': the disk is full\n");
    let stdout = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("a full disk");
    let check = std::process::Command::new(super::program())
        .args(["check".as_ref(), folder.path("scene.toml").as_os_str()])
        .stdout(stdout)
        .output()
        .expect("it runs");
    assert_eq!(check.status.code(), Some(2));
    says(&String::from_utf8_lossy(&check.stderr), &["error: cannot write to the standard output: "]);
}

#[test]
fn arguments_that_make_no_sense() {
    let folder = Folder::with_scene(SCENE);
    let refuse = |arguments: &str| folder.refuse(&format!("render scene.toml -o a.png {arguments}"));
    says(&refuse("--size 0x0"), &["error: invalid value '0x0'", "at least 1 pixel wide and high"]);
    says(&refuse("--size 99999x99999"), &["error: a picture of 99999×99999 is too large"]);
    says(&refuse("--threads 0"), &["error: invalid value '0' for '--threads <N>'"]);
    says(&refuse("--integrator pathh"), &["error: unknown integrator 'pathh'\n", "hint: did you mean 'path'?"]);
    says(&refuse("--set kernl=cone"), &["error: unknown setting 'kernl'\n", "hint: did you mean 'kernel'?"]);
    says(&refuse("--set kernel=con"), &["error: 'kernel' must be 'box'", "did you mean 'cone'?"]);
    says(&refuse("--set k=0"), &["error: 'k' must be at least 1\n"]);
    says(&refuse("--set k"), &["error: invalid value 'k' for '--set <KEY=VALUE>'"]);
    says(&refuse("--set target=0,1,-4"), &["error: --set target=0,1,-4: the camera's target is the camera itself"]);
    says(&refuse("--define spp=4"), &["error: scene.toml: cannot define 'spp'", "hint: "]);
    says(&refuse("--passes 1 --time 1s"), &["error: the argument '--passes <N>' cannot be used with"]);
    says(&folder.refuse("render scene.blend"), &["error: ", "unknown scene format '.blend'", "hint: "]);
}

#[test]
fn warnings_under_strict() {
    let plane = SCENE.replace(
        "type = \"quad\"\ncorner = [-3, 0, -3]\nu = [0, 0, 6]\nv = [6, 0, 0]",
        "type = \"plane\"\nnormal = [0, 1, 0]\ndistance = 0",
    );
    let sun = plane.replace("type = \"point\"\nposition = [0, 3, 0]\npower = 100", "type = \"constant\"");
    let folder = Folder::with_scene(&sun);
    let strict = folder.refuse("render scene.toml --strict -o a.png");
    says(&strict, &["error: scene.toml: photons from infinitely far away", "hint: "]);
    assert_eq!(folder.refuse("info scene.toml --strict"), strict);
    let (_, told) = folder.run("check scene.toml");
    assert_eq!(told, strict.replace("error: ", "warning: "));
    assert_eq!(folder.run("render scene.toml --quiet -o a.png"), (String::new(), String::new()));
}

#[test]
fn pictures_that_are_none() {
    let folder = Folder::with_scene(SCENE);
    folder.write("a.png", b"");
    folder.write("b.png", b"\x89PNG\r\n\x1a\n and no more");
    folder.write("c.pfm", b"PF\n2 1\n-1\n\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0");
    folder.write("d.pfm", b"PF\n1 1\n-1\n\0\0\0\0\0\0\0\0\0\0\0\0");
    says(&folder.refuse("tonemap a.png -o t.png"), &["error: a.png: the file is empty, not a picture\n"]);
    says(&folder.refuse("tonemap b.png -o t.png"), &["error: b.png: "]);
    says(&folder.refuse("tonemap no.png -o t.png"), &["error: cannot read 'no.png': no such file or folder\n"]);
    says(&folder.refuse("tonemap scene.toml -o t.png"), &["error: scene.toml: not a picture", "hint: known are"]);
    says(&folder.refuse("tonemap c.pfm -o no/t.png"), &["error: cannot write 'no/t.png': there is no folder 'no'"]);
    says(&folder.refuse("tonemap c.pfm -o t.png --operator gama"), &["error: ", "hint: did you mean 'gamma'?"]);
    says(&folder.refuse("tonemap c.pfm -o t.png --white -1"), &["error: the white of reinhard must be a positive"]);
    says(&folder.refuse("compare c.pfm d.pfm"), &["error: ", "2 × 1 and 1 × 1", "hint: render both"]);
    says(&folder.refuse("compare c.pfm no.pfm"), &["error: cannot read 'no.pfm'"]);
    says(&folder.refuse("compare c.pfm c.pfm -o d.gif"), &["error: ", "'.gif' names no picture format"]);
}
