//! Direct light by next-event estimation, and the weights that combine it with paths that meet lamps by chance.

use super::{MediumPoint, PathState};
use crate::light::{Illumination, LightId, Vista};
use crate::material::Lobes;
use crate::sampler::Sampler;
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;

const NOTHING: (Spectrum, f32) = (Spectrum::ZERO, 0.0);

/// Radiance that the smooth lobes at `point`, from where one sees this of the lights, reflect from one of them, chosen at
/// random, back along the path (theory §4.3), times a weight against other ways of finding the same light; with the distance
/// that it came, in scene units times how much slower light is on its side than on the side of the path.
pub fn direct_light(
    scene: &Scene,
    point: &SurfacePoint,
    vista: Option<Vista>,
    path: &PathState,
    sampler: &mut Sampler,
    weight: impl FnOnce(LightId, &Illumination) -> f32,
) -> (Spectrum, f32) {
    if !point.bsdf.lobes().meets(Lobes::SMOOTH) {
        return NOTHING;
    }
    match scene.illuminate(point.surface.position, vista, sampler) {
        Some((light, illumination)) => light_from(scene, point, (light, &illumination), path, sampler, weight),
        None => NOTHING,
    }
}

/// [`direct_light`] of what was chosen.
#[inline]
pub fn light_from(
    scene: &Scene,
    point: &SurfacePoint,
    (light, illumination): (LightId, &Illumination),
    path: &PathState,
    sampler: &mut Sampler,
    weight: impl FnOnce(LightId, &Illumination) -> f32,
) -> (Spectrum, f32) {
    let value = point.eval_radiance(illumination.to_light);
    if value.is_zero() {
        return NOTHING;
    }
    let factor = |visibility: f32| point.cos(illumination.to_light) * weight(light, illumination) * visibility;
    let distance = || {
        scene.distance_of(point.surface.position, light, illumination) * point.slowness_toward(illumination.to_light)
    };
    if scene.has_media() {
        let passage = scene.passage_to(point, &path.inside, illumination, sampler);
        if passage.is_zero() {
            return NOTHING;
        }
        return (value * illumination.irradiance * passage * factor(1.0), distance());
    }
    let visibility = scene.visibility(&point.surface, illumination);
    if visibility <= 0.0 {
        return NOTHING;
    }
    (value * illumination.irradiance * factor(visibility), distance())
}

/// [`direct_light`] at a point in a medium.
pub fn direct_light_in_medium(
    scene: &Scene,
    point: &MediumPoint,
    path: &PathState,
    sampler: &mut Sampler,
    weight: impl FnOnce(&Illumination) -> f32,
) -> (Spectrum, f32) {
    let Some((lamp, illumination)) = scene.illuminate(point.position, None, sampler) else { return NOTHING };
    let passage = scene.passage(point.position, path.inside, &illumination, sampler);
    if passage.is_zero() {
        return NOTHING;
    }
    let value = point.albedo * point.value(illumination.to_light);
    let light = value * illumination.irradiance * passage * weight(&illumination);
    (light, scene.distance_of(point.position, lamp, &illumination))
}

/// The weight of a sample of density `own` that could also have come from a strategy of density `other`
/// [Veach & Guibas 1995, the power heuristic with β = 2].
pub fn mis_weight(own: f32, other: f32) -> f32 {
    // In ratios, so that densities in tiny or huge scenes do not overflow.
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}
