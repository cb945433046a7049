//! The yardstick of the photon map: a plain grid of dense cells, x fastest, sorted by counting, one record after the
//! other, without any cleverness. What is gathered lies in the record.

#![allow(missing_docs)]

use glam::{UVec3, Vec3};

/// A position and what the photon carries.
#[derive(Clone, Copy)]
pub struct Record<P> {
    pub position: Vec3,
    pub payload: P,
}

pub struct RowGrid<P> {
    records: Vec<Record<P>>,
    starts: Vec<u32>,
    origin: Vec3,
    inverse_cell: f32,
    size: UVec3,
}

impl<P: Copy> RowGrid<P> {
    pub fn build(records: &[Record<P>], cell: f32) -> RowGrid<P> {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for record in records {
            (low, high) = (low.min(record.position), high.max(record.position));
        }
        let size = ((high - low) / cell).floor().as_uvec3() + UVec3::ONE;
        let cells = size.element_product() as usize;
        let mut grid = RowGrid {
            records: records.to_vec(),
            starts: vec![0; cells + 1],
            origin: low,
            inverse_cell: 1.0 / cell,
            size,
        };
        let cell_of = |grid: &RowGrid<P>, record: &Record<P>| {
            let at = grid.coordinates(record.position);
            ((at.z * size.y + at.y) * size.x + at.x) as usize
        };
        for record in records {
            let cell = cell_of(&grid, record);
            grid.starts[cell + 1] += 1;
        }
        for cell in 0..cells {
            grid.starts[cell + 1] += grid.starts[cell];
        }
        let mut next = grid.starts.clone();
        for record in records {
            let cell = cell_of(&grid, record);
            grid.records[next[cell] as usize] = *record;
            next[cell] += 1;
        }
        grid
    }

    fn coordinates(&self, point: Vec3) -> UVec3 {
        ((point - self.origin) * self.inverse_cell).max(Vec3::ZERO).as_uvec3().min(self.size - UVec3::ONE)
    }

    #[inline]
    pub fn within(&self, center: Vec3, radius: f32, mut visit: impl FnMut(&P, f32)) {
        let (low, high) = (self.coordinates(center - radius), self.coordinates(center + radius));
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                let row = (z * self.size.y + y) * self.size.x;
                let (first, last) = (self.starts[(row + low.x) as usize], self.starts[(row + high.x + 1) as usize]);
                for record in &self.records[first as usize..last as usize] {
                    let distance_squared = record.position.distance_squared(center);
                    if distance_squared < radius * radius {
                        visit(&record.payload, distance_squared);
                    }
                }
            }
        }
    }

    /// Leaves in `found` the photons nearer than the `count`-th, all within `max_radius`; returns how far they reach.
    pub fn nearest(&self, center: Vec3, count: usize, max_radius: f32, found: &mut Vec<(f32, P)>) -> f32 {
        found.clear();
        self.within(center, max_radius, |payload, distance_squared| found.push((distance_squared, *payload)));
        if found.len() < count {
            return max_radius;
        }
        let radius = found.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0)).1.0.sqrt();
        found.truncate(count - 1);
        radius
    }
}
