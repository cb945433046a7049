//! The weights of all ways to make a path sum to one, and are the squares of their densities over the sum of these
//! (theory §5.4).
//!
//! Along given paths from eye to lamp, what the visitors of `auto` make of the light is compared with products of densities
//! per area as the theory has them, all in double precision, which know nothing of the sums that the walks carry.
//!
//! Where an event has one direction, its probability is left out, since both walks choose it alike. What remains of its
//! density is by how much a cone of directions becomes wider there: 1 on the way from the eye, by convention, and
//! n² cos / n'² cos' on the way back, by which the law of refraction keeps n² cos dω.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::Vec3;

use super::look::{Look, Merge, Merging};
use crate::film::Sink;
use crate::geometry::{Cone, Ray, Surface};
use crate::import::toml::read_str;
use crate::light::{Emission, Focus, Guide, Lesson, Light, LightId, Source};
use crate::material::{Bsdf, Event, Lobes, Scattered};
use crate::photon::{Deposit, Estimate, Instead, Kernel, Nearest, Photon, PhotonMap, Radius};
use crate::sampler::{Sampler, purpose};
use crate::scene::{NoAssets, Scene, SurfacePoint, build};
use crate::spectrum::Spectrum;
use crate::transport::{Limits, Origin, PathState, Visitor, direct_light, walk};

/// What a pixel sees is so wide wherever it looks, in scene units.
const WIDTH: f32 = 0.01;

/// Such that about one photon lies within each radius, if all fell into a unit square: so that no way outweighs all others.
const MERGING: Merging = Merging {
    paths: 1000,
    first: 2.5,
    further: 0.02,
    nearest: 20,
    shrunk: 0.8,
    on_from_first: 0.3,
    on_from_further: 0.7,
};

/// A way to make a path.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// The walk from the camera meets the lamp.
    Hit,
    /// A shadow ray from the last point before the lamp.
    Shadow,
    /// A photon is found at the point of this number.
    Merge(usize),
}

/// A point between eye and lamp.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    surface: Surface,
    /// Whether it scatters smoothly, too.
    smooth: bool,
    /// What happens there.
    event: Event,
    /// Index of refraction on the side of the lamp over that on the side of the eye.
    ior_ratio: f32,
}

impl Vertex {
    /// The same point where light is scattered smoothly, if it is.
    fn scattering(self) -> Option<Vertex> {
        self.smooth.then_some(Vertex { event: Event::Diffuse, ior_ratio: 1.0, ..self })
    }
}

/// Notes the points of a walk.
#[derive(Default)]
struct Recorder(Vec<Vertex>);

impl Visitor for Recorder {
    fn vertex(&mut self, point: &SurfacePoint, _: &PathState, _: &mut Sampler) -> Lobes {
        let smooth = point.bsdf.lobes().meets(Lobes::SMOOTH);
        self.0.push(Vertex { surface: point.surface, smooth, event: Event::Pass, ior_ratio: 1.0 });
        Lobes::ALL
    }

    fn scattered(&mut self, scattered: &Scattered, _: &SurfacePoint, _: &PathState) {
        if let Some(last) = self.0.last_mut() {
            (last.event, last.ior_ratio) = (scattered.event, scattered.ior_ratio.lanes()[0]);
        }
    }
}

/// Where a path ends.
#[derive(Clone, Copy, Debug)]
enum Lamp {
    Shape(u32, Surface),
    Point(Vec3),
    /// In this direction, from which light comes as from all others.
    Far(Vec3),
    /// In this direction, the only one.
    Parallel(Vec3),
}

/// Light from infinitely far away is taken to come from here, in scene units.
const FAR: f32 = 50.0;

/// A path from the eye to a lamp; its points have the numbers 0 to [`Chain::last`].
#[derive(Debug)]
struct Chain {
    eye: Vec3,
    /// From 1.
    between: Vec<Vertex>,
    light: LightId,
    lamp: Lamp,
    /// Where photons leave for, if not everywhere.
    guide: Option<Arc<Guide>>,
    /// With which a shadow ray from the last point but one finds the lamp.
    sampler: Sampler,
}

