//! A rectangle as it is seen from a point: evenly by solid angle.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::flat::Flat;

/// A rectangle with two edges of its own as axes, in double precision, as solid angles are small differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rectangle {
    corner: DVec3,
    /// Of unit length.
    axes: [DVec3; 2],
    normal: DVec3,
    edges: [f64; 2],
    center: Vec3,
    /// The square of the distance from the centre from which on nobody is near.
    reach2: f32,
}

/// A rectangle around the foot of the perpendicular from the point that sees it, `height` away from its plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    low: DVec2,
    high: DVec2,
    height: f64,
    /// See [`View::before`], at the lower end of the first axis.
    before: DVec2,
    solid_angle: f64,
}

/// Edges whose angle has a smaller cosine than this are perpendicular: what rounding leaves of it after some transforms.
const PERPENDICULAR: f64 = 4e-6;

/// Where the squares of the farthest and of the nearest distance of a rectangle differ by a larger factor, densities by area,
/// which go by the third power of the distance, differ by 8 and more: there solid angles are worth their price
/// (docs/performance.md).
const NEAR: f64 = 4.0;

/// Over the largest distance: who is nearer to the plane sees the rectangle at an angle that rounding decides.
const LEAST_HEIGHT: f64 = 1e-5;

/// What rounding can make of the sine of a solid angle is far less than this.
const LEAST_SOLID_ANGLE: f64 = 1e-9;

impl Rectangle {
    /// The parallelogram of the plane's axes, if these are perpendicular.
    pub(super) fn new(flat: &Flat) -> Option<Rectangle> {
        let [u, v] = [flat.u, flat.v].map(Vec3::as_dvec3);
        let edges = [u.length(), v.length()];
        let normal = u.cross(v).normalize();
        let is_rectangle = u.dot(v).abs() <= PERPENDICULAR * edges[0] * edges[1] && normal.is_finite();
        let axis = u / edges[0];
        // From three times half the diagonal on, no point is more than twice as far away as another.
        let reach = 1.5 * (u + v).length();
        is_rectangle.then(|| Rectangle {
            corner: flat.origin.as_dvec3(),
            axes: [axis, normal.cross(axis)],
            normal,
            edges,
            center: flat.origin + 0.5 * (flat.u + flat.v),
            reach2: (reach * reach) as f32,
        })
    }

    /// As it is seen from a point, if that is so near that it matters, and not in its plane.
    #[inline]
    pub(super) fn seen_from(&self, from: Vec3) -> Option<View> {
        if from.distance_squared(self.center) < self.reach2 { self.seen_from_nearby(from) } else { None }
    }

    fn seen_from_nearby(&self, from: Vec3) -> Option<View> {
        let to_corner = self.corner - from.as_dvec3();
        let low = DVec2::from_array(self.axes.map(|axis| axis.dot(to_corner)));
        let high = low + DVec2::from_array(self.edges);
        let height = self.normal.dot(to_corner).abs();
        let nearest2 = low.max(-high).max(DVec2::ZERO).length_squared() + height * height;
        let farthest2 = low.abs().max(high.abs()).length_squared() + height * height;
        let matters = farthest2 > NEAR * nearest2 && height * height > LEAST_HEIGHT * LEAST_HEIGHT * farthest2;
        if matters { View::new(low, high, height) } else { None }
    }
}

impl View {
    fn new(low: DVec2, high: DVec2, height: f64) -> Option<View> {
        let [before, up_to] = [low.x, high.x].map(|x| View::before(x, [low.y, high.y], height));
        let angle = DVec2::new(before.dot(up_to), before.perp_dot(up_to)).to_angle();
        // It is below 2π by more than that.
        let solid_angle = if angle < -LEAST_SOLID_ANGLE { angle + TAU } else { angle };
        (solid_angle > LEAST_SOLID_ANGLE).then_some(View { low, high, height, before, solid_angle })
    }

    /// A vector at the angle that is the solid angle from 0 to `x` on the first axis, between both ends on the second.
    fn before(x: f64, ends: [f64; 2], height: f64) -> DVec2 {
        // From 0 to x and to y it is one with the tangent x y / (height · distance).
        let corner = |y: f64| DVec2::new(height * (x * x + y * y + height * height).sqrt(), x * y);
        let [low, high] = ends.map(corner);
        DVec2::new(low.dot(high), low.perp_dot(high))
    }

    /// The solid angle of the rectangle.
    #[inline]
    pub(super) fn solid_angle(&self) -> f32 {
        self.solid_angle as f32
    }

    /// The point below which, by solid angle, so much of the rectangle lies along each axis, as shares of its edges
    /// (theory §4.3) [Ureña et al. 2013].
    pub(super) fn sample(&self, u: Vec2) -> Vec2 {
        let View { low, high, height, before, solid_angle } = *self;
        let (u, height2) = (u.as_dvec2(), height * height);
        let sine = |y: f64, distance2: f64| y / (distance2 + y * y).sqrt();
        // At x it is the angle A = arcsin(p q₁) - arcsin(p q₀), with the sines p of the angle to x and q of those to the
        // ends of the second axis. So p² = sin² A / (q₀² + q₁² - 2 q₀ q₁ cos A), from which tangents follow.
        let DVec2 { x: cos, y: sin } = DVec2::from_angle(u.x * solid_angle).rotate(before.normalize());
        let [q0, q1] = [low.y, high.y].map(|y| sine(y, height2));
        let versine = if cos > 0.0 { sin * sin / (1.0 + cos) } else { 1.0 - cos };
        let rest = (q1 - q0).powi(2) + 2.0 * q0 * q1 * versine - sin * sin;
        let x = (height * sin / rest.max(f64::MIN_POSITIVE).sqrt()).clamp(low.x, high.x);
        // On the line at x sines are even.
        let distance2 = height2 + x * x;
        let [q0, q1] = [low.y, high.y].map(|y| sine(y, distance2));
        let q = q0 + u.y * (q1 - q0);
        let y = q * (distance2 / (1.0 - q * q)).sqrt();
        ((DVec2::new(x, y) - low) / (high - low)).clamp(DVec2::ZERO, DVec2::ONE).as_vec2()
    }
}
