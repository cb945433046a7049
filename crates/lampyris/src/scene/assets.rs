//! What a scene needs from outside, already decoded.

use std::sync::Arc;

use crate::error::{Error, Result};
use crate::geometry::MeshData;
use crate::image::Image;

/// Meshes and pictures by the names that a description gives them. The library itself opens no file:
/// [`import::Files`](crate::import::Files) does for programs that have a file system.
pub trait Assets: Sync {
    /// Mesh number `index` of `file`.
    fn mesh(&self, file: &str, index: u32) -> Result<Arc<MeshData>>;

    /// The picture in `file`. Values of files with 8 or 16 bits a channel lie in 0..1 and are linear, decoded
    /// from sRGB unless `raw`.
    fn image(&self, file: &str, raw: bool) -> Result<Arc<Image>>;
}

/// For scenes that need nothing from outside.
pub struct NoAssets;

impl Assets for NoAssets {
    fn mesh(&self, file: &str, _: u32) -> Result<Arc<MeshData>> {
        Err(Error::new(format!("cannot read '{file}': this scene has no files")))
    }

    fn image(&self, file: &str, _: bool) -> Result<Arc<Image>> {
        Err(Error::new(format!("cannot read '{file}': this scene has no files")))
    }
}
