//! Mathematics that light transport needs beyond vectors (those are `glam`'s).

mod distribution;
mod frame;
pub mod fresnel;
mod grid;
pub mod warp;

pub use distribution::Distribution;
pub use frame::Frame;
pub use grid::Grid;
