//! Where along a ray a light can shine, and how densely to ask there.

use glam::Vec3;

use crate::geometry::Ray;

/// A part of a ray that holds all points on which a light shines, if nothing stands between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Distance of its beginning, in scene units.
    pub from: f32,
    /// And of its end, which may be infinite.
    pub to: f32,
    /// About where the light comes from, with half the width of that, in scene units; none where it does not fade with the
    /// distance.
    pub center: Option<(Vec3, f32)>,
}

/// Spans are wider than light by this share, so that rounding cuts nothing off.
const MARGIN: f64 = 1e-3;

impl Span {
    /// The whole of a ray of this length.
    pub fn whole(length: f32, center: Option<(Vec3, f32)>) -> Span {
        Span { from: 0.0, to: length, center }
    }

    /// What lies between two distances, too; none if that is nothing.
    fn between(self, from: f64, to: f64) -> Option<Span> {
        let span = Span { from: self.from.max(from as f32), to: self.to.min(to as f32), ..self };
        (span.from < span.to).then_some(span)
    }

    /// What lies in a cone, too, whose edge is at this angle to its axis (unit length), at most π/2.
    pub(super) fn in_cone(self, ray: &Ray, apex: Vec3, axis: Vec3, angle: f32) -> Option<Span> {
        let angle = f64::from(angle) * (1.0 + MARGIN) + MARGIN;
        if angle >= std::f64::consts::FRAC_PI_2 {
            return Some(self);
        }
        let (axis, direction) = (axis.as_dvec3(), ray.direction.as_dvec3());
        let (offset, cos2) = ((ray.origin - apex).as_dvec3(), angle.cos().powi(2));
        let (height, rise) = (offset.dot(axis), direction.dot(axis));
        // ((o + t d)·a)² = cos² |o + t d|².
        let a = rise * rise - cos2;
        let b = height * rise - cos2 * offset.dot(direction);
        let c = height * height - cos2 * offset.length_squared();
        let discriminant = b * b - a * c;
        if discriminant < 0.0 {
            // It meets the edge nowhere, and so it would have to lie inside from end to end: no line does.
            return if a < 0.0 { None } else { Some(self) };
        }
        let root = discriminant.sqrt();
        // Without cancellation; a ray along the edge has one end.
        let q = -(b + root.copysign(b));
        let (first, second) = (q / a, if q == 0.0 { 0.0 } else { c / q });
        let [near, far] = if first < second { [first, second] } else { [second, first] };
        if !(near.is_finite() && far.is_finite()) {
            return Some(self);
        }
        if a < 0.0 {
            // Between the two, if that is not the other cone, behind the apex.
            let is_ahead = height + 0.5 * (near + far) * rise > 0.0;
            return if is_ahead { self.between(near, far) } else { None };
        }
        if rise > 0.0 { self.between(far, f64::INFINITY) } else { self.between(f64::NEG_INFINITY, near) }
    }

    /// What lies in a cylinder, too, with this axis (a point, unit length).
    pub(super) fn in_cylinder(self, ray: &Ray, (base, axis): (Vec3, Vec3), radius: f32) -> Option<Span> {
        let axis = axis.as_dvec3();
        let across = |vector: Vec3| vector.as_dvec3() - axis * vector.as_dvec3().dot(axis);
        let (offset, direction) = (across(ray.origin - base), across(ray.direction));
        let (a, b) = (direction.length_squared(), offset.dot(direction));
        let c = offset.length_squared() - (f64::from(radius) * (1.0 + MARGIN)).powi(2);
        if a < 1e-12 {
            return (c < 0.0).then_some(self);
        }
        let discriminant = b * b - a * c;
        let root = (discriminant > 0.0).then(|| discriminant.sqrt())?;
        self.between((-b - root) / a, (-b + root) / a)
    }

