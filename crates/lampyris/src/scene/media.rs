//! The media of a scene: which one is where, and how much light comes through.

use std::sync::Arc;

use glam::Vec3;

use super::{Scene, ShapeRecord, SurfacePoint};
use crate::geometry::Ray;
use crate::light::Illumination;
use crate::medium::{Inside, Interior, Matter, Medium, MediumId};
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// What is between the surfaces of a scene.
#[derive(Debug)]
pub struct Media {
    all: Vec<Medium>,
    /// The medium around everything.
    around: Option<MediumId>,
    /// Whether any shape says what is inside of it.
    bounded: bool,
    /// What the camera is in.
    eye: Inside,
}

impl Media {
    /// None if no light of the scene can be in any of them.
    pub(super) fn new(all: Vec<Medium>, around: Option<MediumId>, shapes: &[ShapeRecord]) -> Option<Media> {
        let bounded = shapes.iter().any(|shape| shape.interior.is_some_and(|interior| interior.medium.is_some()));
        (bounded || around.is_some()).then_some(Media { all, around, bounded, eye: Inside::NOTHING })
    }
}

/// A direction that no one builds along: where a point is told by what a ray in it leaves.
const OUT: Vec3 = Vec3::new(0.407_24, 0.823_98, 0.394_01);

/// After so many surfaces a ray has left all shapes that it was in.
const MOST_SURFACES: usize = 1 << 14;

impl Scene {
    pub(super) fn set_media(&mut self, media: Option<Media>) {
        self.media = media.map(Arc::new);
        let eye = self.inside_at(self.camera.origin());
        if let Some(media) = self.media.as_mut().and_then(Arc::get_mut) {
            media.eye = eye;
        }
    }

    /// Whether there is anything between the surfaces.
    #[inline]
    pub fn has_media(&self) -> bool {
        self.media.is_some()
    }

    /// The media, by their numbers.
    pub fn media(&self) -> &[Medium] {
        self.media.as_ref().map_or(&[], |media| &media.all)
    }

    /// What fills the space of a path, which goes on to a surface or another point, or (not `bounded`) to infinity: there is
    /// no closed shape there, whatever rounding may have told at an edge.
    #[inline]
    pub fn matter(&self, inside: &Inside, bounded: bool) -> Option<Matter<'_>> {
        let media = self.media.as_ref()?;
        let id = match inside.top() {
            Some(interior) if bounded => interior.medium?,
            _ => media.around?,
        };
        Some(media.all[usize::from(id)].matter(id, &self.basis))
    }

    /// The shapes with media that a point of free space lies in: those that a ray to infinity leaves without having entered
    /// them.
    pub fn inside_at(&self, point: Vec3) -> Inside {
        let mut inside = Inside::NOTHING;
        if !self.media.as_ref().is_some_and(|media| media.bounded) {
            return inside;
        }
        let mut ray = Ray { origin: point, direction: OUT };
        let (mut entered, mut left): (Vec<Interior>, Vec<Interior>) = (Vec::new(), Vec::new());
        for _ in 0..MOST_SURFACES {
            let Some(hit) = self.surfaces.closest(&ray, f32::INFINITY) else { break };
            let surface = self.surfaces.surface(&ray, &hit);
            if let Some(interior) = self.shapes[hit.shape as usize].interior {
                if surface.normal.dot(ray.direction) < 0.0 {
                    entered.push(interior);
                } else if let Some(at) = entered.iter().rposition(|other| *other == interior) {
                    entered.remove(at);
                } else {
                    left.push(interior);
                }
            }
            ray.origin = surface.offset(ray.direction);
        }
        // What is left last lies outermost.
        left.iter().rev().for_each(|&interior| inside.cross(interior, true));
        inside
    }

    /// What a ray of [`Scene::view`] starts in.
    pub fn inside_of_view(&self, ray: &Ray) -> Inside {
        match (&self.media, self.meter) {
            (None, _) => Inside::NOTHING,
            (Some(media), None) => media.eye,
            (Some(_), Some(_)) => self.inside_at(ray.origin),
        }
    }

    /// What is on the other side of a surface, for a path or a shadow ray that leaves `point` in the direction `to_next`
    /// (world).
    #[inline]
    pub fn cross(&self, point: &SurfacePoint, to_next: Vec3, inside: &mut Inside) {
        let normal = point.surface.normal;
        if let Some(interior) = self.shapes[point.shape as usize].interior
            && normal.dot(to_next) * normal.dot(point.to_previous) < 0.0
        {
            inside.cross(interior, normal.dot(to_next) < 0.0);
        }
    }

    /// Share of the light from `illumination` that surfaces, their holes and all media on the way leave to a point of free
    /// space, which lies `inside` of these.
    pub fn passage(
        &self,
        mut from: Vec3,
        mut inside: Inside,
        illumination: &Illumination,
        sampler: &mut Sampler,
    ) -> Spectrum {
        let mut share = Spectrum::ONE;
        loop {
            let (ray, distance) = illumination.rest(from);
            let hit = self.surfaces.closest(&ray, distance);
            if hit.is_some() && !self.materials.have_holes() {
                return Spectrum::ZERO;
            }
            let reached = hit.map_or(distance, |hit| hit.distance);
            if let Some(matter) = self.matter(&inside, reached < f32::INFINITY) {
                share = share * matter.transmittance(&ray, reached, sampler);
            }
            let Some(hit) = hit else { return share };
            let (surface, holes) = self.holes(&ray, &hit);
            share *= holes;
            if share.is_zero() {
                return share;
            }
            if let Some(interior) = self.shapes[hit.shape as usize].interior {
                inside.cross(interior, surface.normal.dot(ray.direction) < 0.0);
            }
            from = surface.offset(ray.direction);
        }
    }

    /// The same to a point on a surface that a path has reached, which was `inside` of these on its way there.
    pub fn passage_to(
        &self,
        point: &SurfacePoint,
        inside: &Inside,
        illumination: &Illumination,
        sampler: &mut Sampler,
    ) -> Spectrum {
        let mut inside = *inside;
        self.cross(point, illumination.to_light, &mut inside);
        self.passage(point.surface.offset(illumination.to_light), inside, illumination, sampler)
    }
}
