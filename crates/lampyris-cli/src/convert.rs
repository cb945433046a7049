//! `lampyris convert`.

use lampyris::output::{check_scene_path, write_scene};

use crate::args::ConvertArguments;
use crate::report::{Failure, print};
use crate::scene::read;

/// Writes a scene in our own format and names the files that it wrote.
///
/// # Errors
/// Whatever is wrong with the scene file, or with the place of the new one.
pub fn run(arguments: &ConvertArguments) -> Result<(), Failure> {
    check_scene_path(&arguments.output)?;
    let imported = read(&arguments.scene)?;
    crate::scene::heed(&imported.warnings, arguments.scene.strict, false)?;
    for path in write_scene(&arguments.output, &imported, &arguments.scene.scene)? {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(())
}
