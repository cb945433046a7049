//! From a binary tree to one of eight boxes a node, at the least cost [Ylitie, Karras and Laine 2017, §3.1].

use rayon::prelude::*;

use super::pages::Pages;
use super::reference::Extent;
use super::{LEAF, Leaf, Node, WIDTH};

/// A node of a binary tree, which lies behind its children, the right one just before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binary {
    /// As in [`Extent`], without those that tell nothing.
    planes: [f32; 6],
    /// The left child; or a leaf, its first reference and how many there are; or the root of a part of the forest.
    inside: u32,
    /// How many of `n` boxes of a node go to the left, for `n` from 1 on, each in [`SHARE`] bits; 0 if one box around
    /// all is best. The last is for its own node.
    shares: u32,
}

const SHARE: u32 = 3;
/// Bits of a leaf's number of references.
const COUNT: u32 = 3;

/// What is in a [`Binary`].
enum Content {
    Leaf(Leaf),
    Two(u32, u32),
    Part(u32),
}

/// `0[n - 1]` is the cost of all below a node of a binary tree, if it takes up to `n` boxes: visits of nodes and leaves,
/// weighted by area. The last is infinite.
#[derive(Clone, Copy, Debug)]
pub(super) struct Costs([f32; WIDTH]);

impl Costs {
    pub(super) fn of_leaf(around: Extent) -> Costs {
        let mut costs = [around.area(); WIDTH];
        costs[WIDTH - 1] = f32::INFINITY;
        Costs(costs)
    }

    /// Of a node with this area around two others, and its shares.
    #[inline(always)]
    pub(super) fn around(area: f32, a: &Costs, b: &Costs) -> (Costs, u32) {
        // From the place `WIDTH` on, so that what is before it, and not there, costs too much.
        let mut right = [f32::INFINITY; 2 * WIDTH];
        right[WIDTH..].copy_from_slice(&b.0);
        let (mut costs, mut to_left) = ([f32::INFINITY; WIDTH], [0_u32; WIDTH]);
        for share in 1..WIDTH {
            let right = &right[WIDTH - share..][..WIDTH];
            for index in 0..WIDTH {
                let cost = a.0[share - 1] + right[index];
                let is_less = cost < costs[index];
                costs[index] = if is_less { cost } else { costs[index] };
                to_left[index] = if is_less { share as u32 } else { to_left[index] };
            }
        }
        // In one box there is a node of its own.
        let single = area + costs[WIDTH - 1];
        // Infinite costs of huge boxes tell nothing apart.
        let own = to_left[WIDTH - 1].max(1);
        for index in 0..WIDTH {
            let is_single = index == 0 || single <= costs[index];
            costs[index] = if is_single { single } else { costs[index] };
            to_left[index] = if is_single { 0 } else { to_left[index] };
        }
        costs[WIDTH - 1] = f32::INFINITY;
        to_left[WIDTH - 1] = own;
        let shares = (0..).zip(to_left).fold(0, |shares, (index, share)| shares | share << (SHARE * index));
        (Costs(costs), shares)
    }
}

/// A binary tree in parts.
#[derive(Debug, Default)]
pub(super) struct Forest {
    /// The top of it, with the root as its last; its leaves are the roots of the parts.
    pub(super) top: Vec<Binary>,
    parts: Vec<Part>,
    /// References of all parts.
    references: u32,
}

#[derive(Debug)]
struct Part {
    /// With its root as its last.
    tree: Vec<Binary>,
    /// Its first reference.
    first: u32,
}

/// A place in one of a forest's trees.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// None for the top.
    part: Option<u32>,
    index: u32,
}

/// The boxes of a node.
struct Boxes {
    count: usize,
    places: [Place; WIDTH],
}

/// The bit that tells roots of parts, and children whose nodes are made apart.
const APART: u32 = 1 << 30;

impl Forest {
    /// Adds a part with so many references, which must not be empty; its place in the top.
    pub(super) fn push_part(&mut self, tree: Vec<Binary>, references: usize) -> u32 {
        let root = tree[tree.len() - 1];
        self.top.push(Binary { inside: self.parts.len() as u32 | APART, ..root });
        self.parts.push(Part { tree, first: self.references });
        self.references += references as u32;
        (self.top.len() - 1) as u32
    }

    fn at(&self, place: Place) -> &Binary {
        let tree = place.part.map_or(&self.top, |part| &self.parts[part as usize].tree);
        &tree[place.index as usize]
    }

    fn content(&self, place: Place) -> Content {
        let inside = self.at(place).inside;
        if inside & LEAF != 0 {
            let first = place.part.map_or(0, |part| self.parts[part as usize].first);
            Content::Leaf(Leaf { first: first + ((inside & !LEAF) >> COUNT), count: inside & ((1 << COUNT) - 1) })
        } else if inside & APART != 0 {
            Content::Part(inside & !APART)
        } else {
            Content::Two(inside, place.index - 1)
        }
    }

    /// Appends to `boxes` what becomes boxes of one node, if there is room for `room`.
    fn gather(&self, place: Place, room: usize, boxes: &mut Boxes) {
        let share = self.at(place).share(room);
        match self.content(place) {
            Content::Part(part) => self.gather(self.root(part), room, boxes),
            Content::Two(left, right) if share > 0 => {
                self.gather(Place { index: left, ..place }, share, boxes);
                self.gather(Place { index: right, ..place }, room - share, boxes);
            }
            _ => {
                boxes.places[boxes.count] = place;
                boxes.count += 1;
            }
        }
    }

    fn root(&self, part: u32) -> Place {
        Place { part: Some(part), index: self.parts[part as usize].tree.len() as u32 - 1 }
    }
}

