//! The innermost loop of the search: distances of a run of photons, and which of them are below a limit.
//!
//! It is written twice, for every processor and for those with AVX2. Both compute the same sums in the same order and
//! find the same photons in the same order, so that pictures do not depend on the processor, to the last bit.

#![allow(unsafe_code)]

use glam::Vec3;

use super::grid::Grid;

/// Positions axis by axis, so that several distances can be computed side by side.
#[derive(Debug)]
pub(super) struct Positions {
    pub(super) axes: [Vec<f32>; 3],
}

/// So many distances are computed side by side; and so many values lie behind the last position, that there be a group
/// from each on.
pub(super) const GROUP: usize = 8;

/// Numbers and squared distances of the photons that a search found, in the order of the map.
#[derive(Debug, Default)]
pub(super) struct Hits {
    /// Only the first `count` mean something; there is always room for a group more.
    indices: Vec<u32>,
    distances_squared: Vec<f32>,
    count: usize,
}

impl Hits {
    pub(super) fn indices(&self) -> &[u32] {
        &self.indices[..self.count]
    }

    pub(super) fn distances_squared(&self) -> &[f32] {
        &self.distances_squared[..self.count]
    }

    pub(super) fn distances_squared_mut(&mut self) -> &mut [f32] {
        &mut self.distances_squared[..self.count]
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// Only those nearer than this, in the same order.
    pub(super) fn keep_below(&mut self, limit: f32) {
        let mut kept = 0;
        for at in 0..self.count {
            let (index, distance_squared) = (self.indices[at], self.distances_squared[at]);
            // Without a branch, which would be foreseen badly.
            self.indices[kept] = index;
            self.distances_squared[kept] = distance_squared;
            kept += usize::from(distance_squared < limit);
        }
        self.count = kept;
    }

    /// Makes room for so many more, and a group.
    #[inline]
    fn reserve(&mut self, more: usize) {
        let needed = self.count + more + GROUP;
        if self.indices.len() < needed {
            self.indices.resize(2 * needed, 0);
            self.distances_squared.resize(2 * needed, 0.0);
        }
    }
}

/// How the search is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lanes(Width);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Width {
    One,
    #[cfg(target_arch = "x86_64")]
    Eight,
}

impl Lanes {
    /// For every processor.
    pub(super) const PORTABLE: Lanes = Lanes(Width::One);

    /// The fastest that this processor has.
    pub(super) fn detect() -> Lanes {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("popcnt") && is_x86_feature_detected!("bmi1") {
            return Lanes(Width::Eight);
        }
        Lanes::PORTABLE
    }

    /// Finds all photons nearer to `center` than `radius`.
    #[inline]
    pub(super) fn search(self, grid: &Grid, positions: &Positions, center: Vec3, radius: f32, hits: &mut Hits) {
        match self.0 {
            Width::One => portable(grid, positions, center, radius, hits),
            // SAFETY: only `detect` makes this value, after it found all features that the function is compiled for.
            #[cfg(target_arch = "x86_64")]
            Width::Eight => unsafe { avx2::search(grid, positions, center, radius, hits) },
        }
    }
}

fn portable(grid: &Grid, positions: &Positions, center: Vec3, radius: f32, hits: &mut Hits) {
    let limit = radius * radius;
    let [xs, ys, zs] = &positions.axes;
    hits.count = 0;
    grid.rows(center, radius, |first, last| {
        hits.reserve(last - first);
        let run = xs[first..last].iter().zip(&ys[first..last]).zip(&zs[first..last]);
        for (((x, y), z), index) in run.zip(first as u32..) {
            let (dx, dy, dz) = (x - center.x, y - center.y, z - center.z);
            let distance_squared = dx * dx + dy * dy + dz * dz;
            hits.indices[hits.count] = index;
            hits.distances_squared[hits.count] = distance_squared;
            hits.count += usize::from(distance_squared < limit);
        }
    });
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::{
        __m256, __m256i, _CMP_LT_OQ, _mm_cvtsi64_si128, _mm256_add_epi32, _mm256_add_ps, _mm256_cmp_ps,
        _mm256_cvtepu8_epi32, _mm256_loadu_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_permutevar8x32_ps,
        _mm256_set1_epi32, _mm256_set1_ps, _mm256_storeu_ps, _mm256_storeu_si256, _mm256_sub_ps,
    };

    use super::{GROUP, Grid, Hits, Positions, Vec3};

    #[target_feature(enable = "avx2,popcnt,bmi1")]
    pub(super) fn search(grid: &Grid, positions: &Positions, center: Vec3, radius: f32, hits: &mut Hits) {
        let [x, y, z] = center.to_array().map(|axis| _mm256_set1_ps(axis));
        let limit = _mm256_set1_ps(radius * radius);
        let [xs, ys, zs] = &positions.axes;
        hits.count = 0;
        grid.rows(center, radius, |first, last| {
            hits.reserve(last - first);
            for start in (first..last).step_by(GROUP) {
                let dx = _mm256_sub_ps(load(xs, start), x);
                let dy = _mm256_sub_ps(load(ys, start), y);
                let dz = _mm256_sub_ps(load(zs, start), z);
                // Products and sums apart, each rounded, as in the portable twin.
                let squares = _mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy));
                let distances_squared = _mm256_add_ps(squares, _mm256_mul_ps(dz, dz));
                let below = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(distances_squared, limit));
                // What lies behind the run does not count.
                let inside = below as u32 & ((1 << (last - start).min(GROUP)) - 1);
                let places = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(COMPRESSED[inside as usize & 0xff] as i64));
                let indices = _mm256_add_epi32(places, _mm256_set1_epi32(start as i32));
                store(&mut hits.distances_squared, hits.count, _mm256_permutevar8x32_ps(distances_squared, places));
                store_integers(&mut hits.indices, hits.count, indices);
                hits.count += inside.count_ones() as usize;
            }
        });
    }

    /// For every set of lanes their numbers, a byte each, in ascending order.
    static COMPRESSED: [u64; 256] = {
        let mut table = [0; 256];
        let mut set = 0;
        while set < 256 {
            let (mut lane, mut count) = (0, 0);
            while lane < GROUP {
                if set >> lane & 1 == 1 {
                    table[set] |= (lane as u64) << (8 * count);
                    count += 1;
                }
                lane += 1;
            }
            set += 1;
        }
        table
    };

    #[inline]
    #[target_feature(enable = "avx2")]
    fn load(values: &[f32], at: usize) -> __m256 {
        let group = &values[at..at + GROUP];
        // SAFETY: the slice has eight values; the load needs no alignment.
        unsafe { _mm256_loadu_ps(group.as_ptr()) }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn store(values: &mut [f32], at: usize, group: __m256) {
        let place = &mut values[at..at + GROUP];
        // SAFETY: the slice has room for eight values; the store needs no alignment.
        unsafe { _mm256_storeu_ps(place.as_mut_ptr(), group) }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn store_integers(values: &mut [u32], at: usize, group: __m256i) {
        let place = &mut values[at..at + GROUP];
        // SAFETY: the slice has room for eight values of 32 bits; the store needs no alignment.
        unsafe { _mm256_storeu_si256(place.as_mut_ptr().cast(), group) }
    }
}
