//! JPEG, read only.

use std::io::Cursor;

use ::image::ImageDecoder;
use ::image::codecs::jpeg::JpegDecoder;

use super::limits::check_compressed_size;
use super::png::{limits, picture};
use super::{Decoded, Values};
use crate::error::{Error, Result};

pub(super) fn decode(bytes: &[u8]) -> Result<Decoded> {
    // A block of 64 pixels takes two bits at least, or one in a progressive file whose later scans are empty.
    const PIXELS_PER_BYTE: u64 = 8 * 64;
    let fail = |error| Error::new(format!("the JPEG picture is damaged: {error}"));
    let mut decoder = JpegDecoder::new(Cursor::new(bytes)).map_err(fail)?;
    let (width, height) = decoder.dimensions();
    check_compressed_size(width.into(), height.into(), bytes.len(), PIXELS_PER_BYTE)?;
    decoder.set_limits(limits()).map_err(fail)?;
    Ok(Decoded { picture: picture(decoder).map_err(fail)?, values: Values::Srgb })
}
