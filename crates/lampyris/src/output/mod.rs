//! Picture files, written and read.
//!
//! | extension | what it holds | written as |
//! |---|---|---|
//! | `.exr` | linear radiance | 32-bit floats, lossless ZIP, channels R, G, B; layers and facts |
//! | `.npy` | linear radiance | `<f4`, `(height, width, 3)`, the top row first |
//! | `.pfm` | linear radiance | 32-bit floats, little-endian |
//! | `.hdr` | linear radiance, 8 bits of mantissa a pixel | Radiance RGBE, run-length coded |
//! | `.ppm` | linear radiance in 65536 steps of the largest value | text, with the `#MAX=` of the course |
//! | `.png` | display values: radiance cut off at 1, then the sRGB curve | 8 bits a channel |
//!
//! Light by pixel and time goes to `.npy` with a `.json`, or `.npz`; its films to animated PNG and GIF, the times of a pixel to
//! CSV and SVG, captures of relay walls to HDF5.
//!
//! A PNG shows what lies in 0..1; bring a picture there first with a [`ToneMap`](crate::tonemap::ToneMap).
//! Reading knows all of these by their first bytes, whatever the name, and JPEG too; TGA by its ending.

mod atomic;
mod exr;
mod hdr;
mod jpeg;
mod limits;
mod npy;
mod npz;
mod pfm;
mod photons;
mod plot;
mod png;
mod ppm;
mod scene;
mod sidecar;
mod tal;
#[cfg(test)]
mod tests;
mod tga;
mod timed;
mod transient;
mod video;

use std::io::Read;
use std::path::Path;

pub use atomic::{check_writable, write_whole, write_whole_by};
pub use photons::{PhotonFormat, check_photons_path, encode_photons, write_photons};
pub use plot::{check_pixel, map_csv, profile_csv, profile_svg};
pub use scene::{check_scene_path, write_scene};
pub use sidecar::sidecar_path;
pub use tal::{encode_tal, is_hdf5, write_tal};
pub use timed::write_timed;
pub use transient::{TransientFormat, check_transient_path, read_transient, write_phasors, write_transient};
pub use video::{VideoFormat, check_frame_rate, encode_video};

use crate::error::{Error, Result, did_you_mean};
use crate::film::Layer;
use crate::image::Image;
use crate::texture::{Curve, Raster};

/// A file format that we write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR.
    Exr,
    /// Radiance RGBE.
    Hdr,
    /// NumPy array.
    Npy,
    /// Portable float map.
    Pfm,
    /// Portable network graphics: display values, not radiance.
    Png,
    /// Portable pixel map, with the course's `#MAX=`.
    Ppm,
}

impl Format {
    /// Every format, in the order of their extensions.
    pub const ALL: [Format; 6] = [Format::Exr, Format::Hdr, Format::Npy, Format::Pfm, Format::Png, Format::Ppm];

    /// The extension, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Exr => "exr",
            Format::Hdr => "hdr",
            Format::Npy => "npy",
            Format::Pfm => "pfm",
            Format::Png => "png",
            Format::Ppm => "ppm",
        }
    }

    /// The format that the extension of `path` names, in either case; an error that lists the formats where it
    /// names none.
    pub fn of(path: &Path) -> Result<Format> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let format = Format::ALL.into_iter().find(|format| format.extension() == extension);
        format.ok_or_else(|| {
            let known = Format::ALL.map(|format| format!(".{}", format.extension())).join(" ");
            let hint = match did_you_mean(&extension, Format::ALL.map(Format::extension)) {
                Some(near) => format!("did you mean .{near}? known are {known}"),
                None => format!("known are {known}"),
            };
            let what = if extension.is_empty() { "no extension".into() } else { format!("extension '.{extension}'") };
            Error::new(format!("cannot write '{}': {what} names no picture format", path.display())).with_hint(hint)
        })
    }
}

