//! The camera: what it measures and where it stands.

mod film;

use glam::{DMat4, DVec3};

use super::document::Kind;
use super::query::Query;
use super::{Importer, single};
use crate::error::Result;
use crate::scene::description::{CameraDescription, FovAxis, Projection};
use film::Window;

/// Half the diagonal of a 36 mm × 24 mm picture, in mm.
const HALF_DIAGONAL: f64 = 21.633_307_652_783_94;
/// Half the width of a picture that stands for a single ray, in scene units.
const RAY_WIDTH: f64 = 1e-6;

/// Unit vectors to the left, up and forward.
type Axes = [DVec3; 3];

impl<'a> Importer<'a> {
    /// The first sensor of the scene, or else the first on a shape, if there is one.
    pub(super) fn sensor(&mut self, sensors: &[usize]) -> Result<()> {
        let meters = std::mem::take(&mut self.meters);
        let all: Vec<usize> = sensors.iter().copied().chain(meters.iter().map(|(object, _)| *object)).collect();
        for &other in all.iter().skip(1) {
            self.left_out(other, "only the first sensor is used");
        }
        let Some(&object) = all.first() else { return Ok(()) };
        let measured = if sensors.is_empty() { meters.first().map(|(_, name)| name.clone()) } else { None };
        let query = self.first_of_batch(object)?;
        self.note("camera", query.object.spot);
        let window = self.film(query.part(Kind::Film).map(|part| part.object))?;
        let plugin = query.object.plugin.to_ascii_lowercase();
        let (camera, known) = match (plugin.as_str(), measured) {
            ("nlos_capture_meter", Some(wall)) => (self.capture_meter(query, wall)?, true),
            (_, Some(shape)) => {
                (CameraDescription { irradiance_of: Some(shape), ..CameraDescription::default() }, true)
            }
            ("perspective", _) => (self.perspective(query, &window)?, true),
            ("thinlens", _) => (self.thin_lens(query, &window)?, true),
            ("orthographic", _) => (self.orthographic(query, &window)?, true),
            ("radiancemeter", _) => (one_ray(query)?, true),
            ("telecentric" | "codedorthographic", _) => {
                self.left_out(object, "an orthographic camera is used");
                (self.orthographic(query, &window)?, false)
            }
            _ => {
                self.left_out(object, "a perspective camera is used");
                (self.perspective(query, &window)?, false)
            }
        };
        self.exterior(query)?;
        let camera = match query.optional_float("near_clip")? {
            // Where the way of light begins there; else it hides nothing that people would want hidden.
            Some(near) if known && self.description().film.time.is_some() => {
                CameraDescription { near_distance: near as f32, ..camera }
            }
            _ => camera,
        };
        query.ignore(&["near_clip", "far_clip", "shutter_open", "shutter_close", "srf", "focus_distance"]);
        let names = [("fov", "fov"), ("aperture-radius", "aperture_radius"), ("focus-distance", "focus_distance")];
        self.note_all("camera", query, &names);
        self.description().camera = Some(camera);
        if let Some(part) = query.part(Kind::Sampler) {
            self.sampler(part.object)?;
        }
        if known {
            self.leftovers(query);
        }
        if self.capture.is_some() {
            let message = "without a sensor of the type 'nlos_capture_meter' on a shape, 'transient_nlos_path' is as 'transient_path'";
            self.warn(query.object.spot, message);
        }
        Ok(())
    }

    /// The name for a shape whose irradiance a sensor on it measures, or whose points one looks at; other sensors there are
    /// left out.
    pub(super) fn meter(&mut self, query: Query, key: &str) -> Option<String> {
        let sensor = query.part(Kind::Sensor)?.object;
        let plugin = self.document.objects[sensor].plugin.as_str();
        if !matches!(plugin, "irradiancemeter" | "nlos_capture_meter") || self.group.is_some() {
            self.left_out(sensor, "this sensor is left out");
            return None;
        }
        let name = query.object.id.clone().unwrap_or_else(|| key.replace(['[', ']'], "-").trim_end_matches('-').into());
        self.meters.push((sensor, name.clone()));
        Some(name)
    }

