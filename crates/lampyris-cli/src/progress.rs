//! How the render is getting on: a bar on a terminal, a line now and then elsewhere, nothing if `--quiet`.

use std::io::IsTerminal;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use lampyris::error::Warning;
use lampyris::film::Film;
use lampyris::integrator::{Observer, Phase, Work};

use crate::budget::Budget;
use crate::format::{count, percent, plural, time};
use crate::meter::{Meter, Reading, Stage};
use crate::preview::{Preview, Terminal};
use crate::report::{say, warn};

/// Shows what it observes, and counts it with a [`Meter`].
pub struct Progress<'m> {
    meter: &'m Meter,
    budget: Budget,
    display: Display,
    preview: Option<Preview>,
    state: Mutex<State>,
}

/// Where it is shown.
#[derive(Clone)]
pub enum Display {
    /// Nowhere.
    Quiet,
    /// In lines.
    Lines,
    /// On a terminal.
    Bar(ProgressBar),
}

struct State {
    passes: u32,
    /// The standard error of the picture relative to its mean, once there are passes to compare.
    error: Option<f64>,
    shown: Instant,
}

/// How often the bar is drawn, at most, alone and with a picture.
const BARS_PER_SECOND: u8 = 20;
const PICTURES_PER_SECOND: u8 = 2;

/// The bar, with room for a picture above it.
fn style() -> ProgressStyle {
    ProgressStyle::with_template("{picture}[{bar:30}] {prefix}\n{wide_msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ")
        .with_key("picture", |_: &ProgressState, _: &mut dyn std::fmt::Write| {})
}

/// Steps of the bar.
const STEPS: u64 = 1000;

impl Display {
    /// What suits the standard error; with or without room for a picture.
    pub fn new(quiet: bool, has_picture: bool) -> Display {
        let is_dumb = std::env::var_os("TERM").is_some_and(|terminal| terminal == "dumb");
        match std::io::stderr().is_terminal() && !is_dumb {
            _ if quiet => Display::Quiet,
            false => Display::Lines,
            true => {
                // A picture is a thousand times the text of the bar, and terminals may be far away.
                let per_second = if has_picture { PICTURES_PER_SECOND } else { BARS_PER_SECOND };
                let target = ProgressDrawTarget::stderr_with_hz(per_second);
                Display::Bar(ProgressBar::with_draw_target(Some(STEPS), target).with_style(style()))
            }
        }
    }

    /// Shows a line that stays.
    pub fn say(&self, line: &str) {
        match self {
            Display::Quiet => {}
            Display::Lines => say(line),
            Display::Bar(bar) => bar.suspend(|| say(line)),
        }
    }

    /// Shows how many of some steps are done, on a terminal: elsewhere their end is told soon enough.
    pub fn step(&self, done: usize, of: usize, what: &str) {
        if let Display::Bar(bar) = self {
            bar.set_position(STEPS * done as u64 / of.max(1) as u64);
            bar.set_prefix(what.to_string());
        }
    }

    /// Takes the bar from the screen, until it is needed again.
    pub fn clear(&self) {
        if let Display::Bar(bar) = self {
            bar.finish_and_clear();
            bar.set_prefix("");
            bar.reset();
        }
    }

    /// Tells of a warning.
    pub fn warn(&self, warning: &Warning) {
        match self {
            Display::Quiet => {}
            Display::Lines => warn(warning),
            Display::Bar(bar) => bar.suspend(|| warn(warning)),
        }
    }

    /// Shows a picture above the bar from now on, and a new one from time to time.
    pub fn attach(&self, terminal: Arc<Terminal>) {
        if let Display::Bar(bar) = self {
            bar.set_style(style().with_key("picture", move |_: &ProgressState, out: &mut dyn std::fmt::Write| {
                let _ = out.write_str(&terminal.draw().unwrap_or_default());
            }));
        }
    }

    /// How long it lets pass before it shows something new.
    fn interval(&self) -> Duration {
        match self {
            Display::Quiet => Duration::MAX,
            Display::Lines => Duration::from_secs(5),
            Display::Bar(_) => Duration::from_millis(100),
        }
    }
}

/// How the reading of meshes and pictures and the building of shapes is getting on. What takes a moment is not told.
pub struct Loading<'m> {
    meter: &'m Meter,
    scene: String,
    display: Display,
    shown: Mutex<Instant>,
}

