//! Time to quality: relMSE against seconds, for a scene with a reference picture and any settings.
//!
//! ```text
//! cargo bench -p lampyris --bench time_to_quality -- SCENE REFERENCE SECONDS [SETTINGS]...
//! ```
//!
//! Each SETTINGS is a quoted list of KEY=VALUE as for `--set`, and `integrator=NAME`; for example
//! `"integrator=photon-map k=20" "integrator=path"`. After every doubling of passes, and at the end, a line tells
//! passes, seconds, relMSE (mean of (x − r)² / (r² + 0.01)), the same without the worst 0.1 % of pixels, and the ratio
//! of the means. The clock stands still while pictures are compared.

// A program that measures: it reads the clock and its arguments, unlike the library.
#![allow(missing_docs, clippy::print_stdout, clippy::disallowed_methods)]

use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

use lampyris::compare::compare;
use lampyris::image::Image;
use lampyris::import::{Files, load};
use lampyris::integrator::Silent;
use lampyris::output::read_image;
use lampyris::render::Render;
use lampyris::scene::build;

fn main() -> Result<(), Box<dyn Error>> {
    // `cargo bench` itself adds `--bench`.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let [scene, reference, seconds, settings @ ..] = arguments.as_slice() else {
        println!("usage: cargo bench -p lampyris --bench time_to_quality -- SCENE REFERENCE SECONDS [SETTINGS]...");
        return Ok(());
    };
    // Cargo runs benchmarks in the folder of their package; paths are meant from that of the workspace.
    std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))?;
    let reference = read_image(reference.as_ref())?;
    let budget = Duration::try_from_secs_f64(seconds.parse()?)?;
    let file = [String::new()];
    let settings = if settings.is_empty() { &file } else { settings };
    for settings in settings {
        measure(scene.as_ref(), settings, &reference, budget)?;
    }
    Ok(())
}

fn measure(path: &Path, settings: &str, reference: &Image, budget: Duration) -> Result<(), Box<dyn Error>> {
    let mut description = load::load(path, &load::LoadOptions::default())?.description;
    for setting in settings.split_whitespace() {
        match setting.split_once('=') {
            Some(("integrator", name)) => description.use_integrator(name)?,
            Some((key, value)) => description.set(key, value)?,
            None => return Err(format!("'{setting}' is not KEY=VALUE").into()),
        }
    }
    description.film.size = [reference.width() as u32, reference.height() as u32];
    description.check_settings()?;
    let scene = build(&description, &Files::beside(path))?.scene;
    println!("{} [{settings}], {} threads", path.display(), rayon::current_num_threads());
    println!("{:>8} {:>10} {:>12} {:>12} {:>10}", "passes", "seconds", "relMSE", "trimmed", "mean");
    let (mut elapsed, mut start, mut next) = (Duration::ZERO, Instant::now(), 1);
    let mut render = Render::new(&scene, &description, &Silent);
    while elapsed < budget {
        render.step(&Silent);
        elapsed += start.elapsed();
        let passes = render.film().passes();
        if passes >= next || elapsed >= budget {
            next = 2 * passes;
            let result = compare(&render.film().image(), reference)?;
            let (rel_mse, trimmed, mean) = (result.rel_mse, result.rel_mse_trimmed, result.mean_ratio);
            let seconds = elapsed.as_secs_f64();
            println!("{passes:>8} {seconds:>10.3} {rel_mse:>12.6} {trimmed:>12.6} {mean:>10.5}");
        }
        start = Instant::now();
    }
    Ok(())
}
