//! A picture of the light from infinitely far away.

use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use glam::{Mat3, Vec2, Vec3};
use rayon::prelude::*;

use super::{Far, World};
use crate::image::Image;
use crate::math::Grid;
use crate::spectrum::Spectrum;

/// How a picture covers all directions. Points of the picture are in 0..1, (0, 0) at its top left corner; directions in
/// the picture's own axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mapping {
    /// Longitude across, from -z over +x, +z (in the middle) and -x; latitude down from +y. The first and the last row
    /// of pixels lie on the poles, as in Mitsuba 3.
    LatLong,
    /// A square of equal areas, +z in its middle and -z in its corners [Clarberg 2008].
    EqualArea,
}

/// Radiance from infinitely far away in all directions, from a picture, linear between its pixels.
#[derive(Clone, Debug)]
pub struct Environment {
    image: Arc<Image>,
    scale: Spectrum,
    mapping: Mapping,
    /// From the picture's own axes to the world's: a rotation, perhaps with a mirror.
    to_world: Mat3,
    /// Where light comes from: over the picture.
    grid: Grid,
    /// The integral of radiance over all directions, W/m².
    integral: Spectrum,
    world: World,
}

impl Environment {
    /// The light of `image` (at least one pixel, no negative values), multiplied by `scale`, turned by `to_world`
    /// (orthonormal).
    pub fn new(image: Arc<Image>, scale: Spectrum, mapping: Mapping, to_world: Mat3, world: World) -> Environment {
        let mut environment = Environment {
            grid: Grid::new(1, 1, |_, _| 1.0),
            image,
            scale,
            mapping,
            to_world,
            integral: Spectrum::ZERO,
            world,
        };
        let (width, height) = environment.cells();
        let mut rows = environment.light_of_cells(width, height, 1);
        environment.integral = rows
            .iter()
            .map(|row| row.iter().fold(Spectrum::ZERO, |sum, &light| sum + light) / (width * height) as f32)
            .fold(Spectrum::ZERO, |sum, row| sum + row);
        let coarser = coarser(&rows);
        let (width, height) = (width.div_ceil(coarser), height.div_ceil(coarser));
        if coarser > 1 {
            rows = environment.light_of_cells(width, height, coarser);
        }
        environment.grid = Grid::new(width, height, |column, row| f64::from(rows[row][column].mean()));
        environment
    }

    /// The mean of radiance × solid angle over each of so many cells, by row, where a cell is at most `across` times as
    /// wide and high as those between the pixels: by as many points as see every pixel that takes part in it.
    fn light_of_cells(&self, width: usize, height: usize, across: usize) -> Vec<Vec<Spectrum>> {
        let points = 2 * across;
        let light = |column: usize, row: usize| {
            let mut sum = Spectrum::ZERO;
            for (x, y) in (0..points * points).map(|point| (point % points, point / points)) {
                let part = |cell: usize, part: usize, cells: usize| {
                    (cell as f32 + (part as f32 + 0.5) / points as f32) / cells as f32
                };
                let at = Vec2::new(part(column, x, width), part(row, y, height));
                sum += self.at(at) * self.mapping.solid_angle(at);
            }
            sum / (points * points) as f32
        };
        (0..height).into_par_iter().map(|row| (0..width).map(|column| light(column, row)).collect()).collect()
    }

    /// Whether no direction shines.
    pub fn is_black(&self) -> bool {
        self.integral.is_zero()
    }

    /// The size of the grid of cells between the pixels' middles, over which radiance is bilinear.
    fn cells(&self) -> (usize, usize) {
        match self.mapping {
            Mapping::LatLong => (self.image.width(), self.image.height().saturating_sub(1).max(1)),
            Mapping::EqualArea => (self.image.width(), self.image.height()),
        }
    }

    /// The radiance at a point of the picture.
    fn at(&self, point: Vec2) -> Spectrum {
        let [width, height] = [self.image.width(), self.image.height()].map(|side| side as f32);
        let pixel = match self.mapping {
            Mapping::LatLong => Vec2::new(point.x * width - 0.5, point.y * (height - 1.0)),
            Mapping::EqualArea => point * Vec2::new(width, height) - 0.5,
        };
        let corner = pixel.floor();
        let t = pixel - corner;
        let (x, y) = (corner.x as i64, corner.y as i64);
        let row = |y| self.pixel(x, y) * (1.0 - t.x) + self.pixel(x + 1, y) * t.x;
        (row(y) * (1.0 - t.y) + row(y + 1) * t.y) * self.scale
    }

