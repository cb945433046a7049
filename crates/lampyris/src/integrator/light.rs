//! Light tracing: walks from the lamps, each vertex connected to the camera (theory §4.5).
//!
//! It cannot see what the camera sees through glass or in mirrors; lamps and the background in plain sight are added by
//! rays from the camera.

use glam::Vec2;

use super::blocks::{camera_pass, light_pass};
use super::{Integrator, Observer, Pass, Phase};
use crate::image::Image;
use crate::material::Lobes;
use crate::sampler::Sampler;
use crate::scene::description::{FilmDescription, LightSettings};
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transport::{PathState, Visitor};

/// See the module.
#[derive(Clone, Debug)]
pub struct LightTracing {
    /// How many paths, how long.
    pub settings: LightSettings,
}

impl Integrator for LightTracing {
    fn pass(&self, scene: &Scene, film: &FilmDescription, pass: &Pass, observer: &dyn Observer) -> Image {
        let [width, height] = film.size;
        let paths = self.settings.photons.map_or(u64::from(width) * u64::from(height), u64::from);
        let max_bounces = self.settings.max_bounces;
        observer.phase(Phase::Photons);
        let new = || Splat { scene, film, splats: Vec::new(), max_bounces };
        let blocks = light_pass(scene, pass, paths, max_bounces, observer, new);
        observer.phase(Phase::Camera);
        let mut image = camera_pass(scene, film, pass, 1, observer, || (), |ray, _, ()| (scene.plain_sight(ray), 1));
        let scale = 1.0 / paths as f32;
        for (pixel, light) in blocks.into_iter().flat_map(|block| block.splats) {
            let sum = &mut image.pixels_mut()[pixel as usize];
            *sum = (Spectrum::from_rgb(*sum) + light * scale).to_rgb();
        }
        image
    }

    fn name(&self) -> &'static str {
        "light"
    }
}

/// Connects every vertex to the camera.
struct Splat<'a> {
    scene: &'a Scene,
    film: &'a FilmDescription,
    /// Pixel numbers and what arrives there, as if the path were the only one.
    splats: Vec<(u32, Spectrum)>,
    max_bounces: u32,
}

impl Visitor for Splat<'_> {
    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, sampler: &mut Sampler) -> Lobes {
        if path.bounce < self.max_bounces && point.bsdf.lobes().meets(Lobes::SMOOTH) {
            let (lens, offset) = (sampler.square(), sampler.square());
            let splat = self.connect(point, path, lens, offset);
            self.splats.extend(splat);
        }
        Lobes::ALL
    }
}

impl Splat<'_> {
    fn connect(&self, point: &SurfacePoint, path: &PathState, lens: Vec2, offset: Vec2) -> Option<(u32, Spectrum)> {
        let seen = self.scene.camera().see(point.surface.position, lens)?;
        let pixel = self.film.pixel_number(seen.pixel + self.film.filter.sample(offset))?;
        let to_camera = (seen.lens - point.surface.position).normalize();
        // The adjoint cosine: with a shading normal, it is the geometry that sends the light off.
        let cos = point.cos(to_camera) * point.geometric_over_shading(to_camera)
            / point.geometric_over_shading(point.to_previous).max(1e-3);
        let value = point.eval(to_camera) * (cos * seen.importance);
        let visibility = if value.is_zero() { 0.0 } else { self.scene.visibility_of(&point.surface, seen.lens) };
        (visibility > 0.0).then(|| (pixel, path.throughput * value * visibility))
    }
}
