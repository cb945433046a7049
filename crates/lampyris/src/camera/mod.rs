//! The camera: a pinhole, a thin lens or parallel rays, spanned by three vectors as the course writes it; or a sensor that
//! looks at single points of a wall.

mod relay;

use glam::{Mat3, Vec2, Vec3};

pub use relay::{Lighting, Relay};

use crate::geometry::{Cone, Ray};
use crate::math::warp;

/// A camera with its picture in pixels: (0, 0) is the top left corner of the picture, x goes right, y down.
///
/// The picture's points are `origin + forward + a·left + b·up`, a and b from -1 to 1. A pixel's value is the mean of
/// the radiance over its area in the picture, and over the lens. An orthographic camera's rays are parallel to `forward`
/// and start at `origin + a·left + b·up`.
#[derive(Clone, Debug)]
pub struct Camera {
    origin: Vec3,
    /// Columns left, up, forward.
    axes: Mat3,
    inverse: Mat3,
    size: Vec2,
    /// Unit normal of the picture plane, pointing forward.
    normal: Vec3,
    /// Distance of the picture plane from the origin.
    depth: f32,
    /// Area of a pixel in the picture plane.
    pixel_area: f32,
    opening: Opening,
    /// Distance, along the normal, of the plane from which on it sees.
    near: f32,
}

/// Through what rays enter a camera.
#[derive(Clone, Copy, Debug)]
enum Opening {
    Lens(Lens),
    /// The picture itself, all rays parallel.
    Parallel,
    /// A point, each pixel one point of a wall.
    Wall(Relay),
}

/// The opening of a camera.
#[derive(Clone, Copy, Debug)]
struct Lens {
    radius: f32,
    /// Orthonormal, parallel to the picture plane.
    x: Vec3,
    y: Vec3,
    /// Distance of the plane in focus over that of the picture plane.
    focus: f32,
}

/// A point of the scene as the camera sees it, for light tracing.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Where in the picture, in pixels; may lie outside.
    pub pixel: Vec2,
    /// The point of the lens, or of the plane from which on the camera sees.
    pub lens: Vec3,
    /// Value of the pixel for an intensity of 1 W/sr towards the lens, in 1/m².
    pub importance: f32,
}

impl Camera {
    /// A camera for a picture of `width × height` pixels, with a lens of `lens_radius` (0 for a pinhole) in focus at
    /// `focus_distance` along the normal of the picture plane.
    ///
    /// None if `left`, `up` and `forward` lie in a plane.
    pub fn new(
        origin: Vec3,
        [left, up, forward]: [Vec3; 3],
        [width, height]: [u32; 2],
        lens_radius: f32,
        focus_distance: f32,
    ) -> Option<Camera> {
        let camera = Camera::orthographic(origin, [left, up, forward], [width, height])?;
        let x = left.normalize();
        let lens = Lens { radius: lens_radius, x, y: camera.normal.cross(x), focus: focus_distance / camera.depth };
        Some(Camera { opening: Opening::Lens(lens), ..camera })
    }

    /// An orthographic camera, whose half picture is `left` wide and `up` high.
    ///
    /// None if `left`, `up` and `forward` lie in a plane.
    pub fn orthographic(origin: Vec3, [left, up, forward]: [Vec3; 3], [width, height]: [u32; 2]) -> Option<Camera> {
        let axes = Mat3::from_cols(left, up, forward);
        let volume = left.cross(up).dot(forward).abs();
        // Compared with the product of the lengths, so that no unit comes into it. False for NaN, too.
        let spans_space = volume > 1e-6 * left.length() * up.length() * forward.length();
        if !spans_space {
            return None;
        }
        let normal = left.cross(up).normalize();
        let normal = if normal.dot(forward) < 0.0 { -normal } else { normal };
        let depth = normal.dot(forward);
        let size = Vec2::new(width as f32, height as f32);
        let pixel_area = 4.0 * left.cross(up).length() / (size.x * size.y);
        let opening = Opening::Parallel;
        Some(Camera { origin, axes, inverse: axes.inverse(), size, normal, depth, pixel_area, opening, near: 0.0 })
    }

