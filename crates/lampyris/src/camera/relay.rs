//! A sensor that looks at points of a wall, from which it sees around corners.

use glam::{UVec2, Vec2, Vec3};

use crate::geometry::{Cone, Ray};
use crate::transient::{Capture, Grid};

/// A relay wall: a parallelogram whose points are the pixels of a sensor, one point each, in the middle of the cells of a
/// grid. Row 0 lies at the wall's v = 0, column 0 at its u = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relay {
    /// Where the sensor is.
    pub sensor: Vec3,
    /// The wall's corner, from which its edges go.
    pub corner: Vec3,
    /// Its edges, along the columns and along the rows.
    pub edges: [Vec3; 2],
    /// Columns and rows of points that the sensor looks at.
    pub grid: UVec2,
    /// Which point of the wall is lit.
    pub lighting: Lighting,
    /// Whether the ways from the lamp to the wall and from the wall to the sensor count as time.
    pub legs: bool,
}

/// Which point of a wall a laser lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lighting {
    /// One and the same for all pixels.
    Single,
    /// That which the pixel looks at.
    Confocal,
    /// Each of a grid of so many columns and rows, one after the other, for each pixel: the picture has as many copies of
    /// the sensor's grid beside and above each other.
    Exhaustive(UVec2),
}

impl Relay {
    /// Columns and rows of the whole picture.
    pub fn pixels(&self) -> UVec2 {
        match self.lighting {
            Lighting::Exhaustive(lasers) => self.grid * lasers,
            _ => self.grid,
        }
    }

    /// The point of the wall that a pixel looks at.
    pub fn seen(&self, pixel: Vec2) -> Vec3 {
        self.point(self.cell(pixel) % self.grid, self.grid)
    }

    /// The point of the wall that is lit for a pixel; none where it is the same for all.
    pub fn lit(&self, pixel: Vec2) -> Option<Vec3> {
        match self.lighting {
            Lighting::Single => None,
            Lighting::Confocal => Some(self.seen(pixel)),
            Lighting::Exhaustive(lasers) => Some(self.point(self.cell(pixel) / self.grid, lasers)),
        }
    }

    /// How much less than its ray's length the light of a pixel has gone, as far as it counts.
    pub fn head_start(&self, pixel: Vec2) -> f32 {
        if self.legs { 0.0 } else { self.sensor.distance(self.seen(pixel)) }
    }

    /// The same, as it is written for those who make hidden shapes of the light, for a laser at `laser` that lights this point
    /// of the wall if all pixels have the same.
    pub fn capture(&self, laser: Vec3, single: Option<Vec3>) -> Capture {
        let normal = self.edges[0].cross(self.edges[1]).normalize();
        let normal = if normal.dot(self.sensor - self.corner) < 0.0 { -normal } else { normal };
        let array = |vector: Vec3| vector.to_array().map(f64::from);
        let over = |grid: UVec2, value: &dyn Fn(UVec2) -> Vec3| -> Grid {
            (0..grid.y).map(|y| (0..grid.x).map(|x| array(value(UVec2::new(x, y)))).collect()).collect()
        };
        let lasers = match self.lighting {
            Lighting::Single => UVec2::ONE,
            Lighting::Confocal => self.grid,
            Lighting::Exhaustive(lasers) => lasers,
        };
        Capture {
            sensor_xyz: Some(array(self.sensor)),
            laser_xyz: Some(array(laser)),
            sensor_grid_xyz: over(self.grid, &|cell| self.point(cell, self.grid)),
            sensor_grid_normals: over(self.grid, &|_| normal),
            laser_grid_xyz: over(lasers, &|cell| single.unwrap_or(self.point(cell, lasers))),
            laser_grid_normals: over(lasers, &|_| normal),
            t_accounts_first_and_last_bounces: self.legs,
        }
    }

    pub(super) fn ray(&self, pixel: Vec2) -> Ray {
        let between = self.seen(pixel) - self.sensor;
        Ray { origin: self.sensor, direction: between.normalize() }
    }

    /// A cell of the grid, seen from the sensor.
    pub(super) fn cone(&self) -> Cone {
        let [u, v] = self.edges;
        let cell = (u.cross(v).length() / (self.grid.x * self.grid.y) as f32).sqrt();
        let middle = self.corner + 0.5 * (u + v);
        Cone { width: 0.0, spread: cell / self.sensor.distance(middle) }
    }

    fn cell(&self, pixel: Vec2) -> UVec2 {
        pixel.floor().max(Vec2::ZERO).as_uvec2().min(self.pixels() - 1)
    }

    /// The middle of a cell of a grid over the wall.
    fn point(&self, cell: UVec2, grid: UVec2) -> Vec3 {
        let uv = (cell.as_vec2() + 0.5) / grid.as_vec2();
        self.corner + self.edges[0] * uv.x + self.edges[1] * uv.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn relay(lighting: Lighting) -> Relay {
        let edges = [Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 3.0, 0.0)];
        let (sensor, corner) = (Vec3::new(0.0, 0.0, 5.0), Vec3::new(-1.0, 0.0, 0.0));
        Relay { sensor, corner, edges, grid: UVec2::new(4, 2), lighting, legs: false }
    }

    #[test]
    fn pixels_are_the_middles_of_cells_of_the_wall() {
        let relay = relay(Lighting::Single);
        for place in [0.0, 0.3, 0.999] {
            assert_eq!(relay.seen(Vec2::new(3.0 + place, 0.0)), Vec3::new(0.75, 0.75, 0.0));
        }
        let ray = relay.ray(Vec2::new(0.5, 1.5));
        let length = relay.head_start(Vec2::new(0.5, 1.5));
        assert!((ray.at(length) - Vec3::new(-0.75, 2.25, 0.0)).length() < 1e-6);
        assert_eq!(Relay { legs: true, ..relay }.head_start(Vec2::ZERO), 0.0);
    }

    #[test]
    fn the_lit_point_is_one_for_all_or_the_pixels_own_or_that_of_its_copy_of_the_grid() {
        let pixel = Vec2::new(5.5, 3.5);
        assert_eq!(relay(Lighting::Single).lit(pixel), None);
        let confocal = relay(Lighting::Confocal);
        assert_eq!(confocal.lit(Vec2::new(1.5, 1.5)), Some(confocal.seen(Vec2::new(1.5, 1.5))));
        let exhaustive = relay(Lighting::Exhaustive(UVec2::new(2, 3)));
        assert_eq!(exhaustive.pixels(), UVec2::new(8, 6));
        assert_eq!(exhaustive.seen(pixel), confocal.seen(Vec2::new(1.5, 1.5)));
        assert_eq!(exhaustive.lit(pixel), Some(Vec3::new(0.5, 1.5, 0.0)));
    }
}
