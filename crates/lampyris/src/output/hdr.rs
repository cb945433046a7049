//! Radiance RGBE pictures.

use std::io::Cursor;

use ::image::codecs::hdr::{HdrDecoder, HdrEncoder};
use ::image::{ImageDecoder, Rgb};

use super::limits::check_compressed_size;
use super::png::picture;
use crate::error::{Error, Result};
use crate::image::Image;

pub(super) fn encode(image: &Image) -> Result<Vec<u8>> {
    let pixels: Vec<_> = image.pixels().iter().map(|&pixel| Rgb(representable(pixel))).collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes)
        .encode(&pixels, image.width(), image.height())
        .map_err(|error| Error::new(format!("the picture cannot be written as HDR: {error}")))?;
    Ok(bytes)
}

/// The nearest colour that RGBE holds: three mantissas of 8 bits under the exponent of the largest channel. The
/// encoder cuts digits off, which would darken every picture by a fifth of a per cent.
fn representable(pixel: [f32; 3]) -> [f32; 3] {
    const LARGEST: f32 = 1.0e38;
    const SMALLEST: f32 = 1.0e-38;
    // What is no number becomes 0.
    let pixel = pixel.map(|value| if value > 0.0 { value.min(LARGEST) } else { 0.0 });
    let largest = pixel.into_iter().fold(0.0, f32::max);
    if largest < SMALLEST {
        return [0.0; 3];
    }
    let mut step = f64::from(largest.log2().floor() - 7.0).exp2();
    if (f64::from(largest) / step).round() > 255.0 {
        step *= 2.0;
    }
    pixel.map(|value| ((f64::from(value) / step).round() * step) as f32)
}

/// Reads flat and run-length coded pictures; like everyone else, we leave `EXPOSURE` alone.
pub(super) fn decode(bytes: &[u8]) -> Result<Image> {
    // A run of the old coding has no limit; a byte that stands for more pixels than this is a broken one.
    const PIXELS_PER_BYTE: u64 = 1024;
    let fail = |error| Error::new(format!("the HDR picture is damaged: {error}"));
    let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(fail)?;
    let (width, height) = decoder.dimensions();
    // Every row takes four bytes or more.
    let rows_fit = u64::from(height) <= bytes.len() as u64 / 4;
    check_compressed_size(width.into(), height.into(), bytes.len(), if rows_fit { PIXELS_PER_BYTE } else { 0 })?;
    Ok(picture(decoder).map_err(fail)?.to_image())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_rounded_to_the_nearest_step() {
        // Under the exponent of 1.0 a step is 1/128.
        assert_eq!(representable([1.0, 0.6 / 128.0, 0.4 / 128.0]), [1.0, 1.0 / 128.0, 0.0]);
    }

    #[test]
    fn what_rgbe_cannot_hold_comes_out_black_or_as_large_as_can_be() {
        let image = Image::from_pixels(2, 1, vec![[f32::NAN, -1.0, 1e-44], [f32::INFINITY, 0.0, 0.0]]);
        let decoded = decode(&encode(&image.expect("two pixels")).expect("encodes")).expect("decodes");
        assert_eq!(decoded.pixel(0, 0), [0.0; 3]);
        assert!(decoded.pixel(1, 0)[0] > 9e37 && decoded.pixel(1, 0)[0].is_finite());
    }

    #[test]
    fn a_header_with_more_rows_than_bytes_is_refused() {
        let error = decode(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 9000 +X 9000\n").expect_err("no data");
        assert!(error.message.contains("too short"), "{error}");
    }
}
