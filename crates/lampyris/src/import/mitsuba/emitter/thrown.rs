//! Lights that throw a picture or a beam.

use std::f64::consts::PI;

use glam::{DMat4, DVec3};

use crate::error::Result;
use crate::import::mitsuba::document::Kind;
use crate::import::mitsuba::query::Query;
use crate::import::mitsuba::spectrum::Role;
use crate::import::mitsuba::{Importer, single};
use crate::scene::description::{Color, LightDescription, Paint};

/// Field of view, in degrees, across the width of a square picture through the lens of 50 mm that is the default.
const SQUARE_FOV: f64 = 34.022_1;

impl<'a> Importer<'a> {
    /// Mitsuba's irradiance is that which a white wall would show as its radiance: π times less than the light
    /// that arrives.
    pub(super) fn projector(&mut self, query: Query<'a>, matrix: DMat4, key: &str) -> Result<LightDescription> {
        let name = if query.has("irradiance") { "irradiance" } else { "texture" };
        let part = query.named_part(name).or_else(|| query.part(Kind::Texture));
        let paint = match part {
            Some(part) => {
                let shared = self.query(part.object).object.id.is_some();
                match self.painted(part.object, Role::Light, 1.0)? {
                    Paint::Texture(name) => Paint::Texture(self.upright(name, shared)),
                    color => color,
                }
            }
            None => self.paint(query, name, Role::Light, 1.0)?,
        };
        let fov = query.optional_float("fov")?;
        let across = query.text("fov_axis")?.unwrap_or("x");
        query.ignore(&["focal_length"]);
        if (fov.is_none() || across != "x") && matches!(paint, Paint::Texture(_)) {
            let named = if fov.is_some() { "fov_axis" } else { "focal_length" };
            let message = "the field of view of a projector is taken for that across its width";
            self.warn(query.spot(named), message);
        }
        if matrix.determinant() < 0.0 {
            self.warn(query.spot("to_world"), "a projector cannot be mirrored: its picture stays as it is");
        }
        self.note_all(key, query, &[("texture", name), ("fov", "fov"), ("scale", "scale"), ("target", "to_world")]);
        let scale = Color::grey((PI * query.float("scale", 1.0)?) as f32);
        let (texture, scale) = match paint {
            Paint::Texture(name) => (Some(name), scale),
            Paint::Color(color) => (None, Color([0, 1, 2].map(|channel| scale.0[channel] * color.0[channel]))),
        };
        Ok(LightDescription::Projector {
            position: single(matrix.transform_point3(DVec3::ZERO)),
            target: single(matrix.transform_point3(DVec3::Z)),
            up: single(matrix.transform_vector3(DVec3::Y)),
            texture,
            aspect: None,
            fov: fov.unwrap_or(SQUARE_FOV) as f32,
            scale,
        })
    }

    /// 0.x: an infinitely thin beam along +z.
    pub(super) fn collimated(&mut self, query: Query, matrix: DMat4) -> Result<LightDescription> {
        Ok(LightDescription::Beam {
            position: single(matrix.transform_point3(DVec3::ZERO)),
            direction: single(matrix.transform_vector3(DVec3::Z)),
            power: self.color(query, "power", Role::Light, 1.0)?,
            radius: 0.0,
        })
    }
}
