//! A render: passes into a film, one after the other, by anyone.

use std::io::{self, Write};
use std::ops::Range;

use crate::checkpoint::{self, Checkpoint, Identity};
use crate::error::{Error, Result};
use crate::film::{Arrival, Clock, Exposure, Film, Layers, PassSet, Storage};
use crate::integrator::{Integrator, Observer, Pass, integrator, resumed, timed};
use crate::scene::description::{AutoSettings, FilmDescription, IntegratorDescription, PathSettings};
use crate::scene::{Scene, SceneDescription};

/// A render under way. It knows neither clock nor budget: its owner decides after each pass whether to go on.
pub struct Render<'s> {
    scene: &'s Scene,
    settings: FilmDescription,
    integrator: Box<dyn Integrator>,
    seed: u64,
    film: Film,
    passes: PassSet,
}

impl<'s> Render<'s> {
    /// Makes ready to render `scene`, which was built from `description`, with the integrator, film and seed that the
    /// description names, the picture alone.
    pub fn new(scene: &'s Scene, description: &SceneDescription, observer: &dyn Observer) -> Render<'s> {
        Render::with_layers(scene, description, Layers::NONE, observer)
    }

    /// [`Render::new`], and these layers beside the picture.
    ///
    /// # Panics
    /// If the film has more time bins than there can be, which descriptions of scenes that were built do not ask for.
    pub fn with_layers(
        scene: &'s Scene,
        description: &SceneDescription,
        layers: Layers,
        observer: &dyn Observer,
    ) -> Render<'s> {
        let render = Render::stored(scene, description, layers, &Storage::Memory, observer);
        render.unwrap_or_else(|error| panic!("{error}"))
    }

    /// [`Render::with_layers`], with the film's time bins where `storage` says.
    ///
    /// # Errors
    /// Files for which there is no room, and more time bins than there can be.
    pub fn stored(
        scene: &'s Scene,
        description: &SceneDescription,
        layers: Layers,
        storage: &Storage,
        observer: &dyn Observer,
    ) -> Result<Render<'s>> {
        let (settings, seed) = (description.film.clone(), description.render.seed);
        let settings = timed(scene, settings, &description.integrator, seed, observer);
        let mut film = Film::with_layers(settings.size, layers);
        if let Some(clock) = Clock::of(&settings) {
            film = film.with_time(clock, storage)?.with_capture(scene.capture())?;
        }
        let integrator = integrator(scene, &settings, &description.integrator, seed, observer);
        Ok(Render { scene, film, settings, integrator, seed, passes: PassSet::new() })
    }

    /// Goes on from a checkpoint of the same scene and description: whoever calls this has
    /// [compared](Identity::difference) their identities.
    ///
    /// # Errors
    /// If the checkpoint's pilot is not one of this integrator, or its film has another size.
    pub fn resume(scene: &'s Scene, description: &SceneDescription, checkpoint: Checkpoint) -> Result<Render<'s>> {
        let (mut settings, seed) = (description.film.clone(), description.render.seed);
        let integrator = resumed(scene, &description.integrator, checkpoint.pilot())?;
        let (mut film, passes) = checkpoint.into_film();
        if film.size() != settings.size.map(|side| side as usize) {
            return Err(Error::new("the film has another size than it should"));
        }
        if let (Some(time), Some(clock)) = (&mut settings.time, film.clock())
            && !time.keeps_amplitudes()
        {
            time.fix(clock.start(), clock.bin_width());
        }
        if Clock::of(&settings).as_ref() != film.clock() {
            return Err(Error::new("the film has other time bins than it should"));
        }
        if film.clock().is_some() {
            film = film.with_capture(scene.capture())?;
        }
        Ok(Render { scene, film, settings, integrator, seed, passes })
    }

    /// Writes all that it takes to go on later, or elsewhere: the bytes of a [`Checkpoint`]. `identity` is that of the scene
    /// and description.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn write_checkpoint(&self, identity: &Identity, to: &mut dyn Write) -> io::Result<()> {
        checkpoint::write(identity, &self.integrator.pilot(), &self.passes, &self.film, to)
    }

    /// Renders the first pass that is not there yet, on the current `rayon` pool.
    pub fn step(&mut self, observer: &dyn Observer) {
        self.step_in(&(0..u32::MAX), observer);
    }

    /// Renders the first of these passes that is not there yet, on the current `rayon` pool. Returns whether there was one,
    /// and room for it in the film.
    pub fn step_in(&mut self, wanted: &Range<u32>, observer: &dyn Observer) -> bool {
        let missing = self.passes.first_missing(wanted).filter(|_| self.film.passes() < Film::MOST_PASSES);
        let Some(index) = missing else { return false };
        let pass = Pass { index, seed: self.seed };
        let layers = self.film.layers();
        let scene = self.scene.of_pass(pass.seed, pass.index);
        let film = &mut self.film;
        let mut arrived = |arrivals: &[Arrival]| film.add_arrivals(arrivals);
        let exposure = self.integrator.expose_in_parts(&scene, &self.settings, &pass, layers, observer, &mut arrived);
        let area = self.integrator.area(&pass).map(|area| (index, area));
        self.film.add_pass(&Exposure { area, ..exposure });
        self.passes.insert(index);
        true
    }

    /// What is rendered.
    pub fn scene(&self) -> &Scene {
        self.scene
    }

    /// What was rendered so far.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// The passes that were.
    pub fn passes(&self) -> &PassSet {
        &self.passes
    }

    /// The integrator.
    pub fn integrator(&self) -> &dyn Integrator {
        self.integrator.as_ref()
    }
}

/// How many passes make a good quick picture, where the user and the file say nothing.
pub fn default_passes(integrator: &IntegratorDescription) -> u32 {
    match integrator {
        IntegratorDescription::PhotonMap(_) => 16,
        IntegratorDescription::Auto(AutoSettings { samples, .. })
        | IntegratorDescription::Path(PathSettings { samples, .. }) => 64_u32.div_ceil((*samples).max(1)),
        IntegratorDescription::Light(_) => 64,
    }
}
