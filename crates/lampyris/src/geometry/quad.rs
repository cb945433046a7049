//! The parallelogram.

use glam::{Vec2, Vec3};

use super::flat::Flat;
use super::rectangle::{Rectangle, View};
use super::{Bounds, Ray, Surface};

/// The points corner + a·u + b·v with a and b from 0 to 1; its normal is u × v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    flat: Flat,
    /// What [`Quad::by_solid_angle`] makes it.
    rectangle: Option<Rectangle>,
}

impl Quad {
    /// From a corner and two edges that are not parallel.
    pub fn new(corner: Vec3, u: Vec3, v: Vec3) -> Quad {
        Quad { flat: Flat::new(corner, u, v), rectangle: None }
    }

    /// The same, of which [`Quad::sample_from`] draws points if it is a rectangle.
    pub(super) fn by_solid_angle(self) -> Quad {
        Quad { rectangle: Rectangle::new(&self.flat), ..self }
    }

    pub(super) fn flat(&self) -> &Flat {
        &self.flat
    }

    /// Distance to the quad along the ray, if it is met before `max`.
    #[inline]
    pub fn intersect(&self, ray: &Ray, max: f32) -> Option<f32> {
        let (distance, ab) = self.flat.intersect(ray, max)?;
        let inside = ab.x >= 0.0 && ab.x <= 1.0 && ab.y >= 0.0 && ab.y <= 1.0;
        inside.then_some(distance)
    }

    /// The surface at `distance` along the ray; texture coordinates are a and b.
    pub fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        let ab = self.flat.met_at(ray, distance);
        self.flat.surface(ab, ab)
    }

    /// How the position changes with either texture coordinate: the edges.
    pub fn partials(&self) -> (Vec3, Vec3) {
        (self.flat.u, self.flat.v)
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        self.flat.area()
    }

    /// A point uniform by area.
    pub fn sample(&self, u: Vec2) -> Surface {
        self.flat.surface(u, u)
    }

    /// A point uniform by the solid angle under which `from` sees it, with that density; none where that is of no use.
    pub(super) fn sample_from(&self, from: Vec3, u: Vec2) -> Option<(Surface, f32)> {
        let view = self.seen_from(from)?;
        Some((self.sample(view.sample(u)), 1.0 / view.solid_angle()))
    }

    /// Density of [`Quad::sample_from`] per solid angle, in every direction that meets the quad.
    pub(super) fn pdf_from(&self, from: Vec3) -> Option<f32> {
        self.seen_from(from).map(|view| 1.0 / view.solid_angle())
    }

    #[inline]
    fn seen_from(&self, from: Vec3) -> Option<View> {
        self.rectangle.as_ref()?.seen_from(from)
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        let Flat { origin, u, v, .. } = self.flat;
        Bounds::around([Vec3::ZERO, u, v, u + v].map(|edge| origin + edge))
    }
}
