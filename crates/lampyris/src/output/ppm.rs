//! Portable pixel maps, with the comment `#MAX=` by which a file of integers holds radiance: a value in memory is
//! integer · MAX / maxval.

use std::fmt::Write;
use std::ops::Range;

use super::limits::check_size;
use super::{Decoded, Values};
use crate::error::{Error, Place, Result};
use crate::image::Image;
use crate::texture::{Curve, Raster, Texels};

/// The most that a sample may be, and what we scale the largest value to.
const MOST: u32 = 65535;

/// A P3 of 65535 steps up to the largest finite value, which stands in `#MAX=`. What is negative or no number
/// becomes 0, what is infinite becomes the largest.
pub(super) fn encode(image: &Image) -> Vec<u8> {
    // Of a black picture any MAX tells the truth; 1 keeps readers from dividing by 0.
    let max = if image.max() > 0.0 { image.max() } else { 1.0 };
    let mut text = format!("P3\n#MAX={max}\n{} {}\n{MOST}\n", image.width(), image.height());
    for pixel in image.pixels() {
        // `max` takes 0 where the value is no number.
        let [r, g, b] =
            pixel.map(|value| (f64::from(value.max(0.0).min(max)) / f64::from(max) * f64::from(MOST)).round() as u32);
        // Writing to a string does not fail.
        let _ = writeln!(text, "{r} {g} {b}");
    }
    text.into_bytes()
}

/// Reads P3 (text) and P6 (bytes). Without `#MAX=` the values lie in 0..1.
pub(super) fn decode(name: &str, bytes: &[u8]) -> Result<Decoded> {
    let mut text = Text { name, bytes, at: 2, max: None };
    let width = text.number("the width", u32::MAX)?;
    let height = text.number("the height", u32::MAX)?;
    let maxval = text.number("the maxval", MOST)?;
    if maxval == 0 {
        return Err(text.error("the maxval cannot be 0", text.at - 1..text.at));
    }
    let (width, height, samples) = match bytes[1] {
        b'6' => bytes_of_samples(&text, width, height, maxval)?,
        _ => words_of_samples(&mut text, width, height, maxval)?,
    };
    let texels = match (text.max, maxval) {
        (None, 255) => Texels::Bytes(samples.into_iter().map(|sample| sample as u8).collect()),
        (None, 65535) => Texels::Words(samples),
        (max, _) => {
            let scale = f64::from(max.unwrap_or(1.0)) / f64::from(maxval);
            Texels::Floats(samples.into_iter().map(|sample| (f64::from(sample) * scale) as f32).collect())
        }
    };
    let values = if text.max.is_some() { Values::Linear } else { Values::Unstated };
    match Raster::new(width, height, 3, texels, Curve::Linear) {
        Some(picture) => Ok(Decoded { picture, values }),
        None => Err(Error::new("the picture has no pixels")),
    }
}

fn words_of_samples(text: &mut Text, width: u32, height: u32, maxval: u32) -> Result<(usize, usize, Vec<u16>)> {
    // A sample is a digit and a blank at least.
    let rest = text.bytes.len() - text.at;
    let (width, height) = check_size(width.into(), height.into(), rest.div_ceil(6) as u64)?;
    let mut samples = Vec::with_capacity(3 * width * height);
    for _ in 0..3 * width * height {
        samples.push(text.number("a sample", maxval)? as u16);
    }
    match text.word()? {
        None => Ok((width, height, samples)),
        Some(word) => Err(text.error(&format!("more samples than the 3 × {width} × {height} of its size"), word)),
    }
}

fn bytes_of_samples(text: &Text, width: u32, height: u32, maxval: u32) -> Result<(usize, usize, Vec<u16>)> {
    let size = if maxval > 255 { 2 } else { 1 };
    // One blank, whichever, stands between the text and the bytes.
    let data = text.bytes.get(text.at + 1..).unwrap_or_default();
    let (width, height) = check_size(width.into(), height.into(), (data.len() / (3 * size)) as u64)?;
    let samples = data.chunks_exact(size).take(3 * width * height);
    let samples: Vec<u16> =
        samples.map(|bytes| bytes.iter().fold(0, |value, &b| (value << 8) | u16::from(b))).collect();
    match samples.iter().find(|&&sample| u32::from(sample) > maxval) {
        Some(sample) => Err(Error::new(format!("a sample of {sample} lies above the maxval {maxval}"))),
        None => Ok((width, height, samples)),
    }
}

/// Words separated by blanks, among comments from `#` to the end of the line.
struct Text<'a> {
    name: &'a str,
    bytes: &'a [u8],
    at: usize,
    /// What a comment `#MAX=` said.
    max: Option<f32>,
}

