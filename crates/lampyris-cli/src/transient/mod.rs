//! `lampyris transient`: films, pictures, tables and measurements of light by time.

mod film;
mod sensor;

use std::path::{Path, PathBuf};

use lampyris::error::{Error, Result};
use lampyris::image::{Image, luminance};
use lampyris::output::{
    Format, VideoFormat, check_frame_rate, check_path, check_pixel, check_transient_path, check_writable, encode_video,
    is_hdf5, map_csv, profile_csv, profile_svg, read_transient, sidecar_path, write_image, write_phasors, write_tal,
    write_transient, write_whole,
};
use lampyris::transient::{Axis, SPEED_OF_LIGHT, TimeOfFlight, Timing, Transient};

use crate::args::{Length, TransientArguments};
use crate::progress::Display;
use crate::report::{print, say};
use film::Look;

/// What a file is to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Output {
    /// A film of a format that we write.
    Film(VideoFormat),
    /// A film that another program writes.
    Mp4,
    /// A picture, as the options say.
    Picture(Format),
    /// The times of a pixel, or depths, as a table.
    Table,
    /// The times of a pixel as a plot.
    Plot,
    /// Light by time again.
    Transient,
    /// Complex amplitudes.
    Phasors,
    /// A capture for y-tal.
    Hdf5,
    /// A picture for each bin.
    Bins,
}

/// Reads light by time, does with it what was asked for, and writes the results.
///
/// # Errors
/// Options that do not go together, and what is wrong with the files.
pub fn run(arguments: &TransientArguments) -> Result<()> {
    let outputs: Vec<(&PathBuf, Output)> =
        arguments.outputs.iter().map(|path| Ok((path, output(path, arguments)?))).collect::<Result<_>>()?;
    let look = Look::of(arguments)?;
    check_frame_rate(arguments.fps.into())?;
    for &(path, output) in &outputs {
        check(path, output)?;
    }
    let transient = sensor::sensed(read(arguments)?, arguments)?;
    check_options(&transient, arguments)?;
    let display = Display::new(arguments.quiet, false);
    for &(path, output) in &outputs {
        write(path, output, &transient, arguments, &look, &display)?;
        display.clear();
        if !arguments.quiet {
            say(&format!("wrote {}", path.display()));
        }
    }
    Ok(())
}

/// What a file is to hold, by its name and the options.
fn output(path: &Path, arguments: &TransientArguments) -> Result<Output> {
    let text = path.to_string_lossy();
    if text.ends_with(['/', std::path::MAIN_SEPARATOR]) || path.is_dir() {
        return Ok(Output::Bins);
    }
    let TransientArguments { gate, row, column, tof, phasor, pixel, .. } = arguments;
    let is_view = arguments.rainbow
        || arguments.peak_time
        || arguments.steady
        || gate.is_some()
        || row.is_some()
        || column.is_some()
        || tof.is_some();
    let needs =
        |option: &str| Error::new(format!("'{text}' needs {option}")).with_hint("see 'lampyris transient --help'");
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match extension.as_str() {
        "png" if arguments.video => Ok(Output::Film(VideoFormat::Apng)),
        "mp4" => Ok(Output::Mp4),
        "csv" if pixel.is_some() || tof.is_some() => Ok(Output::Table),
        "csv" => Err(needs("--pixel X,Y or --tof FREQUENCY")),
        "svg" if pixel.is_some() => Ok(Output::Plot),
        "svg" => Err(needs("--pixel X,Y")),
        "npy" if phasor.is_some() => Ok(Output::Phasors),
        "npz" => Ok(Output::Transient),
        "npy" if !is_view => Ok(Output::Transient),
        _ if is_hdf5(path) => Ok(Output::Hdf5),
        _ => match (VideoFormat::of(path), Format::of(path)) {
            (Some(format), _) => Ok(Output::Film(format)),
            (None, Ok(_)) if phasor.is_some() => Err(Error::new(format!("'{text}' cannot hold phasors")).with_hint("use .npy")),
            (None, Ok(format)) => Ok(Output::Picture(format)),
            (None, Err(error)) => Err(Error {
                hint: Some("known are .gif .apng .mp4, .csv .svg, .npy .npz .hdf5, pictures such as .png and .exr, and FOLDER/".into()),
                ..error
            }),
        },
    }
}

