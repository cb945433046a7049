//! Photon mapping: walks from the lamps leave photons, walks from the camera gather them (theory §5).

use super::blocks::{BLOCK, camera_pass, light_pass};
use super::path::CAMERA_ROULETTE_FROM;
use super::{Integrator, Observer, Pass, Phase, Work, dots, pilot};
use crate::image::Image;
use crate::material::Lobes;
use crate::photon::{Bandwidth, Deposit, Estimate, Nearest, Photon, PhotonMap, Radius};
use crate::sampler::Sampler;
use crate::scene::description::{BandwidthRule, Direct, FilmDescription, PhotonMapSettings, Show};
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transport::{Limits, Origin, PathState, Visitor, direct_light, walk};

/// See the module.
#[derive(Clone, Debug)]
pub struct PhotonMapping {
    settings: PhotonMapSettings,
    bandwidth: Bandwidth,
}

impl PhotonMapping {
    /// With these settings; measures a radius by a pilot where they give none and the rule needs one.
    pub fn new(
        scene: &Scene,
        film: &FilmDescription,
        settings: PhotonMapSettings,
        seed: u64,
        observer: &dyn Observer,
    ) -> PhotonMapping {
        let count = settings.k as usize;
        let bandwidth = match (settings.bandwidth, settings.radius) {
            (BandwidthRule::Nearest, radius) => {
                Bandwidth::Nearest { count, max_radius: radius.unwrap_or(f32::INFINITY) }
            }
            (BandwidthRule::Fixed, Some(radius)) => Bandwidth::Fixed(radius),
            (BandwidthRule::Shrinking, Some(initial)) => Bandwidth::Shrinking { initial, alpha: settings.alpha },
            (rule, None) => {
                let radius = pilot::radius(scene, film, &settings, seed, observer);
                match rule {
                    BandwidthRule::Fixed => Bandwidth::Fixed(radius),
                    _ => Bandwidth::Shrinking { initial: radius, alpha: settings.alpha },
                }
            }
        };
        PhotonMapping { settings, bandwidth }
    }

    /// How the radius is chosen.
    pub fn bandwidth(&self) -> Bandwidth {
        self.bandwidth
    }

    /// The photon map of a pass.
    pub fn map(&self, scene: &Scene, pass: &Pass, observer: &dyn Observer) -> PhotonMap {
        photon_map(scene, &self.settings, pass, self.bandwidth.radius::<2>(pass.index), observer)
    }

    fn look(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        map: &PhotonMap,
        observer: &dyn Observer,
    ) -> Image {
        let radius = self.bandwidth.radius::<2>(pass.index);
        let estimate = Estimate { map, kernel: self.settings.kernel, radius };
        let max_bounces = self.settings.max_bounces;
        let limits = Limits { max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
        let next_event = self.settings.direct == Direct::NextEvent;
        let samples = self.settings.samples;
        camera_pass(scene, film, pass, samples, observer, Nearest::default, |ray, sampler, found| {
            let mut gather =
                Gather { scene, estimate: &estimate, next_event, max_bounces, found, radiance: Spectrum::ZERO };
            let path = PathState::new(ray, Spectrum::ONE);
            let walked = walk(scene, path, Origin::Camera, &limits, sampler, &mut gather);
            (gather.radiance, walked.rays)
        })
    }
}

impl Integrator for PhotonMapping {
    fn pass(&self, scene: &Scene, film: &FilmDescription, pass: &Pass, observer: &dyn Observer) -> Image {
        let map = self.map(scene, pass, observer);
        observer.phase(Phase::Camera);
        match self.settings.show {
            Show::Radiance => self.look(scene, film, pass, &map, observer),
            Show::Photons => dots::draw(scene, film, &map, |_| true),
            Show::Caustics => dots::draw(scene, film, &map, Photon::is_caustic),
        }
    }

    fn name(&self) -> &'static str {
        "photon-map"
    }
}

/// Traces the light paths of a pass and sorts their photons for this radius.
pub(super) fn photon_map(
    scene: &Scene,
    settings: &PhotonMapSettings,
    pass: &Pass,
    radius: Radius,
    observer: &dyn Observer,
) -> PhotonMap {
    observer.phase(Phase::Photons);
    let (paths, max_bounces) = (u64::from(settings.photons), settings.max_bounces);
    let direct = settings.direct == Direct::Photons;
    // A block has some thousand paths and most paths a photon or two; growing would copy them.
    let new = || Deposit { photons: Vec::with_capacity(2 * BLOCK as usize), direct, max_bounces };
    let blocks = light_pass(scene, pass, paths, max_bounces, observer, new);
    observer.phase(Phase::Map);
    let blocks: Vec<Vec<Photon>> = blocks.into_iter().map(|block| block.photons).collect();
    let map = PhotonMap::from_blocks(&blocks, paths, radius);
    observer.work(&Work { photons: map.photons().len() as u64, ..Work::default() });
    map
}

/// Gathers photons at smooth lobes and follows delta lobes.
struct Gather<'a> {
    scene: &'a Scene,
    estimate: &'a Estimate<'a>,
    next_event: bool,
    max_bounces: u32,
    found: &'a mut Nearest,
    radiance: Spectrum,
}

impl Visitor for Gather<'_> {
    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, sampler: &mut Sampler) -> Lobes {
        let mut radiance = self.scene.emitted(point);
        if path.bounce < self.max_bounces && point.bsdf.lobes().meets(Lobes::SMOOTH) {
            if self.next_event {
                radiance += direct_light(self.scene, point, None, sampler);
            }
            // The event in which the photons are read is one of the path's, too.
            radiance += self.estimate.radiance(point, self.max_bounces - path.bounce - 1, self.found);
        }
        self.radiance += path.throughput * radiance;
        Lobes::DELTA
    }

    fn escaped(&mut self, path: &PathState) {
        self.radiance += path.throughput * self.scene.background(path.ray.direction);
    }
}
