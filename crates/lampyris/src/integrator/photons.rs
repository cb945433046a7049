//! The photon maps of a pass.

use super::blocks::{BLOCK, light_pass};
use super::volume::VolumeEstimate;
use super::{Observer, Pass, Phase, Work};
use crate::photon::{Deposit, Instead, Photon, PhotonMap, Radius, Volume, VolumeMap};
use crate::scene::Scene;

/// Which photons a pass leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Photons {
    /// Light paths.
    pub paths: u64,
    /// How long paths may become, from lamp to eye, in scattering events.
    pub max_bounces: u32,
    /// Whether light that comes straight from a lamp is stored on surfaces, too.
    pub direct: bool,
    /// How light in media is estimated, if there are any.
    pub volume: Option<VolumeEstimate>,
}

/// What the photons of a pass left.
#[derive(Debug)]
pub(super) struct Maps {
    /// On surfaces.
    pub surface: PhotonMap,
    /// In media.
    pub volume: Option<VolumeMap>,
}

impl Photons {
    /// Traces the light paths and sorts their photons for this radius. With `instead`, they note what else could have
    /// made their paths.
    pub(super) fn maps<'s>(
        &self,
        scene: &'s Scene,
        pass: &Pass,
        radius: Radius,
        instead: impl Fn() -> Option<Instead<'s>> + Sync,
        observer: &dyn Observer,
    ) -> Maps {
        observer.phase(Phase::Photons);
        let Photons { paths, max_bounces, direct, .. } = *self;
        // Most paths have a photon or two; growing would copy them.
        let photons = || Vec::with_capacity(2 * BLOCK as usize);
        let (volume, volume_paths) =
            self.volume.map_or((Volume::Points, 0), |estimate| (estimate.volume, estimate.paths.min(paths)));
        let new = || Deposit {
            photons: photons(),
            volume,
            volume_paths,
            direct,
            direct_in_media: self.volume.is_some_and(|estimate| estimate.direct > 0.0),
            ..Deposit::on_surfaces(max_bounces, instead())
        };
        let blocks = light_pass(scene, pass, paths, max_bounces, observer, new);
        observer.phase(Phase::Map);
        let (blocks, beams): (Vec<Vec<Photon>>, Vec<_>) =
            blocks.into_iter().map(|block| (block.photons, block.beams)).unzip();
        let surface = PhotonMap::from_blocks(&blocks, paths, radius);
        let volume = self.volume.filter(|_| scene.has_media()).map(|estimate| estimate.map(beams, volume_paths, pass));
        let left = surface.photons().len() + volume.as_ref().map_or(0, |map| map.beams().len());
        observer.work(&Work { photons: left as u64, ..Work::default() });
        Maps { surface, volume }
    }
}
