//! How a smooth boundary divides light (theory §3.2).

use glam::Vec3;

/// What a smooth dielectric boundary does to unpolarised light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Share that is reflected, 0 to 1; the rest is refracted.
    pub reflectance: f32,
    /// Cosine of the refracted direction, positive; 0 under total internal reflection.
    pub cos_refracted: f32,
    /// Index on the far side over the index on the near side.
    pub ior_ratio: f32,
}

/// The Fresnel equations for light that meets the boundary under the cosine `cos` to the normal, where `ior` is the
/// index on the normal's far side (below) over that on its near side (above); negative cosines come from below.
pub fn dielectric(cos: f32, ior: f32) -> Boundary {
    let ior_ratio = if cos >= 0.0 { ior } else { 1.0 / ior };
    let cos = cos.abs().min(1.0);
    let sin2_refracted = (1.0 - cos * cos) / (ior_ratio * ior_ratio);
    if sin2_refracted >= 1.0 {
        return Boundary { reflectance: 1.0, cos_refracted: 0.0, ior_ratio };
    }
    let cos_refracted = (1.0 - sin2_refracted).sqrt();
    let parallel = (ior_ratio * cos - cos_refracted) / (ior_ratio * cos + cos_refracted);
    let perpendicular = (cos - ior_ratio * cos_refracted) / (cos + ior_ratio * cos_refracted);
    Boundary { reflectance: 0.5 * (parallel * parallel + perpendicular * perpendicular), cos_refracted, ior_ratio }
}

/// Share of unpolarised light that a metal of complex index `eta + i k` (relative to the outside) reflects under
/// the cosine `cos` [Born & Wolf 1999, §14.2].
pub fn conductor(cos: f32, eta: f32, k: f32) -> f32 {
    let cos2 = (cos * cos).min(1.0);
    let sin2 = 1.0 - cos2;
    let (eta2, k2) = (eta * eta, k * k);
    let t0 = eta2 - k2 - sin2;
    let a2_plus_b2 = (t0 * t0 + 4.0 * eta2 * k2).sqrt();
    let a = (0.5 * (a2_plus_b2 + t0)).max(0.0).sqrt();
    let perpendicular = {
        let (sum, product) = (a2_plus_b2 + cos2, 2.0 * cos.abs() * a);
        (sum - product) / (sum + product)
    };
    let parallel = {
        let (sum, product) = (cos2 * a2_plus_b2 + sin2 * sin2, 2.0 * cos.abs() * a * sin2);
        perpendicular * (sum - product) / (sum + product).max(f32::MIN_POSITIVE)
    };
    0.5 * (parallel + perpendicular)
}

/// Share of diffuse light (cosine-weighted over the hemisphere) that a boundary reflects, coming from the side whose
/// index is 1 towards the side of index `ior`. Exact: Gauss–Legendre quadrature of the Fresnel equations.
pub fn diffuse_reflectance(ior: f32) -> f32 {
    // ∫ F(cos) 2 cos d(cos), in t with cos = t², which tames the square root at the critical angle. Panels end there.
    let critical = if ior < 1.0 { (1.0 - ior * ior).sqrt() } else { 0.0 };
    let mut sum = f64::from(critical * critical);
    let panels = 64;
    for panel in 0..panels {
        // cos = critical + (1 - critical) s², so that the square-root behaviour at the critical angle is smooth in s.
        for (node, weight) in [(-0.774_596_7, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_7, 5.0 / 9.0)] {
            let s = (f64::from(panel) + 0.5 + 0.5 * node) / f64::from(panels);
            let width = 1.0 - f64::from(critical);
            let cos = f64::from(critical) + width * s * s;
            let reflectance = f64::from(dielectric(cos as f32, ior).reflectance);
            sum += reflectance * 2.0 * cos * width * 2.0 * s * weight * 0.5 / f64::from(panels);
        }
    }
    sum as f32
}

/// `to_previous` mirrored at the normal +z.
pub fn reflect(to_previous: Vec3) -> Vec3 {
    Vec3::new(-to_previous.x, -to_previous.y, to_previous.z)
}

/// The direction into which `to_previous` is refracted through the plane z = 0.
pub fn refract(to_previous: Vec3, boundary: &Boundary) -> Vec3 {
    let scale = -1.0 / boundary.ior_ratio;
    let z = boundary.cos_refracted * -to_previous.z.signum();
    Vec3::new(scale * to_previous.x, scale * to_previous.y, z).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_at_normal_incidence_reflects_four_percent() {
        let boundary = dielectric(1.0, 1.5);
        assert!((boundary.reflectance - 0.04).abs() < 1e-6);
        assert!((dielectric(-1.0, 1.5).reflectance - 0.04).abs() < 1e-6);
    }

    #[test]
    fn nothing_parallel_is_reflected_at_brewsters_angle() {
        let angle = 1.5_f32.atan();
        let perpendicular = ((1.0 - 1.5 * 1.5) / (1.0 + 1.5 * 1.5) as f32).powi(2);
        assert!((dielectric(angle.cos(), 1.5).reflectance - 0.5 * perpendicular).abs() < 1e-5);
    }

    #[test]
    fn beyond_the_critical_angle_everything_is_reflected() {
        let critical = (1.0_f32 / 1.5).asin();
        assert_eq!(dielectric(-(critical + 0.01).cos(), 1.5).reflectance, 1.0);
        assert!(dielectric(-(critical - 0.01).cos(), 1.5).reflectance < 1.0);
    }

    #[test]
    fn refraction_obeys_snell() {
        let to_previous = Vec3::new(0.6, 0.0, 0.8);
        let to_next = refract(to_previous, &dielectric(0.8, 1.5));
        assert!((to_next - Vec3::new(-0.4, 0.0, -(1.0_f32 - 0.16).sqrt())).length() < 1e-6);
    }

    #[test]
    fn a_metal_without_absorption_is_a_dielectric() {
        for cos in [1.0, 0.7, 0.3, 0.05] {
            assert!((conductor(cos, 1.5, 0.0) - dielectric(cos, 1.5).reflectance).abs() < 1e-5);
        }
    }

    #[test]
    fn the_diffuse_reflectance_of_glass_is_the_literatures() {
        // [Egan & Hilgeman 1973]: 0.0918 from outside and 0.5963 from inside at 1.5; they hang together by
        // (1 - inside) = (1 - outside) / n².
        let (outside, inside) = (diffuse_reflectance(1.5), diffuse_reflectance(1.0 / 1.5));
        assert!((outside - 0.0918).abs() < 2e-4, "{outside}");
        assert!((inside - 0.5963).abs() < 2e-4, "{inside}");
        assert!(((1.0 - inside) * 1.5 * 1.5 - (1.0 - outside)).abs() < 1e-4);
    }
}