impl Chain {
    /// The number of the point on the lamp.
    fn last(&self) -> usize {
        self.between.len() + 1
    }

    fn position(&self, at: usize) -> Vec3 {
        match (at, self.lamp) {
            (0, _) => self.eye,
            (at, _) if at < self.last() => self.between[at - 1].surface.position,
            (_, Lamp::Shape(_, surface)) => surface.position,
            (_, Lamp::Point(position)) => position,
            (at, Lamp::Far(toward) | Lamp::Parallel(toward)) => self.position(at - 1) + FAR * toward,
        }
    }

    fn direction(&self, from: usize, to: usize) -> Vec3 {
        (self.position(to) - self.position(from)).normalize()
    }

    fn surface(&self, at: usize) -> Option<Surface> {
        match self.lamp {
            Lamp::Shape(_, surface) if at == self.last() => Some(surface),
            _ => Some(self.between.get(at.checked_sub(1)?)?.surface),
        }
    }

    fn ray(&self, from: usize, to: usize) -> Ray {
        let direction = self.direction(from, to);
        match self.surface(from) {
            Some(surface) => surface.spawn(direction),
            None => Ray { origin: self.position(from), direction },
        }
    }

    /// Cosine at a point of the direction to the one beside it.
    fn cos(&self, at: usize, to: usize) -> f64 {
        self.surface(at).map_or(1.0, |surface| f64::from(surface.normal.dot(self.direction(at, to)).abs()))
    }

    /// Solid angle over area: what makes a density per area at `to` of one per solid angle at `from`.
    fn per_area(&self, from: usize, to: usize) -> f64 {
        let far = matches!(self.lamp, Lamp::Far(_) | Lamp::Parallel(_)) && from.max(to) == self.last();
        let distance = if far { 1.0 } else { f64::from(self.position(from).distance(self.position(to))) };
        self.cos(to, from) / (distance * distance)
    }

    fn is_smooth(&self, at: usize) -> bool {
        Lobes::SMOOTH.contains(self.between[at - 1].event)
    }

    /// The point as a walk reaches it that comes from the one beside it; none if something is in its way.
    fn arrive<R>(&self, scene: &Scene, from: usize, at: usize, see: impl FnOnce(&SurfacePoint) -> R) -> Option<R> {
        let mut bsdf = Bsdf::default();
        let point = scene.closest(&self.ray(from, at), &mut bsdf)?;
        (point.surface.position.distance(self.position(at)) < 1e-4).then(|| see(&point))
    }

    /// Density per solid angle at a smooth point.
    fn pdf(&self, scene: &Scene, from: usize, at: usize, to: usize) -> Option<f64> {
        self.arrive(scene, from, at, |point| f64::from(point.pdf(self.direction(at, to), Lobes::ALL)))
    }

    /// The probabilities with which photons and shadow rays choose the lamp.
    fn chosen(&self, scene: &Scene) -> (f64, f64) {
        let power = |light: &Light| f64::from(light.emitter().power(scene.surfaces()).mean());
        let share = power(&scene.lights()[self.light as usize]) / scene.lights().iter().map(power).sum::<f64>();
        (share, 0.5 * share + 0.5 / scene.lights().len() as f64)
    }

    /// Density of photons that leave the lamp: per solid angle, per area across, or both, as the lamp has it.
    fn emission(&self, scene: &Scene) -> f64 {
        let section = |radius: f32| PI * f64::from(radius).powi(2);
        let density = match &scene.lights()[self.light as usize] {
            Light::Area(area) => {
                let sides = if area.two_sided { 2.0 } else { 1.0 };
                1.0 / (sides * PI * f64::from(scene.surfaces().area(area.shape)))
            }
            Light::Point(_) => 0.25 / PI,
            Light::Constant(light) => 0.25 / PI / section(light.world.radius),
            Light::Directional(light) => 1.0 / section(light.world.radius),
            other => panic!("no {} here", other.kind()),
        };
        let last = self.last();
        self.chosen(scene).0 * density * f64::from(self.guided(scene, self.ray(last, last - 1)))
    }

