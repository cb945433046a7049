//! What files mean and how they are refused, from files in memory.

mod documents;
mod groups;
mod hostile;
mod lights;
mod materials;
mod media;
mod mutations;
mod odd;
mod parts;
mod real_files;
mod textures;
mod transients;
mod views;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::source::Folder;
use super::{Imported, Options, read_from};
use crate::error::{Error, Result};
use crate::scene::description::{MaterialDescription, MaterialRef, Paint, ShapeDescription};

/// Files by name.
struct Memory(HashMap<PathBuf, Vec<u8>>);

impl Folder for Memory {
    fn read(&self, file: &Path) -> std::io::Result<Vec<u8>> {
        self.0.get(file).cloned().ok_or(std::io::ErrorKind::NotFound.into())
    }

    fn has(&self, file: &Path) -> bool {
        self.0.contains_key(file)
    }

    fn shown(&self, file: &Path) -> PathBuf {
        file.to_path_buf()
    }
}

/// Reads the first of these files.
fn read_files(files: &[(&str, &str)], defines: &[(&str, &str)]) -> Result<Imported> {
    let memory = files.iter().map(|(name, text)| (PathBuf::from(name), text.as_bytes().to_vec())).collect();
    let defines = defines.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    read_from(&Memory(memory), Path::new(files[0].0), &Options { defines })
}

/// Reads the content of a version 3 scene.
fn scene(content: &str) -> Result<Imported> {
    read_files(&[("a.xml", &format!("<scene version=\"3.0.0\">\n{content}\n</scene>"))], &[])
}

/// Reads one that must be good, and without a word.
fn clean(content: &str) -> Imported {
    let imported = scene(content).expect("the scene is valid");
    assert_eq!(messages(&imported), Vec::<String>::new());
    imported
}

fn fault(content: &str) -> Error {
    scene(content).expect_err("the scene is wrong")
}

fn messages(imported: &Imported) -> Vec<String> {
    imported.warnings.iter().map(ToString::to_string).collect()
}

fn inner(material: &MaterialRef) -> &MaterialDescription {
    match material {
        MaterialRef::Inline(material) => material,
        MaterialRef::Named(name) => panic!("'{name}' should stand here itself"),
    }
}

fn close(found: [f32; 3], wanted: [f32; 3]) {
    assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?} is not {wanted:?}");
}

fn shape(content: &str) -> ShapeDescription {
    clean(&format!("<shape {content}</shape>")).description.shapes.remove(0)
}

fn placed(kind: &str, steps: &str) -> ShapeDescription {
    shape(&format!("type='{kind}'><transform name='to_world'>{steps}</transform>"))
}

fn material(bsdf: &str) -> MaterialDescription {
    let imported = clean(&format!("<shape type='sphere'>{bsdf}</shape>"));
    inner(imported.description.shapes[0].material.as_ref().expect("a material")).clone()
}

const GREY: &str = "<bsdf type='diffuse'/>";

fn grey() -> MaterialDescription {
    MaterialDescription::Diffuse { reflectance: Paint::grey(0.5) }
}

/// What its front is made of, of a material black from behind.
fn front(bsdf: &str) -> MaterialDescription {
    match material(bsdf) {
        MaterialDescription::TwoSided { front, back: Some(_) } => inner(&front).clone(),
        other => panic!("{other:?} is not black from behind"),
    }
}

/// Black from behind.
fn one_sided(front: MaterialDescription) -> MaterialDescription {
    let black = MaterialDescription::Diffuse { reflectance: Paint::grey(0.0) };
    MaterialDescription::TwoSided {
        front: MaterialRef::Inline(Box::new(front)),
        back: Some(MaterialRef::Inline(Box::new(black))),
    }
}
