//! Building a tree from the top: what is left is split in two where the surface area heuristic over bins says, until a
//! node has eight boxes [Wald 2007; Wald, Benthin and Boulos 2008].

use glam::{Vec3, Vec3A, Vec4};
use rayon::prelude::*;

use super::kernel::Isa;
use super::{LEAF, Leaf, Node, Tree, WIDTH};
use crate::geometry::Bounds;

/// The box of something with a number, in few bytes.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Reference {
    /// The fourth lane holds the bits of the number.
    least: Vec4,
    greatest: Vec4,
}

/// Levels of the deepest tree.
pub(super) const MAX_DEPTH: usize = 96;
/// The level from which on ranges are split in the middle, so that the rest has no more levels than bits.
const HALVE: usize = MAX_DEPTH - 32;
/// References from which on children are built by several threads.
const PARALLEL: usize = 1 << 13;
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
struct Extent {
    least: Vec3A,
    greatest: Vec3A,
}

impl Extent {
    const EMPTY: Extent = Extent { least: Vec3A::INFINITY, greatest: Vec3A::NEG_INFINITY };

    #[inline]
    fn union(self, other: Extent) -> Extent {
        Extent { least: self.least.min(other.least), greatest: self.greatest.max(other.greatest) }
    }

    /// Half the surface area.
    #[inline]
    fn area(self) -> f32 {
        let size = self.greatest - self.least;
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    fn bounds(self) -> Bounds {
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
        let mut parts = Parts::default();
        branch(references, range, 0, in_leaf).flatten(&mut parts);
        let Parts { nodes, leaves, depth } = parts;
        Some((Tree { nodes, depth, isa: Isa::best() }, leaves))
    }
}

/// Nodes and leaves, numbered from the start of the part.
#[derive(Debug, Default)]
struct Parts {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    depth: usize,
}

/// A part of a tree before its place in the whole is known.
enum Branch {
    /// A node, and for each of its boxes what is in it.
    Node(Box<(Node, Vec<Branch>)>),
    /// Built by one thread; the first node is the root.
    Parts(Parts),
    Leaf(Leaf),
}

impl Branch {
    /// Appends itself to `parts`; what its parent calls it.
    fn flatten(self, parts: &mut Parts) -> u32 {
        match self {
            Branch::Leaf(leaf) => parts.push_leaf(leaf),
            Branch::Node(content) => {
                let (mut node, branches) = *content;
                let place = parts.nodes.len();
                parts.nodes.push(Node::empty());
                let depth = std::mem::take(&mut parts.depth);
                let mut deepest = 0;
                for (child, branch) in node.children.iter_mut().zip(branches) {
                    parts.depth = 0;
                    *child = branch.flatten(parts);
                    deepest = deepest.max(parts.depth);
                }
                parts.depth = depth.max(deepest + 1);
                parts.nodes[place] = node;
                place as u32
            }
            Branch::Parts(part) => {
                let (place, leaves) = (parts.nodes.len() as u32, parts.leaves.len() as u32);
                parts.leaves.extend(part.leaves);
                parts.nodes.extend(part.nodes.into_iter().map(|mut node| {
                    for child in &mut node.children {
                        *child += if *child & LEAF != 0 { leaves } else { place };
                    }
                    node
                }));
                parts.depth = parts.depth.max(part.depth);
                place
            }
        }
    }
}

impl Parts {
    fn push_leaf(&mut self, leaf: Leaf) -> u32 {
        self.leaves.push(leaf);
        (self.leaves.len() - 1) as u32 | LEAF
    }

    /// Appends the node over `range` and all below it; its number.
    fn push_node(
        &mut self,
        references: &mut [Reference],
        offset: usize,
        range: Range,
        level: usize,
        in_leaf: usize,
    ) -> u32 {
        let place = self.nodes.len();
        self.nodes.push(Node::empty());
        self.depth = self.depth.max(level + 1);
        let mut ranges = [range; WIDTH];
        let count = split_in_eight(&mut references[range.first - offset..][..range.count], &mut ranges, level, in_leaf);
        for (index, child) in ranges[..count].iter().enumerate() {
            let number = if child.count <= in_leaf {
                self.push_leaf(Leaf { first: child.first as u32, count: child.count as u32 })
            } else {
                self.push_node(references, offset, *child, level + 1, in_leaf)
            };
            self.nodes[place].set(index, child.around.bounds(), number);
        }
        place as u32
    }
}

/// The branch over `range`, which is what `references` are.
fn branch(references: &mut [Reference], range: Range, level: usize, in_leaf: usize) -> Branch {
    if range.count < PARALLEL {
        let mut parts = Parts::default();
        parts.push_node(references, range.first, range, level, in_leaf);
        parts.depth -= level;
        return Branch::Parts(parts);
    }
    let mut ranges = [range; WIDTH];
    let count = split_in_eight(references, &mut ranges, level, in_leaf);
    let ranges = &mut ranges[..count];
    ranges.sort_unstable_by_key(|child| child.first);
    let mut node = Node::empty();
    let mut rest = references;
    let mut tasks = Vec::with_capacity(count);
    for (index, child) in ranges.iter().enumerate() {
        node.set(index, child.around.bounds(), LEAF);
        let (own, others) = rest.split_at_mut(child.count);
        tasks.push((own, *child));
        rest = others;
    }
    let build = |(own, child): (&mut [Reference], Range)| {
        if child.count <= in_leaf {
            return Branch::Leaf(Leaf { first: child.first as u32, count: child.count as u32 });
        }
        branch(own, child, level + 1, in_leaf)
    };
    Branch::Node(Box::new((node, tasks.into_par_iter().map(build).collect())))
}

/// Splits the first of `ranges`, which is what `references` are, until there are eight or none can be split: always the
/// one of the largest area. How many there are.
fn split_in_eight(references: &mut [Reference], ranges: &mut [Range; WIDTH], level: usize, in_leaf: usize) -> usize {
    let offset = ranges[0].first;
    let mut count = 1;
    while count < WIDTH {
        let mut largest: Option<(usize, f32)> = None;
        for (index, range) in ranges[..count].iter().enumerate() {
            let area = range.around.area();
            if range.count > in_leaf && largest.is_none_or(|(_, before)| area > before) {
                largest = Some((index, area));
            }
        }
        let Some((index, _)) = largest else { break };
        let range = ranges[index];
        let (left, right) = range.split(&mut references[range.first - offset..][..range.count], level, in_leaf);
        ranges[index] = left;
        ranges[count] = right;
        count += 1;
    }
    count
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
    fn place(&self, middle: Vec3A) -> [usize; 3] {
        let place = (middle - self.least) * self.scale;
        [place.x, place.y, place.z].map(|x| (x as i32 as usize) % MAX_BINS)
    }
}

impl Bins {
    fn empty() -> Bins {
        Bins { around: [[Extent::EMPTY; 3]; MAX_BINS], counts: [[0; 3]; MAX_BINS] }
    }

