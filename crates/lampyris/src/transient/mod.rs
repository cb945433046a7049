//! Light by pixel and time: what a film with time bins has in the end, and what is made of it.
//!
//! Time is *optical path length*, the geometric length of a path times the index of refraction along it, in scene units,
//! counted from the moment at which all lamps flash. Divided by the speed of light it is a time.

mod capture;
mod parts;
mod phasor;
mod pulse;
mod spad;
mod tof;
mod views;

pub use capture::{Capture, Grid};
pub use parts::{LightKind, Met, TimeLayer, TimeLayers};
pub use phasor::Phasors;
pub(crate) use phasor::{phase, phasor_frequencies};
pub use pulse::{Pulse, Table};
pub use spad::{Counting, Spad};
pub use tof::TimeOfFlight;

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::image::Image;

/// The speed of light in vacuum, in metres per second: exact, as the metre is defined by it.
pub const SPEED_OF_LIGHT: f64 = 299_792_458.0;

/// The bins of time, all of one width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Where the first bin begins: optical path length in scene units.
    pub start: f64,
    /// The width of a bin: optical path length in scene units, above 0.
    pub bin_width: f64,
}

impl Axis {
    /// Where bin `bin` begins, and where bin `bin - 1` ends: optical path length in scene units.
    pub fn edge(&self, bin: usize) -> f64 {
        self.start + self.bin_width * bin as f64
    }

    /// The middle of bin `bin`: optical path length in scene units.
    pub fn middle(&self, bin: usize) -> f64 {
        self.start + self.bin_width * (bin as f64 + 0.5)
    }

    /// Where a path of this optical length falls, in bins from the start: 0.0 is the beginning of the first, 1.0 of the
    /// second. Negative before the start.
    pub fn place(&self, optical_length: f64) -> f64 {
        (optical_length - self.start) / self.bin_width
    }
}

/// Which part of a path does not count in its length. Without the way from the scene to the camera, light is seen where it
/// is at a time, and not when it is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Unwarp {
    /// All of the path counts: what a camera would see.
    #[default]
    None,
    /// The way from the camera to the first surface, a mirror or glass as well, does not count (mitransient's
    /// `camera_unwarp`).
    FirstSurface,
    /// The last leg to the camera does not count, from the first surface or from where a medium scattered the light last.
    LastSegment,
}

impl Unwarp {
    /// All of them.
    pub const ALL: [Unwarp; 3] = [Unwarp::None, Unwarp::FirstSurface, Unwarp::LastSegment];

    /// Its name in files: `none`, `first_surface` or `last_segment`.
    pub fn name(self) -> &'static str {
        match self {
            Unwarp::None => "none",
            Unwarp::FirstSurface => "first_surface",
            Unwarp::LastSegment => "last_segment",
        }
    }
}

/// Which index of refraction makes lengths optical.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum IndexMode {
    /// The index n that bends light.
    #[default]
    Phase,
    /// The index n - λ dn/dλ, with which a pulse travels.
    Group,
}

impl IndexMode {
    /// Both of them.
    pub const ALL: [IndexMode; 2] = [IndexMode::Phase, IndexMode::Group];

    /// Its name in files: `phase` or `group`.
    pub fn name(self) -> &'static str {
        match self {
            IndexMode::Phase => "phase",
            IndexMode::Group => "group",
        }
    }
}

/// What is to be known of a transient beside its values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// The bins.
    pub axis: Axis,
    /// What does not count.
    pub unwarp: Unwarp,
    /// Which index counts.
    pub index: IndexMode,
    /// The speed of light in vacuum in scene units per second: [`SPEED_OF_LIGHT`] where the unit is a metre.
    pub light_speed: f64,
}