    /// A distance by a number in 0..1, with a density that falls with the square of the distance to the center
    /// [Kulla & Fajardo 2012, §4.1], and that density per scene unit; none without a center.
    pub fn equiangular(&self, ray: &Ray) -> Option<Equiangular> {
        let (center, radius) = self.center?;
        let offset = center - ray.origin;
        let nearest = offset.dot(ray.direction);
        let across = (offset - ray.direction * nearest).length_squared() + radius * radius;
        // Of a ray that meets a point no density would be finite.
        let height = across.sqrt().max(1e-6 * (1.0 + nearest.abs()));
        let [from, to] = [self.from, self.to].map(|end| ((end - nearest) / height).atan());
        Some(Equiangular { nearest, height, from, angle: to - from, ends: [self.from, self.to] })
    }
}

/// A density along a ray: see [`Span::equiangular`].
#[derive(Clone, Copy, Debug)]
pub struct Equiangular {
    nearest: f32,
    height: f32,
    from: f32,
    angle: f32,
    ends: [f32; 2],
}

impl Equiangular {
    /// A distance in scene units, by a number in 0..1.
    pub fn sample(&self, u: f32) -> f32 {
        let at = self.nearest + self.height * (self.from + u * self.angle).tan();
        at.clamp(self.ends[0], self.ends[1].min(f32::MAX))
    }

    /// The density at a distance, per scene unit.
    pub fn pdf(&self, at: f32) -> f32 {
        let off = (at - self.nearest) / self.height;
        1.0 / (self.angle * self.height * (1.0 + off * off))
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;

    fn unit() -> impl Strategy<Value = Vec3> {
        (-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0)
            .prop_map(|(x, y, z)| Vec3::new(x, y, z))
            .prop_filter("too short", |vector| vector.length() > 0.1)
            .prop_map(Vec3::normalize)
    }

    fn holds(span: Option<Span>, t: f32) -> bool {
        span.is_some_and(|span| span.from <= t && t <= span.to)
    }

    proptest! {
        /// A thousand rays each; half of the points are made to lie inside.
        #[test]
        fn a_span_holds_all_that_lies_in_the_cone(
            axis in unit(), to in unit(), direction in unit(), angle in 0.01_f32..1.5, far in 0.1_f32..10.0, t in 0.0_f32..10.0,
        ) {
            let at = to * far;
            let ray = Ray { origin: at - direction * t, direction };
            let span = Span::whole(20.0, None).in_cone(&ray, Vec3::ZERO, axis, angle);
            if to.dot(axis) > angle.cos() {
                prop_assert!(holds(span, t), "{span:?} does not hold {t}");
            } else if to.angle_between(axis) > angle * 1.002 + 0.002 && t > 0.1 {
                prop_assert!(!holds(span, t), "{span:?} holds {t}");
            }
        }

        #[test]
        fn a_span_holds_all_that_lies_in_the_cylinder_and_no_more(
            axis in unit(), off in unit(), direction in unit(), along in -5.0_f32..5.0, radius in 0.01_f32..2.0, t in 0.1_f32..10.0,
        ) {
            let across = off - axis * off.dot(axis);
            let ray = Ray { origin: across + axis * along - direction * t, direction };
            let span = Span::whole(20.0, None).in_cylinder(&ray, (Vec3::ZERO, axis), radius);
            if across.length() < radius {
                prop_assert!(holds(span, t), "{span:?} does not hold {t}");
            } else if across.length() > 1.01 * radius {
                prop_assert!(!holds(span, t), "{span:?} holds {t}");
            }
        }

        #[test]
        fn the_density_of_a_span_is_that_of_its_samples(
            origin in unit(), direction in unit(), center in unit(), radius in 0.0_f32..0.5, to in 0.1_f32..30.0,
        ) {
            let ray = Ray { origin: origin * 3.0, direction };
            let span = Span { from: 0.05, to, center: Some((center, radius)) };
            let density = span.equiangular(&ray).expect("there is a center");
            // d u / d t, by small steps of u.
            for u in [0.1_f32, 0.3, 0.5, 0.7, 0.9] {
                let step = 0.02;
                let [low, high] = [u - step, u + step].map(|u| density.sample(u));
                prop_assume!(high - low > 1e-3);
                let pieces = 64;
                let width = (high - low) / pieces as f32;
                let sum: f32 = (0..pieces).map(|i| density.pdf(low + (i as f32 + 0.5) * width) * width).sum();
                prop_assert!((sum / (2.0 * step) - 1.0).abs() < 0.02, "{u}: {sum}");
            }
        }
    }
}