    /// How much denser photons are on a ray from the lamp by their guide.
    fn guided(&self, scene: &Scene, ray: Ray) -> f32 {
        let normal = if let Lamp::Shape(_, surface) = self.lamp { surface.normal } else { Vec3::ZERO };
        self.guide.as_ref().map_or(1.0, |guide| guide.factor(&scene.leaving(self.light, ray, normal)))
    }

    /// Whether photons are as dense right beside the path where it leaves the lamp: guides have edges.
    fn leaves_evenly(&self, scene: &Scene) -> bool {
        let ray = self.ray(self.last(), self.last() - 1);
        let here = self.guided(scene, ray);
        Vec3::AXES.into_iter().flat_map(|axis| [2e-5 * axis, -2e-5 * axis]).all(|off| {
            let shifted = Ray { origin: ray.origin + off, ..ray };
            let turned = Ray { direction: (ray.direction + off).normalize(), ..ray };
            [shifted, turned].into_iter().all(|ray| (self.guided(scene, ray) / here - 1.0).abs() < 1e-3)
        })
    }

    /// Density of the lamp's point for a shadow ray from the point before it: per area, per solid angle, or neither.
    fn shadow(&self, scene: &Scene) -> f64 {
        let last = self.last();
        let density = match self.lamp {
            Lamp::Shape(shape, surface) => {
                let pdf = scene.surfaces().pdf_from(shape, self.position(last - 1), &surface);
                f64::from(pdf.expect("a density")) * self.per_area(last - 1, last)
            }
            Lamp::Far(_) => 0.25 / PI,
            Lamp::Point(_) | Lamp::Parallel(_) => 1.0,
        };
        self.chosen(scene).1 * density
    }

    /// All ways to make the path, each with its density; none if there is something in its way.
    fn ways(&self, scene: &Scene) -> Option<Vec<(Way, f64)>> {
        let last = self.last();
        let first = (1..last).find(|&at| self.is_smooth(at));
        // Density of a walk from the camera that reaches the point of each number.
        let mut seen = vec![1.0; last + 1];
        for at in 1..last {
            let step = if self.is_smooth(at) {
                let on = if Some(at) == first { MERGING.on_from_first } else { MERGING.on_from_further };
                f64::from(on) * self.pdf(scene, at - 1, at, at + 1)?
            } else {
                1.0
            };
            seen[at + 1] = seen[at] * step * self.per_area(at, at + 1);
        }
        // And of one from the lamp.
        let mut lit = vec![0.0; last];
        let from_lamp = if matches!(self.lamp, Lamp::Shape(..)) { self.cos(last, last - 1) } else { 1.0 };
        lit[last - 1] = self.emission(scene) * from_lamp * self.per_area(last, last - 1);
        for at in (2..last).rev() {
            let step = if self.is_smooth(at) {
                self.pdf(scene, at + 1, at, at - 1)?
            } else {
                let ior_ratio = f64::from(self.between[at - 1].ior_ratio);
                self.cos(at, at - 1) / (self.cos(at, at + 1) * ior_ratio * ior_ratio)
            };
            lit[at - 1] = lit[at] * step * self.per_area(at, at - 1);
        }
        let mut ways = Vec::new();
        if matches!(self.lamp, Lamp::Shape(..) | Lamp::Far(_)) {
            ways.push((Way::Hit, seen[last]));
        }
        if self.is_smooth(last - 1) {
            ways.push((Way::Shadow, seen[last - 1] * self.shadow(scene)));
        }
        for at in (1..last - 1).filter(|&at| self.is_smooth(at)) {
            let radius = MERGING.shrunk * if Some(at) == first { MERGING.first * WIDTH } else { MERGING.further };
            let photons = PI * f64::from(radius).powi(2) * MERGING.paths as f64;
            ways.push((Way::Merge(at), seen[at] * photons * lit[at]));
        }
        Some(ways)
    }

    /// The path on its way from the point `from` to the one beside it, after so many events.
    fn state(&self, from: usize, to: usize, bounce: usize) -> PathState {
        let cone = Cone { width: WIDTH, spread: 0.0 };
        PathState { cone, bounce: bounce as u32, ..PathState::new(self.ray(from, to), Spectrum::ONE) }
    }