    /// The same that sees nothing before a plane at this distance along its normal, where its rays begin, too.
    #[must_use]
    pub fn from_plane(self, near: f32) -> Camera {
        Camera { near, ..self }
    }

    /// A sensor that looks at points of a wall.
    pub fn relay(relay: Relay) -> Camera {
        let size = relay.pixels().as_vec2();
        let (axes, normal) = (Mat3::IDENTITY, Vec3::Z);
        let opening = Opening::Wall(relay);
        Camera {
            origin: relay.sensor,
            axes,
            inverse: axes,
            size,
            normal,
            depth: 1.0,
            pixel_area: 0.0,
            opening,
            near: 0.0,
        }
    }

    /// The wall, if the camera looks at points of one.
    pub fn wall(&self) -> Option<&Relay> {
        if let Opening::Wall(relay) = &self.opening { Some(relay) } else { None }
    }

    /// The ray through a point of the picture, in pixels, and a point of the unit square for the lens.
    pub fn ray(&self, pixel: Vec2, lens: Vec2) -> Ray {
        let across = Vec2::ONE - 2.0 * pixel / self.size;
        let ray = match &self.opening {
            Opening::Parallel => {
                Ray { origin: self.origin + self.axes * across.extend(0.0), direction: self.axes.z_axis.normalize() }
            }
            Opening::Lens(opening) => {
                let through = self.axes * across.extend(1.0);
                let on_lens = opening.at(lens);
                Ray { origin: self.origin + on_lens, direction: (through * opening.focus - on_lens).normalize() }
            }
            Opening::Wall(relay) => return relay.ray(pixel),
        };
        if self.near == 0.0 {
            return ray;
        }
        Ray { origin: ray.at(self.near / self.normal.dot(ray.direction)), ..ray }
    }

    /// The point `at` as seen through a point of the lens; none from behind the camera, and none of a wall of which single
    /// points are seen.
    pub fn see(&self, at: Vec3, lens: Vec2) -> Option<Seen> {
        let opening = match &self.opening {
            Opening::Lens(opening) => opening,
            Opening::Parallel => return self.see_in_parallel(at),
            Opening::Wall(_) => return None,
        };
        let on_lens = opening.at(lens);
        let to_point = at - self.origin - on_lens;
        let along = self.normal.dot(to_point);
        if along <= self.near {
            return None;
        }
        // Where the ray from the lens to the point meets the plane in focus, from the middle of the lens.
        let focus_depth = self.depth * opening.focus;
        let on_ray = to_point * (focus_depth / along);
        let in_focus = on_lens + on_ray;
        let local = self.inverse * in_focus;
        let across = Vec2::new(local.x, local.y) / local.z;
        // A pixel's area in the plane in focus, seen from the lens: dω = area · cos / distance².
        let distance2 = on_ray.length_squared();
        let cos = focus_depth / distance2.sqrt();
        let area = self.pixel_area * opening.focus * opening.focus;
        let per_solid_angle = distance2 / (area * cos);
        Some(Seen {
            pixel: 0.5 * (Vec2::ONE - across) * self.size,
            lens: self.origin + on_lens + to_point * (self.near / along),
            importance: per_solid_angle / to_point.length_squared(),
        })
    }

    /// What a ray of the camera stands for: a pixel in the middle of the picture, as wide as it is high. What a lens
    /// blurs is left to the samples.
    pub fn cone(&self) -> Cone {
        let side = self.pixel_area.sqrt();
        match self.opening {
            Opening::Lens(_) => Cone { width: self.near * side / self.depth, spread: side / self.depth },
            Opening::Parallel => Cone { width: side, spread: 0.0 },
            Opening::Wall(relay) => relay.cone(),
        }
    }

    /// Where the pinhole or the middle of the lens is.
    pub fn origin(&self) -> Vec3 {
        self.origin
    }

