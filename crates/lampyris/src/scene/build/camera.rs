//! The camera, from either of its two forms.

use glam::Vec3;

use super::check;
use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::scene::description::{CameraDescription, FovAxis, Projection};

/// Field of view across the picture, in degrees, of a camera that says nothing of it.
const DEFAULT_FOV: f32 = 40.0;
/// Width of the picture of an orthographic camera that says nothing of it.
const DEFAULT_WIDTH: f32 = 2.0;

pub(super) fn build(camera: Option<&CameraDescription>, size: [u32; 2]) -> Result<Camera> {
    let Some(camera) = camera else {
        return Err(Error::new("the scene has no camera")
            .with_hint("add one, for example: camera = { origin = [0, 0, -4], target = [0, 0, 0] }"));
    };
    placed(camera, size).map_err(|error| error.under("camera"))
}

fn placed(camera: &CameraDescription, size: [u32; 2]) -> Result<Camera> {
    if camera.irradiance_of.is_some() || camera.capture.is_some() {
        // The rays start on a shape, or go to one that is not built yet; what is left to say is where those who ask for the
        // camera find it.
        let origin = check::point("origin", camera.origin)?;
        let axes = [Vec3::NEG_X, Vec3::Y, Vec3::Z];
        return Camera::orthographic(origin, axes, size).ok_or_else(|| Error::new("the camera has no axes"));
    }
    let origin = check::point("origin", camera.origin)?;
    let radius = check::at_least_zero("aperture-radius", camera.aperture_radius)?;
    if let (Projection::Orthographic, Some(_)) = (camera.projection, camera.fov) {
        return Err(Error::at_key("fov", "an orthographic camera has no field of view").with_hint("give it a width"));
    }
    let (axes, subject) = match (camera.target, camera.left, camera.up, camera.forward) {
        (Some(_), Some(_), ..) | (Some(_), .., Some(_)) => {
            return Err(Error::at_key("target", "the camera has a target, and left or forward as well")
                .with_hint("give either origin, target and up, or origin, left, up and forward"));
        }
        (Some(target), None, up, None) => looking_at(origin, camera, target, up, size)?,
        (None, Some(left), Some(up), Some(forward)) => spanned(camera, [left, up, forward], size)?,
        (None, ..) => {
            return Err(Error::new("the camera does not say where it looks")
                .with_hint("give a target, or left, up and forward"));
        }
    };
    let focus = match camera.focus_distance {
        Some(distance) => check::above_zero("focus-distance", distance)?,
        None => subject,
    };
    let built = match camera.projection {
        Projection::Perspective => Camera::new(origin, axes, size, radius, focus),
        Projection::Orthographic => Camera::orthographic(origin, axes, size),
    };
    let near = check::at_least_zero("near-distance", camera.near_distance)?;
    built.map(|camera| camera.from_plane(near)).ok_or_else(|| {
        Error::at_key(
            "up",
            "the camera's axes lie in one plane: left, up and forward must point in different directions",
        )
        .with_hint("choose an up that is not parallel to the viewing direction")
    })
}

fn looking_at(
    origin: Vec3,
    camera: &CameraDescription,
    target: [f32; 3],
    up: Option<[f32; 3]>,
    size: [u32; 2],
) -> Result<([Vec3; 3], f32)> {
    let to_target = check::point("target", target)? - origin;
    let forward = check::direction("target", to_target.to_array())
        .map_err(|_| Error::at_key("target", "the camera's target is the camera itself"))?;
    let up = check::direction("up", up.unwrap_or([0.0, 1.0, 0.0]))?;
    let left = up.cross(forward);
    if left.length() < 1e-6 {
        return Err(Error::at_key("up", "the camera looks along its own up direction")
            .with_hint("choose an up that is not parallel to the viewing direction"));
    }
    let left = left.normalize();
    let axes = [left, forward.cross(left), forward];
    if camera.projection == Projection::Orthographic {
        let half = 0.5 * check::above_zero("width", camera.width.unwrap_or(DEFAULT_WIDTH))?;
        let [width, height] = size.map(|side| side as f32);
        return Ok(([left * half, axes[1] * (half * height / width), forward], to_target.length()));
    }
    let fov = camera.fov.unwrap_or(DEFAULT_FOV);
    Ok((sized(axes, fov, camera.fov_axis, size)?, to_target.length()))
}

fn spanned(camera: &CameraDescription, axes: [[f32; 3]; 3], size: [u32; 2]) -> Result<([Vec3; 3], f32)> {
    let [left, up, forward] = axes;
    if let Some(fov) = camera.fov {
        let axes =
            [check::direction("left", left)?, check::direction("up", up)?, check::direction("forward", forward)?];
        return Ok((sized(axes, fov, camera.fov_axis, size)?, 1.0));
    }
    for (key, axis) in [("left", left), ("up", up), ("forward", forward)] {
        check::direction(key, axis)?;
    }
    let axes = axes.map(Vec3::from_array);
    Ok((axes, axes[2].length()))
}

/// The unit vectors left, up and forward, the first two scaled so that the picture spans `fov` degrees.
fn sized([left, up, forward]: [Vec3; 3], fov: f32, axis: FovAxis, size: [u32; 2]) -> Result<[Vec3; 3]> {
    let half = (0.5 * check::angle("fov", fov, 0.0, 180.0)?).to_radians().tan();
    let [width, height] = size.map(|side| side as f32);
    let scale = match axis {
        FovAxis::X => half / width,
        FovAxis::Y => half / height,
        FovAxis::Smaller => half / width.min(height),
        FovAxis::Larger => half / width.max(height),
        FovAxis::Diagonal => half / width.hypot(height),
    };
    Ok([left * (scale * width), up * (scale * height), forward])
}
