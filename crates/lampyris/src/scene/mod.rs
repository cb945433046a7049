//! Scenes: what a file says ([`SceneDescription`]) and what is rendered ([`Scene`]).

mod assets;
mod build;
pub mod description;
mod fingerprint;
mod lights;
mod media;
pub(crate) mod notation;
mod point;
pub mod schema;
pub mod settings;
mod spot;
mod targets;

use std::borrow::Cow;
use std::f32::consts::PI;
use std::sync::Arc;

use glam::{Vec2, Vec3};

pub use assets::{Assets, NoAssets};
pub use build::{Built, build, build_observed};
pub use description::SceneDescription;
pub use fingerprint::{Fingerprint, NotedAssets};
pub use lights::Lamp;
use lights::Lights;
pub use media::Media;
pub use point::SurfacePoint;
use spot::Spot;
use targets::Targets;

use crate::camera::{Camera, Seen};
use crate::geometry::{Bounds, Cone, Hit, Ray, Surface, Surfaces};
use crate::image::displayable;
use crate::light::{Guide, Illumination, Light, LightId, Outlook, World};
use crate::material::{Bsdf, MaterialId, Materials, Slopes};
use crate::math::{Frame, warp};
use crate::medium::Interior;
use crate::sampler::{self, Sampler};
use crate::spectrum::{Basis, Spectrum};
use crate::texture::{Asks, Lookup};

/// A scene ready for light: immutable, everything checked and linked by number. Copies share all that is large.
#[derive(Clone, Debug)]
pub struct Scene {
    surfaces: Arc<Surfaces>,
    shapes: Arc<[ShapeRecord]>,
    materials: Arc<Materials>,
    lights: Arc<Lights>,
    camera: Camera,
    /// The shape whose irradiance is measured in place of a picture.
    meter: Option<u32>,
    /// Before which light from infinitely far away starts.
    world: World,
    /// Whether its passes have wavelengths.
    spectral: bool,
    /// What the lanes of all light in it are.
    basis: Basis,
    /// What is between surfaces, if there is anything.
    media: Option<Arc<Media>>,
    /// Where photons leave for.
    guide: Option<Arc<Guide>>,
    /// What shadow rays are shot at.
    outlook: Option<Arc<Outlook>>,
    /// What a laser lights.
    spot: Option<Spot>,
    /// What paths that leave a relay wall are aimed at.
    targets: Option<Arc<Targets>>,
}

/// What a shape is besides its geometry.
#[derive(Clone, Debug)]
pub struct ShapeRecord {
    /// Its material.
    pub material: MaterialId,
    /// The light that it is.
    pub light: Option<LightId>,
    /// What is inside of it, if it says so.
    pub interior: Option<Interior>,
    /// What the textures of its material and of its light ask for.
    pub asks: Asks,
    /// Its name, for people.
    pub name: Option<String>,
}