impl Timing {
    /// Bins of this width from `start` on, both in scene units, in a scene in metres, where all of a path counts with the
    /// phase index.
    pub fn new(start: f64, bin_width: f64) -> Timing {
        let axis = Axis { start, bin_width };
        Timing { axis, unwarp: Unwarp::None, index: IndexMode::Phase, light_speed: SPEED_OF_LIGHT }
    }

    /// Finds what makes no bins.
    ///
    /// # Errors
    /// A start that is not finite; a width or a speed that is not finite and above 0.
    pub fn check(&self) -> Result<()> {
        let Axis { start, bin_width } = self.axis;
        if !start.is_finite() {
            return Err(Error::at_key(
                "start_opl",
                format!("the first bin must begin at a finite length, not {start}"),
            ));
        }
        if !(bin_width.is_finite() && bin_width > 0.0) {
            let message = format!("the width of a bin must be a number above 0, not {bin_width}");
            return Err(Error::at_key("bin_width_opl", message));
        }
        if !(self.light_speed.is_finite() && self.light_speed > 0.0) {
            let message = format!("the speed of light must be a number above 0, not {}", self.light_speed);
            return Err(Error::at_key("c", message));
        }
        Ok(())
    }
}

/// Light by pixel and time: the radiance of each pixel, *integrated over each bin*, so that the bins of a pixel add up to its
/// radiance in the steady picture, less what came before the first and after the last.
///
/// The values stand as `(height, width, bins, 3)`, row-major, the top row first: the times of a pixel stand together.
#[derive(Clone, Debug, PartialEq)]
pub struct Transient {
    width: usize,
    height: usize,
    bins: usize,
    timing: Timing,
    values: Vec<f32>,
    capture: Option<Arc<Capture>>,
}

impl Transient {
    /// Darkness.
    ///
    /// # Errors
    /// As [`Transient::from_values`].
    pub fn new(width: usize, height: usize, bins: usize, timing: Timing) -> Result<Transient> {
        let count = value_count(width, height, bins)?;
        timing.check()?;
        Ok(Transient { width, height, bins, timing, values: vec![0.0; count], capture: None })
    }

    /// These values, `(height, width, bins, 3)`, row-major.
    ///
    /// # Errors
    /// No pixels or bins, another number of values than these sizes make, or a [`Timing`] that makes no bins.
    pub fn from_values(
        (width, height, bins): (usize, usize, usize),
        timing: Timing,
        values: Vec<f32>,
    ) -> Result<Transient> {
        let count = value_count(width, height, bins)?;
        timing.check()?;
        match values.len() == count {
            true => Ok(Transient { width, height, bins, timing, values, capture: None }),
            false => Err(Error::new(format!(
                "{} values do not make {height} × {width} pixels with {bins} bins of 3",
                values.len()
            ))),
        }
    }

    /// The same light, of a wall that was captured so.
    ///
    /// # Errors
    /// As [`Capture::check`].
    pub fn with_capture(self, capture: Capture) -> Result<Transient> {
        capture.check(self.width, self.height)?;
        Ok(Transient { capture: Some(Arc::new(capture)), ..self })
    }

    /// Other values in place of these.
    ///
    /// # Panics
    /// If they are not as many.
    fn with_values(&self, values: Vec<f32>) -> Transient {
        assert_eq!(values.len(), self.values.len(), "as many values as there were");
        Transient { values, capture: self.capture.clone(), ..*self }
    }

    /// How a wall was captured, if it is one.
    pub fn capture(&self) -> Option<&Capture> {
        self.capture.as_deref()
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Bins of a pixel.
    pub fn bins(&self) -> usize {
        self.bins
    }

    /// What the bins mean.
    pub fn timing(&self) -> &Timing {
        &self.timing
    }

    /// The bins.
    pub fn axis(&self) -> &Axis {
        &self.timing.axis
    }

    /// All values, `(height, width, bins, 3)`, row-major.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The light of each bin of the pixel in column `x`, row `y`.
    ///
    /// # Panics
    /// Outside the picture.
    pub fn profile(&self, x: usize, y: usize) -> &[[f32; 3]] {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) lies outside {}×{}", self.width, self.height);
        self.profiles().nth(y * self.width + x).unwrap_or_default()
    }

