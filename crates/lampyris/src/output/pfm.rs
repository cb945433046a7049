//! Portable float maps: three lines of text, then 32-bit floats, the bottom row first.

use super::limits::check_size;
use crate::error::{Error, Result};
use crate::image::Image;

pub(super) fn encode(image: &Image) -> Vec<u8> {
    let mut bytes = format!("PF\n{} {}\n-1.0\n", image.width(), image.height()).into_bytes();
    for row in image.pixels().chunks(image.width()).rev() {
        bytes.extend(row.iter().flatten().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

/// Reads `PF` (colour) and `Pf` (grey). The sign of the third number tells the byte order, its size multiplies
/// the values.
pub(super) fn decode(bytes: &[u8]) -> Result<Image> {
    let mut at = 0;
    let channels = if next_word(bytes, &mut at) == Some("PF") { 3 } else { 1 };
    let width: u64 = number(bytes, &mut at, "width")?;
    let height: u64 = number(bytes, &mut at, "height")?;
    let scale: f32 = number(bytes, &mut at, "scale")?;
    if scale == 0.0 || !scale.is_finite() {
        return Err(Error::new(format!("the scale in a PFM cannot be {scale}")));
    }
    // One blank ends the text; where lines end in two, the second is no sample.
    at += if bytes[at..].starts_with(b"\r\n") { 2 } else { 1 };
    let data = bytes.get(at..).unwrap_or_default();
    let (width, height) = check_size(width, height, data.len() as u64 / (4 * channels))?;
    let sample = |four: &[u8]| {
        let four = [four[0], four[1], four[2], four[3]];
        scale.abs() * if scale < 0.0 { f32::from_le_bytes(four) } else { f32::from_be_bytes(four) }
    };
    let mut image = Image::new(width, height);
    let size = 4 * channels as usize;
    let rows = image.pixels_mut().chunks_mut(width).rev().zip(data.chunks(width * size));
    for (row, data) in rows {
        for (pixel, data) in row.iter_mut().zip(data.chunks(size)) {
            *pixel = std::array::from_fn(|channel| sample(&data[channel * 4 % size..]));
        }
    }
    Ok(image)
}

fn number<T: std::str::FromStr>(bytes: &[u8], at: &mut usize, what: &str) -> Result<T> {
    let word = next_word(bytes, at).ok_or_else(|| Error::new(format!("the PFM ends before its {what}")))?;
    word.parse().map_err(|_| Error::new(format!("the {what} of the PFM is not a number: '{word}'")))
}

/// The next run of characters without blanks, with `at` moved to its end.
fn next_word<'a>(bytes: &'a [u8], at: &mut usize) -> Option<&'a str> {
    // No number that we can use is longer; without this, binary data would be taken for a word.
    const LONGEST_WORD: usize = 64;
    let rest = &bytes[*at..];
    let start = *at + rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
    let word = bytes[start..].iter().take(LONGEST_WORD).take_while(|byte| byte.is_ascii_graphic()).count();
    *at = start + word;
    bytes.get(*at).filter(|byte| byte.is_ascii_whitespace())?;
    std::str::from_utf8(&bytes[start..*at]).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, values: &[f32], big_endian: bool) -> Vec<u8> {
        let mut bytes = header.as_bytes().to_vec();
        for value in values {
            bytes.extend(if big_endian { value.to_be_bytes() } else { value.to_le_bytes() });
        }
        bytes
    }

    #[test]
    fn the_bottom_row_comes_first() {
        let bytes = file("PF\n1 2\n-1\n", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], false);
        let image = decode(&bytes).expect("valid");
        assert_eq!(image.pixels(), [[4.0, 5.0, 6.0], [1.0, 2.0, 3.0]]);
        assert_eq!(encode(&image)[encode(&image).len() - 24..], bytes[bytes.len() - 24..]);
    }

    #[test]
    fn grey_big_endian_and_scaled() {
        let image = decode(&file("Pf\r\n2 1\r\n2.0\r\n", &[1.5, -3.0], true)).expect("valid");
        assert_eq!(image.pixels(), [[3.0; 3], [-6.0; 3]]);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        for (header, expected) in [
            ("PF\n1 1\n0\n", "scale"),
            ("PF\n1 1\nnan\n", "scale"),
            ("PF\n-1 1\n-1\n", "width"),
            ("PF\n1 2\n-1\n", "too short"),
            ("PF\n99999999 99999999\n-1\n", "too large"),
            ("PF\n1", "ends before its width"),
        ] {
            let error = decode(&file(header, &[0.0; 3], false)).expect_err(header);
            assert!(error.message.contains(expected), "{header:?}: {error}");
        }
    }
}
