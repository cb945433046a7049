//! Lights that are not surfaces.

use std::f32::consts::PI;

use super::check;
use crate::error::{Error, Result};
use crate::light::{Constant, Directional, Light, Point, Spot, World};
use crate::math::Frame;
use crate::scene::description::{Color, LightDescription};
use crate::spectrum::Spectrum;

pub(super) fn build(light: &LightDescription, world: World) -> Result<Light> {
    match light {
        LightDescription::Point { position, intensity, power } => {
            let position = check::point("position", *position)?;
            Ok(Light::Point(Point { position, intensity: intensity_of(*intensity, *power, 4.0 * PI)? }))
        }
        LightDescription::Spot { position, target, intensity, power, cutoff, beam_width } => {
            let position = check::point("position", *position)?;
            let to_target = check::point("target", *target)? - position;
            let direction = check::direction("target", to_target.to_array())
                .map_err(|_| Error::at_key("target", "the spot's target is the spot itself"))?;
            let cutoff = check::angle("cutoff", *cutoff, 0.0, 90.000_1)?.to_radians();
            let beam_width = match beam_width {
                Some(width) => check::at_least_zero("beam-width", *width)?.to_radians(),
                None => 0.75 * cutoff,
            };
            if beam_width > cutoff {
                return Err(Error::at_key("beam-width", "the spot's beam-width is larger than its cutoff"));
            }
            let intensity = intensity_of(*intensity, *power, Spot::unit_power(cutoff, beam_width))?;
            Ok(Light::Spot(Spot::new(position, direction, intensity, cutoff, beam_width)))
        }
        LightDescription::Directional { direction, irradiance, angle: _ } => {
            let direction = Frame::around(check::direction("direction", *direction)?);
            let irradiance = lit("irradiance", check::light("irradiance", *irradiance)?)?;
            Ok(Light::Directional(Directional { direction, irradiance, world }))
        }
        LightDescription::Constant { radiance } => {
            let radiance = lit("radiance", check::light("radiance", *radiance)?)?;
            Ok(Light::Constant(Constant { radiance, world }))
        }
        _ => Err(Error::new("this light cannot be rendered yet")),
    }
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
