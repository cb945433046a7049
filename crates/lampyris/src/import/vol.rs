//! Mitsuba's `.vol` grids, version 3: numbers in a box.

use super::mesh::unreadable;
use crate::error::Result;
use crate::medium::VolumeData;

/// The mark, the version, five whole numbers and six for the box.
const HEADER: usize = 4 + 5 * 4 + 6 * 4;

/// Reads the file `name` (used in messages alone) from its bytes.
///
/// # Errors
/// If it is not what it says: a wrong mark or version, another encoding than single-precision numbers, other channels than one
/// or three, fewer bytes than its size takes, or a number that is negative or not finite.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<VolumeData> {
    let fault = |reason: String| Err(unreadable(name, reason));
    let (Some(header), Some(b"VOL")) = (bytes.get(..HEADER), bytes.get(..3)) else {
        return fault("it does not begin as a .vol file does".into());
    };
    if header[3] != 3 {
        return fault(format!("its version is {}, and only 3 is known", header[3]));
    }
    let word = |index: usize| std::array::from_fn(|byte| header[4 + 4 * index + byte]);
    let [encoding, nx, ny, nz, channels] = [0, 1, 2, 3, 4].map(|index| i32::from_le_bytes(word(index)));
    if encoding != 1 {
        return fault(format!("its encoding is {encoding}, and only 1, single-precision numbers, is known"));
    }
    if channels != 1 && channels != 3 {
        return fault(format!("it has {channels} channels, and only 1 or 3 are known"));
    }
    let sides = [nx, ny, nz].map(|side| u32::try_from(side).ok().filter(|&side| side > 0));
    let [Some(nx), Some(ny), Some(nz)] = sides else {
        return fault(format!("its size is {nx} × {ny} × {nz}"));
    };
    let count = [ny, nz, channels as u32, 4]
        .into_iter()
        .try_fold(u64::from(nx), |product, side| product.checked_mul(u64::from(side)));
    let rest = &bytes[HEADER..];
    if count != Some(rest.len() as u64) {
        let promised = count.map_or("more bytes than there can be".into(), |count| format!("{count} bytes"));
        return fault(format!("its size of {nx} × {ny} × {nz} takes {promised}, and there are {}", rest.len()))
            .map_err(|error: crate::error::Error| error.with_hint("is the file complete?"));
    }
    let float = |bytes: [u8; 4]| f32::from_le_bytes(bytes);
    let bounds = [5, 8].map(|first| [0, 1, 2].map(|axis| float(word(first + axis))));
    let (quads, _) = rest.as_chunks::<4>();
    let values: Vec<f32> = quads.iter().map(|&bytes| float(bytes)).collect();
    if let Some(value) = values.iter().find(|value| !value.is_finite() || **value < 0.0) {
        return fault(format!("it holds {value}, which is no density"));
    }
    Ok(VolumeData { size: [nx, ny, nz], channels: channels as u32, bounds, values })
}

/// The bytes of a file that [`read`] reads.
pub(super) fn write(data: &VolumeData) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    let [nx, ny, nz] = data.size;
    [1, nx, ny, nz, data.channels].iter().for_each(|word| bytes.extend(word.to_le_bytes()));
    data.bounds.iter().flatten().chain(&data.values).for_each(|value| bytes.extend(value.to_le_bytes()));
    bytes
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn file(size: [i32; 3], channels: u32, values: &[f32]) -> Vec<u8> {
        let (size, bounds) = (size.map(|side| side as u32), [[0.0; 3], [1.0, 2.0, 3.0]]);
        write(&VolumeData { size, channels, bounds, values: values.to_vec() })
    }

    #[test]
    fn a_grid_is_read_as_it_was_written() {
        let data = read("a.vol", &file([2, 1, 2], 1, &[1.0, 2.0, 3.0, 4.0])).expect("a grid");
        assert_eq!((data.size, data.channels), ([2, 1, 2], 1));
        assert_eq!(data.bounds, [[0.0; 3], [1.0, 2.0, 3.0]]);
        assert_eq!(data.values, [1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn what_is_not_what_it_says_is_told() {
        for (bytes, word) in [
            (b"VOL".to_vec(), "begin"),
            (file([2, 2, 2], 1, &[0.0; 7]), "takes"),
            (file([2, 2, 2], 1, &[0.0; 9]), "takes"),
            (file([i32::MAX, i32::MAX, i32::MAX], 3, &[]), "takes"),
            (file([0, 2, 2], 1, &[]), "size"),
            (file([-1, 2, 2], 1, &[]), "size"),
            (file([1, 1, 1], 2, &[0.0; 2]), "channels"),
            (file([1, 1, 1], 1, &[-0.5]), "density"),
            (file([1, 1, 1], 1, &[f32::NAN]), "density"),
        ] {
            let error = read("a.vol", &bytes).expect_err("a fault");
            assert!(error.to_string().contains(word), "{error}");
        }
    }

    proptest! {
        #[test]
        fn damaged_files_never_panic(at in 0_usize..64, byte in any::<u8>(), cut in 0_usize..80) {
            let mut bytes = file([2, 1, 2], 1, &[1.0, 2.0, 3.0, 4.0]);
            if let Some(place) = bytes.get_mut(at) {
                *place = byte;
            }
            bytes.truncate(bytes.len() - cut.min(bytes.len()));
            let _ = read("a.vol", &bytes);
        }
    }
}