    /// The event that sends a walk from `point`, the one of number `at`, to the one beside it.
    fn scattered(&self, point: &SurfacePoint, at: usize, to: usize) -> Scattered {
        let Vertex { event, ior_ratio, .. } = self.between[at - 1];
        let ior_ratio = if to > at { ior_ratio } else { 1.0 / ior_ratio };
        let to_next = self.direction(at, to);
        let pdf = if self.is_smooth(at) { point.pdf(to_next, Lobes::ALL) } else { 1.0 };
        Scattered { to_next, weight: Spectrum::ONE, pdf, event, ior_ratio: Spectrum::grey(ior_ratio) }
    }

    fn max_bounces(&self) -> u32 {
        self.between.len() as u32
    }

    /// What `auto` adds on a walk from the camera as far as the point `end`.
    fn look(&self, scene: &Scene, map: &PhotonMap, end: usize) -> Option<Vec<Spectrum>> {
        let (mut found, mut sink) = (Nearest::default(), Noted::default());
        let merge = Merge::new(map, MERGING, &mut found);
        let mut look = Look::new(scene, self.max_bounces(), &mut sink, Some(merge));
        for at in 1..=end {
            let path = self.state(at - 1, at, at - 1);
            if at == self.last() && !matches!(self.lamp, Lamp::Shape(..)) {
                look.escaped(&path);
                continue;
            }
            self.arrive(scene, at - 1, at, |point| {
                look.vertex(point, &path, &mut self.sampler.clone());
                if at < end {
                    look.scattered(&self.scattered(point, at, at + 1), point, &path);
                }
            })?;
        }
        Some(sink.0)
    }

    /// The photon that a walk from the lamp leaves at the point of this number.
    fn photon(&self, scene: &Scene, end: usize) -> Option<Photon> {
        let instead = Instead::new(scene, MERGING.density(MERGING.further), MERGING.on_from_further);
        let max_bounces = self.max_bounces();
        let mut deposit = Deposit {
            photons: Vec::new(),
            direct: false,
            max_bounces,
            path: 0,
            parallel: false,
            instead: Some(instead),
        };
        let source = match self.lamp {
            Lamp::Shape(shape, surface) => Source::Shape(shape, surface),
            Lamp::Point(_) => Source::Point,
            Lamp::Far(_) => Source::Far((0.25 / PI) as f32),
            Lamp::Parallel(_) => Source::Parallel,
        };
        let (last, density) = (self.last(), self.emission(scene) as f32);
        let emission = Emission { ray: self.ray(last, last - 1), flux: Spectrum::ONE, source, density };
        deposit.emitted(0, self.light, &emission);
        for at in (end..last).rev() {
            let path = self.state(at + 1, at, last - 1 - at);
            self.arrive(scene, at + 1, at, |point| {
                deposit.vertex(point, &path, &mut self.sampler.clone());
                if at > end {
                    deposit.scattered(&self.scattered(point, at, at - 1), point, &path);
                }
            })?;
        }
        // Exactly there, not beside it by rounding.
        let position = self.arrive(scene, end - 1, end, |point| point.surface.position)?;
        deposit.photons.pop().map(|photon| Photon { position, ..photon })
    }

