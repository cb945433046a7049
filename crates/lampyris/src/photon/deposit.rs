//! The visitor that leaves photons.

use glam::Vec3;

use super::{Beam, Photon, Volume};
use crate::light::{Emission, LightId, Source};
use crate::material::{Lobes, Scattered};
use crate::medium::Matter;
use crate::sampler::Sampler;
use crate::scene::{Scene, SurfacePoint};
use crate::transport::{MediumPoint, PathState, Rivals, Segment, Visitor, norm};

/// Leaves a photon wherever a walk from a lamp meets a smooth lobe; follows all lobes.
#[derive(Debug)]
pub struct Deposit<'s> {
    /// The photons so far.
    pub photons: Vec<Photon>,
    /// Those in media.
    pub beams: Vec<Beam>,
    /// What is stored in media: where light flies, or where it meets a particle.
    pub volume: Volume,
    /// By the paths before this number alone.
    pub volume_paths: u64,
    /// Whether light that comes straight from a lamp is stored on surfaces, too.
    pub direct: bool,
    /// And in media.
    pub direct_in_media: bool,
    /// The longest light path from lamp to eye, in scattering events.
    pub max_bounces: u32,
    /// The number of the path.
    pub path: u32,
    /// Whether its first segment is one of parallel light.
    pub parallel: bool,
    /// Notes what else could have made the paths of the photons, for those who ask.
    pub instead: Option<Instead<'s>>,
}

/// What else could have made the path of a photon so far.
#[derive(Debug)]
pub struct Instead<'s> {
    scene: &'s Scene,
    /// Photons times area within which each is merged with a walk from the camera, beyond the first smooth surface that
    /// the camera sees.
    merging: f32,
    on: f32,
    from: From,
    /// At the last vertex: as [`Rivals::at`], and of shadow rays.
    at: (f32, f32),
}

/// Where the current segment began.
#[derive(Debug)]
enum From {
    Nowhere,
    Light(LightId, Emission),
    Surface(Rivals),
}

impl<'s> Instead<'s> {
    /// For photons of which so many, times area in scene units squared, are merged with a walk from the camera.
    pub fn new(scene: &'s Scene, merging: f32, on: f32) -> Instead<'s> {
        Instead { scene, merging, on, from: From::Nowhere, at: (0.0, 0.0) }
    }

    fn vertex(&mut self, point: &SurfacePoint) {
        self.at = match &self.from {
            From::Nowhere => (0.0, 0.0),
            From::Light(light, emission) => {
                let cos = point.geometric_cos(point.to_previous);
                self.scene.instead_of(*light, emission, &point.surface, cos)
            }
            From::Surface(rivals) => (rivals.at(point), 0.0),
        };
    }
}

impl<'s> Deposit<'s> {
    /// On surfaces alone, of light that has been scattered before.
    pub fn on_surfaces(max_bounces: u32, instead: Option<Instead<'s>>) -> Deposit<'s> {
        Deposit {
            photons: Vec::new(),
            beams: Vec::new(),
            volume: Volume::Points,
            volume_paths: 0,
            direct: false,
            direct_in_media: false,
            max_bounces,
            path: 0,
            parallel: false,
            instead,
        }
    }

    /// Whether light that a path leaves in a medium can come to the camera.
    fn readable_in(&self, matter: &Matter, path: &PathState) -> bool {
        let wants = self.direct_in_media || path.bounce > 0 || path.hidden_lamp;
        wants
            && u64::from(self.path) < self.volume_paths
            && path.bounce < self.max_bounces
            && !matter.scattering.is_zero()
    }

    /// Whether a photon is wanted here, if there is a smooth lobe.
    fn wants(&self, path: &PathState) -> bool {
        self.direct || path.bounce > 0 || path.hidden_lamp
    }
}

impl Visitor for Deposit<'_> {
    fn emitted(&mut self, path: u64, light: LightId, emission: &Emission) {
        self.path = path as u32;
        self.parallel = matches!(emission.source, Source::Parallel | Source::Far(_) | Source::Hidden);
        if let Some(instead) = &mut self.instead {
            instead.from = From::Light(light, *emission);
        }
    }

    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, _: &mut Sampler) -> Lobes {
        let rivals = self.instead.as_mut().map_or(0.0, |instead| {
            instead.vertex(point);
            instead.at.0
        });
        // The event in which the photon is read is one more. Where there is none left, the walk cuts the path.
        let readable = path.bounce < self.max_bounces && self.wants(path);
        if readable && point.bsdf.lobes().meets(Lobes::SMOOTH) {
            let normal = point.surface.normal;
            self.photons.push(Photon {
                position: point.surface.position,
                direction: path.ray.direction,
                normal: if normal.dot(point.to_previous) < 0.0 { -normal } else { normal },
                optical_length: path.optical_length as f32,
                reach: if self.parallel && path.bounce == 0 { f32::INFINITY } else { point.distance },
                slowness: path.slowness,
                flux: path.throughput,
                shading: point.geometric_over_shading_back().recip(),
                rivals,
                path: self.path,
                bounce: u16::try_from(path.bounce).unwrap_or(u16::MAX),
                history: path.history,
            });
        }
        Lobes::ALL
    }

    fn segment(&mut self, segment: &Segment, path: &PathState, _: &mut Sampler) {
        if self.volume == Volume::Beams && self.readable_in(&segment.matter, path) {
            self.beams.push(Beam::new(self.path, path, segment.ray.origin, [0.0, segment.length], segment.matter.id));
        }
    }

    fn medium_vertex(&mut self, point: &MediumPoint, path: &PathState, _: &mut Sampler) -> bool {
        if self.volume != Volume::Beams && self.readable_in(&point.matter, path) {
            let reach = if self.parallel && path.bounce == 0 { f32::INFINITY } else { point.distance };
            // Where it is read, the particle holds its light back anew.
            let path = &PathState { optical_length: path.optical_length - point.delay, ..*path };
            self.beams.push(Beam::new(self.path, path, point.position, [reach, 0.0], point.matter.id));
        }
        true
    }

    fn scattered_by_particle(&mut self, _: Vec3, _: &MediumPoint, _: &PathState) {
        // Walks from the camera scatter at no particle: there is no other way to make the path so far.
        if let Some(instead) = &mut self.instead {
            instead.from = From::Nowhere;
        }
    }

    fn scattered(&mut self, scattered: &Scattered, point: &SurfacePoint, path: &PathState) {
        let wants = self.wants(path);
        if let Some(instead) = &mut self.instead {
            let here = if wants { instead.merging } else { 0.0 };
            let (at, shadow_rays) = instead.at;
            let smooth = Lobes::SMOOTH.contains(scattered.event);
            let back = if smooth { instead.on * point.pdf_back(scattered.to_next, Lobes::ALL) } else { 0.0 };
            instead.from =
                From::Surface(Rivals::after(at, norm([at * back, shadow_rays, here]), 1.0, point, scattered));
        }
    }
}
