//! Light by pixel and time in files: a NumPy array with a JSON file beside it, or both in one `.npz`.

use std::io::{self, Cursor, Read, Seek, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::atomic::{check_writable, write_whole, write_whole_by};
use super::npy::{Array, encode_array};
use super::read_whole;
use crate::error::{Error, Place, Result, did_you_mean};
use crate::transient::{Axis, Capture, IndexMode, Phasors, SPEED_OF_LIGHT, Timing, Transient, Unwarp};

/// A file format for a [`Transient`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransientFormat {
    /// `NAME.npy`: `<f4`, `(height, width, bins, 3)`, the top row first; what the axis means is in `NAME.json`.
    Npy,
    /// `NAME.npz`: the same two in one compressed file, as `transient.npy` and `transient.json`.
    Npz,
}

/// The names within an `.npz` file.
pub(super) const ARRAY: &str = "transient.npy";
pub(super) const SIDECAR: &str = "transient.json";

/// Units of length by which the speed of light may be told, in metres.
const UNITS: [(&str, f64); 4] = [("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("km", 1e3)];

/// What stands beside the array, under the names of mitransient where it has them.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Sidecar {
    /// Of this layout.
    #[serde(default = "this_version")]
    version: u32,
    /// Where the first bin begins, in scene units.
    #[serde(default)]
    start_opl: f64,
    /// The width of a bin, in scene units.
    bin_width_opl: f64,
    /// The scene unit, if it has a name.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    unit: Option<String>,
    /// Scene units per second.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    c: Option<f64>,
    #[serde(default = "no_unwarp")]
    unwarp: String,
    #[serde(default = "phase_index")]
    index: String,
    /// Of the array: for people to read.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    shape: Option<[u64; 4]>,
    /// Of a relay wall.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    capture: Option<Capture>,
    /// Which part of the light it is, if not all.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    layer: Option<String>,
    /// Which parts of the light have arrays of their own.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    layers: Vec<String>,
}

/// What an array has of the light, and what others beside it have.
#[derive(Clone, Copy, Default)]
pub(super) struct Layering<'a> {
    /// The layer, if it is not all light.
    pub layer: Option<&'a str>,
    /// The layers that have arrays of their own.
    pub layers: &'a [String],
}

fn this_version() -> u32 {
    1
}

fn no_unwarp() -> String {
    Unwarp::None.name().into()
}

