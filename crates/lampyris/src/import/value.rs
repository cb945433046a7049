//! Numbers, colours and spectra from the text of an attribute.

use super::spectrum::Spectrum;
use crate::scene::description::Color;
use crate::spectrum::srgb_to_linear;

/// The numbers in `text`, between commas or blanks; else what is wrong with it.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    words(text).map(number).collect()
}

/// One finite number, within the range of `f32`.
pub(super) fn number(text: &str) -> Result<f64, String> {
    let text = text.trim();
    match text.parse::<f64>() {
        Ok(value) if value.abs() <= f64::from(f32::MAX) => Ok(value),
        Ok(_) => Err(format!("'{text}' is not a finite number or too large")),
        Err(_) => Err(format!("'{text}' is not a number")),
    }
}

/// A whole number, perhaps written as 12.0 or 1e5.
pub(super) fn integer(text: &str) -> Result<i64, String> {
    let text = text.trim();
    match text.parse::<i64>() {
        Ok(value) => Ok(value),
        Err(_) => match text.parse::<f64>() {
            Ok(value) if value.fract() == 0.0 && value.abs() < 9e15 => Ok(value as i64),
            _ => Err(format!("'{text}' is not a whole number")),
        },
    }
}

/// `true` or `false`, in any case.
pub(super) fn boolean(text: &str) -> Result<bool, String> {
    match text.trim().to_ascii_lowercase().as_str() {
        "true" => Ok(true),
        "false" => Ok(false),
        other => Err(format!("'{other}' is neither true nor false")),
    }
}

/// Three numbers, or one for all three.
pub(super) fn triple(text: &str) -> Result<[f64; 3], String> {
    match numbers(text)?[..] {
        [a] => Ok([a; 3]),
        [a, b, c] => Ok([a, b, c]),
        ref other => Err(format!("there must be one number or three, not {}", other.len())),
    }
}

/// A linear colour: one number, three, or `#rrggbb` in sRGB.
pub(super) fn rgb(text: &str) -> Result<[f64; 3], String> {
    match text.trim().strip_prefix('#') {
        Some(digits) => {
            let color = Color::from_hex(digits)
                .ok_or_else(|| format!("'#{digits}' is not a colour; six hexadecimal digits make one"))?;
            Ok(color.0.map(f64::from))
        }
        None => triple(text),
    }
}

/// A colour in sRGB, decoded to linear.
pub(super) fn srgb(text: &str) -> Result<[f64; 3], String> {
    if text.trim().starts_with('#') {
        return rgb(text);
    }
    Ok(triple(text)?.map(|channel| f64::from(srgb_to_linear(channel as f32))))
}

/// What a `spectrum` element may hold: a constant, `wavelength:value` pairs, or three numbers, which Mitsuba 0.x
/// takes for a colour.
pub(super) enum SpectrumText {
    Spectrum(Spectrum),
    Rgb([f64; 3]),
}

/// Reads the `value` of a `spectrum` element.
pub(super) fn spectrum(text: &str) -> Result<SpectrumText, String> {
    if text.contains(':') {
        let pairs: Result<Vec<_>, _> = words(text).map(pair).collect();
        return rising(pairs?).map(SpectrumText::Spectrum);
    }
    if text.trim().starts_with('#') {
        return rgb(text).map(SpectrumText::Rgb);
    }
    match numbers(text)?[..] {
        [value] => Ok(SpectrumText::Spectrum(Spectrum::Constant(value))),
        [r, g, b] => Ok(SpectrumText::Rgb([r, g, b])),
        _ => Err("a spectrum is one number, three, or pairs such as '400:0.1, 700:0.5'".to_string()),
    }
}

/// A spectrum file: a wavelength in nm and a value on each line, `#` before comments.
pub(super) fn spectrum_file(text: &str) -> Result<Spectrum, String> {
    let mut pairs = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("").trim();
        if !line.is_empty() {
            match numbers(line).map_err(|error| format!("line {}: {error}", index + 1))?[..] {
                [wavelength, value] => pairs.push([wavelength, value]),
                _ => return Err(format!("line {} does not hold a wavelength and a value", index + 1)),
            }
        }
    }
    rising(pairs)
}

/// The same spectrum from two lists of equal length.
pub(super) fn spectrum_of(wavelengths: &[f64], values: &[f64]) -> Result<Spectrum, String> {
    if wavelengths.len() != values.len() {
        return Err(format!("there are {} wavelengths but {} values", wavelengths.len(), values.len()));
    }
    rising(wavelengths.iter().zip(values).map(|(&wavelength, &value)| [wavelength, value]).collect())
}

/// The spectrum of pairs of wavelength and value, which must rise.
pub(super) fn rising(pairs: Vec<[f64; 2]>) -> Result<Spectrum, String> {
    if pairs.is_empty() {
        return Err("the spectrum has no values".to_string());
    }
    match pairs.windows(2).find(|two| two[1][0] <= two[0][0]) {
        Some(two) => Err(format!("the wavelengths must rise, but {} follows {}", two[1][0], two[0][0])),
        None => Ok(Spectrum::List(pairs)),
    }
}

fn pair(text: &str) -> Result<[f64; 2], String> {
    let (wavelength, value) =
        text.split_once(':').ok_or_else(|| format!("'{text}' is not a pair of wavelength and value"))?;
    Ok([number(wavelength)?, number(value)?])
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c == ';' || c.is_whitespace()).filter(|word| !word.is_empty())
}
