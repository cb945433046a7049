//! The spot that a laser lights: a lamp by way of the surface that it falls on (theory §8.1).

use std::borrow::Cow;

use glam::{Vec2, Vec3};

use super::{Scene, SurfacePoint};
use crate::error::{Error, Result};
use crate::geometry::{Cone, Hit, Ray};
use crate::light::{Emission, Illumination, Laser, Light, LightId, Source};
use crate::material::{Bsdf, Lobes};
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;
use crate::transient::Capture;

/// Where a laser first meets a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    light: LightId,
    /// From the laser.
    ray: Ray,
    hit: Hit,
    /// Flux in W, as it arrives.
    power: Spectrum,
    /// How far light has come until here, as far as it counts, in scene units.
    leg: f32,
}

impl Spot {
    /// The number of the laser.
    pub(super) fn light(&self) -> LightId {
        self.light
    }
}

/// What lies nearer to the spot than so many of its errors is the spot, which does not light itself.
const ERRORS: f32 = 64.0;

impl Scene {
    /// Points the laser, if there is one that is for one point alone.
    ///
    /// # Errors
    /// A beam that lights nothing, or where nothing scatters its light smoothly.
    pub(super) fn set_spot(&mut self) -> Result<()> {
        let Some((light, Laser { target: Some(target), .. })) = self.laser() else { return Ok(()) };
        let key = self.light_key(light);
        let fault = |message: &str, hint: &str| Err(Error::at_key(&key, message).with_hint(hint));
        self.spot = self.spot_toward(*target);
        let Some(spot) = &self.spot else {
            return fault("the laser meets no surface", "let its target lie on one, or beyond none");
        };
        if !self.spot_point(spot, &mut Bsdf::default()).bsdf.lobes().meets(Lobes::SMOOTH) {
            return fault(
                "the laser meets a surface that only mirrors or refracts its light",
                "a light of the type 'beam' is followed by photons through mirrors and glass",
            );
        }
        Ok(())
    }

    /// The key of a light in the scene file, for messages; lights that are surfaces come first.
    fn light_key(&self, light: LightId) -> String {
        let surfaces = self.lights().iter().take_while(|light| matches!(light, Light::Area(_))).count();
        format!("lights[{}]", light as usize - surfaces)
    }

    /// The laser.
    fn laser(&self) -> Option<(LightId, &Laser)> {
        let lasers = (0..).zip(self.lights());
        lasers
            .into_iter()
            .find_map(|(id, light)| if let Light::Laser(laser) = light { Some((id, laser)) } else { None })
    }

    /// Where the laser meets the scene if it points there.
    fn spot_toward(&self, target: Vec3) -> Option<Spot> {
        let (light, laser) = self.laser()?;
        let ray = laser.ray(target)?;
        let hit = self.surfaces.closest(&ray, f32::INFINITY)?;
        let leg = if self.camera.wall().is_some_and(|wall| !wall.legs) { 0.0 } else { hit.distance };
        Some(Spot { light, ray, hit, power: laser.power, leg })
    }

    /// The scene as a pixel sees it, by a point of it: lit by a laser that points where that pixel wants it, if the camera is
    /// of that kind, else as it is.
    #[inline]
    pub fn of_pixel(&self, pixel: Vec2) -> Cow<'_, Scene> {
        match self.camera.wall().and_then(|wall| wall.lit(pixel)) {
            None => Cow::Borrowed(self),
            Some(target) => Cow::Owned(Scene { spot: self.spot_toward(target), ..self.clone() }),
        }
    }

    /// How far the light of a lamp has come before it sets out, in scene units: to the spot of a laser.
    #[inline]
    pub fn traveled(&self, light: LightId) -> f32 {
        self.spot.as_ref().filter(|spot| spot.light == light).map_or(0.0, |spot| spot.leg)
    }

    /// By how much less than its ray a path from the camera counts, in scene units: without the way from a wall to a sensor.
    #[inline]
    pub fn head_start(&self, pixel: Vec2) -> f32 {
        self.camera.wall().map_or(0.0, |wall| wall.head_start(pixel))
    }

    fn spot_point<'s, 'b>(&'s self, spot: &Spot, bsdf: &'b mut Bsdf<'s>) -> SurfacePoint<'b> {
        self.point(&spot.ray, &spot.hit, Cone::THIN, &Spectrum::ONE, bsdf)
    }

    /// Light of the spot that arrives at a point, if the laser is chosen with this probability.
    #[inline(never)]
    pub(super) fn illuminate_from(&self, spot: &Spot, probability: f32, at: Vec3) -> Option<Illumination> {
        let mut bsdf = Bsdf::default();
        let point = self.spot_point(spot, &mut bsdf);
        let to = point.surface.position - at;
        let (distance2, nothing) = (to.length_squared(), ERRORS * point.surface.error);
        if distance2 <= nothing * nothing {
            return None;
        }
        let to_light = to / distance2.sqrt();
        let intensity = self.basis.lanes(spot.power / probability) * point.sent(-to_light);
        let illumination = Illumination {
            to_light,
            target: Some(point.surface.offset(-to_light)),
            irradiance: intensity / distance2,
            pdf: None,
            emission: point.pdf(-to_light, Lobes::SMOOTH) / (distance2 * probability),
            normal: Vec3::ZERO,
        };
        (!illumination.irradiance.is_zero()).then_some(illumination)
    }

    /// A photon of the beam, once the spot has sent it on.
    #[inline(never)]
    pub(super) fn sent_on(&self, spot: &Spot, beam: Emission, sampler: &mut Sampler) -> Option<Emission> {
        let mut bsdf = Bsdf::default();
        let point = self.spot_point(spot, &mut bsdf);
        let scattered = point.sample(Lobes::SMOOTH, sampler)?;
        let flux = beam.flux * point.sent(scattered.to_next) / scattered.pdf;
        let density = beam.density * scattered.pdf;
        let emission = Emission { ray: point.surface.spawn(scattered.to_next), flux, source: Source::Point, density };
        (!flux.is_zero()).then_some(emission)
    }

    /// Where a wall is lit and looked at, if that is what the camera does.
    pub fn capture(&self) -> Option<Capture> {
        let (wall, (_, laser)) = (self.camera.wall()?, self.laser()?);
        let single = self.spot.map(|spot| spot.ray.at(spot.hit.distance));
        Some(wall.capture(laser.position, single))
    }
}
