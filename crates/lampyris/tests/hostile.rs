//! Files that want to do harm, and those that the fuzzer starts from: whatever a file says, a reader answers with a scene
//! or a sentence.

#![allow(clippy::print_stderr, reason = "tests say what they leave out")]

#[path = "common/readers.rs"]
mod readers;

use std::fs;
use std::path::{Path, PathBuf};

use self::readers::{READERS, Workbench};

#[test]
fn no_file_of_the_fuzzers_corpus_does_harm() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    if !corpus.is_dir() {
        eprintln!("left out: there is no folder {}", corpus.display());
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let bench = Workbench::new(folder.path()).expect("a folder to write to");
    for reader in READERS {
        for file in files(&corpus.join(reader)) {
            if let Err(error) = bench.feed(reader, &fs::read(&file).expect("a file")) {
                assert!(!error.message.is_empty(), "{}", file.display());
            }
        }
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    entries.map(|entry| entry.expect("an entry").path()).collect()
}

/// What is wrong with these bytes.
fn fault(reader: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let bench = Workbench::new(folder.path()).expect("a folder to write to");
    match bench.feed(reader, bytes) {
        Err(error) => error.to_string(),
        Ok(()) => format!("no error in {reader} {:.300}", String::from_utf8_lossy(bytes)),
    }
}

const CAMERA: &str = "camera = { origin = [0, 0, 5], target = [0, 0, 0] }\n";

#[test]
fn textures_that_multiply_are_refused() {
    let mix = |number: usize| {
        let inner = number - 1;
        format!("t{number} = {{ type = 'mix', weight = 't{inner}', first = 't{inner}', second = 't{inner}' }}\n")
    };
    let textures: String = (1..8).map(mix).collect();
    let shape = "[[shapes]]\ntype = 'sphere'\nmaterial = { type = 'diffuse', reflectance = 't7' }\n".repeat(1000);
    let text = format!(
        "{CAMERA}lights = [{{ type = 'constant' }}]\n[textures]\nt0 = {{ type = 'vertex-color' }}\n{textures}{shape}"
    );
    assert!(fault("toml", text.as_bytes()).contains("textures together"));
}

#[test]
fn a_chain_of_materials_is_not_followed_to_the_end_of_the_stack() {
    let link = |number: usize| format!("m{number} = {{ type = 'two-sided', front = 'm{}' }}\n", number - 1);
    let chain: String = (1..50_000).map(link).collect();
    let text = format!(
        "{CAMERA}lights = [{{ type = 'constant' }}]\nshapes = [{{ type = 'sphere', material = 'm49999' }}]\n\
         [materials]\nm0 = {{ type = 'diffuse' }}\n{chain}"
    );
    assert!(fault("toml", text.as_bytes()).contains("is too deep in others"));
}

#[test]
fn a_thousand_skies_are_refused() {
    let skies = "[[lights]]\ntype = 'sky'\nsun-direction = [0, 1, 0]\n".repeat(1000);
    assert!(fault("toml", format!("{CAMERA}{skies}").as_bytes()).contains("more than 64 skies"));
}

/// What a file of each kind does that means harm or makes no sense, and a piece of the sentence that refuses it.
#[test]
fn tricks_are_refused_with_a_sentence() {
    let mesh = |header: &str| format!("ply\nformat ascii 1.0\n{header}end_header\n");
    let toml = |shape: &str| format!("{CAMERA}lights = [{{ type = 'constant' }}]\nshapes = [{{ {shape} }}]\n");
    let xml = |content: &str| format!("<scene version='3.0.0'><sensor type='perspective'/>{content}</scene>");
    let pbrt = |content: &str| format!("Camera \"perspective\" WorldBegin LightSource \"point\" {content}");
    let entities = "<!DOCTYPE a [<!ENTITY b 'x'><!ENTITY c '&b;&b;&b;&b;&b;&b;&b;&b;'>]><scene>&c;</scene>";
    let buffer = |uri: &str| {
        format!(
            r#"{{ "asset": {{ "version": "2.0" }}, "scenes": [{{ "nodes": [0] }}], "nodes": [{{ "mesh": 0 }}],
            "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": 0 }} }}] }}],
            "accessors": [{{ "bufferView": 0, "componentType": 5126, "count": 1000000000, "type": "VEC3" }}],
            "bufferViews": [{{ "buffer": 0, "byteLength": 12000000000 }}],
            "buffers": [{{ "uri": "{uri}", "byteLength": 12000000000 }}] }}"#
        )
    };
    let billion = "element vertex 1000000000\nproperty float x\nproperty float y\nproperty float z\n";
    let cases: [(&str, String, &str); 27] = [
        // Entities and circles.
        ("mitsuba", entities.to_string(), "document type declarations are not read"),
        ("mitsuba", xml("<include filename='a.xml'/>"), "includes itself"),
        ("pbrt", "Include \"a.pbrt\"".to_string(), "includes itself"),
        // Paths that lead away.
        ("gltf", buffer("/etc/passwd"), "absolute"),
        ("gltf", buffer("https://example.org/a.bin"), "not a file beside the scene"),
        ("mitsuba", xml("<include filename='/dev/zero'/>"), "a pipe or a device"),
        ("pbrt", "Include \"/dev/zero\"".to_string(), "a pipe or a device"),
        ("toml", toml("type = 'mesh', file = '/dev/zero.ply'"), "no such file"),
        // A billion things, of which none is there.
        ("ply", mesh(billion), "its header promises 1000000000"),
        ("gltf", buffer("data:,abc"), "12000000000 bytes"),
        ("stl", format!("{:80}\0\u{1}\u{1}\u{1}and no more", ""), "promises"),
        ("picture", "P6 100000 100000 255\n".to_string(), "too large"),
        ("picture", "PF\n10000 10000\n-1\n".to_string(), "too short"),
        // Geometry that is nowhere.
        ("obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_string(), "not a finite number"),
        ("obj", "v 1e39 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_string(), "not a finite number"),
        ("stl", "solid\nvertex nan 0 0\nvertex 1 0 0\nvertex 0 1 0\n".to_string(), "is not finite"),
        ("toml", toml("type = 'sphere', center = [nan, 0, 0]"), "must be a number, not nan"),
        ("pbrt", pbrt("Shape \"sphere\" \"float radius\" nan"), "not a finite number"),
        ("mitsuba", xml("<shape type='sphere'><float name='radius' value='inf'/></shape>"), "not a finite number"),
        ("toml", toml("type = 'sphere', center = [3e38, 0, 0], transform = [{ scale = 10 }]"), "too far away"),
        // Transforms that flatten.
        ("toml", toml("type = 'cube', transform = [{ scale = [1, 0, 1] }]"), "singular"),
        ("pbrt", pbrt("Scale 1 0 1 Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]"), "singular"),
        (
            "mitsuba",
            xml(
                "<emitter type='constant'/><shape type='cube'><transform name='to_world'><scale value='0'/></transform></shape>",
            ),
            "singular",
        ),
        // Pictures without a pixel.
        ("picture", "P6 0 5 255\n".to_string(), "no pixels"),
        ("picture", "PF\n0 0\n-1\n".to_string(), "no pixels"),
        ("texture", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 0\n".to_string(), "no pixels"),
        // Settings beyond reason.
        ("settings", "film.size=[100000, 100000]\n".to_string(), "too large"),
    ];
    let wrong: Vec<String> = cases
        .iter()
        .map(|(reader, text, expected)| (fault(reader, text.as_bytes()), expected))
        .filter(|(message, expected)| !message.contains(*expected))
        .map(|(message, expected)| format!("'{expected}' is not in: {message}"))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Triangles without an area, and normals and coordinates that are none, are no harm.
#[test]
fn degenerate_triangles_are_read_and_rendered() {
    let folder = tempfile::tempdir().expect("a folder");
    let bench = Workbench::new(folder.path()).expect("a folder to write to");
    let points = "v 0 0 0\nv 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nvt nan inf\nvn 0 0 0\nvn nan 0 0\n";
    let faces = "f 1 2 5\nf 1 3 4\nf 1/1/1 3/1/2 5/1/1\nf 1 1 1\nf 1 3\n";
    bench.feed("obj", format!("{points}{faces}").as_bytes()).expect("one triangle is whole");
    bench.feed("obj", b"v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n").expect("a point");
}
