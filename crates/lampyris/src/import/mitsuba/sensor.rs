//! The camera, its film and its sampler.

use glam::{DMat4, DVec3};

use super::document::Kind;
use super::query::Query;
use super::{Importer, single};
use crate::error::Result;
use crate::scene::description::{CameraDescription, FilmDescription, FilterDescription, FovAxis};

/// Half the diagonal of a 36 mm × 24 mm picture, in mm.
const HALF_DIAGONAL: f64 = 21.633_307_652_783_94;

impl Importer<'_> {
    /// The first sensor of the scene, if there is one.
    pub(super) fn sensor(&mut self, sensors: &[usize]) -> Result<()> {
        for &other in sensors.iter().skip(1) {
            self.left_out(other, "only the first sensor is used");
        }
        let Some(&object) = sensors.first() else { return Ok(()) };
        let query = self.query(object);
        let plugin = query.object.plugin.as_str();
        self.note("camera", query.object.spot);
        let mut camera = self.view(query)?;
        let focus_distance = query.optional_float("focus_distance")?;
        if plugin == "thinlens" {
            let Some(radius) = query.optional_float("aperture_radius")? else {
                return Err(query.fault("aperture_radius", "a thinlens needs an 'aperture_radius'"));
            };
            camera.aperture_radius = radius as f32;
            camera.focus_distance = focus_distance.map(|distance| distance as f32);
        } else if plugin != "perspective" {
            self.left_out(object, "a perspective camera is used");
        }
        for offset in ["principal_point_offset_x", "principal_point_offset_y"] {
            if query.float(offset, 0.0)? != 0.0 {
                self.warn(query.spot(offset), format!("'{offset}' is not supported: the view stays centred"));
            }
        }
        query.ignore(&["near_clip", "far_clip", "shutter_open", "shutter_close"]);
        let names = [("fov", "fov"), ("aperture-radius", "aperture_radius"), ("focus-distance", "focus_distance")];
        self.note_all("camera", query, &names);
        self.description().camera = Some(camera);
        let film = query.part(Kind::Film).map(|part| part.object);
        self.film(film)?;
        if let Some(part) = query.part(Kind::Sampler) {
            self.sampler(part.object)?;
        }
        if plugin == "perspective" || plugin == "thinlens" {
            self.leftovers(query);
        }
        Ok(())
    }

    /// Where the camera is and what it sees. Mitsuba's looks along +z, +y up, +x to the left of the picture; a
    /// mirroring matrix mirrors the picture.
    fn view(&mut self, query: Query) -> Result<CameraDescription> {
        let matrix = query.transform("to_world")?.unwrap_or(DMat4::IDENTITY);
        let axis = |axis: DVec3| matrix.transform_vector3(axis).try_normalize();
        let (Some(left), Some(up), Some(forward)) = (axis(DVec3::X), axis(DVec3::Y), axis(DVec3::Z)) else {
            return Err(query.fault("to_world", "the camera's 'to_world' makes an axis zero"));
        };
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
        Ok(CameraDescription {
            origin: single(matrix.transform_point3(DVec3::ZERO)),
            left: Some(single(left)),
            up: Some(single(up)),
            forward: Some(single(forward)),
            fov: Some(fov as f32),
            fov_axis,
            ..CameraDescription::default()
        })
    }

    fn film(&mut self, object: Option<usize>) -> Result<()> {
        // Mitsuba's sizes where the file gives none.
        let mut film = FilmDescription { size: [768, 576], filter: FilterDescription::Gaussian { stddev: 0.5 } };
        let Some(object) = object else {
            self.description().film = film;
            return Ok(());
        };
        let query = self.query(object);
        film.size[0] = query.count("width", 1)?.unwrap_or(film.size[0]);
        film.size[1] = query.count("height", 1)?.unwrap_or(film.size[1]);
        if let Some(part) = query.part(Kind::Filter) {
            film.filter = self.filter(part.object)?;
        }
        for crop in ["crop_offset_x", "crop_offset_y", "crop_width", "crop_height"] {
            if query.integer(crop)?.is_some() {
                self.warn(query.spot(crop), format!("'{crop}' is not supported: the whole picture is drawn"));
            }
        }
        // How their file is written, and what we always or never do.
        query.ignore(&["file_format", "pixel_format", "component_format", "gamma", "banner", "attach_log"]);
        query.ignore(&[
            "high_quality_edges",
            "sample_border",
            "compensate",
            "tonemap_method",
            "exposure",
            "key",
            "burn",
        ]);
        let known = matches!(query.object.plugin.as_str(), "hdrfilm" | "ldrfilm" | "mfilm" | "specfilm");
        if known {
            self.leftovers(query);
        } else {
            self.left_out(object, "an ordinary film of its size is used");
        }
        self.note("film", query.object.spot);
        self.note_all("film", query, &[("size", "width")]);
        self.description().film = film;
        Ok(())
    }

    fn filter(&mut self, object: usize) -> Result<FilterDescription> {
        let query = self.query(object);
        let filter = match query.object.plugin.as_str() {
            "box" => FilterDescription::Box { radius: query.float("radius", 0.5)? as f32 },
            "tent" => FilterDescription::Tent { radius: query.float("radius", 1.0)? as f32 },
            "gaussian" => FilterDescription::Gaussian { stddev: query.float("stddev", 0.5)? as f32 },
            _ => {
                self.left_out(object, "a Gaussian of standard deviation 0.5 is used");
                return Ok(FilterDescription::Gaussian { stddev: 0.5 });
            }
        };
        self.leftovers(query);
        self.note("film.filter", query.object.spot);
        Ok(filter)
    }

    /// Samples per pixel; the pattern is ours whatever theirs is.
    fn sampler(&mut self, object: usize) -> Result<()> {
        let query = self.query(object);
        let passes = query.count("sample_count", 1)?;
        let seed = query.integer("seed")?;
        self.description().render.passes = passes;
        if let Some(seed) = seed {
            let seed = u64::try_from(seed).map_err(|_| query.fault("seed", "the seed must not be negative"))?;
            self.description().render.seed = seed;
        }
        query.ignore(&["jitter", "dimension", "scramble"]);
        self.note("render.passes", query.spot("sample_count"));
        self.leftovers(query);
        Ok(())
    }
}

/// The field of view across the diagonal, in degrees, of a lens such as `50mm` before 35 mm film.
fn diagonal_fov(query: Query, focal_length: &str) -> Result<f64> {
    let text = focal_length.trim().trim_end_matches("mm");
    match super::value::number(text) {
        Ok(focal_length) if focal_length > 0.0 => Ok(2.0 * (HALF_DIAGONAL / focal_length).atan().to_degrees()),
        _ => Err(query.fault("focal_length", format!("'focal_length' must be like 50mm, not '{focal_length}'"))),
    }
}
