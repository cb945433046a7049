//! Path tracing that merges with photons, under multiple importance sampling (theory §5.4).
//!
//! Direct light is path traced; all other light can also come from photons that lie near a point of the camera's path,
//! and the power heuristic weighs all ways by their densities. Where photons are dense, few paths go on from there.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use serde::{Deserialize, Serialize};

use super::alone::alone;
use super::blocks::{CameraPass, Eye};
use super::guiding::{self, Judgement, Learned};
use super::look::Look;
use super::merge::{Found, Merge, Merging};
use super::path::{CAMERA_ROULETTE_FROM, PathTracing};
use super::photons::{Maps, Photons};
use super::reuse;
use super::reuse::Lending;
use super::sharing::Sharing;
use super::survey::{outlook, survey};
use super::volume::{VolumeEstimate, Wishes};
use super::{Integrator, Observer, Pass, Phase, Work, pilot, with};
use crate::error::Result;
use crate::film::{Arrival, Exposure, Layers, Sink};
use crate::light::{Guide, Outlook, Sightings};
use crate::material::Lobes;
use crate::photon::{Instead, Kernel, Nearest, PhotonMap, Radius, shrunk};
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::scene::description::{AutoSettings, FilmDescription, PathSettings};
use crate::transport::{Limits, Origin, PathState, walk};

/// See the module.
#[derive(Clone, Debug)]
pub struct Auto {
    settings: AutoSettings,
    pilot: Pilot,
    guide: Option<Arc<Guide>>,
    outlook: Option<Arc<Outlook>>,
    /// What traces paths where photons are not worth their price.
    alone: Option<PathTracing>,
}

/// What the pilot finds: about the first pass.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Pilot {
    /// Light paths a pass.
    paths: u64,
    /// Whether these are worth their price.
    is_worth_it: bool,
    /// The radius on the first smooth surface that the camera sees, over the width of what a pixel sees there.
    first: f32,
    /// The radius on all further surfaces, in scene units.
    further: f32,
    /// How many photons are typically found in these.
    counts: [f32; 2],
    /// So many times as many light paths as usual, at least once.
    times: f32,
    /// Over how many time bins the light of photons at one place is spread.
    bins: f32,
    /// How far photons stand for paths that go on, 0 to 1.
    useful: f32,
    /// Where photons leave for.
    learned: Option<Learned>,
    /// How light in media is estimated, where there are any.
    volume: Option<VolumeEstimate>,
    /// Where shadow rays are shot, if that was worth learning.
    seen: Option<Sightings>,
}

/// Of photons that are denser than typical, as in a caustic, the nearest of so many are enough, and blur less; where there
/// are more photons in all than usual, or their light is spread over time bins, of more of them.
const NEAREST: f32 = 20.0;
/// On the first surface, the radius is so large that it typically holds that many photons, but at least so many pixels. If
/// that takes more than the larger number of pixels, photons are too few to bring what paths bring as well: the radius is
/// smaller again by as much, so that they blur little, and are left to what is denser than typical. On all further surfaces,
/// where what it blurs is not seen, it is so large that it holds this many.
const FIRST_PIXELS: [f32; 2] = [3.0, 8.0];
const FURTHER_COUNT: f32 = 5.0;

/// Light paths a pass for each pixel, but no less and no more than so many; and at least and at most so many times that, by
/// what they are worth.
const PATHS_PER_PIXEL: f32 = 0.5;
const PATHS: [f32; 2] = [16_384.0, 1_048_576.0];
const TIMES: [f32; 2] = [0.125, 4.0];

/// A ray through a medium typically finds so many photons.
const VOLUME_COUNT: usize = 30;

/// What even numbers leave of the camera's variance, which is judged by independent ones; measured.
const EVENNESS: f32 = 0.4;

/// Where photons bring less than this share of the light, paths that go on do more for direct light, by meeting lamps, than
/// photons save them.
const LEAST_SHARE: f32 = 0.05;

/// So many photons in media a pass, whatever the picture's size: the price of a ray grows with them, and passes are many;
/// measured.
const ENOUGH_BEAMS: f64 = 16_384.0;

/// Photons are left where they make variance times price so many times less, as the pilot judges. It flatters them: its unit of
/// light at a place has its own photons in it, a film's paths are more even than its photons, and of these there are fewer at
/// a point as radii shrink; measured.
const LEAST_WORTH: f32 = 2.0;

/// To look for photons around the points of a path from the camera and to weigh them takes so many rays' time; measured.
const SEARCHES: f32 = 0.2;

/// What is learned is used if it is worth so many times as many photons.
const LEAST_GAIN: f32 = 1.5;

