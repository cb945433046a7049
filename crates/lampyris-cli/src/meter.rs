//! Counts the work of a render and the time that it takes: the library has no clock.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use lampyris::integrator::{Observer, Phase, Work};
use serde::Serialize;

/// What the program is busy with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Reading the scene file.
    Load,
    /// Building the scene, with its meshes and pictures.
    Build,
    /// Choosing the radius.
    Pilot,
    /// Walks from the lamps.
    Photons,
    /// Sorting the photons.
    Map,
    /// Walks from the camera.
    Camera,
    /// Writing the picture.
    Write,
}

impl Stage {
    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Load => "load",
            Stage::Build => "build",
            Stage::Pilot => "pilot",
            Stage::Photons => "photons",
            Stage::Map => "map",
            Stage::Camera => "camera",
            Stage::Write => "write",
        }
    }
}

/// Seconds of each stage.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Seconds {
    /// All together.
    pub total: f64,
    pub load: f64,
    pub build: f64,
    pub pilot: f64,
    pub photons: f64,
    pub map: f64,
    pub camera: f64,
    pub write: f64,
}

impl Seconds {
    fn of(&mut self, stage: Stage) -> &mut f64 {
        match stage {
            Stage::Load => &mut self.load,
            Stage::Build => &mut self.build,
            Stage::Pilot => &mut self.pilot,
            Stage::Photons => &mut self.photons,
            Stage::Map => &mut self.map,
            Stage::Camera => &mut self.camera,
            Stage::Write => &mut self.write,
        }
    }

    /// Seconds spent in passes.
    pub fn passes(&self) -> f64 {
        self.photons + self.map + self.camera
    }
}

/// Work and time so far. The pilot's work is not counted.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// What is done now.
    pub stage: Stage,
    /// Share of it that is done, 0 to 1.
    pub share: f64,
    /// Work of all passes.
    pub work: Work,
    /// Time of all stages.
    pub seconds: Seconds,
}

impl Reading {
    /// So much a second of the passes.
    pub fn per_second(&self, amount: u64) -> f64 {
        let seconds = self.seconds.passes();
        if seconds > 0.0 { amount as f64 / seconds } else { 0.0 }
    }
}

/// Counts.
#[derive(Debug)]
pub struct Meter(Mutex<State>);

#[derive(Debug)]
struct State {
    reading: Reading,
    start: Instant,
    since: Instant,
}

impl State {
    fn lap(&mut self) {
        let now = Instant::now();
        let stage = self.reading.stage;
        *self.reading.seconds.of(stage) += (now - self.since).as_secs_f64();
        self.reading.seconds.total = (now - self.start).as_secs_f64();
        self.since = now;
    }
}

impl Meter {
    /// Starts with the loading of the scene.
    pub fn start() -> Meter {
        let now = Instant::now();
        let reading = Reading { stage: Stage::Load, share: 0.0, work: Work::default(), seconds: Seconds::default() };
        Meter(Mutex::new(State { reading, start: now, since: now }))
    }

    /// Another stage begins.
    pub fn enter(&self, stage: Stage) {
        let mut state = self.state();
        state.lap();
        state.reading.stage = stage;
        state.reading.share = 0.0;
    }

    /// Work and time so far.
    pub fn read(&self) -> Reading {
        let mut state = self.state();
        state.lap();
        state.reading
    }

    /// Since the render began, scene file and all that came before left out.
    pub fn rendering(&self) -> Duration {
        let seconds = self.read().seconds;
        Duration::from_secs_f64(seconds.pilot + seconds.passes())
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for Meter {
    fn phase(&self, phase: Phase) {
        self.enter(match phase {
            Phase::Load => Stage::Build,
            Phase::Pilot => Stage::Pilot,
            Phase::Photons => Stage::Photons,
            Phase::Map => Stage::Map,
            Phase::Camera => Stage::Camera,
        });
    }

    fn work(&self, work: &Work) {
        let mut state = self.state();
        let Reading { work: sum, share, .. } = &mut state.reading;
        sum.bytes += work.bytes;
        sum.shapes += work.shapes;
        sum.rays += work.rays;
        sum.light_paths += work.light_paths;
        sum.photons += work.photons;
        sum.flux_emitted += work.flux_emitted;
        sum.flux_cut += work.flux_cut;
        *share = (*share + work.share).min(1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_adds_up_and_shares_begin_anew_with_each_stage() {
        let meter = Meter::start();
        meter.phase(Phase::Photons);
        meter.work(&Work { rays: 3, photons: 2, share: 0.5, ..Work::default() });
        meter.work(&Work { rays: 4, share: 0.25, ..Work::default() });
        let reading = meter.read();
        assert_eq!((reading.work.rays, reading.work.photons, reading.share), (7, 2, 0.75));
        meter.phase(Phase::Camera);
        assert_eq!((meter.read().stage, meter.read().share, meter.read().work.rays), (Stage::Camera, 0.0, 7));
    }

    #[test]
    fn the_stages_make_up_the_whole_time() {
        let meter = Meter::start();
        for stage in [Stage::Build, Stage::Pilot, Stage::Photons, Stage::Map, Stage::Camera, Stage::Write] {
            meter.enter(stage);
        }
        let Seconds { total, load, build, pilot, write, .. } = meter.read().seconds;
        let sum = load + build + pilot + write + meter.read().seconds.passes();
        assert!(total > 0.0 && (sum - total).abs() < 1e-3, "{sum} of {total}");
    }
}
