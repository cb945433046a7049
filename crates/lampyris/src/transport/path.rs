//! The state of a path as it travels.

use glam::Vec2;

use crate::geometry::{Cone, Ray};
use crate::material::{Event, Lobes};
use crate::medium::Inside;
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::spectrum::Spectrum;
use crate::transient::Met;

/// Where a path began.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// At the eye: the path carries the weight of radiance.
    Camera,
    /// At a lamp: the path carries flux.
    Light,
}

/// A path on its way. Everything that rides along is here: flux or weight, time, and where it has been.
#[derive(Clone, Copy, Debug)]
pub struct PathState {
    /// The current segment.
    pub ray: Ray,
    /// Flux in W of a path from a lamp; weight, without unit, of a path from the camera.
    pub throughput: Spectrum,
    /// Σ slowness × length so far, in scene units, of what counts; in double precision, so that long paths keep short differences.
    pub optical_length: f64,
    /// Index of refraction of where the path is, over that of where it began.
    pub ior: f32,
    /// How much slower light is where the path is than where it began: the same, or the ratio of group indices.
    pub slowness: f32,
    /// The shapes with media that it is in.
    pub inside: Inside,
    /// What the ray stands for, from its origin.
    pub cone: Cone,
    /// Scattering events so far.
    pub bounce: u32,
    /// Which events these were.
    pub history: Lobes,
    /// Whether it began at a lamp that no shadow ray finds.
    pub hidden_lamp: bool,
}

impl PathState {
    /// A path that begins with this ray, as one of many in all directions.
    pub fn new(ray: Ray, throughput: Spectrum) -> PathState {
        PathState {
            ray,
            throughput,
            optical_length: 0.0,
            ior: 1.0,
            slowness: 1.0,
            inside: Inside::NOTHING,
            cone: Cone::WIDE,
            bounce: 0,
            history: Lobes::NONE,
            hidden_lamp: false,
        }
    }

    /// A path that begins at a point of the picture, in pixels, as [`Scene::view`] says.
    #[inline]
    pub fn from_camera(scene: &Scene, pixel: Vec2, sampler: &mut Sampler) -> PathState {
        let (ray, response) = scene.view(pixel, sampler);
        PathState {
            cone: scene.cone(),
            inside: scene.inside_of_view(&ray),
            optical_length: -f64::from(scene.head_start(pixel)),
            ..PathState::new(ray, Spectrum::grey(response))
        }
    }

    /// What light has met that comes by this path, with so many more events on surfaces.
    #[inline]
    pub fn met(&self, more: u32) -> Met {
        let particles = self.history.contains(Event::Scatter);
        Met { particles, ..Met::surfaces(self.bounce + more) }
    }

    /// Whether a path of this history has met mirrors and glass, and nothing else.
    pub fn is_caustic_history(history: Lobes) -> bool {
        !history.is_none() && !history.meets(Lobes::SMOOTH)
    }
}
