//! Lights that are not surfaces.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{Mat3, Vec2, Vec3};

use super::textures::Quantity;
use super::{check, textures};
use crate::error::{Error, Result};
use crate::light::{
    Beam, Constant, Directional, Environment, Laser, Light, Mapping, Point, Projector, Sky, SkyDisk, Spot, World,
    sky_picture, sun_irradiance,
};
use crate::math::Frame;
use crate::scene::Assets;
use crate::scene::description::{Color, EnvironmentMapping, LightDescription, Transform};
use crate::spectrum::Spectrum;
use crate::texture::Texture;

/// What lights are built from besides their description.
pub(super) struct Around<'a, 'd> {
    /// What photons from infinitely far away must cover.
    pub(super) world: World,
    /// The textures of the scene.
    pub(super) textures: &'a mut textures::Builder<'d>,
    /// For pictures.
    pub(super) assets: &'a dyn Assets,
    /// Lights so far that keep a picture, each its own.
    pub(super) pictures: usize,
}

/// Most skies, surroundings and projectors of a scene: a line of a file makes megabytes of each.
const MOST_PICTURES: usize = 64;

impl<'d> Around<'_, 'd> {
    /// Adds the light, or for a sky the two lights, to `lights`.
    pub(super) fn build(&mut self, light: &'d LightDescription, lights: &mut Vec<Light>) -> Result<()> {
        let world = self.world;
        if let LightDescription::Environment { .. }
        | LightDescription::Sky { .. }
        | LightDescription::Projector { .. } = light
        {
            self.pictures += 1;
            if self.pictures > MOST_PICTURES {
                return Err(Error::new(format!(
                    "there are more than {MOST_PICTURES} skies, environments and projectors"
                ))
                .with_hint("join the skies and environments in one picture"));
            }
        }
        lights.push(match light {
            LightDescription::Point { position, intensity, power } => {
                let position = check::point("position", *position)?;
                Light::Point(Point { position, intensity: intensity_of(*intensity, *power, 4.0 * PI)? })
            }
            LightDescription::Spot { position, target, intensity, power, cutoff, beam_width } => {
                let axis = axis(*position, *target, "spot")?;
                spot(axis, *intensity, *power, *cutoff, *beam_width)?
            }
            LightDescription::Directional { direction, irradiance, angle } => {
                let direction = check::direction("direction", *direction)?;
                let irradiance = lit("irradiance", check::light("irradiance", *irradiance)?)?;
                let angle = check::at_least_zero("angle", *angle)?;
                if angle > 90.0 {
                    return Err(Error::at_key("angle", format!("angle must be at most 90 degrees, not {angle}")));
                }
                match 0.5 * angle.to_radians() {
                    0.0 => Light::Directional(Directional { direction: Frame::around(direction), irradiance, world }),
                    half => Light::SkyDisk(SkyDisk::new(-direction, half, irradiance, world)),
                }
            }
            LightDescription::Constant { radiance } => {
                let radiance = lit("radiance", check::light("radiance", *radiance)?)?;
                Light::Constant(Constant { radiance, world })
            }
            LightDescription::Environment { file, scale, mapping, transform } => {
                self.environment(file, *scale, *mapping, transform)?
            }
            LightDescription::Sky { sun_direction, turbidity, albedo, sky_scale, sun_scale, sun_angle, transform } => {
                let sky = sky(*sun_direction, *turbidity, *albedo)?;
                let scales = [("sky-scale", *sky_scale), ("sun-scale", *sun_scale)];
                return self.sky(&sky, scales, *sun_angle, transform, lights);
            }
            LightDescription::Projector { position, target, up, texture, aspect, fov, scale } => {
                let axis = axis(*position, *target, "projector")?;
                self.projector(axis, *up, texture.as_deref(), *aspect, *fov, *scale)?
            }
            LightDescription::Beam { position, direction, power, radius } => Light::Beam(Beam {
                position: check::point("position", *position)?,
                direction: Frame::around(check::direction("direction", *direction)?),
                radius: check::at_least_zero("radius", *radius)?,
                power: lit("power", check::light("power", *power)?)?,
            }),
            LightDescription::Laser { position, target, power } => Light::Laser(Laser {
                position: check::point("position", *position)?,
                target: target.map(|target| axis(*position, target, "laser").map(|_| target.into())).transpose()?,
                power: lit("power", check::light("power", *power)?)?,
            }),
        });
        Ok(())
    }

    fn environment(&self, file: &str, scale: Color, mapping: EnvironmentMapping, turn: &Transform) -> Result<Light> {
        let scale = lit("scale", check::light("scale", scale)?)?;
        let image = self.assets.picture(file, false).map_err(|error| error.under("file"))?.to_image();
        let fault = |message: String| Err(Error::at_key("file", format!("the picture '{file}' {message}")));
        if mapping == EnvironmentMapping::EqualArea && image.width() != image.height() {
            return fault(format!("must be a square, not {} × {}", image.width(), image.height()));
        }
        // A sun too bright for its file's numbers is as bright as they go; what is no light is none.
        let shining = |value: f32| if value > 0.0 { value.min(BRIGHTEST) } else { 0.0 };
        let image = Arc::new(image.map(|pixel| pixel.map(shining)));
        let mapping = match mapping {
            EnvironmentMapping::LatLong => Mapping::LatLong,
            EnvironmentMapping::EqualArea => Mapping::EqualArea,
        };
        let environment = Environment::new(image, scale, mapping, rotation(turn)?, self.world);
        if environment.is_black() {
            return fault("is black: it gives no light".to_string());
        }
        Ok(Light::Environment(Box::new(environment)))
    }

    fn sky(
        &self,
        sky: &Sky,
        scales: [(&str, f32); 2],
        sun_angle: f32,
        turn: &Transform,
        lights: &mut Vec<Light>,
    ) -> Result<()> {
        let [sky_scale, sun_scale] = scales.map(|(key, scale)| check::at_least_zero(key, scale));
        let (sky_scale, sun_scale, turn) = (sky_scale?, sun_scale?, rotation(turn)?);
        let half_angle = 0.5 * check::angle("sun-angle", sun_angle, 0.0, 180.0)?.to_radians();
        if sky_scale == 0.0 && sun_scale == 0.0 {
            return Err(Error::at_key("sky-scale", "the sky has no light: sky-scale and sun-scale are both 0"));
        }
        if sky_scale > 0.0 {
            let picture = sky_picture(sky).ok_or_else(|| Error::new("the model of the sky has no such weather"))?;
            let scale = Spectrum::grey(sky_scale);
            let sky = Environment::new(Arc::new(picture), scale, Mapping::LatLong, turn, self.world);
            lights.push(Light::Environment(Box::new(sky)));
        }
        if sun_scale > 0.0 {
            let irradiance = sun_irradiance(sky) * sun_scale;
            lights.push(Light::SkyDisk(SkyDisk::new(turn * sky.sun, half_angle, irradiance, self.world)));
        }
        Ok(())
    }

    fn projector(
        &mut self,
        (position, forward): (Vec3, Vec3),
        up: [f32; 3],
        texture: Option<&'d str>,
        aspect: Option<f32>,
        fov: f32,
        scale: Color,
    ) -> Result<Light> {
        let up = check::direction("up", up)?;
        let Some(right) = forward.cross(up).try_normalize() else {
            return Err(Error::at_key("up", "the projector shines along its own up direction")
                .with_hint("choose an up that is not parallel to the axis"));
        };
        let texture = match texture {
            Some(name) => self.textures.named(name, "texture", Quantity::Light)?,
            None => Texture::Constant(Spectrum::ONE),
        };
        let natural = texture.aspect().unwrap_or(1.0);
        let aspect = check::above_zero("aspect", aspect.unwrap_or(natural))?;
        let half = (0.5 * check::angle("fov", fov, 0.0, 180.0)?).to_radians().tan();
        let scale = lit("scale", check::light("scale", scale)?)?;
        let axes = [right, right.cross(forward), forward];
        let projector = Projector::new(position, axes, Vec2::new(half, half / aspect), texture, scale);
        Ok(Light::Projector(Box::new(projector)))
    }
}

