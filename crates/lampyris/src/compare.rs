//! How far a picture lies from a reference.

mod flip;

use crate::error::{Error, Result};
use crate::image::Image;

/// The differences between a picture x and a reference r, over pixels and channels.
///
/// Pixels with a value in either picture that is infinite or no number are counted and left out of everything
/// else; where no pixel is left, the measures are not numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Mean of (x − r)² / (r² + 0.01).
    pub rel_mse: f64,
    /// The same without the worst thousandth of the pixels, which a few fireflies would otherwise decide.
    pub rel_mse_trimmed: f64,
    /// Root of the mean of (x − r)², in the unit of the pictures.
    pub rmse: f64,
    /// Mean of x over mean of r: 1 where no light is lost or made. 1 too if both are black.
    pub mean_ratio: f64,
    /// The largest |x − r|.
    pub max_abs: f64,
    /// Mean LDR-FLIP [Andersson 2020], 0 to 1, of both pictures cut off at 1 as in a PNG: what of the difference a
    /// viewer sees who flips between them.
    pub flip: f64,
    /// Pixels of x with a value that is infinite or no number.
    pub non_finite: usize,
    /// Pixels of r with such a value.
    pub non_finite_reference: usize,
}

/// Compares a picture with a reference.
///
/// # Errors
/// If their sizes differ.
pub fn compare(image: &Image, reference: &Image) -> Result<Comparison> {
    check_sizes(image, reference)?;
    let finite = |pixel: &[f32; 3]| pixel.iter().all(|value| value.is_finite());
    let non_finite = |image: &Image| image.pixels().iter().filter(|pixel| !finite(pixel)).count();
    let flip = flip::error_map(image, reference);

    let (mut relative, mut square, mut max_abs, mut flip_sum) = (Vec::new(), 0.0, 0.0f64, 0.0);
    let (mut sum, mut reference_sum) = (0.0, 0.0);
    for ((x, r), flip) in image.pixels().iter().zip(reference.pixels()).zip(flip) {
        if !finite(x) || !finite(r) {
            continue;
        }
        flip_sum += f64::from(flip);
        let mut of_pixel = 0.0;
        for (x, r) in x.iter().zip(r).map(|(x, r)| (f64::from(*x), f64::from(*r))) {
            of_pixel += (x - r).powi(2) / (r * r + 0.01);
            square += (x - r).powi(2);
            max_abs = max_abs.max((x - r).abs());
            sum += x;
            reference_sum += r;
        }
        relative.push(of_pixel / 3.0);
    }

    let pixels = relative.len() as f64;
    Ok(Comparison {
        rel_mse: relative.iter().sum::<f64>() / pixels,
        rel_mse_trimmed: trimmed_mean(&mut relative),
        rmse: (square / (3.0 * pixels)).sqrt(),
        mean_ratio: if sum == reference_sum && pixels > 0.0 { 1.0 } else { sum / reference_sum },
        max_abs: if pixels > 0.0 { max_abs } else { f64::NAN },
        flip: flip_sum / pixels,
        non_finite: non_finite(image),
        non_finite_reference: non_finite(reference),
    })
}

/// The absolute difference of each value.
///
/// # Errors
/// If the sizes differ.
pub fn difference_image(image: &Image, reference: &Image) -> Result<Image> {
    check_sizes(image, reference)?;
    let mut difference = image.clone();
    for (x, r) in difference.pixels_mut().iter_mut().zip(reference.pixels()) {
        *x = std::array::from_fn(|channel| (x[channel] - r[channel]).abs());
    }
    Ok(difference)
}

fn check_sizes(image: &Image, reference: &Image) -> Result<()> {
    let [a, b] = [image, reference].map(|image| (image.width(), image.height()));
    if a == b {
        return Ok(());
    }
    Err(Error::new(format!("pictures of {} × {} and {} × {} pixels cannot be compared", a.0, a.1, b.0, b.1))
        .with_hint("render both in the same size"))
}

/// The mean of all but the largest thousandth, rounded up so that a small picture loses its worst pixel too.
fn trimmed_mean(values: &mut [f64]) -> f64 {
    let kept = values.len() - values.len().div_ceil(1000).min(values.len().saturating_sub(1));
    if kept < values.len() {
        values.select_nth_unstable_by(kept, f64::total_cmp);
    }
    let kept = &mut values[..kept];
    // In one order, whatever the selection did, for one sum.
    kept.sort_unstable_by(f64::total_cmp);
    kept.iter().sum::<f64>() / kept.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(pixels: &[[f32; 3]]) -> Image {
        Image::from_pixels(pixels.len(), 1, pixels.to_vec()).expect("one row")
    }

    fn flat(value: f32) -> Image {
        Image::new(40, 50).map(|_| [value; 3])
    }

    #[test]
    fn a_picture_does_not_differ_from_itself() {
        let found = compare(&flat(0.7), &flat(0.7)).expect("same size");
        assert_eq!((found.rel_mse, found.rmse, found.max_abs, found.flip), (0.0, 0.0, 0.0, 0.0));
        assert_eq!((found.mean_ratio, found.non_finite, found.non_finite_reference), (1.0, 0, 0));
    }

    #[test]
    fn measures_are_what_their_formulas_say() {
        let found = compare(&image(&[[1.0, 0.0, 0.5], [0.0; 3]]), &image(&[[0.5, 0.0, 0.5], [0.0; 3]])).expect("same");
        assert!((found.rel_mse - 0.25 / 0.26 / 6.0).abs() < 1e-12);
        assert!((found.rmse - (0.25f64 / 6.0).sqrt()).abs() < 1e-12);
        assert_eq!((found.mean_ratio, found.max_abs), (1.5, 0.5));
    }

    #[test]
    fn trimming_leaves_out_the_worst_thousandth() {
        let mut fireflies = flat(1.0);
        fireflies.pixels_mut()[7] = [1e6; 3];
        fireflies.pixels_mut()[1900] = [1e5; 3];
        let found = compare(&fireflies, &flat(1.0)).expect("same size");
        assert_eq!(found.rel_mse_trimmed, 0.0);
        assert!(found.rel_mse > 1e8);
        fireflies.pixels_mut()[3] = [1e4; 3];
        assert!(compare(&fireflies, &flat(1.0)).expect("same size").rel_mse_trimmed > 1e4);
    }

    #[test]
    fn broken_pixels_are_counted_and_left_out() {
        let broken = image(&[[f32::NAN, 1.0, 1.0], [2.0; 3], [1.0; 3]]);
        let reference = image(&[[1.0; 3], [2.0; 3], [1.0, f32::INFINITY, 1.0]]);
        let found = compare(&broken, &reference).expect("same size");
        assert_eq!((found.non_finite, found.non_finite_reference), (1, 1));
        assert_eq!((found.rel_mse, found.mean_ratio, found.max_abs), (0.0, 1.0, 0.0));
        assert!(found.flip.is_finite());
    }

    #[test]
    fn other_sizes_are_refused() {
        assert!(compare(&Image::new(2, 3), &Image::new(3, 2)).is_err());
        assert!(difference_image(&Image::new(2, 3), &Image::new(3, 2)).is_err());
    }

    #[test]
    fn the_difference_image_has_no_sign() {
        let difference = difference_image(&image(&[[1.0, 2.0, 3.0]]), &image(&[[3.0, 2.0, 1.0]])).expect("same size");
        assert_eq!(difference.pixels(), [[2.0, 0.0, 2.0]]);
    }
}
