//! PNG: display values, 8 bits a channel under the sRGB curve.

use std::io::Cursor;

use ::image::codecs::png::{PngDecoder, PngEncoder};
use ::image::error::{ParameterError, ParameterErrorKind};
use ::image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageError, ImageResult, Limits};

use super::limits::check_size;
use super::{Decoded, Values};
use crate::error::{Error, Result};
use crate::image::{Image, displayable};
use crate::spectrum::linear_to_srgb;
use crate::texture::{Curve, Raster, Texels};

/// Values are cut off at 0 and 1; what is not a number becomes 0.
pub(super) fn encode(image: &Image) -> Result<Vec<u8>> {
    let fail = |error: &dyn std::fmt::Display| Error::new(format!("the picture cannot be written as PNG: {error}"));
    let codes = codes(image);
    let width = u32::try_from(image.width()).map_err(|error| fail(&error))?;
    let height = u32::try_from(image.height()).map_err(|error| fail(&error))?;
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(&codes, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| fail(&error))?;
    Ok(bytes)
}

/// Three bytes a pixel, under the sRGB curve. Values are cut off at 0 and 1; what is not a number becomes 0.
pub(super) fn codes(image: &Image) -> Vec<u8> {
    image.pixels().iter().flatten().map(|&value| code(value)).collect()
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
    // Smaller pixels are a byte each in memory, and more where they become light.
    let bits_per_pixel = u64::from(decoder.original_color_type().bits_per_pixel().max(8));
    check_size(width.into(), height.into(), bytes.len() as u64 * BITS_PER_BYTE / bits_per_pixel)?;
    Ok(Decoded { picture: picture(decoder).map_err(fail)?, values: Values::Srgb })
}

/// What a decoder may allocate: the largest picture with four channels of 16 bits, and room to work.
pub(super) fn limits() -> Limits {
    let mut limits = Limits::default();
    limits.max_alloc = Some(3 << 30);
    limits
}

/// The picture of a decoder from the `image` crate, its numbers as they are.
pub(super) fn picture(decoder: impl ImageDecoder) -> ImageResult<Raster> {
    let decoded = DynamicImage::from_decoder(decoder)?;
    let (width, height) = (decoded.width() as usize, decoded.height() as usize);
    let (channels, texels) = match decoded {
        DynamicImage::ImageLuma8(pixels) => (1, Texels::Bytes(pixels.into_raw())),
        DynamicImage::ImageLumaA8(pixels) => (2, Texels::Bytes(pixels.into_raw())),
        DynamicImage::ImageRgb8(pixels) => (3, Texels::Bytes(pixels.into_raw())),
        DynamicImage::ImageRgba8(pixels) => (4, Texels::Bytes(pixels.into_raw())),
        DynamicImage::ImageLuma16(pixels) => (1, Texels::Words(pixels.into_raw())),
        DynamicImage::ImageLumaA16(pixels) => (2, Texels::Words(pixels.into_raw())),
        DynamicImage::ImageRgb16(pixels) => (3, Texels::Words(pixels.into_raw())),
        DynamicImage::ImageRgba16(pixels) => (4, Texels::Words(pixels.into_raw())),
        DynamicImage::ImageRgb32F(pixels) => (3, Texels::Floats(pixels.into_raw())),
        other => (4, Texels::Floats(other.into_rgba32f().into_raw())),
    };
    // The crate's buffers have the size that they say, but not always pixels.
    Raster::new(width, height, channels, texels, Curve::Linear).ok_or_else(|| {
        let kind = ParameterErrorKind::DimensionMismatch;
        ImageError::Parameter(ParameterError::from_kind(kind))
    })
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
