//! Photon maps as point clouds: PLY for viewers, CSV for spreadsheets and scripts.
//!
//! | columns | what they hold |
//! |---|---|
//! | `x y z` | where the photon landed, scene units |
//! | `nx ny nz` | normal of the geometry, on the side on which it landed |
//! | `dx dy dz` | where it was going, unit length |
//! | `red green blue` | its colour for a display, 0 to 255: white at the mean flux |
//! | `flux_r flux_g flux_b` | its flux in W; all photons together carry the flux that landed |
//! | `optical_length` | of its path since the lamp, scene units |
//! | `bounce` | scattering events before it landed |
//! | `caustic` | 1 if it came by mirrors and glass alone, and by at least one of them, else 0 |

use std::path::Path;

use super::{check_writable, write_whole};
use crate::error::{Error, Result};
use crate::photon::{Photon, PhotonMap};
use crate::spectrum::linear_to_srgb;

/// A file format for photon maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhotonFormat {
    /// Polygon file format, binary, little-endian: vertices without faces.
    Ply,
    /// Text, a photon a line after a line of column names.
    Csv,
}

impl PhotonFormat {
    /// The format that the extension of `path` names, in either case.
    ///
    /// # Errors
    /// If it names none.
    pub fn of(path: &Path) -> Result<PhotonFormat> {
        match path.extension().unwrap_or_default().to_string_lossy().to_lowercase().as_str() {
            "ply" => Ok(PhotonFormat::Ply),
            "csv" => Ok(PhotonFormat::Csv),
            _ => Err(Error::new(format!("cannot write photons to '{}': unknown format", path.display()))
                .with_hint("photons can be written as .ply or .csv")),
        }
    }
}

/// Finds what would stop [`write_photons`] from writing to `path`.
///
/// # Errors
/// An unknown extension, a folder that does not exist or may not be written to.
pub fn check_photons_path(path: &Path) -> Result<()> {
    PhotonFormat::of(path)?;
    check_writable(path)
}

/// Writes the photons of a map in the format that the extension of `path` names, whole or not at all.
///
/// # Errors
/// An unknown extension, or what the operating system says.
pub fn write_photons(path: &Path, map: &PhotonMap) -> Result<()> {
    write_whole(path, &encode_photons(PhotonFormat::of(path)?, map))
}

/// The bytes of a file in this format, photons in the order of the map.
pub fn encode_photons(format: PhotonFormat, map: &PhotonMap) -> Vec<u8> {
    let share = 1.0 / map.paths_emitted().max(1) as f32;
    let count = map.photons().len().max(1) as f64;
    let mean = map.photons().iter().map(|photon| f64::from(photon.flux.max()) / count).sum::<f64>() as f32;
    let records = map.photons().iter().map(|photon| Record::of(photon, share, mean));
    match format {
        PhotonFormat::Ply => ply(records),
        PhotonFormat::Csv => csv(records),
    }
}

/// Names of the floats before the colour, and after it.
const BEFORE: [&str; 9] = ["x", "y", "z", "nx", "ny", "nz", "dx", "dy", "dz"];
const COLOR: [&str; 3] = ["red", "green", "blue"];
const AFTER: [&str; 4] = ["flux_r", "flux_g", "flux_b", "optical_length"];

/// A photon as both formats write it.
struct Record {
    before: [f32; 9],
    color: [u8; 3],
    after: [f32; 4],
    bounce: i32,
    caustic: u8,
}

impl Record {
    fn of(photon: &Photon, share: f32, mean: f32) -> Record {
        let ([x, y, z], [nx, ny, nz]) = (photon.position.to_array(), photon.normal.to_array());
        let [dx, dy, dz] = photon.direction.to_array();
        let [r, g, b] = photon.flux.to_rgb();
        let shown = |flux: f32| {
            let value = if mean > 0.0 { (flux / mean).clamp(0.0, 1.0) } else { 0.0 };
            (255.0 * linear_to_srgb(value)).round() as u8
        };
        Record {
            before: [x, y, z, nx, ny, nz, dx, dy, dz],
            color: [r, g, b].map(shown),
            after: [r * share, g * share, b * share, photon.optical_length],
            bounce: i32::from(photon.bounce),
            caustic: u8::from(photon.is_caustic()),
        }
    }
}

