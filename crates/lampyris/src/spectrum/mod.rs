//! Colour.
mod srgb;
pub use srgb::{linear_to_srgb, srgb_to_linear};
