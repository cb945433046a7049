//! A point that a path has reached: its geometry and its scattering.

use glam::Vec3;

use crate::geometry::{Hit, Surface};
use crate::material::{Bsdf, Event, Lobes, Scattered};
use crate::math::Frame;
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// A point that a path has reached.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint<'s> {
    /// The geometry there.
    pub surface: Surface,
    /// Around the normal that shading uses, turned by the material's maps.
    pub frame: Frame,
    /// How rough maps make the surface as a whole: α² of facets that lean as much as the normal does here, 0 without maps.
    pub lean: f32,
    /// The scattering there.
    pub bsdf: &'s Bsdf<'s>,
    /// Back along the path, world coordinates, unit length.
    pub to_previous: Vec3,
    /// The same in the coordinates of `frame`.
    pub(super) local_previous: Vec3,
    /// What the ray met.
    pub hit: Hit,
    /// Along the segment that led here, scene units.
    pub distance: f32,
    /// The number of the shape.
    pub shape: u32,
    /// Across what the path sees there, in texture coordinates, where a texture of the shape asks for it; else 0.
    pub footprint: f32,
}

impl SurfacePoint<'_> {
    /// The share of the light back along the path that is not absorbed; see [`Bsdf::albedo`].
    pub fn albedo(&self) -> Spectrum {
        self.bsdf.albedo(self.local_previous)
    }

    /// The value of the smooth lobes in 1/sr for flux that comes from the previous point and leaves in the direction
    /// `to_next` (world).
    #[inline]
    pub fn eval(&self, to_next: Vec3) -> Spectrum {
        if !self.keeps_side(to_next) {
            return Spectrum::ZERO;
        }
        let value = self.bsdf.eval(self.local_previous, self.frame.to_local(to_next));
        value * self.unshadowed(self.to_previous)
    }

    /// The value of the smooth lobes in 1/sr for radiance that comes from the direction `to_light` (world) and leaves
    /// towards the previous point.
    #[inline]
    pub fn eval_radiance(&self, to_light: Vec3) -> Spectrum {
        if !self.keeps_side(to_light) {
            return Spectrum::ZERO;
        }
        let value = self.bsdf.eval(self.frame.to_local(to_light), self.local_previous);
        value * self.unshadowed(to_light)
    }

    /// The value of [`SurfacePoint::eval_radiance`] where it is the same for all directions on the side of the previous
    /// point, and zero on the other.
    #[inline]
    pub fn even(&self) -> Option<Spectrum> {
        if self.lean > 0.0 { None } else { self.bsdf.even(self.local_previous) }
    }

    /// Of [`SurfacePoint::eval_radiance`] the share of the broad part, lane by lane.
    pub fn broad_share(&self, to_light: Vec3) -> Spectrum {
        if self.bsdf.is_lambertian() {
            return Spectrum::ONE;
        }
        let to_light = self.frame.to_local(to_light);
        self.bsdf.broad(to_light, self.local_previous).divided(self.bsdf.eval(to_light, self.local_previous))
    }

    /// How much of the broad part leaves in a direction (world), up to a factor.
    pub fn outward(&self, direction: Vec3) -> f32 {
        self.bsdf.outward(self.frame.to_local(direction))
    }

    /// A direction (world) in which the path goes on by one of these lobes; see [`Bsdf::sample`].
    #[inline]
    pub fn sample(&self, follow: Lobes, sampler: &mut Sampler) -> Option<Scattered> {
        let scattered = self.bsdf.sample(self.local_previous, follow, sampler)?;
        if scattered.event == Event::Pass {
            return Some(Scattered { to_next: -self.to_previous, ..scattered });
        }
        let to_next = self.frame.to_world(scattered.to_next);
        self.keeps_side(to_next).then_some(Scattered { to_next, ..scattered })
    }

    /// Whether one of several events sends light in one direction, or in some around it, and there are no holes.
    #[inline]
    pub fn may_glimpse(&self) -> bool {
        const NARROW: Lobes = Lobes::DELTA.with(Event::Glossy);
        self.bsdf.lobes().meets(NARROW) && !self.bsdf.lobes().meets(Lobes::HOLES) && self.bsdf.has_choice()
    }

    /// See [`Bsdf::is_clear`].
    #[inline]
    pub fn is_clear(&self) -> bool {
        self.bsdf.is_clear()
    }

    /// Where delta events would lead (world), if there is anything to choose between them and others; see [`Bsdf::deltas`].
    pub fn deltas(&self) -> impl Iterator<Item = Scattered> {
        self.bsdf.deltas(self.local_previous).filter_map(|scattered| {
            let to_next = self.frame.to_world(scattered.to_next);
            self.keeps_side(to_next).then_some(Scattered { to_next, ..scattered })
        })
    }

    /// A direction (world) of the glossy event, if that is one of several; see [`Bsdf::sample_gloss`].
    pub fn sample_gloss(&self, u: Vec3) -> Option<Vec3> {
        let to_next = self.bsdf.sample_gloss(self.local_previous, u)?;
        Some(self.frame.to_world(to_next)).filter(|&to_next| self.keeps_side(to_next))
    }

    /// The density per solid angle with which [`SurfacePoint::sample_gloss`] draws `to_next` (world).
    pub fn gloss_pdf(&self, to_next: Vec3) -> f32 {
        if !self.keeps_side(to_next) {
            return 0.0;
        }
        self.bsdf.gloss_pdf(self.local_previous, self.frame.to_local(to_next))
    }

    /// What [`Scattered::weight`] would be, times the density, for a direction (world) that a smooth lobe leads to.
    pub(super) fn weight(&self, to_next: Vec3) -> Spectrum {
        if !self.keeps_side(to_next) {
            return Spectrum::ZERO;
        }
        let to_next = self.frame.to_local(to_next);
        self.bsdf.eval(self.local_previous, to_next) * to_next.z.abs()
    }

    /// The share of flux from the previous point that the smooth lobes send in the direction `to_next` (world), per solid
    /// angle: with the adjoint cosine, as with a shading normal it is the geometry that sends light off [Veach 1997, eq. 5.17].
    #[inline]
    pub fn sent(&self, to_next: Vec3) -> Spectrum {
        let cos = self.cos(to_next) * self.geometric_over_shading(to_next) / self.geometric_over_shading_back();
        self.eval(to_next) * cos
    }

    /// Whether a direction (world) lies on the same side of the normal that maps have turned as of the one before.
    #[inline]
    fn keeps_side(&self, direction: Vec3) -> bool {
        self.lean == 0.0 || self.surface.shading_normal.dot(direction) * self.frame.normal.dot(direction) > 0.0
    }

    /// Share of the light from a direction (world) that what maps only paint would not shadow if it were there
    /// [Estevez et al. 2019].
    #[inline]
    pub fn unshadowed(&self, to_light: Vec3) -> f32 {
        if self.lean == 0.0 {
            return 1.0;
        }
        let cos2 = self.surface.shading_normal.dot(to_light).powi(2).clamp(1e-8, 1.0);
        2.0 / (1.0 + (1.0 + self.lean * (1.0 - cos2) / cos2).sqrt())
    }

    /// Whether a direction (world) lies on the side of the shading normal on which the previous point does.
    #[inline]
    pub fn same_side(&self, to_next: Vec3) -> bool {
        self.frame.normal.dot(self.to_previous) * self.frame.normal.dot(to_next) > 0.0
    }

    /// How much slower light is on the side of a direction (world) to which smooth lobes lead, than on the side of the previous
    /// point.
    #[inline]
    pub fn slowness_toward(&self, direction: Vec3) -> f32 {
        self.bsdf.slowness(self.local_previous, self.frame.to_local(direction))
    }

    /// The density per solid angle with which the walk goes on in the direction `to_next` (world) by a smooth lobe.
    #[inline]
    pub fn pdf(&self, to_next: Vec3, follow: Lobes) -> f32 {
        if !self.keeps_side(to_next) {
            return 0.0;
        }
        self.bsdf.pdf(self.local_previous, self.frame.to_local(to_next), follow)
    }

    /// The density per solid angle with which a walk that came from `to_next` (world) would go on to the previous point.
    #[inline]
    pub fn pdf_back(&self, to_next: Vec3, follow: Lobes) -> f32 {
        if !self.keeps_side(to_next) {
            return 0.0;
        }
        self.bsdf.pdf(self.frame.to_local(to_next), self.local_previous, follow)
    }

    /// Whether the walk goes on with the density cos / π, from wherever it came and whichever way it goes.
    #[inline]
    pub fn is_lambertian(&self) -> bool {
        self.lean == 0.0 && self.bsdf.is_lambertian()
    }

    /// Cosine between a direction and the normal of the geometry, positive on both sides, never quite 0.
    #[inline]
    pub fn geometric_cos(&self, direction: Vec3) -> f32 {
        self.surface.normal.dot(direction).abs().max(1e-5)
    }

    /// Cosine between a direction and the shading normal, positive on both sides.
    #[inline]
    pub fn cos(&self, direction: Vec3) -> f32 {
        self.frame.normal.dot(direction).abs()
    }

    /// |cos to the geometric normal| / |cos to the shading normal|: 1 on surfaces without smooth or turned normals. Light
    /// falls on the geometry, whereas shading reckons with its own normal; whoever compares the two needs this ratio.
    #[inline]
    pub fn geometric_over_shading(&self, direction: Vec3) -> f32 {
        if self.surface.normal == self.frame.normal {
            return 1.0;
        }
        self.surface.normal.dot(direction).abs() / self.cos(direction).max(1e-4)
    }

    /// The same back along the path, as a divisor: never so small that what is divided has no limit.
    #[inline]
    pub fn geometric_over_shading_back(&self) -> f32 {
        self.geometric_over_shading(self.to_previous).max(1e-3)
    }
}
