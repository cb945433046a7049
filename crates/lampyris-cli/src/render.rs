//! `lampyris render`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use lampyris::error::{Error, Result};
use lampyris::film::{Layer, Layers};
use lampyris::image::Image;
use lampyris::import::Imported;
use lampyris::integrator::Silent;
use lampyris::output::{Fact, Format, Picture, check_path, check_writable, write_picture};
use lampyris::render::Render;
use lampyris::scene::Scene;

use crate::args::{PreviewTarget, RenderArguments};
use crate::budget::Budget;
use crate::format::{plural, time};
use crate::interrupt::Interrupt;
use crate::meter::{Meter, Stage};
use crate::preview::Preview;
use crate::progress::{Display, Loading, Progress};
use crate::report::Failure;
use crate::scene::{change, heed, read, ready, warnings};
use crate::snapshots::Snapshots;
use crate::stats::Stats;

/// Renders a scene and writes the picture.
///
/// # Errors
/// Whatever is wrong with the scene or the places of the files, all of it found before the work begins; and what
/// keeps the files from being written in the end.
pub fn run(arguments: &RenderArguments) -> Result<(), Failure> {
    let meter = Meter::start();
    let outputs = outputs(arguments)?;
    let layers = layers(arguments, &outputs)?;
    let snapshots = Snapshots::new(outputs.first().map(PathBuf::as_path).filter(|_| arguments.snapshots))?;
    let mut imported = read(&arguments.scene)?;
    apply(arguments, &mut imported)?;
    let pool = pool(arguments.work.threads.map_or(0, usize::from))?;
    let has_picture = arguments.preview.contains(&PreviewTarget::Terminal);
    let display = Display::new(arguments.work.quiet, has_picture);
    let loading = Loading::new(&meter, &arguments.scene.scene, display.clone());
    let built = pool.install(|| ready(&arguments.scene, &imported, &arguments.changes.settings, &loading));
    display.clear();
    let built = built?;
    let warnings = warnings(&arguments.scene, &imported, &built);
    heed(&warnings, arguments.scene.strict, arguments.work.quiet)?;
    let job = Job { arguments, imported: &imported, scene: &built.scene, outputs: &outputs, layers, meter: &meter };
    let stats = pool.install(|| job.run(display, &warnings, snapshots))?;
    if let Some(path) = &arguments.stats {
        stats.write(path)?;
    }
    Ok(())
}

/// Where the picture goes: all places are checked.
fn outputs(arguments: &RenderArguments) -> Result<Vec<PathBuf>> {
    let outputs = match arguments.outputs.as_slice() {
        [] => vec![PathBuf::from(arguments.scene.scene.file_stem().unwrap_or_default()).with_extension("png")],
        given => given.to_vec(),
    };
    outputs.iter().try_for_each(|path| check_path(path))?;
    if let Some(stats) = &arguments.stats {
        check_writable(stats)?;
        if outputs.contains(stats) {
            let message = format!("'{}' cannot hold both the picture and the statistics", stats.display());
            return Err(Error::new(message).with_hint("give --stats another file, such as stats.json"));
        }
    }
    Ok(outputs)
}

/// The layers to compute: those that the user asks for, or all of them if a file can hold them.
fn layers(arguments: &RenderArguments, outputs: &[PathBuf]) -> Result<Layers> {
    let is_exr = |path: &PathBuf| Format::of(path).is_ok_and(|format| format == Format::Exr);
    match (arguments.layers, outputs.iter().any(is_exr)) {
        (Some(layers), false) if !layers.is_empty() => {
            Err(Error::new("only .exr files hold layers, and none is to be written")
                .with_hint("add -o FILE.exr, or leave --layers out"))
        }
        (given, has_exr) => Ok(given.unwrap_or(if has_exr { Layers::ALL } else { Layers::NONE })),
    }
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
    meter: &'a Meter,
}

impl Job<'_> {
    fn run(&self, display: Display, warnings: &[Error], mut snapshots: Snapshots) -> Result<Stats, Failure> {
        let description = &self.imported.description;
        let budget = Budget::of(self.arguments, description);
        let interrupt = Interrupt::listen({
            let display = display.clone();
            move || display.say("stopping after this pass; Ctrl-C again quits at once")
        })?;
        display.say(&self.headline(budget));
        let name = self.outputs.first().map_or_else(String::new, |path| path.display().to_string());
        let preview = Preview::start(&self.arguments.preview, &name, description.film.size, &display);
        let mut progress = Progress::new(self.meter, budget, display, preview);

        self.meter.enter(Stage::Pilot);
        let mut render = Render::with_layers(self.scene, description, self.layers, &Silent);
        loop {
            render.step(&progress);
            progress.passed(render.film());
            if snapshots.is_due(render.film().passes()) {
                self.meter.enter(Stage::Write);
                snapshots.write(render.film()).unwrap_or_else(|warning| progress.warn(&warning));
            }
            if interrupt.is_raised() || budget.is_spent(render.film().passes(), self.meter.rendering()) {
                break;
            }
        }

        let (seconds, error) = (self.meter.rendering(), render.film().relative_error());
        self.meter.enter(Stage::Write);
        progress.finish();
        let passes = plural(render.film().passes() as usize, "pass");
        progress.say(&format!("{passes} in {}; {}", time(seconds), progress.speed(error)));
        self.write(&render)?;
        let count = plural(snapshots.written().len(), "snapshot");
        let snapshots_too = if snapshots.written().is_empty() { String::new() } else { format!(" and {count}") };
        progress.say(&format!("wrote {}{snapshots_too}", names(self.outputs)));
        let snapshots = snapshots.written();
        Ok(Stats::of(self.arguments, description, &render, self.meter, warnings, snapshots, interrupt.is_raised()))
    }

    /// Writes the picture to all of its places.
    fn write(&self, render: &Render<'_>) -> Result<(), Failure> {
        let film = render.film();
        let image = film.image();
        let layers: Vec<(Layer, Image)> =
            self.layers.iter().filter_map(|layer| Some((layer, film.layer(layer)?))).collect();
        let facts = self.facts(render);
        let picture = Picture { image: &image, layers: &layers, facts: &facts };
        // One that cannot be written does not keep the others from it.
        Failure::if_any(self.outputs.iter().filter_map(|path| write_picture(path, &picture).err()).collect())
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

    fn headline(&self, budget: Budget) -> String {
        let description = &self.imported.description;
        let [width, height] = description.film.size;
        let budget = match budget {
            Budget::Passes(passes) => plural(passes as usize, "pass"),
            Budget::Time(most) => time(most),
        };
        format!(
            "rendering {}: {width} × {height} pixels, {}, {budget}, {}",
            self.arguments.scene.scene.display(),
            description.integrator.name(),
            plural(rayon::current_num_threads(), "thread"),
        )
    }
}

fn names(paths: &[PathBuf]) -> String {
    let names: Vec<String> = paths.iter().map(|path: &PathBuf| Path::display(path).to_string()).collect();
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
