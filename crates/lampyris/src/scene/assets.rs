//! What a scene needs from outside, already decoded.

use std::sync::Arc;

use crate::error::{Error, Result};
use crate::geometry::MeshData;
use crate::medium::VolumeData;
use crate::texture::Raster;

/// Meshes, pictures and grids by the names that a description gives them. The library itself opens no file:
/// [`import::Files`](crate::import::Files) does for programs that have a file system.
///
/// [`build`](super::build) asks from many threads, first ahead for all that a scene needs, then again for each thing as
/// its turn comes: what someone still holds should be given to all who ask, without being read again.
pub trait Assets: Sync {
    /// Mesh number `index` of `file`.
    fn mesh(&self, file: &str, index: u32) -> Result<Arc<MeshData>>;

    /// The picture in `file`. Files with 8 or 16 bits a channel hold 0..1, decoded from sRGB unless `raw`; others hold
    /// linear values of any size.
    fn picture(&self, file: &str, raw: bool) -> Result<Arc<Raster>>;

    /// The grid of numbers in `file`; by default there are none.
    fn volume(&self, file: &str) -> Result<Arc<VolumeData>> {
        Err(Error::new(format!("cannot read '{file}': this scene has no grids")))
    }
}

/// For scenes that need nothing from outside.
pub struct NoAssets;

impl Assets for NoAssets {
    fn mesh(&self, file: &str, _: u32) -> Result<Arc<MeshData>> {
        Err(Error::new(format!("cannot read '{file}': this scene has no files")))
    }

    fn picture(&self, file: &str, _: bool) -> Result<Arc<Raster>> {
        Err(Error::new(format!("cannot read '{file}': this scene has no files")))
    }
}
