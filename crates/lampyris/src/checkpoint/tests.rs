//! Films that are written, read, damaged and merged.

use proptest::prelude::*;

use super::file::{CHECKSUM, MAGIC};
use super::*;
use crate::film::{Arrival, Clock, Exposure, Features, Storage};
use crate::image::Image;
use crate::import::toml::read_str;
use crate::scene::description::{FilmDescription, TimeDescription};
use crate::scene::{NoAssets, NotedAssets};
use crate::transient::{Capture, LightKind, TimeLayer};

fn identity(settings: &str) -> Identity {
    let text = format!("{settings}\nshapes = [{{ type = 'sphere' }}]");
    let description = read_str("a.toml".as_ref(), &text).expect("a scene").description;
    Identity::new(NotedAssets::new(&NoAssets).fingerprint(&description), &description)
}

/// With weights, areas, layers, and time bins with their variance and a layer.
fn checkpoint(passes: &[u32]) -> Checkpoint {
    let layers = vec![LightKind::Caustic];
    let (start, bin_width) = (Some(0.1), Some(0.7));
    checkpoint_of(TimeDescription { bins: 5, start, bin_width, variance: true, layers, ..Default::default() }, passes)
}

fn checkpoint_of(time: TimeDescription, passes: &[u32]) -> Checkpoint {
    checkpoint_in(&Storage::Memory, time, passes)
}

fn checkpoint_in(storage: &Storage, time: TimeDescription, passes: &[u32]) -> Checkpoint {
    let clock = Clock::of(&FilmDescription { time: Some(time), ..Default::default() }).expect("a clock");
    let mut film = Film::with_layers([3, 2], Layers::ALL).with_time(clock, storage).expect("room");
    film = film.with_capture(Some(capture([0.1, 1.0 / 3.0, f64::MIN_POSITIVE]))).expect("it fits");
    let mut held = PassSet::new();
    for &pass in passes {
        let value = (pass as f32).sin().abs();
        let image = Image::from_pixels(3, 2, vec![[value, 0.1, 1e-20 * value]; 6]).expect("six pixels");
        let features = vec![Features { depth: value, met: 0.3, ..Features::default() }; 6];
        let area = Some((pass, 1.0 / f64::from(pass + 1)));
        let arrival = |pixel| Arrival { pixel, slot: (pass + pixel) % 8, light: [value, 0.1, 0.3] };
        let arrivals = (0..6).filter(|pixel| (pass + pixel) % 3 > 0).map(arrival).collect();
        film.add_pass(&Exposure { image, features, weights: vec![1.0 + value; 6], samples: 3, area, arrivals });
        held.insert(pass);
    }
    Checkpoint {
        identity: identity("film = { filter = { type = 'tent', radius = 1.1 } }"),
        pilot: vec![1, 2],
        passes: held,
        film,
    }
}

/// Of a wall that a film of 3 × 2 pixels shows, lit at this point.
fn capture(laser: [f64; 3]) -> Capture {
    let grid = |point: [f64; 3]| vec![vec![point; 3]; 2];
    Capture {
        sensor_xyz: None,
        laser_xyz: None,
        sensor_grid_xyz: grid([0.2; 3]),
        sensor_grid_normals: grid([0.0, 0.0, 1.0]),
        laser_grid_xyz: vec![vec![laser]],
        laser_grid_normals: vec![vec![[0.0, 0.0, 1.0]]],
        t_accounts_first_and_last_bounces: false,
    }
}

#[test]
fn what_is_written_is_read() {
    let kept = checkpoint(&[3, 4, 5, 9]);
    let read = Checkpoint::decode(&kept.encode()).expect("it is whole");
    assert_eq!(read.film, kept.film);
    assert_eq!((&read.passes, &read.pilot), (&kept.passes, &kept.pilot));
    assert_eq!(kept.identity.difference(&read.identity), None);
    assert_eq!(read.encode(), kept.encode());
}

#[test]
fn a_film_in_a_file_is_that_in_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = Storage::File(folder.path().into());
    let time =
        || TimeDescription { bins: 6, start: Some(0.1), bin_width: Some(0.7), variance: true, ..Default::default() };
    let (mut own, other) = (checkpoint_in(&file, time(), &[3, 4, 5]), checkpoint_in(&file, time(), &[0, 9]));
    own.merge(&other).expect("disjoint");
    let expected = checkpoint_of(time(), &[0, 3, 4, 5, 9]);
    assert_eq!(own, expected);
    let mut none = checkpoint_in(&file, time(), &[]);
    none.merge(&own).expect("disjoint");
    assert_eq!(none, expected, "also where nothing was");
    let bytes = own.encode();
    assert!(bytes == expected.encode());
    let read = Checkpoint::read(&mut bytes.as_slice(), bytes.len() as u64, |bytes| {
        assert_eq!(bytes, 8 * 6 * 4 * 17, "what the bins take");
        file.clone()
    });
    assert_eq!(read.expect("it is whole"), expected);
    assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 0, "no file has a name");
}

