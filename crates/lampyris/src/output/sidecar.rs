//! What stands beside an array of light by pixel and time: a JSON file that says what its axes mean.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::{Error, Place, Result, did_you_mean};
use crate::transient::{Axis, Capture, IndexMode, SPEED_OF_LIGHT, Timing, Transient, Unwarp};

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

/// Where the axis of the array in `path` stands: beside it, with the extension `.json`.
pub fn sidecar_path(path: &Path) -> PathBuf {
    path.with_extension("json")
}

/// What is to be known of an array beside its values.
pub(super) struct Facts<'a> {
    pub timing: Timing,
    /// Height, width and bins.
    pub size: [usize; 3],
    pub capture: Option<&'a Capture>,
}

impl<'a> Facts<'a> {
    pub(super) fn of(transient: &'a Transient) -> Facts<'a> {
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
pub(super) type Meaning = (Timing, Option<Capture>);

/// What the text of such a file says.
///
/// # Errors
/// Text that does not tell the axis.
pub(super) fn decode_sidecar(path: &Path, text: &[u8]) -> Result<Meaning> {
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
pub(super) fn with_key(error: Error) -> Error {
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

/// There is no such layer in time; those that there are stand in the sidecar.
pub(super) fn no_layer(layer: &str, sidecar: Option<Vec<u8>>) -> Error {
    let sidecar: Option<Sidecar> = sidecar.and_then(|text| serde_json::from_slice(&text).ok());
    let known = sidecar.map(|sidecar| sidecar.layers).unwrap_or_default();
    Error::new(format!("there is no layer '{layer}' in time")).with_hint(match known.is_empty() {
        true => "only all light was kept; film.time.layers asks for more".into(),
        false => format!("known are {}", known.join(", ")),
    })
}
