//! The picture and the budget as a file gives them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::one;
use crate::error::{Error, Result};
use crate::transient::{IndexMode, LightKind, SPEED_OF_LIGHT, TimeLayers, Unwarp, phasor_frequencies};

/// The size of the picture and how samples become pixels.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct FilmDescription {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The reconstruction filter.
    pub filter: FilterDescription,
    /// Bins in time beside the picture: when the light of a pulse that all lamps send at time 0 arrives; none by default.
    pub time: Option<TimeDescription>,
}

impl Default for FilmDescription {
    fn default() -> FilmDescription {
        FilmDescription { size: [512, 512], filter: FilterDescription::default(), time: None }
    }
}

/// The time bins of every pixel. Time is optical path length, Σ index × distance, in scene units.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct TimeDescription {
    /// How many bins (default 256).
    pub bins: u32,
    /// Optical path length of a bin, in scene units; measured by default, so that the bins hold nearly all light.
    pub bin_width: Option<f64>,
    /// Optical path length at which the first bin begins, in scene units; measured by default.
    pub start: Option<f64>,
    /// In place of `bin-width`, in seconds, with scene units of a metre.
    pub bin_width_seconds: Option<f64>,
    /// In place of `start`, in seconds, with scene units of a metre.
    pub start_seconds: Option<f64>,
    /// Which part of the way is left out, for pictures in which light is seen where it is at one time.
    pub unwarp: Unwarp,
    /// Which index of refraction makes lengths optical, where that depends on the wavelength.
    pub index: IndexMode,
    /// Whether the variance of every bin is kept, too, which takes a third more memory.
    pub variance: bool,
    /// Kinds of light that have bins of their own beside those of all light, each of which takes as much memory again.
    pub layers: Vec<LightKind>,
    /// Bins of their own for light by the number of its scattering events: 0, 1 and so on up to this, and all above.
    pub bounces: Option<u32>,
    /// Keeps complex amplitudes in place of bins, for frequencies of the transform of the bins: those of mitransient's
    /// `phasor_hdr_film`. `start`, where phases are 0, is 0 by default then.
    pub phasor: Option<PhasorDescription>,
    /// Keeps complex amplitudes in place of bins, for these frequencies, in cycles per scene unit.
    pub frequencies: Vec<f64>,
}

impl Default for TimeDescription {
    fn default() -> TimeDescription {
        TimeDescription {
            bins: 256,
            bin_width: None,
            start: None,
            bin_width_seconds: None,
            start_seconds: None,
            unwarp: Unwarp::None,
            index: IndexMode::Phase,
            variance: false,
            layers: Vec::new(),
            bounces: None,
            phasor: None,
            frequencies: Vec::new(),
        }
    }
}

/// Which frequencies are kept: all multiples of 1/(bins × bin width) from 1/mean - 1/(2 sigma) to 1/mean + 1/(2 sigma).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct PhasorDescription {
    /// The wavelength in the middle, in scene units.
    pub mean: f64,
    /// The longer this is, the fewer frequencies there are; in scene units.
    pub sigma: f64,
}

impl TimeDescription {
    /// Where the first bin begins, or where phases are 0, as an optical path length in scene units, if it is known.
    pub fn start(&self) -> Option<f64> {
        let given = self.start.or(self.start_seconds.map(|seconds| SPEED_OF_LIGHT * seconds));
        given.or(self.keeps_amplitudes().then_some(0.0))
    }

    /// Whether it asks for complex amplitudes in place of bins.
    pub fn keeps_amplitudes(&self) -> bool {
        self.phasor.is_some() || !self.frequencies.is_empty()
    }

    /// The frequencies for which amplitudes are kept, in cycles per scene unit; none where bins are.
    ///
    /// # Errors
    /// Wavelengths without bins that could tell them.
    pub fn amplitudes(&self) -> Result<Vec<f64>> {
        match self.phasor {
            None => Ok(self.frequencies.clone()),
            Some(PhasorDescription { mean, sigma }) => match self.bin_width() {
                Some(width) => phasor_frequencies(self.bins as usize, width, mean, sigma),
                None => Err(Error::new("'phasor' takes its frequencies from the bins, whose width is not given")
                    .with_hint("give bin-width, or frequencies in place of phasor")),
            },
        }
    }

    /// The parts of the light that have bins of their own.
    pub fn layers(&self) -> TimeLayers {
        TimeLayers::new(&self.layers, self.bounces)
    }

    /// Bytes that the bins, or the amplitudes, of a picture of this size take while it is rendered, for all light and for each
    /// layer: exact sums of three channels, or four with the variance.
    pub fn bytes(&self, [width, height]: [u32; 2]) -> f64 {
        const SUM: f64 = 17.0;
        let sums = if self.variance { 4.0 } else { 3.0 };
        f64::from(width) * f64::from(height) * self.slots() * sums * SUM
    }

    /// What a pixel has room for, for all light and for each layer.
    pub(crate) fn slots(&self) -> f64 {
        let each = match self.amplitudes() {
            Ok(frequencies) if !frequencies.is_empty() => 2.0 * frequencies.len() as f64,
            _ => f64::from(self.bins) + 2.0,
        };
        each * (1.0 + self.layers().count() as f64)
    }

    /// Sets both, as optical path lengths in scene units.
    pub fn fix(&mut self, start: f64, bin_width: f64) {
        (self.start, self.bin_width) = (Some(start), Some(bin_width));
        (self.start_seconds, self.bin_width_seconds) = (None, None);
    }

    /// The width of a bin as an optical path length in scene units, if it is given.
    pub fn bin_width(&self) -> Option<f64> {
        self.bin_width.or(self.bin_width_seconds.map(|seconds| SPEED_OF_LIGHT * seconds))
    }
}

/// A reconstruction filter; sizes in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(tag = "type")]
pub enum FilterDescription {
    /// The mean over a square of this half width (default 0.5: the pixel itself).
    Box {
        /// Half the width of the square.
        #[serde(default = "half")]
        radius: f32,
    },
    /// A tent that falls to zero at this distance (default 1).
    Tent {
        /// Where the tent ends.
        #[serde(default = "one")]
        radius: f32,
    },
    /// A Gaussian of this standard deviation (default 0.5), cut at four of them.
    Gaussian {
        /// Standard deviation.
        #[serde(default = "half")]
        stddev: f32,
    },
}

impl FilterDescription {
    /// The Gaussian is cut at this many standard deviations.
    pub const GAUSSIAN_CUT: f32 = 4.0;

    /// How far from its middle the filter reaches, in pixels; the box and the tent along either axis.
    pub fn radius(&self) -> f32 {
        match *self {
            FilterDescription::Box { radius } | FilterDescription::Tent { radius } => radius,
            FilterDescription::Gaussian { stddev } => FilterDescription::GAUSSIAN_CUT * stddev,
        }
    }
}

impl Default for FilterDescription {
    fn default() -> FilterDescription {
        FilterDescription::Box { radius: 0.5 }
    }
}

fn half() -> f32 {
    0.5
}

/// The budget that the file asks for, and the seed.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct RenderDescription {
    /// Number of passes; a good quick picture by default.
    pub passes: Option<u32>,
    /// Seed of all random numbers; 0 by default.
    pub seed: u64,
    /// Whether light has wavelengths in place of red, green and blue; by default where a material separates them.
    pub spectral: Option<bool>,
}
