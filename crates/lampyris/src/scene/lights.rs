//! The lights of a scene: where photons leave, where shadow rays are shot, and with which densities.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::{Scene, SurfacePoint};
use crate::geometry::{Bounds, Cone, Ray, Shape, Surface, Surfaces};
use crate::light::{
    Emission, Far, Guide, Illumination, Leaving, Light, LightId, Outlook, Parts, Sightings, Source, Span, Vista,
    illuminate_by,
};
use crate::material::Bsdf;
use crate::math::Distribution;
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// The lights and how one of them is chosen.
#[derive(Debug)]
pub(super) struct Lights {
    pub(super) all: Vec<Light>,
    /// The numbers of those that rays meet when they leave the scene.
    far: Vec<usize>,
    /// Which one a photon leaves: proportional to the power.
    emission: Distribution,
    /// Which one a shadow ray tests: half proportional to the power, half all alike, since a weak lamp may be near.
    selection: Distribution,
    /// Boxes around all that shines and that a ray can meet, if these are few.
    boxes: Option<Vec<Bounds>>,
}

/// More boxes than this are not worth asking.
const FEW: usize = 16;

/// A light that was chosen with this probability.
#[derive(Clone, Copy, Debug)]
pub struct Lamp<'s> {
    scene: &'s Scene,
    light: LightId,
    probability: f32,
    vista: Option<Vista<'s>>,
}

impl Lamp<'_> {
    /// The number of the light.
    pub fn id(&self) -> LightId {
        self.light
    }

    /// Its light that arrives at `at`, in the lanes of the pass and over the probability.
    #[inline]
    pub fn illuminate(&self, at: Vec3, sampler: &mut Sampler) -> Option<Illumination> {
        let Lamp { scene, light, probability, vista } = *self;
        if let Some(spot) = &scene.spot
            && spot.light() == light
        {
            return scene.illuminate_from(spot, probability, at);
        }
        let lamp = &scene.lights.all[light as usize];
        let (illumination, density) = match (vista.and_then(|vista| vista.places(light)), lamp.far()) {
            (Some(places), Some(far)) => {
                let (place, density) = places.sample(sampler.square());
                (illuminate_by(far, at, place)?, density * probability)
            }
            _ => (lamp.emitter().illuminate(&scene.surfaces, at, sampler)?, probability),
        };
        Some(Illumination {
            irradiance: scene.basis.lanes(illumination.irradiance / density),
            pdf: illumination.pdf.map(|pdf| pdf * density),
            emission: illumination.emission / density,
            ..illumination
        })
    }

    /// On which part of a ray it can shine.
    pub fn span(&self, ray: &Ray, length: f32) -> Option<Span> {
        self.scene.lights.all[self.light as usize].emitter().span(ray, length)
    }
}

impl Scene {
    /// The same scene, in which photons leave for where this leads them.
    #[must_use]
    pub fn guided(&self, guide: Arc<Guide>) -> Scene {
        Scene { guide: Some(guide), ..self.clone() }
    }

    /// The same scene, in which shadow rays are shot at what points are likely to see.
    #[must_use]
    pub fn with_outlook(&self, outlook: Arc<Outlook>) -> Scene {
        Scene { outlook: Some(outlook), ..self.clone() }
    }

    /// The parts of its lights that points may see on their own.
    pub fn parts_of_lights(&self) -> Parts {
        Parts::new(&self.lights.all)
    }

    /// By what was learned, if it can have been learned of this scene.
    pub fn outlook(&self, seen: &Sightings) -> Option<Outlook> {
        let parts = self.parts_of_lights();
        seen.is_fit(&parts).then(|| Outlook::new(seen, &parts, &self.lights.selection))
    }