    /// The weight that `auto` gives the path when it is made in this way: what it adds, over what there is.
    fn weight(&self, scene: &Scene, way: Way) -> Option<f64> {
        let (last, radius) = (self.last(), MERGING.shrunk * MERGING.further);
        let map = |photons: Vec<Photon>| PhotonMap::build(photons, MERGING.paths, Radius::Fixed(radius));
        let (added, all) = match way {
            Way::Hit => {
                let added = self.look(scene, &map(Vec::new()), last)?;
                let all = match self.lamp {
                    Lamp::Shape(..) => self.arrive(scene, last - 1, last, |point| scene.emitted(point))?,
                    _ => scene.background(self.direction(last - 1, last)),
                };
                (added.last().copied()?, all)
            }
            Way::Shadow => {
                // The last light is that of photons, of which there are none.
                let added = self.look(scene, &map(Vec::new()), last - 1)?;
                let direct = |point: &SurfacePoint| direct_light(scene, point, &mut self.sampler.clone(), |_, _| 1.0).0;
                let all = self.arrive(scene, last - 2, last - 1, direct)?;
                (added[added.len() - 2], all)
            }
            Way::Merge(at) => {
                let map = map(vec![self.photon(scene, at)?]);
                let added = self.look(scene, &map, at)?;
                let is_first = (1..at).all(|before| !self.is_smooth(before));
                let radius = if is_first { MERGING.shrunk * MERGING.first * WIDTH } else { radius };
                let estimate = Estimate { map: &map, kernel: Kernel::Epanechnikov, radius: Radius::Fixed(radius) };
                let read = |point: &SurfacePoint| estimate.radiance(point, u32::MAX, &mut Nearest::default());
                (added.last().copied()?, self.arrive(scene, at - 1, at, read)?)
            }
        };
        (!all.is_zero()).then(|| f64::from(added.mean()) / f64::from(all.mean()))
    }

    /// Whether light can take this path, and no step of it is so short or so level that rounding decides.
    fn carries(&self, scene: &Scene) -> bool {
        let last = self.last();
        let open = |at: usize| {
            let long = self.position(at).distance(self.position(at - 1)) > 0.03;
            let steep = self.cos(at, at - 1) > 0.1 && self.cos(at - 1, at) > 0.1;
            let lamp = at == last && !matches!(self.lamp, Lamp::Shape(..));
            long && steep && (lamp || self.arrive(scene, at - 1, at, |_| ()).is_some())
        };
        let passes = |at: usize| {
            let value = |from: usize, to: usize| {
                self.arrive(scene, from, at, |point| point.eval_radiance(self.direction(at, to)).mean() > 1e-4)
            };
            let both = || Some(value(at - 1, at + 1)? && value(at + 1, at - 1)?);
            if self.is_smooth(at) { both() == Some(true) } else { self.arrive(scene, at + 1, at, |_| ()).is_some() }
        };
        let shines = || match self.lamp {
            Lamp::Shape(..) => {
                self.arrive(scene, last - 1, last, |point| !scene.emitted(point).is_zero()) == Some(true)
            }
            _ => true,
        };
        (1..=last).all(open) && (1..last).all(passes) && shines()
    }
}

/// All light that is added, in its order.
#[derive(Clone, Default)]
struct Noted(Vec<Spectrum>);

impl Sink for Noted {
    const LAYERED: bool = false;

    fn clear(&mut self) {
        self.0.clear();
    }

    fn add(&mut self, light: Spectrum, _: u32, _: f64) {
        self.0.push(light);
    }

    fn take(&mut self, _: &Noted, _: f32) {}

    fn radiance(&self) -> Spectrum {
        self.0.iter().fold(Spectrum::ZERO, |sum, light| sum + *light)
    }
}

/// The most points between eye and lamp.
const MOST: usize = 6;

/// The longest walk, without roulette.
const LIMITS: Limits = Limits { max_bounces: MOST as u32 - 1, roulette_from: u32::MAX };

/// Paths whose last point before the lamp scatters smoothly: along a walk from the camera, as far as each of its points, and
/// on to a lamp as a shadow ray chooses it.
fn lit_directly(scene: &Scene, eye: Vec3, walked: &[Vertex], sampler: &Sampler) -> Vec<Chain> {
    let chain = |number: usize| {
        let between = extended(walked, number)?;
        let from = &between.last()?.surface;
        let (light, choice) = scene.illuminate(from.position, &mut sampler.clone())?;
        let lamp = match (&scene.lights()[light as usize], choice.to_light) {
            (Light::Point(point), _) => Lamp::Point(point.position),
            (Light::Directional(_), toward) => Lamp::Parallel(toward),
            (Light::Area(_), toward) => {
                let mut bsdf = Bsdf::default();
                let met = scene.closest(&from.spawn(toward), &mut bsdf)?;
                // Of another lamp that is in the way there is more than one point.
                (scene.shapes()[met.shape as usize].light == Some(light))
                    .then_some(Lamp::Shape(met.shape, met.surface))?
            }
            (_, toward) => Lamp::Far(toward),
        };
        Some(Chain { eye, between, light, lamp, guide: None, sampler: sampler.clone() })
    };
    (1..=walked.len()).filter_map(chain).collect()
}

