//! Building a tree: references are split in two, and again in two, where the surface area heuristic over bins says
//! [Wald 2007]; the binary tree is then collapsed to one of eight boxes a node, at the least cost.

use glam::{Vec3, Vec3A, Vec4};
use rayon::prelude::*;

use super::collapse::{Binary, Forest, Parts};
use super::kernel::Isa;
use super::{Leaf, Pages, Tree};
use crate::geometry::Bounds;

/// The box of something with a number, in few bytes.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Reference {
    /// The fourth lane holds the bits of the number.
    least: Vec4,
    greatest: Vec4,
}

/// Levels of the deepest binary tree, and so of the deepest tree.
pub(super) const MAX_DEPTH: usize = 128;
/// The level from which on ranges are split in the middle, so that the rest has no more levels than bits.
const HALVE: usize = MAX_DEPTH - 33;
/// References up to which one thread builds and collapses a part of a tree.
const PART: usize = 1 << 13;
/// References that a thread bins at a time.
const CHUNK: usize = 1 << 12;
const MAX_BINS: usize = 32;

impl Reference {
    pub(in super::super) fn new(number: u32, bounds: Bounds) -> Reference {
        Reference { least: bounds.min.extend(f32::from_bits(number)), greatest: bounds.max.extend(0.0) }
    }

    #[inline]
    pub(in super::super) fn number(&self) -> u32 {
        self.least.w.to_bits()
    }

    #[inline]
    fn extent(&self) -> Extent {
        Extent { least: Vec3A::from_vec4(self.least), greatest: Vec3A::from_vec4(self.greatest) }
    }

    /// Twice the middle of its box.
    #[inline]
    fn middle(&self) -> Vec3A {
        Vec3A::from_vec4(self.least) + Vec3A::from_vec4(self.greatest)
    }
}

/// A box in registers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    least: Vec3A,
    greatest: Vec3A,
}

impl Extent {
    pub(super) const EMPTY: Extent = Extent { least: Vec3A::INFINITY, greatest: Vec3A::NEG_INFINITY };

    #[inline]
    pub(super) fn union(self, other: Extent) -> Extent {
        Extent { least: self.least.min(other.least), greatest: self.greatest.max(other.greatest) }
    }

