//! How bright it is around each pixel [Reinhard 2002, § 3.2].

use crate::image::convolve::{Plane, normalized_kernel};
use crate::image::{Image, luminance};

const SCALES: i32 = 8;
const RATIO: f64 = 1.6;

/// V₁(x, y, s_m): the average luminance over the largest scale s_m up to which centre and surround stay alike, row
/// by row. `image` is scaled to its key.
pub(super) fn surroundings(image: &Image, key: f32, phi: f32, epsilon: f32) -> Vec<f32> {
    let light = image.pixels().iter().map(|&pixel| luminance(pixel)).collect();
    let light = Plane { width: image.width(), values: light };
    let sharpening = f64::from(phi).exp2() as f32 * key;

    let mut centre = average(&light, 1.0);
    let mut chosen = centre.values.clone();
    let mut growing = vec![true; chosen.len()];
    for index in 0..SCALES {
        let scale = RATIO.powi(index);
        // The surround of a scale is the centre of the next.
        let surround = average(&light, scale * RATIO);
        for pixel in 0..chosen.len() {
            let (v1, v2) = (centre.values[pixel], surround.values[pixel]);
            if growing[pixel] {
                chosen[pixel] = v1;
                let contrast = (v1 - v2) / (sharpening / (scale * scale) as f32 + v1); // [eq. 7]
                growing[pixel] = contrast.abs() < epsilon; // [eq. 8]
            }
        }
        centre = surround;
    }
    chosen
}

/// The light under a Gaussian exp(−r² / (α s)²), α = 1/(2√2) [eqs. 5, 6].
fn average(light: &Plane, scale: f64) -> Plane {
    let width = scale / (2.0 * std::f64::consts::SQRT_2);
    // exp(−9) is one ten-thousandth.
    let radius = (3.0 * width).ceil() as usize;
    let kernel = normalized_kernel(radius, |x| (-(x / width).powi(2)).exp());
    light.convolved(&kernel, &kernel)
}
