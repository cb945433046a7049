//! Where to split references in two: at the least cost by the surface area heuristic, over bins [Wald 2007].
//!
//! All of this is compiled once for each kind of processor (see [`BuildKernel`]), and gives the same bits.

use rayon::prelude::*;

use super::kernel::BuildKernel;
use super::portable::Portable;
use super::reference::{Extent, Reference};

pub(super) const MAX_BINS: usize = 32;

/// How many references there are, and the boxes around them and around twice their middles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    pub(super) count: usize,
    pub(super) around: Extent,
    pub(super) middles: Extent,
}

/// What lies in a bin along each axis.
#[derive(Clone, Debug)]
pub(super) struct Bins {
    around: [[Extent; 3]; MAX_BINS],
    /// References in the lower half, and in the upper the things that they stand for.
    counts: [[u64; 3]; MAX_BINS],
}

/// Into which bin a middle falls, on each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) least: [f32; 4],
    pub(super) scale: [f32; 4],
    /// Just below the number of bins.
    pub(super) last: f32,
    bins: usize,
}

/// Where to split: middles in bins below `bin` go to the left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    pub(super) axis: usize,
    pub(super) bin: usize,
}

impl Range {
    pub(super) const EMPTY: Range = Range { count: 0, around: Extent::EMPTY, middles: Extent::EMPTY };

    /// All of `references`.
    pub(super) fn of(references: &[Reference]) -> Range {
        references.iter().fold(Range::EMPTY, |range, reference| {
            let around = reference.extent();
            range.union(Range { count: 1, around, middles: Extent(Portable.middle(around.0)) })
        })
    }

    pub(super) fn of_rows(rows: &[&[Reference]]) -> Range {
        rows.par_iter().map(|row| Range::of(row)).reduce(|| Range::EMPTY, Range::union)
    }

    fn union(self, other: Range) -> Range {
        Range {
            count: self.count + other.count,
            around: self.around.union(other.around),
            middles: self.middles.union(other.middles),
        }
    }
}

/// What has so many units in its last place that whole numbers are the bits above the lowest [`FRACTION`].
pub(super) const WHOLE: f32 = 1024.0;
pub(super) const FRACTION: u32 = 13;

impl Grid {
    #[inline(always)]
    pub(super) fn new(range: &Range) -> Grid {
        let bins = (4 + range.count / 16).min(MAX_BINS);
        let last = 0.9999 * bins as f32;
        let (mut least, mut scale) = ([0.0; 4], [0.0; 4]);
        for axis in 0..3 {
            least[axis] = range.middles.0[axis];
            let inverse = last / (0.0 - (range.middles.0[axis] + range.middles.0[axis + 4]));
            // An axis without an extent has one bin.
            scale[axis] = if inverse < f32::INFINITY { inverse } else { 0.0 };
        }
        Grid { least, scale, last, bins }
    }
}

impl Bins {
    pub(super) fn empty() -> Bins {
        Bins { around: [[Extent::EMPTY; 3]; MAX_BINS], counts: [[0; 3]; MAX_BINS] }
    }

    /// Puts references into the bins of the grid, which may have held anything.
    #[inline(always)]
    pub(super) fn fill<K: BuildKernel>(&mut self, kernel: K, references: &[Reference], grid: &Grid) {
        self.around[..grid.bins].fill([Extent::EMPTY; 3]);
        self.counts[..grid.bins].fill([0; 3]);
        // What lies side by side is often in the same bins, which are not to be waited for: from both halves in turns.
        let (left, right) = references.split_at(references.len() / 2);
        for (left, right) in left.iter().zip(right) {
            self.add(kernel, left, grid);
            self.add(kernel, right, grid);
        }
        right[left.len()..].iter().for_each(|reference| self.add(kernel, reference, grid));
    }

    #[inline(always)]
    fn add<K: BuildKernel>(&mut self, kernel: K, reference: &Reference, grid: &Grid) {
        let planes = kernel.planes(&reference.extent());
        let places = kernel.places(grid, kernel.middle(planes));
        let count = 1 | (1 + u64::from(reference.is_pair())) << 32;
        for (axis, place) in places.into_iter().enumerate() {
            let place = place as usize % MAX_BINS;
            let around = &mut self.around[place][axis];
            *around = kernel.extent(kernel.least(planes, kernel.planes(around)));
            self.counts[place][axis] += count;
        }
    }

