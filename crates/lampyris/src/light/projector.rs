//! A point that throws a picture.

use glam::{Vec2, Vec3};

use super::{Emission, Emit, Illumination, Source, Span, point};
use crate::geometry::{Ray, Surfaces};
use crate::math::Grid;
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;
use crate::texture::{Lookup, Texture};

/// A point that throws a texture: on a plane at right angles to its axis at distance 1, the texture times a scale is the
/// irradiance in W/m² (scene units for metres).
#[derive(Clone, Debug)]
pub struct Projector {
    position: Vec3,
    /// Unit vectors to the right and up in the thrown picture, and along the axis.
    axes: [Vec3; 3],
    /// Half the width and height of the picture at distance 1.
    half: Vec2,
    texture: Texture,
    scale: Spectrum,
    /// Where the light goes: over the picture.
    grid: Grid,
    power: Spectrum,
}

/// Cells a side of the grid by which photons choose their direction. The texture is asked at every photon, so that finer
/// detail is not lost, only chosen less well.
const CELLS: usize = 256;
/// Share of the photons that is spread evenly, lest detail between the middles of cells be missed.
const EVEN: f64 = 0.05;

impl Projector {
    /// A projector at `position`. `axes` are unit vectors to the right, up and along the axis; `half` is half the width
    /// and height of the picture at distance 1. The texture's (0, 0) is the bottom left corner.
    pub fn new(position: Vec3, axes: [Vec3; 3], half: Vec2, texture: Texture, scale: Spectrum) -> Projector {
        let middle = |cell: usize| (cell as f32 + 0.5) / CELLS as f32;
        let value = |column, row| texture.at(&Lookup::point(Vec2::new(middle(column), middle(row))));
        let cells = (CELLS * CELLS) as f32;
        let mean = (0..CELLS * CELLS).fold(Spectrum::ZERO, |sum, cell| sum + value(cell % CELLS, cell / CELLS)) / cells;
        let floor = EVEN * f64::from(mean.mean());
        let grid = Grid::new(CELLS, CELLS, |column, row| floor + f64::from(value(column, row).mean()));
        let power = mean * scale * (4.0 * half.x * half.y);
        Projector { position, axes, half, texture, scale, grid, power }
    }

    /// The irradiance at distance 1 behind a point of the texture.
    fn irradiance(&self, uv: Vec2) -> Spectrum {
        self.texture.at(&Lookup::point(uv)) * self.scale
    }

    /// Density of a direction per solid angle, from that of its point in the unit square, under this cosine to the axis.
    fn pdf(&self, in_square: f32, cos: f32) -> f32 {
        // A solid angle dω covers dω / cos³ of the plane at distance 1.
        in_square / (4.0 * self.half.x * self.half.y * cos * cos * cos)
    }

    /// Radiant intensity in W/sr, and the density per solid angle with which photons leave.
    fn intensity(&self, direction: Vec3) -> (Spectrum, f32) {
        let [right, up, forward] = self.axes;
        let cos = direction.dot(forward);
        if cos <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let across = Vec2::new(direction.dot(right), direction.dot(up)) / (cos * self.half);
        if across.abs().max_element() > 1.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let uv = 0.5 + 0.5 * across;
        (self.irradiance(uv) / (cos * cos * cos), self.pdf(self.grid.pdf(uv), cos))
    }
}

impl Emit for Projector {
    fn emit(&self, _: &Surfaces, sampler: &mut Sampler) -> Option<Emission> {
        let (uv, pdf) = self.grid.sample(sampler.square());
        let across = (2.0 * uv - Vec2::ONE) * self.half;
        let [right, up, forward] = self.axes;
        let ray = Ray { origin: self.position, direction: (right * across.x + up * across.y + forward).normalize() };
        let density = self.pdf(pdf, 1.0 / (1.0 + across.length_squared()).sqrt());
        let flux = self.irradiance(uv) * (4.0 * self.half.x * self.half.y / pdf);
        (!flux.is_zero()).then_some(Emission { ray, flux, source: Source::Point, density })
    }

    fn illuminate(&self, _: &Surfaces, at: Vec3, _: &mut Sampler) -> Option<Illumination> {
        point::from_point(self.position, at, |direction| self.intensity(direction))
            .filter(|illumination| !illumination.irradiance.is_zero())
    }

    fn span(&self, ray: &Ray, length: f32) -> Option<Span> {
        let [.., forward] = self.axes;
        let whole = Span::whole(length, Some((self.position, 0.0)));
        whole.in_cone(ray, self.position, forward, self.half.length().atan())
    }

    fn power(&self, _: &Surfaces) -> Spectrum {
        self.power
    }
}
