//! The photon map: photons sorted into a grid whose rows are contiguous.
//!
//! Cells are numbered x fastest, so that the cells of a query box form one slice of photons for every (y, z). On this
//! kind of data (photons on surfaces, coherent queries) that beats a kd-tree two to one (the book, "Performance").

use glam::{UVec3, Vec3};
use rayon::prelude::*;

use super::{Nearest, Photon, Radius};
use crate::geometry::Bounds;

/// The photons of one pass, ready for queries. Immutable.
#[derive(Debug)]
pub struct PhotonMap {
    photons: Vec<Photon>,
    /// Positions of `photons` once more, axis by axis, so that the search computes several distances at once.
    positions: [Vec<f32>; 3],
    grid: Grid,
    paths_emitted: u64,
}

/// Where a photon lies before it is sorted.
#[derive(Clone, Copy)]
struct Place {
    block: u32,
    index: u32,
}

/// Where in the sorted list the photons of each cell are.
#[derive(Debug)]
struct Grid {
    origin: Vec3,
    inverse_cell: f32,
    size: UVec3,
    /// `starts[cell]..starts[cell + 1]` are its photons; photons outside the box belong to the nearest cell.
    starts: Vec<u32>,
}

impl PhotonMap {
    /// Sorts the photons of `paths_emitted` light paths for queries with about this radius. Equal photons in equal
    /// order give an equal map.
    pub fn build(photons: Vec<Photon>, paths_emitted: u64, radius: Radius) -> PhotonMap {
        PhotonMap::from_blocks(&[photons], paths_emitted, radius)
    }

    /// [`PhotonMap::build`] of photons that lie in several blocks, one after the other.
    pub fn from_blocks(blocks: &[Vec<Photon>], paths_emitted: u64, radius: Radius) -> PhotonMap {
        let places: Vec<Place> = (0..)
            .zip(blocks)
            .flat_map(|(block, photons)| (0..photons.len() as u32).map(move |index| Place { block, index }))
            .collect();
        let photon = |place: &Place| &blocks[place.block as usize][place.index as usize];
        let points: Vec<Vec3> = places.par_iter().map(|place| photon(place).position).collect();
        let cell = match radius {
            Radius::Fixed(radius) => radius,
            Radius::Nearest { count, max_radius } => typical_distance(&points, count).min(max_radius),
        };
        let (grid, order) = Grid::sort(&points, cell);
        let photons = order.par_iter().map(|&index| *photon(&places[index as usize])).collect();
        let axis = |axis: usize| order.par_iter().map(|&index| points[index as usize][axis]).collect();
        PhotonMap { photons, positions: [axis(0), axis(1), axis(2)], grid, paths_emitted }
    }

    /// All photons, sorted by cell.
    pub fn photons(&self) -> &[Photon] {
        &self.photons
    }

    /// How many light paths were emitted for it.
    pub fn paths_emitted(&self) -> u64 {
        self.paths_emitted
    }

    /// Calls `visit` with every photon nearer to `center` than `radius`, and its squared distance.
    #[inline]
    pub fn within(&self, center: Vec3, radius: f32, mut visit: impl FnMut(&Photon, f32)) {
        self.near(center, radius, |index, distance_squared| visit(&self.photons[index], distance_squared));
    }

    /// Calls `visit` with the number of every photon nearer to `center` than `radius`, and its squared distance.
    #[inline]
    fn near(&self, center: Vec3, radius: f32, mut visit: impl FnMut(usize, f32)) {
        let limit = radius * radius;
        let [xs, ys, zs] = &self.positions;
        self.grid.rows(center, radius, |first, last| {
            let (xs, ys, zs) = (&xs[first..last], &ys[first..last], &zs[first..last]);
            // Distances in groups, without a branch, so that the compiler can compute them side by side.
            let mut start = 0;
            while start < xs.len() {
                let count = (xs.len() - start).min(GROUP);
                let mut distances = [f32::INFINITY; GROUP];
                let group = xs[start..][..count].iter().zip(&ys[start..][..count]).zip(&zs[start..][..count]);
                for (distance, ((x, y), z)) in distances.iter_mut().zip(group) {
                    let (dx, dy, dz) = (x - center.x, y - center.y, z - center.z);
                    *distance = dx * dx + dy * dy + dz * dz;
                }
                for (offset, &distance_squared) in distances.iter().enumerate() {
                    if distance_squared < limit {
                        visit(first + start + offset, distance_squared);
                    }
                }
                start += count;
            }
        });
    }

