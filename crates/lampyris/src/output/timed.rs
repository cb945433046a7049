//! Films with time in files: all light by pixel and time, and each layer of it that was kept.

use std::io::{self, Write};
use std::path::Path;

use rayon::prelude::*;

use super::atomic::{write_whole, write_whole_by};
use super::npy::encode_header;
use super::npz::{Member, write_npz};
use super::sidecar::{Facts, Layering, encode_phasor_sidecar, encode_sidecar, sidecar_path};
use super::tal::{is_hdf5, write_tal};
use super::transient::{ARRAY, SIDECAR, TransientFormat, layer_path, member_of};
use crate::error::{Error, Result};
use crate::film::{Clock, Film};
use crate::image::luminance;
use crate::transient::TimeLayer;

/// Writes the time bins of a film as [`write_transient`](super::write_transient) or [`write_tal`] do, or its amplitudes as
/// [`write_phasors`](super::write_phasors) does, with its layers in time: beside `NAME.npy`, `NAME.LAYER.npy` with a `.json` of
/// its own; within an `.npz`, `LAYER.npy`, where amplitudes of all light are `phasors.npy`. Each file is written whole or not
/// at all, and but for HDF5 a part at a time, so that there is no copy of the film in memory.
///
/// # Errors
/// A film without time, another extension than `.npy`, `.npz` and `.hdf5`, or what the operating system says.
pub fn write_timed(path: &Path, film: &Film) -> Result<()> {
    if is_hdf5(path) {
        return write_tal(path, &film.transient(None)?);
    }
    let clock = film.clock().ok_or_else(|| Error::new("the film has no time bins"))?;
    let layers: Vec<TimeLayer> = clock.layers().iter().collect();
    let names: Vec<String> = layers.iter().map(ToString::to_string).collect();
    let whole = Array { film, clock, layer: None, layering: Layering { layer: None, layers: &names } };
    let parts = layers.iter().zip(&names).map(|(&layer, name)| {
        let layering = Layering { layer: Some(name), layers: &[] };
        (name, Array { layer: Some(layer), layering, ..whole })
    });
    match TransientFormat::of(path)? {
        TransientFormat::Npy => {
            for (name, array) in parts {
                array.write_both(&layer_path(path, name))?;
            }
            whole.write_both(path)
        }
        TransientFormat::Npz => {
            let [array, sidecar] = if clock.bins() > 0 { [ARRAY, SIDECAR] } else { ["phasors.npy", "phasors.json"] };
            let mut members = vec![whole.member(array), Member::of_bytes(sidecar, whole.sidecar()?)];
            members.extend(parts.map(|(name, array)| array.member(&member_of(name))));
            write_whole_by(path, |file| write_npz(file, &members))
        }
    }
}

/// The bins or amplitudes of all light, or of one layer.
#[derive(Clone, Copy)]
struct Array<'a> {
    film: &'a Film,
    clock: &'a Clock,
    layer: Option<TimeLayer>,
    layering: Layering<'a>,
}

/// Bytes of an array that are made at a time.
const AT_ONCE: usize = 1 << 24;

impl<'a> Array<'a> {
    /// The array, and beside it what it means; that comes first, so that whoever sees the array appear finds it.
    fn write_both(self, path: &Path) -> Result<()> {
        write_whole(&sidecar_path(path), &self.sidecar()?)?;
        write_whole_by(path, |file| self.write(file))
    }

    /// Within another file.
    fn member(self, name: &str) -> Member<'a> {
        let values = self.shape().iter().map(|&length| length as u64).product::<u64>();
        Member { name: name.into(), length: 4 * values, write: Box::new(move |to| self.write(to)) }
    }

    fn shape(&self) -> [usize; 4] {
        let [width, height] = self.film.size();
        let of_pixel = match self.clock.bins() {
            0 => [self.clock.frequencies().len(), 2],
            bins => [bins, 3],
        };
        [height, width, of_pixel[0], of_pixel[1]]
    }

    fn write(&self, to: &mut dyn Write) -> io::Result<()> {
        let [height, width, count, channels] = self.shape();
        to.write_all(&encode_header(&self.shape()))?;
        let pixels: Vec<usize> = (0..width * height).collect();
        for pixels in pixels.chunks((AT_ONCE / (4 * channels * count.max(1))).max(1)) {
            let parts: Result<Vec<Vec<u8>>> = pixels.par_iter().map(|&pixel| self.values(pixel)).collect();
            for part in parts.map_err(io::Error::other)? {
                to.write_all(&part)?;
            }
        }
        Ok(())
    }

    /// Those of a pixel, as bytes.
    fn values(&self, pixel: usize) -> Result<Vec<u8>> {
        let values = match self.clock.bins() {
            0 => self.film.amplitudes(pixel, self.layer)?.into_iter().flatten().map(luminance).collect(),
            _ => self.film.bins_of(pixel, self.layer)?.into_flattened(),
        };
        Ok(values.into_iter().flat_map(f32::to_le_bytes).collect())
    }

    /// The JSON beside the array.
    fn sidecar(&self) -> Result<Vec<u8>> {
        let [height, width, count, _] = self.shape();
        if self.clock.bins() == 0 {
            let (frequencies, start) = (self.clock.frequencies(), self.clock.start());
            return Ok(encode_phasor_sidecar([height, width], &frequencies, start, self.layering));
        }
        let facts = Facts { timing: self.clock.timing(), size: [height, width, count], capture: self.film.capture() };
        encode_sidecar(&facts, self.layering)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Arrival, Exposure, Storage};
    use crate::image::Image;
    use crate::output::read_transient;
    use crate::scene::description::{FilmDescription, TimeDescription};
    use crate::transient::{LightKind, Met};

    /// A pixel with a bin of direct light and one of a caustic.
    fn film() -> Film {
        let layers = vec![LightKind::Caustic, LightKind::Direct];
        let time = TimeDescription { bins: 3, start: Some(1.0), bin_width: Some(0.5), layers, ..Default::default() };
        let clock = Clock::of(&FilmDescription { time: Some(time), ..Default::default() }).expect("a clock");
        let mut exposure = Exposure::from(Image::new(1, 1));
        let caustic = Met { is_caustic: true, ..Met::surfaces(2) };
        for (optical_length, met, light) in [(1.7, Met::surfaces(1), 2.0), (2.1, caustic, 4.0)] {
            let mut arrivals = Vec::new();
            clock.note(optical_length, met, |slot, _| arrivals.push(Arrival { pixel: 0, slot, light: [light; 3] }));
            exposure.add_arrivals(arrivals);
        }
        let mut film = Film::new([1, 1]).with_time(clock, &Storage::Memory).expect("memory");
        film.add_pass(&exposure);
        film
    }

    #[test]
    fn layers_in_time_are_read_as_they_were_written() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["a.npy", "a.npz"] {
            let path = folder.path().join(name);
            write_timed(&path, &film()).expect("written");
            let read = |layer| read_transient(&path, layer, None).map(|light| light.profile(0, 0).to_vec());
            assert_eq!(read(None).expect("all light"), [[0.0; 3], [2.0; 3], [4.0; 3]]);
            assert_eq!(read(Some("direct")).expect("direct"), [[0.0; 3], [2.0; 3], [0.0; 3]]);
            assert_eq!(read(Some("caustic")).expect("caustic"), [[0.0; 3], [0.0; 3], [4.0; 3]]);
            let error = read(Some("volume")).expect_err("not kept").to_string();
            assert!(error.contains("no layer 'volume'") && error.contains("direct, caustic"), "{error}");
        }
    }
}
