//! Where the bytes of buffers and pictures come from: the file itself, a `data:` URI, a file beside it.

use std::cell::OnceCell;
use std::io::Read;
use std::path::PathBuf;

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use super::document::{Buffer, BufferView, Document};
use super::spots::Spots;
use crate::error::{Error, Result};
use crate::import::source as ordinary;

/// Takes Base64 with and without its padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// What a URI names.
pub(super) enum Resource {
    /// Bytes that stand in the URI itself.
    Bytes(Vec<u8>),
    /// A file, relative to the scene's folder.
    File(String),
}

/// Resolves a URI of the forms that glTF allows.
///
/// # Errors
/// An address of the network, an absolute path, and broken Base64, as a message without a place.
pub(super) fn resolve(uri: &str) -> Result<Resource, String> {
    if let Some(data) = strip_scheme(uri, "data:") {
        let (kind, data) = data.split_once(',').ok_or("the data URI has no comma")?;
        return match kind.ends_with(";base64") {
            true => {
                BASE64.decode(data).map(Resource::Bytes).map_err(|error| format!("the data URI is broken: {error}"))
            }
            false => Ok(Resource::Bytes(percent_decoded(data))),
        };
    }
    let scheme = uri.find(':').map(|end| &uri[..end]);
    if scheme.is_some_and(|scheme| scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))) {
        return Err(format!("'{}' is not a file beside the scene; fetch it and write its relative path", short(uri)));
    }
    let file = String::from_utf8(percent_decoded(uri)).unwrap_or_else(|_| uri.to_string()).replace('\\', "/");
    if file.starts_with('/') {
        return Err(format!("'{}' is an absolute path; write one relative to the scene's folder", short(uri)));
    }
    Ok(Resource::File(file))
}

fn strip_scheme<'a>(uri: &'a str, scheme: &str) -> Option<&'a str> {
    let (start, rest) = uri.split_at_checked(scheme.len())?;
    start.eq_ignore_ascii_case(scheme).then_some(rest)
}

fn short(uri: &str) -> String {
    match uri.char_indices().nth(80) {
        Some((end, _)) => format!("{}...", &uri[..end]),
        None => uri.to_string(),
    }
}

/// The bytes of a text whose `%20` and the like stand for bytes; what is no such code stays.
fn percent_decoded(text: &str) -> Vec<u8> {
    let digit = |byte: Option<&u8>| byte.and_then(|&byte| char::from(byte).to_digit(16));
    let bytes = text.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        match (bytes[at], digit(bytes.get(at + 1)), digit(bytes.get(at + 2))) {
            (b'%', Some(high), Some(low)) => {
                decoded.push((16 * high + low) as u8);
                at += 3;
            }
            (byte, ..) => {
                decoded.push(byte);
                at += 1;
            }
        }
    }
    decoded
}

/// The buffers of a document, each read when it is first asked for.
pub(super) struct Buffers<'a> {
    buffers: &'a [Buffer],
    views: &'a [BufferView],
    folder: PathBuf,
    binary: Option<&'a [u8]>,
    loaded: Vec<OnceCell<Vec<u8>>>,
}

