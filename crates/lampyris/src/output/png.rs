//! PNG: display values, 8 bits a channel under the sRGB curve.

use std::io::Cursor;

use ::image::codecs::png::{PngDecoder, PngEncoder};
use ::image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageResult, Limits};

use super::limits::check_size;
use super::{Decoded, Values};
use crate::error::{Error, Result};
use crate::image::{Image, displayable};
use crate::spectrum::linear_to_srgb;

/// Values are cut off at 0 and 1; what is not a number becomes 0.
pub(super) fn encode(image: &Image) -> Result<Vec<u8>> {
    let fail = |error: &dyn std::fmt::Display| Error::new(format!("the picture cannot be written as PNG: {error}"));
    let codes: Vec<u8> = image.pixels().iter().flatten().map(|&value| code(value)).collect();
    let width = u32::try_from(image.width()).map_err(|error| fail(&error))?;
    let height = u32::try_from(image.height()).map_err(|error| fail(&error))?;
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(&codes, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| fail(&error))?;
    Ok(bytes)
}

fn code(linear: f32) -> u8 {
    (linear_to_srgb(displayable(linear)) * 255.0).round() as u8
}

pub(super) fn decode(bytes: &[u8]) -> Result<Decoded> {
    // Deflate makes at most 1032 bytes of one.
    const BITS_PER_BYTE: u64 = 8 * 1032;
    let fail = |error| Error::new(format!("the PNG picture is damaged: {error}"));
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits()).map_err(fail)?;
    let (width, height) = decoder.dimensions();
    let bits_per_pixel = u64::from(decoder.original_color_type().bits_per_pixel().max(1));
    check_size(width.into(), height.into(), bytes.len() as u64 * BITS_PER_BYTE / bits_per_pixel)?;
    Ok(Decoded { image: pixels(decoder).map_err(fail)?, values: Values::Srgb })
}

/// What a decoder may allocate: the largest picture with four channels of 16 bits, and room to work.
pub(super) fn limits() -> Limits {
    let mut limits = Limits::default();
    limits.max_alloc = Some(3 << 30);
    limits
}

/// The pixels of a decoder from the `image` crate, integers scaled to 0..1.
pub(super) fn pixels(decoder: impl ImageDecoder) -> ImageResult<Image> {
    let decoded = DynamicImage::from_decoder(decoder)?.into_rgb32f();
    let mut image = Image::new(decoded.width() as usize, decoded.height() as usize);
    for (pixel, decoded) in image.pixels_mut().iter_mut().zip(decoded.pixels()) {
        *pixel = decoded.0;
    }
    Ok(image)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_values() {
        let values = [0.0, 1.0, 0.18, -1.0, 7.0, f32::INFINITY, f32::NAN];
        assert_eq!(values.map(code), [0, 255, 118, 0, 255, 255, 0]);
    }

    #[test]
    fn a_header_that_promises_more_than_deflate_can_hold_is_refused() {
        let mut bytes = encode(&Image::new(8, 8)).expect("encodes");
        bytes[16..24].copy_from_slice(&[0, 0, 0x20, 0, 0, 0, 0x20, 0]); // 8192 × 8192, with the checksum mended
        let checksum = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
        let error = decode(&bytes).err().expect("too short");
        assert!(error.message.contains("too short"), "{error}");
    }

    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0u32, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1)))
        })
    }
}