impl Auto {
    /// With these settings, and what a pilot finds out.
    pub fn new(
        scene: &Scene,
        film: &FilmDescription,
        settings: AutoSettings,
        seed: u64,
        observer: &dyn Observer,
    ) -> Auto {
        let pilot = Pilot::measure(scene, film, &settings, seed, observer);
        Auto::with(scene, settings, pilot)
    }

    fn with(scene: &Scene, settings: AutoSettings, pilot: Pilot) -> Auto {
        let AutoSettings { samples, max_bounces, guiding, reuse, .. } = settings;
        let of_paths = PathSettings { samples, max_bounces, guiding, reuse };
        let alone = (!pilot.is_worth_it).then(|| PathTracing::seeing(scene, of_paths, pilot.seen.clone()));
        Auto { settings, guide: pilot.guide(), outlook: pilot.outlook(scene), alone, pilot }
    }

    /// With what a pilot has found out before.
    ///
    /// # Errors
    /// If it is no such thing, or not about such a scene.
    pub(super) fn resumed(scene: &Scene, settings: AutoSettings, pilot: &[u8]) -> Result<Auto> {
        let pilot: Pilot = pilot::read(pilot)?;
        if !pilot.is_fit(scene, &settings) {
            return Err(pilot::unfit());
        }
        Ok(Auto::with(scene, settings, pilot))
    }

    /// How paths merge with the photons of a pass.
    fn merging(&self, pass: &Pass) -> Merging {
        self.pilot.merging(shrunk::<2>(pass.index, self.settings.alpha))
    }
}

/// Follows paths that merge with the photons of a pass.
struct Merged {
    maps: Maps,
    sharing: Sharing,
    merging: Merging,
    limits: Limits,
}

impl Eye for Merged {
    type Working = Found;

    fn look<S: Sink>(
        &self,
        scene: &Scene,
        path: PathState,
        sampler: &mut Sampler,
        found: &mut Found,
        sink: &mut S,
        _: Option<Lending<S>>,
    ) -> u32 {
        let merge = Merge::new(&self.maps.surface, self.merging, found);
        let volume = self.maps.volume.as_ref().map(|map| (map, self.sharing));
        let mut look = Look::merging(scene, self.limits.max_bounces, sink, merge, volume);
        walk(scene, path, Origin::Camera, &self.limits, sampler, &mut look).rays
    }
}

impl Pilot {
    fn measure(
        scene: &Scene,
        film: &FilmDescription,
        settings: &AutoSettings,
        seed: u64,
        observer: &dyn Observer,
    ) -> Pilot {
        let pixels = film.size[0] as f32 * film.size[1] as f32;
        let by_pixels = (PATHS_PER_PIXEL * pixels).clamp(PATHS[0], PATHS[1]) as u64;
        let (further, counts) = (pilot::fallback(scene), [0.0; 2]);
        let paths = settings.photons.map_or(by_pixels, u64::from);
        let learned = settings.guiding.then(|| Learned::nothing(scene));
        let seen = settings.guiding.then(|| survey(scene, film, settings.max_bounces, seed, observer)).flatten();
        let mut pilot = Pilot {
            paths,
            is_worth_it: true,
            first: 1.0,
            further,
            counts,
            times: 1.0,
            bins: 1.0,
            useful: 1.0,
            learned,
            volume: None,
            seen,
        };
        let scene = &*with(scene, &pilot.outlook(scene), Scene::with_outlook);
        let rounds = if settings.guiding { guiding::ROUNDS } else { 0 };
        for round in 0..=rounds {
            let pass = Pass { index: pilot::PASS - round, seed };
            let scene = &*with(scene, &pilot.guide(), Scene::guided);
            let counting = Counting::new(observer);
            pilot.volume = pilot.volume_estimate(scene, film, settings, seed, &counting);
            let maps = pilot.look_around(scene, film, settings, &pass, &counting);
            let ways = (pilot.merging(1.0), Sharing::of(pilot.volume, &maps));
            let judgement = guiding::judge(scene, film, settings, &pass, &maps, ways);
            if round < rounds {
                pilot.learned = pilot.learned.map(|learned| learned.more(scene, &pass, &judgement.worth));
                continue;
            }
            pilot.learned = pilot.learned.filter(|learned| learned.gain(scene, &pass, &judgement.worth) > LEAST_GAIN);
            pilot.useful = (judgement.share / LEAST_SHARE).min(1.0);
            if settings.photons.is_none() {
                let rays = counting.rays() as f32 / pilot.paths as f32;
                let judged = pilot.paths as f32;
                pilot.choose_paths(&judgement, rays);
                let times = pilot.paths as f32 / judged;
                if settings.radius.is_none() && pilot.volume.is_none() {
                    let of_light = rays * pilot.paths as f32 / (pixels * settings.samples as f32);
                    let price = judgement.rays + SEARCHES + of_light;
                    let merged = (EVENNESS * judgement.of_camera + judgement.of_photons / times) * price;
                    let reuse = settings.reuse && reuse::is_possible(scene);
                    let alone = alone(scene, &pass, settings.max_bounces, reuse, &judgement.places);
                    pilot.is_worth_it = EVENNESS * alone.variance * alone.rays >= LEAST_WORTH * merged;
                }
            }
        }
        if !pilot.is_worth_it {
            return pilot;
        }
        // What is changed so is measured again.
        let pass = Pass { index: pilot::PASS - rounds - 1, seed };
        let scene = &*with(scene, &pilot.guide(), Scene::guided);
        pilot.look_around(scene, film, settings, &pass, observer);
        pilot.volume = pilot.volume_estimate(scene, film, settings, seed, observer).map(|estimate| {
            let direct = Sharing::measure(scene, film, settings, pilot.photons(settings), estimate, seed, observer);
            VolumeEstimate { direct, ..estimate }
        });
        pilot
    }

