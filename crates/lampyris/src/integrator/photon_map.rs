//! Photon mapping: walks from the lamps leave photons, walks from the camera gather them (theory §5).

use serde::{Deserialize, Serialize};

use super::blocks::{CameraPass, Eye};
use super::merge::note;
use super::path::CAMERA_ROULETTE_FROM;
use super::photons::{Maps, Photons};
use super::reuse::Lending;
use super::volume::{MediumPhotons, VolumeEstimate, Wishes};
use super::{Integrator, Observer, Pass, Phase, dots, pilot};
use crate::error::Result;
use crate::film::{Arrival, Exposure, Layers, Sink};
use crate::material::Lobes;
use crate::photon::{Bandwidth, Estimate, Nearest, Photon, PhotonMap, Radius, VolumeMap};
use crate::sampler::Sampler;
use crate::scene::description::{BandwidthRule, Direct, FilmDescription, PhotonMapSettings, Show};
use crate::scene::{Scene, SurfacePoint};
use crate::transport::{Crossing, Limits, Origin, PathState, Segment, Visitor, direct_light, walk};

/// See the module.
#[derive(Clone, Debug)]
pub struct PhotonMapping {
    settings: PhotonMapSettings,
    pilot: Pilot,
    bandwidth: Bandwidth,
}

/// What is measured before the first pass.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Pilot {
    /// The first radius, where the settings give none and need one.
    radius: Option<f32>,
    /// How light in media is estimated, where there are any.
    volume: Option<VolumeEstimate>,
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
        let is_needed = settings.radius.is_none() && settings.bandwidth != BandwidthRule::Nearest;
        let radius = is_needed.then(|| pilot::radius(scene, film, &settings, seed, observer));
        let bandwidth = bandwidth(&settings, radius.unwrap_or(f32::INFINITY));
        let wishes = Wishes {
            volume: settings.volume,
            radius: settings.volume_radius,
            alpha: settings.volume_alpha,
            kernel: settings.kernel,
            shrinks: settings.bandwidth != BandwidthRule::Fixed,
            count: settings.k as usize,
            enough: None,
        };
        let volume = VolumeEstimate::new(scene, film, wishes, photons(&settings, None), seed, observer);
        PhotonMapping { settings, pilot: Pilot { radius, volume }, bandwidth }
    }

    /// With these settings, and what was measured for them.
    pub(super) fn resumed(settings: PhotonMapSettings, pilot: Pilot) -> Result<PhotonMapping> {
        let is_needed = settings.radius.is_none() && settings.bandwidth != BandwidthRule::Nearest;
        let is_fit = pilot.radius.is_some() == is_needed
            && pilot.radius.is_none_or(|radius| radius.is_finite() && radius > 0.0)
            && pilot.volume.is_none_or(|volume| volume.is_fit());
        let bandwidth = bandwidth(&settings, pilot.radius.unwrap_or(f32::INFINITY));
        is_fit.then_some(PhotonMapping { settings, pilot, bandwidth }).ok_or_else(pilot::unfit)
    }

    /// How the radius is chosen.
    pub fn bandwidth(&self) -> Bandwidth {
        self.bandwidth
    }

    /// The photon map of a pass.
    pub fn map(&self, scene: &Scene, pass: &Pass, observer: &dyn Observer) -> PhotonMap {
        self.maps(scene, pass, observer).surface
    }

    fn maps(&self, scene: &Scene, pass: &Pass, observer: &dyn Observer) -> Maps {
        let radius = self.bandwidth.radius::<2>(pass.index);
        photons(&self.settings, self.pilot.volume).maps(scene, pass, radius, || None, observer)
    }
}

impl Integrator for PhotonMapping {
    fn expose_in_parts(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        layers: Layers,
        observer: &dyn Observer,
        arrived: &mut dyn FnMut(&[Arrival]),
    ) -> Exposure {
        let maps = self.maps(scene, pass, observer);
        observer.phase(Phase::Camera);
        match self.settings.show {
            Show::Radiance => {
                let Maps { surface, volume } = &maps;
                let radius = self.bandwidth.radius::<2>(pass.index);
                let estimate = Estimate { map: surface, kernel: self.settings.kernel, radius };
                let PhotonMapSettings { direct, max_bounces, samples, .. } = self.settings;
                let limits = Limits { max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
                let eye = Gathering { estimate, volume: volume.as_ref(), direct, limits };
                CameraPass { scene, film, pass, samples, layers, observer }.expose(&eye, arrived)
            }
            Show::Photons => dots::draw(scene, film, &maps.surface, |_| true).into(),
            Show::Caustics => dots::draw(scene, film, &maps.surface, Photon::is_caustic).into(),
        }
    }

    fn area(&self, pass: &Pass) -> Option<f64> {
        // What blurs media shrinks at another rate: two kinds of bias cannot be told by one.
        let is_alone = self.pilot.volume.is_none() && self.settings.show == Show::Radiance;
        self.bandwidth.area(pass.index).filter(|_| is_alone)
    }

    fn name(&self) -> &'static str {
        "photon-map"
    }

