//! Captures of a relay wall: mitransient's `transient_nlos_path` with a sensor of the type `nlos_capture_meter` on a shape.

use glam::{DVec2, DVec3};

use super::document::Kind;
use super::query::Query;
use super::{Importer, single};
use crate::error::Result;
use crate::scene::description::{
    CameraDescription, CaptureDescription, CaptureMode, Color, FilterDescription, GeometryDescription,
    IntegratorDescription, LightDescription, PathSettings,
};

impl Importer<'_> {
    /// What the integrator says of a capture, before it is known whether there is a wall.
    pub(super) fn nlos(&mut self, query: Query) -> Result<()> {
        let mode = match (query.property("capture_type"), query.text("capture_type")) {
            (None, _) => CaptureMode::Single,
            (Some(_), Ok(Some(name))) => match name.to_ascii_lowercase().as_str() {
                "single" | "1" => CaptureMode::Single,
                "confocal" | "2" => CaptureMode::Confocal,
                "exhaustive" | "3" => CaptureMode::Exhaustive,
                _ => return Err(wrong_mode(query, name)),
            },
            _ => match query.integer("capture_type")? {
                Some(1) | None => CaptureMode::Single,
                Some(2) => CaptureMode::Confocal,
                Some(3) => CaptureMode::Exhaustive,
                Some(other) => return Err(wrong_mode(query, &other.to_string())),
            },
        };
        for name in ["filter_bounces", "filter_depth"] {
            if query.integer(name)?.is_some_and(|depth| depth != -1) {
                self.warn(query.spot(name), format!("'{name}' is not supported: paths of all lengths are in the film"));
            }
        }
        if !query.boolean("force_equal_illumination_scanning", true)? {
            let name = "force_equal_illumination_scanning";
            self.warn(
                query.spot(name),
                format!("'{name}' is not supported: the laser's grid lies over all of the wall"),
            );
        }
        // How paths are sampled there is our business, and a wall does not see its own spot.
        query.ignore(&["nlos_laser_sampling", "illumination_scan_fov", "discard_direct_paths"]);
        query.ignore(&[
            "nlos_hidden_geometry_sampling_do_rroulette",
            "nlos_hidden_geometry_sampling_includes_relay_wall",
            "nlos_hidden_geometry_sampling_max_depth",
        ]);
        self.capture = Some(CaptureDescription {
            wall: String::new(),
            mode,
            laser_grid: None,
            legs: query.boolean("account_first_and_last_bounces", false)?,
            hidden_geometry: query.boolean("nlos_hidden_geometry_sampling", false)?,
        });
        Ok(())
    }

    /// The sensor on a wall of this name, once its film is known; the lamp becomes a laser.
    pub(super) fn capture_meter(&mut self, query: Query, wall: String) -> Result<CameraDescription> {
        let sensor = query.vector("sensor_origin")?.unwrap_or(DVec3::ZERO);
        // Without an integrator for it, as that there is by default.
        let nothing = || CaptureDescription {
            wall: String::new(),
            mode: CaptureMode::Single,
            laser_grid: None,
            legs: false,
            hidden_geometry: false,
        };
        let mut capture = CaptureDescription { wall, ..self.capture.take().unwrap_or_else(nothing) };
        // Where files of older versions say what the integrator says now.
        if query.boolean("confocal", false)? {
            capture.mode = CaptureMode::Confocal;
        }
        query.ignore(&["account_first_and_last_bounces"]);
        let size = self.description().film.size;
        if capture.mode == CaptureMode::Exhaustive {
            capture.laser_grid = Some(self.laser_grid(query, size)?);
        }
        let target = self.laser_target(query, &capture.wall, size)?;
        self.lasers(query.vector("laser_origin")?, target);
        let max_bounces = self.description().integrator.max_bounces();
        let description = self.description();
        description.integrator = IntegratorDescription::Path(PathSettings { max_bounces, ..PathSettings::default() });
        description.film.filter = FilterDescription::default();
        Ok(CameraDescription { origin: single(sensor), capture: Some(capture), ..CameraDescription::default() })
    }

    /// Columns and rows of the laser's points, as many as the sensor's where the film does not say; the film grows to hold
    /// all pairs.
    fn laser_grid(&mut self, query: Query, size: [u32; 2]) -> Result<[u32; 2]> {
        let film = query.part(Kind::Film).map(|part| self.query(part.object));
        let count = |name: &str, default: u32| -> Result<u32> {
            let given = film.as_ref().map(|film| film.count(name, 0)).transpose()?.flatten();
            Ok(given.filter(|&count| count > 0).unwrap_or(default))
        };
        let grid = [count("laser_scan_width", size[0])?, count("laser_scan_height", size[1])?];
        self.description().film.size = [0, 1].map(|axis| size[axis].saturating_mul(grid[axis]));
        Ok(grid)
    }

    /// Where a laser points by the pixels of older files, as a share of the wall.
    fn laser_target(&mut self, query: Query, wall: &str, size: [u32; 2]) -> Result<Option<[f32; 3]>> {
        let Some(pixel) = query.vector("laser_lookat_pixel")? else {
            return query.vector("laser_lookat_3d").map(|at| at.map(single));
        };
        let uv = (pixel.truncate() / DVec2::new(size[0].into(), size[1].into())).as_vec2().to_array();
        let shapes = &self.description().shapes;
        let Some(shape) = shapes.iter().find(|shape| shape.name.as_deref() == Some(wall)) else { return Ok(None) };
        Ok(match shape.geometry {
            GeometryDescription::Quad { corner, u, v } => {
                Some([0, 1, 2].map(|axis| corner[axis] + uv[0] * u[axis] + uv[1] * v[axis]))
            }
            _ => None,
        })
    }

    /// Makes a laser of the first projector, of its flux.
    fn lasers(&mut self, origin: Option<DVec3>, lookat: Option<[f32; 3]>) {
        let projectors = |light: &&mut LightDescription| matches!(light, LightDescription::Projector { .. });
        let Some(light) = self.description().lights.iter_mut().find(projectors) else { return };
        if let LightDescription::Projector { position, target, scale, fov, aspect, .. } = *light {
            let half = (0.5 * fov.to_radians()).tan();
            let area = 4.0 * half * half / aspect.unwrap_or(1.0);
            let power = Color(scale.0.map(|scale| scale * area));
            let position = origin.map_or(position, single);
            *light = LightDescription::Laser { position, target: Some(lookat.unwrap_or(target)), power };
        }
    }
}

fn wrong_mode(query: Query, mode: &str) -> crate::error::Error {
    query.fault(
        "capture_type",
        format!("'capture_type' must be single, confocal or exhaustive, or 1 to 3, not '{mode}'"),
    )
}
