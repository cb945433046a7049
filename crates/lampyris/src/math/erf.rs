//! The error function and its inverse, in single precision.

/// The integral of 2/√π exp(-t²) from 0 to `x` [Abramowitz & Stegun 1964, 7.1.26]; absolute error below 5e-7.
pub fn erf(x: f32) -> f32 {
    let t = 1.0 / (1.0 + 0.327_591_1 * x.abs());
    let polynomial = t * (0.254_829_6 + t * (-0.284_496_74 + t * (1.421_413_7 + t * (-1.453_152 + t * 1.061_405_4))));
    (1.0 - polynomial * (-x * x).exp()).copysign(x)
}

/// The number whose [`erf`] is `y`, for `y` between -1 and 1 [Giles 2012].
pub fn erf_inverse(y: f32) -> f32 {
    let y = y.clamp(-0.999_999_9, 0.999_999_9);
    let w = -((1.0 - y) * (1.0 + y)).ln();
    let polynomial = |coefficients: [f32; 9], w: f32| coefficients.iter().fold(0.0, |sum, c| sum * w + c);
    const MIDDLE: [f32; 9] = [
        2.810_226_4e-8,
        3.432_739_4e-7,
        -3.523_388e-6,
        -4.391_506_5e-6,
        0.000_218_580_87,
        -0.001_253_725,
        -0.004_177_681_6,
        0.246_640_73,
        1.501_409_4,
    ];
    const TAILS: [f32; 9] = [
        -0.000_200_214_26,
        0.000_100_950_56,
        0.001_349_343_2,
        -0.003_673_428_4,
        0.005_739_507_7,
        -0.007_622_461_3,
        0.009_438_870_5,
        1.001_674,
        2.832_976_8,
    ];
    y * if w < 5.0 { polynomial(MIDDLE, w - 2.5) } else { polynomial(TAILS, w.sqrt() - 3.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        for (x, value) in [(0.0, 0.0), (0.5, 0.520_499_9), (1.0, 0.842_700_8), (-2.0, -0.995_322_3)] {
            assert!((erf(x) - value).abs() < 5e-7, "erf({x}) = {}", erf(x));
        }
    }

    #[test]
    fn the_inverse_undoes_it() {
        for step in -250..=250 {
            let x = step as f32 / 100.0;
            assert!((erf(erf_inverse(erf(x))) - erf(x)).abs() < 1e-6, "at {x}");
        }
    }
}
