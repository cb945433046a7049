//! `KHR_lights_punctual`, and the sky of a scene without light.
//!
//! The numbers are photometric in glTF (candela, lux) and radiometric here (W/sr, W/m²); they are taken as they are,
//! as viewers do, since emission and exposure have no other scale to agree with.

use glam::DVec3;

use super::Importer;
use super::extensions::PunctualLight;
use super::nodes::Placed;
use super::source::missing;
use crate::error::{Result, Warning};
use crate::import::framing::default_light;
use crate::scene::description::{Color, LightDescription};

impl Importer<'_> {
    /// The lights of all nodes.
    pub(super) fn lights(&mut self, placed: &[Placed]) -> Result<()> {
        for Placed { node: index, to_world } in placed {
            let Some(light) = &self.node(*index)?.extensions.light else { continue };
            let path = format!("extensions.KHR_lights_punctual.lights[{}]", light.light);
            let lights = self.document.extensions.lights.as_ref().map_or(&[][..], |lights| &lights.lights);
            let light = lights.get(light.light).ok_or_else(|| missing(&self.spots, &path, lights.len()))?;
            let position = to_world.transform_point3(DVec3::ZERO);
            let Some(direction) = to_world.transform_vector3(-DVec3::Z).try_normalize() else {
                return Err(self.spots.fault(&format!("nodes[{index}]"), "the light's node makes an axis zero"));
            };
            let strength = light.color.map(|channel| channel * light.intensity);
            if strength.iter().all(|&channel| channel <= 0.0) {
                continue;
            }
            let Some(light) = placed_light(light, position, direction, Color(strength)) else {
                self.warn(&path, format!("there is no light of type '{}': it is left out", light.kind));
                continue;
            };
            let number = self.imported.description.lights.len();
            self.note(format!("lights[{number}]"), &format!("nodes[{index}]"));
            self.imported.description.lights.push(light);
        }
        Ok(())
    }

    /// A sky for a scene that would be dark. What glows by a picture, as screens and lamps of a car do, is not taken
    /// for its light.
    pub(super) fn sky(&mut self) {
        if self.glows || !self.imported.description.lights.is_empty() {
            return;
        }
        self.imported.description.lights.push(default_light());
        let message = "the file has no light: a white sky of radiance 1 is used";
        self.imported.warnings.push(Warning::new(message).with_file(&self.path));
    }
}

fn placed_light(light: &PunctualLight, position: DVec3, direction: DVec3, strength: Color) -> Option<LightDescription> {
    let single = |vector: DVec3| vector.as_vec3().to_array();
    Some(match (light.kind.as_str(), &light.spot) {
        ("point", _) => LightDescription::Point { position: single(position), intensity: Some(strength), power: None },
        ("directional", _) => {
            LightDescription::Directional { direction: single(direction), irradiance: strength, angle: 0.0 }
        }
        ("spot", cone) => {
            let (inner, outer) = cone
                .as_ref()
                .map_or((0.0, std::f32::consts::FRAC_PI_4), |cone| (cone.inner_cone_angle, cone.outer_cone_angle));
            LightDescription::Spot {
                position: single(position),
                target: single(position + direction),
                intensity: Some(strength),
                power: None,
                cutoff: outer.to_degrees(),
                beam_width: Some(inner.to_degrees()),
            }
        }
        _ => return None,
    })
}
