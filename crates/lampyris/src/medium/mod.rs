//! Participating media: what is between surfaces, and what light does there (theory §9).

mod flight;
mod grid;
mod inside;
mod phase;
mod tracking;

pub use flight::{Flight, Matter};
pub use grid::{Cloud, Grid, VolumeData};
pub use inside::{Inside, Interior};
pub use phase::{Phase, Table};
pub use tracking::{Depth, Fading};

use std::sync::Arc;

use crate::spectrum::{Basis, Spectrum};

/// The number of a medium in its scene.
pub type MediumId = u16;

/// What fills space somewhere.
#[derive(Clone, Debug)]
pub struct Medium {
    /// Extinction coefficient σ_t in 1/(scene unit), linear RGB.
    pub extinction: Spectrum,
    /// Scattering coefficient σ_s in 1/(scene unit), linear RGB, no more than the extinction.
    pub scattering: Spectrum,
    /// Where scattered light goes.
    pub phase: Phase,
    /// What the coefficients are multiplied by, where that is not the same everywhere.
    pub cloud: Option<Arc<Cloud>>,
    /// Mean optical path length, in scene units, by which a particle holds back the light that it scatters.
    pub delay: f32,
}

impl Medium {
    /// Whether light of different colours flies differently far.
    pub fn is_coloured(&self) -> bool {
        let [r, g, b] = self.extinction.to_rgb();
        r != g || g != b
    }

    /// The medium, of this number, as the light of a pass meets it.
    #[inline]
    pub fn matter<'m>(&'m self, id: MediumId, basis: &'m Basis) -> Matter<'m> {
        Matter {
            id,
            extinction: basis.lanes(self.extinction),
            scattering: basis.lanes(self.scattering),
            phase: &self.phase,
            cloud: self.cloud.as_deref(),
            delay: self.delay,
            basis,
        }
    }
}
