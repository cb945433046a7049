//! Lampyris renders the light that path tracers turn into fireflies, or miss, by photon mapping.
//!
//! A photon's life, in the order of the modules that it passes:
//!
//! 1. a [`light`] emits it, with the random numbers of its path ([`sampler`]);
//! 2. the one [`transport::walk`] carries it from surface to surface of the [`scene`]'s [`geometry`];
//! 3. at each of them a [`material`] says what can happen, and roulette decides what does;
//! 4. wherever it meets a smooth lobe it leaves a record in the [`photon`] map;
//! 5. the same walk, begun at the [`camera`], passes through mirrors and glass and gathers what it finds there;
//! 6. the [`film`] adds up passes; the [`output`] writes the picture.
//!
//! An [`integrator`] is no more than the first rays of its walks and a visitor of them.

pub mod camera;
pub mod checkpoint;
pub mod compare;
pub mod denoise;
pub mod error;
pub mod film;
pub mod geometry;
pub mod image;
pub mod import;
pub mod integrator;
pub mod light;
pub mod material;
pub mod math;
pub mod medium;
pub mod observer;
pub mod output;
pub mod photon;
pub mod render;
pub mod sampler;
pub mod scene;
#[cfg(test)]
mod shared_tests;
pub mod spectrum;
pub mod texture;
pub mod tonemap;
pub mod transient;
pub mod transport;
