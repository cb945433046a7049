//! What a render did, for programs to read.

use std::path::{Path, PathBuf};

use lampyris::error::{Error, Result};
use lampyris::film::{Bias, Film};
use lampyris::output::write_whole;
use lampyris::render::Render;
use lampyris::scene::SceneDescription;
use lampyris::scene::description::{
    AutoSettings, FilmDescription, IntegratorDescription, LightSettings, PathSettings, PhotonMapSettings,
};
use serde::Serialize;

use crate::args::RenderArguments;
use crate::format::most;
use crate::meter::{Meter, Seconds};

/// The content of a `--stats` file.
#[derive(Debug, Serialize)]
pub struct Stats {
    /// The scene file as it was named.
    scene: String,
    /// Of this program.
    version: &'static str,
    integrator: &'static str,
    settings: Settings,
    film: FilmDescription,
    seed: u64,
    threads: usize,
    size: [u32; 2],
    passes: u32,
    /// Which they are, such as `0..8`.
    pass_ranges: String,
    /// Whether Ctrl-C ended it.
    interrupted: bool,
    seconds: Seconds,
    /// Rays of the passes, shadow rays not counted.
    rays: u64,
    rays_per_second: f64,
    /// Walks from the lamps, the pilot's not counted.
    light_paths: u64,
    light_paths_per_second: f64,
    /// Photons stored, all passes together.
    photons: u64,
    photons_per_second: f64,
    flux: Flux,
    /// Relative standard error of the picture's luminance; null after one pass. It does not know of bias.
    relative_error: Option<f64>,
    /// Null where the radius does not shrink, and of too few passes.
    bias: Option<BiasNumbers>,
    /// The relative error after 2, 4, 8 ... passes.
    errors: ErrorCurve,
    /// Null where the system does not say.
    peak_memory_bytes: Option<u64>,
    /// Pictures written on the way.
    snapshots: Vec<String>,
    warnings: Vec<String>,
}

/// The settings of the integrator alone: its name stands beside them.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Settings {
    Auto(AutoSettings),
    PhotonMap(PhotonMapSettings),
    Path(PathSettings),
    Light(LightSettings),
}

/// How the error falls.
#[derive(Debug, Default, Serialize)]
pub struct ErrorCurve(Vec<ErrorAt>);

#[derive(Debug, Serialize)]
struct ErrorAt {
    passes: u32,
    relative_error: f64,
}

impl ErrorCurve {
    /// A pass is done.
    pub fn passed(&mut self, film: &Film) {
        let passes = film.passes();
        let error = if passes.is_power_of_two() { film.relative_error() } else { None };
        self.0.extend(error.map(|relative_error| ErrorAt { passes, relative_error }));
    }
}

/// The bias of the picture's luminance, extrapolated from the radii of the passes, as the root of its mean square over the
/// picture relative to the mean.
#[derive(Debug, Serialize)]
struct BiasNumbers {
    rms: f64,
    standard_error: f64,
    /// With a probability of 95 %.
    at_most: f64,
}

impl BiasNumbers {
    fn of(bias: &Bias) -> BiasNumbers {
        BiasNumbers { rms: bias.rms(), standard_error: bias.standard_error(), at_most: most(bias) }
    }
}

/// What is left of a render at its end.
pub struct Done<'a> {
    pub render: &'a Render<'a>,
    pub errors: ErrorCurve,
    /// Passes that were there before.
    pub begun: u32,
    /// Pictures written on the way.
    pub snapshots: &'a [PathBuf],
    /// Whether Ctrl-C ended it.
    pub interrupted: bool,
}

/// Flux of the walks from the lamps.
#[derive(Debug, Serialize)]
struct Flux {
    /// In W, mean of the channels; null if the integrator has no such walks.
    emitted: Option<f64>,
    /// The share of it that was lost because paths grew too long.
    cut_share: Option<f64>,
}

impl Stats {
    /// After the render.
    pub fn of(
        arguments: &RenderArguments,
        description: &SceneDescription,
        done: Done<'_>,
        meter: &Meter,
        warnings: &[Error],
    ) -> Stats {
        let Done { render, errors, begun, snapshots, interrupted } = done;
        let (reading, passes) = (meter.read(), render.film().passes());
        let work = reading.work;
        let has_flux = work.flux_emitted > 0.0;
        Stats {
            scene: arguments.scene.scene.display().to_string(),
            version: env!("CARGO_PKG_VERSION"),
            integrator: render.integrator().name(),
            settings: match &description.integrator {
                IntegratorDescription::Auto(settings) => Settings::Auto(settings.clone()),
                IntegratorDescription::PhotonMap(settings) => Settings::PhotonMap(settings.clone()),
                IntegratorDescription::Path(settings) => Settings::Path(settings.clone()),
                IntegratorDescription::Light(settings) => Settings::Light(settings.clone()),
            },
            film: description.film.clone(),
            seed: description.render.seed,
            threads: rayon::current_num_threads(),
            size: description.film.size,
            passes,
            pass_ranges: render.passes().to_string(),
            interrupted,
            seconds: reading.seconds,
            rays: work.rays,
            rays_per_second: reading.per_second(work.rays),
            light_paths: work.light_paths,
            light_paths_per_second: reading.per_second(work.light_paths),
            photons: work.photons,
            photons_per_second: reading.per_second(work.photons),
            flux: Flux {
                emitted: has_flux.then(|| work.flux_emitted / f64::from((passes - begun).max(1))),
                cut_share: has_flux.then(|| work.flux_cut / work.flux_emitted),
            },
            relative_error: render.film().relative_error(),
            bias: render.film().bias().as_ref().map(BiasNumbers::of),
            errors,
            peak_memory_bytes: peak_memory(),
            snapshots: snapshots.iter().map(|path| path.display().to_string()).collect(),
            warnings: warnings.iter().map(ToString::to_string).collect(),
        }
    }

    /// Writes them as JSON, whole or not at all.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn write(&self, path: &Path) -> Result<()> {
        let json = serde_json::to_string_pretty(self)
            .map_err(|error| Error::new(format!("cannot write '{}': {error}", path.display())))?;
        write_whole(path, format!("{json}\n").as_bytes())
    }
}

/// The most memory that the process ever held, as Linux tells it.
fn peak_memory() -> Option<u64> {
    peak_in(&std::fs::read_to_string("/proc/self/status").ok()?)
}

fn peak_in(status: &str) -> Option<u64> {
    let value = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    value.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kilobytes| 1024 * kilobytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_read_in_bytes() {
        assert_eq!(peak_in("Name:\tlampyris\nVmHWM:\t    2048 kB\nVmRSS:\t 1 kB\n"), Some(2 << 20));
        assert_eq!(peak_in("Name:\tlampyris\n"), None);
    }
}
