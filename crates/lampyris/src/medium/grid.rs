//! Media whose density a grid gives: trilinear between its values, with bounds for parts of it (theory §9.5).

use std::sync::Arc;

use glam::{Affine3A, UVec3, Vec3};

use crate::geometry::Ray;
use crate::spectrum::Spectrum;

/// Numbers in a box, as a file holds them.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeData {
    /// How many along x, y, z; none is 0.
    pub size: [u32; 3],
    /// One number for each, or three: linear RGB.
    pub channels: u32,
    /// The corners of the box that the file names.
    pub bounds: [[f32; 3]; 2],
    /// The numbers, x fastest, of each place the channels.
    pub values: Vec<f32>,
}

/// Numbers in space: those of a box, which are the middles of its cells; outside of the box those at its sides.
#[derive(Clone, Debug)]
pub struct Grid {
    data: Arc<VolumeData>,
    /// From the world to where the box is the unit cube.
    to_unit: Affine3A,
    /// Whether the number of a cell holds in all of it.
    nearest: bool,
}

impl Grid {
    /// `to_unit` takes the world to where the box is the unit cube.
    pub fn new(data: Arc<VolumeData>, to_unit: Affine3A, nearest: bool) -> Grid {
        Grid { data, to_unit, nearest }
    }

    /// The value at a point of the world.
    pub fn at(&self, point: Vec3) -> Spectrum {
        let size = UVec3::from_array(self.data.size);
        let last = size - UVec3::ONE;
        let place = self.to_unit.transform_point3(point) * size.as_vec3();
        if self.nearest {
            return self.value(place.max(Vec3::ZERO).as_uvec3().min(last));
        }
        let place = (place - 0.5).clamp(Vec3::ZERO, last.as_vec3());
        let low = place.as_uvec3().min(last);
        let (high, t) = ((low + UVec3::ONE).min(last), place - low.as_vec3());
        let mut sum = Spectrum::ZERO;
        for corner in 0..8_u32 {
            let pick = UVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let at = low * (UVec3::ONE - pick) + high * pick;
            let share = Vec3::select(pick.cmpeq(UVec3::ONE), t, 1.0 - t);
            sum += self.value(at) * (share.x * share.y * share.z);
        }
        sum
    }

    fn value(&self, at: UVec3) -> Spectrum {
        let [nx, ny, _] = self.data.size.map(|side| side as usize);
        let index = ((at.z as usize * ny + at.y as usize) * nx + at.x as usize) * self.data.channels as usize;
        match self.data.channels {
            1 => Spectrum::grey(self.data.values[index]),
            _ => Spectrum::from_rgb([0, 1, 2].map(|channel| self.data.values[index + channel])),
        }
    }
}

/// Where a grid gives the density, and may give the albedo.
#[derive(Clone, Debug)]
pub struct Cloud {
    /// Factor of the medium's extinction coefficient.
    density: Grid,
    /// The share of the light that collisions scatter, where it is not the same everywhere.
    albedo: Option<Grid>,
    bounds: UpperBounds,
}

/// Parts of a grid with upper bounds of the density there, x fastest.
#[derive(Clone, Debug)]
struct UpperBounds {
    size: UVec3,
    values: Vec<f32>,
}

/// Parts along each side, at most.
const MOST_PARTS: u32 = 16;

impl Cloud {
    /// Of a density, which must not be negative, and an albedo.
    pub fn new(density: Grid, albedo: Option<Grid>) -> Cloud {
        let bounds = UpperBounds::new(&density.data);
        Cloud { density, albedo, bounds }
    }

    /// The same with bounds that are so many times as high, which must make no difference but for time.
    #[must_use]
    pub fn with_higher_bounds(mut self, times: f32) -> Cloud {
        self.bounds.values.iter_mut().for_each(|bound| *bound *= times);
        self
    }

