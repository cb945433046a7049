//! Paths from eye to lamp, the densities of all ways to make them, and the weights that the visitors of `auto` give these.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::Vec3;

use crate::film::Sink;
use crate::geometry::{Cone, Ray, Surface};
use crate::integrator::look::{Look, SHOTS};
use crate::integrator::merge::{COUNTED, Found, Merge, Merging};
use crate::light::{Emission, Guide, Light, LightId, Source};
use crate::material::{Bsdf, Event, Lobes, Scattered};
use crate::photon::{Deposit, Estimate, Instead, Kernel, Nearest, Photon, PhotonMap, Radius};
use crate::sampler::Sampler;
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transient::Met;
use crate::transport::{PathState, Visitor, direct_light};

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
pub(super) enum Way {
    /// The walk from the camera meets the lamp.
    Hit,
    /// A shadow ray from the last point before the lamp.
    Shadow,
    /// A glimpse into the glossy lobe of that point, if it is the first smooth one.
    Glimpse,
    /// A photon is found at the point of this number.
    Merge(usize),
}

/// A point between eye and lamp.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub(super) surface: Surface,
    /// Whether it scatters smoothly, too.
    pub(super) smooth: bool,
    /// What happens there.
    pub(super) event: Event,
    /// Index of refraction on the side of the lamp over that on the side of the eye.
    pub(super) ior_ratio: f32,
}

impl Vertex {
    /// The same point where light is scattered smoothly, if it is.
    pub(super) fn scattering(self) -> Option<Vertex> {
        self.smooth.then_some(Vertex { event: Event::Diffuse, ior_ratio: 1.0, ..self })
    }
}

