//! Films of light by time, and how they look on a display.

use std::io::{ErrorKind, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use lampyris::error::{Error, Result, did_you_mean};
use lampyris::image::{Image, luminance};
use lampyris::output::display_codes;
use lampyris::tonemap::ToneMap;
use lampyris::transient::Transient;

use crate::args::TransientArguments;
use crate::progress::Display;

/// From radiance to display light, the same for all pictures of a film.
pub struct Look {
    operator: ToneMap,
    exposure: f32,
    quantile: f64,
}

impl Look {
    /// The names that `--operator` knows.
    const NAMES: [&'static str; 3] = ["clamp", "gamma", "filmic"];

    /// As the user wants it.
    ///
    /// # Errors
    /// An unknown operator, or a quantile outside 0..1.
    pub fn of(arguments: &TransientArguments) -> Result<Look> {
        // Others would take their measure from each picture, and a film would flicker.
        let operator = match arguments.operator.as_str() {
            "clamp" => ToneMap::Clamp,
            "gamma" => ToneMap::GammaClamp { gamma: 2.2, value: 1.0 },
            "filmic" => ToneMap::Filmic,
            name => {
                let hint = match did_you_mean(name, Look::NAMES) {
                    Some(near) => format!("did you mean '{near}'?"),
                    None => format!("known are {}", Look::NAMES.join(", ")),
                };
                return Err(Error::new(format!("there is no operator '{name}' for light by time")).with_hint(hint));
            }
        };
        if !(0.0..=1.0).contains(&arguments.quantile) {
            return Err(Error::new(format!("the quantile must be from 0 to 1, not {}", arguments.quantile)));
        }
        Ok(Look { operator, exposure: arguments.exposure, quantile: arguments.quantile.into() })
    }

    /// The luminance that becomes white, or 0 where all is dark.
    pub fn white_of(&self, image: &Image) -> f32 {
        let lit = image.pixels().iter().map(|&pixel| luminance(pixel)).filter(|l| *l > 0.0 && l.is_finite());
        let mut lit: Vec<f32> = lit.collect();
        if lit.is_empty() {
            return 0.0;
        }
        let at = ((lit.len() - 1) as f64 * self.quantile).round() as usize;
        *lit.select_nth_unstable_by(at, f32::total_cmp).1
    }

    /// The same, brightened by the exposure.
    pub fn exposed_white_of(&self, image: &Image) -> f32 {
        self.white_of(image) / self.exposure.exp2()
    }

    /// The picture in display light.
    pub fn apply(&self, image: &Image, white: f32) -> Image {
        let scale = if white > 0.0 { 1.0 / white } else { 0.0 };
        self.operator.apply(&image.map(|pixel| pixel.map(|value| value * scale)), self.exposure)
    }
}

/// The pictures of a film, bin by bin, as they are asked for.
pub fn frames<'a>(
    transient: &'a Transient,
    look: &'a Look,
    path: &'a Path,
    display: &'a Display,
) -> impl ExactSizeIterator<Item = Image> + 'a {
    let white = transient.quantile(look.quantile);
    (0..transient.bins()).map(move |bin| {
        display.step(bin, transient.bins(), &format!("writing {}", path.display()));
        look.apply(&transient.frame(bin), white)
    })
}

/// The program that writes MP4.
const FFMPEG: &str = "ffmpeg";

/// Fails if it is not there.
pub fn check_ffmpeg(path: &Path) -> Result<()> {
    let tried =
        Command::new(FFMPEG).arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    match tried {
        Ok(status) if status.success() => Ok(()),
        _ => Err(no_ffmpeg(path)),
    }
}

fn no_ffmpeg(path: &Path) -> Error {
    Error::new(format!("cannot write '{}': MP4 is written by {FFMPEG}, which is not there", path.display()))
        .with_hint("install ffmpeg, or write .apng or .gif")
}

/// Lets ffmpeg make an MP4 of the pictures. The file appears whole or not at all.
///
/// # Errors
/// If ffmpeg is not there or fails, with what it says.
pub fn write_mp4(path: &Path, transient: &Transient, look: &Look, rate: f32, display: &Display) -> Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let unfinished = path.with_file_name(format!(".lampyris-{}-{name}", std::process::id()));
    let written = encode_mp4(path, &unfinished, transient, look, rate, display)
        .and_then(|()| std::fs::rename(&unfinished, path).map_err(|error| Error::io(path, "write", &error)));
    if written.is_err() {
        // The first error is the one to tell.
        let _ = std::fs::remove_file(&unfinished);
    }
    written
}

fn encode_mp4(
    path: &Path,
    unfinished: &Path,
    transient: &Transient,
    look: &Look,
    rate: f32,
    display: &Display,
) -> Result<()> {
    let fail = |what: &str| Error::new(format!("cannot write '{}': {FFMPEG} {what}", path.display()));
    let size = format!("{}x{}", transient.width(), transient.height());
    let mut child = Command::new(FFMPEG)
        .args(["-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", &size])
        .args(["-r", &rate.to_string(), "-i", "-", "-an"])
        // Players want even sides and this sampling of colour.
        .args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4"])
        .arg(unfinished)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(
            |error| if error.kind() == ErrorKind::NotFound { no_ffmpeg(path) } else { fail(&error.to_string()) },
        )?;
    if let Some(mut pipe) = child.stdin.take() {
        for frame in frames(transient, look, path, display) {
            // If it has ended, what it said is the better message.
            if pipe.write_all(&display_codes(&frame)).is_err() {
                break;
            }
        }
    }
    let output = child.wait_with_output().map_err(|error| fail(&error.to_string()))?;
    match output.status.success() {
        true => Ok(()),
        false => {
            let said = String::from_utf8_lossy(&output.stderr);
            Err(fail(&format!("says: {}", said.lines().last().unwrap_or("nothing").trim())))
        }
    }
}
