//! From the unit square to where samples are needed, preserving stratification, with the densities.

use std::f32::consts::{FRAC_PI_4, PI, TAU};

use glam::{Vec2, Vec3};

/// Uniform on the unit disk, by the concentric map [Shirley & Chiu 1997]. Density 1/π per area.
pub fn disk(u: Vec2) -> Vec2 {
    let p = 2.0 * u - Vec2::ONE;
    let along_x = p.x.abs() > p.y.abs();
    let (radius, across) = if along_x { (p.x, p.y) } else { (p.y, p.x) };
    if radius == 0.0 {
        return Vec2::ZERO;
    }
    let (sin, cos) = sin_cos_of_eighth(FRAC_PI_4 * (across / radius));
    radius * if along_x { Vec2::new(cos, sin) } else { Vec2::new(sin, cos) }
}

/// Sine and cosine of an angle of at most π/4 either way, to within two units in the last place: their Taylor series. The
/// same on all machines, and a quarter of the price of the system's.
fn sin_cos_of_eighth(angle: f32) -> (f32, f32) {
    let x2 = angle * angle;
    let sin = 1.0 + x2 * (-1.0 / 6.0 + x2 * (1.0 / 120.0 + x2 * (-1.0 / 5040.0 + x2 / 362_880.0)));
    let cos = 1.0 + x2 * (-0.5 + x2 * (1.0 / 24.0 + x2 * (-1.0 / 720.0 + x2 / 40_320.0)));
    (angle * sin, cos)
}

/// Cosine-weighted on the hemisphere around +z [Malley's method]; density [`cosine_hemisphere_pdf`].
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let p = disk(u);
    p.extend((1.0 - p.length_squared()).max(1e-12).sqrt())
}

/// Density of [`cosine_hemisphere`] per solid angle, at the cosine `z` (0 below the horizon).
pub fn cosine_hemisphere_pdf(z: f32) -> f32 {
    z.max(0.0) / PI
}

/// Uniform on the unit sphere; density 1/4π per solid angle.
pub fn sphere(u: Vec2) -> Vec3 {
    on_sphere(1.0 - 2.0 * u.x, TAU * u.y)
}

/// The point of the square that [`sphere`] takes to a direction.
pub fn sphere_inverse(direction: Vec3) -> Vec2 {
    let around = direction.y.atan2(direction.x) / TAU;
    Vec2::new(0.5 - 0.5 * direction.z, around - around.floor())
}

/// Uniform in the cone around +z of directions with a cosine of at least `cos_max`; density [`cone_pdf`].
pub fn cone(u: Vec2, cos_max: f32) -> Vec3 {
    cap(u, 1.0 - cos_max)
}

/// Uniform on the cap of the unit sphere around +z of this height, which is 1 minus the cosine at its edge (2 for the whole
/// sphere); exact for small ones, too. Density 1 / (2π height) per solid angle.
pub fn cap(u: Vec2, height: f32) -> Vec3 {
    // From the disk by Lambert's projection, which keeps areas.
    let p = disk(u);
    let below = p.length_squared() * height;
    (p * (height * (2.0 - below).max(0.0)).sqrt()).extend(1.0 - below)
}

/// The point of the square that [`disk`] takes to `p`, which lies in the unit disk.
pub fn disk_inverse(p: Vec2) -> Vec2 {
    let along_x = p.x.abs() > p.y.abs();
    let (along, across) = if along_x { (p.x, p.y) } else { (p.y, p.x) };
    if along == 0.0 {
        return Vec2::splat(0.5);
    }
    let radius = p.length().min(1.0).copysign(along);
    let across = radius * (across / along).atan() / FRAC_PI_4;
    0.5 + 0.5 * if along_x { Vec2::new(radius, across) } else { Vec2::new(across, radius) }
}

/// The point of the square that [`cosine_hemisphere`] takes to a direction; none below the horizon.
pub fn cosine_hemisphere_inverse(direction: Vec3) -> Option<Vec2> {
    (direction.z > 0.0).then(|| disk_inverse(direction.truncate()))
}