    /// As many light paths as make error times price least, where each takes so many rays.
    fn choose_paths(&mut self, judgement: &Judgement, rays: f32) {
        let variances = judgement.of_photons / (EVENNESS * judgement.of_camera);
        let times = (variances * judgement.rays / rays).sqrt();
        let times = if times.is_finite() { times.clamp(TIMES[0], TIMES[1]) } else { 1.0 };
        self.paths = (self.paths as f32 * times) as u64;
        self.times = times.max(1.0);
    }

    /// Of how many photons the nearest are enough. Least error is with a radius that grows with the sixth root of the variance,
    /// which grows with the number of bins that share the light.
    fn nearest(&self) -> usize {
        (NEAREST * self.times.sqrt() * self.bins.cbrt()) as usize
    }

    /// How light in media is estimated with so many photons.
    fn volume_estimate(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        settings: &AutoSettings,
        seed: u64,
        observer: &dyn Observer,
    ) -> Option<VolumeEstimate> {
        let (volume, radius, alpha) = (settings.volume, settings.volume_radius, None);
        let (kernel, shrinks, count) = (Kernel::Epanechnikov, true, VOLUME_COUNT);
        let enough = settings.photons.is_none().then_some(ENOUGH_BEAMS);
        let wishes = Wishes { volume, radius, alpha, kernel, shrinks, count, enough };
        VolumeEstimate::new(scene, film, wishes, self.photons(settings), seed, observer)
    }

    /// Which photons a pass leaves on surfaces.
    fn photons(&self, settings: &AutoSettings) -> Photons {
        Photons { paths: self.paths, max_bounces: settings.max_bounces, direct: false, volume: None }
    }

    /// Leaves photons and sets the radii by them.
    fn look_around(
        &mut self,
        scene: &Scene,
        film: &FilmDescription,
        settings: &AutoSettings,
        pass: &Pass,
        observer: &dyn Observer,
    ) -> Maps {
        let maps = photon_maps(scene, &self.merging(1.0), self.volume, settings.max_bounces, pass, observer);
        observer.phase(Phase::Pilot);
        if settings.radius.is_none() {
            let count = NEAREST as usize;
            self.bins = pilot::bins_of_neighbours(scene, film, settings.max_bounces, pass.seed, &maps.surface, count);
        }
        self.set_radii(scene, film, settings, &maps.surface, pass.seed);
        maps
    }

    fn set_radii(
        &mut self,
        scene: &Scene,
        film: &FilmDescription,
        settings: &AutoSettings,
        map: &PhotonMap,
        seed: u64,
    ) {
        let (mut found, mut widths, mut radii) = (Nearest::default(), Vec::new(), Vec::new());
        let (nearest, of_further) = (self.nearest(), FURTHER_COUNT * self.bins.cbrt());
        pilot::gather_points(scene, film, settings.max_bounces, seed, |point, path, smooth_events| {
            if smooth_events == 0 {
                widths.push(pilot::distance(map, point, nearest, &mut found) / path.cone.width);
                return Lobes::ALL;
            }
            radii.push(pilot::distance(map, point, of_further as usize, &mut found));
            Lobes::NONE
        });
        let typical = pilot::median(widths).unwrap_or(f32::INFINITY);
        let further = pilot::median(radii);
        let [least, turn] = FIRST_PIXELS;
        let turn = turn * self.bins.cbrt().sqrt();
        self.first = settings.radius.unwrap_or(typical.min(turn * turn / typical).max(least));
        self.further = further.unwrap_or_else(|| pilot::fallback(scene));
        self.counts = [nearest as f32 * (self.first / typical).powi(2), further.map_or(0.0, |_| of_further)];
    }

