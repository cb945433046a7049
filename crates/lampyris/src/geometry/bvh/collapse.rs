//! From a binary tree to one of eight boxes a node, at the least cost [Ylitie, Karras and Laine 2017, §3.1].

use rayon::prelude::*;

use super::build::Extent;
use super::{LEAF, Leaf, Node, WIDTH};

/// A node of a binary tree, which lies behind its children.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binary {
    around: Extent,
    content: Content,
    /// `costs[n - 1]` is the cost of all below it, if it takes up to `n` boxes of a node: visits of nodes and leaves,
    /// weighted by area.
    costs: [f32; WIDTH - 1],
    /// How many of `n` boxes then go to the left, at `n - 1`; 0 if one box around all is best. The last is for its own
    /// node.
    to_left: [u8; WIDTH],
}

#[derive(Clone, Copy, Debug)]
enum Content {
    Leaf(Leaf),
    Two(u32, u32),
    /// The root of a part of the forest.
    Part(u32),
}

/// A binary tree in parts.
#[derive(Debug, Default)]
pub(super) struct Forest {
    /// The top of it, with the root as its last; its leaves are the roots of the parts.
    pub(super) top: Vec<Binary>,
    /// Each with its root as its last.
    parts: Vec<Vec<Binary>>,
}

/// A place in one of a forest's trees.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// None for the top.
    part: Option<u32>,
    index: u32,
}

impl Forest {
    /// Adds a part, which must not be empty; its place in the top.
    pub(super) fn push_part(&mut self, part: Vec<Binary>) -> u32 {
        let root = part[part.len() - 1];
        self.top.push(Binary { content: Content::Part(self.parts.len() as u32), ..root });
        self.parts.push(part);
        (self.top.len() - 1) as u32
    }

    fn at(&self, place: Place) -> &Binary {
        let tree = place.part.map_or(&self.top, |part| &self.parts[part as usize]);
        &tree[place.index as usize]
    }

    /// Appends to `boxes` what becomes boxes of one node, if there is room for `room`.
    fn gather(&self, place: Place, room: usize, boxes: &mut Vec<Place>) {
        let own = self.at(place);
        let share = usize::from(own.to_left[room - 1]);
        match own.content {
            Content::Part(part) => self.gather(self.root(part), room, boxes),
            Content::Two(left, right) if share > 0 => {
                self.gather(Place { index: left, ..place }, share, boxes);
                self.gather(Place { index: right, ..place }, room - share, boxes);
            }
            _ => boxes.push(place),
        }
    }

    fn root(&self, part: u32) -> Place {
        Place { part: Some(part), index: self.parts[part as usize].len() as u32 - 1 }
    }
}

impl Binary {
    /// Appends a leaf; its place.
    pub(super) fn push_leaf(tree: &mut Vec<Binary>, around: Extent, leaf: Leaf) -> u32 {
        let costs = [around.area(); WIDTH - 1];
        tree.push(Binary { around, content: Content::Leaf(leaf), costs, to_left: [0; WIDTH] });
        (tree.len() - 1) as u32
    }

    /// Appends the node over two that are in the tree; its place.
    pub(super) fn push_parent(tree: &mut Vec<Binary>, left: u32, right: u32) -> u32 {
        let [a, b] = [left, right].map(|child| &tree[child as usize]);
        let around = a.around.union(b.around);
        let (mut costs, mut to_left) = ([0.0; WIDTH], [0; WIDTH]);
        for boxes in 2..=WIDTH {
            let mut least = f32::INFINITY;
            for share in 1..boxes {
                let cost = a.costs[share - 1] + b.costs[boxes - share - 1];
                if cost < least {
                    (least, to_left[boxes - 1]) = (cost, share as u8);
                }
            }
            costs[boxes - 1] = least;
        }
        // Infinite costs of huge boxes tell nothing apart.
        to_left[WIDTH - 1] = to_left[WIDTH - 1].max(1);
        // In one box there is a node of its own.
        let single = around.area() + costs[WIDTH - 1];
        for boxes in 1..WIDTH {
            if boxes == 1 || single <= costs[boxes - 1] {
                (costs[boxes - 1], to_left[boxes - 1]) = (single, 0);
            }
        }
        let costs = std::array::from_fn(|index| costs[index]);
        tree.push(Binary { around, content: Content::Two(left, right), costs, to_left });
        (tree.len() - 1) as u32
    }
}

