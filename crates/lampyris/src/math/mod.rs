//! Mathematics that light transport needs beyond vectors (those are `glam`'s).

mod distribution;
mod erf;
mod frame;
pub mod fresnel;
mod grid;
pub mod warp;

pub use distribution::{Distribution, ONE_MINUS_EPSILON};
pub use erf::{erf, erf_inverse};
pub use frame::Frame;
pub use grid::Grid;
