//! `lampyris convert`.

use lampyris::observer::Silent;
use lampyris::output::{check_scene_path, write_scene};

use crate::args::ConvertArguments;
use crate::report::{Failure, print};
use crate::scene::{heed, read, ready, warnings};

/// Writes a scene in our own format and names the files that it wrote.
///
/// # Errors
/// Whatever is wrong with the scene, as `check` tells it, or with the place of the new one.
pub fn run(arguments: &ConvertArguments) -> Result<(), Failure> {
    check_scene_path(&arguments.output)?;
    let imported = read(&arguments.scene)?;
    // What makes no sense is told while its place in the old file is known.
    let built = ready(&arguments.scene, &imported, &[], &Silent)?;
    heed(&warnings(&arguments.scene, &imported, &built), arguments.scene.strict, false)?;
    drop(built);
    for path in write_scene(&arguments.output, &imported, &arguments.scene.scene)? {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(())
}