impl Scene {
    /// The scene as a pass of a render with this seed sees it: where passes have wavelengths, with those of the pass, which
    /// all its paths share, else as it is. What comes before all passes, such as a pilot, sees the scene without wavelengths.
    pub fn of_pass(&self, seed: u64, pass: u32) -> Cow<'_, Scene> {
        if !self.spectral {
            return Cow::Borrowed(self);
        }
        let basis = Basis::wavelengths_at(sampler::of_pass(seed, pass));
        Cow::Owned(Scene { basis, ..self.clone() })
    }

    /// Whether its passes have wavelengths.
    pub fn is_spectral(&self) -> bool {
        self.spectral
    }

    /// What the lanes of all light in it mean.
    #[inline]
    pub fn basis(&self) -> &Basis {
        &self.basis
    }

    /// The first surface along the ray, as it is at that very point. Its scattering function is made in `bsdf`, as in
    /// [`Scene::closest_in_cone`].
    #[inline]
    pub fn closest<'s, 'b>(&'s self, ray: &Ray, bsdf: &'b mut Bsdf<'s>) -> Option<SurfacePoint<'b>> {
        self.closest_in_cone(ray, Cone::THIN, bsdf)
    }

    /// The first surface along the ray, its textures as the whole cone sees them. Its scattering function is made in
    /// `bsdf`, whatever was there before: it is large, and a walk makes them one after the other in the same place.
    #[inline]
    pub fn closest_in_cone<'s, 'b>(
        &'s self,
        ray: &Ray,
        cone: Cone,
        bsdf: &'b mut Bsdf<'s>,
    ) -> Option<SurfacePoint<'b>> {
        self.closest_carrying(ray, cone, &Spectrum::ONE, bsdf)
    }

    /// [`Scene::closest_in_cone`], for a path that carries so much in each lane, up to a factor: a boundary that separates
    /// wavelengths follows them as often as they are carried.
    #[inline]
    pub fn closest_carrying<'s, 'b>(
        &'s self,
        ray: &Ray,
        cone: Cone,
        carried: &Spectrum,
        bsdf: &'b mut Bsdf<'s>,
    ) -> Option<SurfacePoint<'b>> {
        let hit = self.surfaces.closest(ray, f32::INFINITY)?;
        Some(self.point(ray, &hit, cone, carried, bsdf))
    }

    /// The point that a ray has met, as in [`Scene::closest_carrying`].
    #[inline]
    pub fn point<'s, 'b>(
        &'s self,
        ray: &Ray,
        hit: &Hit,
        cone: Cone,
        carried: &Spectrum,
        bsdf: &'b mut Bsdf<'s>,
    ) -> SurfacePoint<'b> {
        let surface = self.surfaces.surface(ray, hit);
        let to_previous = -ray.direction;
        let front = surface.shading_normal.dot(to_previous) > 0.0;
        let record = &self.shapes[hit.shape as usize];
        let lookup = match record.asks.is_none() {
            true => Lookup { basis: &self.basis, carried, ..Lookup::point(surface.uv) },
            false => Lookup { carried, ..self.lookup(record.asks, hit, &surface, ray, cone) },
        };
        self.materials.make_bsdf(record.material, &lookup, front, bsdf);
        let (hit, distance, shape, footprint) = (*hit, hit.distance, hit.shape, lookup.footprint);
        let (frame, lean) = if self.materials.has_tangents(record.material) {
            self.turned_frame(record.material, &lookup, ray, &hit, &surface)
        } else {
            (Frame::around(surface.shading_normal), 0.0)
        };
        let local_previous = frame.to_local(to_previous);
        SurfacePoint { surface, frame, lean, bsdf, to_previous, local_previous, hit, distance, shape, footprint }
    }

    /// What textures that ask for more than a point are asked with. The footprint is the longer axis of the cone's
    /// ellipse on the surface [Akenine-Möller et al. 2021], cut where the surface is seen edge-on, in texture coordinates
    /// by the mean of their density over all directions.
    fn lookup(&self, asks: Asks, hit: &Hit, surface: &Surface, ray: &Ray, cone: Cone) -> Lookup<'_> {
        const LEAST_COS: f32 = 0.125;
        let mut lookup = Lookup { basis: &self.basis, ..Lookup::point(surface.uv) };
        if asks.footprint {
            let (along_u, along_v) = self.surfaces.partials(hit, surface);
            let cos = surface.normal.dot(ray.direction).abs().max(LEAST_COS);
            let width = cone.after(hit.distance).width;
            lookup.footprint = width / (along_u.cross(along_v).length().sqrt() * cos);
        }
        if asks.vertex_color
            && let Some(color) = self.surfaces.vertex_color(hit)
        {
            lookup.vertex_color = Spectrum::from_rgb(color.map(displayable));
        }
        lookup
    }

    /// The frame that the material's maps make of the one along the tangents, with [`SurfacePoint::lean`].
    fn turned_frame(
        &self,
        material: MaterialId,
        lookup: &Lookup,
        ray: &Ray,
        hit: &Hit,
        surface: &Surface,
    ) -> (Frame, f32) {
        let (along_u, along_v) = self.surfaces.partials(hit, surface);
        let frame = Frame::along(surface.shading_normal, along_u);
        let slopes = Slopes { along_u: frame.to_local(along_u), along_v: frame.to_local(along_v) };
        let view = frame.to_local(-ray.direction);
        let normal = self.materials.normal(material, lookup, view.z > 0.0, view, &slopes);
        if normal == Vec3::Z {
            return (frame, 0.0);
        }
        let tan2 = (1.0 - normal.z * normal.z) / (normal.z * normal.z).max(1e-8);
        // Not zero, by which turned frames are known.
        let lean = (0.125 * tan2).clamp(f32::MIN_POSITIVE, 1.0);
        (Frame::along(frame.to_world(normal).normalize(), frame.tangent()), lean)
    }

    /// How far the light of a lamp comes to `at`, in scene units: from where its shadow ray ends, or from infinitely far
    /// away, and what it had come before.
    #[inline]
    pub fn distance_of(&self, at: Vec3, light: LightId, illumination: &Illumination) -> f32 {
        let far = || self.distance_from_far(at, illumination.to_light);
        illumination.target.map_or_else(far, |target| target.distance(at)) + self.traveled(light)
    }

    /// How far light from infinitely far away comes to `at`, in scene units, since it began in front of all that is finite,
    /// where its photons do; negative for what lies in front of that.
    #[inline]
    pub fn distance_from_far(&self, at: Vec3, to_light: Vec3) -> f32 {
        self.world.radius - (at - self.world.center).dot(to_light)
    }

    /// Share of the light from `illumination` that what stands between leaves to `from`: 1, 0, or what holes let through.
    #[inline]
    pub fn visibility(&self, from: &Surface, illumination: &Illumination) -> f32 {
        let origin = from.offset(illumination.to_light);
        let is_blocked = match illumination.target {
            Some(target) => self.surfaces.occluded(origin, target),
            None => {
                let ray = Ray { origin, direction: illumination.to_light };
                self.surfaces.blocked(&ray, f32::INFINITY)
            }
        };
        if is_blocked { self.through_holes(origin, illumination) } else { 1.0 }
    }

    /// Share of light that comes through holes, where it is known that something stands in its way.
    fn through_holes(&self, mut from: Vec3, illumination: &Illumination) -> f32 {
        let mut share = 1.0;
        while self.materials.have_holes() && share > 0.0 {
            let (ray, distance) = illumination.rest(from);
            let Some(hit) = self.surfaces.closest(&ray, distance) else { return share };
            let (surface, holes) = self.holes(&ray, &hit);
            share *= holes;
            from = surface.offset(ray.direction);
        }
        0.0
    }

    /// The point that a shadow ray meets, and the share of its light that goes straight through there.
    fn holes(&self, ray: &Ray, hit: &Hit) -> (Surface, f32) {
        let surface = self.surfaces.surface(ray, hit);
        let front = surface.shading_normal.dot(ray.direction) < 0.0;
        let record = &self.shapes[hit.shape as usize];
        let lookup = self.lookup(record.asks, hit, &surface, ray, Cone::THIN);
        (surface, self.materials.bsdf(record.material, &lookup, front).holes())
    }

    /// A ray whose radiance, times the number that comes with it, is a sample of the picture at `pixel`: through the
    /// camera, or towards the shape whose irradiance is measured, uniform by area and weighted by the cosine.
    pub fn view(&self, pixel: Vec2, sampler: &mut Sampler) -> (Ray, f32) {
        let on_lens = sampler.square();
        match self.meter.and_then(|shape| self.surfaces.sample(shape, on_lens)) {
            Some(surface) => {
                let direction = Frame::around(surface.normal).to_world(warp::cosine_hemisphere(sampler.square()));
                (surface.spawn(direction), PI)
            }
            None => {
                if self.has_media() {
                    // For how far the first flight goes.
                    sampler.step(1);
                }
                (self.camera.ray(pixel, on_lens), 1.0)
            }
        }
    }

    /// What the rays of [`Scene::view`] stand for.
    pub fn cone(&self) -> Cone {
        if self.meter.is_some() { Cone::WIDE } else { self.camera.cone() }
    }

    /// The camera as light sees it that leaves `at` for a point of the lens; none if it cannot be seen from there, and
    /// never where irradiance is measured.
    pub fn seen_by_camera(&self, at: Vec3, lens: Vec2) -> Option<Seen> {
        if self.meter.is_some() { None } else { self.camera.see(at, lens) }
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The lights.
    pub fn lights(&self) -> &[Light] {
        &self.lights.all
    }

    /// The shapes, beside their geometry in [`Scene::surfaces`].
    pub fn shapes(&self) -> &[ShapeRecord] {
        &self.shapes
    }

    /// The geometry.
    pub fn surfaces(&self) -> &Surfaces {
        &self.surfaces
    }

    /// The materials.
    pub fn materials(&self) -> &Materials {
        &self.materials
    }

    /// The box around all finite shapes.
    pub fn bounds(&self) -> Bounds {
        self.surfaces.bounds()
    }
}
