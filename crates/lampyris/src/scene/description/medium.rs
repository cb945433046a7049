//! Media as a file gives them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Color, Transform, one};

/// What fills space.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(tag = "type")]
pub enum MediumDescription {
    /// The same everywhere: give `sigma-t`, or `sigma-s` and `sigma-a`.
    #[serde(rename_all = "kebab-case")]
    Homogeneous {
        /// Extinction coefficient σ_t in 1/(scene unit): one over the mean distance between collisions.
        sigma_t: Option<Color>,
        /// The share of the light that a collision scatters, 0 to 1, beside `sigma-t` (default 0.75).
        albedo: Option<Color>,
        /// Scattering coefficient σ_s in 1/(scene unit).
        sigma_s: Option<Color>,
        /// Absorption coefficient σ_a in 1/(scene unit).
        sigma_a: Option<Color>,
        /// Factor of all coefficients (default 1).
        #[serde(default = "one")]
        scale: f32,
        /// Where scattered light goes; the same in all directions by default.
        #[serde(default)]
        phase: PhaseDescription,
        /// Mean optical path length, in scene units, by which a particle holds back the light that it scatters: by chance, with an
        /// exponential density (default 0).
        #[serde(default)]
        delay: f32,
        /// In place of `delay`, in seconds, with scene units of a metre.
        delay_seconds: Option<f32>,
    },
    /// Of a density that a grid gives: a cloud.
    #[serde(rename_all = "kebab-case")]
    Grid {
        /// The file of the densities, a `.vol` of Mitsuba, relative to the scene's folder.
        file: String,
        /// Extinction coefficient σ_t in 1/(scene unit) where the density is 1 (default 1).
        sigma_t: Option<Color>,
        /// The share of the light that a collision scatters, 0 to 1 (default 0.75).
        albedo: Option<Color>,
        /// The file of a grid of the same place that gives this share, instead.
        albedo_file: Option<String>,
        /// Factor of the extinction coefficient (default 1).
        #[serde(default = "one")]
        scale: f32,
        /// Moves the unit cube, which the grid fills, to the world. Outside of it there is nothing.
        #[serde(default)]
        transform: Transform,
        /// The grid fills the box that its file names, in place of the unit cube (default false).
        #[serde(default)]
        file_bounds: bool,
        /// A density holds in all of its cell; by default it is that of the cell's middle, and linear between.
        #[serde(default)]
        nearest: bool,
        /// Where scattered light goes; the same in all directions by default.
        #[serde(default)]
        phase: PhaseDescription,
        /// Mean optical path length, in scene units, by which a particle holds back the light that it scatters: by chance, with an
        /// exponential density (default 0).
        #[serde(default)]
        delay: f32,
        /// In place of `delay`, in seconds, with scene units of a metre.
        delay_seconds: Option<f32>,
    },
}

/// Where a particle scatters light.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(tag = "type")]
pub enum PhaseDescription {
    /// The same in all directions.
    #[serde(rename_all = "kebab-case")]
    Isotropic {},
    /// By one parameter [Henyey & Greenstein 1941].
    #[serde(rename_all = "kebab-case")]
    HenyeyGreenstein {
        /// The mean cosine, between −1 (backward) and 1 (forward).
        g: f32,
    },
    /// As particles much smaller than the wavelength do.
    #[serde(rename_all = "kebab-case")]
    Rayleigh {},
    /// By a table.
    #[serde(rename_all = "kebab-case")]
    Tabulated {
        /// Values, of any scale, at cosines of the angle of scattering evenly from −1 (backward) to 1 (forward), linear
        /// between them.
        values: Vec<f32>,
    },
    /// One of two.
    #[serde(rename_all = "kebab-case")]
    Blend {
        /// The share of the second, 0 to 1.
        weight: f32,
        /// The phase function at weight 0.
        first: Box<PhaseDescription>,
        /// The phase function at weight 1.
        second: Box<PhaseDescription>,
    },
}

impl Default for PhaseDescription {
    fn default() -> PhaseDescription {
        PhaseDescription::Isotropic {}
    }
}
