//! LDR-FLIP, the difference that a viewer sees who flips between two pictures.
//!
//! [Andersson 2020] P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild, "FLIP: A
//! Difference Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020. Section
//! numbers below are of this paper.

use crate::image::convolve::{Plane, normalized_kernel};
use crate::image::{Image, displayable};

/// Pixels per degree of visual angle: a screen 0.7 m wide with 3840 pixels, seen from 0.7 m.
const PIXELS_PER_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * std::f64::consts::PI / 180.0;

/// The error at each pixel, from 0 (none to be seen) to 1, row by row. Both pictures are cut off at 0 and 1, as on
/// a display; they have the same size.
pub(super) fn error_map(image: &Image, reference: &Image) -> Vec<f32> {
    let [image, reference] = [image, reference].map(Seen::new);
    let largest_colour_error = largest_colour_error();
    let colours = image.perceived.iter().zip(&reference.perceived);
    let features = image.features.iter().zip(&reference.features);
    let errors = colours.zip(features).map(|((a, b), (f, g))| {
        let colour = redistributed(hyab(*a, *b).powf(0.7), largest_colour_error);
        // § 4.3: the feature difference raises the colour difference.
        let feature = (f[0] - g[0]).abs().max((f[1] - g[1]).abs()) * std::f32::consts::FRAC_1_SQRT_2;
        colour.powf((1.0 - feature.sqrt()).max(0.0))
    });
    errors.collect()
}

/// A picture as the eye takes it in.
struct Seen {
    /// CIELAB after the blur of the eye, with chroma as strong as lightness lets it appear.
    perceived: Vec<[f32; 3]>,
    /// Strength of the edge and of the point at each pixel.
    features: Vec<[f32; 2]>,
}

impl Seen {
    fn new(image: &Image) -> Seen {
        let opponent = image.map(|pixel| opponent(xyz(pixel.map(displayable))));
        let planes = [0, 1, 2].map(|channel| Plane {
            width: image.width(),
            values: opponent.pixels().iter().map(|pixel| pixel[channel]).collect(),
        });
        let perceived = blurred(&planes).into_iter().map(|pixel| {
            let visible = linear_rgb(xyz_of_opponent(pixel)).map(displayable);
            hunt_adjusted(lab(xyz(visible)))
        });
        Seen { perceived: perceived.collect(), features: features(&planes[0]) }
    }
}