    /// Factor of the extinction coefficient at a point of the world; outside of the box there is nothing.
    #[inline]
    pub fn density(&self, point: Vec3) -> Spectrum {
        let place = self.density.to_unit.transform_point3(point);
        // What rounding puts outside belongs to the side.
        let is_inside = place.cmpge(Vec3::splat(-1e-4)).all() && place.cmple(Vec3::splat(1.0 + 1e-4)).all();
        if is_inside { self.density.at(point) } else { Spectrum::ZERO }
    }

    /// The albedo there, if the cloud has one of its own.
    #[inline]
    pub fn albedo(&self, point: Vec3) -> Option<Spectrum> {
        self.albedo.as_ref().map(|albedo| albedo.at(point))
    }

    /// Whether the density has colours.
    pub fn is_coloured(&self) -> bool {
        self.density.data.channels > 1
    }

    /// The highest density, of any channel.
    pub fn most(&self) -> f32 {
        self.bounds.values.iter().copied().fold(0.0, f32::max)
    }

    /// Where a ray enters and leaves the box, up to a distance.
    pub(super) fn extent(&self, ray: &Ray, distance: f32) -> Option<(f32, f32)> {
        let [origin, direction] =
            [self.density.to_unit.transform_point3(ray.origin), self.density.to_unit.transform_vector3(ray.direction)];
        within(origin, direction, Vec3::ONE, distance)
    }

    /// Tells of the parts of a ray up to a distance that lie in the box, one after the other, as (from, to, upper bound of
    /// the density), until `visit` has enough (false).
    pub(super) fn along(&self, ray: &Ray, distance: f32, mut visit: impl FnMut(f32, f32, f32) -> bool) {
        let UpperBounds { size, values } = &self.bounds;
        let parts = size.as_vec3();
        let origin = self.density.to_unit.transform_point3(ray.origin) * parts;
        let direction = self.density.to_unit.transform_vector3(ray.direction) * parts;
        let Some((mut from, end)) = within(origin, direction, parts, distance) else { return };
        let (start, origin, direction) = (origin + direction * from, origin.to_array(), direction.to_array());
        let last = (*size - UVec3::ONE).to_array();
        let mut cell = start.max(Vec3::ZERO).as_uvec3().min(*size - UVec3::ONE).to_array();
        // The planes at the sides are those at which the box ends.
        let next = |axis: usize, cell: u32| match direction[axis] {
            d if d > 0.0 && cell < last[axis] => ((cell + 1) as f32 - origin[axis]) / d,
            d if d < 0.0 && cell > 0 => (cell as f32 - origin[axis]) / d,
            _ => f32::INFINITY,
        };
        let mut leave: [f32; 3] = std::array::from_fn(|axis| next(axis, cell[axis]));
        loop {
            let axis = (1..3).fold(0, |least, axis| if leave[axis] < leave[least] { axis } else { least });
            let to = leave[axis].min(end);
            let [x, y, z] = cell;
            let bound = values[((z * size.y + y) * size.x + x) as usize];
            if to > from && !visit(from, to, bound) || to >= end {
                return;
            }
            from = from.max(to);
            // There is a next one, since the plane between them is at a finite distance.
            cell[axis] = if direction[axis] > 0.0 { cell[axis] + 1 } else { cell[axis] - 1 };
            leave[axis] = next(axis, cell[axis]);
        }
    }
}