    /// Finds the radius of an estimate from the `count` nearest photons: the distance of the last of them, or
    /// `max_radius` if there are fewer up to there; where that is infinite, the distance of the farthest of all. All
    /// photons that are nearer are left in `found`.
    pub fn nearest<'f>(
        &self,
        center: Vec3,
        count: usize,
        max_radius: f32,
        found: &'f mut Nearest,
    ) -> (f32, impl Iterator<Item = (&Photon, f32)> + use<'_, 'f>) {
        let mut reach = (1.25 / self.grid.inverse_cell).min(max_radius);
        let radius_squared = loop {
            found.collect(self, center, reach);
            if found.candidates.len() >= count {
                break found.nth_distance_squared(count);
            }
            if reach >= max_radius || found.candidates.len() == self.photons.len() {
                break if max_radius.is_finite() { max_radius.powi(2) } else { found.farthest_distance_squared() };
            }
            reach = (reach * 1.7).min(max_radius);
        };
        let photons = found
            .candidates
            .iter()
            .filter(move |(distance_squared, _)| *distance_squared < radius_squared)
            .map(|&(distance_squared, index)| (&self.photons[index as usize], distance_squared));
        (radius_squared.sqrt(), photons)
    }
}

impl Nearest {
    /// Candidates in the order of the map, which does not depend on `reach`: sums over them keep their order.
    fn collect(&mut self, map: &PhotonMap, center: Vec3, reach: f32) {
        self.candidates.clear();
        map.near(center, reach, |index, distance_squared| self.candidates.push((distance_squared, index as u32)));
    }

    fn farthest_distance_squared(&self) -> f32 {
        self.candidates.iter().map(|candidate| candidate.0).fold(0.0, f32::max)
    }

    fn nth_distance_squared(&mut self, count: usize) -> f32 {
        self.distances.clear();
        self.distances.extend(self.candidates.iter().map(|candidate| candidate.0));
        *self.distances.select_nth_unstable_by(count.max(1) - 1, f32::total_cmp).1
    }
}

/// So many distances are computed side by side.
const GROUP: usize = 8;

/// At most this many cells for each photon.
const CELLS_PER_PHOTON: usize = 8;

impl Grid {
    /// A grid of cells of about this size, and the order of the points in it.
    fn sort(points: &[Vec3], cell: f32) -> (Grid, Vec<u32>) {
        let mut grid = Grid::sized(&robust_bounds(points), cell, (CELLS_PER_PHOTON * points.len()).max(64));
        let cells: Vec<u32> = points.par_iter().map(|&point| grid.cell_of(point)).collect();
        // Counting sort: counts, then ends, which become starts as the points are put before them from last to first.
        let mut starts = vec![0_u32; grid.size.element_product() as usize + 1];
        for &cell in &cells {
            starts[cell as usize] += 1;
        }
        let mut end = 0;
        for count in &mut starts {
            end += *count;
            *count = end;
        }
        let mut order = vec![0; points.len()];
        for (index, &cell) in cells.iter().enumerate().rev() {
            let start = &mut starts[cell as usize];
            *start -= 1;
            order[*start as usize] = index as u32;
        }
        grid.starts = starts;
        (grid, order)
    }

