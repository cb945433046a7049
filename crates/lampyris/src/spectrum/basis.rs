//! What the four lanes of a pass mean: linear RGB, or four wavelengths (theory §7).

use glam::Vec4;

use super::Spectrum;
use super::curves::PRIMARIES;
use super::eye::{channels, daylight};
use crate::image::luminance;

/// What the lanes of a [`Spectrum`] mean in a pass, and the way from linear RGB and back.
///
/// Both ways are linear. Between them, the lanes of a spectral pass are relative to daylight (D65, the white of sRGB): white
/// light and a white wall are 1 in all four.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Basis {
    /// Red, green, blue, and green.
    #[default]
    Rgb,
    /// Four wavelengths.
    Wavelengths(Wavelengths),
}

/// Four wavelengths with all that depends on them alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelengths {
    /// In nm.
    nanometres: [f32; 4],
    /// The lanes of red, green and blue.
    from_rgb: [Vec4; 3],
    /// What the lanes add to red, green and blue.
    to_rgb: [Vec4; 3],
}

impl Basis {
    /// Four wavelengths, one from each quarter of the visible light, all at the same place `u`, in 0..1, of their quarters.
    ///
    /// Wavelengths are hero wavelengths [Wilkie et al. 2014] but for two things. They are not drawn uniformly but in
    /// proportion to what they mean to the picture, the length of their colour in linear RGB under daylight, and the
    /// rotation by quarters is one of the cumulative density. And no lane is the hero by its place: a boundary that
    /// separates them draws the lane that it follows.
    pub fn wavelengths_at(u: f64) -> Basis {
        let eye = Eye::new();
        let drawn = [0, 1, 2, 3].map(|quarter| eye.quantile((f64::from(quarter) + u) / 4.0));
        let rows = |value: &dyn Fn(f64, f64) -> [f64; 3]| {
            let lanes = drawn.map(|(wavelength, density)| value(wavelength, density));
            [0, 1, 2].map(|row| Vec4::from_array(lanes.map(|lane| lane[row] as f32)))
        };
        Basis::Wavelengths(Wavelengths {
            nanometres: drawn.map(|(wavelength, _)| wavelength as f32),
            from_rgb: rows(&|wavelength, _| primaries(wavelength)),
            to_rgb: rows(&|wavelength, density| eye.seen(wavelength).map(|channel| channel / (4.0 * density))),
        })
    }

    /// The wavelengths of the lanes in nm; none in an RGB pass.
    pub fn nanometres(&self) -> Option<[f32; 4]> {
        match self {
            Basis::Rgb => None,
            Basis::Wavelengths(wavelengths) => Some(wavelengths.nanometres),
        }
    }

    /// The lanes of a light or a reflectance in linear RGB, by the curves of its primaries [Mallett & Yuksel 2019].
    #[inline]
    pub fn lanes(&self, rgb: Spectrum) -> Spectrum {
        match self {
            Basis::Rgb => rgb,
            Basis::Wavelengths(wavelengths) => wavelengths.lanes(rgb),
        }
    }

    /// Luminance of white in this pass: 1, or 1 in the mean over all passes.
    pub fn white(&self) -> f32 {
        match self {
            Basis::Rgb => 1.0,
            Basis::Wavelengths(_) => luminance(self.to_rgb(Spectrum::ONE)),
        }
    }

    /// Linear RGB of what the lanes hold: in a spectral pass an estimate that is right in the mean over all passes.
    #[inline]
    pub fn to_rgb(&self, lanes: Spectrum) -> [f32; 3] {
        match self {
            Basis::Rgb => lanes.to_rgb(),
            Basis::Wavelengths(wavelengths) => wavelengths.to_rgb.map(|row| row.dot(lanes.0)),
        }
    }
}

impl Wavelengths {
    /// By itself, so that RGB passes do not carry its code through everything that has a colour.
    #[inline(never)]
    fn lanes(&self, rgb: Spectrum) -> Spectrum {
        let ([red, green, blue], [r, g, b]) = (self.from_rgb, rgb.to_rgb());
        Spectrum(red * r + green * g + blue * b)
    }
}

/// The first wavelength of the tables and the distance between their entries, in nm.
const FIRST: f64 = 380.0;
const STEP: f64 = 5.0;
const CELLS: usize = PRIMARIES.len() - 1;

/// The reflectances of red, green and blue at a wavelength in nm.
fn primaries(wavelength: f64) -> [f64; 3] {
    let place = ((wavelength - FIRST) / STEP).clamp(0.0, CELLS as f64);
    let cell = (place as usize).min(CELLS - 1);
    let t = place - cell as f64;
    [0, 1, 2].map(|index| PRIMARIES[cell][index] * (1.0 - t) + PRIMARIES[cell + 1][index] * t)
}

/// The nodes of Simpson's rule in every cell, (wavelength in nm, weight): exact for what is linear in the tables, and for
/// products of three such.
fn nodes() -> impl Iterator<Item = (f64, f64)> {
    let of_cell = |cell: usize| {
        [(0.0, 1.0), (0.5, 4.0), (1.0, 1.0)]
            .map(|(place, weight)| (FIRST + STEP * (cell as f64 + place), weight * STEP / 6.0))
    };
    (0..CELLS).flat_map(of_cell)
}

