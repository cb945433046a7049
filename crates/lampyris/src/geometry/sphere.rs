//! The sphere.

use std::f32::consts::{PI, TAU};

use glam::{DVec3, Mat3, Vec2, Vec3};

use super::{Bounds, RELATIVE_ERROR, Ray, Surface};
use crate::math::{Frame, warp};

/// A sphere, its normal pointing out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The centre.
    pub center: Vec3,
    /// The radius.
    pub radius: f32,
    /// From world directions to those in which texture coordinates are measured (pole +z).
    to_local: Mat3,
}

impl Sphere {
    /// A sphere whose texture coordinates have their pole in +z after `rotation`, from its own axes to the world's.
    pub fn new(center: Vec3, radius: f32, rotation: Mat3) -> Sphere {
        Sphere { center, radius, to_local: rotation.transpose() }
    }

    /// Distance to the sphere along the ray, if it is met before `max`.
    ///
    /// In double precision: the discriminant is a small difference of large numbers for far or small spheres.
    #[inline]
    pub fn intersect(&self, ray: &Ray, max: f32) -> Option<f32> {
        let direction = ray.direction.as_dvec3();
        let to_center = (self.center - ray.origin).as_dvec3();
        let middle = to_center.dot(direction) / direction.length_squared();
        let radius = f64::from(self.radius);
        let half2 = radius * radius - (to_center - direction * middle).length_squared();
        if half2 < 0.0 {
            return None;
        }
        let half = (half2 / direction.length_squared()).sqrt();
        let distance = if middle - half > 0.0 { middle - half } else { middle + half };
        (distance > 0.0 && distance < f64::from(max)).then_some(distance as f32)
    }

    /// The surface at `distance` along the ray.
    pub fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        let out: DVec3 =
            ray.origin.as_dvec3() - self.center.as_dvec3() + ray.direction.as_dvec3() * f64::from(distance);
        self.at(out.normalize().as_vec3())
    }

    /// The surface in the direction `normal` (unit length) from the centre.
    fn at(&self, normal: Vec3) -> Surface {
        let local = self.to_local * normal;
        let around = local.y.atan2(local.x) / TAU;
        let uv = Vec2::new(if around < 0.0 { around + 1.0 } else { around }, local.z.clamp(-1.0, 1.0).acos() / PI);
        Surface::flat(self.center + normal * self.radius, normal, uv, self.error())
    }

    /// How the position changes with either texture coordinate, at `uv`; at the poles not with the first.
    pub fn partials(&self, uv: Vec2) -> (Vec3, Vec3) {
        let ((sin_around, cos_around), (sin, cos)) = ((TAU * uv.x).sin_cos(), (PI * uv.y).sin_cos());
        let to_world = self.to_local.transpose() * self.radius;
        let along_u = Vec3::new(-sin * sin_around, sin * cos_around, 0.0) * TAU;
        let along_v = Vec3::new(cos * cos_around, cos * sin_around, -sin) * PI;
        (to_world * along_u, to_world * along_v)
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        4.0 * PI * self.radius * self.radius
    }

    /// A point uniform by area.
    pub fn sample(&self, u: Vec2) -> Surface {
        self.at(warp::sphere(u))
    }

    /// A point uniform by the solid angle under which `from`, outside, sees it, with that density.
    pub fn sample_from(&self, from: Vec3, u: Vec2) -> Option<(Surface, f32)> {
        let cos_max = self.cone_from(from)?;
        let axis = (self.center - from).normalize();
        let direction = Frame::around(axis).to_world(warp::cone(u, cos_max));
        let ray = Ray { origin: from, direction };
        // A direction at the rim can miss by rounding: then the rim itself is meant.
        let distance = self.intersect(&ray, f32::INFINITY).unwrap_or_else(|| (self.center - from).dot(direction));
        Some((self.surface(&ray, distance), warp::cone_pdf(cos_max)))
    }

    /// Density of [`Sphere::sample_from`] per solid angle, in every direction that meets the sphere; none from inside.
    pub fn pdf_from(&self, from: Vec3) -> Option<f32> {
        self.cone_from(from).map(warp::cone_pdf)
    }

    /// Cosine of half the angle under which the sphere is seen; none from inside or from the sphere itself, which
    /// rounding may put a little outside, or where the cone is too thin to tell its cosine from 1.
    fn cone_from(&self, from: Vec3) -> Option<f32> {
        let distance = (self.center.as_dvec3() - from.as_dvec3()).length();
        let sin2 = (f64::from(self.radius) / distance).powi(2);
        let cos_max = (1.0 - sin2).max(0.0).sqrt() as f32;
        let outside = distance > f64::from(self.radius + 4.0 * self.error());
        (outside && cos_max < 0.999_999).then_some(cos_max)
    }

    /// How far rounding can put a point off the sphere.
    fn error(&self) -> f32 {
        RELATIVE_ERROR * (self.center.abs().max_element() + self.radius)
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        Bounds { min: self.center - self.radius, max: self.center + self.radius }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen from itself, as from inside a glowing shell, a sphere has no cone, whichever way its points are rounded.
    #[test]
    fn from_a_sphere_itself_there_is_no_cone() {
        let sphere = Sphere::new(Vec3::new(3.0, -2.0, 0.7), 0.9, Mat3::IDENTITY);
        for index in 0..1000 {
            let u = Vec2::new((index as f32 * 0.618_034).fract(), (index as f32 + 0.5) / 1000.0);
            let surface = sphere.sample(u);
            assert_eq!(sphere.pdf_from(surface.position), None);
            assert_eq!(sphere.pdf_from(surface.offset(-surface.normal)), None);
        }
        assert!(sphere.pdf_from(Vec3::new(3.0, -2.0, 1.7)).is_some());
    }

    #[test]
    fn a_ray_from_outside_meets_the_near_side_and_from_inside_the_far_one() {
        let sphere = Sphere::new(Vec3::new(0.0, 0.0, 5.0), 1.0, Mat3::IDENTITY);
        let ray = |z| Ray { origin: Vec3::new(0.0, 0.0, z), direction: Vec3::Z };
        assert_eq!(sphere.intersect(&ray(0.0), 100.0), Some(4.0));
        assert_eq!(sphere.intersect(&ray(5.0), 100.0), Some(1.0));
        assert_eq!(sphere.intersect(&ray(7.0), 100.0), None);
        assert_eq!(sphere.intersect(&ray(0.0), 3.0), None);
    }
}