    /// What is likely to be seen of the lights from a surface, if that is known.
    #[inline]
    pub fn vista(&self, surface: &Surface) -> Option<Vista<'_>> {
        self.outlook.as_ref().map(|outlook| outlook.vista(surface.position, surface.normal))
    }

    /// How much denser shadow rays to a light in this direction are from where one sees this than where nothing is known.
    pub fn aim_factor(&self, vista: Option<Vista>, light: LightId, toward: Vec3) -> f32 {
        self.aimed_at(vista, light as usize, toward) / self.lights.selection.probability(light as usize)
    }

    /// How often even shadow rays are shot at each part.
    pub fn shares_of_parts(&self, parts: &Parts) -> Vec<f32> {
        let of_light = |light: usize| {
            let count = parts.of(light as LightId).len();
            std::iter::repeat_n(self.lights.selection.probability(light) / count as f32, count)
        };
        (0..self.lights.all.len()).flat_map(of_light).collect()
    }

    /// The place on a light that is seen in this direction, if it can be seen in part.
    pub fn place_on(&self, light: LightId, toward: Vec3) -> Option<Vec2> {
        self.lights.all[light as usize].far().and_then(|far| far.unsample(toward))
    }

    /// How one of the lights is chosen for next-event estimation.
    #[inline]
    fn selection<'s>(&'s self, vista: Option<Vista<'s>>) -> &'s Distribution {
        vista.map_or(&self.lights.selection, |vista| vista.lights())
    }

    /// Density of a direction to a light infinitely far away, over that of shadow rays of that light alone.
    #[inline]
    fn aimed_at(&self, vista: Option<Vista>, light: usize, toward: Vec3) -> f32 {
        let chosen = self.selection(vista).probability(light);
        let light = light as LightId;
        let Some(places) = vista.and_then(|vista| vista.places(light)) else { return chosen };
        chosen * self.place_on(light, toward).map_or(1.0, |place| places.pdf(place))
    }

    /// A photon of any light, chosen by power or by the guide, and the number of that light.
    #[inline]
    pub fn emit(&self, sampler: &mut Sampler) -> Option<(LightId, Emission)> {
        let (light, emission) = match &self.guide {
            None => self.emit_by_power(sampler)?,
            Some(guide) => self.emit_guided(guide, sampler)?,
        };
        let factor = self.emission_factor(light, emission.ray, emission.normal());
        let (flux, density) = (self.basis.lanes(emission.flux / factor), emission.density * factor);
        let (light, emission) = (light as LightId, Emission { flux, density, ..emission });
        match &self.spot {
            Some(spot) if spot.light() == light => Some((light, self.sent_on(spot, emission, sampler)?)),
            _ => Some((light, emission)),
        }
    }

    fn emit_by_power(&self, sampler: &mut Sampler) -> Option<(usize, Emission)> {
        let (light, ..) = self.lights.emission.sample(sampler.uniform());
        sampler.step(1);
        Some((light, self.lights.all[light].emitter().emit(&self.surfaces, sampler)?))
    }

    fn emit_guided(&self, guide: &Guide, sampler: &mut Sampler) -> Option<(usize, Emission)> {
        let Some((light, ray)) = guide.choose(sampler.uniform()) else { return self.emit_by_power(sampler) };
        let aim = self.lights.all[light as usize].emitter().aim()?;
        let start = aim.start(&self.surfaces, sampler)?;
        let emission = aim.send(&self.surfaces, &start, ray(&start.section, sampler.square()))?;
        Some((light as usize, emission))
    }

    /// The density of a photon over that which its light alone would give it. It is on `ray`, and `normal` that of the
    /// light's surface where it leaves.
    #[inline]
    fn emission_factor(&self, light: usize, ray: Ray, normal: Vec3) -> f32 {
        let probability = self.lights.emission.probability(light);
        match &self.guide {
            None => probability,
            Some(guide) => probability * guide.factor(&self.leaving(light as LightId, ray, normal)),
        }
    }

    /// A photon that leaves a light on a ray, where `normal` is that of the light's surface.
    pub fn leaving(&self, light: LightId, ray: Ray, normal: Vec3) -> Leaving<'_> {
        let probability = self.lights.emission.probability(light as usize);
        let aim = self.lights.all[light as usize].emitter().aim();
        Leaving { number: light, light: aim, probability, ray, normal }
    }

    /// The lights whose photons can be aimed, each with the probability of choosing it by its power.
    pub fn aimed_lights(&self) -> impl Iterator<Item = (LightId, f32)> {
        let powers = (0..self.lights.all.len()).map(|light| (light, self.lights.emission.probability(light)));
        let aimed = |&(light, power): &(usize, f32)| power > 0.0 && self.lights.all[light].emitter().aim().is_some();
        powers.filter(aimed).map(|(light, power)| (light as LightId, power))
    }

    /// Light that arrives at `at`, from where one sees this, from one of the lights, with its number, for next-event
    /// estimation.
    #[inline]
    pub fn illuminate(&self, at: Vec3, vista: Option<Vista>, sampler: &mut Sampler) -> Option<(LightId, Illumination)> {
        let lamp = self.lamp_in(vista, sampler);
        Some((lamp.light, lamp.illuminate(at, sampler)?))
    }

    /// Whether shadow rays from one point can find different things: not at a single light that has no extent.
    #[inline]
    pub fn shadow_rays_differ(&self) -> bool {
        match &*self.lights.all {
            [light] => light.far().is_some() || matches!(light, Light::Area(_)),
            lights => !lights.is_empty(),
        }
    }

    /// One of the lights, chosen at random, for next-event estimation.
    #[inline]
    pub fn lamp(&self, sampler: &mut Sampler) -> Lamp<'_> {
        self.lamp_in(None, sampler)
    }

    #[inline]
    fn lamp_in<'s>(&'s self, vista: Option<Vista<'s>>, sampler: &mut Sampler) -> Lamp<'s> {
        let (light, probability, _) = self.selection(vista).sample(sampler.uniform());
        Lamp { scene: self, light: light as LightId, probability, vista }
    }

    /// Density of a photon of this light that comes this way to `at`, per area across it, over that of the shadow ray.
    pub fn emission_toward(&self, at: Vec3, light: LightId, illumination: &Illumination) -> f32 {
        let Illumination { to_light, target, emission, normal, .. } = *illumination;
        let ray = Ray { origin: target.unwrap_or(at), direction: -to_light };
        emission * self.emission_factor(light as usize, ray, normal)
    }

    /// Radiance that a surface emits back along the path that reached it.
    #[inline]
    pub fn emitted(&self, point: &SurfacePoint) -> Spectrum {
        // Most surfaces do not.
        if self.shapes[point.shape as usize].light.is_none() { Spectrum::ZERO } else { self.emitted_by_lamp(point) }
    }

    fn emitted_by_lamp(&self, point: &SurfacePoint) -> Spectrum {
        match self.area_light(point.shape) {
            Some((_, Light::Area(area))) => {
                self.basis.lanes(area.radiance(&point.surface, point.to_previous, point.footprint))
            }
            _ => Spectrum::ZERO,
        }
    }

    /// Density per solid angle with which [`Scene::illuminate`], asked at `from` where one sees this, finds this point of a
    /// light.
    pub fn emitted_pdf(&self, from: Vec3, vista: Option<Vista>, point: &SurfacePoint) -> f32 {
        match self.area_light(point.shape) {
            Some((light, Light::Area(area))) => {
                self.selection(vista).probability(light) * area.pdf(&self.surfaces, from, &point.surface)
            }
            _ => 0.0,
        }
    }

    /// Density with which [`Scene::emit`] leaves this point of a light back along the path that reached it, per area across
    /// the ray and per solid angle.
    pub fn emission_density(&self, point: &SurfacePoint) -> f32 {
        match self.area_light(point.shape) {
            Some((light, Light::Area(area))) => {
                let ray = Ray { origin: point.surface.position, direction: point.to_previous };
                self.emission_factor(light, ray, point.surface.normal) * area.emission(&self.surfaces)
            }
            _ => 0.0,
        }
    }

    /// How much denser other techniques are at the point that a photon meets first than the photon is there, per area: a
    /// path that meets the light by chance, over its density per solid angle; and a shadow ray.
    pub fn instead_of(&self, light: LightId, emission: &Emission, met: &Surface, cos: f32) -> (f32, f32) {
        let photon = emission.density * cos;
        let (at, vista) = (met.position, self.vista(met));
        let shadow_ray = self.selection(vista).probability(light as usize);
        match emission.source {
            Source::Point => (0.0, shadow_ray * at.distance_squared(emission.ray.origin) / photon),
            Source::Parallel => (0.0, shadow_ray / photon),
            Source::Far(pdf) => {
                (1.0 / photon, self.aimed_at(vista, light as usize, -emission.ray.direction) * pdf / photon)
            }
            Source::Shape(shape, surface) => {
                let pdf = self.surfaces.pdf_from(shape, at, &surface).unwrap_or(0.0);
                (1.0 / photon, shadow_ray * pdf / photon)
            }
            Source::Hidden => (0.0, 0.0),
        }
    }

    #[inline]
    fn area_light(&self, shape: u32) -> Option<(usize, &Light)> {
        let light = self.shapes[shape as usize].light? as usize;
        Some((light, &self.lights.all[light]))
    }

    /// Radiance that arrives from infinitely far away.
    #[inline]
    pub fn background(&self, toward: Vec3) -> Spectrum {
        self.basis.lanes(self.far_lights().fold(Spectrum::ZERO, |sum, (_, light)| sum + light.radiance(toward)))
    }

    /// Radiance that arrives along a ray that leaves the scene from each light infinitely far away, with the density per
    /// solid angle with which [`Scene::illuminate`] finds that light in this direction where one sees this, and, for those
    /// who ask, the density with which [`Scene::emit`] comes back along the ray, per solid angle and per area across it.
    pub fn backgrounds(
        &self,
        ray: &Ray,
        vista: Option<Vista>,
    ) -> impl Iterator<Item = (Spectrum, f32, impl FnOnce() -> f32)> {
        let (toward, back) = (ray.direction, Ray { origin: ray.origin, direction: -ray.direction });
        self.far_lights().map(move |(index, light)| {
            let pdf = light.pdf(toward);
            let emission = move || {
                pdf * light.world().density_at(ray.origin, -toward) * self.emission_factor(index, back, Vec3::ZERO)
            };
            (self.basis.lanes(light.radiance(toward)), self.aimed_at(vista, index, toward) * pdf, emission)
        })
    }

    /// Whether [`Scene::glimpse`] sees what a path would meet next: neither fog nor aims come in between.
    pub fn has_glimpses(&self) -> bool {
        !self.has_media() && self.targets.is_none()
    }

    /// Whether rays that leave the scene may meet light.
    pub fn has_sky(&self) -> bool {
        !self.lights.far.is_empty()
    }

    /// Whether a ray may meet anything that shines.
    pub fn may_meet_light(&self, ray: &Ray) -> bool {
        self.lights.may_meet(ray)
    }

    /// Tells of all that shines where a ray ends: its radiance, how far away it is, in scene units, and the density per
    /// solid angle with which [`Scene::illuminate`], asked at `from` where one sees this, finds it.
    pub fn glimpse(
        &self,
        ray: &Ray,
        cone: Cone,
        (from, vista): (Vec3, Option<Vista>),
        mut tell: impl FnMut(Spectrum, f32, f32),
    ) {
        if !self.lights.may_meet(ray) {
            return;
        }
        let Some(hit) = self.surfaces.closest(ray, f32::INFINITY) else {
            let distance = self.distance_from_far(ray.origin, ray.direction);
            return self.backgrounds(ray, vista).for_each(|(radiance, pdf, _)| tell(radiance, distance, pdf));
        };
        if self.shapes[hit.shape as usize].light.is_some() {
            let mut bsdf = Bsdf::default();
            let point = self.point(ray, &hit, cone, &Spectrum::ONE, &mut bsdf);
            tell(self.emitted_by_lamp(&point), hit.distance, self.emitted_pdf(from, vista, &point));
        }
    }

    fn far_lights(&self) -> impl Iterator<Item = (usize, &dyn Far)> {
        self.lights.far.iter().filter_map(|&index| Some((index, self.lights.all[index].far()?)))
    }

    /// Flux in W of all lights together, in linear RGB.
    pub fn power(&self) -> Spectrum {
        self.lights.all.iter().fold(Spectrum::ZERO, |sum, light| sum + light.emitter().power(&self.surfaces))
    }
}