    fn sized(bounds: &Bounds, cell: f32, max_cells: usize) -> Grid {
        let extent = (bounds.max - bounds.min).max(Vec3::ZERO);
        let longest = extent.max_element();
        // Without any extent all photons lie in one point, or there are none.
        let usable = |cell: f32| cell.is_finite() && cell > 0.0;
        let mut cell = [cell, longest].into_iter().find(|&cell| usable(cell)).unwrap_or(1.0);
        // Cells are never so small that the longest side has more of them than a thousand each way would allow.
        cell = cell.max(longest / 4096.0);
        let cells = |cell: f32| (extent / cell).floor().as_uvec3() + UVec3::ONE;
        while cells(cell).as_u64vec3().element_product() > max_cells as u64 {
            cell *= 1.25;
        }
        Grid { origin: bounds.min, inverse_cell: 1.0 / cell, size: cells(cell), starts: Vec::new() }
    }

    #[inline]
    fn coordinates(&self, point: Vec3) -> UVec3 {
        // Float to integer conversion saturates: what lies outside belongs to the border.
        ((point - self.origin) * self.inverse_cell).max(Vec3::ZERO).as_uvec3().min(self.size - UVec3::ONE)
    }

    #[inline]
    fn cell_of(&self, point: Vec3) -> u32 {
        let at = self.coordinates(point);
        (at.z * self.size.y + at.y) * self.size.x + at.x
    }

    /// Calls `visit` with ranges of photons that together hold all within `radius` of `center`.
    #[inline]
    fn rows(&self, center: Vec3, radius: f32, mut visit: impl FnMut(usize, usize)) {
        let low = self.coordinates(center - radius);
        let high = self.coordinates(center + radius);
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                let row = (z * self.size.y + y) * self.size.x;
                let first = self.starts[(row + low.x) as usize];
                let last = self.starts[(row + high.x + 1) as usize];
                if first < last {
                    visit(first as usize, last as usize);
                }
            }
        }
    }
}

/// The box that holds nearly all points: a few far ones (photons run far on an infinite plane) must not make the cells
/// of all others large.
fn robust_bounds(points: &[Vec3]) -> Bounds {
    let sample: Vec<Vec3> = points.iter().step_by((points.len() / 4096).max(1)).copied().collect();
    let sorted = |axis: usize| {
        let mut values: Vec<f32> = sample.iter().map(|point| point[axis]).collect();
        values.sort_unstable_by(f32::total_cmp);
        values
    };
    let mut bounds = Bounds::EMPTY;
    if sample.is_empty() {
        return Bounds { min: Vec3::ZERO, max: Vec3::ZERO };
    }
    for axis in 0..3 {
        let values = sorted(axis);
        let cut = values.len() / 200;
        let (low, high) = (values[cut], values[values.len() - 1 - cut]);
        let margin = 0.05 * (high - low);
        bounds.min[axis] = (low - margin).max(values[0]);
        bounds.max[axis] = (high + margin).min(values[values.len() - 1]);
    }
    bounds
}

