//! Accessors: lists of vectors of any number type, packed into buffers.

use super::document::{Accessor, Document};
use super::source::{Buffers, missing};
use super::spots::Spots;
use crate::error::Result;

/// The elements of an accessor, read one by one where they lie.
pub(super) struct Elements<'b> {
    pub count: usize,
    /// Numbers an element.
    pub width: usize,
    data: Option<Strided<'b>>,
    component: Component,
    normalized: bool,
    /// Numbers of elements that are replaced, in rising order, and by what.
    sparse: Option<(Vec<u32>, Strided<'b>)>,
}

#[derive(Clone, Copy)]
struct Strided<'b> {
    bytes: &'b [u8],
    stride: usize,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(code: u32) -> Option<Component> {
        Some(match code {
            5120 => Component::I8,
            5121 => Component::U8,
            5122 => Component::I16,
            5123 => Component::U16,
            5125 => Component::U32,
            5126 => Component::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Component::I8 | Component::U8 => 1,
            Component::I16 | Component::U16 => 2,
            Component::U32 | Component::F32 => 4,
        }
    }

    /// The number at the start of `bytes`, and what an integer is divided by to lie within -1..1.
    fn read(self, bytes: &[u8]) -> (f64, f64) {
        let byte = bytes.first().copied().unwrap_or(0);
        let two = bytes.first_chunk().copied().unwrap_or_default();
        let four = bytes.first_chunk().copied().unwrap_or_default();
        match self {
            Component::I8 => (f64::from(byte.cast_signed()), f64::from(i8::MAX)),
            Component::U8 => (f64::from(byte), f64::from(u8::MAX)),
            Component::I16 => (f64::from(i16::from_le_bytes(two)), f64::from(i16::MAX)),
            Component::U16 => (f64::from(u16::from_le_bytes(two)), f64::from(u16::MAX)),
            Component::U32 => (f64::from(u32::from_le_bytes(four)), f64::from(u32::MAX)),
            Component::F32 => (f64::from(f32::from_le_bytes(four)), 1.0),
        }
    }
}

impl Elements<'_> {
    /// Element `index`, which must be below `count`; numbers beyond its width are 0.
    pub(super) fn get<const N: usize>(&self, index: usize) -> [f32; N] {
        let replaced = self.sparse.as_ref().and_then(|(indices, values)| {
            let at = indices.binary_search(&u32::try_from(index).ok()?).ok()?;
            Some((values, at))
        });
        let Some((data, index)) = replaced.or(self.data.as_ref().map(|data| (data, index))) else { return [0.0; N] };
        let size = self.component.size();
        std::array::from_fn(|number| {
            if number >= self.width {
                return 0.0;
            }
            let (value, most) = self.component.read(&data.bytes[index * data.stride + number * size..]);
            // The lowest signed integer is one below the opposite of the highest.
            if self.normalized { (value / most).max(-1.0) as f32 } else { value as f32 }
        })
    }

    /// Element `index` of a list of single whole numbers.
    pub(super) fn index(&self, index: usize) -> u32 {
        let data = self.data.as_ref();
        data.map_or(0, |data| self.component.read(&data.bytes[index * data.stride..]).0 as u32)
    }

    /// Whether these are whole numbers without sign, one an element, as indices are.
    pub(super) fn are_indices(&self) -> bool {
        let unsigned = matches!(self.component, Component::U8 | Component::U16 | Component::U32);
        self.width == 1 && unsigned && self.sparse.is_none() && !self.normalized
    }
}

/// Opens accessor `index`, whose elements must have `widths` numbers. All bytes that it speaks of exist then.
///
/// # Errors
/// An accessor that does not exist, is of another type, or reaches beyond its buffer.
pub(super) fn elements<'b>(
    document: &Document,
    buffers: &'b Buffers,
    spots: &Spots,
    index: usize,
    widths: &[usize],
) -> Result<Elements<'b>> {
    let path = format!("accessors[{index}]");
    let fault = |message: String| spots.fault(&path, message);
    let accessor = document.accessors.get(index).ok_or_else(|| missing(spots, &path, document.accessors.len()))?;
    let component = Component::of(accessor.component_type)
        .ok_or_else(|| fault(format!("there is no component type {}", accessor.component_type)))?;
    let width = width(&accessor.kind).ok_or_else(|| fault(format!("there is no type '{}'", accessor.kind)))?;
    if !widths.contains(&width) {
        return Err(fault(format!("a list of type '{}' cannot stand here", accessor.kind)));
    }
    let size = width * component.size();
    let strided = |view: usize, offset: usize, count: usize, size: usize| -> Result<Strided<'b>> {
        let (bytes, stride) = buffers.view(view, spots)?;
        let stride = stride.unwrap_or(size);
        if stride < size {
            return Err(fault(format!("elements of {size} bytes cannot lie {stride} bytes apart")));
        }
        let needed = match count {
            0 => Some(0),
            _ => stride.checked_mul(count - 1).and_then(|bytes| bytes.checked_add(size)),
        };
        let bytes = bytes.get(offset..).filter(|bytes| needed.is_some_and(|needed| needed <= bytes.len()));
        let bytes = bytes.ok_or_else(|| fault(format!("{count} elements do not lie inside bufferViews[{view}]")))?;
        Ok(Strided { bytes, stride })
    };
    let data = match accessor.buffer_view {
        Some(view) => Some(strided(view, accessor.byte_offset, accessor.count, size)?),
        None => None,
    };
    let sparse = match &accessor.sparse {
        Some(sparse) => {
            let indices = Component::of(sparse.indices.component_type)
                .filter(|component| matches!(component, Component::U8 | Component::U16 | Component::U32))
                .ok_or_else(|| fault("the sparse indices must be whole numbers without sign".into()))?;
            let at = strided(sparse.indices.buffer_view, sparse.indices.byte_offset, sparse.count, indices.size())?;
            let values = strided(sparse.values.buffer_view, sparse.values.byte_offset, sparse.count, size)?;
            let at: Vec<u32> =
                (0..sparse.count).map(|index| indices.read(&at.bytes[index * at.stride..]).0 as u32).collect();
            if !at.is_sorted() || at.last().is_some_and(|&last| last as usize >= accessor.count) {
                return Err(fault("the sparse indices must rise and be less than 'count'".into()));
            }
            Some((at, values))
        }
        None => None,
    };
    check_size(accessor, data.is_some()).map_err(fault)?;
    Ok(Elements { count: accessor.count, width, data, component, normalized: accessor.normalized, sparse })
}

/// A list without data is one of zeros, whose length no bytes vouch for.
fn check_size(accessor: &Accessor, has_data: bool) -> Result<(), String> {
    let replaced = accessor.sparse.as_ref().map_or(0, |sparse| sparse.count);
    if has_data || accessor.count <= 64 * replaced {
        return Ok(());
    }
    Err("it has no data".into())
}

fn width(kind: &str) -> Option<usize> {
    Some(match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        _ => return None,
    })
}