/// From where to where, up to a distance, a ray is in the box from 0 to `size`.
fn within(origin: Vec3, direction: Vec3, size: Vec3, distance: f32) -> Option<(f32, f32)> {
    let (mut from, mut to) = (0.0_f32, distance);
    for axis in 0..3 {
        let (o, d) = (origin[axis], direction[axis]);
        if d == 0.0 {
            if o < 0.0 || o > size[axis] {
                return None;
            }
            continue;
        }
        let (a, b) = (-o / d, (size[axis] - o) / d);
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    (from < to).then_some((from, to))
}

impl UpperBounds {
    fn new(data: &VolumeData) -> UpperBounds {
        let count = data.size.map(|side| side.clamp(1, MOST_PARTS));
        // The cells whose values have a share in a part: one more on either side, for what lies between values.
        let range = |axis: usize, part: u32| {
            let (side, count) = (u64::from(data.size[axis]), u64::from(count[axis]));
            let first = (u64::from(part) * side / count).saturating_sub(1);
            let end = ((u64::from(part) + 1) * side).div_ceil(count) + 1;
            first as usize..end.min(side) as usize
        };
        let [nx, ny, _] = data.size.map(|side| side as usize);
        let channels = data.channels as usize;
        let mut values = Vec::with_capacity(count.iter().product::<u32>() as usize);
        for z in 0..count[2] {
            for y in 0..count[1] {
                for x in 0..count[0] {
                    let mut most = 0.0_f32;
                    for (k, j) in range(2, z).flat_map(|k| range(1, y).map(move |j| (k, j))) {
                        let row = (k * ny + j) * nx;
                        let along = range(0, x);
                        let values = &data.values[(row + along.start) * channels..(row + along.end) * channels];
                        most = values.iter().copied().fold(most, f32::max);
                    }
                    values.push(most);
                }
            }
        }
        UpperBounds { size: UVec3::from_array(count), values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::Sampler;

    fn data(size: [u32; 3], value: impl FnMut(usize) -> f32) -> Arc<VolumeData> {
        let count = size.iter().product::<u32>() as usize;
        Arc::new(VolumeData {
            size,
            channels: 1,
            bounds: [[0.0; 3], [1.0; 3]],
            values: (0..count).map(value).collect(),
        })
    }

    #[test]
    fn values_are_those_of_the_middles_of_cells_and_linear_between_them() {
        let grid = Grid::new(data([2, 1, 1], |i| [1.0, 3.0][i]), Affine3A::IDENTITY, false);
        for (x, value) in [(-5.0, 1.0), (0.25, 1.0), (0.5, 2.0), (0.625, 2.5), (0.75, 3.0), (9.0, 3.0)] {
            assert_eq!(grid.at(Vec3::new(x, 7.0, -3.0)).lanes()[0], value, "{x}");
        }
        let grid = Grid { nearest: true, ..grid };
        for (x, value) in [(-5.0, 1.0), (0.49, 1.0), (0.51, 3.0), (9.0, 3.0)] {
            assert_eq!(grid.at(Vec3::new(x, 7.0, -3.0)).lanes()[0], value, "{x}");
        }
    }

    /// Along rays through and beside grids of odd sizes: the parts join, and no density exceeds its bound.
    #[test]
    fn parts_of_a_ray_join_and_bound_the_density() {
        let mut sampler = Sampler::new(6, 0, 0, 0);
        for size in [[1, 1, 1], [3, 17, 40], [33, 2, 5]] {
            let values = data(size, |_| sampler.independent().powi(8));
            let mut point = || sampler.square().extend(sampler.uniform());
            for nearest in [false, true] {
                let cloud = Cloud::new(Grid::new(values.clone(), Affine3A::IDENTITY, nearest), None);
                for index in 0..200 {
                    let mut direction = (point() - 0.5).normalize();
                    if index % 4 == 0 {
                        direction = Vec3::Y;
                    }
                    let ray = Ray { origin: 3.0 * point() - 1.0, direction };
                    let mut at = None;
                    cloud.along(&ray, 4.0, |from, to, bound| {
                        assert!(at.is_none_or(|at| at == from) && to > from && to <= 4.0);
                        at = Some(to);
                        for i in 0..20 {
                            let t = from + (to - from) * (i as f32 + 0.5) / 20.0;
                            let density = cloud.density(ray.at(t)).max();
                            assert!(density <= bound * 1.00001, "{density} > {bound}");
                        }
                        true
                    });
                    // Nothing is left out: the parts go from where the ray comes in to where it goes out.
                    let inside = |t: f32| ray.at(t).cmpge(Vec3::ZERO).all() && ray.at(t).cmple(Vec3::ONE).all();
                    let last = (0..=4000).rev().map(|i| i as f32 / 1000.0).find(|&t| inside(t));
                    assert!(last.is_none_or(|last| at.is_some_and(|at| (at - last).abs() < 2e-3)), "{at:?} {last:?}");
                }
            }
        }
    }
}