/// Finds what of the options makes no sense for this light, before anything is written.
fn check_options(transient: &Transient, arguments: &TransientArguments) -> Result<()> {
    let speed = transient.timing().light_speed;
    if let Some((x, y)) = arguments.pixel {
        check_pixel(transient, x, y)?;
    }
    if let Some((from, to)) = arguments.gate {
        gate(speed, from, to)?;
    }
    if let Some(y) = arguments.row {
        transient.streak_of_row(y)?;
    }
    if let Some(x) = arguments.column {
        transient.streak_of_column(x)?;
    }
    if let Some(frequency) = arguments.tof {
        TimeOfFlight::of_frequency(frequency, speed)?;
    }
    if let Some((mean, sigma)) = arguments.phasor {
        transient.phasor_frequencies(mean, sigma)?;
    }
    Ok(())
}

/// When a gate opens and closes, in scene units.
fn gate(speed: f64, from: Length, to: Length) -> Result<[f64; 2]> {
    let [from, to] = [from, to].map(|length| length.in_units(speed));
    if from >= to {
        return Err(Error::new(format!("a gate must open before it closes, not at {from} and {to}"))
            .with_hint("a number without a unit is in scene units, and a time is taken to them"));
    }
    Ok([from, to])
}

/// Finds what would stop a file from being written, before any work.
fn check(path: &Path, output: Output) -> Result<()> {
    match output {
        Output::Picture(_) => check_path(path),
        Output::Transient => check_transient_path(path),
        Output::Phasors => check_writable(&sidecar_path(path)).and_then(|()| check_writable(path)),
        Output::Bins => check_folder(path),
        Output::Mp4 => film::check_ffmpeg(path).and_then(|()| check_writable(path)),
        Output::Film(_) | Output::Table | Output::Plot | Output::Hdf5 => check_writable(path),
    }
}

/// Finds what would stop a folder from being made, or files from being written into it; what is not there is not made yet.
fn check_folder(path: &Path) -> Result<()> {
    let there = path.ancestors().find(|folder| folder.exists()).unwrap_or(Path::new("."));
    if !there.is_dir() {
        return Err(Error::new(format!("cannot create '{}': '{}' is not a folder", path.display(), there.display())));
    }
    check_writable(&there.join("000.exr"))
}

fn read(arguments: &TransientArguments) -> Result<Transient> {
    let units = |length: Length| length.in_units(SPEED_OF_LIGHT);
    let otherwise = arguments.bin_width.map(|width| {
        let start = arguments.start.map_or(0.0, units);
        Timing { axis: Axis { start, bin_width: units(width) }, ..Timing::new(0.0, 1.0) }
    });
    if let Some(timing) = &otherwise {
        timing.check()?;
    }
    let transient = read_transient(&arguments.input, arguments.layer.as_deref(), otherwise)?;
    match arguments.rebin {
        Some(count) => transient.rebinned(count.get() as usize),
        None => Ok(transient),
    }
}

