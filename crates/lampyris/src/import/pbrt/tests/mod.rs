//! What files mean and how they are refused, from files in memory.

mod files;
mod hostile;
mod materials;
mod media;
mod mutations;
mod parts;
mod real_files;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::super::source::Folder;
use super::read_from;
use crate::error::{Error, Result};
use crate::import::Imported;
use crate::scene::description::{MaterialDescription, MaterialRef, ShapeDescription};

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
fn read_files(files: &[(&str, &[u8])]) -> Result<Imported> {
    let memory = files.iter().map(|(name, bytes)| (PathBuf::from(name), bytes.to_vec())).collect();
    read_from(&Memory(memory), Path::new(files[0].0))
}

/// Reads a file.
fn scene(text: &str) -> Result<Imported> {
    read_files(&[("a.pbrt", text.as_bytes())])
}

/// Reads one that must be good, and without a word.
fn clean(text: &str) -> Imported {
    let imported = scene(text).expect("the scene is valid");
    assert_eq!(messages(&imported), Vec::<String>::new());
    imported
}

fn fault(text: &str) -> Error {
    scene(text).expect_err("the scene is wrong")
}

fn messages(imported: &Imported) -> Vec<String> {
    imported.warnings.iter().map(ToString::to_string).collect()
}

/// The only shape of a scene that must be good.
fn shape(text: &str) -> ShapeDescription {
    let mut shapes = clean(text).description.shapes;
    assert_eq!(shapes.len(), 1);
    shapes.remove(0)
}

/// The material of the only shape, and what is said about it.
fn material(text: &str) -> (MaterialDescription, Vec<String>) {
    let mut imported = scene(&format!("{text}\nShape \"sphere\"")).expect("the scene is valid");
    let messages = messages(&imported);
    match imported.description.shapes.remove(0).material.expect("a material") {
        MaterialRef::Inline(material) => (*material, messages),
        MaterialRef::Named(name) => {
            (imported.description.materials.remove(&name).expect("it is in the scene"), messages)
        }
    }
}

fn inner(material: &MaterialRef) -> &MaterialDescription {
    match material {
        MaterialRef::Inline(material) => material,
        MaterialRef::Named(name) => panic!("'{name}' should stand here itself"),
    }
}
