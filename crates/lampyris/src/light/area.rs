//! A shape that emits.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::{Aim, Emission, Emit, Illumination, Section, Source, Span, Start, aim};
use crate::geometry::{Ray, Shape, Surface, Surfaces};
use crate::math::Frame;
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;
use crate::texture::{Lookup, Texture};

/// A shape with the same radiance in all directions on the side of its normal, or on both. The radiance can vary over
/// the shape by its texture coordinates.
#[derive(Clone, Debug)]
pub struct Area {
    /// The number of the shape.
    pub shape: u32,
    /// Radiance in W/(m² sr).
    pub radiance: Texture,
    /// Whether the back shines, too.
    pub two_sided: bool,
    power: Spectrum,
    /// See [`Span::center`].
    center: Option<(Vec3, f32)>,
}

impl Area {
    /// The shape of this number and geometry as a light.
    pub fn new(shape: u32, geometry: &Shape, radiance: Texture, two_sided: bool) -> Area {
        let mean = mean(&radiance, geometry);
        // About half the side of a square, or the radius of a ball.
        let center = geometry.bounds().map(|bounds| (bounds.center(), 0.6 * bounds.radius()));
        let mut area = Area { shape, radiance, two_sided, power: Spectrum::ZERO, center };
        area.power = mean * area.per_radiance(geometry.area());
        area
    }

    /// Radiance that leaves `surface` in this direction, seen across a footprint of this width in texture coordinates.
    #[inline]
    pub fn radiance(&self, surface: &Surface, direction: Vec3, footprint: f32) -> Spectrum {
        if !self.two_sided && direction.dot(surface.normal) <= 0.0 {
            return Spectrum::ZERO;
        }
        self.radiance.at(&Lookup { footprint, ..Lookup::point(surface.uv) })
    }

    /// Density of [`Emit::illuminate`] per solid angle at `at`, of a point on the light.
    pub fn pdf(&self, surfaces: &Surfaces, at: Vec3, surface: &Surface) -> f32 {
        surfaces.pdf_from(self.shape, at, surface).unwrap_or(0.0)
    }

    /// Density of [`Emit::emit`], per area across the ray and per solid angle, of all rays from all points.
    pub fn emission(&self, surfaces: &Surfaces) -> f32 {
        1.0 / self.per_radiance(surfaces.area(self.shape))
    }

    /// Flux in W, of both sides together.
    pub fn power(&self) -> Spectrum {
        self.power
    }

    /// Flux of a surface of this area and radiance 1, in W.
    fn per_radiance(&self, area: f32) -> f32 {
        let one_sided = PI * area;
        if self.two_sided { 2.0 * one_sided } else { one_sided }
    }

    /// Rays from a point of the shape, on the side of this normal.
    fn rays(&self, origin: Vec3, normal: Vec3) -> Section {
        let side = if self.two_sided { 0.5 } else { 1.0 };
        Section::Hemisphere { origin, axis: Frame::around(normal), side }
    }
}

impl Emit for Area {
    fn emit(&self, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Emission> {
        aim::evenly(self, surfaces, sampler)
    }

    fn illuminate(&self, surfaces: &Surfaces, at: Vec3, sampler: &mut Sampler) -> Option<Illumination> {
        let (surface, pdf) = surfaces.sample_from(self.shape, at, sampler.square())?;
        let to_light = (surface.position - at).normalize_or_zero();
        let radiance = self.radiance(&surface, -to_light, 0.0);
        if radiance.is_zero() {
            return None;
        }
        let target = Some(surface.offset(-to_light));
        let emission = self.emission(surfaces) / pdf;
        Some(Illumination {
            to_light,
            target,
            irradiance: radiance / pdf,
            pdf: Some(pdf),
            emission,
            normal: surface.normal,
        })
    }

    fn span(&self, _: &Ray, length: f32) -> Option<Span> {
        Some(Span::whole(length, self.center))
    }

    fn aim(&self) -> Option<&dyn Aim> {
        Some(self)
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.power
    }
}

impl Aim for Area {
    fn start(&self, surfaces: &Surfaces, sampler: &mut Sampler) -> Option<Start> {
        let surface = surfaces.sample(self.shape, sampler.square())?;
        let back = self.two_sided && sampler.uniform() < 0.5;
        let section = self.rays(surface.position, if back { -surface.normal } else { surface.normal });
        Some(Start { section, source: Source::Shape(self.shape, surface) })
    }

    fn send(&self, surfaces: &Surfaces, start: &Start, ray: Ray) -> Option<Emission> {
        let Source::Shape(_, surface) = start.source else { return None };
        let (radiance, density) = (self.radiance(&surface, ray.direction, 0.0), self.emission(surfaces));
        (!radiance.is_zero()).then(|| Emission {
            ray: surface.spawn(ray.direction),
            flux: radiance / density,
            source: start.source,
            density,
        })
    }

    fn section(&self, ray: &Ray, normal: Vec3) -> Section {
        self.rays(ray.origin, normal * normal.dot(ray.direction).signum())
    }
}

/// The mean of a texture over a shape by area: over an even grid, which has a point for every texel of a picture. It
/// decides how often a light is chosen, so that light is exact even where it is not.
fn mean(texture: &Texture, geometry: &Shape) -> Spectrum {
    const FEWEST: usize = 64;
    const MOST: usize = 2048;
    if let Texture::Constant(radiance) = texture {
        return *radiance;
    }
    let [columns, rows] = texture.texels().map(|side| side.clamp(FEWEST, MOST));
    let row = |y: usize| {
        let at = |x: usize| Vec2::new((x as f32 + 0.5) / columns as f32, (y as f32 + 0.5) / rows as f32);
        let surfaces = (0..columns).filter_map(|x| geometry.sample(at(x)));
        surfaces.fold(Spectrum::ZERO, |sum, surface| sum + texture.at(&Lookup::point(surface.uv))) / columns as f32
    };
    (0..rows).fold(Spectrum::ZERO, |sum, y| sum + row(y)) / rows as f32
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Affine2;

    use super::*;
    use crate::geometry::Quad;
    use crate::texture::{Bitmap, Channel, Curve, Pyramid, Raster, Texels, TextureFilter, Wrap};

    #[test]
    fn the_power_of_a_picture_is_its_mean_times_pi_times_area_on_each_side() {
        // Three texels of 0, 1 and 5, as wide as the lamp together.
        let picture = Raster::new(3, 1, 1, Texels::Floats(vec![0.0, 1.0, 5.0]), Curve::Linear).expect("texels");
        let bitmap = Bitmap {
            pyramid: Arc::new(Pyramid::new(Arc::new(picture), false, [0.0, f32::MAX])),
            channel: Channel::Color,
            filter: TextureFilter::Nearest,
            wrap: [Wrap::Repeat; 2],
            to_uv: Affine2::IDENTITY,
        };
        let quad = Shape::Quad(Quad::new(Vec3::ZERO, 3.0 * Vec3::X, Vec3::Y));
        for (two_sided, sides) in [(false, 1.0), (true, 2.0)] {
            let area = Area::new(0, &quad, Texture::Bitmap(bitmap.clone()), two_sided);
            let expected = sides * 2.0 * PI * 3.0;
            assert!((area.power.mean() / expected - 1.0).abs() < 0.02, "{}", area.power.mean());
        }
    }
}
