//! Lights as a file gives them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Color, Transform, one};

/// A light that is not a surface. Where both `intensity` and `power` may stand, give one.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(tag = "type")]
pub enum LightDescription {
    /// A point that shines equally in all directions.
    #[serde(rename_all = "kebab-case")]
    Point {
        /// Where it is.
        position: [f32; 3],
        /// Radiant intensity in W/sr.
        intensity: Option<Color>,
        /// Flux in W: 4π times the intensity.
        power: Option<Color>,
    },
    /// A point that shines into a cone: fully within `beam-width` of the axis, then linearly in the angle
    /// down to nothing at `cutoff`.
    #[serde(rename_all = "kebab-case")]
    Spot {
        /// Where it is.
        position: [f32; 3],
        /// A point on the axis of the cone.
        target: [f32; 3],
        /// Radiant intensity on the axis in W/sr.
        intensity: Option<Color>,
        /// Flux of the cone in W.
        power: Option<Color>,
        /// Angle between axis and edge in degrees (default 20).
        #[serde(default = "cutoff")]
        cutoff: f32,
        /// Angle of full intensity in degrees (default three quarters of `cutoff`).
        beam_width: Option<f32>,
    },
    /// Parallel light from infinitely far away.
    #[serde(rename_all = "kebab-case")]
    Directional {
        /// Where the light goes.
        direction: [f32; 3],
        /// Irradiance on a surface that faces it, in W/m² (default 1).
        #[serde(default = "Color::one")]
        irradiance: Color,
        /// Angle across the disk from which the light comes, in degrees, 0 (the default) to 90; the sun's is 0.53.
        #[serde(default)]
        angle: f32,
    },
    /// The same radiance from everywhere infinitely far away.
    #[serde(rename_all = "kebab-case")]
    Constant {
        /// Radiance in W/(m² sr) (default 1).
        #[serde(default = "Color::one")]
        radiance: Color,
    },
    /// A picture of the radiance from infinitely far away, in all directions.
    #[serde(rename_all = "kebab-case")]
    Environment {
        /// The picture's file, relative to the scene's folder.
        file: String,
        /// Factor of the picture's values (default 1).
        #[serde(default = "Color::one")]
        scale: Color,
        /// How the picture covers the directions (default lat-long).
        #[serde(default)]
        mapping: EnvironmentMapping,
        /// Turns the picture from its own axes (+y up; the middle of a lat-long picture lies along +z) to
        /// the world's.
        #[serde(default)]
        transform: Transform,
    },
    /// The clear or hazy sky of the day, and the sun in it [Hošek & Wilkie 2012].
    #[serde(rename_all = "kebab-case")]
    Sky {
        /// Where the sun stands, in the sky's own axes (+y up unless turned by `transform`).
        sun_direction: [f32; 3],
        /// Haze: 1 clear to 10 (default 3).
        #[serde(default = "turbidity")]
        turbidity: f32,
        /// Mean reflectance of the ground (default 0.15).
        #[serde(default = "ground")]
        albedo: Color,
        /// Factor of the sky's radiance, 0 to leave it out (default 1).
        #[serde(default = "one")]
        sky_scale: f32,
        /// Factor of the sun's radiance, 0 to leave it out (default 1).
        #[serde(default = "one")]
        sun_scale: f32,
        /// Angle across the sun in degrees, its radiance changing so that its irradiance stays (default 0.5358).
        #[serde(default = "sun_angle")]
        sun_angle: f32,
        /// Turns the sky to the world's axes.
        #[serde(default)]
        transform: Transform,
    },
    /// A point that throws a picture.
    #[serde(rename_all = "kebab-case")]
    Projector {
        /// Where it is.
        position: [f32; 3],
        /// A point in the middle of the picture.
        target: [f32; 3],
        /// The upright direction of the picture (default +y).
        #[serde(default = "plus_y")]
        up: [f32; 3],
        /// Name of the texture that is thrown; white by default.
        texture: Option<String>,
        /// Width over height of the picture; that of the texture's file by default, or 1.
        aspect: Option<f32>,
        /// Field of view across the width, in degrees (default 45).
        #[serde(default = "projector_fov")]
        fov: f32,
        /// Factor of the texture: irradiance, in W/m², on a plane at right angles to the axis at a distance of 1
        /// scene unit, where the texture is 1 (default 1).
        #[serde(default = "Color::one")]
        scale: Color,
    },
    /// A beam of parallel light, as of a laser.
    #[serde(rename_all = "kebab-case")]
    Beam {
        /// Where it starts.
        position: [f32; 3],
        /// Where it goes.
        direction: [f32; 3],
        /// Flux in W (default 1).
        #[serde(default = "Color::one")]
        power: Color,
        /// Radius of the beam in scene units, 0 (the default) for an infinitely thin one.
        #[serde(default)]
        radius: f32,
    },
    /// An infinitely thin beam, by the point of a surface that it lights, which sends its light on as the material there
    /// scatters it smoothly. No one sees that point itself. A scene has one at most, and no media.
    #[serde(rename_all = "kebab-case")]
    Laser {
        /// Where it starts.
        position: [f32; 3],
        /// A point that it goes through; a camera with a `capture` that is not `single` gives its own.
        target: Option<[f32; 3]>,
        /// Flux in W (default 1).
        #[serde(default = "Color::one")]
        power: Color,
    },
}

/// How a square or oblong picture covers all directions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum EnvironmentMapping {
    /// Longitude across, latitude down, +y at the top.
    #[default]
    LatLong,
    /// The square of equal areas of pbrt-v4, +z in its middle [Clarberg 2008].
    EqualArea,
}

fn turbidity() -> f32 {
    3.0
}

fn ground() -> Color {
    Color::grey(0.15)
}

fn sun_angle() -> f32 {
    0.5358
}

fn projector_fov() -> f32 {
    45.0
}

fn plus_y() -> [f32; 3] {
    [0.0, 1.0, 0.0]
}

fn cutoff() -> f32 {
    20.0
}
