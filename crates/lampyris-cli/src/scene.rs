//! From a scene's arguments to a scene.

use lampyris::checkpoint::Identity;
use lampyris::error::{Error, Result, Warning};
use lampyris::import::load::{LoadOptions, load};
use lampyris::import::{Files, Imported};
use lampyris::observer::Observer;
use lampyris::scene::{Assets, Built, NotedAssets, build_observed};

use crate::args::{ChangeArguments, SceneArguments};
use crate::report::{Failure, warn};

/// Reads the scene file and checks what it sets.
///
/// # Errors
/// Whatever is wrong with the file, with its place.
pub fn read(arguments: &SceneArguments) -> Result<Imported> {
    let imported = load(&arguments.scene, &LoadOptions { defines: arguments.defines.clone() })?;
    match imported.description.check_settings() {
        Ok(()) => Ok(imported),
        Err(error) => Err(located(error, arguments, &imported)),
    }
}

/// Changes what the file sets to what the command line does.
///
/// # Errors
/// An unknown key, or a value that makes no sense.
pub fn change(imported: &mut Imported, changes: &ChangeArguments) -> Result<()> {
    let scene = &mut imported.description;
    for (key, value) in &changes.settings {
        scene.set(key, value)?;
    }
    if let Some(seed) = changes.seed {
        scene.render.seed = seed;
    }
    scene.check_settings()
}

/// Builds the scene, with the files beside it, and tells `observer` how that is getting on.
///
/// # Errors
/// Whatever makes no sense in it, with its place.
pub fn ready(
    arguments: &SceneArguments,
    imported: &Imported,
    set: &[(String, String)],
    observer: &dyn Observer,
) -> Result<Built> {
    ready_with(arguments, imported, set, observer, &files(arguments, imported, observer))
}

/// [`ready`], and by what the scene with its settings is known again.
///
/// # Errors
/// As [`ready`].
pub fn ready_identified(
    arguments: &SceneArguments,
    imported: &Imported,
    set: &[(String, String)],
    observer: &dyn Observer,
) -> Result<(Built, Identity)> {
    let files = files(arguments, imported, observer);
    let noted = NotedAssets::new(&files);
    let built = ready_with(arguments, imported, set, observer, &noted)?;
    let identity = Identity::new(noted.fingerprint(&imported.description), &imported.description);
    Ok((built, identity))
}

fn files<'o>(arguments: &SceneArguments, imported: &Imported, observer: &'o dyn Observer) -> Files<'o> {
    Files::beside(&arguments.scene).with_embedded(imported.embedded.clone()).observed(observer)
}

fn ready_with(
    arguments: &SceneArguments,
    imported: &Imported,
    set: &[(String, String)],
    observer: &dyn Observer,
    assets: &dyn Assets,
) -> Result<Built> {
    build_observed(&imported.description, assets, observer).map_err(|error| {
        match error.key.as_deref().and_then(|key| set.iter().find(|(name, _)| names(name, key))) {
            // The line in the file is not to blame for what the command line put in its place.
            Some((name, value)) => Error::new(format!("--set {name}={value}: {}", error.message)),
            None => located(error, arguments, imported),
        }
    })
}

/// The same error where the scene file says what it is about, or at least with the file's name.
fn located(error: Error, arguments: &SceneArguments, imported: &Imported) -> Error {
    let error = imported.places.locate(error);
    if error.place.is_some() { error } else { error.with_file(&arguments.scene) }
}

/// Whether a setting of this name changes the key, or a part of it: `up` does `camera.up`.
fn names(setting: &str, key: &str) -> bool {
    let (setting, key) = (setting.replace('_', "-"), key.trim_start_matches('/'));
    let in_section = ["integrator.", "film.", "camera.", "render."].iter().find_map(|name| key.strip_prefix(name));
    key == setting || in_section == Some(&setting)
}

/// Tells of warnings, unless `quiet`.
///
/// # Errors
/// The warnings themselves, if `strict`.
pub fn heed(warnings: &[Warning], strict: bool, quiet: bool) -> Result<(), Failure> {
    if strict {
        return Failure::if_any(warnings.to_vec());
    }
    if !quiet {
        warnings.iter().for_each(warn);
    }
    Ok(())
}

/// All that the user should know of: what the file has that we leave out, and what is odd about the scene.
pub fn warnings(arguments: &SceneArguments, imported: &Imported, built: &Built) -> Vec<Warning> {
    let odd = built.warnings.iter();
    imported.warnings.iter().chain(odd).map(|warning| located(warning.clone(), arguments, imported)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_names_its_key_with_or_without_the_section() {
        assert!(names("up", "camera.up") && names("camera.up", "camera.up"));
        assert!(names("focus_distance", "camera.focus-distance"));
        assert!(!names("up", "shapes[0].up") && !names("p", "camera.up"));
    }
}
