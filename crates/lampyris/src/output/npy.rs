//! NumPy arrays: a Python dictionary that describes the array, then its values.

use ::exr::prelude::f16;

use super::limits::check_size;
use crate::error::{Error, Result};
use crate::image::Image;

const MAGIC: &[u8] = b"\x93NUMPY";

/// Little-endian 32-bit floats of shape (height, width, 3), the top row first.
pub(super) fn encode(image: &Image) -> Vec<u8> {
    encode_array(&[image.height(), image.width(), 3], bytemuck::cast_slice(image.pixels()))
}

/// Little-endian 32-bit floats of any shape of two axes or more, row-major.
pub(super) fn encode_array(shape: &[usize], values: &[f32]) -> Vec<u8> {
    let mut bytes = encode_header(shape);
    bytes.reserve_exact(size_of_val(values));
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// What comes before the values of such an array.
pub(super) fn encode_header(shape: &[usize]) -> Vec<u8> {
    let shape = shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({shape}), }}");
    // The values begin at a multiple of 64 bytes; the header before them ends in a line feed.
    let before = MAGIC.len() + 4;
    header.push_str(&" ".repeat((before + header.len() + 1).next_multiple_of(64) - before - header.len() - 1));
    header.push('\n');
    let mut bytes = Vec::with_capacity(before + header.len());
    bytes.extend(MAGIC);
    bytes.extend([1, 0]);
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.into_bytes());
    bytes
}

/// Reads arrays of 16-, 32- or 64-bit floats of shape (height, width, 3) or (height, width).
pub(super) fn decode(bytes: &[u8]) -> Result<Image> {
    let array = Array::of(bytes)?;
    let (height, width, channels) = match array.shape[..] {
        [height, width] => (height, width, 1),
        [height, width, 3] => (height, width, 3),
        _ => {
            let shape = &array.shape;
            let hint = match shape[..] {
                [_, _, _, 1 | 3] => "it may be light by pixel and time, which 'lampyris transient' reads",
                _ => "a picture is (height, width, 3) or (height, width)",
            };
            return Err(Error::new(format!("an NPY array of shape {shape:?} is no picture")).with_hint(hint));
        }
    };
    let (width, height) = check_size(width, height, (array.data.len() / (array.sample.bytes() * channels)) as u64)?;
    let mut image = Image::new(width, height);
    let mut values = array.values();
    for pixel in image.pixels_mut() {
        // Every value is there, or the size would not have passed.
        let first = values.next().unwrap_or(0.0);
        *pixel = [first; 3];
        for value in pixel.iter_mut().take(channels).skip(1) {
            *value = values.next().unwrap_or(0.0);
        }
    }
    Ok(image)
}

/// An array as its file has it.
pub(super) struct Array<'a> {
    /// As the file claims it; the data may be too short for it.
    pub(super) shape: Vec<u64>,
    sample: Sample,
    data: &'a [u8],
}

impl Array<'_> {
    /// Reads the header of an array of 16-, 32- or 64-bit floats.
    pub(super) fn of(bytes: &[u8]) -> Result<Array<'_>> {
        if !bytes.starts_with(MAGIC) {
            return Err(Error::new("not an array of NumPy"));
        }
        let (header, data) = split(bytes)?;
        let sample = Sample::of(entry(header, "descr")?.trim_matches(['\'', '"']))?;
        if entry(header, "fortran_order")? != "False" {
            return Err(Error::new("the NPY array is in Fortran order").with_hint("save np.ascontiguousarray(array)"));
        }
        Ok(Array { shape: shape(entry(header, "shape")?)?, sample, data })
    }

    /// The values that are there, in the order of the file.
    pub(super) fn values(&self) -> impl ExactSizeIterator<Item = f32> {
        self.data.chunks_exact(self.sample.bytes()).map(|bytes| self.sample.value(bytes))
    }
}

/// How a value is stored.
#[derive(Clone, Copy)]
enum Sample {
    Half,
    Single,
    Double,
}

impl Sample {
    fn of(descr: &str) -> Result<Sample> {
        match descr {
            "<f2" => Ok(Sample::Half),
            "<f4" => Ok(Sample::Single),
            "<f8" => Ok(Sample::Double),
            _ => Err(Error::new(format!("the NPY array holds values of type '{descr}'"))
                .with_hint("save array.astype('<f4'); little-endian f2, f4 and f8 are read")),
        }
    }

