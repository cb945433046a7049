//! Photons: what a walk from a lamp leaves behind, and how light is read from it (theory §5).

mod bandwidth;
mod deposit;
mod gather;
mod grid;
mod kernel;
mod map;
mod nearest;
mod search;
mod sort;
mod tree;
mod volume;

use glam::Vec3;

pub use bandwidth::{Bandwidth, Radius, shrunk};
pub use deposit::{Deposit, Instead};
pub use gather::Estimate;
pub use kernel::Kernel;
pub use map::{Nearest, PhotonMap};
pub use volume::{Beam, Volume, VolumeMap};

use crate::material::Lobes;
use crate::spectrum::Spectrum;
use crate::transport::PathState;

/// Where flux arrived on a surface with a smooth lobe.
///
/// It fills a line of the processor's cache, and does not lie across two.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Photon {
    /// Where it landed.
    pub position: Vec3,
    /// Where it was going, unit length.
    pub direction: Vec3,
    /// Normal of the geometry, on the side on which it landed.
    pub normal: Vec3,
    /// Optical length of its path since the lamp, in scene units.
    pub optical_length: f32,
    /// Flux in W, as if its path were the only one of its pass.
    pub flux: Spectrum,
    /// What else could have made its path: see [`Rivals::at`](crate::transport::Rivals::at); 0 where nobody asks.
    pub rivals: f32,
    /// The number of its path in the pass.
    pub path: u32,
    /// Scattering events before it landed.
    pub bounce: u16,
    /// Which events these were.
    pub history: Lobes,
}

impl Photon {
    /// Whether it came from the lamp by mirrors and glass alone, and by at least one of them.
    pub fn is_caustic(&self) -> bool {
        PathState::is_caustic_history(self.history)
    }
}
