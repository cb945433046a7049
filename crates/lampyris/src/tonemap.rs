//! From radiance to what a display shows.
//!
//! Every operator takes linear radiance to linear display light in 0..1, and nothing more: the curve of the display
//! (sRGB) is the writer's business, so a PNG has it applied once, whichever operator came before. In the course's
//! own pictures the operator's output goes to the screen as it is; there γ = 2.2 does what the PNG writer does here,
//! and [`ToneMap::Equalize`] in a PNG comes close to the course's gamma picture. γ = 1 is the same as equalising.
//!
//! An operator first brings the picture to its own scale (equalising divides by the largest value, Reinhard's by
//! the average), then exposure multiplies by 2^stops, then comes the curve. So a stop is a stop for every operator,
//! also for those that would undo it if it came first.

mod local;

use std::str::FromStr;

use crate::error::{Error, Result, did_you_mean};
use crate::image::{Image, displayable, luminance};

/// A tone-mapping operator. The first five are the course's and treat each channel alone; the others change the
/// luminance, keep the chromaticity, and cut off what leaves 0..1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToneMap {
    /// Cut off at 1.
    Clamp,
    /// Divide by the largest value in the picture.
    Equalize,
    /// Divide by `value`, then cut off at 1.
    EqualizeClamp {
        /// The radiance that becomes white.
        value: f32,
    },
    /// Divide by the largest value, then raise to 1/γ.
    Gamma {
        /// γ; above 1 it lifts the shadows.
        gamma: f32,
    },
    /// Divide by `value`, cut off at 1, then raise to 1/γ.
    GammaClamp {
        /// γ; above 1 it lifts the shadows.
        gamma: f32,
        /// The radiance that becomes white.
        value: f32,
    },
    /// The global operator of [Reinhard 2002, eqs. 1–4]: L (1 + L/white²) / (1 + L), where the logarithmic average
    /// of the luminance is brought to `key`. Black pixels do not count in the average.
    Reinhard {
        /// The display light of the average, before the curve: 0.18 for middle grey.
        key: f32,
        /// The scaled luminance that becomes white; without it no luminance does [eq. 3].
        white: Option<f32>,
    },
    /// The local operator of [Reinhard 2002, eqs. 5–9]: dodging and burning, L / (1 + V), where V is the average
    /// over the largest surroundings without strong contrast.
    ReinhardLocal {
        /// As in [`ToneMap::Reinhard`].
        key: f32,
        /// φ, the sharpening: the larger, the sooner contrast counts.
        phi: f32,
        /// ε, the contrast that ends the surroundings.
        epsilon: f32,
    },
    /// Narkowicz's rational fit of 2016 to the film curve of the Academy Color Encoding System (ACES):
    /// L (2.51 L + 0.03) / (L (2.43 L + 0.59) + 0.14).
    Filmic,
}

impl ToneMap {
    /// Every operator under its name, with the parameters that it has unless told otherwise.
    pub const ALL: [(&str, ToneMap); 8] = [
        ("clamp", ToneMap::Clamp),
        ("equalize", ToneMap::Equalize),
        ("equalize-clamp", ToneMap::EqualizeClamp { value: 1.0 }),
        ("gamma", ToneMap::Gamma { gamma: 2.2 }),
        ("gamma-clamp", ToneMap::GammaClamp { gamma: 2.2, value: 1.0 }),
        ("reinhard", ToneMap::Reinhard { key: 0.18, white: None }),
        ("reinhard-local", ToneMap::ReinhardLocal { key: 0.18, phi: 8.0, epsilon: 0.05 }),
        ("filmic", ToneMap::Filmic),
    ];

