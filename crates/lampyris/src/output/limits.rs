//! Sizes as files claim them, believed only as far as the bytes go.

use crate::error::{Error, Result};

/// 16384 × 16384; a file that claims more pixels is taken for damaged.
pub(super) const MOST_PIXELS: u64 = 1 << 28;

/// Below this, what a small file claims is not worth doubting: four million pixels.
const NOT_WORTH_DOUBT: u64 = 1 << 22;

/// Width and height as memory sizes, where the file can hold so many pixels: at most `most_pixels`.
pub(super) fn check_size(width: u64, height: u64, most_pixels: u64) -> Result<(usize, usize)> {
    let pixels = width.checked_mul(height).filter(|&pixels| pixels <= MOST_PIXELS);
    match pixels {
        Some(0) => Err(Error::new(format!("the picture has no pixels: its size is {width} × {height}"))),
        Some(pixels) if pixels <= most_pixels => Ok((width as usize, height as usize)),
        Some(_) => Err(Error::new(format!("the file is too short for a picture of {width} × {height} pixels"))
            .with_hint("it may have been cut off in a copy")),
        None => Err(Error::new(format!("a picture of {width} × {height} pixels is too large"))
            .with_hint(format!("at most {MOST_PIXELS} pixels are read"))),
    }
}

/// [`check_size`] for a compressed format, of which `bytes` bytes cannot become more than `ratio` pixels each.
pub(super) fn check_compressed_size(width: u64, height: u64, bytes: usize, ratio: u64) -> Result<(usize, usize)> {
    check_size(width, height, (bytes as u64).saturating_mul(ratio).max(NOT_WORTH_DOUBT))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_beyond_the_bytes_or_beyond_reason_are_refused() {
        assert_eq!(check_size(4, 3, 12).expect("exactly enough"), (4, 3));
        assert!(check_size(4, 3, 11).is_err());
        assert!(check_size(0, 3, 11).is_err());
        assert!(check_size(1 << 15, 1 << 15, u64::MAX).is_err());
        assert!(check_size(u64::MAX, 2, u64::MAX).is_err());
    }
}