impl Text<'_> {
    /// Where the next word stands; `None` at the end.
    fn word(&mut self) -> Result<Option<Range<usize>>> {
        while let Some(&byte) = self.bytes.get(self.at) {
            match byte {
                b'#' => self.comment()?,
                _ if byte.is_ascii_whitespace() => self.at += 1,
                _ => {
                    let start = self.at;
                    let word = self.bytes[start..].iter().take_while(|&&b| b != b'#' && !b.is_ascii_whitespace());
                    self.at += word.count();
                    return Ok(Some(start..self.at));
                }
            }
        }
        Ok(None)
    }

    fn number(&mut self, what: &str, most: u32) -> Result<u32> {
        let Some(word) = self.word()? else {
            let end = self.bytes.len();
            return Err(self.error(&format!("the file ends where {what} should stand"), end..end));
        };
        let digits =
            std::str::from_utf8(&self.bytes[word.clone()]).ok().filter(|w| w.bytes().all(|b| b.is_ascii_digit()));
        let Some(digits) = digits else {
            let found = String::from_utf8_lossy(&self.bytes[word.clone()][..word.len().min(20)]);
            return Err(self.error(&format!("expected {what}, a whole number, and found '{found}'"), word));
        };
        match digits.parse() {
            Ok(number) if number <= most => Ok(number),
            _ => Err(self.error(&format!("{what} of {digits:.20} is more than {most}"), word)),
        }
    }

    fn comment(&mut self) -> Result<()> {
        let start = self.at;
        let line = self.bytes[start..].iter().take_while(|&&byte| byte != b'\n' && byte != b'\r');
        self.at += line.count();
        let comment = String::from_utf8_lossy(&self.bytes[start + 1..self.at]);
        let Some(max) = comment.trim_start().strip_prefix("MAX").and_then(|rest| rest.trim_start().strip_prefix('='))
        else {
            return Ok(());
        };
        match max.trim().parse::<f32>() {
            Ok(value) if value > 0.0 && value.is_finite() => self.max = Some(value),
            _ => {
                let found = format!("the largest value #MAX= must be a positive number, not '{}'", max.trim());
                return Err(self.error(&found, start..self.at));
            }
        }
        Ok(())
    }

    fn error(&self, message: &str, span: Range<usize>) -> Error {
        let text = String::from_utf8_lossy(&self.bytes[..span.end]);
        let length = span.len().min(text.len());
        Error::new(message).with_place(Place::of(self.name, &text, text.len() - length..text.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(file: &[u8]) -> Vec<[f32; 3]> {
        decode("a.ppm", file).expect("valid").picture.to_image().pixels().to_vec()
    }

    #[test]
    fn the_file_begins_as_in_the_course() {
        let image = Image::from_pixels(1, 2, vec![[2.5, 1.25, 0.0], [f32::NAN, -1.0, f32::INFINITY]]);
        let text = String::from_utf8(encode(&image.expect("two pixels"))).expect("text");
        assert_eq!(text, "P3\n#MAX=2.5\n1 2\n65535\n65535 32768 0\n0 0 65535\n");
    }

    #[test]
    fn a_black_picture_has_a_positive_max() {
        assert!(encode(&Image::new(1, 1)).starts_with(b"P3\n#MAX=1\n"));
    }

    #[test]
    fn max_scales_the_integers() {
        let file = b"P3\n# feep.ppm\n#MAX=30\n2 1\n15\n0 0 15 1 2 # in between\n3";
        assert_eq!(pixels(file), [[0.0, 0.0, 30.0], [2.0, 4.0, 6.0]]);
    }

    #[test]
    fn without_max_values_lie_in_0_to_1() {
        assert_eq!(pixels(b"P3 1 1 4 0 1 4"), [[0.0, 0.25, 1.0]]);
    }

    #[test]
    fn bytes_are_big_endian_above_255() {
        assert_eq!(pixels(b"P6 1 1 255\n\x00\x33\xff"), [[0.0, 0.2, 1.0]]);
        assert_eq!(pixels(b"P6 1 1 #MAX=1000\n 1000\n\x00\x01\x01\x00\x03\xe8"), [[1.0, 256.0, 1000.0]]);
    }

    #[test]
    fn every_fault_has_its_place() {
        for (file, expected) in [
            ("P3\n2 x 255", "a.ppm:2:3: expected the height, a whole number, and found 'x'"),
            ("P3\n1 1 255\n1 2\n256", "a.ppm:4:1: a sample of 256 is more than 255"),
            ("P3\n1 1 15\n1 2 ", "a.ppm:3:5: the file ends where a sample should stand"),
            ("P3\n1 1 15\n1 -2 3", "a.ppm:3:3: expected a sample, a whole number, and found '-2'"),
            ("P3\n1 1 15\n1 2 3\n 4", "a.ppm:4:2: more samples than the 3 × 1 × 1 of its size"),
            ("P3\n1 1 65536\n1 2 3", "a.ppm:2:5: the maxval of 65536 is more than 65535"),
            ("P3\n1 1 0\n1 2 3", "a.ppm:2:5: the maxval cannot be 0"),
            ("P3\n#MAX=0\n1 1 1 1 1 1", "a.ppm:2:1: the largest value #MAX= must be a positive number, not '0'"),
            ("P3\n#MAX=nan\n1 1 1 1 1 1", "a.ppm:2:1: the largest value #MAX= must be a positive number, not 'nan'"),
            ("P3\n #MAX=-3\n1 1 1 1 1 1", "a.ppm:2:2: the largest value #MAX= must be a positive number, not '-3'"),
            ("P3\n999999 999999 1\n1 2 3", "a picture of 999999 × 999999 pixels is too large"),
            ("P3\n99 99 1\n1 2 3", "the file is too short for a picture of 99 × 99 pixels"),
        ] {
            let error = decode("a.ppm", file.as_bytes()).err().expect(file);
            assert!(error.to_string().starts_with(expected), "{file:?}: {error}");
        }
    }
}
