//! A render: passes, one after the other, into a film.

use crate::film::{Film, Layers};
use crate::integrator::{Integrator, Observer, Pass, integrator};
use crate::scene::description::{FilmDescription, IntegratorDescription};
use crate::scene::{Scene, SceneDescription};

/// A render under way. It knows neither clock nor budget: its owner decides after each pass whether to go on.
pub struct Render<'s> {
    scene: &'s Scene,
    settings: FilmDescription,
    integrator: Box<dyn Integrator>,
    seed: u64,
    film: Film,
}

impl<'s> Render<'s> {
    /// Makes ready to render `scene`, which was built from `description`, with the integrator, film and seed that the
    /// description names, the picture alone.
    pub fn new(scene: &'s Scene, description: &SceneDescription, observer: &dyn Observer) -> Render<'s> {
        Render::with_layers(scene, description, Layers::NONE, observer)
    }

    /// [`Render::new`], and these layers beside the picture.
    pub fn with_layers(
        scene: &'s Scene,
        description: &SceneDescription,
        layers: Layers,
        observer: &dyn Observer,
    ) -> Render<'s> {
        let (settings, seed) = (description.film.clone(), description.render.seed);
        let integrator = integrator(scene, &settings, &description.integrator, seed, observer);
        Render { scene, film: Film::with_layers(settings.size, layers), settings, integrator, seed }
    }

    /// Renders the next pass, on the current `rayon` pool.
    pub fn step(&mut self, observer: &dyn Observer) {
        let pass = Pass { index: self.film.passes(), seed: self.seed };
        let layers = self.film.layers();
        let scene = self.scene.of_pass(pass.seed, pass.index);
        self.film.add_pass(&self.integrator.expose(&scene, &self.settings, &pass, layers, observer));
    }

    /// What was rendered so far.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// The integrator.
    pub fn integrator(&self) -> &dyn Integrator {
        self.integrator.as_ref()
    }
}

/// How many passes make a good quick picture, where the user and the file say nothing.
pub fn default_passes(integrator: &IntegratorDescription) -> u32 {
    match integrator {
        IntegratorDescription::Auto(_) | IntegratorDescription::PhotonMap(_) => 16,
        IntegratorDescription::Path(settings) => 64_u32.div_ceil(settings.samples.max(1)),
        IntegratorDescription::Light(_) => 64,
    }
}
