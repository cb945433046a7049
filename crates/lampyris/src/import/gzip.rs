//! Files that come packed with gzip.

use std::borrow::Cow;
use std::io::Read;

use flate2::read::MultiGzDecoder;

use super::mesh::unreadable;
use crate::error::Result;

/// How many bytes may come out for each that goes in: text and meshes reach 30, a bomb a thousand.
const LARGEST_RATIO: u64 = 200;

/// The content of `bytes`, unpacked where they are in gzip's format. `name` is for messages alone.
///
/// # Errors
/// Where they cannot be unpacked, or grow out of all proportion.
pub(super) fn unpacked<'a>(name: &str, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(Cow::Borrowed(bytes));
    }
    let limit = (bytes.len() as u64).saturating_mul(LARGEST_RATIO);
    let mut content = Vec::new();
    let read = MultiGzDecoder::new(bytes).take(limit + 1).read_to_end(&mut content);
    if let Err(error) = read {
        return Err(unreadable(name, format!("its gzip is broken: {error}")).with_hint("is the file complete?"));
    }
    if content.len() as u64 > limit {
        return Err(unreadable(name, format!("unpacked it is more than {LARGEST_RATIO} times as large")));
    }
    Ok(Cow::Owned(content))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn packed(content: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(content).expect("memory");
        encoder.finish().expect("memory")
    }

    #[test]
    fn what_is_packed_is_unpacked_and_the_rest_stays() {
        assert_eq!(*unpacked("a", &packed(b"ply\n")).expect("it is whole"), *b"ply\n");
        assert_eq!(*unpacked("a", b"ply\n").expect("it is no gzip"), *b"ply\n");
    }

    #[test]
    fn bombs_and_broken_files_are_refused() {
        let bomb = packed(&vec![0; 1 << 20]);
        assert!(unpacked("a", &bomb).expect_err("a bomb").message.contains("times as large"));
        let whole = packed(b"a file that will be cut off");
        assert!(unpacked("a", &whole[..whole.len() - 9]).expect_err("cut off").message.contains("gzip is broken"));
    }
}