fn write(
    path: &Path,
    output: Output,
    transient: &Transient,
    arguments: &TransientArguments,
    look: &Look,
    display: &Display,
) -> Result<()> {
    match (output, arguments.pixel) {
        (Output::Film(format), _) => {
            let rate = f64::from(arguments.fps);
            write_whole(path, &encode_video(format, rate, film::frames(transient, look, path, display))?)
        }
        (Output::Mp4, _) => film::write_mp4(path, transient, look, arguments.fps, display),
        (Output::Picture(format), _) => write_image(path, &picture(transient, arguments, look, format)?),
        (Output::Table, Some((x, y))) => write_whole(path, profile_csv(transient, x, y)?.as_bytes()),
        (Output::Table, None) => match arguments.tof {
            Some(frequency) => {
                let camera = TimeOfFlight::of_frequency(frequency, transient.timing().light_speed)?;
                write_whole(path, map_csv("depth", &camera.depths(transient)).as_bytes())
            }
            None => Err(Error::new("a table needs --pixel X,Y or --tof FREQUENCY")),
        },
        (Output::Plot, Some((x, y))) => write_whole(path, profile_svg(transient, x, y)?.as_bytes()),
        (Output::Plot, None) => Err(Error::new("a plot needs --pixel X,Y")),
        (Output::Transient, _) => write_transient(path, transient),
        (Output::Phasors, _) => {
            let (mean, sigma) = arguments.phasor.unwrap_or((0.0, 0.0));
            write_phasors(path, &transient.phasors(&transient.phasor_frequencies(mean, sigma)?)?)
        }
        (Output::Hdf5, _) => write_tal(path, transient),
        (Output::Bins, _) => {
            std::fs::create_dir_all(path).map_err(|error| Error::io(path, "create", &error))?;
            let digits = (transient.bins() - 1).to_string().len().max(3);
            for bin in 0..transient.bins() {
                display.step(bin, transient.bins(), &format!("writing {}", path.display()));
                write_image(&path.join(format!("{bin:0digits$}.exr")), &transient.frame(bin))?;
            }
            Ok(())
        }
    }
}

/// The picture that the options ask for. A PNG has display light, other formats what there is.
fn picture(transient: &Transient, arguments: &TransientArguments, look: &Look, format: Format) -> Result<Image> {
    let speed = transient.timing().light_speed;
    let is_shown = matches!(format, Format::Png);
    let light = match arguments {
        TransientArguments { steady: true, .. } => transient.steady(),
        TransientArguments { gate: Some((from, to)), .. } => {
            let [from, to] = gate(speed, *from, *to)?;
            transient.gated(from, to)
        }
        TransientArguments { row: Some(y), .. } => transient.streak_of_row(*y)?,
        TransientArguments { column: Some(x), .. } => transient.streak_of_column(*x)?,
        TransientArguments { peak_time: true, .. } => return lengths("peaks", transient.peak_lengths(), is_shown),
        TransientArguments { tof: Some(frequency), .. } => {
            let camera = TimeOfFlight::of_frequency(*frequency, speed)?;
            print(&format!("depths begin again at {}\n", camera.range() as f32))?;
            return lengths("depths", camera.depths(transient), is_shown);
        }
        _ => {
            let peaks =
                transient.picture(|profile| [profile.iter().map(|&value| luminance(value)).fold(0.0, f32::max); 3]);
            let (image, ends) = transient.rainbow(look.exposed_white_of(&peaks));
            // In single precision, as other lengths are told, and without the dust of the last digits.
            if let Some([first, last]) = ends.map(|ends| ends.map(|length| length as f32)) {
                print(&format!("peaks from {first} (red) to {last} (violet)\n"))?;
            }
            return Ok(image);
        }
    };
    Ok(if is_shown { look.apply(&light, look.white_of(&light)) } else { light })
}

/// Tells the range of lengths; for a display, the nearest is black and the farthest white.
fn lengths(what: &str, image: Image, is_shown: bool) -> Result<Image> {
    let finite = image.pixels().iter().map(|pixel| pixel[0]).filter(|length| length.is_finite());
    let Some([first, last]) = finite.fold(None, |ends: Option<[f32; 2]>, length| {
        let [first, last] = ends.unwrap_or([length; 2]);
        Some([first.min(length), last.max(length)])
    }) else {
        return Ok(if is_shown { image.map(|_| [0.0; 3]) } else { image });
    };
    print(&format!("{what} from {first} to {last}\n"))?;
    let span = if last > first { last - first } else { 1.0 };
    let grey = |length: f32| if length.is_finite() { (length - first) / span } else { 0.0 };
    Ok(if is_shown { image.map(|pixel| pixel.map(grey)) } else { image })
}
