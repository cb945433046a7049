//! Lampyris: photon mapping.
pub mod compare;
pub mod error;
pub mod geometry;
pub mod image;
pub mod import;
pub mod output;
pub mod scene;
pub mod spectrum;
pub mod tonemap;
