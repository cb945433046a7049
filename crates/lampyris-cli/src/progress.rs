//! How the render is getting on: a bar on a terminal, a line now and then elsewhere, nothing if `--quiet`.

use std::io::IsTerminal;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use lampyris::error::Warning;
use lampyris::film::Film;
use lampyris::integrator::{Observer, Phase, Work};

use crate::budget::Budget;
use crate::format::{count, percent, time};
use crate::meter::{Meter, Stage};
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

/// The time from one picture in the terminal to the next.
const PICTURES: Duration = Duration::from_millis(500);

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
    /// What suits the standard error.
    pub fn new(quiet: bool) -> Display {
        let is_dumb = std::env::var_os("TERM").is_some_and(|terminal| terminal == "dumb");
        match std::io::stderr().is_terminal() && !is_dumb {
            _ if quiet => Display::Quiet,
            false => Display::Lines,
            true => {
                let target = ProgressDrawTarget::stderr();
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
            let shown = Arc::new(Mutex::new((None::<Instant>, String::new())));
            bar.set_style(style().with_key("picture", move |_: &ProgressState, out: &mut dyn std::fmt::Write| {
                let mut shown = shown.lock().unwrap_or_else(PoisonError::into_inner);
                if shown.0.is_none_or(|at| at.elapsed() >= PICTURES)
                    && let Some(lines) = terminal.draw()
                {
                    *shown = (Some(Instant::now()), lines);
                }
                let _ = out.write_str(&shown.1);
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
            _ if self.budget.is_spent(state.passes, self.meter.rendering()) => false,
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
        let (where_we_are, speed) = (self.where_we_are(state.passes, is_under_way), self.speed(state.error));
        match &self.display {
            Display::Quiet => {}
            Display::Lines => say(&format!("{where_we_are}; {speed}")),
            Display::Bar(bar) => {
                bar.set_position((STEPS as f64 * self.budget.share(state.passes, self.meter.rendering())) as u64);
                bar.set_prefix(where_we_are);
                bar.set_message(speed);
            }
        }
    }

    fn where_we_are(&self, passes: u32, is_under_way: bool) -> String {
        let (reading, elapsed) = (self.meter.read(), self.meter.rendering());
        let of = match self.budget {
            Budget::Passes(most) => format!(" of {most}"),
            Budget::Time(_) => String::new(),
        };
        let pass = match (is_under_way, reading.stage) {
            (false, _) => format!("pass {passes}{of}"),
            (true, Stage::Map) => format!("pass {}{of} (map)", passes + 1),
            (true, stage) => format!("pass {}{of} ({} {})", passes + 1, stage.name(), percent(reading.share)),
        };
        let left = self.budget.time_left(passes, elapsed);
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
