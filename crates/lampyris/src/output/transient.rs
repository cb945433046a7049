//! Light by pixel and time in files: a NumPy array with a JSON file beside it, or both in one `.npz`.

#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use super::atomic::{check_writable, write_whole, write_whole_by};
use super::npy::{Array, encode_array};
use super::npz::{Archive, Member, write_npz};
use super::read_whole;
use super::sidecar::{
    Facts, Layering, Meaning, decode_sidecar, encode_phasor_sidecar, encode_sidecar, no_layer, sidecar_path, with_key,
};
use crate::error::{Error, Result};
use crate::transient::{Phasors, Timing, Transient};

/// A file format for a [`Transient`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransientFormat {
    /// `NAME.npy`: `<f4`, `(height, width, bins, 3)`, the top row first; what the axis means is in `NAME.json`.
    Npy,
    /// `NAME.npz`: the same two in one compressed file, as `transient.npy` and `transient.json`.
    Npz,
}

impl TransientFormat {
    /// The format that the extension of `path` names, in either case.
    ///
    /// # Errors
    /// Any other extension.
    pub fn of(path: &Path) -> Result<TransientFormat> {
        match path.extension().unwrap_or_default().to_string_lossy().to_lowercase().as_str() {
            "npy" => Ok(TransientFormat::Npy),
            "npz" => Ok(TransientFormat::Npz),
            _ => Err(Error::new(format!("'{}' names no file for light by pixel and time", path.display()))
                .with_hint("known are .npy, with a .json beside it, and .npz")),
        }
    }
}

/// The names within an `.npz` file.
pub(super) const ARRAY: &str = "transient.npy";
pub(super) const SIDECAR: &str = "transient.json";

/// Where the array of a layer in time stands, beside that of all light in `path`: `NAME.LAYER.npy`.
pub(super) fn layer_path(path: &Path, layer: &str) -> PathBuf {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_extension(format!("{layer}.{extension}"))
}

/// The array of a layer in time within an `.npz`.
pub(super) fn member_of(layer: &str) -> String {
    format!("{layer}.npy")
}

/// Finds what would stop [`write_transient`] from writing to `path`.
///
/// # Errors
/// As [`write_transient`], except that a disk may still fill up.
pub fn check_transient_path(path: &Path) -> Result<()> {
    if TransientFormat::of(path)? == TransientFormat::Npy {
        check_writable(&sidecar_path(path))?;
    }
    check_writable(path)
}

/// Writes light by pixel and time in the format that the extension of `path` names, each file whole or not at all.
///
/// # Errors
/// Another extension than `.npy` and `.npz`, or what the operating system says.
pub fn write_transient(path: &Path, transient: &Transient) -> Result<()> {
    match TransientFormat::of(path)? {
        TransientFormat::Npy => {
            // The array comes last: whoever sees it appear finds what it means.
            write_whole(&sidecar_path(path), &encode_sidecar(&Facts::of(transient), Layering::default())?)?;
            write_whole(path, &encode_values(transient))
        }
        TransientFormat::Npz => {
            let members = members(transient)?;
            write_whole_by(path, |file| write_npz(file, &members))
        }
    }
}

/// Reads what [`write_transient`] writes, and arrays of others: `(height, width, bins, channels)` with 3 channels or 1, or
/// `(height, width, bins)`, of 16-, 32- or 64-bit floats. One channel fills all three. `otherwise` is the axis of an array
/// that has no file beside it; `layer` names a part of the light that has an array of its own.
///
/// # Errors
/// Another extension, an axis that is given twice, a layer that is not there, an array of another shape or shorter than its
/// shape, an axis that is missing or makes no sense, or what the operating system says.
pub fn read_transient(path: &Path, layer: Option<&str>, otherwise: Option<Timing>) -> Result<Transient> {
    match TransientFormat::of(path)? {
        TransientFormat::Npy => {
            let own = layer.map(|layer| layer_path(path, layer));
            if let (Some(layer), Some(own)) = (layer, &own)
                && !own.exists()
            {
                return Err(no_layer(layer, read_whole(&sidecar_path(path)).ok()).with_file(path));
            }
            let path = own.as_deref().unwrap_or(path);
            let sidecar = sidecar_path(path);
            let bytes = read_whole(path)?;
            let meaning = match (read_whole(&sidecar), otherwise) {
                (Ok(_), Some(_)) => return Err(known_axis(&sidecar)),
                (Ok(text), None) => decode_sidecar(&sidecar, &text)?,
                (Err(_), Some(timing)) if !sidecar.exists() => (timing, None),
                (Err(error), _) if sidecar.exists() => return Err(error),
                (Err(_), _) => return Err(no_axis(path, &sidecar)),
            };
            decode_values(&bytes, meaning).map_err(|error| error.with_file(path))
        }
        TransientFormat::Npz => decode_npz(&read_whole(path)?, layer, otherwise).map_err(|error| error.with_file(path)),
    }
}

