//! Lights: where photons start and shadow rays end.

mod aim;
mod area;
mod beam;
mod constant;
mod directional;
mod disk;
mod environment;
mod far;
mod guide;
mod laser;
mod mosaic;
mod outlook;
mod point;
mod projector;
mod sky;
mod span;
mod spot;
mod world;

use glam::Vec3;

pub use aim::{Aim, Focus, Section, Start};
pub use area::Area;
pub use beam::Beam;
pub use constant::Constant;
pub use directional::Directional;
pub use disk::SkyDisk;
pub use environment::{Environment, Mapping};
pub use far::Far;
pub(crate) use far::illuminate_by;
pub use guide::{Guide, Leaving, Lesson};
pub use laser::Laser;
pub use mosaic::Mosaic;
pub use outlook::{Node, Outlook, Parts, SIDES, Sightings, Vista, side};
pub use point::Point;
pub use projector::Projector;
pub use sky::{Sky, sky_picture, sun_irradiance};
pub use span::{Equiangular, Span};
pub use spot::Spot;
pub use world::World;

use crate::geometry::{Ray, Surface, Surfaces};
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
    /// Where it leaves, for those who want to know how else its path could have begun.
    pub source: Source,
    /// Density of this ray: per solid angle from a point; per area across the ray for parallel light; per area across
    /// the ray and per solid angle for all others, whose flux is radiance over density.
    pub density: f32,
}

impl Emission {
    /// Normal of the light's surface where the photon leaves it; zero if it leaves none.
    pub fn normal(&self) -> Vec3 {
        if let Source::Shape(_, surface) = &self.source { surface.normal } else { Vec3::ZERO }
    }

    /// Whether no shadow ray finds the light.
    pub fn is_hidden(&self) -> bool {
        matches!(self.source, Source::Hidden)
    }
}

/// From what a photon comes, and so how else its light is found.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// A point: found by shadow rays alone.
    Point,
    /// Infinitely far away in one direction, or in a beam: found by shadow rays alone.
    Parallel,
    /// A point of the shape of this number: found by shadow rays and by rays that meet it.
    Shape(u32, Surface),
    /// Infinitely far away, where shadow rays have this density per solid angle; found by rays that leave the scene, too.
    Far(f32),
    /// What neither shadow rays nor others find, so that photons must carry its direct light, too.
    Hidden,
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
    /// Density of a photon that the light sends this way of itself, per area across it, over that of this draw.
    pub emission: f32,
    /// Normal of the light's surface where it comes from; zero if it comes from none.
    pub normal: Vec3,
}

impl Illumination {
    /// Nothing but the way from one point of free space to another, for those who ask what comes through.
    pub fn way(from: Vec3, to: Vec3) -> Illumination {
        let nothing = Spectrum::ZERO;
        let (emission, normal) = (0.0, Vec3::ZERO);
        Illumination { to_light: to - from, irradiance: nothing, pdf: None, target: Some(to), emission, normal }
    }

    /// What is left of the way to the light from a point on it: a ray and its length.
    pub fn rest(&self, from: Vec3) -> (Ray, f32) {
        match self.target {
            None => (Ray { origin: from, direction: self.to_light }, f32::INFINITY),
            Some(target) => {
                let between = target - from;
                let distance = between.length();
                (Ray { origin: from, direction: between / distance }, distance * (1.0 - 1e-6))
            }
        }
    }
}

/// What every light does. The shapes of the scene are lent to lights that are surfaces.
pub trait Emit {
    /// A photon. None if this draw has no light.
    fn emit(&self, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Emission>;

    /// Light that arrives at `at`: for next-event estimation. None if this draw has no light.
    fn illuminate(&self, surfaces: &Surfaces, at: Vec3, sampler: &mut Sampler) -> Option<Illumination>;

    /// On which part of a ray of this length it can shine; none if on no part.
    fn span(&self, _ray: &Ray, length: f32) -> Option<Span> {
        Some(Span::whole(length, None))
    }

    /// The light as one whose photons can be aimed, if it is that.
    fn aim(&self) -> Option<&dyn Aim> {
        None
    }

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
    /// A disk in the sky.
    SkyDisk(SkyDisk),
    /// A picture of the radiance from infinitely far away.
    Environment(Box<Environment>),
    /// A point that throws a picture.
    Projector(Box<Projector>),
    /// A beam of parallel light.
    Beam(Beam),
    /// The point of a surface that an infinitely thin beam lights.
    Laser(Laser),
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
            Light::SkyDisk(light) => light,
            Light::Environment(light) => &**light,
            Light::Projector(light) => &**light,
            Light::Beam(light) => light,
            Light::Laser(light) => light,
        }
    }

    /// The light as what rays that leave the scene meet, if it is that.
    #[inline]
    pub fn far(&self) -> Option<&dyn Far> {
        match self {
            Light::Constant(light) => Some(light),
            Light::SkyDisk(light) => Some(light),
            Light::Environment(light) => Some(&**light),
            _ => None,
        }
    }

    /// Whether the light comes from infinitely far away.
    pub fn is_far(&self) -> bool {
        self.far().is_some() || matches!(self, Light::Directional(_))
    }

    /// What kind of light it is, for people.
    pub fn kind(&self) -> &'static str {
        match self {
            Light::Point(_) => "point",
            Light::Spot(_) => "spot",
            Light::Directional(_) => "directional",
            Light::Area(_) => "area",
            Light::Constant(_) => "constant",
            Light::SkyDisk(_) => "sky disk",
            Light::Environment(_) => "environment",
            Light::Projector(_) => "projector",
            Light::Beam(_) => "beam",
            Light::Laser(_) => "laser",
        }
    }
}
