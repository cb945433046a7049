//! Renders kept in files: a film, the passes that it holds, and what it takes to go on with others.
//!
//! A file is, all numbers in little-endian order:
//!
//! | bytes | what |
//! |---|---|
//! | 16 | `LAMPYRIS FILM 4` and a line feed; the number is the version of this table |
//! | 8 | the length of the header |
//! | | the header, in JSON: the [`Identity`], the passes, the layers, how a wall is captured |
//! | 8 | the length of the pilot |
//! | | what the integrator measured before the first pass, in a form of its own |
//! | | the sums: for each of them, the higher limbs of all pixels, the lower limbs, and the numbers of the limbs |
//! | 4 | CRC-32 of all before |

use std::io::{self, Read, Write};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::{Error, Result};
use crate::film::{Film, FilmShape, Layers, PassSet, Storage};
use crate::scene::{Fingerprint, SceneDescription};

/// A film with all that it takes to go on, or to be merged with others of the same render.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    identity: Identity,
    pilot: Vec<u8>,
    passes: PassSet,
    film: Film,
}

/// Everything that a pass depends on beside its number. What has the same identity can be merged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Of the program: another one may compute otherwise.
    version: String,
    /// Of all but camera and settings.
    scene: Fingerprint,
    seed: u64,
    /// Whether light was made to have wavelengths, or not to.
    spectral: Option<bool>,
    integrator: Value,
    film: Value,
    camera: Value,
}

/// The header of a file.
#[derive(Serialize, Deserialize)]
struct Header {
    identity: Identity,
    passes: PassSet,
    film: FilmShape,
}

impl Identity {
    /// Of a scene with this fingerprint, rendered as its description says.
    pub fn new(scene: Fingerprint, description: &SceneDescription) -> Identity {
        // What can be said in a scene file can be said in JSON.
        let value = |part: serde_json::Result<Value>| part.unwrap_or_default();
        Identity {
            version: env!("CARGO_PKG_VERSION").into(),
            scene,
            seed: description.render.seed,
            spectral: description.render.spectral,
            integrator: value(serde_json::to_value(&description.integrator)),
            film: value(serde_json::to_value(&description.film)),
            camera: value(serde_json::to_value(&description.camera)),
        }
    }

    /// What sets another identity apart from this one, such as `seed: 1 instead of 2`; none if nothing does.
    pub fn difference(&self, other: &Identity) -> Option<String> {
        if self.version != other.version {
            return Some(format!("made by version {} instead of {}", other.version, self.version));
        }
        if self.seed != other.seed {
            return Some(format!("of seed {} instead of {}", other.seed, self.seed));
        }
        let word = |spectral: Option<bool>| spectral.map_or(Value::Null, Value::Bool);
        if let Some(difference) = difference("render.spectral", &word(self.spectral), &word(other.spectral)) {
            return Some(difference);
        }
        let parts = [
            ("integrator", &self.integrator, &other.integrator),
            ("film", &self.film, &other.film),
            ("camera", &self.camera, &other.camera),
        ];
        let of_setting = parts.into_iter().find_map(|(name, own, other)| difference(name, own, other));
        of_setting.or_else(|| (self.scene != other.scene).then(|| "of another scene".to_string()))
    }

    /// The name of the integrator, for those who look at a film.
    pub fn integrator(&self) -> &str {
        let name = self.integrator.as_object().and_then(|tagged| tagged.keys().next());
        name.map_or("unknown", String::as_str)
    }

    /// The seed.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The version of the program.
    pub fn version(&self) -> &str {
        &self.version
    }
}

/// The first key whose value differs, with both values.
fn difference(key: &str, own: &Value, other: &Value) -> Option<String> {
    let none = &Value::Null;
    match (own, other) {
        (Value::Object(own), Value::Object(other)) => {
            let keys = own.keys().chain(other.keys().filter(|key| !own.contains_key(*key)));
            let mut pairs = keys.map(|name| (name, own.get(name).unwrap_or(none), other.get(name).unwrap_or(none)));
            pairs.find_map(|(name, own, other)| difference(&format!("{key}.{name}"), own, other))
        }
        _ => (!is_same(own, other)).then(|| format!("of another {key}: {} instead of {}", said(other), said(own))),
    }
}

/// Whether two values are the same, one of which may have been written and read again: the last bit of a double can be
/// lost on the way, and settings have single precision.
fn is_same(own: &Value, other: &Value) -> bool {
    match (own, other) {
        (Value::Array(own), Value::Array(other)) => {
            own.len() == other.len() && own.iter().zip(other).all(|(own, other)| is_same(own, other))
        }
        (Value::Number(own), Value::Number(other)) if own.is_f64() && other.is_f64() => {
            own.as_f64().map(|value| value as f32) == other.as_f64().map(|value| value as f32)
        }
        _ => own == other,
    }
}

