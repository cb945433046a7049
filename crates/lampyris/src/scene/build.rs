//! From what a file says to what is rendered: names resolved, numbers checked. Every fault becomes an
//! [`Error`] with the key of what is wrong, from which the importer finds the line.

mod ahead;
mod camera;
mod capture;
mod check;
mod lights;
mod materials;
mod media;
mod shapes;
mod textures;

use std::sync::Arc;

use glam::Vec3;

use super::description::{CameraDescription, IntegratorDescription, SceneDescription};
use super::{Assets, Lights, Media, Scene, ShapeRecord};
use crate::camera::Camera;
use crate::error::{Error, Result, Warning};
use crate::geometry::{Bounds, Shape, Surfaces};
use crate::light::{Light, World};
use crate::observer::{Observer, Phase, Silent, Work};
use crate::spectrum::Basis;

/// A scene, with what its author should know of.
#[derive(Debug)]
pub struct Built {
    /// The scene.
    pub scene: Scene,
    /// Faults that do not keep it from being rendered.
    pub warnings: Vec<Warning>,
}

/// Builds the scene that `description` tells of.
///
/// # Errors
/// The first fault, with its key: no camera, no light, a number out of its range, an unknown name, a broken mesh.
pub fn build(description: &SceneDescription, assets: &dyn Assets) -> Result<Built> {
    build_observed(description, assets, &Silent)
}

/// [`build`], telling `observer` of the phase [`Phase::Load`] and of each shape.
///
/// # Errors
/// As [`build`].
pub fn build_observed(description: &SceneDescription, assets: &dyn Assets, observer: &dyn Observer) -> Result<Built> {
    observer.phase(Phase::Load);
    description.check_settings()?;
    let camera = camera::build(description.camera.as_ref(), description.film.size)?;
    let mut read_ahead = ahead::ReadAhead::new(description, assets);
    let mut materials = materials::Builder::new(description, assets);
    let media = media::Builder::new(description, assets)?;
    let mut shapes = shapes::Builder::new(&media);
    for (name, group) in &description.groups {
        shapes
            .add_group(name, group, &mut materials, assets)
            .map_err(|error| error.under(&format!("groups.{name}")))?;
    }
    for (index, shape) in description.shapes.iter().enumerate() {
        shapes.add(shape, &mut materials, assets).map_err(|error| error.under(&format!("shapes[{index}]")))?;
        read_ahead.built(shape);
        observer.work(&Work { shapes: 1, share: 1.0 / description.shapes.len() as f64, ..Work::default() });
    }
    let (surfaces, records, area_lights) = shapes.finish();
    let world = world(&surfaces, camera.origin());
    let mut all: Vec<Light> = area_lights.into_iter().map(Light::Area).collect();
    let mut around = lights::Around { world, textures: materials.textures(), assets, pictures: 0 };
    for (index, light) in description.lights.iter().enumerate() {
        around.build(light, &mut all).map_err(|error| error.under(&format!("lights[{index}]")))?;
    }
    if all.is_empty() {
        return Err(Error::new("the scene has no light")
            .with_hint("add a light, for example a point light, or give a shape an emission"));
    }
    let relay = capture::relay(description, &records, &surfaces)?;
    let camera = relay.map_or(camera, |(relay, _)| Camera::relay(relay));
    let meter = meter(description.camera.as_ref(), &records, &surfaces)?;
    let warnings = warnings(&description.integrator, &surfaces, &all);
    let around = description.medium.as_ref().map(|name| media.by_name(name, "medium")).transpose()?;
    if around.is_some() && all.iter().any(Light::is_far) {
        return Err(Error::at_key("medium", "light from infinitely far away cannot come through a medium without end")
            .with_hint("make the medium the interior of a large sphere"));
    }
    let materials = materials.finish();
    let media = Media::new(media.finish(), around, &records);
    capture::aim_lasers(description, &mut all, media.is_some())?;
    let lights = Lights::new(all, &surfaces);
    let mut scene = Scene {
        surfaces: Arc::new(surfaces),
        shapes: records.into(),
        spectral: description.render.spectral.unwrap_or(materials.disperse()),
        materials: Arc::new(materials),
        lights: Arc::new(lights),
        camera,
        meter,
        world,
        basis: Basis::Rgb,
        media: None,
        guide: None,
        outlook: None,
        spot: None,
        targets: None,
    };
    scene.set_media(media);
    scene.set_spot()?;
    if let (Some((_, wall)), Some(capture)) = (relay, description.camera.as_ref().and_then(|c| c.capture.as_ref()))
        && capture.hidden_geometry
    {
        scene.set_targets(wall);
    }
    Ok(Built { scene, warnings })
}

/// The number of the shape whose irradiance is measured in place of a picture.
fn meter(camera: Option<&CameraDescription>, shapes: &[ShapeRecord], surfaces: &Surfaces) -> Result<Option<u32>> {
    let Some(name) = camera.and_then(|camera| camera.irradiance_of.as_deref()) else { return Ok(None) };
    let fault = |message: String| Err(Error::at_key("camera.irradiance-of", message));
    let Some(shape) = shapes.iter().position(|shape| shape.name.as_deref() == Some(name)) else {
        return fault(format!("there is no shape named '{name}' to measure the irradiance of"));
    };
    if !surfaces.area(shape as u32).is_finite() {
        return fault(format!("the shape '{name}' is infinite: its irradiance has no mean"));
    }
    Ok(Some(shape as u32))
}

/// The sphere on which photons from infinitely far away start: around all that is finite, and the camera, near which
/// infinite planes should be lit.
fn world(surfaces: &Surfaces, camera: Vec3) -> World {
    let infinite = surfaces.shapes().any(|shape| shape.bounds().is_none());
    let around_camera = if infinite { Bounds { min: camera, max: camera } } else { Bounds::EMPTY };
    let bounds = surfaces.bounds().union(around_camera);
    if bounds.is_empty() {
        return World { center: camera, radius: 1.0 };
    }
    // A little larger, so that what touches the box is not missed by rounding.
    World { center: bounds.center(), radius: (1.001 * bounds.radius()).max(f32::MIN_POSITIVE) }
}

fn warnings(integrator: &IntegratorDescription, surfaces: &Surfaces, lights: &[Light]) -> Vec<Warning> {
    let plane = surfaces.shapes().any(|shape| matches!(shape, Shape::Plane(_)));
    let far = lights.iter().any(Light::is_far);
    let photons = !matches!(integrator, IntegratorDescription::Path(_));
    let mut warnings = Vec::new();
    if !photons && lights.iter().any(|light| matches!(light, Light::Beam(beam) if beam.radius == 0.0)) {
        warnings.push(
            Warning::new("the integrator 'path' cannot see the light of an infinitely thin beam")
                .with_hint("give the beam a radius, or use 'photon-map'"),
        );
    }
    if plane && far && photons {
        warnings.push(
            Warning::new("photons from infinitely far away reach an infinite plane near the finite shapes only")
                .with_hint("use a large quad instead of the plane, or the integrator 'path'"),
        );
    }
    warnings
}