fn known_axis(sidecar: &Path) -> Error {
    Error::new(format!("'{}' tells what the bins are already", sidecar.display()))
        .with_hint("leave --bin-width out, or change the file")
}

fn no_axis(path: &Path, sidecar: &Path) -> Error {
    Error::new(format!("'{}' does not say what its bins are: there is no '{}'", path.display(), sidecar.display()))
        .with_hint("write {\"start_opl\": 0, \"bin_width_opl\": 0.003} there, or give --bin-width")
}

/// Writes complex amplitudes as `.npy`: `<f4`, `(height, width, frequencies, 2)`, real and imaginary parts, with the
/// frequencies, in cycles per scene unit, in a `.json` of the same name. Each file is written whole or not at all.
///
/// # Errors
/// Another extension than `.npy`, or what the operating system says.
pub fn write_phasors(path: &Path, phasors: &Phasors) -> Result<()> {
    if TransientFormat::of(path)? != TransientFormat::Npy {
        return Err(Error::new(format!("'{}' names no file for phasors", path.display())).with_hint("known is .npy"));
    }
    let Phasors { width, height, frequencies, start, values } = phasors;
    let size = [*height, *width];
    write_whole(&sidecar_path(path), &encode_phasor_sidecar(size, frequencies, *start, Layering::default()))?;
    write_whole(path, &encode_array(&[*height, *width, frequencies.len(), 2], values))
}

fn encode_values(transient: &Transient) -> Vec<u8> {
    encode_array(&[transient.height(), transient.width(), transient.bins(), 3], transient.values())
}

/// The values of an array, once its size is that of its data.
fn decode_values(bytes: &[u8], (timing, capture): Meaning) -> Result<Transient> {
    let array = Array::of(bytes)?;
    let (size, channels) = match array.shape[..] {
        [height, width, bins] | [height, width, bins, 1] => ([height, width, bins], 1),
        [height, width, bins, 3] => ([height, width, bins], 3),
        _ => {
            return Err(Error::new(format!("an NPY array of shape {:?} is not light by pixel and time", array.shape))
                .with_hint("it must be (height, width, bins, channels), with 3 channels or 1"));
        }
    };
    let count = size.into_iter().chain([channels]).try_fold(1, u64::checked_mul);
    if count.is_none_or(|count| count > array.values().len() as u64) {
        return Err(Error::new(format!("the file is too short for an array of shape {:?}", array.shape))
            .with_hint("it may have been cut off in a copy"));
    }
    let [height, width, bins] = size.map(|length| length as usize);
    let count = count.unwrap_or(0) as usize;
    let values = match channels {
        1 => array.values().take(count).flat_map(|value| [value; 3]).collect(),
        _ => array.values().take(count).collect(),
    };
    let transient = Transient::from_values((width, height, bins), timing, values)?;
    match capture {
        Some(capture) => transient.with_capture(capture).map_err(with_key),
        None => Ok(transient),
    }
}

fn members(transient: &Transient) -> Result<[Member<'_>; 2]> {
    let sidecar = encode_sidecar(&Facts::of(transient), Layering::default())?;
    Ok([Member::of_bytes(ARRAY, encode_values(transient)), Member::of_bytes(SIDECAR, sidecar)])
}

fn decode_npz(bytes: &[u8], layer: Option<&str>, otherwise: Option<Timing>) -> Result<Transient> {
    let mut file = Archive::of(bytes)?;
    let meaning = match (file.member(SIDECAR)?, otherwise) {
        (Some(_), Some(_)) => return Err(known_axis(Path::new(SIDECAR))),
        (Some(text), None) => decode_sidecar(Path::new(SIDECAR), &text)?,
        (None, Some(timing)) => (timing, None),
        (None, None) => {
            return Err(Error::new(format!("the NPZ file does not say what its bins are: it has no {SIDECAR}"))
                .with_hint("give --bin-width"));
        }
    };
    if let Some(layer) = layer {
        let array = match file.member(&member_of(layer))? {
            Some(array) => array,
            None => return Err(no_layer(layer, file.member(SIDECAR)?)),
        };
        return decode_values(&array, meaning);
    }
    let array = file.member(ARRAY)?.ok_or_else(|| {
        Error::new(format!("the NPZ file has no {ARRAY}")).with_hint("save it by np.savez(file, transient=array)")
    })?;
    decode_values(&array, meaning)
}
