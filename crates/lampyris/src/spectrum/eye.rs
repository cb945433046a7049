//! What the eye makes of a spectrum: linear RGB, by the two conventions of Mitsuba's RGB mode.

use super::observer::{D65, FIRST, MATCHING};

/// What a spectrum belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Reflectances, indices of refraction, as they look in daylight: the illuminant is D65, and a constant 1 is
    /// (1, 1, 1).
    Surface,
    /// Radiance, intensity, irradiance, by its power: a constant 1 has luminance 1 and the slightly red hue of equal
    /// energy.
    Light,
}

/// XYZ to linear RGB with the primaries and the white of ITU-R BT.709.
const TO_RGB: [[f64; 3]; 3] =
    [[3.240479, -1.537150, -0.498535], [-0.969256, 1.875991, 0.041556], [0.055648, -0.204043, 1.057311]];

/// Linear RGB of the spectrum that `value` gives by wavelength in nm; a channel is negative where RGB cannot hold the
/// colour.
pub fn rgb(role: Role, value: impl Fn(f64) -> f64) -> [f64; 3] {
    match role {
        Role::Surface => {
            let white = rgb_of(daylight);
            let seen = rgb_of(|wavelength| value(wavelength) * daylight(wavelength));
            [0, 1, 2].map(|channel| seen[channel] / white[channel])
        }
        Role::Light => {
            let luminance: f64 = wavelengths().map(|wavelength| matching(wavelength)[1]).sum();
            rgb_of(value).map(|channel| channel / luminance)
        }
    }
}

/// Planck's law in W/(m² sr nm), wavelength in nm, temperature in kelvin.
pub fn planck(wavelength: f64, temperature: f64) -> f64 {
    const PLANCK: f64 = 6.626_070_15e-34;
    const LIGHT: f64 = 299_792_458.0;
    const BOLTZMANN: f64 = 1.380_649e-23;
    let metres = wavelength * 1e-9;
    let exponent = PLANCK * LIGHT / (metres * BOLTZMANN * temperature);
    2.0 * PLANCK * LIGHT * LIGHT / metres.powi(5) / exponent.exp_m1() * 1e-9
}

fn wavelengths() -> impl Iterator<Item = f64> {
    (380..=780).map(f64::from)
}

fn rgb_of(power: impl Fn(f64) -> f64) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    for wavelength in wavelengths() {
        let power = power(wavelength);
        for (sum, matching) in xyz.iter_mut().zip(matching(wavelength)) {
            *sum += power * matching;
        }
    }
    xyz_to_rgb(xyz)
}

/// Linear RGB of a colour in CIE XYZ; negative where RGB cannot hold it.
pub fn xyz_to_rgb(xyz: [f64; 3]) -> [f64; 3] {
    TO_RGB.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// Linear RGB of light of one wavelength (nm), as the matching functions have it.
pub(super) fn channels(wavelength: f64) -> [f64; 3] {
    xyz_to_rgb(matching(wavelength))
}

fn matching(wavelength: f64) -> [f64; 3] {
    [0, 1, 2].map(|channel| between(|index| MATCHING.get(index).map(|row| row[channel]), (wavelength - FIRST) / 5.0))
}

/// The relative power of D65 at a wavelength in nm.
pub(super) fn daylight(wavelength: f64) -> f64 {
    between(|index| D65.get(index).copied(), (wavelength - FIRST) / 10.0)
}

/// The value of an evenly spaced table at a fractional index.
fn between(table: impl Fn(usize) -> Option<f64>, at: f64) -> f64 {
    let index = at as usize;
    let first = table(index).unwrap_or(0.0);
    let second = table(index + 1).unwrap_or(first);
    first + (second - first) * (at - index as f64)
}
