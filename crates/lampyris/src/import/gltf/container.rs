//! The two coats of a glTF file: bare JSON, and the binary container `.glb`.

use crate::error::{Error, Result};

/// A file taken apart.
pub(super) struct Container<'a> {
    pub json: &'a [u8],
    /// The first buffer, which a `.glb` may hold.
    pub binary: Option<&'a [u8]>,
    /// Whether the JSON is the file itself, so that lines and columns mean something.
    pub is_text: bool,
}

/// Takes a file apart. What it is is told by its first bytes, whatever it is called.
///
/// # Errors
/// A `.glb` that is cut short, of another version, or whose chunks do not lie inside it.
pub(super) fn open(bytes: &[u8]) -> Result<Container<'_>> {
    if !bytes.starts_with(b"glTF") {
        // A byte order mark is against the rules and harmless.
        let json = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        return Ok(Container { json, binary: None, is_text: true });
    }
    let word = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(cut_short(bytes.len(), 12));
    };
    if version != 2 {
        return Err(Error::new(format!("the binary glTF is of version {version}; only version 2 can be read")));
    }
    let length = length as usize;
    let Some(content) = bytes.get(12..length) else { return Err(cut_short(bytes.len(), length)) };
    let (kind, json, rest) = chunk(content)?;
    if kind != *b"JSON" {
        return Err(Error::new("the first chunk of the binary glTF is not JSON"));
    }
    let binary = match rest {
        [] => None,
        rest => match chunk(rest)? {
            (kind, binary, _) if kind == *b"BIN\0" => Some(binary),
            _ => None,
        },
    };
    Ok(Container { json: without_padding(json), binary, is_text: false })
}

fn cut_short(found: usize, declared: usize) -> Error {
    Error::new(format!("the binary glTF is cut short: it has {found} bytes of {}", declared.max(12)))
}

/// The kind and content of the first chunk, and what follows it.
fn chunk(bytes: &[u8]) -> Result<([u8; 4], &[u8], &[u8])> {
    let short = || Error::new("a chunk of the binary glTF does not fit into it");
    let (length, rest) = bytes.split_first_chunk::<4>().ok_or_else(short)?;
    let (kind, rest) = rest.split_first_chunk::<4>().ok_or_else(short)?;
    let (content, rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or_else(short)?;
    Ok((*kind, content, rest))
}

/// Some writers fill up with zeros in place of blanks.
fn without_padding(json: &[u8]) -> &[u8] {
    let end = json.iter().rposition(|&byte| byte != 0).map_or(0, |at| at + 1);
    &json[..end]
}