/// Nodes and leaves of a tree, or of a part of one that are numbered from its start. The first node is the root.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<Leaf>,
    /// Levels of nodes.
    pub(super) depth: usize,
}

/// The bit of a child whose nodes are made apart.
const APART: u32 = 1 << 30;

impl Parts {
    /// The nodes of a forest's tree, which must not be empty.
    pub(super) fn collapse(forest: &Forest) -> Parts {
        let root = Place { part: None, index: forest.top.len() as u32 - 1 };
        if let Content::Part(part) = forest.at(root).content {
            return Parts::below(forest, forest.root(part), &mut Vec::new());
        }
        let mut apart = Vec::new();
        let top = Parts::below(forest, root, &mut apart);
        top.join(apart.into_par_iter().map(|place| Parts::below(forest, place, &mut Vec::new())).collect())
    }

    /// The nodes of what is below a place in the same part of the forest. What is in other parts is left to be made
    /// `apart`.
    fn below(forest: &Forest, place: Place, apart: &mut Vec<Place>) -> Parts {
        let mut parts = Parts { nodes: vec![Node::empty()], leaves: Vec::new(), depth: 0 };
        parts.fill(forest, place, 0, 0, apart);
        parts
    }

    /// Fills a node with what is below a place, its leaves and nodes side by side.
    fn fill(&mut self, forest: &Forest, place: Place, node: usize, level: usize, apart: &mut Vec<Place>) {
        self.depth = self.depth.max(level + 1);
        let mut boxes = Vec::with_capacity(WIDTH);
        forest.gather(place, WIDTH, &mut boxes);
        let first = self.nodes.len();
        let mut below = Vec::with_capacity(WIDTH);
        for (index, &inside) in boxes.iter().enumerate() {
            let Binary { around, content, .. } = forest.at(inside);
            let child = if let Content::Leaf(leaf) = content {
                self.leaves.push(*leaf);
                (self.leaves.len() - 1) as u32 | LEAF
            } else if inside.part == place.part {
                below.push(inside);
                (first + below.len() - 1) as u32
            } else {
                apart.push(inside);
                (apart.len() - 1) as u32 | APART
            };
            self.nodes[node].set(index, around.bounds(), child);
        }
        self.nodes.resize(first + below.len(), Node::empty());
        for (index, &inside) in below.iter().enumerate() {
            self.fill(forest, inside, first + index, level + 1, apart);
        }
    }

    /// Puts what was made `apart` in its place.
    fn join(mut self, apart: Vec<Parts>) -> Parts {
        let count = |of: fn(&Parts) -> usize| apart.iter().map(of).sum::<usize>();
        let mut starts = Vec::with_capacity(apart.len());
        let mut start = self.nodes.len();
        for part in &apart {
            starts.push(start as u32);
            start += part.nodes.len();
        }
        for child in self.nodes.iter_mut().flat_map(|node| &mut node.children) {
            if *child & (LEAF | APART) == APART {
                *child = starts[(*child & !APART) as usize];
            }
        }
        self.nodes.reserve_exact(count(|part| part.nodes.len()));
        self.leaves.reserve_exact(count(|part| part.leaves.len()));
        self.depth += apart.iter().map(|part| part.depth).max().unwrap_or(0);
        for (part, start) in apart.into_iter().zip(starts) {
            let leaves = self.leaves.len() as u32;
            self.leaves.extend(part.leaves);
            self.nodes.extend(part.nodes.into_iter().map(|mut node| {
                for child in &mut node.children {
                    *child += if *child & LEAF != 0 { leaves } else { start };
                }
                node
            }));
        }
        self
    }
}
