//! What the source and the sensor make of light by time: pulses and single-photon detectors.

use std::path::Path;

use lampyris::error::{Error, Result, did_you_mean};
use lampyris::output::read_whole;
use lampyris::transient::{Counting, Pulse, Spad, Table, Transient};

use crate::args::{PulseShape, TransientArguments, length};

/// The light as the pulse and the detector of the arguments leave it.
///
/// # Errors
/// A pulse or a detector that is none.
pub fn sensed(transient: Transient, arguments: &TransientArguments) -> Result<Transient> {
    let speed = transient.timing().light_speed;
    let transient = match &arguments.pulse {
        None => transient,
        Some(PulseShape::Gaussian(width)) => transient.convolved(&Pulse::Gaussian { fwhm: width.in_units(speed) })?,
        Some(PulseShape::Table(path)) => transient.convolved(&Pulse::Table(table(path)?))?,
    };
    if arguments.spad.is_empty() {
        return Ok(transient);
    }
    let spad = spad(&arguments.spad, speed)?;
    let counts = if arguments.counted { transient } else { spad.count(&transient, arguments.seed)? };
    if arguments.coates { spad.estimate(&counts) } else { Ok(counts) }
}

/// The detector that the keys describe.
fn spad(keys: &[(String, String)], light_speed: f64) -> Result<Spad> {
    const KEYS: [&str; 7] = ["efficiency", "jitter", "tail", "dark", "ambient", "pulses", "first-photon"];
    let mut spad = Spad::default();
    for (key, value) in keys {
        let wrong = |what: &str| Error::new(format!("'{key}' of --spad must be {what}, not '{value}'"));
        let number = || value.parse::<f64>().map_err(|_| wrong("a number"));
        let length =
            || length(value).map(|length| length.in_units(light_speed)).map_err(|_| wrong("a length or a time"));
        match key.replace('_', "-").as_str() {
            "efficiency" => spad.efficiency = number()?,
            "jitter" => spad.jitter = length()?,
            "tail" => spad.tail = length()?,
            "dark" => spad.dark_rate = number()?,
            "ambient" => spad.ambient_rate = number()?,
            "pulses" => {
                let pulses = number()?;
                if !(pulses >= 1.0 && pulses.fract() == 0.0 && pulses < 1e18) {
                    return Err(wrong("a whole number from 1 on"));
                }
                spad.pulses = pulses as u64;
            }
            "first-photon" => {
                spad.counting = match value.as_str() {
                    "true" => Counting::FirstPhoton,
                    "false" => Counting::Linear,
                    _ => return Err(wrong("true or false")),
                }
            }
            _ => {
                let hint = match did_you_mean(key, KEYS) {
                    Some(near) => format!("did you mean '{near}'?"),
                    None => format!("known are {}", KEYS.join(", ")),
                };
                return Err(Error::new(format!("a detector has no '{key}'")).with_hint(hint));
            }
        }
    }
    spad.check()?;
    Ok(spad)
}

/// Two numbers a line, with a comma between them; a first line of words is passed over.
fn table(path: &Path) -> Result<Table> {
    let bytes = read_whole(path)?;
    let text = std::str::from_utf8(&bytes).map_err(|_| Error::new("the pulse is not text").with_file(path))?;
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let mut points = Vec::new();
    for (place, (number, line)) in lines.enumerate() {
        let point = line
            .split_once(',')
            .and_then(|(at, strength)| Some((at.trim().parse::<f64>().ok()?, strength.trim().parse::<f64>().ok()?)));
        match point {
            Some(point) => points.push(point),
            None if place == 0 => {}
            None => {
                return Err(Error::new(format!("line {} of the pulse is not a length and a strength", number + 1))
                    .with_hint("write two numbers with a comma between them")
                    .with_file(path));
            }
        }
    }
    Table::new(points).map_err(|error| error.with_file(path))
}
