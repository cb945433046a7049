//! How light travels: the one random walk, and what both of its directions share.

mod airlight;
mod direct;
mod media;
mod path;
mod rivals;
mod roulette;
mod walk;

pub use airlight::{Airlight, airlight};
pub use direct::{direct_light, direct_light_in_medium, light_from, mis_weight};
pub use media::{Crossing, MediumPoint, Segment};
pub use path::{Origin, PathState};
pub use rivals::{Rivals, norm, squared};
pub use roulette::survive;
pub use walk::{End, Limits, Visitor, Walked, walk};