    /// The sensor itself, or the first of several that would stand side by side in one picture.
    fn first_of_batch(&mut self, mut object: usize) -> Result<Query<'a>> {
        for depth in 0.. {
            let query = self.query(object);
            self.visit(query, depth)?;
            match query.part(Kind::Sensor) {
                Some(part) if query.object.plugin == "batch" => {
                    self.left_out(object, "its first sensor is used, with its own film");
                    object = part.object;
                }
                _ => break,
            }
        }
        Ok(self.query(object))
    }

    fn perspective(&mut self, query: Query, window: &Window) -> Result<CameraDescription> {
        let (origin, axes, _) = placement(query)?;
        let fov_axis = match query.text("fov_axis")? {
            None | Some("x") => FovAxis::X,
            Some("y") => FovAxis::Y,
            Some("smaller") => FovAxis::Smaller,
            Some("larger") => FovAxis::Larger,
            Some("diagonal") => FovAxis::Diagonal,
            Some(other) => {
                let message = format!("'fov_axis' must be x, y, diagonal, smaller or larger, not '{other}'");
                return Err(query.fault("fov_axis", message));
            }
        };
        let (fov, fov_axis) = match (query.optional_float("fov")?, query.text("focal_length")?) {
            (Some(fov), _) => (fov, fov_axis),
            (None, focal_length) => (diagonal_fov(query, focal_length.unwrap_or("50mm"))?, FovAxis::Diagonal),
        };
        let offset = |axis: &str| query.float(&format!("principal_point_offset_{axis}"), 0.0);
        let offset = [offset("x")?, offset("y")?];
        if offset == [0.0; 2] && window.is_whole() {
            let [left, up, forward] = axes.map(|axis| Some(single(axis)));
            let fov = Some(fov as f32);
            return Ok(CameraDescription {
                origin: single(origin),
                left,
                up,
                forward,
                fov,
                fov_axis,
                ..Default::default()
            });
        }
        if !(fov > 0.0 && fov < 180.0) {
            return Err(query.fault("fov", format!("'fov' must lie between 0 and 180 degrees, not {fov}")));
        }
        // A part of the picture: all of it, spanned by vectors, then the window's share.
        let [width, height] = window.full.map(f64::from);
        let along = match fov_axis {
            FovAxis::X => width,
            FovAxis::Y => height,
            FovAxis::Smaller => width.min(height),
            FovAxis::Larger => width.max(height),
            FovAxis::Diagonal => width.hypot(height),
        };
        let half = (0.5 * fov).to_radians().tan() / along;
        let [left, up, forward] = axes;
        let (left, up) = (left * (half * width), up * (half * height));
        let middle = forward - 2.0 * (offset[0] * left + offset[1] * up);
        Ok(spanned(origin, window.part([left, up], middle)))
    }

    fn thin_lens(&mut self, query: Query, window: &Window) -> Result<CameraDescription> {
        let Some(radius) = query.optional_float("aperture_radius")? else {
            return Err(query.fault("aperture_radius", "a thinlens needs an 'aperture_radius'"));
        };
        // Its default is the far end of what is drawn there.
        let far = query.float("far_clip", 1e4)?;
        let focus_distance = Some(query.float("focus_distance", far)? as f32);
        let camera = self.perspective(query, window)?;
        Ok(CameraDescription { aperture_radius: radius as f32, focus_distance, ..camera })
    }

    /// From -1 to 1 across the width, where the matrix does not scale.
    fn orthographic(&mut self, query: Query, window: &Window) -> Result<CameraDescription> {
        let (origin, [left, up, forward], [across, along]) = placement(query)?;
        let [width, height] = window.full.map(f64::from);
        let (left, up) = (left * across, up * (along * height / width));
        let [left, up, middle] = window.part([left, up], DVec3::ZERO);
        let camera = spanned(origin + middle, [left, up, forward]);
        Ok(CameraDescription { projection: Projection::Orthographic, ..camera })
    }
}

/// Where the camera is and what it sees: the lengths that the matrix gives to its x and y axes come last. Mitsuba's
/// camera looks along +z, +y up, +x to the left of the picture; a mirroring matrix mirrors the picture.
fn placement(query: Query) -> Result<(DVec3, Axes, [f64; 2])> {
    let matrix = query.transform("to_world")?.unwrap_or(DMat4::IDENTITY);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| matrix.transform_vector3(axis));
    let [Some(left), Some(up), Some(forward)] = axes.map(DVec3::try_normalize) else {
        return Err(query.fault("to_world", "the camera's 'to_world' makes an axis zero"));
    };
    Ok((matrix.transform_point3(DVec3::ZERO), [left, up, forward], [axes[0].length(), axes[1].length()]))
}

fn spanned(origin: DVec3, axes: Axes) -> CameraDescription {
    let [left, up, forward] = axes.map(|axis| Some(single(axis)));
    CameraDescription { origin: single(origin), left, up, forward, ..CameraDescription::default() }
}

/// A camera so narrow that it sees along one ray.
fn one_ray(query: Query) -> Result<CameraDescription> {
    let (origin, [left, up, forward]) = match (query.vector("origin")?, query.vector("direction")?) {
        (Some(origin), Some(direction)) => {
            let Some(forward) = direction.try_normalize() else {
                return Err(query.fault("direction", "the direction must not be zero"));
            };
            let (left, up) = forward.any_orthonormal_pair();
            (origin, [left, up, forward])
        }
        _ => {
            let (origin, axes, _) = placement(query)?;
            (origin, axes)
        }
    };
    let camera = spanned(origin, [left * RAY_WIDTH, up * RAY_WIDTH, forward]);
    Ok(CameraDescription { projection: Projection::Orthographic, ..camera })
}

/// The field of view across the diagonal, in degrees, of a lens such as `50mm` before 35 mm film.
fn diagonal_fov(query: Query, focal_length: &str) -> Result<f64> {
    let text = focal_length.trim().trim_end_matches("mm");
    match super::value::number(text) {
        Ok(focal_length) if focal_length > 0.0 => Ok(2.0 * (HALF_DIAGONAL / focal_length).atan().to_degrees()),
        _ => Err(query.fault("focal_length", format!("'focal_length' must be like 50mm, not '{focal_length}'"))),
    }
}
