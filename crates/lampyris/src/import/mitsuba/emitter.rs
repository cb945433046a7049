//! Lights that are not surfaces.

use glam::{DMat4, DVec3};

use super::spectrum::Role;
use super::{Importer, single};
use crate::error::Result;
use crate::scene::description::LightDescription;

impl Importer<'_> {
    /// An emitter of the scene itself.
    pub(super) fn light(&mut self, object: usize) -> Result<()> {
        let query = self.query(object);
        query.ignore(&["sampling_weight"]);
        let key = format!("lights[{}]", self.description().lights.len());
        let to_world = query.transform("to_world")?;
        let matrix = to_world.unwrap_or(DMat4::IDENTITY);
        let light = match query.object.plugin.as_str() {
            "point" => {
                let position = query.vector("position")?.unwrap_or_else(|| matrix.transform_point3(DVec3::ZERO));
                self.note_all(&key, query, &[("position", "position"), ("intensity", "intensity")]);
                let intensity = Some(self.color(query, "intensity", Role::Light, 1.0)?);
                LightDescription::Point { position: single(position), intensity, power: None }
            }
            "spot" => {
                let cutoff = query.float("cutoff_angle", 20.0)?;
                let beam_width = query.float("beam_width", cutoff * 0.75)?;
                let names = [("cutoff", "cutoff_angle"), ("beam-width", "beam_width"), ("target", "to_world")];
                self.note_all(&key, query, &names);
                LightDescription::Spot {
                    position: single(matrix.transform_point3(DVec3::ZERO)),
                    target: single(matrix.transform_point3(DVec3::Z)),
                    intensity: Some(self.color(query, "intensity", Role::Light, 1.0)?),
                    power: None,
                    cutoff: cutoff as f32,
                    beam_width: Some(beam_width as f32),
                }
            }
            "directional" => {
                let direction = query.vector("direction")?.unwrap_or_else(|| matrix.transform_vector3(DVec3::Z));
                self.note_all(&key, query, &[("direction", "direction"), ("irradiance", "irradiance")]);
                let irradiance = self.color(query, "irradiance", Role::Light, 1.0)?;
                LightDescription::Directional { direction: single(direction), irradiance, angle: 0.0 }
            }
            "constant" => LightDescription::Constant { radiance: self.color(query, "radiance", Role::Light, 1.0)? },
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
}