    /// Half the surface area.
    #[inline]
    pub(super) fn area(self) -> f32 {
        let size = self.greatest - self.least;
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    pub(super) fn bounds(self) -> Bounds {
        Bounds { min: Vec3::from(self.least), max: Vec3::from(self.greatest) }
    }
}

/// References side by side, with the boxes around them and around twice their middles.
#[derive(Clone, Copy, Debug)]
struct Range {
    first: usize,
    count: usize,
    around: Extent,
    middles: Extent,
}

impl Tree {
    /// A tree over `references`, which it reorders, with at most `in_leaf` of them in a leaf; with the leaves. None over
    /// nothing.
    pub(in super::super) fn build(references: &mut [Reference], in_leaf: usize) -> Option<(Tree, Vec<Leaf>)> {
        if references.is_empty() {
            return None;
        }
        let range = Range::of(references, 0);
        let mut forest = Forest::default();
        top(references, range, 0, in_leaf).plant(&mut forest);
        let Parts { nodes, leaves, depth } = Parts::collapse(&forest);
        drop(forest);
        let nodes = Pages::from_each(&nodes, |node| *node);
        Some((Tree { nodes, depth, isa: Isa::best() }, leaves))
    }
}

/// The top of the binary tree, below which each part was built by one thread.
enum Top {
    Two(Box<[Top; 2]>),
    Part(Vec<Binary>),
}

impl Top {
    /// Appends itself to the forest; its place in the first tree.
    fn plant(self, forest: &mut Forest) -> u32 {
        match self {
            Top::Part(part) => forest.push_part(part),
            Top::Two(two) => {
                let [left, right] = two.map(|half| half.plant(forest));
                Binary::push_parent(&mut forest.top, left, right)
            }
        }
    }
}

fn top(references: &mut [Reference], range: Range, level: usize, in_leaf: usize) -> Top {
    if range.count <= PART {
        let mut builder = Builder { in_leaf, offset: range.first, bins: Bins::empty(), binary: Vec::new() };
        builder.add(references, range, level);
        return Top::Part(builder.binary);
    }
    let (left, right) = range.split(references, level, in_leaf, &mut Bins::empty());
    let (own, other) = references.split_at_mut(left.count);
    let (left, right) = rayon::join(|| top(own, left, level + 1, in_leaf), || top(other, right, level + 1, in_leaf));
    Top::Two(Box::new([left, right]))
}

/// Builds a part of the binary tree.
struct Builder {
    in_leaf: usize,
    /// The place of the part's first reference.
    offset: usize,
    bins: Bins,
    binary: Vec<Binary>,
}

impl Builder {
    /// Appends the tree over `range`; the place of its root, which is its last.
    fn add(&mut self, references: &mut [Reference], range: Range, level: usize) -> u32 {
        if range.count <= self.in_leaf {
            let leaf = Leaf { first: range.first as u32, count: range.count as u32 };
            Binary::push_leaf(&mut self.binary, range.around, leaf)
        } else {
            let own = &mut references[range.first - self.offset..][..range.count];
            let (left, right) = range.split(own, level, self.in_leaf, &mut self.bins);
            let left = self.add(references, left, level + 1);
            let right = self.add(references, right, level + 1);
            Binary::push_parent(&mut self.binary, left, right)
        }
    }
}

/// What lies in a bin along each axis.
#[derive(Clone)]
struct Bins {
    around: [[Extent; 3]; MAX_BINS],
    counts: [[u32; 3]; MAX_BINS],
}

/// Into which bin a middle falls, on each axis.
#[derive(Clone, Copy)]
struct Grid {
    least: Vec3A,
    scale: Vec3A,
    bins: usize,
}

/// Where to split: middles in bins below `bin` go to the left.
#[derive(Clone, Copy)]
struct Split {
    axis: usize,
    bin: usize,
}

impl Grid {
    fn new(range: &Range) -> Grid {
        let bins = (4 + range.count / 16).min(MAX_BINS);
        let size = range.middles.greatest - range.middles.least;
        // An axis without an extent has one bin.
        let scale = (0.9999 * bins as f32 / size).map(|x| if x.is_finite() { x } else { 0.0 });
        Grid { least: range.middles.least, scale, bins }
    }

    #[inline]
    fn places(&self, middle: Vec3A) -> [usize; 3] {
        let place = (middle - self.least) * self.scale;
        [place.x, place.y, place.z].map(|x| x as u32 as usize % MAX_BINS)
    }
}

impl Bins {
    fn empty() -> Bins {
        Bins { around: [[Extent::EMPTY; 3]; MAX_BINS], counts: [[0; 3]; MAX_BINS] }
    }

    /// Fills the bins of the grid, which may hold anything.
    fn fill(&mut self, references: &[Reference], grid: &Grid) {
        if references.len() > PART {
            let of_chunk = |chunk: &[Reference]| {
                let mut bins = Bins::empty();
                bins.add(chunk, grid);
                Box::new(bins)
            };
            let chunks = references.par_chunks(CHUNK).map(of_chunk).reduce_with(|mut a, b| {
                a.unite(&b, grid.bins);
                a
            });
            if let Some(bins) = chunks {
                *self = *bins;
            }
            return;
        }
        self.around[..grid.bins].fill([Extent::EMPTY; 3]);
        self.counts[..grid.bins].fill([0; 3]);
        self.add(references, grid);
    }

    fn add(&mut self, references: &[Reference], grid: &Grid) {
        for reference in references {
            let extent = reference.extent();
            let places = grid.places(extent.least + extent.greatest);
            for (axis, place) in places.into_iter().enumerate() {
                let around = &mut self.around[place][axis];
                *around = around.union(extent);
                self.counts[place][axis] += 1;
            }
        }
    }

