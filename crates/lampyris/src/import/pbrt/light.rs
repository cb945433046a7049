//! Lights that are not surfaces.

use std::f64::consts::PI;

use glam::{DMat4, DVec3};

use super::super::spectrum::Role;
use super::Importer;
use super::material::color;
use super::statement::Statement;
use crate::error::{Result, did_you_mean};
use crate::scene::description::{EnvironmentMapping, LightDescription, Transform};

const SORTS: [&str; 6] = ["distant", "goniometric", "infinite", "point", "projection", "spot"];

impl Importer<'_> {
    pub(super) fn light(&mut self, statement: &Statement) -> Result<()> {
        let scale = self.light_scale(statement)?;
        let light = match statement.sort() {
            "infinite" => self.infinite(statement, scale)?,
            "distant" => self.distant(statement, scale)?,
            "point" => self.point(statement, scale, "I")?,
            "spot" => self.spot(statement, scale)?,
            "projection" => self.projection(statement, scale)?,
            "goniometric" => {
                self.warn(statement.spot, "a goniometric light is not supported: it shines equally in all directions");
                statement.ignore(&["filename", "mapname"]);
                self.point(statement, scale, "I")?
            }
            other => {
                let message = format!("light '{other}' is not supported: it is left out");
                match did_you_mean(other, SORTS) {
                    Some(near) => self.warn_with(statement.spot, message, &format!("did you mean '{near}'?")),
                    None => self.warn(statement.spot, message),
                }
                return Ok(());
            }
        };
        statement.ignore(&["nsamples", "samples"]);
        self.leftovers(statement);
        if let Some(light) = light {
            let key = format!("lights[{}]", self.description().lights.len());
            self.note(key, statement.spot);
            self.description().lights.push(light);
        }
        Ok(())
    }

    /// `scale`, which pbrt-v3 writes as a colour, of which the mean is taken, and the film's exposure.
    fn light_scale(&mut self, statement: &Statement) -> Result<f64> {
        let scale = self.color(statement, "scale", Role::Surface)?.unwrap_or([1.0; 3]);
        Ok(scale.iter().sum::<f64>() / 3.0 * self.exposure)
    }

    /// The colour of a light by its parameter, times a factor; none where it is black.
    fn emitted(&mut self, statement: &Statement, name: &'static str, factor: f64) -> Result<Option<[f64; 3]>> {
        let emitted = self.color(statement, name, Role::Light)?.unwrap_or([1.0; 3]).map(|channel| channel * factor);
        if let Some(channel) = emitted.iter().find(|channel| **channel < 0.0) {
            let message = format!("a light must not be negative, but this one is {channel}");
            return Err(self.reader.fault(statement.spot, message));
        }
        Ok(Some(emitted).filter(|emitted| emitted.iter().any(|&channel| channel > 0.0)))
    }

    /// The parameter if it is above 0, as pbrt has it.
    fn wanted(&self, statement: &Statement, name: &'static str) -> Result<Option<f64>> {
        Ok(self.placed(statement.optional_number(name))?.filter(|value| *value > 0.0))
    }

    fn infinite(&mut self, statement: &Statement, scale: f64) -> Result<Option<LightDescription>> {
        if statement.has("portal") {
            statement.ignore(&["portal"]);
            let message = "portals are not supported: light comes from all directions";
            self.warn(statement.spot_of("portal"), message);
        }
        let illuminance = self.wanted(statement, "illuminance")?;
        let is_v3 = statement.has("mapname");
        let file = self.placed(statement.text(if is_v3 { "mapname" } else { "filename" }))?.unwrap_or("").to_string();
        if file.is_empty() {
            let factor = scale * illuminance.map_or(1.0, |illuminance| illuminance / PI);
            let radiance = self.emitted(statement, "L", factor)?;
            return Ok(radiance.map(|radiance| LightDescription::Constant { radiance: color(radiance) }));
        }
        if illuminance.is_some() {
            let message = "the illuminance of a picture is not supported: it is ignored";
            self.warn(statement.spot_of("illuminance"), message);
        }
        let tint = self.emitted(statement, "L", scale)?;
        // pbrt-v3's pictures have +z at the top and +x at the left edge, and turn the other way than ours.
        let lat_long =
            DMat4::from_cols(-DVec3::Y.extend(0.0), DVec3::Z.extend(0.0), DVec3::X.extend(0.0), glam::DVec4::W);
        let (mapping, axes) = match is_v3 {
            true => (EnvironmentMapping::LatLong, lat_long),
            false => (EnvironmentMapping::EqualArea, DMat4::IDENTITY),
        };
        let transform = Transform((self.state.ctm * axes).as_mat4());
        Ok(tint.map(|tint| LightDescription::Environment { file, scale: color(tint), mapping, transform }))
    }

    fn distant(&mut self, statement: &Statement, scale: f64) -> Result<Option<LightDescription>> {
        let from = self.placed(statement.point("from", DVec3::ZERO))?;
        let to = self.placed(statement.point("to", DVec3::Z))?;
        let illuminance = self.wanted(statement, "illuminance")?.unwrap_or(1.0);
        let direction = self.state.ctm.transform_vector3(to - from);
        if direction.length_squared() == 0.0 {
            return Err(self.reader.fault(statement.spot, "a distant light's 'from' and 'to' must differ"));
        }
        let direction = direction.normalize().as_vec3().to_array();
        let irradiance = self.emitted(statement, "L", scale * illuminance)?;
        Ok(irradiance.map(|irradiance| LightDescription::Directional {
            direction,
            irradiance: color(irradiance),
            angle: 0.0,
        }))
    }

    fn point(&mut self, statement: &Statement, scale: f64, name: &'static str) -> Result<Option<LightDescription>> {
        let from = self.placed(statement.point("from", DVec3::ZERO))?;
        let position = self.state.ctm.transform_point3(from).as_vec3().to_array();
        let power = self.wanted(statement, "power")?;
        let emitted = self.emitted(statement, name, scale * power.map_or(1.0, |power| power / (4.0 * PI)))?;
        let intensity = emitted.map(color);
        Ok(intensity.map(|intensity| LightDescription::Point { position, intensity: Some(intensity), power: None }))
    }

    /// Full within `coneangle` − `conedeltaangle`, nothing beyond `coneangle`. Between, pbrt falls smoothly in the
    /// cosine, we in the angle.
    fn spot(&mut self, statement: &Statement, scale: f64) -> Result<Option<LightDescription>> {
        let from = self.placed(statement.point("from", DVec3::ZERO))?;
        let to = self.placed(statement.point("to", DVec3::Z))?;
        let cone = self.placed(statement.number("coneangle", 30.0))?;
        let delta = self.placed(statement.number("conedeltaangle", 5.0))?;
        let power = self.wanted(statement, "power")?;
        let [edge, full] = [cone, (cone - delta).max(0.0)].map(|degrees| degrees.to_radians().cos());
        let share = 2.0 * PI * ((1.0 - full) + (full - edge) / 2.0);
        let emitted = self.emitted(statement, "I", scale * power.map_or(1.0, |power| power / share))?;
        let [position, target] = [from, to].map(|point| self.state.ctm.transform_point3(point).as_vec3().to_array());
        Ok(emitted.map(|intensity| LightDescription::Spot {
            position,
            target,
            intensity: Some(color(intensity)),
            power: None,
            cutoff: cone as f32,
            beam_width: Some((cone - delta).clamp(0.0, cone.max(0.0)) as f32),
        }))
    }

    fn projection(&mut self, statement: &Statement, scale: f64) -> Result<Option<LightDescription>> {
        let name = if statement.has("mapname") { "mapname" } else { "filename" };
        let file = self.placed(statement.text(name))?.map(str::to_string);
        let fov = self.placed(statement.number("fov", 90.0))?;
        if self.wanted(statement, "power")?.is_some() {
            let message = "the power of a projection is not supported: it is ignored";
            self.warn(statement.spot_of("power"), message);
        }
        self.warn(
            statement.spot,
            "a projection has the same irradiance, not the same intensity, over a flat screen, and 'fov' spans its width",
        );
        let Some(scale) = self.emitted(statement, "I", scale)? else { return Ok(None) };
        let matrix = self.state.ctm;
        let texture = file.map(|file| self.plain_picture(&file, false, statement.spot));
        Ok(Some(LightDescription::Projector {
            position: matrix.transform_point3(DVec3::ZERO).as_vec3().to_array(),
            target: matrix.transform_point3(DVec3::Z).as_vec3().to_array(),
            // pbrt's rows run along +y.
            up: matrix.transform_vector3(-DVec3::Y).as_vec3().to_array(),
            texture,
            aspect: None,
            fov: fov as f32,
            scale: color(scale),
        }))
    }
}
