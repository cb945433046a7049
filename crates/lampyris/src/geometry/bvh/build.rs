//! Building a tree: references are split in two, and again in two (see [`Bins`]); the binary tree is then collapsed to
//! one of eight boxes a node, at the least cost.

use rayon::prelude::*;

use super::bins::{Bins, Grid, Range, Split};
use super::collapse::{Binary, Costs, Forest, Parts};
use super::kernel::{BuildKernel, Isa};
use super::pages::Pages;
use super::reference::{Extent, ROW, Reference, References};
use super::{Contents, Tree};

/// Levels of the deepest binary tree, and so of the deepest tree.
pub(super) const MAX_DEPTH: usize = 128;
/// The level from which on ranges are split in the middle, so that the rest has no more levels than bits.
const HALVE: usize = MAX_DEPTH - 33;
/// References up to which one thread builds and collapses a part of a tree.
const PART: usize = 1 << 13;

impl Tree {
    /// A tree over `references` with at most `2^leaf_bits` things in a leaf; with what is in the leaves. None over nothing.
    pub(in super::super) fn build(references: References, leaf_bits: u32) -> Option<(Tree, Contents)> {
        match Isa::best() {
            Isa::Portable(kernel) => Tree::build_with(kernel, references, leaf_bits),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(kernel) => Tree::build_with(kernel, references, leaf_bits),
        }
    }

    pub(super) fn build_with<K: BuildKernel>(
        kernel: K,
        references: References,
        leaf_bits: u32,
    ) -> Option<(Tree, Contents)> {
        let mut numbers = vec![0; references.len()];
        if numbers.is_empty() {
            return None;
        }
        let mut forest = Forest::default();
        TopBuilder { kernel, leaf_bits }.build_all(references, &mut numbers).plant(&mut forest, kernel);
        let Parts { nodes, leaves, depth } = Parts::collapse(&forest);
        Some((Tree { nodes, depth, isa: Isa::best() }, Contents { numbers, leaves }))
    }
}

/// Space in which references are sorted.
struct Work<'a> {
    from: &'a mut [Reference],
    /// As many that are written before they are read.
    to: &'a mut [Reference],
    /// Their numbers in the order of the leaves.
    numbers: &'a mut [u32],
}

impl<'a> Work<'a> {
    fn split_at(self, count: usize) -> [Work<'a>; 2] {
        let (from, right_from) = self.from.split_at_mut(count);
        let (to, right_to) = self.to.split_at_mut(count);
        let (numbers, right_numbers) = self.numbers.split_at_mut(count);
        [Work { from, to, numbers }, Work { from: right_from, to: right_to, numbers: right_numbers }]
    }

    /// After references were moved.
    fn swapped(self) -> Work<'a> {
        Work { from: self.to, to: self.from, numbers: self.numbers }
    }
}

/// The top of the binary tree, below which each part was built by one thread.
enum Top {
    Two(Box<[Top; 2]>),
    Part(Vec<Binary>, Costs, usize),
}

impl Top {
    /// Appends itself to the forest, and after it the parts.
    fn plant<K: BuildKernel>(self, forest: &mut Forest, kernel: K) -> (u32, Costs) {
        match self {
            Top::Part(part, costs, references) => (forest.push_part(part, references), costs),
            Top::Two(two) => {
                let [(left, a), (right, b)] = two.map(|half| half.plant(forest, kernel));
                let around = forest.top[left as usize].around().union(forest.top[right as usize].around());
                let (costs, shares) = kernel.costs(around.area(), &a, &b);
                (Binary::push_parent(&mut forest.top, around, left, shares), costs)
            }
        }
    }
}

/// Splits what is worth all threads.
#[derive(Clone, Copy)]
struct TopBuilder<K> {
    kernel: K,
    leaf_bits: u32,
}

impl<K: BuildKernel> TopBuilder<K> {
    fn build_all(self, mut references: References, numbers: &mut [u32]) -> Top {
        let rows = references.rows();
        let range = Range::of_rows(&rows);
        let mut other = Pages::zeroed(range.count);
        if range.count > PART
            && let Some([left, right]) = self.split(&rows, &mut other, &range)
        {
            return self.build_both(Work { from: &mut other, to: references.space(), numbers }, [left, right], 0);
        }
        self.build(Work { from: references.pack(), to: &mut other, numbers }, range, 0)
    }

    fn build(self, work: Work, range: Range, level: usize) -> Top {
        if range.count <= PART {
            let TopBuilder { kernel, leaf_bits } = self;
            let (binary, bins) = (Vec::with_capacity(range.count), Bins::empty());
            let mut builder = PartBuilder { kernel, leaf_bits, bins, binary, numbers: work.numbers, numbered: 0 };
            let (_, costs) = builder.add(work.from, work.to, range, level);
            return Top::Part(builder.binary, costs, range.count);
        }
        let rows: Vec<&[Reference]> = work.from.chunks(ROW).collect();
        let split = if level < HALVE { self.split(&rows, work.to, &range) } else { None };
        match split {
            Some(sides) => self.build_both(work.swapped(), sides, level),
            None => {
                let (left, right) = rows.split_at(rows.len() / 2);
                let sides = [Range::of_rows(left), Range::of_rows(right)];
                self.build_both(work, sides, level)
            }
        }
    }

