//! Lights: where photons start and shadow rays end.

mod area;
mod constant;
mod directional;
mod point;
mod spot;

use glam::Vec3;

pub use area::Area;
pub use constant::Constant;
pub use directional::Directional;
pub use point::Point;
pub use spot::Spot;

use crate::geometry::{Ray, Surfaces};
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// The number of a light in its scene.
pub type LightId = u32;

/// A photon that leaves a light.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// Where it leaves and where it goes.
    pub ray: Ray,
    /// Flux in W that it carries if it is the only one: the emitted light × cosine / density.
    pub flux: Spectrum,
}

/// Light as it would arrive at a point from one direction if nothing stood between.
#[derive(Clone, Copy, Debug)]
pub struct Illumination {
    /// Direction to the light, unit length.
    pub to_light: Vec3,
    /// Where the shadow ray ends, moved off the light's surface; none for light from infinitely far away.
    pub target: Option<Vec3>,
    /// Radiance / density, in W/m²: times the value of the BSDF and the cosine it is reflected radiance.
    pub irradiance: Spectrum,
    /// Density of the direction per solid angle; none if the light can be reached in this direction alone.
    pub pdf: Option<f32>,
}

/// What every light does. The shapes of the scene are lent to lights that are surfaces.
pub trait Emit {
    /// A photon. None if this draw has no light.
    fn emit(&self, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Emission>;

    /// Light that arrives at `at`: for next-event estimation. None if this draw has no light.
    fn illuminate(&self, surfaces: &Surfaces, at: Vec3, sampler: &mut Sampler) -> Option<Illumination>;

    /// Flux in W of the whole light.
    fn power(&self, surfaces: &Surfaces) -> Spectrum;
}

/// The closed set of lights.
#[derive(Clone, Debug)]
pub enum Light {
    /// A point that shines equally in all directions.
    Point(Point),
    /// A point that shines into a cone.
    Spot(Spot),
    /// Parallel light from infinitely far away.
    Directional(Directional),
    /// A shape that emits.
    Area(Area),
    /// The same radiance from everywhere infinitely far away.
    Constant(Constant),
}

impl Light {
    /// The light as what it does.
    #[inline]
    pub fn emitter(&self) -> &dyn Emit {
        match self {
            Light::Point(light) => light,
            Light::Spot(light) => light,
            Light::Directional(light) => light,
            Light::Area(light) => light,
            Light::Constant(light) => light,
        }
    }

    /// What kind of light it is, for people.
    pub fn kind(&self) -> &'static str {
        match self {
            Light::Point(_) => "point",
            Light::Spot(_) => "spot",
            Light::Directional(_) => "directional",
            Light::Area(_) => "area",
            Light::Constant(_) => "constant",
        }
    }
}

/// A sphere around all that is finite in a scene: photons from infinitely far away start on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct World {
    /// Its centre.
    pub center: Vec3,
    /// Its radius.
    pub radius: f32,
}
