//! The picture and the budget as a file gives them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::one;

/// The size of the picture and how samples become pixels.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct FilmDescription {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The reconstruction filter.
    pub filter: FilterDescription,
}

impl Default for FilmDescription {
    fn default() -> FilmDescription {
        FilmDescription { size: [512, 512], filter: FilterDescription::default() }
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
