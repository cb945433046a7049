//! Scenes: what a file says, and what is rendered.
mod assets;
pub mod description;
pub(crate) mod notation;
pub mod schema;
pub mod settings;
pub use assets::{Assets, NoAssets};
pub use description::SceneDescription;