/// The point of the square that [`cap`] takes to a direction; none outside the cap.
pub fn cap_inverse(direction: Vec3, height: f32) -> Option<Vec2> {
    // 1 - cos is half the square of the chord, which keeps its digits for small angles.
    let share = 0.5 * (direction - Vec3::Z).length_squared() / height;
    let inside = share <= 1.0;
    inside.then(|| disk_inverse(direction.truncate().normalize_or_zero() * share.sqrt()))
}

/// Density of [`cone`] per solid angle.
pub fn cone_pdf(cos_max: f32) -> f32 {
    1.0 / (TAU * (1.0 - cos_max))
}

/// Uniform on the triangle, as barycentric coordinates of its second and third corner. Density 1/area.
pub fn triangle(u: Vec2) -> Vec2 {
    // [Heitz 2019]: fold the square along its diagonal with low distortion.
    if u.y > u.x {
        let x = 0.5 * u.x;
        Vec2::new(x, u.y - x)
    } else {
        let y = 0.5 * u.y;
        Vec2::new(u.x - y, y)
    }
}

fn on_sphere(z: f32, angle: f32) -> Vec3 {
    let radius = (1.0 - z * z).max(0.0).sqrt();
    (radius * Vec2::from_angle(angle)).extend(z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::Sampler;

    /// The mean of `value` over 40,000 samples and six standard errors of it (false alarm 2e-9).
    fn mean_of(mut value: impl FnMut(Vec2) -> f32) -> (f64, f64) {
        let mut sampler = Sampler::new(7, 0, 0, 0);
        let (mut sum, mut squares, n) = (0.0, 0.0, 40_000);
        for _ in 0..n {
            let x = f64::from(value(sampler.square()));
            sum += x;
            squares += x * x;
        }
        let mean = sum / f64::from(n);
        (mean, 6.0 * ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt())
    }

    #[test]
    fn the_disk_has_mean_squared_radius_one_half() {
        let (mean, error) = mean_of(|u| disk(u).length_squared());
        assert!((mean - 0.5).abs() < error, "{mean} ± {error}");
    }

    #[test]
    fn the_cosine_hemisphere_has_mean_cosine_two_thirds() {
        let (mean, error) = mean_of(|u| cosine_hemisphere(u).z);
        assert!((mean - 2.0 / 3.0).abs() < error, "{mean} ± {error}");
    }

    #[test]
    fn the_cone_has_its_mean_cosine_in_the_middle() {
        let (mean, error) = mean_of(|u| cone(u, 0.6).z);
        assert!((mean - 0.8).abs() < error, "{mean} ± {error}");
    }

    #[test]
    fn inverses_lead_back() {
        let mut sampler = Sampler::new(8, 0, 0, 0);
        for _ in 0..2000 {
            let u = sampler.square();
            let close = |back: Option<Vec2>, to: f32| assert!(back.is_some_and(|back| (back - u).length() < to), "{u}");
            close(Some(disk_inverse(disk(u))), 1e-5);
            // At the horizon the cosine has lost digits, which do not count.
            close(cosine_hemisphere_inverse(cosine_hemisphere(u)), 1e-5);
            // The edge itself may fall out by rounding.
            if (u - 0.5).abs().max_element() < 0.499 {
                for height in [2.0, 1.0, 0.1, 1e-4] {
                    close(cap_inverse(cap(u, height), height), 1e-3);
                }
            }
        }
        assert_eq!(cap_inverse(Vec3::X, 0.5), None);
        assert_eq!(cosine_hemisphere_inverse(-Vec3::Z), None);
    }

    #[test]
    fn the_triangle_has_its_mean_at_one_third() {
        let (mean, error) = mean_of(|u| triangle(u).x);
        assert!((mean - 1.0 / 3.0).abs() < error, "{mean} ± {error}");
    }
}
