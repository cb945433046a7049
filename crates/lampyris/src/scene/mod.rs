//! Scenes: what a file says, and what is rendered.
mod assets;
pub mod description;
pub use assets::{Assets, NoAssets};
pub use description::SceneDescription;
