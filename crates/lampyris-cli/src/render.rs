//! `lampyris render`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

use lampyris::checkpoint::{Checkpoint, Identity};
use lampyris::denoise::Denoiser;
use lampyris::error::{Error, Result, Warning};
use lampyris::film::{Clock, Layers, PassSet, Storage};
use lampyris::import::Imported;
use lampyris::integrator::Silent;
use lampyris::output::{Fact, Format, Picture, check_writable};
use lampyris::render::Render;
use lampyris::scene::Scene;
use lampyris::scene::description::FilmDescription;
use lampyris::transient::SPEED_OF_LIGHT;

use crate::args::{PreviewTarget, RenderArguments};
use crate::budget::Budget;
use crate::denoise::{GUIDES, denoise, denoised_by};
use crate::films::{self, Keeper};
use crate::format::{bias, bytes, percent, plural, time};
use crate::interrupt::Interrupt;
use crate::memory::{free, storage};
use crate::meter::{Meter, Stage};
use crate::preview::Preview;
use crate::progress::{Display, Loading, Progress};
use crate::report::Failure;
use crate::scene::{change, heed, read, ready, ready_identified, warnings};
use crate::snapshots::Snapshots;
use crate::stats::{Done, ErrorCurve, Stats};

/// Renders a scene and writes the picture.
///
/// # Errors
/// Whatever is wrong with the scene or the places of the files, all of it found before the work begins; and what
/// keeps the files from being written in the end.
pub fn run(arguments: &RenderArguments) -> Result<(), Failure> {
    let meter = Meter::start();
    let denoiser = arguments.denoise.then(Denoiser::new).transpose()?;
    let outputs = outputs(arguments)?;
    let memory = arguments.memory.unwrap_or_else(free);
    let begun = arguments.resume.as_deref();
    let begun = begun.map(|path| films::read(path, memory, beside(arguments, &outputs))).transpose()?;
    let layers = layers(arguments, &outputs, begun.as_ref())?;
    let snapshots = Snapshots::new(outputs.first().map(PathBuf::as_path).filter(|_| arguments.snapshots))?;
    let mut imported = read(&arguments.scene)?;
    apply(arguments, &mut imported)?;
    let paths: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
    let time = imported.description.film.time.as_ref();
    if time.is_none() {
        films::check_without_time(&paths)?;
    }
    let pool = pool(arguments.work.threads.map_or(0, usize::from))?;
    let has_picture = arguments.preview.contains(&PreviewTarget::Terminal);
    let display = Display::new(arguments.work.quiet, has_picture);
    let loading = Loading::new(&meter, &arguments.scene.scene, display.clone());
    let (scene, set) = (&arguments.scene, &arguments.changes.settings);
    let built = pool.install(|| match kept_in(arguments) {
        Some(_) => ready_identified(scene, &imported, set, &loading).map(|(built, identity)| (built, Some(identity))),
        None => ready(scene, &imported, set, &loading).map(|built| (built, None)),
    });
    display.clear();
    let (built, identity) = built?;
    let has_bins = time.is_some_and(|time| !time.keeps_amplitudes());
    films::check_captured(&paths, built.scene.camera().wall().is_some(), has_bins)?;
    if let (Some(path), Some(begun), Some(identity)) = (&arguments.resume, &begun, &identity) {
        belongs(path, begun, identity)?;
    }
    let warnings = warnings(&arguments.scene, &imported, &built);
    heed(&warnings, arguments.scene.strict, arguments.work.quiet)?;
    if let Some(path) = arguments.checkpoint.as_deref().filter(|path| begun.is_none() && path.is_file()) {
        let warning = Warning::new(format!("'{}' will be written over", path.display()));
        display.warn(&warning.with_hint("to go on with the film in it, use --resume"));
    }
    let keeper = kept_in(arguments).zip(identity);
    let keeper = keeper.map(|(file, identity)| Keeper::new(file, identity, arguments.checkpoint_every));
    if arguments.denoise && !GUIDES.into_iter().all(|layer| layers.contains(layer)) {
        let warning = Warning::new("the film has no layers albedo and normal to denoise by");
        display.warn(&warning.with_hint("textures will be blurred; begin anew with --denoise"));
    }
    let job =
        Job { arguments, imported: &imported, scene: &built.scene, outputs: &outputs, layers, memory, meter: &meter };
    let stats = pool.install(|| job.run(display, &warnings, snapshots, begun, keeper, denoiser))?;
    if let Some(path) = &arguments.stats {
        stats.write(path)?;
    }
    Ok(())
}

