//! Values of the command line from their texts. The messages end a sentence of clap's that names the option and
//! the text.

use std::num::{NonZeroU32, NonZeroUsize};
use std::ops::Range;
use std::time::Duration;

use lampyris::film::Layers;

use super::PreviewTarget;

/// `NAME=VALUE`; the value may be empty and hold further `=`.
pub(super) fn pair(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, _)) if name.trim().is_empty() => Err("there is no name before the '='".into()),
        Some((name, value)) => Ok((name.trim().to_string(), value.trim().to_string())),
        None => Err("there is no '=' in it".into()),
    }
}

/// `WIDTHxHEIGHT`.
pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let form = || "a size is two whole numbers with an x between them, such as 640x480".to_string();
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(form)?;
    let side = |text: &str| text.trim().parse::<u32>().map_err(|_| form());
    match [side(width)?, side(height)?] {
        [0, _] | [_, 0] => Err("a picture must be at least 1 pixel wide and high".into()),
        size => Ok(size),
    }
}

/// A whole number from 1.
pub(super) fn positive_count(text: &str) -> Result<NonZeroU32, String> {
    text.parse().map_err(|_| format!("it must be a whole number from 1 to {}", u32::MAX))
}

/// Most threads that we start: more than any machine has cores, and few enough for all of them to start.
const MOST_THREADS: usize = 4096;

/// A number of threads.
pub(super) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    match text.parse::<NonZeroUsize>() {
        Ok(count) if count.get() <= MOST_THREADS => Ok(count),
        _ => Err(format!("it must be a whole number from 1 to {MOST_THREADS}")),
    }
}

/// A time in `ms`, `s`, `m` or `h`; in seconds without a unit.
pub(super) fn duration(text: &str) -> Result<Duration, String> {
    let form = || "a time is a number and a unit, such as 60s, 1.5m, 2h or 500ms".to_string();
    let text = text.trim();
    let unit_at = text.trim_end_matches(|c: char| c.is_ascii_alphabetic()).len();
    let (number, unit) = text.split_at(unit_at);
    let seconds = match unit {
        "ms" => 1e-3,
        "s" | "" => 1.0,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(form()),
    };
    let number: f64 = number.trim().parse().map_err(|_| form())?;
    match Duration::try_from_secs_f64(number * seconds) {
        Ok(duration) if !duration.is_zero() => Ok(duration),
        _ if number > 0.0 && number * seconds > 1.0 => Err("that is longer than anyone can wait".into()),
        _ => Err("a time must be greater than 0".into()),
    }
}

/// So many bytes, with a unit of 1000 or of 1024.
pub(super) fn memory(text: &str) -> Result<u64, String> {
    let form = || "memory is a number and a unit, such as 500MB, 4GB or 4GiB, or 0".to_string();
    let text = text.trim();
    let unit_at = text.trim_end_matches(|c: char| c.is_ascii_alphabetic()).len();
    let (number, unit) = text.split_at(unit_at);
    let number: f64 = number.trim().parse().map_err(|_| form())?;
    let bytes: f64 = match unit.to_ascii_lowercase().as_str() {
        "" if number == 0.0 => 0.0,
        "b" => 1.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        "tb" => 1e12,
        "kib" => 1024.0,
        "mib" => 1024f64.powi(2),
        "gib" => 1024f64.powi(3),
        "tib" => 1024f64.powi(4),
        _ => return Err(form()),
    };
    // More than there can be is as much as there is.
    if number >= 0.0 { Ok((number * bytes) as u64) } else { Err(form()) }
}

/// A share greater than 0, such as `1%` or `0.01`.
pub(super) fn share(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.trim().strip_suffix('%') {
        Some(percents) => (percents, 0.01),
        None => (text, 1.0),
    };
    match number.trim().parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number * unit),
        _ => Err("it must be a number greater than 0, such as 1% or 0.01".into()),
    }
}

/// `A..B`, two whole numbers.
pub(super) fn pass_range(text: &str) -> Result<Range<u32>, String> {
    let form = || format!("passes are two whole numbers up to {} with two dots between them, such as 0..100", u32::MAX);
    let (start, end) = text.split_once("..").ok_or_else(form)?;
    let number = |text: &str| text.trim().parse::<u32>().map_err(|_| form());
    match number(start)?..number(end)? {
        range if range.is_empty() => Err("the first pass must come before the last".into()),
        range => Ok(range),
    }
}

/// A finite number.
pub(super) fn finite(text: &str) -> Result<f32, String> {
    match text.trim().parse::<f32>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("it must be a finite number".into()),
    }
}

/// Where tev listens unless told otherwise.
const TEV: &str = "127.0.0.1:14158";

/// `tev`, `terminal` or `HOST:PORT`.
pub(super) fn preview(text: &str) -> Result<PreviewTarget, String> {
    match (text.trim(), text.trim().rsplit_once(':')) {
        ("tev", _) => Ok(PreviewTarget::Tev(TEV.into())),
        ("terminal", _) => Ok(PreviewTarget::Terminal),
        (address, Some((host, port))) if !host.is_empty() && port.parse::<u16>().is_ok() => {
            Ok(PreviewTarget::Tev(address.into()))
        }
        _ => Err("it must be tev, terminal, or HOST:PORT, such as 127.0.0.1:14158".into()),
    }
}

/// `all`, `none`, or names with commas.
pub(super) fn layers(text: &str) -> Result<Layers, String> {
    text.parse().map_err(|error: lampyris::error::Error| error.to_string())
}