/// Where a path ends.
#[derive(Clone, Copy, Debug)]
pub(super) enum Lamp {
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
pub(super) struct Chain {
    pub(super) eye: Vec3,
    /// From 1.
    pub(super) between: Vec<Vertex>,
    pub(super) light: LightId,
    pub(super) lamp: Lamp,
    /// Where photons leave for, if not everywhere.
    pub(super) guide: Option<Arc<Guide>>,
    /// With which a shadow ray from the last point but one finds the lamp.
    pub(super) sampler: Sampler,
}

impl Chain {
    /// The number of the point on the lamp.
    pub(super) fn last(&self) -> usize {
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

    pub(super) fn is_smooth(&self, at: usize) -> bool {
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
    pub(super) fn leaves_evenly(&self, scene: &Scene) -> bool {
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
        let Some(vista) = scene.vista(&self.between[last - 2].surface) else { return self.chosen(scene).1 * density };
        let place = |toward| vista.places(self.light)?.pdf(scene.place_on(self.light, toward)?).into();
        let aimed = if let Lamp::Far(toward) = self.lamp { place(toward) } else { None };
        f64::from(vista.lights().probability(self.light as usize) * aimed.unwrap_or(1.0)) * density
    }

    /// Whether shadow rays find the lamp so near that they are not even by its area.
    pub(super) fn is_near(&self, scene: &Scene) -> bool {
        let Lamp::Shape(shape, _) = self.lamp else { return false };
        let of_area = self.shadow(scene) * f64::from(scene.surfaces().area(shape)) / self.chosen(scene).1;
        scene.vista(&self.between[self.last() - 2].surface).is_none() && (of_area - 1.0).abs() > 0.01
    }

    /// All ways to make the path, each with its density; none if there is something in its way.
    pub(super) fn ways(&self, scene: &Scene) -> Option<Vec<(Way, f64)>> {
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
            ways.push((Way::Shadow, seen[last - 1] * f64::from(self.shots(scene)) * self.shadow(scene)));
        }
        let glossy = |point: &SurfacePoint| f64::from(point.gloss_pdf(self.direction(last - 1, last)));
        let is_met = matches!(self.lamp, Lamp::Shape(..) | Lamp::Far(_));
        let glimpsed =
            if is_met && first == Some(last - 1) { self.arrive(scene, last - 2, last - 1, glossy)? } else { 0.0 };
        if glimpsed > 0.0 {
            ways.push((Way::Glimpse, seen[last - 1] * glimpsed * self.per_area(last - 1, last)));
        }
        for at in (1..last - 1).filter(|&at| self.is_smooth(at)) {
            let radius = MERGING.shrunk * if Some(at) == first { MERGING.first * WIDTH } else { MERGING.further };
            let photons = f64::from(COUNTED) * PI * f64::from(radius).powi(2) * MERGING.paths as f64;
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
        Scattered {
            to_next,
            weight: Spectrum::ONE,
            pdf,
            event,
            ior_ratio: Spectrum::grey(ior_ratio),
            slowness: ior_ratio,
            slot: event.index() as u8,
        }
    }

    fn max_bounces(&self) -> u32 {
        self.between.len() as u32
    }

    /// What `auto` adds on a walk from the camera as far as the point `end`.
    fn look(&self, scene: &Scene, map: &PhotonMap, end: usize) -> Option<Vec<Spectrum>> {
        let (mut found, mut sink) = (Found::default(), Noted::default());
        let merge = Merge::new(map, MERGING, &mut found);
        let mut look = Look::merging(scene, self.max_bounces(), &mut sink, merge, None);
        for at in 1..=end {
            self.see(scene, &mut look, at, |look, point, path| {
                if at < end {
                    look.scattered(&self.scattered(point, at, at + 1), point, path);
                }
            })?;
        }
        Some(sink.0)
    }

    /// What a glimpse at the lamp from the point before it adds, and the light of which it is a part.
    fn glimpse(&self, scene: &Scene) -> Option<(Spectrum, Spectrum)> {
        let (mut found, mut sink) = (Found::default(), Noted::default());
        let map = PhotonMap::build(Vec::new(), MERGING.paths, Radius::Fixed(1.0));
        let merge = Merge::new(&map, MERGING, &mut found);
        let mut look = Look::merging(scene, self.max_bounces(), &mut sink, merge, None);
        let (end, mut added) = (self.last() - 1, None);
        let to_light = self.direction(end, end + 1);
        for at in 1..=end {
            self.see(scene, &mut look, at, |look, point, path| {
                if at < end {
                    return look.scattered(&self.scattered(point, at, at + 1), point, path);
                }
                let before = look.sink.0.len();
                look.glimpse_toward(to_light, point, path);
                let all = point.eval_radiance(to_light) * (point.cos(to_light) / point.gloss_pdf(to_light));
                added = look.sink.0.get(before).map(|&added| (added, all));
            })?;
        }
        let light = match self.lamp {
            Lamp::Shape(..) => self.arrive(scene, end, end + 1, |point| scene.emitted(point))?,
            _ => scene.background(to_light),
        };
        added.map(|(added, all)| (added, all * light))
    }

    /// Shows the visitor of a walk from the camera the point of this number.
    fn see<'a>(
        &self,
        scene: &Scene,
        look: &mut Look<'a, Noted, true>,
        at: usize,
        then: impl FnOnce(&mut Look<'a, Noted, true>, &SurfacePoint, &PathState),
    ) -> Option<()> {
        let path = self.state(at - 1, at, at - 1);
        if at == self.last() && !matches!(self.lamp, Lamp::Shape(..)) {
            look.escaped(&path);
            return Some(());
        }
        self.arrive(scene, at - 1, at, |point| {
            look.vertex(point, &path, &mut self.sampler.clone());
            then(look, point, &path);
        })
    }

    /// The photon that a walk from the lamp leaves at the point of this number.
    fn photon(&self, scene: &Scene, end: usize) -> Option<Photon> {
        let instead = Instead::new(scene, MERGING.density(MERGING.further), MERGING.on_from_further);
        let max_bounces = self.max_bounces();
        let mut deposit = Deposit::on_surfaces(max_bounces, Some(instead));
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
    pub(super) fn weight(&self, scene: &Scene, way: Way) -> Option<f64> {
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
                let shots = self.shots(scene);
                let direct = |point: &SurfacePoint| {
                    let (path, mut sampler) = (self.state(last - 2, last - 1, 0), last_shot(&self.sampler, shots));
                    direct_light(scene, point, scene.vista(&point.surface), &path, &mut sampler, |_, _| 1.0).0
                };
                let all = self.arrive(scene, last - 2, last - 1, direct)?;
                (added[added.len() - 2] * shots as f32, all)
            }
            Way::Glimpse => self.glimpse(scene)?,
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

    /// Shadow rays that are shot from the last point before the lamp.
    fn shots(&self, scene: &Scene) -> u32 {
        shots(scene, (1..self.last() - 1).all(|before| !self.is_smooth(before)))
    }

    /// Whether light can take this path, and no step of it is so short or so level that rounding decides.
    pub(super) fn carries(&self, scene: &Scene) -> bool {
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

/// Shadow rays that are shot where a path scatters smoothly, for the first time or not.
pub(super) fn shots(scene: &Scene, is_first: bool) -> u32 {
    if is_first && scene.shadow_rays_differ() { SHOTS } else { 1 }
}

/// The numbers of the last of so many shadow rays.
pub(super) fn last_shot(sampler: &Sampler, shots: u32) -> Sampler {
    let mut sampler = sampler.clone();
    (0..shots).fold(sampler.clone(), |_, number| sampler.part(number, shots))
}

/// All light that is added, in its order.
#[derive(Clone, Default)]
struct Noted(Vec<Spectrum>);

impl Sink for Noted {
    const LAYERED: bool = false;

    fn clear(&mut self) {
        self.0.clear();
    }

    fn add(&mut self, light: Spectrum, _: Met, _: f64) {
        self.0.push(light);
    }

    fn borrow(&mut self, _: &Noted, _: Spectrum, _: f64) {}

    fn take(&mut self, _: &Noted, _: f32) {}

    fn radiance(&self) -> Spectrum {
        self.0.iter().fold(Spectrum::ZERO, |sum, light| sum + *light)
    }
}
