//! What files mean and how they are refused, from files in memory.

mod materials;
mod meshes;
mod mutations;
mod real_files;
mod refusals;
mod scenes;

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::read_bytes;
use crate::error::{Error, Result};
use crate::geometry::MeshData;
use crate::import::Imported;
use crate::scene::description::{GeometryDescription, MaterialDescription, MaterialRef};

/// A buffer of these bytes.
fn buffer(bytes: &[u8]) -> Value {
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(bytes));
    json!({ "uri": uri, "byteLength": bytes.len() })
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// A file with one triangle, (0 0 0), (1 0 0), (0 1 0), with texture coordinates, in one node.
fn triangle() -> Value {
    let positions = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let uvs = [0.0, 0.0, 1.0, 0.0, 0.0, 0.25];
    json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 } }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 24 }
        ],
        "buffers": [buffer(&floats(&[&positions[..], &uvs[..]].concat()))]
    })
}

/// The triangle with parts changed: pointers into the JSON, and what stands there.
fn changed(changes: &[(&str, Value)]) -> Value {
    let mut file = triangle();
    for (pointer, value) in changes {
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        match file.pointer_mut(parent).expect("it exists") {
            Value::Array(list) => match key.parse::<usize>() {
                Ok(at) if at < list.len() => list[at] = value.clone(),
                _ => list.push(value.clone()),
            },
            object => object[key] = value.clone(),
        }
    }
    file
}

fn read(file: &Value) -> Result<Imported> {
    read_bytes(Path::new("a.gltf"), file.to_string().as_bytes())
}

/// Reads a file that must be good.
fn good(changes: &[(&str, Value)]) -> Imported {
    read(&changed(changes)).expect("the file is valid")
}

fn fault(changes: &[(&str, Value)]) -> Error {
    read(&changed(changes)).expect_err("the file is wrong")
}

fn messages(imported: &Imported) -> Vec<&str> {
    imported.warnings.iter().map(|warning| warning.message.as_str()).collect()
}

/// The triangles of a shape.
fn mesh(imported: &Imported, shape: usize) -> &MeshData {
    match &imported.description.shapes[shape].geometry {
        GeometryDescription::Triangles(data) => data,
        other => panic!("no triangles: {other:?}"),
    }
}

/// The material of the first shape.
fn material(imported: &Imported) -> &MaterialDescription {
    match &imported.description.shapes[0].material {
        Some(MaterialRef::Named(name)) => &imported.description.materials[name],
        other => panic!("no named material: {other:?}"),
    }
}

fn inner(material: &MaterialRef) -> &MaterialDescription {
    match material {
        MaterialRef::Inline(material) => material,
        MaterialRef::Named(name) => panic!("'{name}' should stand here itself"),
    }
}

/// The same without what makes it two-sided.
fn front(material: &MaterialDescription) -> &MaterialDescription {
    match material {
        MaterialDescription::TwoSided { front, back: None } => inner(front),
        other => other,
    }
}

/// A binary container.
fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let length = 12 + 8 + json.len() + 8 + binary.len();
    let word = |number: usize| (number as u32).to_le_bytes();
    [b"glTF", &word(2)[..], &word(length), &word(json.len()), b"JSON", json, &word(binary.len()), b"BIN\0", binary]
        .concat()
}

/// The triangle as a `.glb`.
fn triangle_glb() -> Vec<u8> {
    let positions = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.25]);
    let file = changed(&[("/buffers/0", json!({ "byteLength": 60 }))]);
    glb(file.to_string().as_bytes(), &positions)
}
