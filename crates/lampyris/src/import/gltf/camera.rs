//! The camera: the first of the scene, or one that sees all of it.

use glam::DVec3;

use super::Importer;
use super::nodes::Placed;
use super::source::missing;
use crate::error::{Result, Warning};
use crate::import::framing::{self, Up};
use crate::scene::description::{CameraDescription, FovAxis, Projection};

/// Sides of pictures, as width over height, that are believed.
const ASPECTS: std::ops::RangeInclusive<f64> = 0.05..=20.0;

impl Importer<'_> {
    /// The first camera of the scene; none where it has none.
    pub(super) fn camera(&mut self, placed: &[Placed]) -> Result<()> {
        for Placed { node: index, to_world } in placed {
            let node = self.node(*index)?;
            let Some(camera) = node.camera else { continue };
            if self.imported.description.camera.is_some() {
                self.warn("cameras", "only the first camera of the scene is used");
                return Ok(());
            }
            let path = format!("cameras[{camera}]");
            let cameras = &self.document.cameras;
            let camera = cameras.get(camera).ok_or_else(|| missing(&self.spots, &path, cameras.len()))?;
            let forward = to_world.transform_vector3(-DVec3::Z).try_normalize();
            let up = to_world.transform_vector3(DVec3::Y).try_normalize();
            let (Some(forward), Some(up)) = (forward, up) else {
                return Err(self.spots.fault(&format!("nodes[{index}]"), "the camera's node makes an axis zero"));
            };
            let origin = to_world.transform_point3(DVec3::ZERO);
            let mut description = CameraDescription {
                origin: origin.as_vec3().to_array(),
                target: Some((origin + forward).as_vec3().to_array()),
                up: Some(up.as_vec3().to_array()),
                ..CameraDescription::default()
            };
            let aspect = match (&camera.perspective, &camera.orthographic) {
                (Some(lens), _) => {
                    description.fov = Some(lens.yfov.to_degrees() as f32);
                    description.fov_axis = FovAxis::Y;
                    lens.aspect_ratio
                }
                (None, Some(lens)) => {
                    let (x, y) = (lens.xmag.abs(), lens.ymag.abs());
                    description.projection = Projection::Orthographic;
                    description.width = Some(2.0 * x as f32);
                    (y > 0.0).then_some(x / y)
                }
                (None, None) => return Err(self.spots.fault(&path, "it is neither perspective nor orthographic")),
            };
            self.imported.description.camera = Some(description);
            self.note("camera", &path);
            match aspect {
                Some(aspect) if ASPECTS.contains(&aspect) => {
                    let size = &mut self.imported.description.film.size;
                    size[1] = ((f64::from(size[0]) / aspect).round() as u32).max(1);
                }
                Some(aspect) => self.warn(&path, format!("an aspect ratio of {aspect} is passed over")),
                None => {}
            }
        }
        Ok(())
    }

    /// A camera that sees all shapes, for a scene without one.
    pub(super) fn frame(&mut self) {
        self.imported.description.camera = Some(framing::frame(&self.bounds, Up::Y));
        let warning = Warning::new("the file has no camera: one in front of the scene that sees all of it is used")
            .with_hint("place one with --set camera.origin=... and --set camera.target=...");
        self.imported.warnings.push(warning.with_file(&self.path));
    }
}
