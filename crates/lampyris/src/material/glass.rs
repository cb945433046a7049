//! Clear dielectrics: a smooth boundary, and a thin pane.

use glam::Vec3;

use super::{Event, Fan, Scatter, Shares};
use crate::math::fresnel::{self, Boundary};
use crate::spectrum::Spectrum;

/// A smooth boundary between two clear substances (theory §3.2).
#[derive(Clone, Copy, Debug)]
pub struct Glass {
    /// Index of refraction below the normal over that above it.
    pub ior: f32,
    /// The indices of the lanes, where they differ.
    pub fan: Option<Fan>,
    /// How much slower light is below than above, if there is no fan.
    pub slowness: f32,
    /// Tint of the reflected light, 0 to 1.
    pub reflectance: Spectrum,
    /// Tint of the refracted light, 0 to 1.
    pub transmittance: Spectrum,
}

/// A thin pane: two boundaries and all the reflections between them at once; light goes straight through.
#[derive(Clone, Copy, Debug)]
pub struct ThinGlass {
    /// Index of refraction of the pane over that around it.
    pub ior: f32,
    /// Tint of the reflected light, 0 to 1.
    pub reflectance: Spectrum,
    /// Tint of the transmitted light, 0 to 1.
    pub transmittance: Spectrum,
}

impl Scatter for Glass {
    fn shares(&self, to_previous: Vec3) -> Shares {
        if let Some(fan) = &self.fan {
            let reflected = fan.lanes(|ior| fresnel::dielectric(to_previous.z, ior).reflectance);
            let refracted = reflected.map(|reflected| 1.0 - reflected);
            return delta_shares(self.reflectance * reflected, self.transmittance * refracted);
        }
        let reflected = fresnel::dielectric(to_previous.z, self.ior).reflectance;
        delta_shares(self.reflectance * reflected, self.transmittance * (1.0 - reflected))
    }

    fn sample(&self, event: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)> {
        let ior = match self.followed(event, u) {
            Some((fan, lane)) => fan.iors[lane],
            None => self.ior,
        };
        delta_direction(event, to_previous, &fresnel::dielectric(to_previous.z, ior))
    }
}

impl Glass {
    /// The lane that alone goes on, where the event is one in which the ways of the lanes part.
    #[inline]
    pub(super) fn followed(&self, event: Event, u: Vec3) -> Option<(&Fan, usize)> {
        let fan = self.fan.as_ref().filter(|_| event == Event::Refraction)?;
        Some((fan, fan.choose(u.x).0))
    }
}

impl Scatter for ThinGlass {
    fn shares(&self, to_previous: Vec3) -> Shares {
        // One boundary reflects r; the geometric series over all reflections inside sums to 2r / (1 + r).
        let once = fresnel::dielectric(to_previous.z.abs(), self.ior).reflectance;
        let reflected = 2.0 * once / (1.0 + once);
        delta_shares(self.reflectance * reflected, self.transmittance * (1.0 - reflected))
    }

    fn sample(&self, event: Event, to_previous: Vec3, _: Vec3) -> Option<(Vec3, f32)> {
        let to_next = if event == Event::Specular { fresnel::reflect(to_previous) } else { -to_previous };
        Some((to_next, 1.0))
    }
}

/// Shares of mirrored and refracted light.
pub(super) fn delta_shares(specular: Spectrum, refraction: Spectrum) -> Shares {
    let mut shares = [Spectrum::ZERO; Event::ALL.len()];
    shares[Event::Specular.index()] = specular;
    shares[Event::Refraction.index()] = refraction;
    shares
}

/// The mirrored or the refracted direction with its ratio of indices; none for refraction under total reflection.
pub(super) fn delta_direction(event: Event, to_previous: Vec3, boundary: &Boundary) -> Option<(Vec3, f32)> {
    match event {
        Event::Specular => Some((fresnel::reflect(to_previous), 1.0)),
        _ if boundary.cos_refracted == 0.0 => None,
        _ => Some((fresnel::refract(to_previous, boundary), boundary.ior_ratio)),
    }
}