/// Brighter pixels of an environment, infinite ones included, are taken for this radiance.
const BRIGHTEST: f32 = 1e9;

/// A position and the direction from it to the target.
fn axis(position: [f32; 3], target: [f32; 3], light: &str) -> Result<(Vec3, Vec3)> {
    let position = check::point("position", position)?;
    let to_target = check::point("target", target)? - position;
    let direction = check::direction("target", to_target.to_array())
        .map_err(|_| Error::at_key("target", format!("the {light}'s target is the {light} itself")))?;
    Ok((position, direction))
}

fn spot(
    (position, direction): (Vec3, Vec3),
    intensity: Option<Color>,
    power: Option<Color>,
    cutoff: f32,
    beam_width: Option<f32>,
) -> Result<Light> {
    let cutoff = check::angle("cutoff", cutoff, 0.0, 90.000_1)?.to_radians();
    let beam_width = match beam_width {
        Some(width) => check::at_least_zero("beam-width", width)?.to_radians(),
        None => 0.75 * cutoff,
    };
    if beam_width > cutoff {
        return Err(Error::at_key("beam-width", "the spot's beam-width is larger than its cutoff"));
    }
    let intensity = intensity_of(intensity, power, Spot::unit_power(cutoff, beam_width))?;
    Ok(Light::Spot(Spot::new(position, direction, intensity, cutoff, beam_width)))
}