/// § 4.1.1: contrast sensitivity, one or two Gaussians for each opponent channel, a_i √(π/b_i) exp(−π² d²/b_i) at
/// d degrees.
fn blurred(planes: &[Plane; 3]) -> Vec<[f32; 3]> {
    const CONTRAST_SENSITIVITY: [&[(f64, f64)]; 3] =
        [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
    // Three standard deviations of the widest.
    let radius = (3.0 * (0.04f64 / 2.0).sqrt() / std::f64::consts::PI * PIXELS_PER_DEGREE).ceil() as usize;
    let mut pixels = vec![[0.0; 3]; planes[0].values.len()];
    for (channel, (plane, gaussians)) in planes.iter().zip(CONTRAST_SENSITIVITY).enumerate() {
        let bell = |b: f64| move |x: f64| (-(std::f64::consts::PI * x / PIXELS_PER_DEGREE).powi(2) / b).exp();
        // In two dimensions the weight of a Gaussian is the square of its sum in one.
        let weights: Vec<f64> = gaussians
            .iter()
            .map(|&(a, b)| {
                let sum: f64 = (0..=2 * radius).map(|i| bell(b)(i as f64 - radius as f64)).sum();
                a * (std::f64::consts::PI / b).sqrt() * sum * sum
            })
            .collect();
        let total: f64 = weights.iter().sum();
        for (&(_, b), weight) in gaussians.iter().zip(weights) {
            let kernel = normalized_kernel(radius, bell(b));
            for (pixel, value) in pixels.iter_mut().zip(plane.convolved(&kernel, &kernel).values) {
                pixel[channel] += value * (weight / total) as f32;
            }
        }
    }
    pixels
}

/// § 4.2: how strong an edge and a point there are at each pixel, by the first and second derivative of a Gaussian
/// as wide as the lines that the eye makes out.
fn features(luminance: &Plane) -> Vec<[f32; 2]> {
    const WIDTH_IN_DEGREES: f64 = 0.082;
    let deviation = 0.5 * WIDTH_IN_DEGREES * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as usize;
    let bell = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
    let smooth = normalized_kernel(radius, bell);
    let edge = balanced_kernel(radius, |x| -x * bell(x));
    let point = balanced_kernel(radius, |x| (x * x / (deviation * deviation) - 1.0) * bell(x));

    let luminance =
        Plane { width: luminance.width, values: luminance.values.iter().map(|y| (y + 16.0) / 116.0).collect() };
    let strength = |kernel: &[f32]| {
        let (across, down) = (luminance.convolved(kernel, &smooth), luminance.convolved(&smooth, kernel));
        across.values.into_iter().zip(down.values).map(|(a, d)| (a * a + d * d).sqrt()).collect::<Vec<_>>()
    };
    strength(&edge).into_iter().zip(strength(&point)).map(|(e, p)| [e, p]).collect()
}

/// The values of `profile` at −radius..=radius, scaled for the positive to sum to 1 and the negative to −1.
fn balanced_kernel(radius: usize, profile: impl Fn(f64) -> f64) -> Vec<f32> {
    let values: Vec<f64> = (0..=2 * radius).map(|i| profile(i as f64 - radius as f64)).collect();
    let positive: f64 = values.iter().filter(|v| **v > 0.0).sum();
    let negative: f64 = -values.iter().filter(|v| **v < 0.0).sum::<f64>();
    values.iter().map(|v| if *v > 0.0 { v / positive } else { v / negative } as f32).collect()
}

/// § 4.1.4: errors up to 0.4 of the largest take 0..0.95, the rest is squeezed into what remains.
fn redistributed(error: f32, largest: f32) -> f32 {
    const KNEE: f32 = 0.4;
    const AT_KNEE: f32 = 0.95;
    let knee = KNEE * largest;
    if error < knee { error * AT_KNEE / knee } else { AT_KNEE + (error - knee) / (largest - knee) * (1.0 - AT_KNEE) }
}

/// § 4.1.3: the distance between pure green and pure blue, the largest there is, raised as errors are.
fn largest_colour_error() -> f32 {
    let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| hunt_adjusted(lab(xyz(rgb))));
    hyab(green, blue).powf(0.7)
}

