//! Pictures on the way: a PNG after 1, 2, 4, 8 ... passes.

use std::path::{Path, PathBuf};

use lampyris::error::{Result, Warning};
use lampyris::film::Film;
use lampyris::output::{check_path, write_image};

/// Writes them, and keeps count.
#[derive(Debug)]
pub struct Snapshots {
    /// The picture beside which they lie; none if they are not wanted, or no longer.
    beside: Option<PathBuf>,
    written: Vec<PathBuf>,
}

impl Snapshots {
    /// Beside this picture; none writes nothing.
    ///
    /// # Errors
    /// If files cannot be written there.
    pub fn new(beside: Option<&Path>) -> Result<Snapshots> {
        if let Some(path) = beside {
            check_path(&name(path, 1))?;
        }
        Ok(Snapshots { beside: beside.map(Path::to_path_buf), written: Vec::new() })
    }

    /// Whether there is one to be written after so many passes.
    pub fn is_due(&self, passes: u32) -> bool {
        self.beside.is_some() && passes.is_power_of_two()
    }

    /// Writes the picture so far. The first that cannot be written is the last that is tried.
    ///
    /// # Errors
    /// Why it cannot: the render may go on.
    pub fn write(&mut self, film: &Film) -> std::result::Result<(), Warning> {
        let Some(path) = self.beside.as_deref().map(|path| name(path, film.passes())) else { return Ok(()) };
        match write_image(&path, &film.image()) {
            Ok(()) => {
                self.written.push(path);
                Ok(())
            }
            Err(error) => {
                self.beside = None;
                Err(error.with_hint("the render goes on without snapshots"))
            }
        }
    }

    /// All that were written, in their order.
    pub fn written(&self) -> &[PathBuf] {
        &self.written
    }
}

/// `NAME.pass0004.png`.
fn name(beside: &Path, passes: u32) -> PathBuf {
    let stem = beside.file_stem().unwrap_or_default().to_string_lossy();
    beside.with_file_name(format!("{stem}.pass{passes:04}.png"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snapshots_lie_beside_the_picture() {
        assert_eq!(name(Path::new("a/b.box.exr"), 4), Path::new("a/b.box.pass0004.png"));
        assert_eq!(name(Path::new("c.png"), 65536), Path::new("c.pass65536.png"));
    }
}
