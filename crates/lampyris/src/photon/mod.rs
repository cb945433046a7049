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

/// Where flux arrived on a surface with a smooth lobe, in 80 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(16))]
pub struct Photon {
    /// Where it landed.
    pub position: Vec3,
    /// Where it was going, unit length.
    pub direction: Vec3,
    /// Normal of the geometry, on the side on which it landed.
    pub normal: Vec3,
    /// Optical length of its path since the lamp, in scene units.
    pub optical_length: f32,
    /// Length of the last segment of its path, in scene units; infinite where its light came in parallel.
    pub reach: f32,
    /// How much slower light is where it was than where its path began: by the ratio of indices, or of group indices.
    pub slowness: f32,
    /// Flux in W, as if its path were the only one of its pass.
    pub flux: Spectrum,
    /// |cos| of its direction to the shading normal where it landed, over that to the geometry's: 1 without shading normals.
    pub shading: f32,
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
    /// Optical length of its path if that ended at a point near it, where light is so slow: as a spherical
    /// wave from where the path turned last, or as a plane wave. So a kernel's radius does not blur time to first order
    /// (theory §8), and nothing comes before the shortest path. In scene units.
    #[inline]
    pub fn optical_length_at(&self, at: Vec3, slowness: f32) -> f64 {
        let offset = at - self.position;
        let further = if self.reach.is_finite() {
            (offset + self.direction * self.reach).length() - self.reach
        } else {
            offset.dot(self.direction)
        };
        f64::from(slowness) * (f64::from(self.optical_length / self.slowness) + f64::from(further))
    }

    /// Whether it came from the lamp by mirrors and glass alone, and by at least one of them.
    pub fn is_caustic(&self) -> bool {
        PathState::is_caustic_history(self.history)
    }
}
