//! Films in files: written on the way, gone on with, merged, and made into pictures.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use lampyris::checkpoint::{Checkpoint, Identity};
use lampyris::error::{Error, Result};
use lampyris::film::{Film, Layer};
use lampyris::image::Image;
use lampyris::output::{
    Fact, Picture, TransientFormat, check_path, check_transient_path, check_writable, is_hdf5, read_whole,
    write_picture, write_timed, write_whole_by,
};
use lampyris::render::Render;

use crate::args::MergeArguments;
use crate::format::plural;
use crate::memory::{free, storage};
use crate::report::{Failure, print};

/// How often a film is written, unless told otherwise.
const INTERVAL: Duration = Duration::from_secs(60);

/// Whether a file is a film, by its name.
pub fn is_film(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("film"))
}

/// Reads a film, whose time bins may take so much memory; else they are kept in a file beside `beside`.
///
/// # Errors
/// A file that cannot be read, or that is no film, of another version, or damaged; and if there is no room for it.
pub fn read(path: &Path, memory: u64, beside: &Path) -> Result<Checkpoint> {
    read_by(path, |from, length| Checkpoint::read(from, length, |bytes| storage(bytes, memory, beside)))
}

/// Reads a film without its time bins.
///
/// # Errors
/// As [`read`].
pub fn read_picture(path: &Path) -> Result<Checkpoint> {
    read_by(path, |from, length| Checkpoint::read_picture(from, length))
}

/// Bytes that are read or written at a time.
const BUFFER: usize = 1 << 20;

fn read_by(path: &Path, read: impl FnOnce(&mut dyn Read, u64) -> Result<Checkpoint>) -> Result<Checkpoint> {
    let fail = |error| Error::io(path, "read", &error);
    let file = File::open(path).map_err(fail)?;
    let there = file.metadata().map_err(fail)?;
    if !there.is_file() {
        // Pipes do not say how long they are.
        return Checkpoint::decode(&read_whole(path)?).map_err(|error| error.with_file(path));
    }
    let mut from = BufReader::with_capacity(BUFFER, file);
    read(&mut from, there.len()).map_err(|error| error.with_file(path))
}

/// The picture of a film, or one of its layers.
///
/// # Errors
/// As [`read`], or if it does not have the layer.
pub fn read_image(path: &Path, layer: Option<&str>) -> Result<Image> {
    let checkpoint = read_picture(path)?;
    let film = checkpoint.film();
    let Some(name) = layer else { return Ok(film.image()) };
    let layer = Layer::ALL.into_iter().find(|layer| layer.name() == name).and_then(|layer| film.layer(layer));
    layer.ok_or_else(|| Error::new(format!("there is no layer '{name}' in the film")).with_file(path))
}

/// The picture of a film with its layers.
pub fn pictures(film: &Film) -> (Image, Vec<(Layer, Image)>) {
    let layers = film.layers().iter().filter_map(|layer| Some((layer, film.layer(layer)?)));
    (film.image(), layers.collect())
}

/// Where the picture of a film comes from, as far as the film knows.
pub fn facts(film: &Checkpoint) -> Vec<(&'static str, Fact)> {
    let (identity, passes) = (film.identity(), film.film().passes());
    vec![
        ("version", Fact::Text(identity.version().into())),
        ("integrator", Fact::Text(identity.integrator().into())),
        ("seed", Fact::Text(identity.seed().to_string())),
        ("passes", Fact::Whole(i32::try_from(passes).unwrap_or(i32::MAX))),
    ]
}

/// Writes a picture to all of these places, with its layers where a file has room for them; and if it is that of a film with
/// time, the bins in place of it where a file has room for those.
///
/// # Errors
/// Whatever keeps any of them from being written: the others are.
pub fn write_all(picture: &Picture<'_>, film: Option<&Film>, outputs: &[&Path]) -> Result<(), Failure> {
    let film = film.filter(|film| film.clock().is_some());
    let holds_time = |path: &&&Path| film.is_some() && holds_time(path);
    let (timed, plain): (Vec<&Path>, Vec<&Path>) = outputs.iter().partition(holds_time);
    let mut faults: Vec<Error> = plain.iter().filter_map(|path| write_picture(path, picture).err()).collect();
    if let (Some(film), false) = (film, timed.is_empty()) {
        faults.extend(timed.iter().filter_map(|path| write_timed(path, film).err()));
    }
    Failure::if_any(faults)
}

/// Whether a file has room for light by time.
fn holds_time(path: &Path) -> bool {
    TransientFormat::of(path).is_ok() || is_hdf5(path)
}

