//! Where light goes from eye to lamp: along walks from the camera and from the lamps.

use glam::Vec3;

use super::chain::{Chain, Lamp, Vertex, last_shot, shots};
use crate::light::{Light, Source};
use crate::material::{Bsdf, Event, Lobes, Scattered};
use crate::sampler::Sampler;
use crate::scene::{Scene, SurfacePoint};
use crate::transport::{Limits, Origin, PathState, Visitor, walk};

/// Notes the points of a walk.
#[derive(Default)]
pub(super) struct Recorder(pub(super) Vec<Vertex>);

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

/// The most points between eye and lamp.
const MOST: usize = 6;

/// The longest walk, without roulette.
pub(super) const LIMITS: Limits = Limits { max_bounces: MOST as u32 - 1, roulette_from: u32::MAX };

/// Paths whose last point before the lamp scatters smoothly: along a walk from the camera, as far as each of its points, and
/// on to a lamp as a shadow ray chooses it.
pub(super) fn lit_directly(scene: &Scene, eye: Vec3, walked: &[Vertex], sampler: &Sampler) -> Vec<Chain> {
    let chain = |number: usize| {
        let between = extended(walked, number)?;
        let (last, before) = between.split_last()?;
        let (from, is_first) = (&last.surface, before.iter().all(|vertex| !Lobes::SMOOTH.contains(vertex.event)));
        let mut shot = last_shot(sampler, shots(scene, is_first));
        let (light, choice) = scene.illuminate(from.position, scene.vista(from), &mut shot)?;
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
pub(super) fn lit_by_glass(scene: &Scene, eye: Vec3, walked: &[Vertex], sampler: &mut Sampler) -> Vec<Chain> {
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