/// A picture with all that a file may hold of it. Formats other than EXR hold the image alone.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Linear radiance.
    pub image: &'a Image,
    /// Of the same size: the picture as it was rendered, if it was denoised since. The layer `noisy` of an EXR file.
    pub noisy: Option<&'a Image>,
    /// Of the same size; a layer of one channel is read from the first.
    pub layers: &'a [(Layer, Image)],
    /// What is to be known of it, by name.
    pub facts: &'a [(&'a str, Fact)],
}

impl<'a> From<&'a Image> for Picture<'a> {
    fn from(image: &'a Image) -> Picture<'a> {
        Picture { image, noisy: None, layers: &[], facts: &[] }
    }
}

/// Something to be known of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Fact {
    /// Words.
    Text(String),
    /// A whole number.
    Whole(i32),
    /// A number.
    Number(f64),
}

/// Writes a picture with its layers and facts in the format that the extension of `path` names, as [`write_image`] does.
///
/// # Errors
/// As [`write_image`].
pub fn write_picture(path: &Path, picture: &Picture<'_>) -> Result<()> {
    write_whole(path, &encode_picture(Format::of(path)?, picture)?)
}

/// Writes a picture in the format that the extension of `path` names.
///
/// The file appears whole or not at all, see [`write_whole`].
///
/// # Errors
/// An unknown extension, a picture without pixels, or what the operating system says.
pub fn write_image(path: &Path, image: &Image) -> Result<()> {
    write_whole(path, &encode(Format::of(path)?, image)?)
}

/// Finds what would stop [`write_image`] from writing to `path`, before the work of making a picture: the extension,
/// the folder, and whether `path` is itself a folder or may not be written to.
pub fn check_path(path: &Path) -> Result<()> {
    Format::of(path)?;
    check_writable(path)
}

/// The bytes of a file in this format.
///
/// # Errors
/// A picture without pixels, or of a size that the format cannot hold.
pub fn encode(format: Format, image: &Image) -> Result<Vec<u8>> {
    encode_picture(format, &image.into())
}

fn encode_picture(format: Format, picture: &Picture<'_>) -> Result<Vec<u8>> {
    let image = picture.image;
    if image.pixels().is_empty() {
        return Err(Error::new(format!(
            "a picture of {} × {} pixels cannot be written",
            image.width(),
            image.height()
        )));
    }
    match format {
        Format::Exr => exr::encode(picture),
        Format::Hdr => hdr::encode(image),
        Format::Npy => Ok(npy::encode(image)),
        Format::Pfm => Ok(pfm::encode(image)),
        Format::Png => png::encode(image),
        Format::Ppm => Ok(ppm::encode(image)),
    }
}

/// Three bytes a pixel, row by row, as a PNG has them: display light cut off at 0 and 1, under the sRGB curve.
pub fn display_codes(image: &Image) -> Vec<u8> {
    png::codes(image)
}

/// Reads the picture in a file, as [`decode`] does.
///
/// # Errors
/// As [`decode`], or what the operating system says.
pub fn read_image(path: &Path) -> Result<Image> {
    decode(&path.to_string_lossy(), &read_whole(path)?)
}

/// Reads one layer of an EXR file by its name: channels `NAME.R`, `.G`, `.B` or `.X`, `.Y`, `.Z`, or a single one.
///
/// # Errors
/// A file of another format, a name that it does not have, and those of [`read_image`].
pub fn read_layer(path: &Path, name: &str) -> Result<Image> {
    let bytes = read_whole(path)?;
    let layer = match bytes.as_slice() {
        [0x76, 0x2f, 0x31, 0x01, ..] => exr::decode_layer(&bytes, name),
        _ => Err(Error::new(format!("there is no layer '{name}': only EXR files have layers"))),
    };
    layer.map_err(|error| error.with_file(path))
}

/// All bytes of a file.
///
/// # Errors
/// What the operating system says.
pub fn read_whole(path: &Path) -> Result<Vec<u8>> {
    // Pipes and devices do not say how long they are, and some never end.
    const LONGEST_STREAM: u64 = 1 << 30;
    let fail = |error| Error::io(path, "read", &error);
    let file = std::fs::File::open(path).map_err(fail)?;
    let is_file = file.metadata().map_err(fail)?.is_file();
    let mut bytes = Vec::new();
    file.take(if is_file { u64::MAX } else { LONGEST_STREAM }).read_to_end(&mut bytes).map_err(fail)?;
    Ok(bytes)
}

