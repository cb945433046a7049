//! Films with time in files: all light by pixel and time, and each layer of it that was kept.

use std::path::Path;

use super::atomic::write_whole;
use super::tal::{is_hdf5, write_tal};
use super::transient::{
    ARRAY, Layering, SIDECAR, TransientFormat, encode_npz, encode_phasors, encode_sidecar, encode_values, layer_path,
    member_of, sidecar_path,
};
use crate::error::{Error, Result};
use crate::film::Film;
use crate::transient::{Capture, TimeLayer, Transient};

/// Writes the time bins of a film, of a wall that was captured so, as [`write_transient`](super::write_transient) or
/// [`write_tal`] do, or its amplitudes as
/// [`write_phasors`](super::write_phasors) does, with its layers in time: beside `NAME.npy`, `NAME.LAYER.npy` with a `.json` of
/// its own; within an `.npz`, `LAYER.npy`, where amplitudes of all light are `phasors.npy`. Each file is written whole or not
/// at all.
///
/// # Errors
/// A film without time, another extension than `.npy`, `.npz` and `.hdf5`, or what the operating system says.
pub fn write_timed(path: &Path, film: &Film, capture: Option<&Capture>) -> Result<()> {
    if is_hdf5(path) {
        return write_tal(path, &captured(film.transient(None)?, capture)?);
    }
    let clock = film.clock().ok_or_else(|| Error::new("the film has no time bins"))?;
    let layers: Vec<_> = clock.layers().iter().collect();
    let names: Vec<String> = layers.iter().map(ToString::to_string).collect();
    let whole = || encoded(film, capture, None, Layering { layer: None, layers: &names });
    let part = |(&layer, name): (&TimeLayer, &String)| {
        let (array, sidecar) = encoded(film, capture, Some(layer), Layering { layer: Some(name), layers: &[] })?;
        Ok((name.clone(), array, sidecar))
    };
    let mut parts = layers.iter().zip(&names).map(part);
    match TransientFormat::of(path)? {
        TransientFormat::Npy => {
            parts.try_for_each(|part| {
                let (name, array, sidecar) = part?;
                write_both(&layer_path(path, &name), &array, &sidecar)
            })?;
            let (array, sidecar) = whole()?;
            write_both(path, &array, &sidecar)
        }
        TransientFormat::Npz => {
            let names = if clock.bins() > 0 { [ARRAY, SIDECAR] } else { ["phasors.npy", "phasors.json"] };
            let (array, sidecar) = whole()?;
            let all = names.map(String::from).into_iter().zip([array, sidecar]).map(Ok);
            let parts = parts.map(|part: Result<_>| part.map(|(name, array, _)| (member_of(&name), array)));
            write_whole(path, &encode_npz(all.chain(parts))?)
        }
    }
}

fn write_both(path: &Path, array: &[u8], sidecar: &[u8]) -> Result<()> {
    write_whole(&sidecar_path(path), sidecar)?;
    write_whole(path, array)
}

/// The array of a layer, or of all light, and what stands beside it.
fn encoded(
    film: &Film,
    capture: Option<&Capture>,
    layer: Option<TimeLayer>,
    layering: Layering<'_>,
) -> Result<(Vec<u8>, Vec<u8>)> {
    if let Ok(phasors) = film.phasors(layer) {
        return Ok(encode_phasors(&phasors, layering));
    }
    let light = captured(film.transient(layer)?, capture)?;
    Ok((encode_values(&light), encode_sidecar(&light, layering)?))
}

/// The same with how a wall was captured, if it is one.
fn captured(light: Transient, capture: Option<&Capture>) -> Result<Transient> {
    match capture {
        Some(capture) => light.with_capture(capture.clone()),
        None => Ok(light),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Arrival, Clock, Exposure};
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
        let mut film = Film::new([1, 1]).with_time(clock);
        film.add_pass(&exposure);
        film
    }

    #[test]
    fn layers_in_time_are_read_as_they_were_written() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["a.npy", "a.npz"] {
            let path = folder.path().join(name);
            write_timed(&path, &film(), None).expect("written");
            let read = |layer| read_transient(&path, layer, None).map(|light| light.profile(0, 0).to_vec());
            assert_eq!(read(None).expect("all light"), [[0.0; 3], [2.0; 3], [4.0; 3]]);
            assert_eq!(read(Some("direct")).expect("direct"), [[0.0; 3], [2.0; 3], [0.0; 3]]);
            assert_eq!(read(Some("caustic")).expect("caustic"), [[0.0; 3], [0.0; 3], [4.0; 3]]);
            let error = read(Some("volume")).expect_err("not kept").to_string();
            assert!(error.contains("no layer 'volume'") && error.contains("direct, caustic"), "{error}");
        }
    }
}