    fn unite(&mut self, other: &Bins, bins: usize) {
        for bin in 0..bins {
            for axis in 0..3 {
                self.around[bin][axis] = self.around[bin][axis].union(other.around[bin][axis]);
                self.counts[bin][axis] += other.counts[bin][axis];
            }
        }
    }

    /// The split of least cost, which is area times leaves on each side; none if all lie in one bin.
    fn best(&self, bins: usize, in_leaf: usize) -> Option<Split> {
        let leaves = |count: u32| (count as usize).div_ceil(in_leaf) as f32;
        let mut right_costs = [[f32::INFINITY; 3]; MAX_BINS];
        let (mut around, mut counts) = ([Extent::EMPTY; 3], [0; 3]);
        for bin in (1..bins).rev() {
            for axis in 0..3 {
                around[axis] = around[axis].union(self.around[bin][axis]);
                counts[axis] += self.counts[bin][axis];
                if counts[axis] > 0 {
                    right_costs[bin][axis] = around[axis].area() * leaves(counts[axis]);
                }
            }
        }
        let (mut around, mut counts) = ([Extent::EMPTY; 3], [0; 3]);
        let (mut best, mut least) = (None, f32::INFINITY);
        for (bin, right_costs) in right_costs.iter().enumerate().take(bins).skip(1) {
            for axis in 0..3 {
                around[axis] = around[axis].union(self.around[bin - 1][axis]);
                counts[axis] += self.counts[bin - 1][axis];
                if counts[axis] > 0 {
                    let cost = around[axis].area() * leaves(counts[axis]) + right_costs[axis];
                    if cost < least {
                        least = cost;
                        best = Some(Split { axis, bin });
                    }
                }
            }
        }
        best
    }
}

impl Range {
    /// All of `references`.
    fn of(references: &[Reference], first: usize) -> Range {
        let part = |chunk: &[Reference]| {
            let mut range = Range { first, count: references.len(), around: Extent::EMPTY, middles: Extent::EMPTY };
            for reference in chunk {
                range.add(reference);
            }
            range
        };
        if references.len() <= CHUNK {
            return part(references);
        }
        let unite =
            |a: Range, b: Range| Range { around: a.around.union(b.around), middles: a.middles.union(b.middles), ..a };
        references.par_chunks(CHUNK).map(part).reduce_with(unite).unwrap_or_else(|| part(references))
    }

    #[inline]
    fn add(&mut self, reference: &Reference) {
        let middle = reference.middle();
        self.around = self.around.union(reference.extent());
        self.middles = self.middles.union(Extent { least: middle, greatest: middle });
    }

    /// Its two halves, sorted apart.
    fn split(&self, references: &mut [Reference], level: usize, in_leaf: usize, bins: &mut Bins) -> (Range, Range) {
        let grid = Grid::new(self);
        let split = if level < HALVE {
            bins.fill(references, &grid);
            bins.best(grid.bins, in_leaf)
        } else {
            None
        };
        match split {
            Some(Split { axis, bin }) => {
                let (least, scale, bin) = (grid.least[axis], grid.scale[axis], bin as u32);
                self.partition(references, |middle| (((middle[axis] - least) * scale) as u32) < bin)
            }
            None => {
                let (left, right) = references.split_at(references.len() / 2);
                (Range::of(left, self.first), Range::of(right, self.first + left.len()))
            }
        }
    }

    /// Moves those whose middles are on the left to the front.
    #[inline]
    fn partition(&self, references: &mut [Reference], is_left: impl Fn(Vec3A) -> bool) -> (Range, Range) {
        let empty = Range { first: self.first, count: 0, around: Extent::EMPTY, middles: Extent::EMPTY };
        let (mut left, mut right) = (empty, empty);
        let (mut front, mut back) = (0, references.len());
        loop {
            while front < back && is_left(references[front].middle()) {
                left.add(&references[front]);
                front += 1;
            }
            while front < back && !is_left(references[back - 1].middle()) {
                back -= 1;
                right.add(&references[back]);
            }
            if front >= back {
                break;
            }
            references.swap(front, back - 1);
        }
        left.count = front;
        right.count = references.len() - front;
        right.first = self.first + front;
        (left, right)
    }
}