    fn see_in_parallel(&self, at: Vec3) -> Option<Seen> {
        let local = self.inverse * (at - self.origin);
        let across = Vec2::new(local.x, local.y);
        // A surface's area, seen along the rays, is as large as its shadow on a plane across them.
        let cos = self.depth / self.axes.z_axis.length();
        let axis = self.axes.z_axis;
        let near = self.near / self.depth;
        (local.z > near).then(|| Seen {
            pixel: 0.5 * (Vec2::ONE - across) * self.size,
            lens: self.origin + self.axes * across.extend(0.0) + axis * near,
            importance: 1.0 / (self.pixel_area * cos),
        })
    }
}

impl Lens {
    /// The point of the lens, from its middle, on which a point of the unit square falls.
    fn at(&self, u: Vec2) -> Vec3 {
        if self.radius == 0.0 {
            return Vec3::ZERO;
        }
        let p = warp::disk(u) * self.radius;
        self.x * p.x + self.y * p.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lab_camera(lens_radius: f32) -> Camera {
        let axes = [Vec3::NEG_X, Vec3::Y, Vec3::new(0.0, 0.0, 3.0)];
        Camera::new(Vec3::new(0.0, 0.0, -3.5), axes, [256, 256], lens_radius, 4.0).expect("a good camera")
    }

    #[test]
    fn the_labs_left_edge_is_at_minus_x() {
        let ray = lab_camera(0.0).ray(Vec2::new(0.0, 128.0), Vec2::ZERO);
        assert!((ray.direction - Vec3::new(-1.0, 0.0, 3.0).normalize()).length() < 1e-6);
    }

    #[test]
    fn what_a_ray_meets_is_seen_where_the_ray_went_through_the_picture() {
        for camera in [lab_camera(0.0), lab_camera(0.2)] {
            let (pixel, lens) = (Vec2::new(30.5, 200.25), Vec2::new(0.9, 0.3));
            for distance in [1.0, 4.0, 20.0] {
                let ray = camera.ray(pixel, lens);
                let seen = camera.see(ray.at(distance), lens).expect("in front of the camera");
                assert!((seen.pixel - pixel).length() < 1e-2, "{:?}", seen.pixel);
            }
        }
    }

    #[test]
    fn parallel_rays_see_what_they_meet_and_a_lit_wall_at_its_radiance() {
        // Skewed on purpose: the rays do not run along the normal of the picture.
        let axes = [Vec3::new(-2.0, 0.0, 0.0), Vec3::new(0.5, 1.0, 0.0), Vec3::new(0.4, 0.2, 1.0)];
        let camera = Camera::orthographic(Vec3::new(1.0, 2.0, -3.0), axes, [40, 20]).expect("a good camera");
        let ray = camera.ray(Vec2::new(7.25, 15.5), Vec2::ZERO);
        let seen = camera.see(ray.at(5.0), Vec2::ZERO).expect("in front of the camera");
        assert!((seen.pixel - Vec2::new(7.25, 15.5)).length() < 1e-3 && (seen.lens - ray.origin).length() < 1e-5);
        assert!(camera.see(ray.at(-1.0), Vec2::ZERO).is_none());
        // What a pixel sees of a wall parallel to the picture is as large as the pixel; of radiance 1, its intensity along
        // the rays is area · cos.
        let area = 2.0 * 2.0 * 2.0 * 1.0 / (40.0 * 20.0);
        let cos = ray.direction.z;
        assert!((seen.importance * area * cos - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_pixel_of_a_uniform_wall_adds_up_to_its_radiance() {
        // A wall at z = 0 of radiance 1: the pixel's value is ∫ importance · cos dA over all that falls into it.
        let camera = lab_camera(0.0);
        let side = 3.5 / 3.0 * 2.0 / 256.0;
        let (mut sum, n) = (0.0, 16);
        for i in 0..n {
            for j in 0..n {
                let offset = |step: i32| 1.0 + (step as f32 + 0.5) / n as f32;
                let at = Vec3::new(offset(i), offset(j), 0.0) * side;
                let seen = camera.see(at, Vec2::ZERO).expect("in front");
                assert_eq!(seen.pixel.floor(), Vec2::new(129.0, 126.0));
                sum += seen.importance * (seen.lens - at).normalize().z.abs() * side * side / (n * n) as f32;
            }
        }
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
    }
}