/// A value as people would say it.
fn said(value: &Value) -> String {
    match value {
        Value::Null => "none".into(),
        Value::String(text) => text.clone(),
        Value::Object(_) => "another".into(),
        value => value.to_string(),
    }
}

const MAGIC: &[u8; 16] = b"LAMPYRIS FILM 4\n";
/// What the files of all versions begin with.
const ANY_VERSION: usize = 14;
const CHECKSUM: usize = 4;

impl Checkpoint {
    /// Whether bytes begin as those of a film do.
    pub fn is_in(bytes: &[u8]) -> bool {
        bytes.starts_with(&MAGIC[..ANY_VERSION])
    }

    /// The bytes of a file.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        // There is always room in memory.
        let _ = self.write(&mut bytes);
        bytes
    }

    /// Writes the bytes of a file, a part at a time.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn write(&self, to: &mut dyn Write) -> io::Result<()> {
        write(&self.identity, &self.pilot, &self.passes, &self.film, to)
    }

    /// What [`Checkpoint::encode`] made, in memory.
    ///
    /// # Errors
    /// Bytes that are no film, of another version, cut short or damaged.
    pub fn decode(mut bytes: &[u8]) -> Result<Checkpoint> {
        let length = bytes.len() as u64;
        Checkpoint::read(&mut bytes, length, |_| Storage::Memory)
    }

    /// What [`Checkpoint::write`] wrote, in so many bytes. `storage` says where its time bins are to be, which take so many.
    ///
    /// # Errors
    /// Bytes that are no film, of another version, cut short or damaged; those of `from`, and files for which there is no
    /// room.
    pub fn read(from: &mut dyn Read, length: u64, storage: impl FnOnce(u64) -> Storage) -> Result<Checkpoint> {
        Checkpoint::read_shaped(from, length, |shape| storage(shape.bytes_of_bins() as u64))
    }

    /// [`Checkpoint::read`] without time bins, for those who ask for the picture alone.
    ///
    /// # Errors
    /// As there.
    pub fn read_picture(from: &mut dyn Read, length: u64) -> Result<Checkpoint> {
        Checkpoint::read_shaped(from, length, |shape| {
            shape.drop_time();
            Storage::Memory
        })
    }

    /// `keep` may take from the shape what comes last.
    fn read_shaped(
        from: &mut dyn Read,
        length: u64,
        keep: impl FnOnce(&mut FilmShape) -> Storage,
    ) -> Result<Checkpoint> {
        let mut from = Hashed { inner: from, hash: crc32fast::Hasher::new(), left: length };
        let mut magic = [0; MAGIC.len()];
        let known = MAGIC.len().min(usize::try_from(length).unwrap_or(MAGIC.len()));
        from.read_exact(&mut magic[..known]).map_err(unread)?;
        if !Checkpoint::is_in(&magic) {
            return Err(Error::new("not a film of Lampyris").with_hint("films are what --checkpoint and merge write"));
        }
        if magic != *MAGIC {
            return Err(Error::new("a film of another version of Lampyris")
                .with_hint("go on with the version that wrote it, or begin anew"));
        }
        let mut header: Header = serde_json::from_slice(&part(&mut from)?).map_err(|_| damaged())?;
        let pilot = part(&mut from)?;
        // Before any memory is taken.
        let claimed = header.film.bytes().and_then(|bytes| u64::try_from(bytes).ok()?.checked_add(CHECKSUM as u64));
        if claimed != Some(from.left) || header.passes.count() != u64::from(header.film.passes()) {
            return Err(damaged());
        }
        let storage = keep(&mut header.film);
        let mut film = header.film.empty(&storage)?.ok_or_else(damaged)?;
        film.read_sums(&mut from).map_err(unread)?;
        let left = from.left.saturating_sub(CHECKSUM as u64);
        io::copy(&mut (&mut from).take(left), &mut io::sink()).map_err(unread)?;
        let hash = from.hash.clone().finalize();
        let mut checksum = [0; CHECKSUM];
        from.read_exact(&mut checksum).map_err(unread)?;
        if hash != u32::from_le_bytes(checksum) {
            return Err(damaged());
        }
        Ok(Checkpoint { identity: header.identity, pilot, passes: header.passes, film })
    }

    /// Adds the passes of another checkpoint of the same render.
    ///
    /// # Errors
    /// If it is of another one, or both have a pass. This one is as before then.
    pub fn merge(&mut self, other: &Checkpoint) -> Result<()> {
        if let Some(difference) = self.identity.difference(&other.identity) {
            return Err(Error::new(format!("the films do not belong together: one is {difference}")));
        }
        if self.pilot != other.pilot {
            return Err(Error::new("the films do not belong together: their pilots measured different things"));
        }
        let mut passes = self.passes.clone();
        passes.add(&other.passes)?;
        self.film.merge(&other.film)?;
        self.passes = passes;
        Ok(())
    }

    /// What it is of.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// The passes that it holds.
    pub fn passes(&self) -> &PassSet {
        &self.passes
    }

    /// The layers that it holds.
    pub fn layers(&self) -> Layers {
        self.film.layers()
    }

    /// The film.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// What the integrator measured before the first pass.
    pub fn pilot(&self) -> &[u8] {
        &self.pilot
    }

    pub(crate) fn into_film(self) -> (Film, PassSet) {
        (self.film, self.passes)
    }
}

