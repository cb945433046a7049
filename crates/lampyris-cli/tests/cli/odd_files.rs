//! Meshes from the wild, some of them broken: each renders or is refused with a sentence.

use std::path::{Path, PathBuf};

use super::{Folder, SCENE};

/// The odd files of this folder; none, said on stderr, where the collection is not there.
#[allow(clippy::print_stderr)]
fn files(folder: &str) -> Vec<PathBuf> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes/odd-files")).join(folder);
    let Ok(entries) = std::fs::read_dir(&path) else {
        eprintln!("left out: {} is not there", path.display());
        return Vec::new();
    };
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let is_mesh = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "obj" || ending == "ply");
    paths.filter(is_mesh).collect()
}

/// Renders a scene with the mesh in the middle; returns the names of those that were refused.
fn refused(folder: &str) -> Vec<String> {
    let mut refused = Vec::new();
    for path in files(folder) {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let mesh = format!("type = \"mesh\"\nfile = \"{name}\"");
        let place = Folder::with_scene(&SCENE.replace("type = \"sphere\"\ncenter = [0, 1, 0]\nradius = 0.5", &mesh));
        std::fs::copy(&path, place.path(&name)).expect("copied");
        let output = place.lampyris("render scene.toml -q -o a.png --passes 1").output().expect("it runs");
        let stderr = String::from_utf8_lossy(&output.stderr);
        match output.status.code() {
            Some(0) => assert!(place.path("a.png").exists(), "{name}: {stderr}"),
            Some(2) => {
                assert!(stderr.starts_with("error: ") && stderr.contains(&name), "{name}: {stderr}");
                assert!(!place.path("a.png").exists(), "{name}");
                refused.push(name);
            }
            other => panic!("{name}: {other:?}: {stderr}"),
        }
    }
    refused.sort();
    refused
}

#[test]
fn obj_files() {
    refused("OBJ");
}

#[test]
fn ply_files() {
    refused("PLY");
}

#[test]
fn broken_files() {
    let refused = refused("invalid");
    assert_eq!(refused.len(), files("invalid").len(), "{refused:?}");
}
