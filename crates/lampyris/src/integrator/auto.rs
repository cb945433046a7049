//! Path tracing that merges with photons, under multiple importance sampling (theory §5.4).
//!
//! Direct light is path traced; all other light can also come from photons that lie near a point of the camera's path,
//! and the balance heuristic weighs all ways by their densities. Where photons are dense, few paths go on from there.

use serde::{Deserialize, Serialize};

use super::blocks::camera_pass;
use super::look::{Look, Merge, Merging};
use super::path::CAMERA_ROULETTE_FROM;
use super::photons::Photons;
use super::{Integrator, Observer, Pass, Phase, pilot};
use crate::error::Result;
use crate::film::{Exposure, Layered, Layers, Plain, Sink};
use crate::material::Lobes;
use crate::photon::{Instead, Nearest, PhotonMap, Radius, shrunk};
use crate::scene::Scene;
use crate::scene::description::{AutoSettings, FilmDescription};
use crate::transport::{Limits, Origin, walk};

/// See the module.
#[derive(Clone, Debug)]
pub struct Auto {
    settings: AutoSettings,
    pilot: Pilot,
}

/// What the pilot finds: about the first pass.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Pilot {
    /// Light paths a pass.
    paths: u64,
    /// The radius on the first smooth surface that the camera sees, over the width of what a pixel sees there.
    first: f32,
    /// The radius on all further surfaces, in scene units.
    further: f32,
    /// How many photons are typically found in these.
    counts: [f32; 2],
}

/// On the first surface, the radius is so large that it typically holds this many photons, but never less or more than
/// so many pixels; and on all further ones, where what it blurs is not seen, this many.
const FIRST_COUNT: usize = 20;
const FIRST_PIXELS: [f32; 2] = [2.0, 5.0];
const FURTHER_COUNT: usize = 5;

/// Light paths a pass for each pixel; and no less and no more than so many.
const PATHS_PER_PIXEL: f32 = 0.5;
const PATHS: [f32; 2] = [16_384.0, 1_048_576.0];

impl Auto {
    /// With these settings, and what a pilot finds out.
    pub fn new(
        scene: &Scene,
        film: &FilmDescription,
        settings: AutoSettings,
        seed: u64,
        observer: &dyn Observer,
    ) -> Auto {
        let pixels = film.size[0] as f32 * film.size[1] as f32;
        let by_pixels = (PATHS_PER_PIXEL * pixels).clamp(PATHS[0], PATHS[1]) as u64;
        let paths = settings.photons.map_or(by_pixels, u64::from);
        let pilot = Pilot::measure(scene, film, &settings, paths, seed, observer);
        Auto { settings, pilot }
    }

    /// With what a pilot has found out before.
    ///
    /// # Errors
    /// If it is no such thing.
    pub fn resumed(settings: AutoSettings, pilot: &[u8]) -> Result<Auto> {
        Ok(Auto { settings, pilot: pilot::read(pilot)? })
    }

    /// How paths merge with the photons of a pass.
    fn merging(&self, pass: &Pass) -> Merging {
        self.pilot.merging(shrunk::<2>(pass.index, self.settings.alpha))
    }

    fn look<S: Sink>(&self, scene: &Scene, film: &FilmDescription, pass: &Pass, observer: &dyn Observer) -> Exposure {
        let merging = self.merging(pass);
        let map = photon_map(scene, &merging, self.settings.max_bounces, pass, observer);
        observer.phase(Phase::Camera);
        let limits = Limits { max_bounces: self.settings.max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
        let samples = self.settings.samples;
        camera_pass(scene, film, pass, samples, observer, Nearest::default, |path, sampler, found, sink: &mut S| {
            let merge = Merge::new(&map, merging, found);
            let mut look = Look::new(scene, limits.max_bounces, sink, Some(merge));
            walk(scene, path, Origin::Camera, &limits, sampler, &mut look).rays
        })
    }
}

impl Pilot {
    fn measure(
        scene: &Scene,
        film: &FilmDescription,
        settings: &AutoSettings,
        paths: u64,
        seed: u64,
        observer: &dyn Observer,
    ) -> Pilot {
        let guess = Pilot { paths, first: 1.0, further: pilot::fallback(scene), counts: [0.0; 2] };
        let pass = Pass { index: pilot::PASS, seed };
        let map = photon_map(scene, &guess.merging(1.0), settings.max_bounces, &pass, observer);
        observer.phase(Phase::Pilot);
        let (mut found, mut widths, mut radii) = (Nearest::default(), Vec::new(), Vec::new());
        pilot::gather_points(scene, film, settings.max_bounces, seed, |point, path, smooth_events| {
            if smooth_events == 0 {
                widths.push(pilot::distance(&map, point, FIRST_COUNT, &mut found) / path.cone.width);
                return Lobes::ALL;
            }
            radii.push(pilot::distance(&map, point, FURTHER_COUNT, &mut found));
            Lobes::NONE
        });
        let typical = pilot::median(widths).unwrap_or(f32::INFINITY);
        let first = settings.radius.unwrap_or(typical.clamp(FIRST_PIXELS[0], FIRST_PIXELS[1]));
        let further = pilot::median(radii);
        Pilot {
            paths,
            first,
            further: further.unwrap_or(guess.further),
            counts: [FIRST_COUNT as f32 * (first / typical).powi(2), further.map_or(0.0, |_| FURTHER_COUNT as f32)],
        }
    }

    /// With radii that have shrunk to this share.
    fn merging(&self, shrunk: f32) -> Merging {
        // As photons at a point and a path that goes on from there do the same, only so much of the latter is worth while.
        let on = |count: f32| 1.0 / (1.0 + count * shrunk * shrunk);
        let [first, further] = self.counts.map(on);
        Merging {
            paths: self.paths,
            first: self.first,
            shrunk,
            further: self.further,
            on_from_first: first,
            on_from_further: further,
        }
    }
}

/// The photon map of a pass: of light that has been scattered at least once, or that only photons find.
fn photon_map(scene: &Scene, merging: &Merging, max_bounces: u32, pass: &Pass, observer: &dyn Observer) -> PhotonMap {
    let photons = Photons { paths: merging.paths, max_bounces, direct: false };
    let instead = || Some(Instead::new(scene, merging.density(merging.further), merging.on_from_further));
    photons.map(scene, pass, Radius::Fixed(merging.shrunk * merging.further), instead, observer)
}

impl Integrator for Auto {
    fn expose(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        layers: Layers,
        observer: &dyn Observer,
    ) -> Exposure {
        match layers.is_empty() {
            true => self.look::<Plain>(scene, film, pass, observer),
            false => self.look::<Layered>(scene, film, pass, observer),
        }
    }

    fn area(&self, pass: &Pass) -> Option<f64> {
        Some(f64::from(shrunk::<2>(pass.index, self.settings.alpha)).powi(2))
    }

    fn name(&self) -> &'static str {
        "auto"
    }

    fn pilot(&self) -> Vec<u8> {
        pilot::write(&self.pilot)
    }
}
