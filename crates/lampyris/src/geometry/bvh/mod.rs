//! Bounding volume hierarchies: trees of boxes, eight to a node, by which rays find what they meet.
//!
//! A tree is the same on any number of threads, and what a ray finds in it has the same bits on any processor: all
//! kernels do the same operations in the same order, none contracted.

mod bins;
mod build;
mod collapse;
mod kernel;
mod packet;
mod pages;
mod portable;
mod quads;
mod reference;
#[cfg(test)]
mod tests;
mod traverse;
#[cfg(target_arch = "x86_64")]
mod x86;

use bytemuck::{Pod, Zeroable};

use super::Bounds;
pub(super) use kernel::{Isa, Kernel};
pub(super) use packet::{Best, Packet, TriangleRay};
pub(super) use pages::Pages;
#[cfg(test)]
pub(super) use portable::Portable;
pub(super) use quads::QuadPacket;
pub(super) use reference::{Reference, References};
pub(super) use traverse::{BoxRay, Leaves};

/// Boxes of a node.
const WIDTH: usize = 8;

/// Triangles of a packet.
pub(super) const LANES: usize = 4;

/// Up to eight boxes and what is in them.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Rows of the boxes' least x, y, z and greatest x, y, z. Boxes that are not there are empty, and no ray meets them.
    rows: [[f32; WIDTH]; 6],
    /// What is in the boxes: nodes, or leaves with [`LEAF`] set.
    children: [u32; WIDTH],
    /// Fills the last line of the processor's cache.
    _unused: [u32; WIDTH],
}

/// The bit that tells leaves from nodes.
const LEAF: u32 = 1 << 31;

/// A hierarchy whose leaves have numbers from 0; the first node is its root.
#[derive(Debug)]
pub(super) struct Tree {
    nodes: Pages<Node>,
    /// Levels of nodes.
    depth: usize,
    isa: Isa,
}

/// What is in the leaves of a tree.
#[derive(Debug)]
pub(super) struct Contents {
    /// Of the references, in the order of the tree, with [`TWO`] set for those to two things.
    numbers: Vec<u32>,
    pub(super) leaves: Vec<Leaf>,
}

/// The bit that tells that the next number belongs to a reference, too.
const TWO: u32 = 1 << 31;

/// The references, by place in the order the tree gave them, that lie in one leaf.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Leaf {
    first: u32,
    count: u32,
}

impl Contents {
    fn number(reference: &Reference) -> u32 {
        reference.number() | if reference.is_pair() { TWO } else { 0 }
    }

    /// The numbers of the things in a leaf.
    #[inline]
    pub(super) fn of(&self, leaf: &Leaf) -> impl Iterator<Item = u32> {
        let numbers = &self.numbers[leaf.first as usize..][..leaf.count as usize];
        numbers.iter().flat_map(|&number| (number & !TWO..).take(if number & TWO != 0 { 2 } else { 1 }))
    }
}

impl Node {
    fn empty() -> Node {
        let (none_least, none_greatest) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Node {
            rows: [none_least, none_least, none_least, none_greatest, none_greatest, none_greatest],
            children: [LEAF; WIDTH],
            _unused: [0; WIDTH],
        }
    }

    fn set(&mut self, index: usize, bounds: Bounds, child: u32) {
        for axis in 0..3 {
            self.rows[axis][index] = bounds.min[axis];
            self.rows[axis + 3][index] = bounds.max[axis];
        }
        self.children[index] = child;
    }

    fn bounds(&self, index: usize) -> Bounds {
        let corner = |first: usize| glam::Vec3::from_array([0, 1, 2].map(|axis| self.rows[first + axis][index]));
        Bounds { min: corner(0), max: corner(3) }
    }
}

impl Tree {
    /// The box around all.
    pub(super) fn bounds(&self) -> Bounds {
        (0..WIDTH)
            .map(|index| self.nodes[0].bounds(index))
            .filter(|bounds| !bounds.is_empty())
            .fold(Bounds::EMPTY, Bounds::union)
    }

    #[cfg(test)]
    pub(super) fn make_portable(&mut self) {
        self.isa = Isa::portable();
    }

    /// The bytes that its nodes take.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
    }

    /// What a random ray through the root's box costs on average, in tests of eight boxes or of one leaf, by the ratio
    /// of surface areas [Goldsmith and Salmon 1987].
    pub(super) fn cost(&self) -> f64 {
        let boxes = self.nodes.iter().flat_map(|node| (0..WIDTH).map(|index| node.bounds(index)));
        let areas = boxes.filter(|bounds| !bounds.is_empty()).map(half_area);
        1.0 + areas.sum::<f64>() / half_area(self.bounds()).max(f64::MIN_POSITIVE)
    }
}

fn half_area(bounds: Bounds) -> f64 {
    let extent = (bounds.max - bounds.min).as_dvec3();
    extent.x * extent.y + extent.y * extent.z + extent.z * extent.x
}