    /// Whether it can have been measured: films come from anywhere.
    fn is_fit(&self, scene: &Scene, settings: &AutoSettings) -> bool {
        let most = (TIMES[1] * PATHS[1]) as u64;
        let paths = settings.photons.map_or(1..=most, |photons| photons.into()..=photons.into());
        let positive = |number: f32| number.is_finite() && number > 0.0;
        let learned = self.learned.as_ref();
        paths.contains(&self.paths)
            && (1.0..=TIMES[1]).contains(&self.times)
            && (1.0..=pilot::MOST_BINS).contains(&self.bins)
            && positive(self.first)
            && positive(self.further)
            && self.counts.iter().all(|&count| count >= 0.0)
            && (0.0..=1.0).contains(&self.useful)
            && self.volume.is_none_or(|volume| volume.is_fit())
            && learned.is_none_or(|learned| settings.guiding && learned.is_fit(scene))
            && self.seen.as_ref().is_none_or(|seen| settings.guiding && seen.is_fit(&scene.parts_of_lights()))
    }

    fn guide(&self) -> Option<Arc<Guide>> {
        self.learned.as_ref().map(|learned| Arc::new(learned.guide()))
    }

    fn outlook(&self, scene: &Scene) -> Option<Arc<Outlook>> {
        self.seen.as_ref().and_then(|seen| outlook(scene, seen))
    }

    /// With radii that have shrunk to this share.
    fn merging(&self, shrunk: f32) -> Merging {
        // As photons at a point and a path that goes on from there do the same, only so much of the latter is worth while; but
        // where there is less than one photon, all of it is.
        let on = |count: f32| 1.0 / (self.useful * count * shrunk * shrunk).max(1.0);
        let [first, further] = self.counts.map(on);
        Merging {
            paths: self.paths,
            first: self.first,
            shrunk,
            further: self.further,
            nearest: self.nearest(),
            on_from_first: first,
            on_from_further: further,
        }
    }
}

/// Counts rays.
struct Counting<'o> {
    observer: &'o dyn Observer,
    rays: AtomicU64,
}

impl<'o> Counting<'o> {
    fn new(observer: &'o dyn Observer) -> Counting<'o> {
        Counting { observer, rays: AtomicU64::new(0) }
    }

    fn rays(&self) -> u64 {
        self.rays.load(Ordering::Relaxed)
    }
}

impl Observer for Counting<'_> {
    fn phase(&self, phase: Phase) {
        self.observer.phase(phase);
    }

    fn work(&self, work: &Work) {
        self.rays.fetch_add(work.rays, Ordering::Relaxed);
        self.observer.work(work);
    }
}

/// The photon maps of a pass: on surfaces, of light that has been scattered at least once, or that only photons find.
fn photon_maps(
    scene: &Scene,
    merging: &Merging,
    volume: Option<VolumeEstimate>,
    max_bounces: u32,
    pass: &Pass,
    observer: &dyn Observer,
) -> Maps {
    let photons = Photons { paths: merging.paths, max_bounces, direct: false, volume };
    let instead = || Some(Instead::new(scene, merging.density(merging.further), merging.on_from_further));
    photons.maps(scene, pass, Radius::Fixed(merging.shrunk * merging.further), instead, observer)
}

impl Integrator for Auto {
    fn expose_in_parts(
        &self,
        scene: &Scene,
        film: &FilmDescription,
        pass: &Pass,
        layers: Layers,
        observer: &dyn Observer,
        arrived: &mut dyn FnMut(&[Arrival]),
    ) -> Exposure {
        if let Some(alone) = &self.alone {
            return alone.expose_in_parts(scene, film, pass, layers, observer, arrived);
        }
        let scene = &*with(scene, &self.outlook, Scene::with_outlook);
        let scene = &*with(scene, &self.guide, Scene::guided);
        let (merging, max_bounces) = (self.merging(pass), self.settings.max_bounces);
        let maps = photon_maps(scene, &merging, self.pilot.volume, max_bounces, pass, observer);
        observer.phase(Phase::Camera);
        let limits = Limits { max_bounces, roulette_from: CAMERA_ROULETTE_FROM };
        let sharing = Sharing::of(self.pilot.volume, &maps);
        let eye = Merged { maps, sharing, merging, limits };
        CameraPass { scene, film, pass, samples: self.settings.samples, layers, observer }.expose(&eye, arrived)
    }

    fn area(&self, pass: &Pass) -> Option<f64> {
        // What blurs media shrinks at another rate: two kinds of bias cannot be told by one.
        let blurs_surfaces_alone = self.pilot.volume.is_none() && self.pilot.is_worth_it;
        blurs_surfaces_alone.then(|| f64::from(shrunk::<2>(pass.index, self.settings.alpha)).powi(2))
    }

    fn remark(&self) -> Option<&'static str> {
        self.alone.as_ref().map(|_| "auto left no photons, as here they are not worth their price")
    }

    fn name(&self) -> &'static str {
        "auto"
    }

    fn pilot(&self) -> Vec<u8> {
        pilot::write(&self.pilot)
    }
}
