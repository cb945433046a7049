//! The header of a PLY file: what it holds, in which order and how written.

use crate::error::{Error, Place, Result};
use crate::import::mesh;

/// How the values after the header are written.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Type {
    fn named(name: &str) -> Option<Type> {
        Some(match name {
            "char" | "int8" => Type::I8,
            "uchar" | "uint8" => Type::U8,
            "short" | "int16" => Type::I16,
            "ushort" | "uint16" => Type::U16,
            "int" | "int32" => Type::I32,
            "uint" | "uint32" => Type::U32,
            "float" | "float32" => Type::F32,
            "double" | "float64" => Type::F64,
            _ => return None,
        })
    }

    /// Bytes of a value in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Type::I8 | Type::U8 => 1,
            Type::I16 | Type::U16 => 2,
            Type::I32 | Type::U32 | Type::F32 => 4,
            Type::F64 => 8,
        }
    }
}

/// A number, or a list of them that its length precedes.
pub(super) struct Property {
    pub(super) name: String,
    pub(super) length: Option<Type>,
    pub(super) value: Type,
}

pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
}

impl Header {
    /// The header, and where the values begin.
    pub(super) fn read(name: &str, bytes: &[u8]) -> Result<(Header, usize)> {
        // Lines may end as on old Macs, but then a binary file must not be taken for one that ends them otherwise.
        let line_end = if bytes.get(3) == Some(&b'\r') && bytes.get(4) != Some(&b'\n') { b'\r' } else { b'\n' };
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut start = 0;
        while start < bytes.len() {
            let length = bytes[start..].iter().position(|&byte| byte == line_end).unwrap_or(bytes.len() - start);
            let line = String::from_utf8_lossy(&bytes[start..start + length]);
            let fail = |message: String| Err(Error::new(message).with_place(place(name, bytes, start, length)));
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            if start == 0 && words != ["ply"] {
                return fail("a PLY file begins with the line 'ply'".into());
            }
            match words[..] {
                ["end_header"] => {
                    let Some(encoding) = encoding else { return fail("the header has no 'format' line".into()) };
                    return Ok((Header { encoding, elements }, (start + length + 1).min(bytes.len())));
                }
                ["format", word, _version] => match encoding_named(word) {
                    Some(known) => encoding = Some(known),
                    None => return fail(format!("the format '{word}' is none of PLY")),
                },
                ["element", name, count] => match count.parse() {
                    Ok(count) => elements.push(Element { name: name.into(), count, properties: Vec::new() }),
                    Err(_) => return fail(format!("'{count}' is no number of elements")),
                },
                ["property", ref rest @ ..] => match (property(rest), elements.last_mut()) {
                    (Ok(property), Some(element)) => element.properties.push(property),
                    (Ok(_), None) => return fail("this property stands before the first 'element' line".into()),
                    (Err(message), _) => return fail(message),
                },
                ["ply" | "comment" | "obj_info", ..] | [] => {}
                _ => return fail(format!("'{}' is no line of a PLY header", line.trim_end())),
            }
            start += length + 1;
        }
        Err(mesh::unreadable(name, "its header has no end").with_hint("is the file complete?"))
    }
}

fn encoding_named(name: &str) -> Option<Encoding> {
    match name {
        "ascii" => Some(Encoding::Ascii),
        "binary_little_endian" => Some(Encoding::LittleEndian),
        "binary_big_endian" => Some(Encoding::BigEndian),
        _ => None,
    }
}

/// What the words after `property` declare, or what is wrong with them.
fn property(words: &[&str]) -> Result<Property, String> {
    let known = |name| Type::named(name).ok_or_else(|| format!("'{name}' is no type of PLY"));
    match *words {
        ["list", length, value, name] => {
            let length = known(length)?;
            if matches!(length, Type::F32 | Type::F64) {
                return Err("the length of a list must be of a whole type".into());
            }
            Ok(Property { name: name.into(), length: Some(length), value: known(value)? })
        }
        [value, name] => Ok(Property { name: name.into(), length: None, value: known(value)? }),
        _ => Err("a property is declared as 'property TYPE NAME' or 'property list TYPE TYPE NAME'".into()),
    }
}

/// The place of `length` bytes from `start`, in a file that need not be text.
pub(in crate::import) fn place(name: &str, bytes: &[u8], start: usize, length: usize) -> Place {
    let before = &bytes[..start];
    let line_start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    let line = before.iter().filter(|&&byte| byte == b'\n').count() + 1;
    let column = String::from_utf8_lossy(&before[line_start..]).chars().count() + 1;
    Place { file: name.into(), line, column, span: start..start + length }
}