/// The first points of a walk, as many as `number`, if the last can scatter smoothly.
fn extended(walked: &[Vertex], number: usize) -> Option<Vec<Vertex>> {
    let mut first = walked[..number].to_vec();
    if let Some(last) = first.last_mut() {
        *last = last.scattering()?;
    }
    Some(first)
}

/// Paths whose last point before the lamp is a mirror or glass: a walk from the lamp, joined with one from the camera, or
/// seen by the camera.
fn lit_by_glass(scene: &Scene, eye: Vec3, walked: &[Vertex], sampler: &mut Sampler) -> Vec<Chain> {
    let Some((light, emission)) = scene.emit(sampler) else { return Vec::new() };
    let mut recorder = Recorder::default();
    let path = PathState::new(emission.ray, emission.flux);
    walk(scene, path, Origin::Light, &LIMITS, sampler, &mut recorder);
    let lamp = match emission.source {
        Source::Point => Lamp::Point(emission.ray.origin),
        Source::Parallel => Lamp::Parallel(-emission.ray.direction),
        Source::Far(_) => Lamp::Far(-emission.ray.direction),
        Source::Shape(shape, surface) => Lamp::Shape(shape, surface),
        Source::Hidden => return Vec::new(),
    };
    if recorder.0.first().is_none_or(|vertex| Lobes::SMOOTH.contains(vertex.event) || vertex.event == Event::Pass) {
        return Vec::new();
    }
    let chain = |(seen, lit): (usize, usize)| {
        let (mut between, lit) = (extended(walked, seen)?, extended(&recorder.0, lit)?);
        between.extend(lit.iter().rev().map(|vertex| Vertex { ior_ratio: 1.0 / vertex.ior_ratio, ..*vertex }));
        let sampler = sampler.clone();
        (between.len() <= MOST).then_some(Chain { eye, between, light, lamp, guide: None, sampler })
    };
    let lengths = (0..=walked.len()).flat_map(|seen| (2..=recorder.0.len()).map(move |lit| (seen, lit)));
    lengths.filter_map(chain).collect()
}

/// How often each thing was seen, so that no test passes for want of it.
#[derive(Debug, Default)]
struct Seen {
    hits: u32,
    shadow_rays: u32,
    merges: u32,
    /// Paths with mirrors or boundaries at their end, and elsewhere.
    glass: [u32; 2],
    /// Ways that made between 2 and 98 % of their path.
    shared: u32,
}

/// Compares the weights of all ways of the paths that so many walks give.
#[track_caller]
fn assert_weights(text: &str, walks: u64) -> Seen {
    let camera = "camera = { origin = [0.1, 0.3, -0.9], target = [0, -0.4, 0.2], fov = 70 }
        film = { size = [16, 16] }\n";
    let text = camera.to_string() + text;
    let description = read_str("a.toml".as_ref(), &text).unwrap_or_else(|error| panic!("{error}\n{text}")).description;
    let even = build(&description, &NoAssets).expect("a scene").scene;
    let guide = Arc::new(guide(&even));
    let scenes = [(even.guided(guide.clone()), Some(guide)), (even, None)];
    let mut seen = Seen::default();
    for (scene, guide) in scenes {
        compare_all(&scene, &guide, walks, &mut seen);
    }
    seen
}

/// Aims at the balls, and elsewhere, with more photons here than there.
fn guide(scene: &Scene) -> Guide {
    let foci = [(-0.4, 0.4), (0.5, 0.35)].map(|(x, radius)| Focus { center: Vec3::new(x, -0.6, 0.25), radius });
    let cells = |odd: usize| (0..Lesson::CELLS).map(|cell| (1 + cell * odd % 7) as f32).collect();
    let lesson = |light, focus, share, odd| Lesson { light, focus, share, cells: cells(odd) };
    let lessons = scene.aimed_lights().flat_map(|(light, _)| {
        [lesson(light, Some(0), 2.0, 3), lesson(light, Some(1), 1.0, 5), lesson(light, None, 1.0, 11)]
    });
    Guide::new(&foci, 1.0, &lessons.collect::<Vec<Lesson>>())
}

