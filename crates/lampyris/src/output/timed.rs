//! Films with time in files: all light by pixel and time, and each layer of it that was kept.

use std::path::Path;

use super::atomic::write_whole;
use super::transient::{
    ARRAY, Layering, SIDECAR, TransientFormat, encode_npz, encode_sidecar, encode_values, layer_path, member_of,
    sidecar_path,
};
use crate::error::{Error, Result};
use crate::film::Film;

/// Writes the time bins of a film as [`write_transient`](super::write_transient) does, with its layers in time: beside
/// `NAME.npy`, `NAME.LAYER.npy` with a `.json` of its own; within an `.npz`, `LAYER.npy`. Each file is written whole or not
/// at all.
///
/// # Errors
/// A film without time, another extension than `.npy` and `.npz`, or what the operating system says.
pub fn write_timed(path: &Path, film: &Film) -> Result<()> {
    let clock = film.clock().ok_or_else(|| Error::new("the film has no time bins"))?;
    let layers: Vec<_> = clock.layers().iter().collect();
    let names: Vec<String> = layers.iter().map(ToString::to_string).collect();
    let (all, whole) = (film.transient(None)?, Layering { layer: None, layers: &names });
    match TransientFormat::of(path)? {
        TransientFormat::Npy => {
            for (&layer, name) in layers.iter().zip(&names) {
                let (path, light) = (layer_path(path, name), film.transient(Some(layer))?);
                let part = Layering { layer: Some(name), layers: &[] };
                write_whole(&sidecar_path(&path), &encode_sidecar(&light, part)?)?;
                write_whole(&path, &encode_values(&light))?;
            }
            write_whole(&sidecar_path(path), &encode_sidecar(&all, whole)?)?;
            write_whole(path, &encode_values(&all))
        }
        TransientFormat::Npz => {
            let part =
                |(&layer, name): (_, &String)| Ok((member_of(name), encode_values(&film.transient(Some(layer))?)));
            let parts = layers.iter().zip(&names).map(part);
            let all = [Ok((ARRAY.into(), encode_values(&all))), Ok((SIDECAR.into(), encode_sidecar(&all, whole)?))];
            write_whole(path, &encode_npz(all.into_iter().chain(parts))?)
        }
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
            let slots = clock.slots_of(optical_length, met);
            exposure.add_arrivals(slots.map(|slot| Arrival { pixel: 0, slot, light: [light; 3] }).collect::<Vec<_>>());
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
            write_timed(&path, &film()).expect("written");
            let read = |layer| read_transient(&path, layer, None).map(|light| light.profile(0, 0).to_vec());
            assert_eq!(read(None).expect("all light"), [[0.0; 3], [2.0; 3], [4.0; 3]]);
            assert_eq!(read(Some("direct")).expect("direct"), [[0.0; 3], [2.0; 3], [0.0; 3]]);
            assert_eq!(read(Some("caustic")).expect("caustic"), [[0.0; 3], [0.0; 3], [4.0; 3]]);
            let error = read(Some("volume")).expect_err("not kept").to_string();
            assert!(error.contains("no layer 'volume'") && error.contains("caustic, direct"), "{error}");
        }
    }
}
