//! Photon mapping: walks from the lamps leave photons, walks from the camera gather them (theory §5).

use super::blocks::camera_pass;
use super::path::CAMERA_ROULETTE_FROM;
use super::photons::Photons;
use super::{Integrator, Observer, Pass, Phase, dots, pilot};
use crate::film::{Exposure, Layered, Layers, Plain, Sink};
use crate::material::Lobes;
use crate::photon::{Bandwidth, Estimate, Nearest, Photon, PhotonMap, Radius};
use crate::sampler::Sampler;
use crate::scene::description::{BandwidthRule, Direct, FilmDescription, PhotonMapSettings, Show};
use crate::scene::{Scene, SurfacePoint};
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

    fn look<S: Sink>(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        map: &PhotonMap,
        observer: &dyn Observer,
    ) -> Exposure {
        let radius = self.bandwidth.radius::<2>(pass.index);
        let estimate = Estimate { map, kernel: self.settings.kernel, radius };
        let max_bounces = self.settings.max_bounces;
        let limits = Limits { max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
        let direct = self.settings.direct;
        let samples = self.settings.samples;
        camera_pass(scene, film, pass, samples, observer, Nearest::default, |path, sampler, found, sink: &mut S| {
            let mut gather = Gather { scene, estimate: &estimate, direct, max_bounces, found, sink };
            walk(scene, path, Origin::Camera, &limits, sampler, &mut gather).rays
        })
    }
}

impl Integrator for PhotonMapping {
    fn expose(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        layers: Layers,
        observer: &dyn Observer,
    ) -> Exposure {
        let map = self.map(scene, pass, observer);
        observer.phase(Phase::Camera);
        match self.settings.show {
            Show::Radiance if layers.is_empty() => self.look::<Plain>(scene, film, pass, &map, observer),
            Show::Radiance => self.look::<Layered>(scene, film, pass, &map, observer),
            Show::Photons => dots::draw(scene, film, &map, |_| true).into(),
            Show::Caustics => dots::draw(scene, film, &map, Photon::is_caustic).into(),
        }
    }

    fn name(&self) -> &'static str {
        "photon-map"
    }
}

/// The photon map of a pass, sorted for this radius.
pub(super) fn photon_map(
    scene: &Scene,
    settings: &PhotonMapSettings,
    pass: &Pass,
    radius: Radius,
    observer: &dyn Observer,
) -> PhotonMap {
    let direct = settings.direct == Direct::Photons;
    let photons = Photons { paths: u64::from(settings.photons), max_bounces: settings.max_bounces, direct };
    photons.map(scene, pass, radius, || None, observer)
}

/// Gathers photons at smooth lobes and follows delta lobes.
struct Gather<'a, S> {
    scene: &'a Scene,
    estimate: &'a Estimate<'a>,
    direct: Direct,
    max_bounces: u32,
    found: &'a mut Nearest,
    sink: &'a mut S,
}

impl<S: Sink> Visitor for Gather<'_, S> {
    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, sampler: &mut Sampler) -> Lobes {
        self.sink.surface(point, path);
        self.sink.add(path.throughput * self.scene.emitted(point), path.bounce);
        if path.bounce < self.max_bounces && point.bsdf.lobes().meets(Lobes::SMOOTH) {
            if self.direct == Direct::NextEvent {
                let light = direct_light(self.scene, point, sampler, |_| 1.0);
                self.sink.add(path.throughput * light, path.bounce + 1);
            }
            // The event in which the photons are read is one of the path's, too.
            let light = self.estimate.radiance(point, self.max_bounces - path.bounce - 1, self.found);
            self.sink.add(path.throughput * light, path.bounce + 2);
            if S::LAYERED && self.direct == Direct::Photons && path.bounce == 0 {
                // Photons straight from a lamp, read where the camera looks: asked for once more, by themselves, so that
                // the sum above is the same with layers and without.
                self.sink.was_direct(path.throughput * self.estimate.radiance(point, 0, self.found));
            }
        }
        Lobes::DELTA
    }

    fn escaped(&mut self, path: &PathState) {
        self.sink.add(path.throughput * self.scene.background(path.ray.direction), path.bounce);
    }
}
