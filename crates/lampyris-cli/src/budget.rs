//! How long a render goes on.

use std::ops::Range;
use std::time::Duration;

use lampyris::film::{Film, PassSet};
use lampyris::render::default_passes;
use lampyris::scene::SceneDescription;

use crate::args::RenderArguments;

/// When a render ends by itself: at the first of what is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Passes that the film holds before the render.
    begun: u32,
    /// Passes that it holds when all are there.
    pub passes: Option<u32>,
    /// After the pass in which this time ran out.
    pub time: Option<Duration>,
    /// When the picture's relative standard error is no more than this.
    pub error: Option<f64>,
}

/// An error of fewer passes is not known well enough to stop by.
const FEWEST: u32 = 8;

impl Budget {
    /// What the command line says, else the scene, else enough for a good quick picture; with the passes that may be
    /// rendered, of which the film holds these already.
    pub fn of(arguments: &RenderArguments, scene: &SceneDescription, held: &PassSet) -> (Budget, Range<u32>) {
        let (time, error) = (arguments.time, arguments.target_error);
        let wanted = match (&arguments.pass_range, arguments.passes) {
            (Some(range), _) => Some(range.clone()),
            (None, Some(passes)) => Some(0..passes.get()),
            (None, None) if time.is_some() || error.is_some() => None,
            (None, None) => Some(0..scene.render.passes.unwrap_or_else(|| default_passes(&scene.integrator))),
        };
        let begun = u32::try_from(held.count()).unwrap_or(u32::MAX);
        let passes = wanted.as_ref().map(|wanted| begun.saturating_add(held.missing(wanted)));
        (Budget { begun, passes, time, error }, wanted.unwrap_or(0..u32::MAX))
    }

    /// Whether it is used up. Of error and passes the film alone decides; the error is looked at eight times in each
    /// doubling of passes.
    pub fn is_spent(&self, film: &Film, elapsed: Duration) -> bool {
        let passes = film.passes();
        let is_told = passes >= FEWEST && passes.is_multiple_of(1 << (passes.ilog2() - FEWEST.ilog2()));
        let is_good = |most: f64| is_told && film.relative_error().is_some_and(|error| error <= most);
        self.passes.is_some_and(|most| passes >= most)
            || self.time.is_some_and(|most| elapsed >= most)
            || self.error.is_some_and(is_good)
    }

    /// The share of it that is used up, 0 to 1.
    pub fn share(&self, passes: u32, elapsed: Duration, error: Option<f64>) -> f64 {
        let of_passes = self.passes.map(|most| f64::from(passes) / f64::from(most.max(1)));
        let of_time = self.time.map(|most| elapsed.as_secs_f64() / most.as_secs_f64());
        // The error falls as the root of the work.
        let of_error = self.error.zip(error).map(|(target, error)| (target / error).powi(2));
        [of_passes, of_time, of_error].into_iter().flatten().fold(0.0, f64::max).min(1.0)
    }

    /// How long it will go on if it goes on like this; none before the first pass is done.
    pub fn time_left(&self, passes: u32, elapsed: Duration, error: Option<f64>) -> Option<Duration> {
        let done = passes.saturating_sub(self.begun);
        let of_time = self.time.map(|most| most.saturating_sub(elapsed));
        let for_passes = |more: f64| (done > 0).then(|| elapsed.mul_f64(more.max(0.0) / f64::from(done)));
        let of_passes = self.passes.and_then(|most| for_passes(f64::from(most.saturating_sub(passes))));
        let more = |target: f64, error: f64| f64::from(passes) * ((error / target).powi(2) - 1.0);
        let of_error = self.error.zip(error).and_then(|(target, error)| for_passes(more(target, error).min(1e9)));
        [of_time, of_passes, of_error].into_iter().flatten().min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lampyris::image::Image;

    const NONE: Budget = Budget { begun: 0, passes: None, time: None, error: None };

    /// After passes of 1 and 3 by turns.
    fn film(passes: u32) -> Film {
        let mut film = Film::new([1, 1]);
        for pass in 0..passes {
            let image = Image::from_pixels(1, 1, vec![[1.0 + 2.0 * (pass % 2) as f32; 3]]).expect("one pixel");
            film.add_pass(&image.into());
        }
        film
    }

    #[test]
    fn passes_are_spent_by_passes_and_time_by_time() {
        let seconds = Duration::from_secs;
        let passes = Budget { passes: Some(3), ..NONE };
        assert!(!passes.is_spent(&film(2), seconds(100)) && passes.is_spent(&film(3), seconds(0)));
        let time = Budget { time: Some(seconds(5)), ..NONE };
        assert!(!time.is_spent(&film(9), seconds(4)) && time.is_spent(&film(1), seconds(5)));
        let both = Budget { passes: Some(3), ..time };
        assert!(both.is_spent(&film(3), seconds(1)) && both.is_spent(&film(1), seconds(6)));
        assert_eq!(Budget { passes: Some(4), ..NONE }.share(1, seconds(9), None), 0.25);
        assert_eq!(Budget { time: Some(seconds(4)), ..NONE }.share(9, seconds(1), None), 0.25);
    }

    #[test]
    fn an_error_is_spent_when_enough_passes_tell_it() {
        // The standard error of n values of 1 and 3 by turns is 1/√(n-1), and their mean is 2.
        let budget = |error| Budget { error: Some(error), ..NONE };
        let is_spent = |error, passes| budget(error).is_spent(&film(passes), Duration::ZERO);
        assert!(!is_spent(10.0, 7) && is_spent(10.0, 8), "too few to tell");
        assert!(!is_spent(0.1, 24) && is_spent(0.1, 26) && !is_spent(0.1, 27), "looked at now and then");
        assert_eq!(budget(0.1).share(5, Duration::ZERO, Some(0.2)), 0.25);
    }

    #[test]
    fn what_is_left_takes_as_long_as_what_is_done() {
        let seconds = Duration::from_secs;
        let passes = Budget { passes: Some(4), ..NONE };
        assert_eq!(passes.time_left(1, seconds(2), None), Some(seconds(6)));
        assert_eq!(passes.time_left(0, seconds(2), None), None);
        assert_eq!(Budget { begun: 2, ..passes }.time_left(3, seconds(2), None), Some(seconds(2)));
        assert_eq!(Budget { time: Some(seconds(5)), ..passes }.time_left(1, seconds(2), None), Some(seconds(3)));
        assert_eq!(Budget { error: Some(0.1), ..NONE }.time_left(2, seconds(2), Some(0.2)), Some(seconds(6)));
    }
}
