//! The arguments of `lampyris transient`.

use std::num::NonZeroU32;
use std::path::PathBuf;

use clap::{ArgGroup, Args};

use super::values::{finite, pair, positive_count};

/// `lampyris transient`.
#[derive(Args, Debug)]
#[command(group = ArgGroup::new("view").multiple(false))]
pub struct TransientArguments {
    /// Light by pixel and time: .npy with its .json, or .npz
    pub input: PathBuf,

    /// Where to write, by extension: .gif .apng .mp4 a film; .png .exr and other pictures what the options below say; .csv .svg
    /// the times of a pixel; .npy .npz light by time; .hdf5 a capture for y-tal; FOLDER/ an .exr for each bin; may be repeated
    #[arg(short, long = "output", value_name = "FILE", required = true)]
    pub outputs: Vec<PathBuf>,

    /// The width of a bin, for an array that does not tell; a LENGTH is a number of scene units, or a time such as 10ps or 1.5ns
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    pub bin_width: Option<Length>,

    /// Where the first bin begins, for an array that does not tell [default: 0]
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true, requires = "bin_width")]
    pub start: Option<Length>,

    /// A part of the light that was kept with bins of its own, such as caustic or bounces-2
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,

    /// Add up N bins to one
    #[arg(long, value_name = "N", value_parser = positive_count)]
    pub rebin: Option<NonZeroU32>,

    /// Flash not at once but as a pulse: gaussian:LENGTH, its full width at half maximum, or a table of lengths in scene units
    /// and strengths in FILE.csv
    #[arg(long, value_name = "PULSE", value_parser = pulse)]
    pub pulse: Option<PulseShape>,

    /// Count what a single-photon detector does: efficiency=, jitter=LENGTH, tail=LENGTH, dark=HERTZ, ambient=HERTZ, pulses=N,
    /// first-photon=true for pile-up; with commas between them
    #[arg(long, value_name = "KEY=VALUE,...", value_delimiter = ',', value_parser = pair)]
    pub spad: Vec<(String, String)>,

    /// Take counts, of --spad or of the file, back to light, undoing the pile-up
    #[arg(long, requires = "spad")]
    pub coates: bool,

    /// The file has counts already, of the detector that --spad describes
    #[arg(long, requires = "coates")]
    pub counted: bool,

    /// Seed of the detector's random numbers
    #[arg(long, value_name = "N", default_value = "0")]
    pub seed: u64,

    /// Pictures: hues by when the most light arrives, red first and violet last; the default
    #[arg(long, group = "view")]
    pub rainbow: bool,

    /// Pictures: the path length at which the most light arrives
    #[arg(long, group = "view")]
    pub peak_time: bool,

    /// Pictures: the sum over all bins
    #[arg(long, group = "view")]
    pub steady: bool,

    /// Pictures: what arrives from A to B, such as 3.5..4 or 100ps..250ps
    #[arg(long, value_name = "A..B", value_parser = gate, allow_hyphen_values = true, group = "view")]
    pub gate: Option<(Length, Length)>,

    /// Pictures: time downwards for the pixels of this row
    #[arg(long, value_name = "Y", group = "view")]
    pub row: Option<usize>,

    /// Pictures: time to the right for the pixels of this column
    #[arg(long, value_name = "X", group = "view")]
    pub column: Option<usize>,

    /// Pictures and .csv: the depth that a time-of-flight camera sees whose lamp throbs at this frequency, such as 20MHz
    #[arg(long, value_name = "FREQUENCY", value_parser = frequency, group = "view")]
    pub tof: Option<f64>,

    /// .npy: complex amplitudes for wavelengths in scene units about MEAN, SIGMA wide
    #[arg(long, value_name = "MEAN,SIGMA", value_parser = two, group = "view")]
    pub phasor: Option<(f64, f64)>,

    /// The pixel whose times .csv and .svg have
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    pub pixel: Option<(usize, usize)>,

    /// Make a film of a .png, too
    #[arg(long)]
    pub video: bool,

    /// Pictures a second
    #[arg(long, value_name = "RATE", value_parser = finite, default_value = "24", allow_negative_numbers = true)]
    pub fps: f32,

    /// For displays: clamp, gamma (2.2) or filmic; the same for all pictures of a film
    #[arg(long, value_name = "NAME", default_value = "clamp")]
    pub operator: String,

    /// For displays: this share of the lit values is darker than white
    #[arg(long, value_name = "SHARE", value_parser = finite, default_value = "0.99", allow_negative_numbers = true)]
    pub quantile: f32,

    /// For displays: stops by which to brighten
    #[arg(long, value_name = "STOPS", value_parser = finite, default_value = "0", allow_negative_numbers = true)]
    pub exposure: f32,

    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// A path length, or the time that light takes for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// In scene units.
    Units(f64),
    /// In seconds.
    Seconds(f64),
}