/// About how far the `count`-th nearest photon is from a typical photon, as if they lay on a surface: the median over
/// some photons of the distance to their eighth nearest within a thinned-out set, scaled.
fn typical_distance(points: &[Vec3], nearest: usize) -> f32 {
    const EIGHTH: usize = 8;
    let thinning = (points.len() / 4096).max(1);
    let thinned: Vec<Vec3> = points.iter().step_by(thinning).copied().collect();
    let mut distances: Vec<f32> = thinned
        .iter()
        .step_by((thinned.len() / 64).max(1))
        .filter_map(|&center| {
            let mut distances: Vec<f32> = thinned.iter().map(|point| point.distance_squared(center)).collect();
            // The photon itself is the nearest.
            (distances.len() > EIGHTH).then(|| *distances.select_nth_unstable_by(EIGHTH, f32::total_cmp).1)
        })
        .collect();
    if distances.is_empty() {
        return f32::INFINITY;
    }
    let middle = distances.len() / 2;
    let median = *distances.select_nth_unstable_by(middle, f32::total_cmp).1;
    (median * nearest as f32 / (EIGHTH * thinning) as f32).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Lobes;
    use crate::sampler::Sampler;
    use crate::spectrum::Spectrum;

    /// Photons on a square and a few far away, as on an infinite plane.
    fn photons(count: usize) -> Vec<Photon> {
        let mut sampler = Sampler::new(11, 0, 0, 0);
        let photon = |index: usize| {
            let stretch = if index.is_multiple_of(100) { 1e4 } else { 1.0 };
            Photon {
                position: (sampler.square() * stretch).extend(0.01 * sampler.uniform()),
                direction: Vec3::NEG_Z,
                normal: Vec3::Z,
                optical_length: index as f32,
                flux: Spectrum::ONE,
                bounce: 0,
                history: Lobes::NONE,
            }
        };
        (0..count).map(photon).collect()
    }

    /// What the photons are recognised by, sorted.
    fn numbers<'p>(found: impl Iterator<Item = &'p Photon>) -> Vec<u32> {
        let mut numbers: Vec<u32> = found.map(|photon| photon.optical_length as u32).collect();
        numbers.sort_unstable();
        numbers
    }

    fn by_force(photons: &[Photon], center: Vec3, radius: f32) -> Vec<u32> {
        numbers(photons.iter().filter(|photon| photon.position.distance_squared(center) < radius * radius))
    }

    #[test]
    fn a_search_within_a_radius_finds_what_trying_all_finds() {
        let photons = photons(5_000);
        let map = PhotonMap::build(photons.clone(), 1, Radius::Fixed(0.05));
        let far = photons[100].position;
        for (center, radius) in [(Vec3::new(0.5, 0.5, 0.0), 0.05), (Vec3::ZERO, 0.2), (far, 500.0), (far, 0.0)] {
            let mut found = Vec::new();
            map.within(center, radius, |photon, _| found.push(*photon));
            assert_eq!(numbers(found.iter()), by_force(&photons, center, radius), "at {center}");
        }
    }

    #[test]
    fn the_nearest_are_those_nearer_than_the_last_of_them() {
        let photons = photons(5_000);
        let mut found = Nearest::default();
        for max_radius in [f32::INFINITY, 0.02] {
            let map = PhotonMap::build(photons.clone(), 1, Radius::Nearest { count: 40, max_radius });
            for center in [Vec3::new(0.3, 0.6, 0.0), photons[200].position, Vec3::new(-50.0, 3.0, 1.0)] {
                let mut distances: Vec<f32> = photons.iter().map(|photon| photon.position.distance(center)).collect();
                distances.sort_by(f32::total_cmp);
                let (radius, nearest) = map.nearest(center, 40, max_radius, &mut found);
                let expected = distances[39].min(max_radius);
                assert!((radius - expected).abs() <= 1e-6 * expected, "{radius} is not {expected}");
                assert_eq!(numbers(nearest.map(|(photon, _)| photon)), by_force(&photons, center, radius));
            }
        }
    }

    #[test]
    fn a_map_of_nothing_or_of_one_place_can_be_asked() {
        let mut found = Nearest::default();
        for photons in [Vec::new(), vec![photons(1)[0]; 100]] {
            for radius in [Radius::Fixed(0.1), Radius::Nearest { count: 5, max_radius: f32::INFINITY }] {
                let map = PhotonMap::build(photons.clone(), 1, radius);
                let mut count = 0;
                map.within(Vec3::ZERO, 1e6, |_, _| count += 1);
                assert_eq!(count, photons.len());
                // There are fewer than a thousand: the farthest sets the radius, and is not counted itself.
                let farthest = photons.first().map_or(0.0, |photon| photon.position.length());
                let (radius, nearer) = map.nearest(Vec3::ZERO, 1000, f32::INFINITY, &mut found);
                assert!((radius - farthest).abs() <= 1e-6 * farthest, "{radius} is not {farthest}");
                assert_eq!(nearer.count(), 0);
            }
        }
    }
}