/// The picture in these bytes; `name` is for messages.
///
/// The first bytes tell the format: PPM (P3, P6), PFM, Radiance HDR, OpenEXR, NPY, PNG or JPEG; TGA, which has none to
/// be known by, by the ending of `name`. PNG, JPEG and TGA are decoded from sRGB to linear 0..1; the others hold linear
/// values, and a PPM without `#MAX=` holds 0..1. Alpha is dropped, grey fills all three channels.
///
/// # Errors
/// Anything else, anything cut short, and sizes that the bytes cannot hold; with line and column in a P3.
pub fn decode(name: &str, bytes: &[u8]) -> Result<Image> {
    let Decoded { picture, values } = decode_any(name, bytes)?;
    Ok(match values {
        Values::Srgb => picture.with_curve(Curve::Srgb).to_image(),
        Values::Linear | Values::Unstated => picture.to_image(),
    })
}

/// The texture in these bytes; `name` is for messages.
///
/// As [`decode`], but files with 8 or 16 bits a channel are kept as they are, in 0..1, if `raw` (a roughness, a
/// normal map), and decoded from sRGB otherwise, PPM without `#MAX=` too. Formats of floats hold linear values
/// whether `raw` or not. The opacity is kept, and takes no part in the colour.
pub fn decode_texture(name: &str, bytes: &[u8], raw: bool) -> Result<Raster> {
    let Decoded { picture, values } = decode_any(name, bytes)?;
    let picture = match values {
        Values::Srgb | Values::Unstated if !raw => picture.with_curve(Curve::Srgb),
        _ => picture,
    };
    Ok(picture.compact())
}

/// A picture as it stands in its file, its curve left aside.
struct Decoded {
    picture: Raster,
    values: Values,
}

/// What the numbers in a file mean.
enum Values {
    /// Linear radiance.
    Linear,
    /// Display values 0..1 under the sRGB curve.
    Srgb,
    /// The format leaves it open: 0..1, linear or not.
    Unstated,
}

impl Decoded {
    fn linear(image: Image) -> Result<Decoded> {
        match Raster::of_image(image) {
            Some(picture) => Ok(Decoded { picture, values: Values::Linear }),
            None => Err(Error::new("the picture has no pixels")),
        }
    }
}

fn decode_any(name: &str, bytes: &[u8]) -> Result<Decoded> {
    let decoded = match bytes {
        [0x89, b'P', b'N', b'G', ..] => png::decode(bytes),
        [0xff, 0xd8, 0xff, ..] => jpeg::decode(bytes),
        [0x76, 0x2f, 0x31, 0x01, ..] => decode_exr(bytes),
        [0x93, b'N', b'U', b'M', b'P', b'Y', ..] => npy::decode(bytes).and_then(Decoded::linear),
        [b'#', b'?', ..] => hdr::decode(bytes).and_then(Decoded::linear),
        [b'P', b'3' | b'6', ..] => ppm::decode(name, bytes),
        [b'P', b'F' | b'f', ..] => pfm::decode(bytes).and_then(Decoded::linear),
        [] => Err(Error::new("the file is empty, not a picture")),
        _ if tga::is_likely(name, bytes) => tga::decode(bytes),
        _ => Err(Error::new("not a picture in a format that we read")
            .with_hint("known are exr hdr jpeg npy pfm png ppm (P3, P6) tga")),
    };
    decoded.map_err(|error| error.with_file(name))
}

fn decode_exr(bytes: &[u8]) -> Result<Decoded> {
    let (image, opacity) = exr::decode(bytes)?;
    let decoded = Decoded::linear(image)?;
    Ok(match opacity {
        Some(opacity) => Decoded { picture: decoded.picture.with_opacity(&opacity), ..decoded },
        None => decoded,
    })
}