/// Finds what of these places has room for bins of captured walls alone, which a film may not have.
///
/// # Errors
/// The first of them.
pub fn check_captured(outputs: &[&Path], is_captured: bool, has_bins: bool) -> Result<()> {
    let Some(path) = outputs.iter().find(|path| is_hdf5(path)).filter(|_| !is_captured || !has_bins) else {
        return Ok(());
    };
    let (why, hint) = if is_captured {
        ("the film has amplitudes in place of time bins", "HDF5 holds bins; .npz holds amplitudes, too")
    } else {
        ("the camera captures no wall", "HDF5 needs a camera with a capture; .npz holds light by time of any other")
    };
    Err(Error::new(format!("cannot write '{}': {why}", path.display())).with_hint(hint))
}

/// Finds what would stop a picture from being written to `path`; what only a film with time can be written to is no fault
/// yet.
///
/// # Errors
/// An unknown extension, and what the operating system says.
pub fn check_output(path: &Path) -> Result<()> {
    if is_hdf5(path) || check_transient_path(path).is_ok() { check_writable(path) } else { check_path(path) }
}

/// Finds what of these places has room for a film with time alone, which this is not.
///
/// # Errors
/// The first of them.
pub fn check_without_time(outputs: &[&Path]) -> Result<()> {
    outputs.iter().try_for_each(|path| match (check_path(path), holds_time(path)) {
        (Err(_), true) => Err(Error::new(format!("cannot write '{}': the film has no time bins", path.display()))
            .with_hint("give the film time, such as by --set time.bins=256")),
        (checked, _) => checked,
    })
}

/// The file that a render keeps its film in.
#[derive(Debug)]
pub struct Keeper {
    file: PathBuf,
    identity: Identity,
    every: Duration,
    written: Instant,
}

impl Keeper {
    /// Before the first pass.
    pub fn new(file: &Path, identity: Identity, every: Option<Duration>) -> Keeper {
        Keeper { file: file.to_path_buf(), identity, every: every.unwrap_or(INTERVAL), written: Instant::now() }
    }

    /// Whether it is time to write again.
    pub fn is_due(&self) -> bool {
        self.written.elapsed() >= self.every
    }

    /// Writes the film, whole or not at all.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn write(&mut self, render: &Render<'_>) -> Result<()> {
        let written = write_film(&self.file, |to| render.write_checkpoint(&self.identity, to));
        // Also after a failure: the disk may have room later, and to try after each pass would slow the render.
        self.written = Instant::now();
        written
    }
}

/// Writes a film, whole or not at all.
fn write_film(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    write_whole_by(path, |file| {
        let mut to = BufWriter::with_capacity(BUFFER, file);
        write(&mut to)?;
        to.flush()
    })
}

/// `lampyris merge`.
///
/// # Errors
/// Films that do not belong together or share a pass, and what keeps files from being read or written. Nothing is written
/// then.
pub fn merge(arguments: &MergeArguments) -> Result<(), Failure> {
    for output in &arguments.outputs {
        if is_film(output) { check_writable(output)? } else { check_output(output)? }
    }
    let mut films = arguments.films.iter();
    let Some(first) = films.next() else { return Ok(()) };
    let beside = arguments.outputs.first().unwrap_or(first);
    let memory = arguments.memory.unwrap_or_else(free);
    let read = |path| read(path, memory, beside);
    let mut sum = read(first)?;
    for path in films {
        sum.merge(&read(path)?).map_err(|error| {
            let fault = format!("cannot merge '{}' with '{}': {}", path.display(), first.display(), error.message);
            Error::new(fault).with_hint("merge films of one scene and its settings, each with passes of its own")
        })?;
    }
    let (pictures, kept): (Vec<_>, Vec<_>) =
        arguments.outputs.iter().map(PathBuf::as_path).partition(|path| !is_film(path));
    if sum.film().clock().is_none() {
        check_without_time(&pictures)?;
    }
    let has_bins = sum.film().clock().is_some_and(|clock| clock.bins() > 0);
    check_captured(&pictures, sum.film().capture().is_some(), has_bins)?;
    kept.iter().try_for_each(|path| write_film(path, |to| sum.write(to)))?;
    if !pictures.is_empty() {
        let (image, layers) = self::pictures(sum.film());
        write_all(
            &Picture { image: &image, noisy: None, layers: &layers, facts: &facts(&sum) },
            Some(sum.film()),
            &pictures,
        )?;
    }
    Ok(print(&format!("{}: {}\n", plural(sum.film().passes() as usize, "pass"), sum.passes()))?)
}
