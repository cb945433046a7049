//! Any scene file, by the ending of its name.

use std::path::Path;

use super::files::mesh_extension;
use super::{Imported, gltf, mitsuba, obj_scene, pbrt, toml};
use crate::error::{Error, Result, did_you_mean};

/// Endings of the scene files that [`load`] reads.
pub const FORMATS: [&str; 8] = ["toml", "xml", "pbrt", "gltf", "glb", "obj", "ply", "stl"];

/// What a user may say about how a scene file is to be read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// Values for the parameters that a Mitsuba scene declares with `<default>`, by name.
    pub defines: Vec<(String, String)>,
}

/// Reads the scene file at `path`, in the format that its ending names.
///
/// # Errors
/// A file that cannot be read, an unknown ending, and whatever is wrong in the file, with its place.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Imported> {
    if path.is_dir() {
        return Err(Error::new(format!("'{}' is a folder, not a scene file", path.display())));
    }
    let ending = mesh_extension(path);
    if let ("toml" | "pbrt" | "gltf" | "glb" | "obj" | "ply" | "stl", Some((name, _))) =
        (ending.as_str(), options.defines.first())
    {
        return Err(Error::new(format!("cannot define '{name}': a .{ending} scene has no parameters"))
            .with_file(path)
            .with_hint("to change a setting, use --set"));
    }
    match ending.as_str() {
        "toml" => toml::read(path),
        "xml" => mitsuba::read(path, &mitsuba::Options { defines: options.defines.clone() }),
        "pbrt" => pbrt::read(path),
        "gltf" | "glb" => gltf::read(path),
        "obj" => obj_scene::read(path),
        "ply" | "stl" => obj_scene::read_mesh(path),
        "" => Err(Error::new(format!("cannot read '{}': its name has no ending", path.display())).with_hint(known())),
        other => {
            let error = Error::new(format!("cannot read '{}': unknown scene format '.{other}'", path.display()));
            Err(match did_you_mean(other, FORMATS) {
                Some(near) => error.with_hint(format!("did you mean '.{near}'?")),
                None => error.with_hint(known()),
            })
        }
    }
}

fn known() -> String {
    format!("scene files end in .{}", FORMATS.join(", ."))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(path: &Path) -> String {
        load(path, &LoadOptions::default()).expect_err("it must not load").to_string()
    }

    #[test]
    fn an_unknown_ending_names_the_known_ones() {
        let message = message(Path::new("scene.blend"));
        assert_eq!(
            message,
            "cannot read 'scene.blend': unknown scene format '.blend'; scene files end in .toml, .xml, .pbrt, .gltf, .glb, .obj, .ply, .stl"
        );
    }

    #[test]
    fn a_name_without_ending_names_the_known_ones() {
        assert_eq!(
            message(Path::new("scene")),
            "cannot read 'scene': its name has no ending; scene files end in .toml, .xml, .pbrt, .gltf, .glb, .obj, .ply, .stl"
        );
    }

    #[test]
    fn a_folder_is_not_a_scene() {
        let folder = tempfile::tempdir().expect("a folder");
        assert!(message(folder.path()).ends_with("is a folder, not a scene file"));
    }

    #[test]
    fn a_missing_file_is_named() {
        assert_eq!(message(Path::new("missing.toml")), "cannot read 'missing.toml': no such file or folder");
    }

    #[test]
    fn the_ending_may_be_in_capitals() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("SCENE.TOML");
        std::fs::write(&path, "[camera]\norigin = [0, 0, 1]\n").expect("a file");
        assert!(load(&path, &LoadOptions::default()).expect("it loads").description.camera.is_some());
    }

    #[test]
    fn a_definition_for_a_file_without_parameters_is_an_error() {
        let options = LoadOptions { defines: vec![("spp".into(), "4".into())] };
        let error = load(Path::new("scene.toml"), &options).expect_err("nothing to define");
        assert_eq!(error.message, "cannot define 'spp': a .toml scene has no parameters");
    }
}