    /// The light of each bin, pixel by pixel, row by row.
    pub fn profiles(&self) -> impl ExactSizeIterator<Item = &[[f32; 3]]> {
        self.values.chunks_exact(3 * self.bins).map(triples)
    }

    /// The light of each bin, pixel by pixel, row by row, to change.
    pub fn profiles_mut(&mut self) -> impl ExactSizeIterator<Item = &mut [[f32; 3]]> {
        self.values.chunks_exact_mut(3 * self.bins).map(bytemuck::cast_slice_mut)
    }

    /// The picture of what arrives within one bin.
    ///
    /// # Panics
    /// If there is no such bin.
    pub fn frame(&self, bin: usize) -> Image {
        assert!(bin < self.bins, "there is no bin {bin} of {}", self.bins);
        self.picture(|profile| profile[bin])
    }

    /// The same light in wider bins, each the sum of `count` bins; the last of what is left.
    ///
    /// # Errors
    /// A `count` of 0.
    pub fn rebinned(&self, count: usize) -> Result<Transient> {
        if count == 0 {
            return Err(Error::new("a bin must be the sum of at least one"));
        }
        let bins = self.bins.div_ceil(count);
        let axis = Axis { bin_width: self.timing.axis.bin_width * count as f64, ..self.timing.axis };
        let mut values = Vec::with_capacity(self.width * self.height * bins * 3);
        for group in self.profiles().flat_map(|profile| profile.chunks(count)) {
            let sum = |channel: usize| group.iter().map(|value| f64::from(value[channel])).sum::<f64>() as f32;
            values.extend([0, 1, 2].map(sum));
        }
        let size = (self.width, self.height, bins);
        let rebinned = Transient::from_values(size, Timing { axis, ..self.timing }, values)?;
        Ok(Transient { capture: self.capture.clone(), ..rebinned })
    }

    /// The sum over all bins: the steady picture, less what came outside them.
    pub fn steady(&self) -> Image {
        self.picture(|profile| {
            let sum = |channel: usize| profile.iter().map(|value| f64::from(value[channel])).sum::<f64>() as f32;
            [0, 1, 2].map(sum)
        })
    }

    /// A picture of what `look` makes of the bins of each pixel.
    pub fn picture(&self, look: impl Fn(&[[f32; 3]]) -> [f32; 3]) -> Image {
        let mut image = Image::new(self.width, self.height);
        for (pixel, profile) in image.pixels_mut().iter_mut().zip(self.profiles()) {
            *pixel = look(profile);
        }
        image
    }
}

/// Three values a bin.
fn triples(values: &[f32]) -> &[[f32; 3]] {
    bytemuck::cast_slice(values)
}

