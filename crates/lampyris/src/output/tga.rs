//! Truevision TGA, read only.

use std::io::Cursor;

use ::image::ImageDecoder;
use ::image::codecs::tga::TgaDecoder;

use super::limits::check_compressed_size;
use super::png::picture;
use super::{Decoded, Values};
use crate::error::{Error, Result};

/// Whether this is a TGA as far as one can say: a file of the format's second version says so at its end, and one of
/// the first has nothing but its name.
pub(super) fn is_likely(name: &str, bytes: &[u8]) -> bool {
    bytes.ends_with(b"TRUEVISION-XFILE.\0") || name.to_lowercase().ends_with(".tga")
}

/// Reads grey, true colour and palettes, plain and run-length coded, from any corner.
pub(super) fn decode(bytes: &[u8]) -> Result<Decoded> {
    // A run of two bytes stands for 128 pixels.
    const PIXELS_PER_BYTE: u64 = 64;
    let fail = |error| Error::new(format!("the TGA picture is damaged: {error}"));
    let decoder = TgaDecoder::new(Cursor::new(bytes)).map_err(fail)?;
    let (width, height) = decoder.dimensions();
    check_compressed_size(width.into(), height.into(), bytes.len(), PIXELS_PER_BYTE)?;
    Ok(Decoded { picture: picture(decoder).map_err(fail)?, values: Values::Srgb })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A header of 18 bytes for 2 × 2 pixels.
    fn header(kind: u8, bits: u8, descriptor: u8) -> Vec<u8> {
        let palette = if kind % 8 == 1 { [1, 0, 0, 2, 0, 24] } else { [0; 6] };
        let mut bytes = vec![0, palette[0], kind];
        bytes.extend(&palette[1..]);
        bytes.extend([0, 0, 0, 0, 2, 0, 2, 0, bits, descriptor]);
        bytes
    }

    fn colors(bytes: &[u8]) -> Vec<[u8; 3]> {
        let picture = decode(bytes).expect("valid").picture;
        let pixel = |index: usize| picture.color(index % 2, index / 2).map(|value| (value * 255.0).round() as u8);
        (0..4).map(pixel).collect()
    }

    const RED: [u8; 3] = [255, 0, 0];
    const BLUE: [u8; 3] = [0, 0, 255];

    #[test]
    fn the_first_row_is_the_lowest_unless_the_file_says_otherwise() {
        let pixels = [0, 0, 255, 255, 0, 0, 255, 0, 0, 255, 0, 0];
        let below = [header(2, 24, 0), pixels.to_vec()].concat();
        assert_eq!(colors(&below), [BLUE, BLUE, RED, BLUE]);
        let above = [header(2, 24, 0x20), pixels.to_vec()].concat();
        assert_eq!(colors(&above), [RED, BLUE, BLUE, BLUE]);
    }

    #[test]
    fn runs_are_read() {
        let runs = [0x80, 0, 0, 255, 0x82, 255, 0, 0];
        assert_eq!(colors(&[header(10, 24, 0x20), runs.to_vec()].concat()), [RED, BLUE, BLUE, BLUE]);
    }

    #[test]
    fn palettes_and_15_bits_are_read_from_below() {
        let palette = [0, 0, 255, 255, 0, 0];
        let plain = [header(1, 8, 0), palette.to_vec(), vec![0, 1, 1, 1]].concat();
        let runs = [header(9, 8, 0), palette.to_vec(), vec![0x80, 0, 0x82, 1]].concat();
        let words = [header(2, 16, 0), vec![0, 0x7c, 0x1f, 0, 0x1f, 0, 0x1f, 0]].concat();
        for bytes in [plain, runs, words] {
            assert_eq!(colors(&bytes), [BLUE, BLUE, RED, BLUE]);
        }
    }

    #[test]
    fn grey_has_one_channel_and_the_fourth_is_opacity() {
        let grey = decode(&[header(3, 8, 0x20), vec![0, 51, 102, 255]].concat()).expect("valid").picture;
        assert_eq!((grey.bytes(), grey.color(1, 0)), (4, [0.2; 3]));
        let pixels = [[1, 2, 3, 51], [1, 2, 3, 102], [1, 2, 3, 153], [1, 2, 3, 204]].concat();
        let opacity = decode(&[header(2, 32, 0x28), pixels].concat()).expect("valid").picture;
        assert_eq!([opacity.opacity(0, 0), opacity.opacity(1, 1)], [0.2, 0.8]);
    }

    #[test]
    fn a_palette_that_lacks_an_entry_is_an_error() {
        let bytes = [header(1, 8, 0), vec![0; 6], vec![0, 1, 2, 1]].concat();
        assert!(decode(&bytes).is_err());
    }
}