#[track_caller]
fn compare_all(scene: &Scene, guide: &Option<Arc<Guide>>, walks: u64, seen: &mut Seen) {
    for index in 0..walks {
        let mut sampler = Sampler::new(1, 0, purpose::CAMERA, index);
        let (ray, _) = scene.view(16.0 * sampler.square(), &mut sampler);
        let mut recorder = Recorder::default();
        walk(scene, PathState::new(ray, Spectrum::ONE), Origin::Camera, &LIMITS, &mut sampler, &mut recorder);
        let mut chains = lit_directly(scene, ray.origin, &recorder.0, &sampler);
        chains.extend(lit_by_glass(scene, ray.origin, &recorder.0, &mut sampler));
        let chains = chains.into_iter().map(|chain| Chain { guide: guide.clone(), ..chain });
        for chain in chains.filter(|chain| chain.carries(scene) && chain.leaves_evenly(scene)) {
            compare(scene, &chain, seen);
        }
    }
}

#[track_caller]
fn compare(scene: &Scene, chain: &Chain, seen: &mut Seen) {
    let Some(ways) = chain.ways(scene) else { return };
    let total: f64 = ways.iter().map(|(_, density)| density * density).sum();
    let mut sum = 0.0;
    for &(way, density) in &ways {
        // None for a shadow ray that does not get there.
        let Some(weight) = chain.weight(scene, way) else { return };
        // What is compared is densities, whose squares the weights are.
        let expected = density / total.sqrt();
        assert!(
            (weight.sqrt() - expected).abs() < 1e-3 * expected + 1e-6,
            "{way:?} has the weight {weight} instead of {}: {ways:?}, {:?}",
            expected * expected,
            chain.between
        );
        sum += weight;
        seen.shared += u32::from((0.02..0.98).contains(&weight));
    }
    assert!((sum - 1.0).abs() < 1e-3, "the weights sum to {sum}: {ways:?}, {:?}", chain.between);
    let last = chain.last();
    for (way, _) in ways {
        match way {
            Way::Hit => seen.hits += 1,
            Way::Shadow => seen.shadow_rays += 1,
            Way::Merge(_) => seen.merges += 1,
        }
    }
    seen.glass[0] += u32::from(!chain.is_smooth(last - 1));
    seen.glass[1] += u32::from((1..last - 1).any(|at| !chain.is_smooth(at)));
}

const WALLS: &str = "
    [[shapes]]
    type = 'cube'
    flip-normal = true
    material = { type = 'diffuse', reflectance = [0.7, 0.5, 0.3] }\n";

const FLOOR: &str = "
    [[shapes]]
    type = 'quad'
    corner = [-1, -1, -1]
    u = [0, 0, 2]
    v = [2, 0, 0]
    material = { type = 'rough-diffuse', reflectance = 0.8, alpha = 0.4 }\n";

/// One that shines down, and a weaker one that shines to both sides.
const LAMPS: &str = "
    [[shapes]]
    type = 'quad'
    corner = [-0.4, 0.9, -0.4]
    u = [0.8, 0, 0]
    v = [0, 0, 0.8]
    material = { type = 'diffuse', reflectance = 0.3 }
    emission = { radiance = [3, 4, 5] }
    [[shapes]]
    type = 'quad'
    corner = [-0.9, -0.5, -0.5]
    u = [0, 0.8, 0.1]
    v = [0, 0, 0.8]
    emission = { radiance = 2, two-sided = true }\n";

fn ball(center: &str, radius: f32, material: &str) -> String {
    format!("[[shapes]]\ntype = 'sphere'\ncenter = [{center}]\nradius = {radius}\nmaterial = {material}\n")
}

fn light(settings: &str) -> String {
    format!("lights = [{{ {settings} }}]\n")
}