    fn of(references: &[Reference], grid: &Grid) -> Bins {
        if references.len() > CHUNK {
            let parts = references.par_chunks(CHUNK).map(|chunk| Bins::of(chunk, grid));
            return parts.reduce_with(|a, b| a.union(&b, grid.bins)).unwrap_or_else(Bins::empty);
        }
        let mut bins = Bins::empty();
        for reference in references {
            let extent = reference.extent();
            let places = grid.place(extent.least + extent.greatest);
            for (axis, place) in places.into_iter().enumerate() {
                let around = &mut bins.around[place][axis];
                *around = around.union(extent);
                bins.counts[place][axis] += 1;
            }
        }
        bins
    }

    fn union(mut self, other: &Bins, bins: usize) -> Bins {
        for bin in 0..bins {
            for axis in 0..3 {
                self.around[bin][axis] = self.around[bin][axis].union(other.around[bin][axis]);
                self.counts[bin][axis] += other.counts[bin][axis];
            }
        }
        self
    }

    /// The split of least cost, which is area times leaves on each side; none if all lie in one bin.
    fn best(&self, bins: usize, in_leaf: usize) -> Option<Split> {
        let leaves = |count: u32| count.div_ceil(in_leaf as u32) as f32;
        let mut best = None;
        let mut least = f32::INFINITY;
        for axis in 0..3 {
            let mut right_costs = [0.0; MAX_BINS];
            let (mut right, mut count) = (Extent::EMPTY, 0);
            for bin in (1..bins).rev() {
                right = right.union(self.around[bin][axis]);
                count += self.counts[bin][axis];
                right_costs[bin] = if count == 0 { f32::INFINITY } else { right.area() * leaves(count) };
            }
            let (mut left, mut count) = (Extent::EMPTY, 0);
            for bin in 1..bins {
                left = left.union(self.around[bin - 1][axis]);
                count += self.counts[bin - 1][axis];
                if count == 0 {
                    continue;
                }
                let cost = left.area() * leaves(count) + right_costs[bin];
                if cost < least {
                    least = cost;
                    best = Some(Split { axis, bin });
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
        let union =
            |a: Range, b: Range| Range { around: a.around.union(b.around), middles: a.middles.union(b.middles), ..a };
        references.par_chunks(CHUNK).map(part).reduce_with(union).unwrap_or_else(|| part(references))
    }

    #[inline]
    fn add(&mut self, reference: &Reference) {
        let middle = reference.middle();
        self.around = self.around.union(reference.extent());
        self.middles = self.middles.union(Extent { least: middle, greatest: middle });
    }

    /// Its two halves, sorted apart.
    fn split(&self, references: &mut [Reference], level: usize, in_leaf: usize) -> (Range, Range) {
        let grid = Grid::new(self);
        let split = if level < HALVE { Bins::of(references, &grid).best(grid.bins, in_leaf) } else { None };
        match split {
            Some(Split { axis, bin }) => {
                self.partition(references, |reference| grid.place(reference.middle())[axis] < bin)
            }
            None => {
                let (left, right) = references.split_at(references.len() / 2);
                (Range::of(left, self.first), Range::of(right, self.first + left.len()))
            }
        }
    }

    /// Moves those that `is_left` to the front.
    #[inline]
    fn partition(&self, references: &mut [Reference], is_left: impl Fn(&Reference) -> bool) -> (Range, Range) {
        let empty = Range { first: self.first, count: 0, around: Extent::EMPTY, middles: Extent::EMPTY };
        let (mut left, mut right) = (empty, empty);
        let (mut front, mut back) = (0, references.len());
        while front < back {
            if is_left(&references[front]) {
                left.add(&references[front]);
                front += 1;
            } else {
                back -= 1;
                references.swap(front, back);
                right.add(&references[back]);
            }
        }
        left.count = front;
        right.count = references.len() - front;
        right.first = self.first + front;
        (left, right)
    }
}