    /// A pixel, wherever its coordinates lead over the border of the picture.
    fn pixel(&self, x: i64, y: i64) -> Spectrum {
        let (width, height) = (self.image.width() as i64, self.image.height() as i64);
        let (x, y) = match self.mapping {
            // At most once around; a division would take longer.
            Mapping::LatLong if x < 0 => (x + width, y.clamp(0, height - 1)),
            Mapping::LatLong if x >= width => (x - width, y.clamp(0, height - 1)),
            Mapping::LatLong => (x, y.clamp(0, height - 1)),
            Mapping::EqualArea => {
                // Over an edge lies the same edge, read backwards.
                let (x, y) = if x < 0 || x >= width { (x.clamp(0, width - 1), height - 1 - y) } else { (x, y) };
                if y < 0 || y >= height { (width - 1 - x, y.clamp(0, height - 1)) } else { (x, y) }
            }
        };
        Spectrum::from_rgb(self.image.pixel(x as usize, y as usize))
    }

    fn point(&self, toward: Vec3) -> Vec2 {
        self.mapping.point(self.to_world.transpose() * toward)
    }
}

/// By how much the cells that directions are drawn from may be wider than those between the pixels, 1 to 8: a small table
/// stays near the processor, and where the sky is smooth nothing is lost. The second moment of radiance over density may
/// grow by a tenth; below a sun of a few pixels it would grow many times.
fn coarser(rows: &[Vec<Spectrum>]) -> usize {
    const GROWTH: f64 = 1.1;
    let total: f64 = rows.iter().flatten().map(|light| f64::from(light.mean())).sum();
    let second_moment = |across: usize| -> f64 {
        let band = |band: &[Vec<Spectrum>]| -> f64 {
            let width = band[0].len();
            let group = |first: usize| {
                let inside = band.iter().flat_map(|row| &row[first..(first + across).min(width)]);
                let (count, sum, squares) = inside.fold((0.0, 0.0, 0.0), |(count, sum, squares), light| {
                    let light = f64::from(light.mean());
                    (count + 1.0, sum + light, squares + light * light)
                });
                if sum > 0.0 { count * squares / sum } else { 0.0 }
            };
            (0..width).step_by(across).map(group).sum()
        };
        rows.chunks(across).map(band).sum()
    };
    // From the finest on: each step needs about the variance of the one before.
    [2, 4, 8].into_iter().take_while(|&across| second_moment(across) <= GROWTH * total).last().unwrap_or(1)
}

impl Mapping {
    /// The direction of a point.
    fn direction(self, point: Vec2) -> Vec3 {
        match self {
            Mapping::LatLong => {
                let (sin_longitude, cos_longitude) = (point.x * TAU).sin_cos();
                let (sin_latitude, cos_latitude) = (point.y * PI).sin_cos();
                Vec3::new(sin_latitude * sin_longitude, cos_latitude, -sin_latitude * cos_longitude)
            }
            Mapping::EqualArea => {
                let signed = 2.0 * point - Vec2::ONE;
                let across = signed.abs();
                let depth = 1.0 - (across.x + across.y);
                let radius = 1.0 - depth.abs();
                let angle = if radius == 0.0 { 0.5 } else { 0.5 + 0.5 * (across.y - across.x) / radius } * FRAC_PI_2;
                let flat = Vec2::from_angle(angle) * (radius * (2.0 - radius * radius).max(0.0).sqrt());
                let z = (1.0 - radius * radius).copysign(depth);
                Vec3::new(flat.x.copysign(signed.x), flat.y.copysign(signed.y), z)
            }
        }
    }