const GLASS: &str = "{ type = 'glass', ior = 1.5 }";
const PLASTIC: &str = "{ type = 'plastic', reflectance = 0.7 }";
const ROUGH_PLASTIC: &str = "{ type = 'plastic', reflectance = 0.6, roughness = { alpha = 0.3 } }";
const ROUGH_GLASS: &str = "{ type = 'glass', ior = 1.4, roughness = { alpha = 0.5 } }";

/// Balls on the floor.
fn balls(left: &str, right: &str) -> String {
    ball("-0.4, -0.6, 0.3", 0.4, left) + &ball("0.5, -0.65, 0.2", 0.35, right)
}

#[test]
fn weights_sum_to_one_between_smooth_walls_under_lamps() {
    let seen = assert_weights(&(WALLS.to_string() + LAMPS + &balls(ROUGH_PLASTIC, ROUGH_GLASS)), 600);
    assert!(seen.hits > 500 && seen.shadow_rays > 500 && seen.merges > 1000 && seen.shared > 1000, "{seen:?}");
}

#[test]
fn weights_sum_to_one_where_mirrors_and_glass_lie_between() {
    let pane = "[[shapes]]\ntype = 'quad'\ncorner = [-1, 0.5, -1]\nu = [0, 0, 2]\nv = [2, 0, 0]
        material = { type = 'thin-glass', ior = 1.5 }\n";
    for things in
        [balls(GLASS, PLASTIC), balls(GLASS, "{ type = 'mirror' }") + pane, balls(PLASTIC, ROUGH_GLASS) + pane]
    {
        let seen = assert_weights(&(WALLS.to_string() + LAMPS + &things), 600);
        assert!(seen.hits > 500 && seen.shadow_rays > 100 && seen.merges > 500 && seen.shared > 500, "{seen:?}");
        assert!(seen.glass.iter().all(|&paths| paths > 50), "{seen:?}");
    }
}

#[test]
fn weights_sum_to_one_around_a_lamp_in_glass() {
    let lamp = ball("0.1, -0.3, 0.3", 0.15, "{ type = 'diffuse', reflectance = 0.2 }").replace("[[shapes]]", "");
    let lamp = format!("[[shapes]]\nemission = {{ radiance = 5 }}{lamp}");
    let seen = assert_weights(&(WALLS.to_string() + &ball("0.1, -0.3, 0.3", 0.4, GLASS) + &lamp), 600);
    assert!(seen.hits > 500 && seen.merges > 500 && seen.shared > 500 && seen.glass[0] > 200, "{seen:?}");
    let point = light("type = 'point', position = [0.2, -0.3, 0.2], intensity = 1");
    let seen = assert_weights(&(point + WALLS + &ball("0.1, -0.3, 0.3", 0.4, GLASS)), 600);
    assert!(seen.hits == 0 && seen.merges > 200 && seen.shared > 50 && seen.glass[0] > 200, "{seen:?}");
}

#[test]
fn weights_sum_to_one_in_light_of_a_point() {
    let point = light("type = 'point', position = [-0.4, 0.7, 0.3], intensity = [1, 1.5, 2]");
    let seen = assert_weights(&(point + WALLS + &balls(GLASS, ROUGH_PLASTIC)), 600);
    assert!(seen.hits == 0 && seen.shadow_rays > 300 && seen.merges > 500 && seen.shared > 500, "{seen:?}");
}

#[test]
fn weights_sum_to_one_under_the_sky() {
    let sky = light("type = 'constant', radiance = [1, 2, 3]");
    for things in [balls(GLASS, ROUGH_PLASTIC), balls(PLASTIC, ROUGH_GLASS)] {
        let seen = assert_weights(&(sky.clone() + FLOOR + &things), 2000);
        assert!(seen.hits > 300 && seen.shadow_rays > 300 && seen.merges > 200 && seen.shared > 200, "{seen:?}");
    }
}

#[test]
fn weights_sum_to_one_in_parallel_light() {
    let sun = light("type = 'directional', direction = [0.5, -1, 0.3], irradiance = [3, 2, 1]");
    let seen = assert_weights(&(sun + FLOOR + &balls(GLASS, ROUGH_PLASTIC)), 2000);
    assert!(seen.hits == 0 && seen.shadow_rays > 200 && seen.merges > 100 && seen.shared > 100, "{seen:?}");
}
