//! Captures of a relay wall: the sensor, and what a laser asks of its scene.

use glam::{UVec2, Vec2, Vec3};

use super::check;
use crate::camera::{Lighting, Relay};
use crate::error::{Error, Result};
use crate::geometry::{Shape, Surfaces};
use crate::light::Light;
use crate::scene::ShapeRecord;
use crate::scene::description::{
    CameraDescription, CaptureDescription, CaptureMode, FilterDescription, IntegratorDescription, SceneDescription,
};

/// The wall as the sensor looks at it, and the wall's number, if the camera is of that kind.
pub(super) fn relay(
    scene: &SceneDescription,
    shapes: &[ShapeRecord],
    surfaces: &Surfaces,
) -> Result<Option<(Relay, u32)>> {
    let Some((camera, capture)) = captured(scene) else { return Ok(None) };
    let sensor = check::point("origin", camera.origin).map_err(|error| error.under("camera"))?;
    check_setting(scene, capture)?;
    let relay = || -> Result<(Relay, u32)> {
        let (wall, [corner, u, v]) = wall(&capture.wall, shapes, surfaces)?;
        let (grid, lighting) = grid(capture, UVec2::from(scene.film.size))?;
        Ok((Relay { sensor, corner, edges: [u, v], grid, lighting, legs: capture.legs }, wall))
    };
    relay().map(Some).map_err(|error| error.under("camera.capture"))
}

/// Takes the target of a laser away where the camera says what is lit, and finds a laser that is missing, one too many, or
/// where it cannot be.
pub(super) fn aim_lasers(scene: &SceneDescription, lights: &mut [Light], has_media: bool) -> Result<()> {
    let surfaces = lights.len() - scene.lights.len().min(lights.len());
    let capture = captured(scene).map(|(_, capture)| capture);
    let mut lasers = (0..).zip(lights).filter_map(|(index, light)| {
        if let Light::Laser(laser) = light {
            Some((format!("lights[{}]", index - surfaces.min(index)), laser))
        } else {
            None
        }
    });
    let (Some((key, laser)), second) = (lasers.next(), lasers.next()) else {
        return match capture {
            None => Ok(()),
            Some(_) => Err(Error::at_key("camera.capture", "there is no laser that lights the wall")
                .with_hint("add a light of the type 'laser'")),
        };
    };
    if let Some((key, _)) = second {
        return Err(Error::at_key(key, "a scene can have one laser only").with_hint("others can be beams"));
    }
    if has_media {
        return Err(Error::at_key(key, "a laser cannot shine through media")
            .with_hint("a light of the type 'beam' is followed by photons through media"));
    }
    match capture {
        Some(CaptureDescription { mode: CaptureMode::Confocal | CaptureMode::Exhaustive, .. }) => laser.target = None,
        _ if laser.target.is_none() => {
            return Err(Error::at_key(key, "the laser does not say where it shines").with_hint("give it a target"));
        }
        _ => {}
    }
    Ok(())
}

fn captured(scene: &SceneDescription) -> Option<(&CameraDescription, &CaptureDescription)> {
    let camera = scene.camera.as_ref()?;
    Some((camera, camera.capture.as_ref()?))
}

/// What else must be so in a scene whose camera looks at points of a wall.
fn check_setting(scene: &SceneDescription, capture: &CaptureDescription) -> Result<()> {
    let fault = |key: &str, message: &str, hint: &str| Err(Error::at_key(key, message).with_hint(hint));
    let is_path = matches!(scene.integrator, IntegratorDescription::Path(_));
    match (&scene.integrator, capture) {
        (IntegratorDescription::Light(_), _) => {
            let message = "the integrator 'light' does not find single points of a wall";
            return fault("camera.capture", message, "use the integrator 'path'");
        }
        (_, CaptureDescription { mode: CaptureMode::Confocal | CaptureMode::Exhaustive, .. }) if !is_path => {
            let message = "photons of one laser spot cannot serve pixels that have others";
            return fault("camera.capture.mode", message, "use the integrator 'path'");
        }
        (_, CaptureDescription { hidden_geometry: true, .. }) if !is_path => {
            let message = "only paths of the integrator 'path' can be aimed at what is hidden";
            return fault("camera.capture.hidden-geometry", message, "use it, or leave this out");
        }
        _ => {}
    }
    if scene.camera.as_ref().is_some_and(|camera| camera.irradiance_of.is_some()) {
        return fault("camera.irradiance-of", "the camera looks at points of a wall already", "give one of the two");
    }
    match scene.film.filter {
        FilterDescription::Box { radius } if radius <= 0.5 => Ok(()),
        _ => fault("film.filter", "points of a wall must not be blurred", "leave the filter out"),
    }
}

/// The number of a wall by its name, its corner and its edges.
fn wall(name: &str, shapes: &[ShapeRecord], surfaces: &Surfaces) -> Result<(u32, [Vec3; 3])> {
    let mut alone = surfaces.places().filter(|(_, instance)| instance.is_none()).map(|(shape, _)| shape);
    let Some(number) = alone.find(|&shape| shapes[shape as usize].name.as_deref() == Some(name)) else {
        return Err(Error::at_key("wall", format!("there is no shape named '{name}' to look at")));
    };
    match (surfaces.shapes().nth(number as usize), surfaces.sample(number, Vec2::ZERO)) {
        (Some(Shape::Quad(quad)), Some(corner)) => {
            let (u, v) = quad.partials();
            Ok((number, [corner.position, u, v]))
        }
        _ => Err(Error::at_key("wall", format!("the shape '{name}' is no quad")).with_hint("make the wall one")),
    }
}

/// The points that the sensor looks at, and those that are lit.
fn grid(capture: &CaptureDescription, size: UVec2) -> Result<(UVec2, Lighting)> {
    let fault = |message: &str, hint: &str| Err(Error::at_key("laser-grid", message).with_hint(hint));
    match (capture.mode, capture.laser_grid.map(UVec2::from)) {
        (CaptureMode::Single, None) => Ok((size, Lighting::Single)),
        (CaptureMode::Confocal, None) => Ok((size, Lighting::Confocal)),
        (CaptureMode::Exhaustive, Some(lasers)) => {
            if lasers.min_element() == 0 || size % lasers != UVec2::ZERO {
                return fault(
                    "the film's size is no multiple of the laser's grid",
                    "the film has as many copies of the sensor's grid as the laser has points",
                );
            }
            Ok((size / lasers, Lighting::Exhaustive(lasers)))
        }
        (CaptureMode::Exhaustive, None) => fault("the laser's grid is missing", "give columns and rows: [8, 8]"),
        (_, Some(_)) => fault("only the mode 'exhaustive' has a grid of the laser's own", "leave it out"),
    }
}
