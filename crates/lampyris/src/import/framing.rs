//! A view and a light for files that have none.

use crate::geometry::{Bounds, MeshData};
use crate::scene::description::{CameraDescription, Color, FovAxis, LightDescription};

/// Field of view in degrees across the shorter side of the picture.
const FOV: f32 = 40.0;
/// How much more than the scene the picture shows.
const MARGIN: f32 = 1.05;

/// Which way is up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Up {
    /// +y, and we look along -z.
    Y,
    /// +z, and we look along +y.
    Z,
}

/// A camera before the scene that has all of it in view: it looks straight at the front of the scene's box, so that
/// a room without a front wall is seen from its open side; at something flat on the ground, from above.
pub(super) fn frame(bounds: &Bounds, up: Up) -> CameraDescription {
    let center = bounds.center();
    let mut extent = (bounds.max - bounds.min).max(glam::Vec3::ZERO);
    // Of a point, or what is as good as one where it lies, any view will do.
    let least = 1e-5 * center.abs().max_element();
    if extent.max_element() <= least {
        extent = glam::Vec3::splat(if least > 0.0 { least } else { 1.0 });
    }
    // Width, height and depth as the camera sees them, and its axes in the world.
    let (size, upright, mut backward) = match up {
        Up::Y => (extent, glam::Vec3::Y, glam::Vec3::Z),
        Up::Z => (glam::Vec3::new(extent.x, extent.z, extent.y), glam::Vec3::Z, -glam::Vec3::Y),
    };
    let widest = size.max_element().max(f32::MIN_POSITIVE);
    let half = 0.5 * size.x.max(size.y).max(0.05 * widest);
    let mut distance = MARGIN * half / (0.5 * FOV).to_radians().tan() + 0.5 * size.z;
    if size.y < 0.05 * widest {
        backward = (backward + upright).normalize();
        distance = MARGIN * 0.5 * size.length() / (0.5 * FOV).to_radians().sin();
    }
    CameraDescription {
        origin: (center + backward * distance).to_array(),
        target: Some(center.to_array()),
        up: Some(upright.to_array()),
        fov: Some(FOV),
        fov_axis: FovAxis::Smaller,
        ..CameraDescription::default()
    }
}

/// The same light from everywhere.
pub(super) fn default_light() -> LightDescription {
    LightDescription::Constant { radiance: Color::grey(1.0) }
}

/// The box around meshes; empty without any.
pub(super) fn bounds<'a>(meshes: impl IntoIterator<Item = &'a MeshData>) -> Bounds {
    let points = meshes.into_iter().flat_map(|mesh| &mesh.positions);
    points.fold(Bounds::EMPTY, |bounds, &point| bounds.union(Bounds::around([glam::Vec3::from_array(point)])))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn seen(bounds: Bounds, up: Up) -> bool {
        let camera = frame(&bounds, up);
        let (origin, target) = (Vec3::from_array(camera.origin), Vec3::from_array(camera.target.expect("set")));
        let forward = (target - origin).normalize();
        let right = forward.cross(Vec3::from_array(camera.up.expect("set"))).normalize();
        let upright = right.cross(forward);
        let limit = (0.5 * FOV).to_radians().tan();
        (0..8).all(|corner| {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] };
            let point = Vec3::new(pick(0), pick(1), pick(2)) - origin;
            let depth = point.dot(forward);
            depth > 0.0 && [right, upright].iter().all(|side| (point.dot(*side) / depth).abs() <= limit)
        })
    }

    #[test]
    fn all_corners_of_the_box_are_in_the_picture() {
        for extent in [Vec3::ONE, Vec3::new(1.0, 20.0, 3.0), Vec3::new(9.0, 0.1, 9.0), Vec3::new(1e-3, 1e-3, 2e-3)] {
            for up in [Up::Y, Up::Z] {
                let min = Vec3::new(5.0, -3.0, 2.0);
                assert!(seen(Bounds { min, max: min + extent }, up), "{extent} {up:?}");
            }
        }
    }

    #[test]
    fn a_room_is_seen_from_its_front() {
        let room = Bounds { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::new(1.0, 2.0, 1.0) };
        let camera = frame(&room, Up::Y);
        assert_eq!((camera.origin[0], camera.origin[1]), (0.0, 1.0));
        assert!((3.7..4.0).contains(&camera.origin[2]), "{:?}", camera.origin);
    }
}