impl<'m> Loading<'m> {
    /// Before it begins.
    pub fn new(meter: &'m Meter, scene: &Path, display: Display) -> Loading<'m> {
        Loading { meter, scene: scene.display().to_string(), display, shown: Mutex::new(Instant::now()) }
    }

    fn show(&self) {
        let Reading { work, share, .. } = self.meter.read();
        let shapes = plural(work.shapes as usize, "shape");
        let bytes = if work.bytes > 0 { format!(", {}B read", count(work.bytes as f64)) } else { String::new() };
        let line = format!("loading {}: {} ({shapes}{bytes})", self.scene, percent(share));
        match &self.display {
            Display::Quiet => {}
            Display::Lines => say(&line),
            Display::Bar(bar) => {
                bar.set_position((STEPS as f64 * share) as u64);
                bar.set_prefix(line);
            }
        }
    }
}

impl Observer for Loading<'_> {
    fn phase(&self, phase: Phase) {
        self.meter.phase(phase);
    }

    fn work(&self, work: &Work) {
        self.meter.work(work);
        if let Ok(mut shown) = self.shown.try_lock()
            && shown.elapsed() >= self.display.interval()
        {
            *shown = Instant::now();
            self.show();
        }
    }
}

impl<'m> Progress<'m> {
    /// Before the first pass.
    pub fn new(meter: &'m Meter, budget: Budget, display: Display, preview: Option<Preview>) -> Progress<'m> {
        Progress {
            meter,
            budget,
            display,
            preview,
            state: Mutex::new(State { passes: 0, error: None, shown: Instant::now() }),
        }
    }

    /// A pass is done.
    pub fn passed(&self, film: &Film) {
        if let Some(preview) = &self.preview {
            preview.passed(film);
        }
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.passes = film.passes();
        let is_due = state.shown.elapsed() >= self.display.interval();
        let is_shown = match self.display {
            Display::Quiet => false,
            // The last one is told with the end of the render.
            _ if self.budget.is_spent(film, self.meter.rendering()) => false,
            Display::Lines => is_due || state.passes.is_power_of_two(),
            Display::Bar(_) => is_due,
        };
        if is_shown {
            state.error = film.relative_error();
            self.show(&mut state, false);
        }
    }

    /// Shows a line that stays.
    pub fn say(&self, line: &str) {
        self.display.say(line);
    }

    /// Tells of a warning.
    pub fn warn(&self, warning: &Warning) {
        self.display.warn(warning);
    }

    /// Takes the bar away, and lets the preview come to its end.
    pub fn finish(&mut self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
        if let Some(preview) = self.preview.take() {
            preview.finish();
        }
    }

    fn show(&self, state: &mut State, is_under_way: bool) {
        state.shown = Instant::now();
        let (where_we_are, speed) = (self.where_we_are(state, is_under_way), self.speed(state.error));
        match &self.display {
            Display::Quiet => {}
            Display::Lines => say(&format!("{where_we_are}; {speed}")),
            Display::Bar(bar) => {
                bar.set_position(
                    (STEPS as f64 * self.budget.share(state.passes, self.meter.rendering(), state.error)) as u64,
                );
                bar.set_prefix(where_we_are);
                bar.set_message(speed);
            }
        }
    }

    fn where_we_are(&self, state: &State, is_under_way: bool) -> String {
        let (reading, elapsed) = (self.meter.read(), self.meter.rendering());
        let passes = state.passes;
        let of = self.budget.passes.map_or_else(String::new, |most| format!(" of {most}"));
        let pass = match (is_under_way, reading.stage) {
            (false, _) => format!("pass {passes}{of}"),
            (true, Stage::Map) => format!("pass {}{of} (map)", passes + 1),
            (true, stage) => format!("pass {}{of} ({} {})", passes + 1, stage.name(), percent(reading.share)),
        };
        let left = self.budget.time_left(passes, elapsed, state.error);
        let left = left.map_or_else(String::new, |left| format!(", about {} left", time(left)));
        format!("{pass}, {}{left}", time(elapsed))
    }

    /// Rays, photons and light paths a second, and the error.
    pub fn speed(&self, error: Option<f64>) -> String {
        let reading = self.meter.read();
        let each =
            |amount: u64, what: &str| (amount > 0).then(|| format!("{} {what}/s", count(reading.per_second(amount))));
        let work = reading.work;
        let photons =
            each(work.photons, "photons").map(|speed| format!("{speed} ({} stored)", count(work.photons as f64)));
        let error = error.map(|error| format!("error {}", percent(error)));
        let all = [each(work.rays, "rays"), photons, each(work.light_paths, "light paths"), error];
        all.into_iter().flatten().collect::<Vec<String>>().join(", ")
    }
}

impl Observer for Progress<'_> {
    fn phase(&self, phase: Phase) {
        self.meter.phase(phase);
    }

    fn row(&self, y: usize, pixels: &[[f32; 3]]) {
        if let Some(preview) = &self.preview {
            preview.row(y, pixels);
        }
    }

    fn work(&self, work: &Work) {
        self.meter.work(work);
        // Whoever finds it locked leaves it to whoever holds it.
        if let Ok(mut state) = self.state.try_lock()
            && state.shown.elapsed() >= self.display.interval()
        {
            self.show(&mut state, true);
        }
    }
}