/// Beside which file a film lies that takes too much memory.
fn beside<'a>(arguments: &'a RenderArguments, outputs: &'a [PathBuf]) -> &'a Path {
    kept_in(arguments).or(outputs.first().map(PathBuf::as_path)).unwrap_or(Path::new("."))
}

/// The file that keeps the film.
fn kept_in(arguments: &RenderArguments) -> Option<&Path> {
    arguments.checkpoint.as_deref().or(arguments.resume.as_deref())
}

/// Checks that a film is one of this scene with these settings.
fn belongs(path: &Path, begun: &Checkpoint, identity: &Identity) -> Result<()> {
    let Some(difference) = identity.difference(begun.identity()) else { return Ok(()) };
    let error = Error::new(format!("cannot resume '{}': it is {difference}", path.display()));
    Err(error.with_hint("a film goes on with the scene, settings, seed and version that it was begun with"))
}

/// Where the picture goes: all places are checked.
fn outputs(arguments: &RenderArguments) -> Result<Vec<PathBuf>> {
    let outputs = match arguments.outputs.as_slice() {
        [] => vec![PathBuf::from(arguments.scene.scene.file_stem().unwrap_or_default()).with_extension("png")],
        given => given.to_vec(),
    };
    outputs.iter().try_for_each(|path| films::check_output(path))?;
    if let Some(stats) = &arguments.stats {
        check_writable(stats)?;
        if outputs.contains(stats) {
            let message = format!("'{}' cannot hold both the picture and the statistics", stats.display());
            return Err(Error::new(message).with_hint("give --stats another file, such as stats.json"));
        }
    }
    if let Some(film) = kept_in(arguments) {
        check_writable(film)?;
        if outputs.iter().chain(&arguments.stats).any(|path| path == film) {
            let message = format!("'{}' cannot hold both the film and something else", film.display());
            return Err(Error::new(message).with_hint("give --checkpoint another file, such as render.film"));
        }
    } else if arguments.checkpoint_every.is_some() {
        return Err(Error::new("--checkpoint-every needs a film to write").with_hint("add --checkpoint FILE"));
    }
    Ok(outputs)
}

/// The layers to compute: those of the film that is gone on with; else those that the user asks for, or all of them if a
/// picture can hold them, and what the denoiser needs.
fn layers(arguments: &RenderArguments, outputs: &[PathBuf], begun: Option<&Checkpoint>) -> Result<Layers> {
    let is_exr = |path: &PathBuf| Format::of(path).is_ok_and(|format| format == Format::Exr);
    if let (Some(begun), Some(path)) = (begun, &arguments.resume) {
        return match arguments.layers {
            Some(layers) if needed(arguments, layers) != begun.film().layers() => {
                Err(Error::new(format!("cannot resume '{}': it has other layers", path.display()))
                    .with_hint("leave --layers out, or begin anew"))
            }
            _ => Ok(begun.film().layers()),
        };
    }
    let layers = match (arguments.layers, outputs.iter().any(is_exr)) {
        (Some(layers), false) if !layers.is_empty() && arguments.checkpoint.is_none() => {
            return Err(Error::new("only .exr files hold layers, and none is to be written")
                .with_hint("add -o FILE.exr, or leave --layers out"));
        }
        (given, has_exr) => given.unwrap_or(if has_exr { Layers::ALL } else { Layers::NONE }),
    };
    Ok(needed(arguments, layers))
}

/// These layers, and those that the denoiser needs.
fn needed(arguments: &RenderArguments, layers: Layers) -> Layers {
    if arguments.denoise { GUIDES.into_iter().fold(layers, Layers::with) } else { layers }
}

/// Changes the scene's settings to those of the command line.
fn apply(arguments: &RenderArguments, imported: &mut Imported) -> Result<()> {
    if let Some(name) = &arguments.integrator {
        imported.description.use_integrator(name)?;
    }
    if let Some(size) = arguments.size {
        imported.description.film.size = size;
    }
    change(imported, &arguments.changes)
}

/// A pool of so many threads, 0 for one on each core.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| {
        Error::new(format!("cannot start the threads: {error}")).with_hint("ask for fewer with --threads")
    })
}