#[test]
fn a_picture_is_read_without_its_time() {
    let kept = checkpoint(&[3, 4]);
    let bytes = kept.encode();
    let read = |bytes: &[u8]| Checkpoint::read_picture(&mut &*bytes, bytes.len() as u64);
    let read_film = read(&bytes).expect("it is whole").film;
    assert_eq!((read_film.image(), read_film.clock()), (kept.film.image(), None));
    assert_eq!(read_film.capture(), None);
    let mut damaged = bytes.clone();
    let last = damaged.len() - 9;
    damaged[last] ^= 1;
    assert!(read(&damaged).is_err() && read(&bytes[..last]).is_err());
}

#[test]
fn amplitudes_are_read_as_they_were_written() {
    let frequencies = vec![0.1, 1.0 / 3.0];
    let of = |frequencies: &[f64]| {
        let time = TimeDescription { frequencies: frequencies.to_vec(), bounces: Some(0), ..Default::default() };
        checkpoint_of(time, &[2, 7])
    };
    let (mut kept, others) = (of(&frequencies), of(&[0.1, 0.2]));
    let read = Checkpoint::decode(&kept.encode()).expect("it is whole");
    assert_eq!(read, kept);
    assert_eq!(read.film.clock().map(Clock::frequencies), Some(frequencies));
    assert!(kept.film.merge(&others.film).is_err(), "of other frequencies");
}

#[test]
fn any_split_and_order_makes_the_same_film() {
    let whole = checkpoint(&[0, 1, 2, 3, 4]);
    let parts = [checkpoint(&[1, 4]), checkpoint(&[0]), checkpoint(&[3, 2])];
    for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
        let mut sum = parts[order[0]].clone();
        order[1..].iter().for_each(|&part| sum.merge(&parts[part]).expect("disjoint"));
        assert_eq!(sum, whole);
    }
}

#[test]
fn walls_that_were_captured_in_different_ways_are_told_apart_and_must_fit() {
    let mut own = checkpoint(&[0]);
    let captured = |laser| own.film.clone().with_capture(laser);
    let other = Checkpoint { film: captured(Some(capture([0.3; 3]))).expect("it fits"), ..checkpoint(&[1]) };
    let none = Checkpoint { film: captured(None).expect("nothing fits"), ..checkpoint(&[1]) };
    assert!(captured(Some(Capture { sensor_grid_xyz: Vec::new(), ..capture([0.3; 3]) })).is_err());
    let before = own.clone();
    for other in [other, none] {
        let said = own.merge(&other).expect_err("another wall").message;
        assert_eq!(said, "films of walls that were captured in different ways cannot be merged");
        assert_eq!(own, before);
    }
}

#[test]
fn a_pass_is_never_counted_twice() {
    let mut sum = checkpoint(&[0, 1, 2]);
    let before = sum.clone();
    assert_eq!(sum.merge(&checkpoint(&[2, 3])).expect_err("overlap").message, "both have pass 2");
    assert_eq!(sum, before);
}

#[test]
fn what_differs_is_named() {
    let own = identity("integrator = { type = 'photon-map', alpha = 0.7 }");
    let difference = |settings: &str| own.difference(&identity(settings));
    assert_eq!(difference("integrator = { type = 'photon-map', alpha = 0.7 }\nrender = { passes = 9 }"), None);
    let told = [
        ("integrator = { type = 'photon-map', alpha = 0.7 }\nrender = { seed = 3 }", "of seed 3 instead of 0"),
        (
            "integrator = { type = 'photon-map', alpha = 0.7, k = 9 }",
            "of another integrator.photon-map.k: 9 instead of 50",
        ),
        (
            "integrator = { type = 'photon-map', alpha = 0.7 }\nrender = { spectral = true }",
            "of another render.spectral: true instead of none",
        ),
        (
            "integrator = { type = 'photon-map', alpha = 0.7 }\nlights = [{ type = 'constant', radiance = 1 }]",
            "of another scene",
        ),
    ];
    for (settings, expected) in told {
        assert_eq!(difference(settings).as_deref(), Some(expected), "{settings}");
    }
    assert!(difference("integrator = { type = 'path' }").is_some_and(|told| told.contains("integrator")));
}