/// How many values these sizes make.
fn value_count(width: usize, height: usize, bins: usize) -> Result<usize> {
    let count = [height, width, bins, 3].into_iter().try_fold(1, usize::checked_mul);
    match count {
        Some(0) => Err(Error::new(format!("{height} × {width} pixels with {bins} bins hold no light"))),
        Some(count) if count <= isize::MAX as usize / size_of::<f32>() => Ok(count),
        _ => Err(Error::new(format!("{height} × {width} pixels with {bins} bins are too many"))),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Any positive number, most often one near the ends of what there is.
    fn positive() -> impl Strategy<Value = f64> {
        prop_oneof![1e-3f64..1e3, Just(f64::MIN_POSITIVE), Just(5e-324), Just(f64::MAX), Just(1e-300), Just(1e300)]
    }

    proptest! {
        #[test]
        fn light_of_any_numbers_makes_pictures_or_sentences(
            values in proptest::collection::vec(any::<f32>(), 2 * 2 * 5 * 3),
            start in any::<f64>(),
            (bin_width, light_speed, width, tail) in (positive(), positive(), positive(), positive()),
            (from, to) in (any::<f64>(), any::<f64>()),
        ) {
            let timing = Timing { light_speed, ..Timing::new(start, bin_width) };
            if let Ok(transient) = Transient::from_values((2, 2, 5), timing, values) {
                let _ = (transient.steady(), transient.gated(from, to), transient.rainbow(transient.quantile(0.9)));
                let _ = transient.convolved(&Pulse::ModifiedGaussian { sigma: width, tail });
                let _ = transient.convolved(&Pulse::Gaussian { fwhm: width });
                let _ = Table::new(vec![(from, 1.0), (to, 2.0)]).map(|table| transient.convolved(&Pulse::Table(table)));
                let _ = transient.phasor_frequencies(width, tail).and_then(|chosen| transient.phasors(&chosen));
                let _ = TimeOfFlight { wavelength: width, contrast: 1.0 }.depths(&transient);
                let spad = Spad { jitter: width, tail, dark_rate: tail, ..Spad::default() };
                let _ = (spad.count(&transient, 1), spad.estimate(&transient));
                let first = Spad { counting: Counting::FirstPhoton, ..spad };
                let _ = (first.count(&transient, 1), first.estimate(&transient));
            }
        }
    }

    /// 2 × 1 pixels with 3 bins; each value tells its place.
    fn sample() -> Transient {
        let values = (0..18).map(|i| i as f32).collect();
        Transient::from_values((2, 1, 3), Timing::new(4.0, 0.5), values).expect("18 values")
    }

    #[test]
    fn times_of_a_pixel_stand_together() {
        assert_eq!(sample().profile(1, 0), [[9.0, 10.0, 11.0], [12.0, 13.0, 14.0], [15.0, 16.0, 17.0]]);
        assert_eq!(sample().frame(2).pixels(), [[6.0, 7.0, 8.0], [15.0, 16.0, 17.0]]);
    }

    #[test]
    fn bins_add_up_to_the_steady_picture() {
        assert_eq!(sample().steady().pixels(), [[9.0, 12.0, 15.0], [36.0, 39.0, 42.0]]);
    }

    #[test]
    fn bins_are_added_up_to_wider_ones() {
        let wide = sample().rebinned(2).expect("two");
        assert_eq!(*wide.axis(), Axis { start: 4.0, bin_width: 1.0 });
        assert_eq!(wide.profile(0, 0), [[3.0, 5.0, 7.0], [6.0, 7.0, 8.0]]);
        assert_eq!(sample().rebinned(1).expect("one"), sample());
        assert_eq!(sample().rebinned(usize::MAX).expect("all").steady(), sample().steady());
        assert!(sample().rebinned(0).is_err());
    }

    #[test]
    fn the_axis_has_edges_and_middles() {
        let axis = Axis { start: 4.0, bin_width: 0.5 };
        assert_eq!((axis.edge(3), axis.middle(3), axis.place(5.5)), (5.5, 5.75, 3.0));
    }

    #[test]
    fn what_makes_no_bins_is_refused() {
        let timing = Timing::new(0.0, 1.0);
        let refused = |size, timing, count| Transient::from_values(size, timing, vec![0.0; count]).is_err();
        assert!(!refused((2, 1, 3), timing, 18));
        assert!(refused((2, 1, 3), timing, 17) && refused((2, 0, 3), timing, 0) && refused((2, 1, 0), timing, 0));
        assert!(refused((usize::MAX, 2, 2), timing, 12));
        assert!(Transient::new(1 << 31, 1 << 31, 1, timing).is_err());
        for broken in [Timing::new(f64::NAN, 1.0), Timing::new(0.0, 0.0), Timing { light_speed: -1.0, ..timing }] {
            assert!(refused((2, 1, 3), broken, 18), "{broken:?}");
        }
    }
}
