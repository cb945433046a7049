//! `lampyris render`.

use std::path::{Path, PathBuf};

use lampyris::error::{Error, Result};
use lampyris::import::Imported;
use lampyris::integrator::Silent;
use lampyris::output::{check_path, check_writable, write_image};
use lampyris::render::Render;
use lampyris::scene::Scene;

use crate::args::RenderArguments;
use crate::budget::Budget;
use crate::format::{plural, time};
use crate::interrupt::Interrupt;
use crate::meter::{Meter, Stage};
use crate::progress::{Display, Progress};
use crate::report::Failure;
use crate::scene::{change, heed, read, ready, warnings};
use crate::stats::Stats;

/// Renders a scene and writes the picture.
///
/// # Errors
/// Whatever is wrong with the scene or the places of the files, all of it found before the work begins; and what
/// keeps the files from being written in the end.
pub fn run(arguments: &RenderArguments) -> Result<(), Failure> {
    let meter = Meter::start();
    let outputs = outputs(arguments)?;
    let mut imported = read(&arguments.scene)?;
    apply(arguments, &mut imported)?;
    let pool = pool(arguments.work.threads.map_or(0, usize::from))?;
    meter.enter(Stage::Build);
    let built = pool.install(|| ready(&arguments.scene, &imported, &arguments.changes.settings))?;
    let warnings = warnings(&arguments.scene, &imported, &built);
    heed(&warnings, arguments.scene.strict, arguments.work.quiet)?;
    let job = Job { arguments, imported: &imported, scene: &built.scene, outputs: &outputs, meter: &meter };
    let stats = pool.install(|| job.run(&warnings))?;
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
    meter: &'a Meter,
}

impl Job<'_> {
    fn run(&self, warnings: &[Error]) -> Result<Stats, Failure> {
        let description = &self.imported.description;
        let budget = Budget::of(self.arguments, description);
        let display = Display::new(self.arguments.work.quiet);
        let interrupt = Interrupt::listen({
            let display = display.clone();
            move || display.say("stopping after this pass; Ctrl-C again quits at once")
        })?;
        let progress = Progress::new(self.meter, budget, display);
        progress.say(&self.headline(budget));

        self.meter.enter(Stage::Pilot);
        let mut render = Render::new(self.scene, description, &Silent);
        loop {
            render.step(&progress);
            progress.passed(render.film());
            if interrupt.is_raised() || budget.is_spent(render.film().passes(), self.meter.rendering()) {
                break;
            }
        }

        let (seconds, error) = (self.meter.rendering(), render.film().relative_error());
        self.meter.enter(Stage::Write);
        progress.finish();
        let passes = plural(render.film().passes() as usize, "pass");
        progress.say(&format!("{passes} in {}; {}", time(seconds), progress.speed(error)));
        let image = render.film().image();
        // One that cannot be written does not keep the others from it.
        let errors: Vec<Error> = self.outputs.iter().filter_map(|path| write_image(path, &image).err()).collect();
        Failure::if_any(errors)?;
        progress.say(&format!("wrote {}", names(self.outputs)));
        Ok(Stats::of(self.arguments, description, &render, self.meter, warnings, interrupt.is_raised()))
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
