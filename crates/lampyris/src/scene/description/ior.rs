//! Indices of refraction as people write them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An index of refraction: a number for all wavelengths, the name of a substance, or a formula over the wavelength.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Ior {
    /// For all wavelengths.
    Number(f32),
    /// The name of a substance that was measured, such as "bk7", "sf11", "water" or "diamond".
    Substance(String),
    /// By the wavelength.
    Formula(IorFormula),
}

/// An index of refraction by the wavelength λ in µm.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum IorFormula {
    /// B₁, B₂, B₃, C₁, C₂, C₃ (the latter in µm²) of n² = 1 + Σ Bᵢ λ² / (λ² - Cᵢ).
    Sellmeier([f32; 6]),
    /// A and B (µm²) of n = A + B / λ².
    Cauchy([f32; 2]),
    /// The index at Fraunhofer's line d and the Abbe number (n_d - 1) / (n_F - n_C).
    Abbe([f32; 2]),
}

impl Ior {
    pub(super) fn one() -> Ior {
        Ior::Number(1.0)
    }

    pub(super) fn glass() -> Ior {
        Ior::Number(1.5)
    }
}

impl From<f32> for Ior {
    fn from(number: f32) -> Ior {
        Ior::Number(number)
    }
}

impl PartialEq<f32> for Ior {
    fn eq(&self, number: &f32) -> bool {
        matches!(self, Ior::Number(own) if own == number)
    }
}