fn phase_index() -> String {
    IndexMode::Phase.name().into()
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

/// Where the axis of the array in `path` stands: beside it, with the extension `.json`.
pub fn sidecar_path(path: &Path) -> PathBuf {
    path.with_extension("json")
}

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
/// Another extension, an axis that is given twice, a layer that is not there, an array of another shape or shorter than its shape, an axis that is missing or makes no sense, or
/// what the operating system says.
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

/// There is no such layer in time; those that there are stand in the sidecar.
fn no_layer(layer: &str, sidecar: Option<Vec<u8>>) -> Error {
    let sidecar: Option<Sidecar> = sidecar.and_then(|text| serde_json::from_slice(&text).ok());
    let known = sidecar.map(|sidecar| sidecar.layers).unwrap_or_default();
    Error::new(format!("there is no layer '{layer}' in time")).with_hint(match known.is_empty() {
        true => "only all light was kept; film.time.layers asks for more".into(),
        false => format!("known are {}", known.join(", ")),
    })
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

/// The JSON beside an array of amplitudes of so many rows and columns.
pub(super) fn encode_phasor_sidecar(
    [height, width]: [usize; 2],
    frequencies: &[f64],
    start: f64,
    layering: Layering<'_>,
) -> Vec<u8> {
    let shape = [height, width, frequencies.len(), 2];
    let mut facts = serde_json::json!({ "frequencies": frequencies, "start_opl": start, "shape": shape });
    if let Some(layer) = layering.layer {
        facts["layer"] = layer.into();
    }
    if !layering.layers.is_empty() {
        facts["layers"] = layering.layers.into();
    }
    format!("{facts:#}\n").into_bytes()
}

pub(super) fn encode_values(transient: &Transient) -> Vec<u8> {
    encode_array(&[transient.height(), transient.width(), transient.bins(), 3], transient.values())
}

/// What is to be known of an array beside its values.
pub(super) struct Facts<'a> {
    pub timing: Timing,
    /// Height, width and bins.
    pub size: [usize; 3],
    pub capture: Option<&'a Capture>,
}

impl<'a> Facts<'a> {
    fn of(transient: &'a Transient) -> Facts<'a> {
        let size = [transient.height(), transient.width(), transient.bins()];
        Facts { timing: *transient.timing(), size, capture: transient.capture() }
    }
}

/// The JSON beside an array.
pub(super) fn encode_sidecar(facts: &Facts<'_>, layering: Layering<'_>) -> Result<Vec<u8>> {
    let (timing, [height, width, bins]) = (facts.timing, facts.size.map(|length| length as u64));
    let unit = UNITS.into_iter().find(|(_, metres)| SPEED_OF_LIGHT / metres == timing.light_speed);
    let sidecar = Sidecar {
        version: this_version(),
        start_opl: timing.axis.start,
        bin_width_opl: timing.axis.bin_width,
        unit: unit.map(|(name, _)| name.into()),
        c: Some(timing.light_speed),
        unwarp: timing.unwarp.name().into(),
        index: timing.index.name().into(),
        shape: Some([height, width, bins, 3]),
        capture: facts.capture.cloned(),
        layer: layering.layer.map(Into::into),
        layers: layering.layers.to_vec(),
    };
    let mut bytes = serde_json::to_vec_pretty(&sidecar)
        .map_err(|error| Error::new(format!("the axis of time cannot be written: {error}")))?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// The axis of time, and how a wall was captured if it is one.
type Meaning = (Timing, Option<Capture>);

fn decode_sidecar(path: &Path, text: &[u8]) -> Result<Meaning> {
    let sidecar: Sidecar = serde_json::from_slice(text).map_err(|error| {
        let place = Place { file: path.into(), line: error.line(), column: error.column(), span: 0..0 };
        let message = error.to_string();
        let message = message.split(" at line ").next().unwrap_or_default();
        Error::new(format!("the file does not tell the axis of time: {message}")).with_place(place)
    })?;
    match timing(&sidecar) {
        Ok(timing) => Ok((timing, sidecar.capture)),
        Err(error) => Err(with_key(error).with_file(path)),
    }
}

/// The key goes into the message, for there is no place to tell.
fn with_key(error: Error) -> Error {
    match &error.key {
        Some(key) => Error { message: format!("'{key}': {}", error.message), ..error },
        None => error,
    }
}

/// What a sidecar says, with the key of what is wrong with it.
fn timing(sidecar: &Sidecar) -> Result<Timing> {
    if sidecar.version != this_version() {
        let message = format!("version {} of this layout is not known, only {}", sidecar.version, this_version());
        return Err(Error::at_key("version", message));
    }
    let light_speed = match (sidecar.c, sidecar.unit.as_deref()) {
        (Some(speed), _) => speed,
        (None, None) => SPEED_OF_LIGHT,
        (None, Some(unit)) => {
            let names = UNITS.map(|(name, _)| name);
            let metres = UNITS.into_iter().find(|(name, _)| *name == unit).map(|(_, metres)| metres);
            SPEED_OF_LIGHT / metres.ok_or_else(|| unknown("unit", unit, &names))?
        }
    };
    let names = Unwarp::ALL.map(Unwarp::name);
    let unwarp = Unwarp::ALL.into_iter().find(|mode| mode.name() == sidecar.unwarp);
    let unwarp = unwarp.ok_or_else(|| unknown("unwarp", &sidecar.unwarp, &names))?;
    let names = IndexMode::ALL.map(IndexMode::name);
    let index = IndexMode::ALL.into_iter().find(|mode| mode.name() == sidecar.index);
    let index = index.ok_or_else(|| unknown("index", &sidecar.index, &names))?;
    let axis = Axis { start: sidecar.start_opl, bin_width: sidecar.bin_width_opl };
    let timing = Timing { axis, unwarp, index, light_speed };
    timing.check()?;
    Ok(timing)
}

fn unknown(key: &str, word: &str, known: &[&str]) -> Error {
    let hint = match did_you_mean(word, known.iter().copied()) {
        Some(near) => format!("did you mean '{near}'?"),
        None => format!("known are {}", known.join(", ")),
    };
    Error::at_key(key, format!("'{word}' is not known")).with_hint(hint)
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

/// Writes what a file holds.
pub(super) type Content<'a> = dyn Fn(&mut dyn Write) -> io::Result<()> + 'a;

/// A file within another.
pub(super) struct Member<'a> {
    pub name: String,
    /// Bytes that it has.
    pub length: u64,
    pub write: Box<Content<'a>>,
}

impl Member<'_> {
    /// With these bytes.
    pub(super) fn of_bytes<'a>(name: &str, bytes: Vec<u8>) -> Member<'a> {
        let length = bytes.len() as u64;
        Member { name: name.into(), length, write: Box::new(move |to| to.write_all(&bytes)) }
    }
}

fn members(transient: &Transient) -> Result<[Member<'_>; 2]> {
    let sidecar = encode_sidecar(&Facts::of(transient), Layering::default())?;
    Ok([Member::of_bytes(ARRAY, encode_values(transient)), Member::of_bytes(SIDECAR, sidecar)])
}

/// The members are written one after the other, so that not all of them need be in memory at once.
pub(super) fn write_npz(to: impl Write + Seek, members: &[Member<'_>]) -> io::Result<()> {
    let mut file = ZipWriter::new(to);
    for Member { name, length, write } in members {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .compression_level(Some(1))
            .large_file(*length > u64::from(u32::MAX));
        file.start_file(name.as_str(), options)?;
        write(&mut file)?;
    }
    file.finish()?;
    Ok(())
}

fn decode_npz(bytes: &[u8], layer: Option<&str>, otherwise: Option<Timing>) -> Result<Transient> {
    let damaged = |error: ZipError| Error::new(format!("the NPZ file is damaged: {error}"));
    let mut file = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
    // Deflate makes at most 1032 bytes of one, and what claims more is not believed.
    let most = (bytes.len() as u64).saturating_mul(1032);
    let mut member = |name: &str| -> Result<Option<Vec<u8>>> {
        let mut member = match file.by_name(name) {
            Err(ZipError::FileNotFound) => return Ok(None),
            found => found.map_err(damaged)?,
        };
        let mut content = Vec::new();
        let read = member.by_ref().take(most).read_to_end(&mut content);
        read.map_err(|error| Error::new(format!("the NPZ file is damaged: {error}")))?;
        Ok(Some(content))
    };
    let meaning = match (member(SIDECAR)?, otherwise) {
        (Some(_), Some(_)) => return Err(known_axis(Path::new(SIDECAR))),
        (Some(text), None) => decode_sidecar(Path::new(SIDECAR), &text)?,
        (None, Some(timing)) => (timing, None),
        (None, None) => {
            return Err(Error::new(format!("the NPZ file does not say what its bins are: it has no {SIDECAR}"))
                .with_hint("give --bin-width"));
        }
    };
    if let Some(layer) = layer {
        let array = match member(&member_of(layer))? {
            Some(array) => array,
            None => return Err(no_layer(layer, member(SIDECAR)?)),
        };
        return decode_values(&array, meaning);
    }
    let array = member(ARRAY)?.ok_or_else(|| {
        Error::new(format!("the NPZ file has no {ARRAY}")).with_hint("save it by np.savez(file, transient=array)")
    })?;
    decode_values(&array, meaning)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn timing() -> impl Strategy<Value = Timing> {
        let modes = (proptest::sample::select(&Unwarp::ALL[..]), proptest::sample::select(&IndexMode::ALL[..]));
        let speed = prop_oneof![Just(SPEED_OF_LIGHT), Just(SPEED_OF_LIGHT * 1e3), 1e-3f64..1e20];
        (-1e3f64..1e3, 1e-9f64..1e3, modes, speed).prop_map(|(start, bin_width, (unwarp, index), light_speed)| Timing {
            axis: Axis { start, bin_width },
            unwarp,
            index,
            light_speed,
        })
    }

    fn transient() -> impl Strategy<Value = Transient> {
        ((1usize..6, 1usize..6, 1usize..9), timing()).prop_flat_map(|(size, timing)| {
            let value = prop_oneof![Just(0.0f32), 0.0f32..1e6, Just(f32::INFINITY), Just(-1.5)];
            proptest::collection::vec(value, size.0 * size.1 * size.2 * 3)
                .prop_map(move |values| Transient::from_values(size, timing, values).expect("as many as the size says"))
        })
    }

    /// What becomes of a file's bytes, without the disk.
    fn decode(format: TransientFormat, bytes: &[u8]) -> Result<Transient> {
        match format {
            TransientFormat::Npy => decode_values(bytes, (Timing::new(0.0, 1.0), None)),
            TransientFormat::Npz => decode_npz(bytes, None, None),
        }
    }

    fn sample() -> Transient {
        let values = (0..36).map(|i| i as f32 * 0.5).collect();
        Transient::from_values((2, 3, 2), Timing::new(1.5, 0.25), values).expect("36 values")
    }

    fn encode_npz(transient: &Transient) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        write_npz(&mut file, &members(transient).expect("an axis")).expect("memory");
        file.into_inner()
    }

    fn files() -> [(TransientFormat, Vec<u8>); 2] {
        let npz = encode_npz(&sample());
        [(TransientFormat::Npy, encode_values(&sample())), (TransientFormat::Npz, npz)]
    }

    proptest! {
        #[test]
        fn files_give_back_every_bit(transient in transient()) {
            let folder = tempfile::tempdir().expect("a folder");
            for name in ["a.npy", "a.NPZ"] {
                let path = folder.path().join(name);
                write_transient(&path, &transient).expect("written");
                prop_assert_eq!(&read_transient(&path, None, None).expect("read"), &transient);
            }
        }

        #[test]
        fn damaged_files_do_not_panic(
            which in 0usize..2,
            damage in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..6),
            cut in any::<proptest::sample::Index>(),
        ) {
            let (format, mut bytes) = files()[which].clone();
            for (at, value) in damage {
                let length = bytes.len();
                bytes[at.index(length)] = value;
            }
            let _ = decode(format, &bytes);
            bytes.truncate(cut.index(bytes.len()));
            let _ = decode(format, &bytes);
        }

        #[test]
        fn arbitrary_sidecars_do_not_panic(bytes in proptest::collection::vec(any::<u8>(), 0..60)) {
            let _ = decode_sidecar(Path::new("a.json"), &bytes);
        }
    }

    #[test]
    fn a_file_cut_short_anywhere_is_an_error() {
        for (format, bytes) in files() {
            for length in 0..bytes.len() {
                assert!(decode(format, &bytes[..length]).is_err(), "{format:?} cut to {length} of {}", bytes.len());
            }
        }
    }

    #[test]
    fn the_array_is_that_of_numpy() {
        let bytes = encode_values(&sample());
        let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2, 2, 3), }";
        assert_eq!(&bytes[10..10 + text.len()], text.as_bytes());
        assert_eq!(bytes.len(), 128 + 36 * 4);
    }

    #[test]
    fn one_channel_fills_three() {
        for shape in [&[1, 1, 2][..], &[1, 1, 2, 1]] {
            let read = decode(TransientFormat::Npy, &encode_array(shape, &[1.0, 2.0])).expect("valid");
            assert_eq!(read.profile(0, 0), [[1.0; 3], [2.0; 3]]);
        }
    }

    #[test]
    fn sizes_that_the_bytes_cannot_hold_are_refused() {
        for shape in [[1 << 20, 1 << 20, 1 << 20, 3], [1 << 31, 1, 1, 3], [1, 1, 2, 3]] {
            let error = decode(TransientFormat::Npy, &encode_array(&shape, &[0.0; 3])).expect_err("too short");
            assert!(error.message.contains("too short"), "{error}");
        }
        assert!(decode(TransientFormat::Npy, &encode_array(&[0, 1, 1, 3], &[])).is_err());
    }

    #[test]
    fn sidecars_say_what_is_wrong_with_them() {
        let read = |text: &str| decode_sidecar(Path::new("a.json"), text.as_bytes()).map(|(timing, _)| timing);
        let millimetres = read(r#"{"bin_width_opl": 3, "unit": "mm"}"#).expect("valid");
        assert_eq!(millimetres, Timing { light_speed: SPEED_OF_LIGHT / 1e-3, ..Timing::new(0.0, 3.0) });
        for (text, expected) in [
            ("", "a.json:1:0: the file does not tell the axis of time"),
            ("{\n\"start_opl\": 0}", "bin_width_opl"),
            (r#"{"bin_width_opl": 0}"#, "'bin_width_opl': the width of a bin"),
            (r#"{"bin_width_opl": 1, "unwarp": "last_segmnt"}"#, "did you mean 'last_segment'?"),
            (r#"{"bin_width_opl": 1, "unit": "parsec"}"#, "known are m, cm, mm, km"),
            (r#"{"bin_width_opl": 1, "c": -1}"#, "speed of light"),
            (r#"{"bin_width_opl": 1, "version": 9}"#, "version 9"),
            (r#"{"bin_width": 1}"#, "unknown field `bin_width`"),
        ] {
            let error = read(text).expect_err(text).to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }

    #[test]
    fn the_capture_of_a_wall_stays_with_its_light_and_must_fit_it() {
        let row = |y: f64| (0..2).map(|x| [f64::from(x), y, 0.1]).collect::<Vec<_>>();
        let grid: Vec<_> = (0..3).map(|y| row(f64::from(y))).collect();
        let capture = Capture {
            sensor_xyz: Some([0.0, 0.1, 1.0]),
            laser_xyz: None,
            sensor_grid_xyz: grid.clone(),
            sensor_grid_normals: grid.clone(),
            laser_grid_xyz: vec![vec![[0.0; 3]]],
            laser_grid_normals: vec![vec![[0.0, 0.0, 1.0]]],
            t_accounts_first_and_last_bounces: false,
        };
        let transient = sample().with_capture(capture.clone()).expect("it fits");
        let npz = encode_npz(&transient);
        assert_eq!(decode(TransientFormat::Npz, &npz).expect("read").capture(), Some(&capture));
        for broken in [
            Capture { sensor_grid_xyz: grid[..2].to_vec(), ..capture.clone() },
            Capture { laser_grid_xyz: grid.clone(), ..capture.clone() },
            Capture { sensor_grid_normals: vec![vec![[f64::NAN; 3]; 2]; 3], ..capture.clone() },
            Capture { t_accounts_first_and_last_bounces: true, ..capture.clone() },
        ] {
            assert!(sample().with_capture(broken.clone()).is_err(), "{broken:?}");
        }
    }

    #[test]
    fn phasors_are_real_and_imaginary_parts() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("p.npy");
        write_phasors(&path, &sample().phasors(&[0.5]).expect("finite")).expect("written");
        assert_eq!(Array::of(&read_whole(&path).expect("there")).expect("an array").shape, [3, 2, 1, 2]);
        let facts = String::from_utf8(read_whole(&sidecar_path(&path)).expect("there")).expect("text");
        assert!(facts.contains("\"frequencies\": [\n    0.5\n  ]"), "{facts}");
        assert!(write_phasors(Path::new("a.npz"), &sample().phasors(&[0.5]).expect("finite")).is_err());
    }

    #[test]
    fn an_array_without_an_axis_takes_the_one_that_is_given_or_none() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        std::fs::write(&path, encode_values(&sample())).expect("written");
        let error = read_transient(&path, None, None).expect_err("no axis");
        assert!(error.to_string().contains("there is no") && error.to_string().contains("--bin-width"), "{error}");
        let timing = Timing::new(7.0, 0.5);
        assert_eq!(*read_transient(&path, None, Some(timing)).expect("read").timing(), timing);
    }
}