    fn bytes(self) -> usize {
        match self {
            Sample::Half => 2,
            Sample::Single => 4,
            Sample::Double => 8,
        }
    }

    fn value(self, b: &[u8]) -> f32 {
        match self {
            Sample::Half => f16::from_le_bytes([b[0], b[1]]).to_f32(),
            Sample::Single => f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
            Sample::Double => f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]) as f32,
        }
    }
}

/// The dictionary and the values.
fn split(bytes: &[u8]) -> Result<(&str, &[u8])> {
    let cut = || Error::new("the NPY file ends within its header");
    let rest = &bytes[MAGIC.len()..];
    let (length, start) = match rest {
        [1, _, a, b, ..] => (u16::from_le_bytes([*a, *b]) as usize, 4),
        [2 | 3, _, a, b, c, d, ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, 6),
        [version, _, _, _, ..] if *version > 3 => {
            return Err(Error::new(format!("version {version} of NPY is not known")));
        }
        _ => return Err(cut()),
    };
    let rest = &rest[start..];
    if rest.len() < length {
        return Err(cut());
    }
    let header = std::str::from_utf8(&rest[..length]).map_err(|_| Error::new("the NPY header is not text"))?;
    Ok((header, &rest[length..]))
}

/// What stands after `'key':`, up to the comma, or up to the closing bracket where one opens.
fn entry<'a>(header: &'a str, key: &str) -> Result<&'a str> {
    let found = || {
        let after = [format!("'{key}'"), format!("\"{key}\"")]
            .iter()
            .find_map(|quoted| header.split_once(quoted.as_str()))?
            .1
            .trim_start()
            .strip_prefix(':')?
            .trim_start();
        let end = if after.starts_with('(') { after.find(')')? + 1 } else { after.find([',', '}'])? };
        Some(after[..end].trim_end())
    };
    found().ok_or_else(|| Error::new(format!("the NPY header has no '{key}'")))
}

fn shape(tuple: &str) -> Result<Vec<u64>> {
    let numbers = tuple.trim_matches(['(', ')']).split(',').map(str::trim).filter(|word| !word.is_empty());
    let shape: Result<Vec<u64>, _> = numbers.map(str::parse).collect();
    shape.map_err(|_| Error::new(format!("the NPY header has no shape that we understand: {tuple}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(dictionary: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend((dictionary.len() as u16).to_le_bytes());
        bytes.extend(dictionary.as_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn the_header_is_what_numpy_writes() {
        let bytes = encode(&Image::new(2, 1));
        assert_eq!(&bytes[..10], b"\x93NUMPY\x01\x00\x76\x00");
        let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3), }";
        assert_eq!(&bytes[10..10 + text.len()], text.as_bytes());
        assert_eq!((bytes[127], bytes.len()), (b'\n', 128 + 24));
    }

    #[test]
    fn halves_and_doubles_are_read_and_grey_fills_the_channels() {
        let halves = [0x00, 0x3c, 0x00, 0xc0]; // 1, −2
        let dictionary = "{'descr': '<f2', 'fortran_order': False, 'shape': (2, 1)}";
        let image = decode(&file(dictionary, &halves)).expect("valid");
        assert_eq!((image.width(), image.height()), (1, 2));
        assert_eq!(image.pixels(), [[1.0; 3], [-2.0; 3]]);

        let doubles: Vec<u8> = [1.5f64, 2.5, 3.5].iter().flat_map(|v| v.to_le_bytes()).collect();
        let dictionary = "{\"shape\": (1,1,3,), \"fortran_order\": False, \"descr\": \"<f8\"}";
        assert_eq!(decode(&file(dictionary, &doubles)).expect("valid").pixels(), [[1.5, 2.5, 3.5]]);
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        for (dictionary, expected) in [
            ("{'descr': '>f4', 'fortran_order': False, 'shape': (1, 1, 3)}", "'>f4'"),
            ("{'descr': '<f4', 'fortran_order': True, 'shape': (1, 1, 3)}", "Fortran"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 8, 3)}", "[1, 1, 8, 3]"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3)}", "too short"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (4000000000, 4000000000, 3)}", "too large"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 99999999999999999999)}", "shape"),
            ("{'descr': '<f4', 'fortran_order': False}", "no 'shape'"),
        ] {
            let error = decode(&file(dictionary, &[0; 12])).expect_err(dictionary);
            assert!(error.message.contains(expected), "{dictionary}: {error}");
        }
    }
}
