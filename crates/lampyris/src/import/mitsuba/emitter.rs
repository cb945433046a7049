//! Lights that are not surfaces.

mod sky;
mod thrown;

use glam::{DMat4, DVec3};

use super::document::Kind;
use super::query::Query;
use super::spectrum::Role;
use super::{Importer, single};
use crate::error::Result;
use crate::scene::description::{Color, EnvironmentMapping, LightDescription, Transform};

impl<'a> Importer<'a> {
    /// An emitter of the scene itself.
    pub(super) fn light(&mut self, object: usize) -> Result<()> {
        let query = self.query(object);
        query.ignore(&["sampling_weight"]);
        self.exterior(query)?;
        let key = format!("lights[{}]", self.description().lights.len());
        let matrix = query.transform("to_world")?.unwrap_or(DMat4::IDENTITY);
        let light = match query.object.plugin.as_str() {
            "point" => self.point(query, matrix, &key)?,
            "spot" => self.spot(query, matrix, &key)?,
            "directional" => self.directional(query, matrix, &key)?,
            "constant" => LightDescription::Constant { radiance: self.color(query, "radiance", Role::Light, 1.0)? },
            "envmap" => self.environment(query, matrix, &key)?,
            plugin @ ("sunsky" | "sky" | "sun") => self.sky(query, matrix, plugin)?,
            "projector" => self.projector(query, matrix, &key)?,
            "perspectiveprojector" => {
                self.left_out(object, "it is taken for a 'projector'");
                self.projector(query, matrix, &key)?
            }
            "collimated" => self.collimated(query, matrix)?,
            // Shapes refer to it.
            "area" if query.object.id.is_some() => return Ok(()),
            _ => {
                self.left_out(object, "this light is left out");
                return Ok(());
            }
        };
        self.note(key, query.object.spot);
        self.leftovers(query);
        self.description().lights.push(light);
        Ok(())
    }

    fn point(&mut self, query: Query, matrix: DMat4, key: &str) -> Result<LightDescription> {
        let position = query.vector("position")?.unwrap_or_else(|| matrix.transform_point3(DVec3::ZERO));
        self.note_all(key, query, &[("position", "position"), ("intensity", "intensity")]);
        let intensity = Some(self.color(query, "intensity", Role::Light, 1.0)?);
        Ok(LightDescription::Point { position: single(position), intensity, power: None })
    }

    fn spot(&mut self, query: Query, matrix: DMat4, key: &str) -> Result<LightDescription> {
        let cutoff = query.float("cutoff_angle", 20.0)?;
        let beam_width = query.float("beam_width", cutoff * 0.75)?;
        let names = [("cutoff", "cutoff_angle"), ("beam-width", "beam_width"), ("target", "to_world")];
        self.note_all(key, query, &names);
        Ok(LightDescription::Spot {
            position: single(matrix.transform_point3(DVec3::ZERO)),
            target: single(matrix.transform_point3(DVec3::Z)),
            intensity: Some(self.color(query, "intensity", Role::Light, 1.0)?),
            power: None,
            cutoff: cutoff as f32,
            beam_width: Some(beam_width as f32),
        })
    }

    fn directional(&mut self, query: Query, matrix: DMat4, key: &str) -> Result<LightDescription> {
        let direction = query.vector("direction")?.unwrap_or_else(|| matrix.transform_vector3(DVec3::Z));
        self.note_all(key, query, &[("direction", "direction"), ("irradiance", "irradiance")]);
        let irradiance = self.color(query, "irradiance", Role::Light, 1.0)?;
        Ok(LightDescription::Directional { direction: single(direction), irradiance, angle: 0.0 })
    }

    /// A picture all around, its middle in the direction +z, +x to its left, as ours.
    fn environment(&mut self, query: Query<'a>, matrix: DMat4, key: &str) -> Result<LightDescription> {
        let picture = query.part(Kind::Texture).map(|part| self.query(part.object));
        let file = match (query.text("filename")?, picture) {
            (Some(file), _) => file,
            (None, Some(picture)) => {
                let file = picture.text("filename")?;
                picture.ignore(&["raw", "filter_type", "wrap_mode", "format", "accel", "gamma", "cache"]);
                self.leftovers(picture);
                file.ok_or_else(|| query.fault("", "the picture of an envmap needs a 'filename'"))?
            }
            (None, None) => return Err(query.fault("filename", "an envmap needs a 'filename'")),
        };
        // Before 0.4 the factor had another name.
        let name = if query.has("intensity_scale") { "intensity_scale" } else { "scale" };
        let scale = query.float(name, 1.0)?;
        query.ignore(&["cache", "mis_compensation"]);
        if query.optional_float("gamma")?.is_some_and(|gamma| gamma > 0.0 && gamma != 1.0) {
            self.warn(query.spot("gamma"), "'gamma' of an envmap is not supported: that of its file is used");
        }
        self.note_all(key, query, &[("file", "filename"), ("scale", name), ("transform", "to_world")]);
        Ok(LightDescription::Environment {
            file: file.to_string(),
            scale: Color::grey(scale as f32),
            mapping: EnvironmentMapping::LatLong,
            transform: Transform(matrix.as_mat4()),
        })
    }
}