impl Length {
    /// In scene units, where light travels so many of them a second.
    pub fn in_units(self, light_speed: f64) -> f64 {
        match self {
            Length::Units(length) => length,
            Length::Seconds(seconds) => seconds * light_speed,
        }
    }
}

/// What a pulse looks like.
#[derive(Clone, Debug, PartialEq)]
pub enum PulseShape {
    /// A Gaussian with this full width at half maximum.
    Gaussian(Length),
    /// A table in this file.
    Table(PathBuf),
}

/// A number and what follows it.
fn number_and_unit(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let unit_at = text.trim_end_matches(|c: char| c.is_alphabetic()).len();
    let (number, unit) = text.split_at(unit_at);
    let number: f64 = number.trim().parse().ok()?;
    number.is_finite().then_some((number, unit))
}

/// A length in scene units, or a time with its unit.
pub fn length(text: &str) -> Result<Length, String> {
    let form = || "a length is a number of scene units, or a time such as 10ps, 1.5ns or 2us".to_string();
    let (number, unit) = number_and_unit(text).ok_or_else(form)?;
    let seconds = match unit {
        "" => return Ok(Length::Units(number)),
        "fs" => 1e-15,
        "ps" => 1e-12,
        "ns" => 1e-9,
        "us" | "µs" => 1e-6,
        "ms" => 1e-3,
        "s" => 1.0,
        _ => return Err(form()),
    };
    Ok(Length::Seconds(number * seconds))
}

fn gate(text: &str) -> Result<(Length, Length), String> {
    let form =
        || "a gate is two lengths or times with two dots between them, such as 3.5..4 or 100ps..250ps".to_string();
    let (from, to) = text.split_once("..").ok_or_else(form)?;
    Ok((length(from)?, length(to)?))
}

fn pulse(text: &str) -> Result<PulseShape, String> {
    match text.split_once(':') {
        Some(("gaussian", width)) => length(width).map(PulseShape::Gaussian),
        _ if text.to_lowercase().ends_with(".csv") => Ok(PulseShape::Table(text.into())),
        _ => Err("a pulse is gaussian:LENGTH, such as gaussian:50ps, or the name of a .csv file".into()),
    }
}

fn frequency(text: &str) -> Result<f64, String> {
    let form = || "a frequency is a number above 0 and a unit, such as 20MHz".to_string();
    let (number, unit) = number_and_unit(text).ok_or_else(form)?;
    let hertz = match unit {
        "Hz" | "" => 1.0,
        "kHz" => 1e3,
        "MHz" => 1e6,
        "GHz" => 1e9,
        _ => return Err(form()),
    };
    if number > 0.0 { Ok(number * hertz) } else { Err(form()) }
}

fn two(text: &str) -> Result<(f64, f64), String> {
    let form = || "it must be two numbers with a comma between them, such as 0.06,0.06".to_string();
    let (first, second) = text.split_once(',').ok_or_else(form)?;
    match (first.trim().parse(), second.trim().parse()) {
        (Ok(first), Ok(second)) => Ok((first, second)),
        _ => Err(form()),
    }
}

fn pixel(text: &str) -> Result<(usize, usize), String> {
    let form = || "a pixel is two whole numbers with a comma between them, such as 12,34".to_string();
    let (x, y) = text.split_once(',').ok_or_else(form)?;
    match (x.trim().parse(), y.trim().parse()) {
        (Ok(x), Ok(y)) => Ok((x, y)),
        _ => Err(form()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_may_be_times() {
        assert_eq!(length("2.5"), Ok(Length::Units(2.5)));
        assert_eq!(length("1e-3"), Ok(Length::Units(1e-3)));
        assert_eq!(length("-4 ns"), Ok(Length::Seconds(-4e-9)));
        assert_eq!(length("10ps").map(|length| length.in_units(3e8)), Ok(10.0 * 1e-12 * 3e8));
        assert!(length("10parsec").is_err() && length("").is_err() && length("ps").is_err() && length("inf").is_err());
    }

    #[test]
    fn gates_pulses_frequencies_and_pixels() {
        assert_eq!(gate("1..2ns"), Ok((Length::Units(1.0), Length::Seconds(2.0 * 1e-9))));
        assert!(gate("1").is_err() && gate("1..x").is_err());
        assert_eq!(pulse("gaussian:0.5"), Ok(PulseShape::Gaussian(Length::Units(0.5))));
        assert_eq!(pulse("a.csv"), Ok(PulseShape::Table("a.csv".into())));
        assert!(pulse("triangle:1").is_err());
        assert_eq!(frequency("20MHz"), Ok(20e6));
        assert!(frequency("0Hz").is_err() && frequency("20 m").is_err());
        assert_eq!((pixel("3,4"), two("1, 0.5")), (Ok((3, 4)), Ok((1.0, 0.5))));
        assert!(pixel("3").is_err() && pixel("-1,2").is_err() && two("1").is_err());
    }
}