    /// The point of a direction (unit length).
    fn point(self, direction: Vec3) -> Vec2 {
        match self {
            Mapping::LatLong => {
                let longitude = direction.x.atan2(-direction.z) / TAU;
                let latitude = Vec2::new(direction.x, direction.z).length().atan2(direction.y) / PI;
                Vec2::new(longitude - longitude.floor(), latitude)
            }
            Mapping::EqualArea => {
                let radius = (1.0 - direction.z.abs()).max(0.0).sqrt();
                let share = direction.y.abs().atan2(direction.x.abs()) / FRAC_PI_2;
                let mut across = Vec2::new(radius * (1.0 - share), radius * share);
                if direction.z < 0.0 {
                    across = Vec2::new(1.0 - across.y, 1.0 - across.x);
                }
                0.5 + 0.5 * Vec2::new(across.x.copysign(direction.x), across.y.copysign(direction.y))
            }
        }
    }

    /// Solid angle per area of the unit square.
    fn solid_angle(self, point: Vec2) -> f32 {
        match self {
            Mapping::LatLong => TAU * PI * (point.y * PI).sin(),
            Mapping::EqualArea => 4.0 * PI,
        }
    }
}

impl Far for Environment {
    fn sample(&self, u: Vec2) -> Option<(Vec3, Spectrum, f32)> {
        let (at, pdf) = self.grid.sample(u);
        let (radiance, solid_angle) = (self.at(at), self.mapping.solid_angle(at));
        let lit = !radiance.is_zero() && solid_angle > 0.0;
        lit.then(|| (self.to_world * self.mapping.direction(at), radiance, pdf / solid_angle))
    }

    fn unsample(&self, toward: Vec3) -> Option<Vec2> {
        Some(self.grid.unsample(self.point(toward)))
    }

    fn world(&self) -> &World {
        &self.world
    }

    fn power(&self) -> Spectrum {
        self.integral * self.world.cross_section()
    }

    fn radiance(&self, toward: Vec3) -> Spectrum {
        self.at(self.point(toward))
    }

    fn pdf(&self, toward: Vec3) -> f32 {
        let at = self.point(toward);
        let solid_angle = self.mapping.solid_angle(at);
        if solid_angle > 0.0 { self.grid.pdf(at) / solid_angle } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_and_directions_are_each_others_inverse() {
        for mapping in [Mapping::LatLong, Mapping::EqualArea] {
            for (i, j) in (0..32).flat_map(|i| (0..32).map(move |j| (i, j))) {
                let point = (Vec2::new(i as f32, j as f32) + 0.5) / 32.0;
                let direction = mapping.direction(point);
                assert!((direction.length() - 1.0).abs() < 1e-5);
                assert!((mapping.point(direction) - point).length() < 1e-4, "{mapping:?} {point} {direction}");
            }
        }
    }

    #[test]
    fn the_middle_of_both_pictures_lies_along_z() {
        for mapping in [Mapping::LatLong, Mapping::EqualArea] {
            assert!((mapping.direction(Vec2::splat(0.5)) - Vec3::Z).length() < 1e-6);
        }
        assert!((Mapping::LatLong.direction(Vec2::new(0.25, 0.5)) - Vec3::X).length() < 1e-6);
        assert!((Mapping::LatLong.direction(Vec2::new(0.3, 0.0)) - Vec3::Y).length() < 1e-6);
    }

    #[test]
    fn a_square_of_equal_areas_is_continuous_over_its_edges() {
        let pixels = (0..64).map(|i| [i as f32; 3]).collect();
        let image = Image::from_pixels(8, 8, pixels).expect("64 pixels");
        let world = World { center: Vec3::ZERO, radius: 1.0 };
        let environment = Environment::new(Arc::new(image), Spectrum::ONE, Mapping::EqualArea, Mat3::IDENTITY, world);
        for step in 0..100 {
            // On the lower half of the great circles y = 0 and x = 0 the picture has its edges.
            let angle = PI * (0.51 + 0.0048 * step as f32);
            for side in [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y] {
                let on_edge = side * angle.sin() + Vec3::Z * angle.cos();
                let aside = Vec3::Z.cross(side) * 1e-4;
                let [a, b] = [on_edge + aside, on_edge - aside].map(|d| environment.radiance(d.normalize()).mean());
                assert!((a - b).abs() < 0.1, "{on_edge}: {a} {b}");
            }
        }
    }
}
