//! Pictures of light by time: gates, streaks, peaks and rainbows.

use super::Transient;
use crate::error::{Error, Result};
use crate::image::{Image, luminance};

impl Transient {
    /// What a camera sees whose shutter is open from `from` to `to`, optical path lengths in scene units: the light between
    /// them. Of a bin that is cut, the share that lies within.
    pub fn gated(&self, from: f64, to: f64) -> Image {
        let bins = self.bins() as f64;
        let [from, to] = [from, to].map(|length| self.axis().place(length).clamp(0.0, bins));
        let first = from as usize;
        let shares: Vec<f64> = (first..(to.ceil() as usize).max(first))
            .map(|bin| (to.min(bin as f64 + 1.0) - from.max(bin as f64)).max(0.0))
            .collect();
        self.picture(|profile| {
            let open = || profile.iter().skip(first).zip(&shares);
            [0, 1, 2].map(|channel| open().map(|(value, share)| f64::from(value[channel]) * share).sum::<f64>() as f32)
        })
    }

    /// The streak picture of row `y`: a column for each pixel of it, a row for each bin, the first bin on top.
    ///
    /// # Errors
    /// If there is no such row.
    pub fn streak_of_row(&self, y: usize) -> Result<Image> {
        if y >= self.height() {
            return Err(Error::new(format!("there is no row {y}: the picture has {} of them", self.height()))
                .with_hint("rows count from 0 at the top"));
        }
        let mut image = Image::new(self.width(), self.bins());
        for x in 0..self.width() {
            for (bin, &value) in self.profile(x, y).iter().enumerate() {
                image.pixels_mut()[bin * self.width() + x] = value;
            }
        }
        Ok(image)
    }

    /// The streak picture of column `x`: a row for each pixel of it, a column for each bin, the first bin on the left.
    ///
    /// # Errors
    /// If there is no such column.
    pub fn streak_of_column(&self, x: usize) -> Result<Image> {
        if x >= self.width() {
            return Err(Error::new(format!("there is no column {x}: the picture has {} of them", self.width()))
                .with_hint("columns count from 0 at the left"));
        }
        let pixels = (0..self.height()).flat_map(|y| self.profile(x, y).iter().copied()).collect();
        Image::from_pixels(self.bins(), self.height(), pixels).ok_or_else(|| Error::new("a streak of no pixels"))
    }

    /// The path length at which most light arrives at each pixel, the middle of that bin, in scene units; in all three
    /// channels. A pixel that is dark at all times has infinity.
    pub fn peak_lengths(&self) -> Image {
        self.picture(|profile| [peak(profile).map_or(f32::INFINITY, |(bin, _)| self.axis().middle(bin) as f32); 3])
    }

    /// A picture that shows when light arrives: the hue of each pixel tells when most of it does, from red for the earliest
    /// peak of the picture by yellow, green and blue to violet for the latest; how bright it is tells how strong the peak is,
    /// beside `white`. In linear display light. With it the path lengths of the two ends; none where all is dark.
    pub fn rainbow(&self, white: f32) -> (Image, Option<[f64; 2]>) {
        let ends = self.profiles().filter_map(peak).map(|(bin, _)| bin).fold(None, |ends, bin| {
            let [first, last] = ends.unwrap_or([bin, bin]);
            Some([bin.min(first), bin.max(last)])
        });
        let [first, last] = ends.unwrap_or_default();
        let image = self.picture(|profile| {
            let Some((bin, strength)) = peak(profile) else { return [0.0; 3] };
            let share = (bin - first) as f32 / (last - first).max(1) as f32;
            let brightness = if white > 0.0 { (strength / white).min(1.0) } else { 0.0 };
            rainbow_color(share).map(|value| value * brightness)
        });
        (image, ends.map(|ends| ends.map(|bin| self.axis().middle(bin))))
    }

    /// The luminance below which the share `quantile` of all lit values lies, of all pixels at all times; 0 where all is
    /// dark. Of large films, as many values as are enough, evenly chosen.
    pub fn quantile(&self, quantile: f64) -> f32 {
        const ENOUGH: usize = 1 << 22;
        let values = self.width() * self.height() * self.bins();
        // An odd step, so that it does not fall on the same bins of every pixel.
        let step = (values / ENOUGH).max(1) | 1;
        let lit = |value: &f32| *value > 0.0 && value.is_finite();
        let all = self.profiles().flatten().step_by(step).map(|&value| luminance(value));
        let mut values: Vec<f32> = all.filter(lit).collect();
        if values.is_empty() {
            return 0.0;
        }
        let at = ((values.len() - 1) as f64 * quantile.clamp(0.0, 1.0)).round() as usize;
        *values.select_nth_unstable_by(at, f32::total_cmp).1
    }
}

