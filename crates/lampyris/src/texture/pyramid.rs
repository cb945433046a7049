//! A picture with smaller copies of itself, for looking at it from afar.

use std::sync::Arc;

use half::f16;
use rayon::prelude::*;

use super::{Curve, Raster, Texels};

/// A picture, and if it is to be looked at from afar, pictures of half its size, a quarter, and so on to a single texel
/// [Williams 1983]. Each texel of these is the mean, in linear light, over the rectangle that it covers, whatever the
/// size of the picture, so that all of them have the same mean.
#[derive(Debug)]
pub struct Pyramid {
    levels: Vec<Arc<Raster>>,
    /// The smallest and the largest value of a texel.
    bounds: [f32; 2],
}

impl Pyramid {
    /// With smaller copies if `mip`; values are cut to the smallest and the largest of `bounds`, what is no number to the
    /// smallest.
    pub fn new(picture: Arc<Raster>, mip: bool, bounds: [f32; 2]) -> Pyramid {
        let mut pyramid = Pyramid { levels: vec![picture], bounds };
        while mip && let Some(smaller) = pyramid.half_of_last() {
            pyramid.levels.push(Arc::new(smaller));
        }
        pyramid
    }

    /// Level 0 is the picture itself.
    ///
    /// # Panics
    /// If there is no such level.
    #[inline]
    pub fn picture(&self, level: usize) -> &Raster {
        &self.levels[level]
    }

    /// How many pictures there are.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// The level whose texels are as wide as so many of the picture, and how far from there to the next one.
    #[inline]
    pub(super) fn level(&self, texels_across: f32) -> (usize, f32) {
        if texels_across <= 1.0 || texels_across.is_nan() {
            return (0, 0.0);
        }
        let (level, last) = (texels_across.log2(), self.levels.len() - 1);
        if level >= last as f32 { (last, 0.0) } else { (level as usize, level.fract()) }
    }

    /// What is used of a value.
    #[inline]
    pub(super) fn bounded(&self, value: f32) -> f32 {
        let [least, most] = self.bounds;
        if value > least { value.min(most) } else { least }
    }

    /// None after a single texel.
    fn half_of_last(&self) -> Option<Raster> {
        let from = self.levels.last()?;
        if from.width() == 1 && from.height() == 1 {
            return None;
        }
        let [columns, rows] = [from.width(), from.height()].map(halves);
        let channels = from.channels();
        let colors = channels - usize::from(from.has_opacity());
        let texel = |column: &[(usize, f32)], row: &[(usize, f32)]| {
            let mut sum = [0.0; 4];
            for &(y, height) in row {
                for &(x, width) in column {
                    let (color, opacity) = (from.color(x, y), [from.opacity(x, y)]);
                    let values = color[..colors].iter().chain(&opacity);
                    values.zip(&mut sum).for_each(|(&value, sum)| *sum += self.bounded(value) * width * height);
                }
            }
            sum
        };
        let row_of = |row: &Vec<(usize, f32)>| -> Vec<f32> {
            columns.iter().flat_map(|column| texel(column, row).into_iter().take(channels)).collect()
        };
        let values: Vec<f32> = rows.par_iter().map(row_of).collect::<Vec<_>>().concat();
        // What has 8 bits is not worse for the 11 of a half.
        let texels = match from.is_byte() || values.iter().all(|&value| value <= f16::MAX.to_f32()) && from.is_half() {
            true => Texels::Halves(values.into_iter().map(f16::from_f32).collect()),
            false => Texels::Floats(values),
        };
        Raster::new(columns.len(), rows.len(), channels, texels, Curve::Linear)
    }
}

/// For each texel along a side of half the length, rounded down: which ones of the side it covers, and with which share
/// of itself.
fn halves(length: usize) -> Vec<Vec<(usize, f32)>> {
    let half = (length / 2).max(1);
    // In units of 1/half of a texel of the long side, all ends are whole numbers.
    let covered = |index: usize| {
        let (start, end) = (index * length, (index + 1) * length);
        let share = |texel: usize| {
            let overlap = end.min((texel + 1) * half) - start.max(texel * half);
            (texel, overlap as f32 / length as f32)
        };
        (start / half..end.div_ceil(half)).map(share).collect()
    };
    (0..half).map(covered).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn sides_are_covered_once_and_evenly() {
        for length in 1..40 {
            let mut covered = vec![0.0; length];
            for texel in halves(length) {
                assert!((texel.iter().map(|(_, share)| share).sum::<f32>() - 1.0).abs() < 1e-5);
                texel.iter().for_each(|&(at, share)| covered[at] += share);
            }
            let each = (length / 2).max(1) as f32 / length as f32;
            assert!(covered.iter().all(|share| (share - each).abs() < 1e-5), "{length}: {covered:?}");
        }
    }

    #[test]
    fn light_is_averaged_and_not_code_values() {
        let picture = Raster::new(2, 1, 1, Texels::Bytes(vec![0, 255]), Curve::Srgb).expect("texels");
        let pyramid = Pyramid::new(Arc::new(picture), true, [0.0, 1.0]);
        assert_eq!((pyramid.levels(), pyramid.picture(1).color(0, 0)), (2, [0.5; 3]));
    }

    #[test]
    fn a_picture_that_is_not_looked_at_from_afar_has_no_copies() {
        let picture = Raster::new(2, 2, 1, Texels::Bytes(vec![0; 4]), Curve::Srgb).expect("texels");
        assert_eq!(Pyramid::new(Arc::new(picture), false, [0.0, 1.0]).levels(), 1);
    }

    fn mean(picture: &Raster) -> f64 {
        let sum: f64 = picture.to_image().pixels().iter().flatten().map(|&value| f64::from(value)).sum();
        sum / (3 * picture.width() * picture.height()) as f64
    }

    proptest! {
        #[test]
        fn all_levels_have_the_same_mean(
            (width, values) in (1usize..20, 1usize..20).prop_flat_map(|(width, height)| {
                (Just(width), proptest::collection::vec(0.0f32..9.0, width * height * 3))
            }),
        ) {
            let height = values.len() / 3 / width;
            let picture = Raster::new(width, height, 3, Texels::Floats(values), Curve::Linear).expect("texels");
            let pyramid = Pyramid::new(Arc::new(picture), true, [0.0, f32::MAX]);
            let last = pyramid.picture(pyramid.levels() - 1);
            prop_assert_eq!((last.width(), last.height()), (1, 1));
            for level in 1..pyramid.levels() {
                prop_assert!((mean(pyramid.picture(level)) / mean(pyramid.picture(0)) - 1.0).abs() < 1e-5);
            }
        }
    }
}