    pub(super) fn unite(&mut self, other: &Bins, grid: &Grid) {
        for bin in 0..grid.bins {
            for axis in 0..3 {
                self.around[bin][axis] = self.around[bin][axis].union(other.around[bin][axis]);
                self.counts[bin][axis] += other.counts[bin][axis];
            }
        }
    }

    /// The split of least cost, which is area times leaves on each side, of `2^leaf_bits` things at most; none if all lie in one
    /// bin.
    #[inline(always)]
    pub(super) fn best<K: BuildKernel>(&self, kernel: K, grid: &Grid, leaf_bits: u32) -> Option<Split> {
        let leaves = |count: u64| (((count >> 32) as u32 + (1 << leaf_bits) - 1) >> leaf_bits) as f32;
        let nothing = kernel.planes(&Extent::EMPTY);
        // What is empty costs infinity times zero, which is not a number.
        let mut right_costs = [[0.0; 3]; MAX_BINS];
        let (mut around, mut counts) = ([nothing; 3], [0; 3]);
        for bin in (1..grid.bins).rev() {
            for axis in 0..3 {
                around[axis] = kernel.least(kernel.planes(&self.around[bin][axis]), around[axis]);
                counts[axis] += self.counts[bin][axis];
                right_costs[bin][axis] = kernel.area(around[axis]) * leaves(counts[axis]);
            }
        }
        let (mut around, mut counts) = ([nothing; 3], [0; 3]);
        // Costs are not negative, and sort as their bits do; what is not a number comes after all.
        let infinite = u64::from(f32::INFINITY.to_bits()) << 32;
        let mut least = infinite;
        for (bin, right_costs) in right_costs.iter().enumerate().take(grid.bins).skip(1) {
            for axis in 0..3 {
                around[axis] = kernel.least(kernel.planes(&self.around[bin - 1][axis]), around[axis]);
                counts[axis] += self.counts[bin - 1][axis];
                let cost = kernel.area(around[axis]) * leaves(counts[axis]) + right_costs[axis];
                least = least.min(u64::from(cost.to_bits()) << 32 | (bin << 2 | axis) as u64);
            }
        }
        let split = Split { axis: least as usize & 3, bin: least as u32 as usize >> 2 };
        (least < infinite).then_some(split)
    }

    /// How many a split sends to the left.
    pub(super) fn on_left(&self, split: Split) -> usize {
        self.counts[..split.bin].iter().map(|counts| counts[split.axis]).sum::<u64>() as u32 as usize
    }

    /// The boxes on either side of a split.
    pub(super) fn around(&self, grid: &Grid, split: Split) -> [Extent; 2] {
        let (left, right) = self.around[..grid.bins].split_at(split.bin);
        [left, right].map(|side| side.iter().fold(Extent::EMPTY, |around, bin| around.union(bin[split.axis])))
    }
}

impl Split {
    /// Copies each reference to its side, which must have the right size; the boxes around twice the middles of either.
    #[inline(always)]
    pub(super) fn partition<K: BuildKernel>(
        self,
        kernel: K,
        grid: &Grid,
        references: &[Reference],
        left: &mut [Reference],
        right: &mut [Reference],
    ) -> [Extent; 2] {
        let (mut on_left, mut on_right) = (0, 0);
        let mut middles = [kernel.planes(&Extent::EMPTY); 2];
        for reference in references {
            let middle = kernel.middle(kernel.planes(&reference.extent()));
            let (is_left, [left_middle, right_middle]) = kernel.sides(grid, self, middle);
            // Without a branch, which nobody could foresee: to both sides, of which one is written again.
            if let Some(slot) = left.get_mut(on_left) {
                *slot = *reference;
            }
            if let Some(slot) = right.get_mut(on_right) {
                *slot = *reference;
            }
            on_left += usize::from(is_left);
            on_right += usize::from(!is_left);
            middles[0] = kernel.least(left_middle, middles[0]);
            middles[1] = kernel.least(right_middle, middles[1]);
        }
        middles.map(|planes| kernel.extent(planes))
    }
}
