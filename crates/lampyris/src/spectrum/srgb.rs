//! The sRGB transfer function, both ways (IEC 61966-2-1).

/// From encoded 0..1 to linear 0..1.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// From linear 0..1 to encoded 0..1.
pub fn linear_to_srgb(linear: f32) -> f32 {
    // In f64, for 1 to become 1.
    let encode = |linear: f64| (1.055 * linear.powf(1.0 / 2.4) - 0.055) as f32;
    if linear <= 0.003_130_8 { linear * 12.92 } else { encode(linear.into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        assert_eq!((srgb_to_linear(0.0), srgb_to_linear(1.0)), (0.0, 1.0));
        assert_eq!((linear_to_srgb(0.0), linear_to_srgb(1.0)), (0.0, 1.0));
        // Middle grey: 18 % of the light is code value 117.65 of 255.
        assert!((linear_to_srgb(0.18) * 255.0 - 117.65).abs() < 0.01);
    }

    #[test]
    fn each_is_the_inverse_of_the_other() {
        for code in 0..=1000 {
            let encoded = code as f32 / 1000.0;
            assert!((linear_to_srgb(srgb_to_linear(encoded)) - encoded).abs() < 1e-5, "at {encoded}");
        }
    }
}