fn sky(sun: [f32; 3], turbidity: f32, albedo: Color) -> Result<Sky> {
    let sun = check::direction("sun-direction", sun)?;
    if sun.y < 0.0 {
        return Err(
            Error::at_key("sun-direction", "the sun is below the horizon").with_hint("its y must not be negative")
        );
    }
    let turbidity = check::finite("turbidity", turbidity)?;
    if !(1.0..=10.0).contains(&turbidity) {
        return Err(Error::at_key("turbidity", format!("turbidity must lie between 1 and 10, not {turbidity}")));
    }
    Ok(Sky { sun, turbidity, albedo: check::share("albedo", albedo)?.to_rgb() })
}

/// The rotation, perhaps with a mirror, of a transform; what it moves and scales does not matter infinitely far away.
fn rotation(transform: &Transform) -> Result<Mat3> {
    check::transform("transform", transform)?;
    let axes = Mat3::from_mat4(transform.0);
    let rotation = axes * (1.0 / axes.determinant().abs().cbrt());
    if (rotation.transpose() * rotation).abs_diff_eq(Mat3::IDENTITY, 1e-3) {
        return Ok(rotation);
    }
    Err(Error::at_key("transform", "light from infinitely far away can be turned, but not stretched"))
}

/// An intensity in W/sr, given as such or as the power of a light whose power is `unit_power` at intensity 1.
fn intensity_of(intensity: Option<Color>, power: Option<Color>, unit_power: f32) -> Result<Spectrum> {
    match (intensity, power) {
        (Some(intensity), None) => lit("intensity", check::light("intensity", intensity)?),
        (None, Some(power)) => lit("power", check::light("power", power)? / unit_power),
        _ => Err(Error::new("the light needs either an intensity or a power")),
    }
}

fn lit(key: &str, light: Spectrum) -> Result<Spectrum> {
    if light.is_zero() {
        return Err(Error::at_key(key, "the light has no power: it is black")
            .with_hint(format!("give it a {key} above 0, or leave the light out")));
    }
    Ok(light)
}