/// A render with all that it needs.
struct Job<'a> {
    arguments: &'a RenderArguments,
    imported: &'a Imported,
    scene: &'a Scene,
    outputs: &'a [PathBuf],
    layers: Layers,
    /// Bytes that the film may take of memory.
    memory: u64,
    meter: &'a Meter,
}

impl Job<'_> {
    fn run(
        &self,
        display: Display,
        warnings: &[Error],
        mut snapshots: Snapshots,
        begun: Option<Checkpoint>,
        mut keeper: Option<Keeper>,
        denoiser: Option<Denoiser>,
    ) -> Result<Stats, Failure> {
        let description = &self.imported.description;
        let none = PassSet::new();
        let (budget, wanted) =
            Budget::of(self.arguments, description, begun.as_ref().map_or(&none, Checkpoint::passes));
        let interrupt = Interrupt::listen({
            let display = display.clone();
            move || display.say("stopping after this pass; Ctrl-C again quits at once")
        })?;
        display.say(&self.headline(budget, begun.as_ref()));
        let name = self.outputs.first().map_or_else(String::new, |path| path.display().to_string());
        let preview = Preview::start(&self.arguments.preview, &name, description.film.size, &display);
        let mut progress = Progress::new(self.meter, budget, display, preview);

        self.meter.enter(Stage::Pilot);
        let mut render = match begun {
            Some(begun) => Render::resume(self.scene, description, begun)?,
            None => Render::stored(self.scene, description, self.layers, &self.storage(), &Silent)?,
        };
        if let Some(clock) = render.film().clock() {
            progress.say(&bins(clock, &description.film, &self.storage()));
        }
        let (mut errors, before) = (ErrorCurve::default(), render.film().passes());
        // A film that is good enough already stays as it is; time is for this run alone.
        let is_done = before > 0 && budget.is_spent(render.film(), Duration::ZERO);
        while !is_done && render.step_in(&wanted, &progress) {
            progress.passed(render.film());
            errors.passed(render.film());
            if snapshots.is_due(render.film().passes()) {
                self.meter.enter(Stage::Write);
                snapshots.write(render.film()).unwrap_or_else(|warning| progress.warn(&warning));
            }
            if interrupt.is_raised() || budget.is_spent(render.film(), self.meter.rendering()) {
                break;
            }
            if let Some(keeper) = keeper.as_mut().filter(|keeper| keeper.is_due()) {
                self.meter.enter(Stage::Write);
                let go_on = |error: Error| progress.warn(&error.with_hint("the render goes on and will try again"));
                keeper.write(&render).unwrap_or_else(go_on);
            }
        }

        let (seconds, error) = (self.meter.rendering(), render.film().relative_error());
        self.meter.enter(Stage::Write);
        progress.finish();
        let passes = plural(render.film().passes() as usize, "pass");
        let bias = render.film().bias().map_or_else(String::new, |found| format!(", {}", bias(&found)));
        progress.say(&format!("{passes} in {}; {}{bias}", time(seconds), progress.speed(error)));
        if let Some(remark) = render.integrator().remark() {
            progress.say(remark);
        }
        if let Some([before, after]) = render.film().share_outside_bins() {
            let shares = [before, after].map(percent);
            progress.say(&format!(
                "{} of the light came before the first time bin, {} after the last",
                shares[0], shares[1]
            ));
        }
        // What cannot be written keeps nothing else from it.
        let kept = keeper.map_or(Ok(()), |mut keeper| keeper.write(&render));
        let outputs: Vec<&Path> = self.outputs.iter().map(PathBuf::as_path).collect();
        self.write_pictures(&render, &outputs, denoiser)?;
        kept?;
        let count = plural(snapshots.written().len(), "snapshot");
        let snapshots_too = if snapshots.written().is_empty() { String::new() } else { format!(" and {count}") };
        let mut written = outputs;
        written.extend(kept_in(self.arguments));
        progress.say(&format!("wrote {}{snapshots_too}", names(&written)));
        let (snapshots, interrupted) = (snapshots.written(), interrupt.is_raised());
        let done = Done { render: &render, errors, begun: before, snapshots, interrupted };
        Ok(Stats::of(self.arguments, description, done, self.meter, warnings))
    }

    /// Where the film's time bins are kept.
    fn storage(&self) -> Storage {
        let film = &self.imported.description.film;
        let bytes = film.time.as_ref().map_or(0.0, |time| time.bytes(film.size));
        storage(bytes as u64, self.memory, beside(self.arguments, self.outputs))
    }

    /// Writes the picture, denoised if that is asked for; as it is if that fails.
    fn write_pictures(
        &self,
        render: &Render<'_>,
        outputs: &[&Path],
        denoiser: Option<Denoiser>,
    ) -> Result<(), Failure> {
        let ((image, layers), mut facts) = (films::pictures(render.film()), self.facts(render));
        let denoised = denoiser.map(|denoiser| denoise(&denoiser, &image, &layers)).transpose();
        let picture = match &denoised {
            Ok(Some(denoised)) => {
                facts.push(denoised_by());
                Picture { image: denoised, noisy: Some(&image), layers: &layers, facts: &facts }
            }
            _ => Picture { image: &image, noisy: None, layers: &layers, facts: &facts },
        };
        films::write_all(&picture, Some(render.film()), outputs)?;
        denoised?;
        Ok(())
    }

    /// Where the picture comes from, for those who find it later.
    fn facts(&self, render: &Render<'_>) -> Vec<(&'static str, Fact)> {
        let passes = i32::try_from(render.film().passes()).unwrap_or(i32::MAX);
        vec![
            ("scene", Fact::Text(self.arguments.scene.scene.display().to_string())),
            ("command", Fact::Text(command_line(std::env::args_os()))),
            ("version", Fact::Text(env!("CARGO_PKG_VERSION").into())),
            ("integrator", Fact::Text(render.integrator().name().into())),
            ("seed", Fact::Text(self.imported.description.render.seed.to_string())),
            ("passes", Fact::Whole(passes)),
            ("seconds", Fact::Number(self.meter.rendering().as_secs_f64())),
        ]
    }

    fn headline(&self, budget: Budget, begun: Option<&Checkpoint>) -> String {
        let description = &self.imported.description;
        let [width, height] = description.film.size;
        let until = [
            budget.passes.map(|passes| plural(passes as usize, "pass")),
            budget.time.map(time),
            budget.error.map(|error| format!("error {}", percent(error))),
        ];
        let until: Vec<String> = until.into_iter().flatten().collect();
        let begun = begun.map_or_else(String::new, |begun| format!(", going on from passes {}", begun.passes()));
        format!(
            "rendering {}: {width} × {height} pixels, {}, {}, {}{begun}",
            self.arguments.scene.scene.display(),
            description.integrator.name(),
            until.join(" or "),
            plural(rayon::current_num_threads(), "thread"),
        )
    }
}

