//! Ranges of numbers. Every check names its key.

use glam::Vec3;

use crate::error::{Error, Result};
use crate::scene::description::{Color, Transform};
use crate::spectrum::Spectrum;

pub(super) fn finite(key: &str, value: f32) -> Result<f32> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Error::at_key(key, format!("{key} must be a finite number, not {value}")))
    }
}

pub(super) fn above_zero(key: &str, value: f32) -> Result<f32> {
    finite(key, value)?;
    if value > 0.0 { Ok(value) } else { Err(Error::at_key(key, format!("{key} must be greater than 0, not {value}"))) }
}

pub(super) fn at_least_zero(key: &str, value: f32) -> Result<f32> {
    finite(key, value)?;
    if value >= 0.0 {
        Ok(value)
    } else {
        Err(Error::at_key(key, format!("{key} must not be negative, but is {value}")))
    }
}

/// Strictly between two angles in degrees.
pub(super) fn angle(key: &str, value: f32, low: f32, high: f32) -> Result<f32> {
    finite(key, value)?;
    if value > low && value < high {
        return Ok(value);
    }
    Err(Error::at_key(key, format!("{key} must lie between {low} and {high} degrees, not {value}")))
}

pub(super) fn point(key: &str, value: [f32; 3]) -> Result<Vec3> {
    value.iter().try_for_each(|&x| finite(key, x).map(|_| ()))?;
    Ok(Vec3::from_array(value))
}

/// Unit length.
pub(super) fn direction(key: &str, value: [f32; 3]) -> Result<Vec3> {
    let vector = point(key, value)?.as_dvec3();
    match vector.try_normalize() {
        Some(unit) => Ok(unit.as_vec3()),
        None => Err(Error::at_key(key, format!("{key} must not be zero"))),
    }
}

/// Any finite colour.
pub(super) fn number(key: &str, color: Color) -> Result<Spectrum> {
    color.0.iter().try_for_each(|&x| finite(key, x).map(|_| ()))?;
    Ok(Spectrum::from_rgb(color.0))
}

/// Of light: not negative.
pub(super) fn light(key: &str, color: Color) -> Result<Spectrum> {
    color.0.iter().try_for_each(|&x| at_least_zero(key, x).map(|_| ()))?;
    Ok(Spectrum::from_rgb(color.0))
}

/// Of reflectance: 0 to 1.
pub(super) fn share(key: &str, color: Color) -> Result<Spectrum> {
    light(key, color)?;
    if let Some(value) = color.0.into_iter().find(|&value| value > 1.0) {
        return Err(Error::at_key(key, format!("{key} must not exceed 1, but is {value}"))
            .with_hint("a surface cannot send back more light than it gets"));
    }
    Ok(Spectrum::from_rgb(color.0))
}

/// Finite, affine and not singular.
pub(super) fn transform(key: &str, transform: &Transform) -> Result<()> {
    let matrix = transform.0;
    if !matrix.is_finite() {
        return Err(Error::at_key(key, "the transform has a number that is not finite"));
    }
    if matrix.row(3).abs_diff_eq(glam::Vec4::W, 1e-6) {
        let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate().as_dvec3());
        // Relative to the lengths, so that small and large scenes are judged alike.
        let volume = x.cross(y).dot(z).abs();
        if volume > 1e-9 * x.length() * y.length() * z.length() {
            return Ok(());
        }
        return Err(Error::at_key(key, "the transform flattens the shape: its matrix is singular")
            .with_hint("every axis needs a scale other than 0"));
    }
    Err(Error::at_key(key, "the last row of a transform must be 0 0 0 1"))
}