    /// Its name.
    pub fn name(&self) -> &'static str {
        match self {
            ToneMap::Clamp => "clamp",
            ToneMap::Equalize => "equalize",
            ToneMap::EqualizeClamp { .. } => "equalize-clamp",
            ToneMap::Gamma { .. } => "gamma",
            ToneMap::GammaClamp { .. } => "gamma-clamp",
            ToneMap::Reinhard { .. } => "reinhard",
            ToneMap::ReinhardLocal { .. } => "reinhard-local",
            ToneMap::Filmic => "filmic",
        }
    }

    /// Finds parameters that make no picture.
    ///
    /// # Errors
    /// If one of them is not a positive number.
    pub fn check(&self) -> Result<()> {
        let parameters: &[(&str, f32)] = match *self {
            ToneMap::Clamp | ToneMap::Equalize | ToneMap::Filmic => &[],
            ToneMap::EqualizeClamp { value } => &[("value", value)],
            ToneMap::Gamma { gamma } => &[("gamma", gamma)],
            ToneMap::GammaClamp { gamma, value } => &[("gamma", gamma), ("value", value)],
            ToneMap::Reinhard { key, white } => &[("key", key), ("white", white.unwrap_or(1.0))],
            ToneMap::ReinhardLocal { key, phi, epsilon } => &[("key", key), ("phi", phi), ("epsilon", epsilon)],
        };
        match parameters.iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            None => Ok(()),
            Some((name, value)) => {
                Err(Error::new(format!("the {name} of {} must be a positive number, not {value}", self.name())))
            }
        }
    }

    /// The picture in linear display light, every value in 0..1.
    ///
    /// `exposure` is in stops: +1 doubles what the curve is given. Infinite values count as the largest finite one,
    /// negative ones and those that are no number as 0.
    #[must_use]
    pub fn apply(&self, image: &Image, exposure: f32) -> Image {
        let largest = image.max();
        let image = image.map(|pixel| pixel.map(|value| value.max(0.0).min(largest)));
        let gain = exposure.exp2();
        let over = |white: f32| move |value: f32| if white > 0.0 { value / white * gain } else { 0.0 };
        let mapped = match *self {
            ToneMap::Clamp => image.map(|pixel| pixel.map(over(1.0))),
            ToneMap::Equalize => image.map(|pixel| pixel.map(over(largest))),
            ToneMap::EqualizeClamp { value } => image.map(|pixel| pixel.map(over(value))),
            ToneMap::Gamma { gamma } => image.map(|pixel| pixel.map(over(largest)).map(|v| v.powf(1.0 / gamma))),
            ToneMap::GammaClamp { gamma, value } => {
                image.map(|pixel| pixel.map(over(value)).map(|v| v.powf(1.0 / gamma)))
            }
            ToneMap::Reinhard { key, white } => {
                let scale = gain * key_scale(&image, key);
                let whiteness = white.map_or(0.0, |white| 1.0 / (white * white));
                by_luminance(&image, scale, |l| (1.0 + l * whiteness) / (1.0 + l))
            }
            ToneMap::ReinhardLocal { key, phi, epsilon } => {
                let scaled = scaled(&image, gain * key_scale(&image, key));
                let surroundings = local::surroundings(&scaled, key, phi, epsilon);
                let mut mapped = scaled;
                for (pixel, v) in mapped.pixels_mut().iter_mut().zip(surroundings) {
                    *pixel = pixel.map(|value| value / (1.0 + v));
                }
                mapped
            }
            ToneMap::Filmic => by_luminance(&image, gain, |l| (2.51 * l + 0.03) / (l * (2.43 * l + 0.59) + 0.14)),
        };
        mapped.map(|pixel| pixel.map(displayable))
    }
}

impl FromStr for ToneMap {
    type Err = Error;

    /// The operator of this name, with the parameters of [`ToneMap::ALL`]; `equalise` is known too.
    fn from_str(name: &str) -> Result<ToneMap> {
        let spelled = name.to_lowercase().replace("equalise", "equalize");
        let found = ToneMap::ALL.into_iter().find(|(known, _)| *known == spelled);
        found.map(|(_, operator)| operator).ok_or_else(|| {
            let names = ToneMap::ALL.map(|(known, _)| known);
            let hint = match did_you_mean(&spelled, names) {
                Some(near) => format!("did you mean '{near}'?"),
                None => format!("known are {}", names.join(", ")),
            };
            Error::new(format!("there is no tone-mapping operator '{name}'")).with_hint(hint)
        })
    }
}

/// What brings the logarithmic average of the luminance to `key` [Reinhard 2002, eqs. 1, 2]. The paper adds a small
/// δ to every luminance so that black has a logarithm; that would depend on the unit of the radiance, and a large
/// black background would brighten what stands before it, so we leave black out.
fn key_scale(image: &Image, key: f32) -> f32 {
    let lit = || image.pixels().iter().map(|&pixel| luminance(pixel)).filter(|&l| l > 0.0);
    let logarithms: f64 = lit().map(|l| f64::from(l).ln()).sum();
    let average = (logarithms / lit().count() as f64).exp();
    if average > 0.0 { (f64::from(key) / average) as f32 } else { 0.0 }
}

fn scaled(image: &Image, scale: f32) -> Image {
    // White to every curve, and its square is still a number.
    const BRIGHTEST: f32 = 1e15;
    image.map(|pixel| pixel.map(|value| (value * scale).min(BRIGHTEST)))
}

/// The picture times `scale`, then each pixel times `ratio` of its luminance.
fn by_luminance(image: &Image, scale: f32, ratio: impl Fn(f32) -> f32) -> Image {
    scaled(image, scale).map(|pixel| {
        let ratio = ratio(luminance(pixel));
        pixel.map(|value| value * ratio)
    })
}

#[cfg(test)]
mod tests;