/// What daylight means to the picture, by its wavelength.
struct Eye {
    /// Linear RGB of all daylight together, in the units of the tables.
    white: [f64; 3],
    /// The share of the wavelengths below each nm from the first on.
    cumulative: Vec<f64>,
}

impl Eye {
    fn new() -> Eye {
        let mut eye = Eye { white: [0.0; 3], cumulative: vec![0.0] };
        for (wavelength, weight) in nodes() {
            let light = channels(wavelength).map(|channel| channel * daylight(wavelength) * weight);
            eye.white = [0, 1, 2].map(|index| eye.white[index] + light[index]);
        }
        let mut sum = 0.0;
        for cell in 0..CELLS * STEP as usize {
            let [r, g, b] = eye.seen(FIRST + cell as f64 + 0.5);
            sum += (r * r + g * g + b * b).sqrt();
            eye.cumulative.push(sum);
        }
        eye.cumulative.iter_mut().for_each(|share| *share /= sum);
        eye
    }

    /// Linear RGB of the daylight of one wavelength in nm, per nm, where all daylight is (1, 1, 1).
    fn seen(&self, wavelength: f64) -> [f64; 3] {
        let (channels, power) = (channels(wavelength), daylight(wavelength));
        [0, 1, 2].map(|index| channels[index] * power / self.white[index])
    }

    /// The wavelength in nm below which this share lies, and the density per nm there.
    fn quantile(&self, share: f64) -> (f64, f64) {
        let last = self.cumulative.len() - 2;
        let cell = self.cumulative.partition_point(|&below| below <= share).saturating_sub(1).min(last);
        let density = self.cumulative[cell + 1] - self.cumulative[cell];
        let t = ((share - self.cumulative[cell]) / density).clamp(0.0, 1.0);
        (FIRST + cell as f64 + t, density)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean over so many passes, evenly spaced, of linear RGB to lanes and back.
    fn round_trip(rgb: [f32; 3], passes: u32) -> [f64; 3] {
        let mut mean = [0.0; 3];
        for pass in 0..passes {
            let basis = Basis::wavelengths_at((f64::from(pass) + 0.5) / f64::from(passes));
            let seen = basis.to_rgb(basis.lanes(Spectrum::from_rgb(rgb)));
            mean = [0, 1, 2].map(|index| mean[index] + f64::from(seen[index]) / f64::from(passes));
        }
        mean
    }

    #[test]
    fn the_curves_of_the_primaries_are_shares_of_one() {
        for row in PRIMARIES {
            assert!(row.iter().all(|share| (0.0..=1.0).contains(share)), "{row:?}");
            assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-6, "{row:?}");
        }
    }

    #[test]
    fn the_observer_sees_the_primaries_under_daylight() {
        let eye = Eye::new();
        let mut seen = [[0.0; 3]; 3];
        for (wavelength, weight) in nodes() {
            let (light, shares) = (eye.seen(wavelength), primaries(wavelength));
            for (row, share) in seen.iter_mut().zip(shares) {
                *row = [0, 1, 2].map(|index| row[index] + light[index] * share * weight);
            }
        }
        for (row, exact) in seen.into_iter().zip([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) {
            assert!((0..3).all(|index| (row[index] - exact[index]).abs() < 1e-6), "{row:?}");
        }
    }

    #[test]
    fn any_colour_comes_back_in_the_mean_over_passes_and_sooner_the_more_there_are() {
        for rgb in
            [[1.0, 1.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.3, 0.02, 0.7], [0.2, -0.1, 5.0]]
        {
            let off = |passes| {
                let mean = round_trip(rgb, passes);
                (0..3).map(|index| (mean[index] - f64::from(rgb[index])).abs()).fold(0.0, f64::max)
            };
            assert!(
                off(4) < 0.2 && off(16) < 0.03 && off(1000) < 2e-3,
                "{rgb:?}: {} {} {}",
                off(4),
                off(16),
                off(1000)
            );
        }
    }

    #[test]
    fn white_and_grey_are_the_same_in_all_lanes() {
        for pass in 0..50 {
            let basis = Basis::wavelengths_at(f64::from(pass) / 50.0);
            assert!(basis.lanes(Spectrum::grey(0.25)).lanes().iter().all(|lane| (lane - 0.25).abs() < 1e-6));
        }
    }

    #[test]
    fn each_quarter_has_its_wavelength_and_the_middle_of_the_spectrum_more_than_its_ends() {
        let Some(wavelengths) = Basis::wavelengths_at(0.5).nanometres() else { panic!("four wavelengths") };
        assert!(wavelengths.is_sorted() && wavelengths[0] > 400.0 && wavelengths[3] < 700.0, "{wavelengths:?}");
    }

    #[test]
    fn an_rgb_pass_changes_nothing() {
        let color = Spectrum::from_rgb([0.1, 0.2, 0.3]);
        assert_eq!(Basis::Rgb.lanes(color), color);
        assert_eq!(Basis::Rgb.to_rgb(color), [0.1, 0.2, 0.3]);
    }
}