fn ply(records: impl ExactSizeIterator<Item = Record>) -> Vec<u8> {
    let mut header = format!(
        "ply\nformat binary_little_endian 1.0\ncomment photon map, flux in W\nelement vertex {}\n",
        records.len()
    );
    let mut declare = |kind: &str, names: &[&str]| {
        names.iter().for_each(|name| header.push_str(&format!("property {kind} {name}\n")));
    };
    declare("float", &BEFORE);
    declare("uchar", &COLOR);
    declare("float", &AFTER);
    declare("int", &["bounce"]);
    declare("uchar", &["caustic"]);
    header.push_str("end_header\n");
    let mut bytes = header.into_bytes();
    for record in records {
        bytes.extend(record.before.iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend(record.color);
        bytes.extend(record.after.iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend(record.bounce.to_le_bytes());
        bytes.push(record.caustic);
    }
    bytes
}

fn csv(records: impl Iterator<Item = Record>) -> Vec<u8> {
    let mut text = [&BEFORE[..], &COLOR, &AFTER, &["bounce", "caustic"]].concat().join(",");
    text.push('\n');
    for record in records {
        let cells = record.before.iter().map(f32::to_string);
        let cells = cells.chain(record.color.iter().map(u8::to_string));
        let cells = cells.chain(record.after.iter().map(f32::to_string));
        let cells: Vec<String> = cells.chain([record.bounce.to_string(), record.caustic.to_string()]).collect();
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::material::{Event, Lobes};
    use crate::photon::Radius;
    use crate::spectrum::Spectrum;

    /// Two photons of 4 light paths, the first one through glass.
    fn map() -> PhotonMap {
        let photon = |x: f32, flux: [f32; 3], history: Lobes| Photon {
            position: Vec3::new(x, 2.0, 3.0),
            direction: Vec3::NEG_Y,
            normal: Vec3::Y,
            optical_length: 7.5,
            reach: 1.0,
            slowness: 1.0,
            flux: Spectrum::from_rgb(flux),
            bounce: 1,
            shading: 1.0,
            rivals: 0.0,
            path: 0,
            history,
        };
        let photons = vec![
            photon(1.0, [8.0, 8.0, 0.0], Event::Refraction.into()),
            photon(1.5, [8.0, 0.0, 0.0], Event::Diffuse.into()),
        ];
        PhotonMap::build(photons, 4, Radius::Fixed(10.0))
    }

    #[test]
    fn a_csv_has_a_line_of_names_and_a_line_for_each_photon() {
        let text = String::from_utf8(encode_photons(PhotonFormat::Csv, &map())).expect("text");
        assert_eq!(
            text,
            "x,y,z,nx,ny,nz,dx,dy,dz,red,green,blue,flux_r,flux_g,flux_b,optical_length,bounce,caustic\n\
             1,2,3,0,1,0,0,-1,0,255,255,0,2,2,0,7.5,1,1\n\
             1.5,2,3,0,1,0,0,-1,0,255,0,0,2,0,0,7.5,1,0\n"
        );
    }

    #[test]
    fn a_ply_holds_what_its_header_says() {
        let bytes = encode_photons(PhotonFormat::Ply, &map());
        let end = bytes.windows(11).position(|window| window == b"end_header\n").expect("a header") + 11;
        let header = std::str::from_utf8(&bytes[..end]).expect("text");
        assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"));
        assert!(header.contains("element vertex 2\nproperty float x\n"));
        let sizes = header.lines().filter_map(|line| match line.split(' ').nth(1) {
            Some("float" | "int") => Some(4),
            Some("uchar") => Some(1),
            _ => None,
        });
        let record: usize = sizes.sum();
        assert_eq!(bytes.len() - end, 2 * record);
        assert_eq!(&bytes[end..end + 4], 1.0_f32.to_le_bytes());
        assert_eq!(&bytes[end + record - 5..end + record], [1, 0, 0, 0, 1], "bounce and caustic");
        assert_eq!(&bytes[end + 36..end + 39], [255, 255, 0]);
    }

    #[test]
    fn an_empty_map_is_a_file_without_photons() {
        let map = PhotonMap::build(Vec::new(), 10, Radius::Fixed(1.0));
        assert_eq!(encode_photons(PhotonFormat::Csv, &map).iter().filter(|&&byte| byte == b'\n').count(), 1);
    }

    #[test]
    fn other_extensions_name_the_known_ones() {
        let error = PhotonFormat::of(Path::new("a.xyz")).expect_err("unknown");
        assert_eq!(error.hint.as_deref(), Some("photons can be written as .ply or .csv"));
    }
}