impl Binary {
    fn new(around: Extent, inside: u32, shares: u32) -> Binary {
        let [x, y, z, _, to_x, to_y, to_z, _] = around.0;
        Binary { planes: [x, y, z, to_x, to_y, to_z], inside, shares }
    }

    /// Appends a leaf; its place.
    pub(super) fn push_leaf(tree: &mut Vec<Binary>, around: Extent, first: usize, count: usize) -> u32 {
        tree.push(Binary::new(around, LEAF | (first as u32) << COUNT | count as u32, 0));
        (tree.len() - 1) as u32
    }

    /// Appends the node over two that are in the tree, the right one as its last; its place.
    pub(super) fn push_parent(tree: &mut Vec<Binary>, around: Extent, left: u32, shares: u32) -> u32 {
        tree.push(Binary::new(around, left, shares));
        (tree.len() - 1) as u32
    }

    pub(super) fn around(&self) -> Extent {
        let [x, y, z, to_x, to_y, to_z] = self.planes;
        Extent([x, y, z, 0.0, to_x, to_y, to_z, 0.0])
    }

    fn share(&self, room: usize) -> usize {
        (self.shares >> (SHARE * (room as u32 - 1))) as usize % WIDTH
    }
}

/// Nodes and leaves of a tree. The first node is the root.
#[derive(Debug)]
pub(super) struct Parts {
    pub(super) nodes: Pages<Node>,
    pub(super) leaves: Vec<Leaf>,
    /// Levels of nodes.
    pub(super) depth: usize,
}

/// Nodes and leaves of a part of a tree that are numbered from its start.
#[derive(Debug, Default)]
struct Below {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    depth: usize,
}

impl Parts {
    /// The nodes of a forest's tree, which must not be empty.
    pub(super) fn collapse(forest: &Forest) -> Parts {
        let root = Place { part: None, index: forest.top.len() as u32 - 1 };
        let mut apart = Vec::new();
        let top = match forest.content(root) {
            Content::Part(part) => Below::new(forest, forest.root(part), &mut apart),
            _ => Below::new(forest, root, &mut apart),
        };
        let below = |&place: &Place| Below::new(forest, place, &mut Vec::new());
        Parts::join(top, apart.par_iter().map(below).collect())
    }

    /// Puts what was made apart in its place.
    fn join(top: Below, apart: Vec<Below>) -> Parts {
        let depth = top.depth + apart.iter().map(|part| part.depth).max().unwrap_or(0);
        let all: Vec<Below> = std::iter::once(top).chain(apart).collect();
        let mut starts = Vec::with_capacity(all.len() + 1);
        let (mut node, mut leaf) = (0, 0);
        for part in &all {
            starts.push((node as u32, leaf as u32));
            node += part.nodes.len();
            leaf += part.leaves.len();
        }
        let (mut nodes, mut leaves) = (Pages::zeroed(node), vec![Leaf::default(); leaf]);
        let (mut nodes_left, mut leaves_left) = (&mut nodes[..], &mut leaves[..]);
        let mut moves = Vec::with_capacity(all.len());
        for (part, &start) in all.iter().zip(&starts) {
            let (own_nodes, other_nodes) = nodes_left.split_at_mut(part.nodes.len());
            let (own_leaves, other_leaves) = leaves_left.split_at_mut(part.leaves.len());
            moves.push((part, start, own_nodes, own_leaves));
            (nodes_left, leaves_left) = (other_nodes, other_leaves);
        }
        moves.into_par_iter().for_each(|(part, (first_node, first_leaf), nodes, leaves)| {
            leaves.copy_from_slice(&part.leaves);
            for (place, node) in nodes.iter_mut().zip(&part.nodes) {
                *place = *node;
                for child in &mut place.children {
                    *child = match *child {
                        leaf if leaf & LEAF != 0 => leaf + first_leaf,
                        // The first is the top.
                        root if root & APART != 0 => starts[(root & !APART) as usize + 1].0,
                        node => node + first_node,
                    };
                }
            }
        });
        Parts { nodes, leaves, depth }
    }
}

impl Below {
    /// The nodes of what is below a place in the same part of the forest. What is in other parts is left to be made
    /// `apart`.
    fn new(forest: &Forest, place: Place, apart: &mut Vec<Place>) -> Below {
        let mut below = Below { nodes: vec![Node::empty()], leaves: Vec::new(), depth: 0 };
        below.fill(forest, place, 0, 0, apart);
        below
    }

    /// Fills a node with what is below a place, its leaves and nodes side by side.
    fn fill(&mut self, forest: &Forest, place: Place, node: usize, level: usize, apart: &mut Vec<Place>) {
        self.depth = self.depth.max(level + 1);
        let mut boxes = Boxes { count: 0, places: [place; WIDTH] };
        forest.gather(place, WIDTH, &mut boxes);
        let first = self.nodes.len();
        let (mut below, mut count) = ([place; WIDTH], 0);
        for (index, &inside) in boxes.places[..boxes.count].iter().enumerate() {
            let child = if let Content::Leaf(leaf) = forest.content(inside) {
                self.leaves.push(leaf);
                (self.leaves.len() - 1) as u32 | LEAF
            } else if inside.part == place.part {
                below[count] = inside;
                count += 1;
                (first + count - 1) as u32
            } else {
                apart.push(inside);
                (apart.len() - 1) as u32 | APART
            };
            self.nodes[node].set(index, forest.at(inside).around().bounds(), child);
        }
        self.nodes.resize(first + count, Node::empty());
        for (index, &inside) in below[..count].iter().enumerate() {
            self.fill(forest, inside, first + index, level + 1, apart);
        }
    }
}
