//! Lampyris: photon mapping.
pub mod error;
pub mod geometry;
pub mod image;
pub mod import;
pub mod scene;
