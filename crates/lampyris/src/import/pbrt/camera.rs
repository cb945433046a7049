//! The camera: where it is and which part of its screen the picture shows.

use glam::{DMat4, DVec2, DVec3};

use super::Importer;
use super::statement::Statement;
use crate::error::Result;
use crate::scene::description::{CameraDescription, FovAxis, Projection};

/// The part of the film that is kept, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crop {
    pub full: [u32; 2],
    pub low: [u32; 2],
    pub high: [u32; 2],
}

impl Crop {
    pub fn whole(full: [u32; 2]) -> Crop {
        Crop { full, low: [0, 0], high: full }
    }
}

impl Importer<'_> {
    /// The camera for the statement, with the transform from world to camera at its place.
    pub(super) fn camera(&mut self, statement: &Statement, to_camera: DMat4, crop: Crop) -> Result<()> {
        let sort = statement.sort();
        if !matches!(sort, "perspective" | "orthographic") {
            self.warn(statement.spot, format!("camera '{sort}' is not supported: a perspective camera is used"));
            statement.ignore(&[
                "lensfile",
                "aperturediameter",
                "focusdistance",
                "aperture",
                "mapping",
                "simpleweighting",
            ]);
        }
        if to_camera.determinant() == 0.0 {
            return Err(self.reader.fault(statement.spot, "the transform of the camera is singular"));
        }
        let matrix = to_camera.inverse();
        let fov = self.fov(statement)?;
        let (low, high, is_plain) = self.screen(statement, crop)?;
        let orthographic = sort == "orthographic";
        let half = if orthographic { 1.0 } else { (0.5 * fov).to_radians().tan() };
        let [right, up, forward] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| matrix.transform_vector3(axis));
        let [middle, sides] = [0.5 * (low + high) * half, 0.5 * (high - low) * half];
        let shift = right * middle.x + up * middle.y;
        let origin = matrix.transform_point3(DVec3::ZERO);
        let mut camera = CameraDescription { origin: single(origin), ..CameraDescription::default() };
        let alike = |a: DVec3, b: DVec3| (a.length() - b.length()).abs() <= 1e-3 * a.length();
        let spans = |camera: &mut CameraDescription, forward: DVec3| {
            camera.left = Some(single(-right * sides.x));
            camera.up = Some(single(up * sides.y));
            camera.forward = Some(single(forward));
        };
        if orthographic {
            camera.projection = Projection::Orthographic;
            camera.origin = single(origin + shift);
            spans(&mut camera, forward);
        } else if is_plain && alike(right, up) && alike(up, forward) {
            camera.left = Some(single(-right.normalize()));
            camera.up = Some(single(up.normalize()));
            camera.forward = Some(single(forward.normalize()));
            camera.fov = Some(fov as f32);
            camera.fov_axis = FovAxis::Smaller;
        } else {
            spans(&mut camera, forward + shift);
        }
        let radius = self.placed(statement.number("lensradius", 0.0))?;
        let focus = self.placed(statement.number("focaldistance", 1e6))?;
        if radius > 0.0 {
            camera.aperture_radius = (radius * right.length()) as f32;
            camera.focus_distance = Some((focus * forward.length()) as f32);
        }
        statement.ignore(&["shutteropen", "shutterclose", "hither", "yon"]);
        self.leftovers(statement);
        self.note("camera", statement.spot);
        for (ours, theirs) in [("fov", "fov"), ("aperture-radius", "lensradius"), ("focus-distance", "focaldistance")] {
            self.note(format!("camera.{ours}"), statement.spot_of(theirs));
        }
        self.description().camera = Some(camera);
        Ok(())
    }

    fn fov(&mut self, statement: &Statement) -> Result<f64> {
        if self.placed(statement.optional_number("halffov"))?.is_some() {
            return Ok(2.0 * self.placed(statement.number("halffov", 45.0))?);
        }
        let fov = self.placed(statement.number("fov", 90.0))?;
        match fov > 0.0 && fov < 180.0 {
            true => Ok(fov),
            false => {
                Err(self.reader.fault(statement.spot_of("fov"), format!("'fov' must lie between 0 and 180, not {fov}")))
            }
        }
    }

    /// The lower left and upper right corner of the picture on the screen, whose shorter side spans -1 to 1, and
    /// whether it is the whole screen.
    fn screen(&mut self, statement: &Statement, crop: Crop) -> Result<(DVec2, DVec2, bool)> {
        let [width, height] = crop.full.map(f64::from);
        let aspect = self.placed(statement.number("frameaspectratio", width / height))?;
        let square = (aspect / (width / height) - 1.0).abs() < 1e-6;
        let corner = if aspect > 1.0 { DVec2::new(aspect, 1.0) } else { DVec2::new(1.0, 1.0 / aspect) };
        let (mut low, mut high, mut plain) = (-corner, corner, square);
        match self.placed(statement.numbers("screenwindow"))? {
            None | Some([]) => {}
            Some(&[left, right, bottom, top]) => {
                let (new_low, new_high) = (DVec2::new(left, bottom), DVec2::new(right, top));
                plain = plain && (new_low - low).length() < 1e-6 && (new_high - high).length() < 1e-6;
                (low, high) = (new_low, new_high);
            }
            Some(_) => {
                let spot = statement.spot_of("screenwindow");
                return Err(self.reader.fault(spot, "'screenwindow' must be four numbers"));
            }
        }
        if crop != Crop::whole(crop.full) {
            plain = false;
            // Rows are counted from the top.
            let at = |column: u32, row: u32| {
                let share = DVec2::new(f64::from(column) / width, 1.0 - f64::from(row) / height);
                low + (high - low) * share
            };
            (low, high) = (at(crop.low[0], crop.high[1]), at(crop.high[0], crop.low[1]));
        }
        if !((high - low).min_element() > 0.0 && low.is_finite() && high.is_finite()) {
            return Err(self.reader.fault(statement.spot_of("screenwindow"), "the camera's screen has no area"));
        }
        Ok((low, high, plain))
    }
}

fn single(vector: DVec3) -> [f32; 3] {
    vector.as_vec3().to_array()
}