/// The bin with the largest luminance, the first of equals, and that luminance; none where there is no light.
pub(super) fn peak(profile: &[[f32; 3]]) -> Option<(usize, f32)> {
    let lit = profile.iter().map(|&value| luminance(value)).enumerate().filter(|(_, value)| *value > 0.0);
    lit.fold(None, |best: Option<(usize, f32)>, (bin, value)| match best {
        Some((_, strength)) if strength >= value => best,
        _ => Some((bin, value)),
    })
}

/// Hues at full saturation from red (0) by yellow, green and blue to violet (1), linear.
fn rainbow_color(share: f32) -> [f32; 3] {
    // Three quarters of the circle of hues, each a sixth of it wide.
    let hue = share.clamp(0.0, 1.0) * 4.5;
    let channel = |center: f32| {
        let distance = (hue - center).abs();
        let distance = distance.min(6.0 - distance);
        (2.0 - distance).clamp(0.0, 1.0)
    };
    [channel(0.0), channel(2.0), channel(4.0)]
}

#[cfg(test)]
mod tests {
    use super::super::Timing;
    use super::*;

    /// 2 × 1 pixels: light in the bins 0, 1, 2 of the one, and in the bin 2 of the other.
    fn sample() -> Transient {
        let values = vec![1.0, 1.0, 1.0, 4.0, 4.0, 4.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0, 8.0, 8.0];
        Transient::from_values((2, 1, 3), Timing::new(10.0, 2.0), values).expect("18 values")
    }

    #[test]
    fn a_gate_takes_bins_and_shares_of_bins() {
        let gate = |from, to| sample().gated(from, to).pixels().iter().map(|pixel| pixel[0]).collect::<Vec<_>>();
        assert_eq!(gate(12.0, 14.0), [4.0, 0.0]);
        assert_eq!(gate(11.0, 14.5), [0.5 + 4.0 + 0.5, 2.0]);
        assert_eq!(gate(12.5, 13.0), [1.0, 0.0]);
        assert_eq!(gate(-1e9, 1e9), [7.0, 8.0]);
        assert_eq!([gate(14.0, 12.0), gate(16.0, 99.0), gate(1.0, 9.0)], [[0.0, 0.0]; 3]);
    }

    #[test]
    fn gates_that_meet_add_up() {
        let whole = sample().gated(10.3, 15.9);
        let parts = [sample().gated(10.3, 13.7), sample().gated(13.7, 15.9)];
        for ((a, b), sum) in parts[0].pixels().iter().zip(parts[1].pixels()).zip(whole.pixels()) {
            assert!((a[0] + b[0] - sum[0]).abs() < 1e-6);
        }
    }

    #[test]
    fn streaks_have_time_downwards_or_to_the_right() {
        let row = sample().streak_of_row(0).expect("a row");
        assert_eq!((row.width(), row.height()), (2, 3));
        assert_eq!((row.pixel(0, 1), row.pixel(1, 2)), ([4.0; 3], [8.0; 3]));
        let column = sample().streak_of_column(1).expect("a column");
        assert_eq!((column.width(), column.height(), column.pixel(2, 0)), (3, 1, [8.0; 3]));
        assert!(sample().streak_of_row(1).is_err() && sample().streak_of_column(2).is_err());
    }

    #[test]
    fn a_peak_lies_in_the_middle_of_its_bin() {
        assert_eq!(sample().peak_lengths().pixels(), [[13.0; 3], [15.0; 3]]);
        let dark = Transient::new(1, 1, 2, Timing::new(0.0, 1.0)).expect("a pixel");
        assert_eq!(dark.peak_lengths().pixels(), [[f32::INFINITY; 3]]);
        assert_eq!(dark.rainbow(1.0), (Image::new(1, 1), None));
    }

    #[test]
    fn a_rainbow_goes_from_red_to_violet_and_is_as_bright_as_the_peak() {
        let (image, ends) = sample().rainbow(8.0);
        assert_eq!(ends, Some([13.0, 15.0]));
        assert_eq!(image.pixels(), [[0.5, 0.0, 0.0], [0.5, 0.0, 1.0]]);
        assert_eq!([1.0 / 4.5, 2.0 / 4.5].map(rainbow_color), [[1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    }

    #[test]
    fn quantiles_leave_out_the_dark() {
        let grey = [1.0, 2.0, 4.0, 8.0].map(|value| luminance([value; 3]));
        assert_eq!([0.0, 0.34, 0.66, 1.0].map(|share| sample().quantile(share)), grey);
    }
}