    /// Builds both sides of what was split.
    fn build_both(self, work: Work, [left, right]: [Range; 2], level: usize) -> Top {
        let [a, b] = work.split_at(left.count);
        let (a, b) = rayon::join(|| self.build(a, left, level + 1), || self.build(b, right, level + 1));
        Top::Two(Box::new([a, b]))
    }

    /// Sorts references to two sides, at the best split if there is any.
    fn split(self, rows: &[&[Reference]], to: &mut [Reference], range: &Range) -> Option<[Range; 2]> {
        let grid = Grid::new(range);
        let of_row = |row: &&[Reference]| {
            let mut bins = Bins::empty();
            self.kernel.fill(&mut bins, row, &grid);
            bins
        };
        let bins: Vec<Bins> = rows.par_iter().map(of_row).collect();
        let mut all = Bins::empty();
        bins.iter().for_each(|bins| all.unite(bins, &grid));
        let split = self.kernel.best(&all, &grid, self.leaf_bits)?;
        let on_left = all.on_left(split);
        let (mut left, mut right) = to.split_at_mut(on_left);
        let mut moves = Vec::with_capacity(rows.len());
        for (row, bins) in rows.iter().zip(&bins) {
            let count = bins.on_left(split);
            let (own_left, other_left) = left.split_at_mut(count);
            let (own_right, other_right) = right.split_at_mut(row.len() - count);
            moves.push((row, own_left, own_right));
            (left, right) = (other_left, other_right);
        }
        let [a, b] = moves
            .into_par_iter()
            .map(|(row, left, right)| self.kernel.partition(split, &grid, row, left, right))
            .reduce(|| [Extent::EMPTY; 2], |[a, b], [c, d]| [a.union(c), b.union(d)]);
        let [left, right] = all.around(&grid, split);
        let left = Range { count: on_left, around: left, middles: a };
        let right = Range { count: range.count - on_left, around: right, middles: b };
        Some([left, right])
    }
}

/// Builds a part of the binary tree.
struct PartBuilder<'a, K> {
    kernel: K,
    leaf_bits: u32,
    bins: Bins,
    binary: Vec<Binary>,
    numbers: &'a mut [u32],
    /// How many of them were written.
    numbered: usize,
}

impl<K: BuildKernel> PartBuilder<'_, K> {
    /// Appends the tree over `from`; the place of its root, which is its last, and what it costs.
    fn add(&mut self, from: &mut [Reference], to: &mut [Reference], range: Range, level: usize) -> (u32, Costs) {
        let room = 1 << self.leaf_bits;
        if from.len() <= room && from.len() + from.iter().filter(|reference| reference.is_pair()).count() <= room {
            let first = self.numbered;
            self.numbered += from.len();
            for (number, reference) in self.numbers[first..self.numbered].iter_mut().zip(from.iter()) {
                *number = Contents::number(reference);
            }
            let place = Binary::push_leaf(&mut self.binary, range.around, first, from.len());
            return (place, Costs::of_leaf(range.around));
        }
        let grid = Grid::new(&range);
        let mut split = None;
        if level < HALVE {
            self.kernel.fill(&mut self.bins, from, &grid);
            split = self.kernel.best(&self.bins, &grid, self.leaf_bits);
        }
        let ((left, a), (_, b)) = match split {
            Some(split) => self.add_split(from, to, &grid, split, level),
            None => {
                let middle = from.len() / 2;
                let (left, right) = from.split_at_mut(middle);
                let (left_to, right_to) = to.split_at_mut(middle);
                let (a, b) = (Range::of(left), Range::of(right));
                (self.add(left, left_to, a, level + 1), self.add(right, right_to, b, level + 1))
            }
        };
        let (costs, shares) = self.kernel.costs(range.around.area(), &a, &b);
        (Binary::push_parent(&mut self.binary, range.around, left, shares), costs)
    }

    fn add_split(
        &mut self,
        from: &mut [Reference],
        to: &mut [Reference],
        grid: &Grid,
        split: Split,
        level: usize,
    ) -> ((u32, Costs), (u32, Costs)) {
        let middle = self.bins.on_left(split);
        let (left, right) = to.split_at_mut(middle);
        let [a, b] = self.kernel.partition(split, grid, from, left, right);
        let [left_around, right_around] = self.bins.around(grid, split);
        let a = Range { count: left.len(), around: left_around, middles: a };
        let b = Range { count: right.len(), around: right_around, middles: b };
        let (left_to, right_to) = from.split_at_mut(middle);
        (self.add(left, left_to, a, level + 1), self.add(right, right_to, b, level + 1))
    }
}