impl Lights {
    pub(super) fn new(all: Vec<Light>, surfaces: &Surfaces) -> Lights {
        let powers: Vec<f64> = all.iter().map(|light| f64::from(light.emitter().power(surfaces).mean())).collect();
        let total: f64 = powers.iter().sum();
        let even = 1.0 / all.len().max(1) as f64;
        let selection: Vec<f64> =
            powers.iter().map(|power| 0.5 * power / total.max(f64::MIN_POSITIVE) + 0.5 * even).collect();
        let far: Vec<usize> = (0..all.len()).filter(|&index| all[index].far().is_some()).collect();
        let boxes = if far.is_empty() { boxes(&all, surfaces) } else { None };
        Lights { emission: Distribution::new(&powers), selection: Distribution::new(&selection), far, boxes, all }
    }

    /// Whether a ray may meet anything that shines.
    #[inline]
    fn may_meet(&self, ray: &Ray) -> bool {
        let Some(boxes) = &self.boxes else { return true };
        let inverse = ray.direction.recip();
        boxes.iter().any(|bounds| {
            let (a, b) = ((bounds.min - ray.origin) * inverse, (bounds.max - ray.origin) * inverse);
            let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
            // Where a coordinate is no number, as in a plane of the box, it may.
            !(enter > leave || leave < 0.0)
        })
    }
}

/// Boxes around the shapes that shine.
fn boxes(lights: &[Light], surfaces: &Surfaces) -> Option<Vec<Bounds>> {
    let shapes: Vec<&Shape> = surfaces.shapes().collect();
    let areas = lights.iter().filter_map(|light| if let Light::Area(area) = light { Some(area) } else { None });
    let boxes = areas.map(|area| {
        let bounds = shapes.get(area.shape as usize)?.bounds()?;
        // A little larger, for rounding.
        let pad = Vec3::splat(1e-3 * bounds.radius() + 1e-5 * bounds.center().length());
        Some(Bounds { min: bounds.min - pad, max: bounds.max + pad })
    });
    boxes.collect::<Option<Vec<Bounds>>>().filter(|boxes| boxes.len() <= FEW)
}