impl<'a> Buffers<'a> {
    /// `binary` is what the container holds.
    pub(super) fn new(document: &'a Document, folder: PathBuf, binary: Option<&'a [u8]>) -> Buffers<'a> {
        let loaded = document.buffers.iter().map(|_| OnceCell::new()).collect();
        Buffers { buffers: &document.buffers, views: &document.buffer_views, folder, binary, loaded }
    }

    /// How many bytes have been read so far, or lie in the file.
    pub(super) fn size(&self) -> usize {
        self.binary.map_or(0, <[u8]>::len) + self.loaded.iter().filter_map(OnceCell::get).map(Vec::len).sum::<usize>()
    }

    /// The bytes of a view, and its stride.
    ///
    /// # Errors
    /// A view or buffer that does not exist, cannot be read, or is shorter than it should be.
    pub(super) fn view(&self, index: usize, spots: &Spots) -> Result<(&[u8], Option<usize>)> {
        let path = format!("bufferViews[{index}]");
        let view = self.views.get(index).ok_or_else(|| missing(spots, &path, self.views.len()))?;
        let buffer = self.buffer(view.buffer, spots)?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let bytes = end.and_then(|end| buffer.get(view.byte_offset..end)).ok_or_else(|| {
            let message = format!(
                "{} bytes from byte {} on do not lie inside buffer {}, which has {}",
                view.byte_length,
                view.byte_offset,
                view.buffer,
                buffer.len()
            );
            spots.fault(&path, message)
        })?;
        Ok((bytes, view.byte_stride))
    }

    fn buffer(&self, index: usize, spots: &Spots) -> Result<&[u8]> {
        let path = format!("buffers[{index}]");
        let (Some(buffer), Some(cell)) = (self.buffers.get(index), self.loaded.get(index)) else {
            return Err(missing(spots, &path, self.buffers.len()));
        };
        let length = buffer.byte_length;
        let bytes = match (&buffer.uri, self.binary) {
            (None, Some(binary)) if index == 0 => binary,
            (None, _) => return Err(spots.fault(&path, "it has no 'uri', and the file has no binary part for it")),
            (Some(uri), _) => match cell.get() {
                Some(bytes) => bytes,
                None => {
                    let bytes = self.load(uri, length).map_err(|message| spots.fault(&path, message))?;
                    cell.get_or_init(|| bytes)
                }
            },
        };
        bytes.get(..length).ok_or_else(|| {
            spots.fault(&path, format!("it should have {length} bytes, but there are only {}", bytes.len()))
        })
    }

    fn load(&self, uri: &str, length: usize) -> Result<Vec<u8>, String> {
        let file = match resolve(uri)? {
            Resource::Bytes(bytes) => return Ok(bytes),
            Resource::File(file) => self.folder.join(file),
        };
        let failed = |error: std::io::Error| Error::io(&file, "read", &error).message;
        let opened = ordinary::open(&file).map_err(failed)?;
        // Before reading, so that no memory is taken for what will be refused.
        let found = opened.metadata().map_err(failed)?.len();
        if found < length as u64 {
            return Err(format!("'{}' should have {length} bytes, but has {found}", file.display()));
        }
        let mut bytes = Vec::new();
        opened.take(length as u64).read_to_end(&mut bytes).map_err(failed)?;
        Ok(bytes)
    }
}

/// An error about `path`, an element that a list of `count` does not have.
pub(super) fn missing(spots: &Spots, path: &str, count: usize) -> Error {
    let message = match count {
        0 => format!("there is no {path}: the file has none"),
        1 => format!("there is no {path}: the file has only one, number 0"),
        _ => format!("there is no {path}: the file has {count}, numbered from 0"),
    };
    spots.placed(path, Error::new(message))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(uri: &str) -> Vec<u8> {
        match resolve(uri).expect("it resolves") {
            Resource::Bytes(bytes) => bytes,
            Resource::File(file) => panic!("a file: {file}"),
        }
    }

    fn file(uri: &str) -> String {
        match resolve(uri).expect("it resolves") {
            Resource::File(file) => file,
            Resource::Bytes(bytes) => panic!("bytes: {bytes:?}"),
        }
    }

    #[test]
    fn data_stands_in_the_uri_with_or_without_base64_and_padding() {
        assert_eq!(bytes("data:application/octet-stream;base64,AQID/w=="), [1, 2, 3, 255]);
        assert_eq!(bytes("DATA:;base64,AQID/w"), [1, 2, 3, 255]);
        assert_eq!(bytes("data:text/plain,a%20b%zz"), b"a b%zz");
    }

    #[test]
    fn files_are_named_with_blanks_umlauts_and_backslashes() {
        assert_eq!(file("my%20file%C3%A4.bin"), "my fileä.bin");
        assert_eq!(file("../a b.bin"), "../a b.bin");
        assert_eq!(file("textures\\a.png"), "textures/a.png");
        assert_eq!(file("50%.png"), "50%.png");
    }

    #[test]
    fn the_network_and_absolute_paths_are_refused() {
        for uri in ["https://example.org/a.bin", "file:///etc/passwd", "C:\\a.bin", "/etc/passwd", "\\\\server\\a"] {
            assert!(resolve(uri).is_err(), "{uri}");
        }
        assert!(resolve("data:;base64,?").is_err());
        assert!(resolve("data:nothing").is_err());
    }
}
