//! Who is told how the work is getting on. The library prints nothing and has no clock; its owner may have both.

/// Who wants to know how the work is getting on. Called from many threads.
pub trait Observer: Sync {
    /// A phase begins.
    fn phase(&self, _phase: Phase) {}

    /// Some work was done.
    fn work(&self, _work: &Work) {}

    /// Row `y` of the picture of the current pass is done: linear radiance of its pixels, from the left. Rows come in
    /// any order. Integrators whose rows are not done before the pass is (light tracing) tell of none.
    fn row(&self, _y: usize, _pixels: &[[f32; 3]]) {}
}

/// Nobody wants to know.
pub struct Silent;

impl Observer for Silent {}

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Phase {
    /// Meshes and pictures are read and shapes are built, once, before everything else.
    Load,
    /// The radius is chosen, once, before the first pass.
    Pilot,
    /// Walks from the lamps.
    Photons,
    /// The photons are sorted.
    Map,
    /// Walks from the camera.
    Camera,
}

/// Work done since the last report.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Bytes read from files beside the scene file.
    pub bytes: u64,
    /// Shapes built.
    pub shapes: u64,
    /// Rays traced, shadow rays not counted.
    pub rays: u64,
    /// Walks from lamps.
    pub light_paths: u64,
    /// Photons stored.
    pub photons: u64,
    /// Flux that the lamps emitted, in W, mean of the lanes, as of one pass.
    pub flux_emitted: f64,
    /// Flux that was lost because its path grew too long.
    pub flux_cut: f64,
    /// Share of the current phase.
    pub share: f64,
}