/// The time bins of a film, in its unit and in seconds, and what they take.
fn bins(clock: &Clock, film: &FilmDescription, storage: &Storage) -> String {
    let picoseconds = |length: f64| format!("{:.4} ps", length / SPEED_OF_LIGHT * 1e12);
    let size = bytes(film.time.as_ref().map_or(0.0, |time| time.bytes(film.size)));
    let layers = match clock.layers().count() {
        0 => String::new(),
        count => format!(", for all light and {}", plural(count, "layer")),
    };
    let room = match storage {
        Storage::Memory => format!("up to {size} of memory"),
        Storage::File(folder) => format!("{size} of the disk, in '{}'", folder.display()),
    };
    if let ([first, ..], [.., last]) = (&clock.frequencies()[..], &clock.frequencies()[..]) {
        let count = clock.frequencies().len();
        return format!("amplitudes, frequencies from {first:.6} to {last:.6} cycles a unit ({count}){layers}, {room}");
    }
    format!(
        "{} time bins of {:.6} ({} in metres) from {:.6} ({}){layers}, {room}",
        clock.bins(),
        clock.bin_width(),
        picoseconds(clock.bin_width()),
        clock.start(),
        picoseconds(clock.start()),
    )
}

fn names(paths: &[&Path]) -> String {
    let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    names.join(", ")
}

/// The words of a command as a shell would take them.
fn command_line(words: impl Iterator<Item = OsString>) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
    let quoted = |word: OsString| match word.to_string_lossy() {
        word if !word.is_empty() && word.chars().all(is_plain) => word.into_owned(),
        word => format!("'{}'", word.replace('\'', r"'\''")),
    };
    words.map(quoted).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_line_can_be_pasted_into_a_shell() {
        let words = ["lampyris", "render", "my scene.toml", "--set", "a=b", "it's", ""].map(OsString::from);
        assert_eq!(command_line(words.into_iter()), r"lampyris render 'my scene.toml' --set a=b 'it'\''s' ''");
    }
}
