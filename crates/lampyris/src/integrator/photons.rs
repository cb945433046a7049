//! The photon map of a pass.

use super::blocks::{BLOCK, light_pass};
use super::{Observer, Pass, Phase, Work};
use crate::photon::{Deposit, Instead, Photon, PhotonMap, Radius};
use crate::scene::Scene;

/// Which photons a pass leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Photons {
    /// Light paths.
    pub paths: u64,
    /// How long paths may become, from lamp to eye, in scattering events.
    pub max_bounces: u32,
    /// Whether light that comes straight from a lamp is stored, too.
    pub direct: bool,
}

impl Photons {
    /// Traces the light paths and sorts their photons for this radius. With `instead`, they note what else could have
    /// made their paths.
    pub(super) fn map<'s>(
        &self,
        scene: &'s Scene,
        pass: &Pass,
        radius: Radius,
        instead: impl Fn() -> Option<Instead<'s>> + Sync,
        observer: &dyn Observer,
    ) -> PhotonMap {
        observer.phase(Phase::Photons);
        let Photons { paths, max_bounces, direct } = *self;
        // A block has some thousand paths and most paths a photon or two; growing would copy them.
        let photons = || Vec::with_capacity(2 * BLOCK as usize);
        let new = || Deposit { photons: photons(), direct, max_bounces, path: 0, parallel: false, instead: instead() };
        let blocks = light_pass(scene, pass, paths, max_bounces, observer, new);
        observer.phase(Phase::Map);
        let blocks: Vec<Vec<Photon>> = blocks.into_iter().map(|block| block.photons).collect();
        let map = PhotonMap::from_blocks(&blocks, paths, radius);
        observer.work(&Work { photons: map.photons().len() as u64, ..Work::default() });
        map
    }
}