#[test]
fn other_files_and_other_versions_are_told_apart() {
    let message = |bytes: &[u8]| Checkpoint::decode(bytes).expect_err("no film").message;
    assert_eq!(message(b""), "not a film of Lampyris");
    assert_eq!(message(b"PNG"), "not a film of Lampyris");
    assert_eq!(message(b"LAMPYRIS FILM 1\n"), "a film of another version of Lampyris");
    assert_eq!(message(MAGIC), "the film is damaged or cut short");
}

/// With other text in its header, filled up with spaces, and a checksum that fits.
fn replaced(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let to = format!("{to:<0$}", from.len());
    assert_eq!(from.len(), to.len());
    let at = bytes.windows(from.len()).position(|window| window == from.as_bytes()).expect("in the header");
    sealed([&bytes[..at], to.as_bytes(), &bytes[at + from.len()..bytes.len() - CHECKSUM]].concat())
}

#[test]
fn a_wall_that_does_not_fit_the_film_is_damage() {
    let kept = checkpoint(&[0]).encode();
    Checkpoint::decode(&replaced(&kept, "[0.2,0.2,0.2]]", "[0.2,0.2,0.7]]")).expect("another point");
    let point = "[0.2,0.2,0.2],[0.2,0.2,0.2]]]";
    for other in ["[0.2,0.2,0.2]]]", "[0.2,0.2,null],[0.2,0.2,0]]]"] {
        let error = Checkpoint::decode(&replaced(&kept, point, other)).expect_err(other);
        assert_eq!(error.message, "the film is damaged or cut short");
    }
}

/// With a checksum that fits.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

#[test]
fn sizes_that_are_not_there_take_no_memory() {
    let kept = checkpoint(&[0]).encode();
    let text = String::from_utf8_lossy(&kept).to_string();
    let start = text.find("\"size\":[3,2],\"passes\"").expect("in the header");
    for size in ["[4294967295,4294967295]", "[18446744073709551615,9]", "[4,2]", "[0,0]"] {
        let (head, rest) = (&kept[24..start], &kept[start + "\"size\":[3,2]".len()..kept.len() - CHECKSUM]);
        let length = u64::from_le_bytes(kept[16..24].try_into().expect("eight")) as usize + size.len() - "[3,2]".len();
        let parts: [&[u8]; 6] = [MAGIC, &(length as u64).to_le_bytes(), head, b"\"size\":", size.as_bytes(), rest];
        Checkpoint::decode(&sealed(parts.concat())).expect_err(size);
    }
}

proptest! {
    #[test]
    fn damage_is_found(at in any::<prop::sample::Index>(), bit in 0..8u8, cut in any::<prop::sample::Index>()) {
        let mut bytes = checkpoint(&[0, 1]).encode();
        prop_assert!(Checkpoint::decode(&bytes[..cut.index(bytes.len())]).is_err());
        *at.get_mut(&mut bytes) ^= 1 << bit;
        prop_assert!(Checkpoint::decode(&bytes).is_err());
    }

    #[test]
    fn damage_under_a_checksum_that_fits_does_no_harm(
        keeps_bins in any::<bool>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let frequencies = || TimeDescription { frequencies: vec![0.1, 0.5], bounces: Some(1), ..Default::default() };
        let whole = if keeps_bins { checkpoint(&[0, 1]) } else { checkpoint_of(frequencies(), &[0, 1]) };
        let mut bytes = whole.encode();
        bytes.truncate(bytes.len() - CHECKSUM);
        changes.iter().for_each(|(at, byte)| *at.get_mut(&mut bytes) = *byte);
        if let Ok(mut read) = Checkpoint::decode(&sealed(bytes)) {
            let film = &read.film;
            let _ = (film.image(), film.relative_error(), film.layer(crate::film::Layer::Depth));
            let _ = (film.bins(0), film.outside_bins(0), film.variance_of_bins(0), film.share_outside_bins());
            for layer in [None, Some(TimeLayer::MoreBounces), Some(TimeLayer::Kind(LightKind::Caustic))] {
                let _ = (film.transient(layer), film.phasors(layer));
            }
            let _ = read.merge(&checkpoint(&[7]));
            let _ = read.encode();
        }
    }
}