    fn pilot(&self) -> Vec<u8> {
        pilot::write(&self.pilot)
    }
}

/// How the radius is chosen by settings; `measured` stands in where they give none.
fn bandwidth(settings: &PhotonMapSettings, measured: f32) -> Bandwidth {
    let radius = settings.radius.unwrap_or(measured);
    match settings.bandwidth {
        BandwidthRule::Nearest => Bandwidth::Nearest { count: settings.k as usize, max_radius: radius },
        BandwidthRule::Fixed => Bandwidth::Fixed(radius),
        BandwidthRule::Shrinking => Bandwidth::Shrinking { initial: radius, alpha: settings.alpha },
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
    photons(settings, None).maps(scene, pass, radius, || None, observer).surface
}

/// Which photons these settings ask for.
fn photons(settings: &PhotonMapSettings, volume: Option<VolumeEstimate>) -> Photons {
    let (paths, max_bounces) = (u64::from(settings.photons), settings.max_bounces);
    Photons { paths, max_bounces, direct: settings.direct == Direct::Photons, volume }
}

/// Reads the photons of a pass.
struct Gathering<'a> {
    estimate: Estimate<'a>,
    volume: Option<&'a VolumeMap>,
    direct: Direct,
    limits: Limits,
}

impl Eye for Gathering<'_> {
    type Working = Nearest;

    fn look<S: Sink>(
        &self,
        scene: &Scene,
        path: PathState,
        sampler: &mut Sampler,
        found: &mut Nearest,
        sink: &mut S,
        _: Option<Lending<S>>,
    ) -> u32 {
        let Gathering { ref estimate, volume, direct, limits } = *self;
        let mut gather = Gather { scene, estimate, volume, direct, max_bounces: limits.max_bounces, found, sink };
        walk(scene, path, Origin::Camera, &limits, sampler, &mut gather).rays
    }
}

/// Gathers photons at smooth lobes and follows delta lobes.
struct Gather<'a, S> {
    scene: &'a Scene,
    estimate: &'a Estimate<'a>,
    volume: Option<&'a VolumeMap>,
    direct: Direct,
    max_bounces: u32,
    found: &'a mut Nearest,
    sink: &'a mut S,
}

impl<S: Sink> Visitor for Gather<'_, S> {
    const CROSSING: Crossing = Crossing::Fade;

    fn segment(&mut self, segment: &Segment, path: &PathState, sampler: &mut Sampler) {
        if let Some(map) = self.volume {
            let photons = MediumPhotons { map, max_bounces: self.max_bounces, sharing: None };
            photons.gather(segment, path, sampler, self.sink, |_, _| {});
        }
    }

    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, sampler: &mut Sampler) -> Lobes {
        self.sink.surface(point, path);
        self.sink.add(path.throughput * self.scene.emitted(point), path.met(0), path.optical_length);
        if path.bounce < self.max_bounces && point.bsdf.lobes().meets(Lobes::SMOOTH) {
            if self.direct == Direct::NextEvent {
                let (light, distance) =
                    direct_light(self.scene, point, self.scene.vista(&point.surface), path, sampler, |_, _| 1.0);
                let optical_length = path.optical_length + f64::from(path.slowness * distance);
                self.sink.add(path.throughput * light, path.met(1), optical_length);
            }
            // The event in which the photons are read is one of the path's, too.
            let most = self.max_bounces - path.bounce - 1;
            if S::LAYERED {
                // Photons straight from a lamp are direct light where they are read and the camera looks.
                let looks = self.direct == Direct::Photons && path.bounce == 0;
                let radius = self.estimate.find(point, self.found);
                let weights = |photon: &Photon| {
                    let counts = u32::from(photon.bounce) <= most;
                    [counts, looks && photon.bounce == 0, counts && photon.is_caustic()].map(f32::from)
                };
                let tell = |photon: &Photon, light| note(self.sink, photon, light, point, path);
                let ([light, direct, caustic], unit) = self.estimate.weighted(point, radius, self.found, weights, tell);
                self.sink.add_noted(path.throughput * light, path.bounce + 2, path.throughput * unit);
                self.sink.was_direct(path.throughput * direct);
                self.sink.was_caustic(path.throughput * caustic);
            } else {
                let light = self.estimate.radiance(point, most, self.found);
                self.sink.add(path.throughput * light, path.met(2), path.optical_length);
            }
        }
        Lobes::DELTA
    }

    fn escaped(&mut self, path: &PathState) {
        let distance = self.scene.distance_from_far(path.ray.origin, path.ray.direction);
        let optical_length = path.optical_length + f64::from(path.slowness * distance);
        self.sink.add(path.throughput * self.scene.background(path.ray.direction), path.met(0), optical_length);
    }
}