/// Writes the bytes of a file with a film that holds these passes; `pilot` is what the integrator measured.
pub(crate) fn write(
    identity: &Identity,
    pilot: &[u8],
    passes: &PassSet,
    film: &Film,
    to: &mut dyn Write,
) -> io::Result<()> {
    let header = Header { identity: identity.clone(), passes: passes.clone(), film: film.shape() };
    let header = serde_json::to_vec(&header)?;
    let mut to = Hashed { inner: to, hash: crc32fast::Hasher::new(), left: u64::MAX };
    to.write_all(MAGIC)?;
    for part in [&header, pilot] {
        to.write_all(&(part.len() as u64).to_le_bytes())?;
        to.write_all(part)?;
    }
    film.write_sums(&mut to)?;
    let checksum = to.hash.finalize();
    to.inner.write_all(&checksum.to_le_bytes())
}

/// Bytes on their way from or to a file.
struct Hashed<I> {
    inner: I,
    /// Of all that have passed.
    hash: crc32fast::Hasher,
    /// How many are still to come.
    left: u64,
}

impl<R: Read> Read for Hashed<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let most = bytes.len().min(usize::try_from(self.left).unwrap_or(usize::MAX));
        let count = self.inner.read(&mut bytes[..most])?;
        self.hash.update(&bytes[..count]);
        self.left -= count as u64;
        Ok(count)
    }
}

impl<W: Write> Write for Hashed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.inner.write(bytes)?;
        self.hash.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// A part with its length before it, which takes no more memory than there are bytes.
fn part<R: Read>(from: &mut Hashed<R>) -> Result<Vec<u8>> {
    let mut length = [0; 8];
    from.read_exact(&mut length).map_err(unread)?;
    let length = u64::from_le_bytes(length);
    if length > from.left {
        return Err(damaged());
    }
    let mut part = Vec::new();
    from.take(length).read_to_end(&mut part).map_err(unread)?;
    if part.len() as u64 == length { Ok(part) } else { Err(damaged()) }
}

fn damaged() -> Error {
    Error::new("the film is damaged or cut short")
}

/// Why a film cannot be read on.
fn unread(error: io::Error) -> Error {
    match error.kind() {
        io::ErrorKind::UnexpectedEof | io::ErrorKind::InvalidData => damaged(),
        _ => Error::new(format!("the film cannot be read: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Arrival, Clock, Exposure, Features};
    use crate::image::Image;
    use crate::import::toml::read_str;
    use crate::scene::description::{FilmDescription, TimeDescription};
    use crate::scene::{NoAssets, NotedAssets};
    use crate::transient::{Capture, LightKind, TimeLayer};
    use proptest::prelude::*;

    fn identity(settings: &str) -> Identity {
        let text = format!("{settings}\nshapes = [{{ type = 'sphere' }}]");
        let description = read_str("a.toml".as_ref(), &text).expect("a scene").description;
        Identity::new(NotedAssets::new(&NoAssets).fingerprint(&description), &description)
    }

    /// With weights, areas, layers, and time bins with their variance and a layer.
    fn checkpoint(passes: &[u32]) -> Checkpoint {
        let layers = vec![LightKind::Caustic];
        let (start, bin_width) = (Some(0.1), Some(0.7));
        checkpoint_of(
            TimeDescription { bins: 5, start, bin_width, variance: true, layers, ..Default::default() },
            passes,
        )
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
        let time = || TimeDescription {
            bins: 6,
            start: Some(0.1),
            bin_width: Some(0.7),
            variance: true,
            ..Default::default()
        };
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
            let length =
                u64::from_le_bytes(kept[16..24].try_into().expect("eight")) as usize + size.len() - "[3,2]".len();
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
}
