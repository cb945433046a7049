//! Transforms as Mitsuba writes them: steps, each applied after the one before it.

use glam::{DMat3, DMat4, DVec3};

use super::value::{number, numbers, triple};

/// What is wrong with a step, and the attribute that it is wrong with, if it is one.
pub(super) struct Fault {
    pub attribute: &'static str,
    pub message: String,
}

fn fault<T>(attribute: &'static str, message: impl Into<String>) -> Result<T, Fault> {
    Err(Fault { attribute, message: message.into() })
}

/// One step inside a `transform`, from its tag and attributes.
pub(super) fn step<'a>(tag: &str, get: impl Fn(&str) -> Option<&'a str>) -> Result<DMat4, Fault> {
    match tag {
        "translate" => Ok(DMat4::from_translation(vector(get, 0.0)?)),
        "scale" => Ok(DMat4::from_scale(vector(get, 1.0)?)),
        "rotate" => {
            let Some(angle) = get("angle") else { return fault("", "a rotation needs the attribute 'angle'") };
            let angle = number(angle).or_else(|message| fault("angle", message))?;
            match vector(get, 0.0)?.try_normalize() {
                Some(axis) => Ok(DMat4::from_axis_angle(axis, angle.to_radians())),
                None => fault("", "the axis of a rotation must not be zero"),
            }
        }
        "lookat" | "lookAt" | "look_at" => look_at(get),
        "matrix" => match get("value") {
            Some(text) => matrix(&numbers(text).or_else(|message| fault("value", message))?),
            None => fault("", "a matrix needs the attribute 'value'"),
        },
        _ => fault("", format!("'{tag}' is not a step of a transform")),
    }
}

/// The camera's or spotlight's matrix: +z towards the target, +y up, +x to the left.
fn look_at<'a>(get: impl Fn(&str) -> Option<&'a str>) -> Result<DMat4, Fault> {
    let point = |name: &'static str| match get(name) {
        Some(text) => three(name, text).map(Some),
        None => Ok(None),
    };
    let (Some(origin), Some(target)) = (point("origin")?, point("target")?) else {
        return fault("", "a lookat needs the attributes 'origin' and 'target'");
    };
    let Some(forward) = (target - origin).try_normalize() else {
        return fault("target", "the origin and the target of a lookat must differ");
    };
    // Without `up` any will do; this is the one that Mitsuba takes.
    let up = point("up")?.unwrap_or_else(|| forward.any_orthonormal_pair().0);
    let Some(left) = up.cross(forward).try_normalize() else {
        return fault("up", "the up vector of a lookat must not be zero or lie along the view");
    };
    let up = forward.cross(left);
    Ok(DMat4::from_cols(left.extend(0.0), up.extend(0.0), forward.extend(0.0), origin.extend(1.0)))
}

fn three(name: &'static str, text: &str) -> Result<DVec3, Fault> {
    let values = numbers(text).or_else(|message| fault(name, message))?;
    match <[f64; 3]>::try_from(values.as_slice()) {
        Ok(values) => Ok(DVec3::from_array(values)),
        Err(_) => fault(name, format!("'{name}' needs three numbers, not {}", values.len())),
    }
}

fn matrix(values: &[f64]) -> Result<DMat4, Fault> {
    if let Ok(values) = <[f64; 9]>::try_from(values) {
        return Ok(DMat4::from_mat3(DMat3::from_cols_array(&values).transpose()));
    }
    let Ok(values) = <[f64; 16]>::try_from(values) else {
        return fault("value", format!("a matrix has 16 or 9 values, not {}", values.len()));
    };
    let matrix = DMat4::from_cols_array(&values).transpose();
    match matrix.row(3).to_array() {
        [0.0, 0.0, 0.0, 1.0] => Ok(matrix),
        _ => fault("value", "the last row of a matrix must be 0 0 0 1"),
    }
}

/// `value` with one or three numbers, or else `x`, `y` and `z`, each with a default.
fn vector<'a>(get: impl Fn(&str) -> Option<&'a str>, default: f64) -> Result<DVec3, Fault> {
    if let Some(text) = get("value") {
        return triple(text).map(DVec3::from_array).or_else(|message| fault("value", message));
    }
    let mut vector = DVec3::splat(default);
    for (index, name) in ["x", "y", "z"].into_iter().enumerate() {
        if let Some(text) = get(name) {
            vector[index] = number(text).or_else(|message| fault(name, message))?;
        }
    }
    Ok(vector)
}
