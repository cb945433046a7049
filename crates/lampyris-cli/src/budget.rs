//! How long a render goes on.

use std::time::Duration;

use lampyris::render::default_passes;
use lampyris::scene::SceneDescription;

use crate::args::RenderArguments;

/// When a render ends by itself. It always makes one pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// After so many passes.
    Passes(u32),
    /// After the pass in which this time ran out.
    Time(Duration),
}

impl Budget {
    /// What the command line says, else the scene, else enough for a good quick picture.
    pub fn of(arguments: &RenderArguments, scene: &SceneDescription) -> Budget {
        match (arguments.passes, arguments.time) {
            (Some(passes), _) => Budget::Passes(passes.get()),
            (None, Some(time)) => Budget::Time(time),
            (None, None) => Budget::Passes(scene.render.passes.unwrap_or_else(|| default_passes(&scene.integrator))),
        }
    }

    /// Whether it is used up.
    pub fn is_spent(self, passes: u32, elapsed: Duration) -> bool {
        match self {
            Budget::Passes(most) => passes >= most,
            Budget::Time(most) => elapsed >= most,
        }
    }

    /// The share of it that is used up, 0 to 1.
    pub fn share(self, passes: u32, elapsed: Duration) -> f64 {
        let share = match self {
            Budget::Passes(most) => f64::from(passes) / f64::from(most),
            Budget::Time(most) => elapsed.as_secs_f64() / most.as_secs_f64(),
        };
        share.min(1.0)
    }

    /// How long it will go on if it goes on like this; none before the first pass is done.
    pub fn time_left(self, passes: u32, elapsed: Duration) -> Option<Duration> {
        match self {
            Budget::Passes(_) if passes == 0 => None,
            Budget::Passes(most) => Some(elapsed.mul_f64(f64::from(most.saturating_sub(passes)) / f64::from(passes))),
            Budget::Time(most) => Some(most.saturating_sub(elapsed)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_spent_by_passes_and_time_by_time() {
        let seconds = Duration::from_secs;
        assert!(!Budget::Passes(3).is_spent(2, seconds(100)) && Budget::Passes(3).is_spent(3, seconds(0)));
        assert!(
            !Budget::Time(seconds(5)).is_spent(100, seconds(4)) && Budget::Time(seconds(5)).is_spent(1, seconds(5))
        );
        assert_eq!(Budget::Passes(4).share(1, seconds(9)), 0.25);
        assert_eq!(Budget::Time(seconds(4)).share(9, seconds(1)), 0.25);
    }

    #[test]
    fn what_is_left_takes_as_long_as_what_is_done() {
        let seconds = Duration::from_secs;
        assert_eq!(Budget::Passes(4).time_left(1, seconds(2)), Some(seconds(6)));
        assert_eq!(Budget::Passes(4).time_left(0, seconds(2)), None);
        assert_eq!(Budget::Time(seconds(5)).time_left(0, seconds(2)), Some(seconds(3)));
    }
}