/// Abasi, Tehran & Fairchild 2020: city-block distance in lightness, Euclidean in chroma.
fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + ((a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
}

/// § 4.1.3, after Hunt: colours look the more colourful the lighter they are.
fn hunt_adjusted([l, a, b]: [f32; 3]) -> [f32; 3] {
    [l, 0.01 * l * a, 0.01 * l * b]
}

/// Linear sRGB to XYZ, from the chromaticities of IEC 61966-2-1.
const XYZ_OF_RGB: [[f32; 3]; 3] = [
    [0.412_386_56, 0.357_591_5, 0.180_450_49],
    [0.212_636_82, 0.715_183, 0.072_180_2],
    [0.019_330_62, 0.119_197_17, 0.950_372_6],
];

const RGB_OF_XYZ: [[f32; 3]; 3] = [
    [3.241_003_3, -1.537_399, -0.498_615_9],
    [-0.969_224_2, 1.875_93, 0.041_554_226],
    [0.055_639_42, -0.204_011_2, 1.057_149],
];

/// The white of the display: the XYZ of RGB (1, 1, 1).
const WHITE: [f32; 3] = [0.950_428_55, 1.0, 1.088_900_4];

fn product(matrix: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn xyz(rgb: [f32; 3]) -> [f32; 3] {
    product(&XYZ_OF_RGB, rgb)
}

fn linear_rgb(xyz: [f32; 3]) -> [f32; 3] {
    product(&RGB_OF_XYZ, xyz)
}

/// YCxCz, a linear relative of CIELAB: light, red against green, blue against yellow.
fn opponent(xyz: [f32; 3]) -> [f32; 3] {
    let [x, y, z]: [f32; 3] = std::array::from_fn(|i| xyz[i] / WHITE[i]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn xyz_of_opponent([y, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (y + 16.0) / 116.0;
    [(cx / 500.0 + y) * WHITE[0], y * WHITE[1], (y - cz / 200.0) * WHITE[2]]
}

fn lab(xyz: [f32; 3]) -> [f32; 3] {
    const DELTA: f32 = 6.0 / 29.0;
    let curve = |t: f32| if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 };
    let [x, y, z]: [f32; 3] = std::array::from_fn(|i| curve(xyz[i] / WHITE[i]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 40 × 30 pixels of waves, the same as were given to the authors' program.
    fn waves() -> Image {
        let mut image = Image::new(40, 30);
        for (index, pixel) in image.pixels_mut().iter_mut().enumerate() {
            let (x, y) = ((index % 40) as f32, (index / 40) as f32);
            let waves = [(0.3 * x + 0.1 * y).sin(), (0.2 * y + 1.0).sin(), (0.075 * x + 0.25 * y).cos()];
            *pixel = waves.map(|wave| 0.5 + 0.5 * wave);
        }
        image
    }

    fn changed(change: impl Fn(usize, usize, [f32; 3]) -> [f32; 3]) -> Image {
        let mut image = waves();
        let width = image.width();
        for (index, pixel) in image.pixels_mut().iter_mut().enumerate() {
            *pixel = change(index % width, index / width, *pixel);
        }
        image
    }

    fn mean(image: &Image, reference: &Image) -> f32 {
        let errors = error_map(image, reference);
        errors.iter().sum::<f32>() / errors.len() as f32
    }

    fn flat(rgb: [f32; 3]) -> Image {
        Image::new(8, 8).map(|_| rgb)
    }

    /// Means of `flip_evaluator` 1.x, the authors' program, on the same linear pictures.
    #[test]
    fn means_agree_with_the_authors_program() {
        let square =
            changed(|x, y, p| if (15..25).contains(&x) && (10..20).contains(&y) { p.map(|v| v * 0.5) } else { p });
        let dots = changed(|x, y, p| if x % 7 == 0 && y % 5 == 0 { [1.0; 3] } else { p });
        let swapped = changed(|_, _, [r, g, b]| [g, b, r]);
        let brighter = changed(|_, _, p| p.map(|v| v * 1.1));
        for (name, image, expected) in [
            ("square", square, 0.091_694_75),
            ("dots", dots, 0.135_859_19),
            ("swapped", swapped, 0.923_667),
            ("brighter", brighter, 0.198_551_92),
        ] {
            let found = mean(&image, &waves());
            assert!((found - expected).abs() < 2e-5, "{name}: {found} is not {expected}");
        }
    }

    #[test]
    fn flat_pictures_agree_with_the_authors_program() {
        for (a, b, expected) in [
            ([0.0; 3], [1.0; 3], 0.967_388_2),
            ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], 1.0),
            ([0.5; 3], [0.25; 3], 0.451_898_07),
        ] {
            let found = mean(&flat(a), &flat(b));
            assert!((found - expected).abs() < 2e-5, "{a:?} {b:?}: {found} is not {expected}");
        }
    }

    #[test]
    fn equal_pictures_have_no_error_and_order_does_not_matter() {
        assert_eq!(error_map(&waves(), &waves()), vec![0.0; 40 * 30]);
        let other = changed(|x, _, p| if x > 20 { p } else { [0.2; 3] });
        assert_eq!(error_map(&waves(), &other), error_map(&other, &waves()));
    }

    #[test]
    fn matrices_are_inverse() {
        for rgb in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.3, 0.6, 0.9]] {
            let back = linear_rgb(xyz_of_opponent(opponent(xyz(rgb))));
            assert!(back.iter().zip(rgb).all(|(a, b)| (a - b).abs() < 1e-5), "{rgb:?} became {back:?}");
        }
    }
}
