//! Media, and where they are. A shape that names two of them has the one as its interior and stands in the other.

use std::rc::Rc;

use glam::DMat4;

use super::super::spectrum::Role;
use super::statement::Statement;
use super::{Importer, Warning};
use crate::error::Result;
use crate::medium::VolumeData;
use crate::scene::description::{Color, MediumDescription, PhaseDescription, Transform};

/// The names of the media inside and outside of the shapes that follow; empty for none.
pub(super) type Sides = Rc<[String; 2]>;

/// What pbrt-v3 takes for a medium that says nothing, in 1/mm: v4 takes 1.
const V3: [[f64; 3]; 2] = [[0.0011, 0.0024, 0.014], [2.55, 3.21, 3.77]];

impl Importer<'_> {
    pub(super) fn medium_statement(&mut self, statement: &Statement) -> Result<()> {
        match statement.keyword {
            "MediumInterface" => {
                let inside = statement.sort().to_string();
                let outside = statement.texts.get(1).cloned().unwrap_or_else(|| inside.clone());
                self.state.media = Rc::new([inside, outside]);
                Ok(())
            }
            "MakeNamedMedium" => self.make_medium(statement),
            // Only how v3 computed it.
            _ => Ok(()),
        }
    }

    fn make_medium(&mut self, statement: &Statement) -> Result<()> {
        let name = statement.sort().to_string();
        let sort = self.placed(statement.text("type"))?.unwrap_or("homogeneous").to_string();
        if sort != "homogeneous" && sort != "uniformgrid" {
            let message = format!("medium '{sort}' is not supported: it is left out");
            let place = self.reader.place(statement.spot);
            super::super::warn(&mut self.imported.warnings, || Warning::new(message).with_place(place));
            return Ok(());
        }
        let defaults = if self.is_v3 { V3 } else { [[1.0; 3]; 2] };
        let absorption = self.color(statement, "sigma_a", Role::Surface)?.unwrap_or(defaults[0]);
        let scattering = self.color(statement, "sigma_s", Role::Surface)?.unwrap_or(defaults[1]);
        let scale = self.placed(statement.number("scale", 1.0))? as f32;
        let g = self.placed(statement.number("g", 0.0))? as f32;
        if g.is_nan() || g.abs() >= 1.0 {
            return Err(self
                .reader
                .fault(statement.spot_of("g"), format!("'g' must lie between -1 and 1, not be {g}")));
        }
        let phase = if g == 0.0 { PhaseDescription::default() } else { PhaseDescription::HenyeyGreenstein { g } };
        let single = |color: [f64; 3]| Color(color.map(|channel| channel as f32));
        let medium = if sort == "homogeneous" {
            let (sigma_s, sigma_a) = (Some(single(scattering)), Some(single(absorption)));
            let (sigma_t, albedo, delay, delay_seconds) = (None, None, 0.0, None);
            MediumDescription::Homogeneous { sigma_t, albedo, sigma_s, sigma_a, scale, phase, delay, delay_seconds }
        } else {
            let extinction = [0, 1, 2].map(|channel| scattering[channel] + absorption[channel]);
            let share = |channel: usize| {
                if extinction[channel] > 0.0 { scattering[channel] / extinction[channel] } else { 0.0 }
            };
            let (file, transform) = self.density(statement, &name)?;
            MediumDescription::Grid {
                file,
                sigma_t: Some(single(extinction)),
                albedo: Some(single([0, 1, 2].map(share))),
                albedo_file: None,
                scale,
                transform,
                file_bounds: false,
                nearest: false,
                phase,
                delay: 0.0,
                delay_seconds: None,
            }
        };
        self.leftovers(statement);
        self.note(format!("media.{name}"), statement.spot);
        self.description().media.insert(name, medium);
        Ok(())
    }

    /// The densities of a grid as a file inside the scene, and where they lie.
    fn density(&mut self, statement: &Statement, name: &str) -> Result<(String, Transform)> {
        let count = |side: Result<Option<u32>, _>| self.placed(side).map(|side| side.unwrap_or(1).max(1));
        let size = [count(statement.count("nx"))?, count(statement.count("ny"))?, count(statement.count("nz"))?];
        let values = self.placed(statement.numbers("density"))?.unwrap_or_default();
        let product = size.iter().try_fold(1_u64, |product, &side| product.checked_mul(u64::from(side)));
        if product != Some(values.len() as u64) {
            let [nx, ny, nz] = size;
            let message = format!("a grid of {nx} × {ny} × {nz} has {} densities", values.len());
            return Err(self.reader.fault(statement.spot_of("density"), message));
        }
        if let Some(value) = values.iter().find(|value| !(**value >= 0.0 && **value < f64::from(f32::MAX))) {
            return Err(self.reader.fault(statement.spot_of("density"), format!("{value} is no density")));
        }
        let low = self.placed(statement.point("p0", glam::DVec3::ZERO))?;
        let high = self.placed(statement.point("p1", glam::DVec3::ONE))?;
        let values = values.iter().map(|&value| value as f32).collect();
        let data = VolumeData { size, channels: 1, bounds: [[0.0; 3], [1.0; 3]], values };
        let file = format!("{name}.vol");
        self.imported.embedded.insert(file.clone(), super::super::vol::write(&data).into());
        let matrix = self.state.ctm * DMat4::from_translation(low) * DMat4::from_scale(high - low);
        Ok((file, Transform(matrix.as_mat4())))
    }

    /// What is inside of a shape with these media on its sides.
    pub(super) fn interior(&self, sides: &Sides) -> Option<String> {
        let known = |name: &String| self.imported.description.media.contains_key(name);
        let [inside, outside] = &**sides;
        match (inside == outside, known(inside), known(outside)) {
            (true, ..) | (_, false, false) => None,
            (_, true, _) => Some(inside.clone()),
            (_, false, true) => Some("clear".to_string()),
        }
    }

    /// The medium that the camera stands in is around everything, unless a shape holds it.
    pub(super) fn medium_around(&mut self) {
        let [_, outside] = &*self.eye;
        let held = |name: &String| {
            let all = self.imported.description.shapes.iter();
            all.chain(self.imported.description.groups.values().flatten())
                .any(|shape| shape.interior.as_ref() == Some(name))
        };
        if self.imported.description.media.contains_key(outside) && !held(outside) {
            let name = outside.clone();
            self.description().medium = Some(name);
        }
    }
}
