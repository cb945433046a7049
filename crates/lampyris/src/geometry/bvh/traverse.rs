//! The way of a ray through a tree, nearest boxes first.

use arrayvec::ArrayVec;
use glam::Vec3;

use super::kernel::{Isa, Kernel};
use super::{LEAF, Node, Tree, WIDTH};
use crate::geometry::Ray;

/// A ray as boxes meet it.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct BoxRay {
    pub(super) origin: [f32; 3],
    pub(super) inverse: [f32; 3],
    /// The rows of a node at which the ray enters boxes, and at which it leaves them.
    pub(super) enter: [usize; 3],
    pub(super) leave: [usize; 3],
}

/// What is in the leaves of a tree.
pub(in super::super) trait Leaves {
    /// Looks in a leaf for something not beyond `limit`; the new limit, which is no greater.
    fn closest<K: Kernel>(&mut self, kernel: K, leaf: u32, limit: f32) -> f32;

    /// Whether there is something in a leaf not beyond `limit`.
    fn any<K: Kernel>(&mut self, kernel: K, leaf: u32, limit: f32) -> bool;

    /// Tells the memory that a leaf will be looked into.
    fn prefetch<K: Kernel>(&self, kernel: K, leaf: u32);
}

/// What a ray's distances to boxes are stretched by, so that no box is missed by rounding: one that is computed of two
/// differences and a product is wrong by less than three halves of f32's epsilon, and two such are compared [Ize 2013];
/// the rest is for the distances to triangles.
pub(super) const STRETCH: f32 = 1.0 + 8.0 * f32::EPSILON;

/// Levels up to which the small stack suffices: every level leaves at most all boxes but one.
const SHALLOW: usize = 18;
const SMALL_STACK: usize = SHALLOW * (WIDTH - 1) + 1;
/// Enough for the deepest tree that is built.
const LARGE_STACK: usize = super::build::MAX_DEPTH * (WIDTH - 1) + 1;

impl BoxRay {
    /// None of a ray that goes nowhere, or not from anywhere.
    #[inline]
    pub(in super::super) fn new(ray: &Ray) -> Option<BoxRay> {
        let finite = (ray.origin + ray.direction).is_finite() && ray.direction.is_finite();
        if !finite || ray.direction == Vec3::ZERO {
            return None;
        }
        let inverse = ray.direction.recip().to_array();
        let enter = [0, 1, 2].map(|axis| if inverse[axis] < 0.0 { axis + 3 } else { axis });
        let leave = [0, 1, 2].map(|axis| if inverse[axis] < 0.0 { axis } else { axis + 3 });
        Some(BoxRay { origin: ray.origin.to_array(), inverse, enter, leave })
    }
}

impl Tree {
    /// Shows a ray the leaves that it may meet before `limit`, which shrinks as they answer.
    #[inline]
    pub(in super::super) fn closest(&self, ray: &BoxRay, limit: f32, leaves: &mut impl Leaves) {
        match (self.isa, self.depth <= SHALLOW) {
            (Isa::Portable(kernel), true) => closest::<_, _, SMALL_STACK>(kernel, &self.nodes, ray, limit, leaves),
            (Isa::Portable(kernel), false) => closest::<_, _, LARGE_STACK>(kernel, &self.nodes, ray, limit, leaves),
            #[cfg(target_arch = "x86_64")]
            (Isa::Avx2(kernel), true) => kernel.closest::<_, SMALL_STACK>(&self.nodes, ray, limit, leaves),
            #[cfg(target_arch = "x86_64")]
            (Isa::Avx2(kernel), false) => kernel.closest::<_, LARGE_STACK>(&self.nodes, ray, limit, leaves),
        }
    }

    /// Whether there is something before `limit` in any leaf.
    #[inline]
    pub(in super::super) fn any(&self, ray: &BoxRay, limit: f32, leaves: &mut impl Leaves) -> bool {
        match (self.isa, self.depth <= SHALLOW) {
            (Isa::Portable(kernel), true) => any::<_, _, SMALL_STACK>(kernel, &self.nodes, ray, limit, leaves),
            (Isa::Portable(kernel), false) => any::<_, _, LARGE_STACK>(kernel, &self.nodes, ray, limit, leaves),
            #[cfg(target_arch = "x86_64")]
            (Isa::Avx2(kernel), true) => kernel.any::<_, SMALL_STACK>(&self.nodes, ray, limit, leaves),
            #[cfg(target_arch = "x86_64")]
            (Isa::Avx2(kernel), false) => kernel.any::<_, LARGE_STACK>(&self.nodes, ray, limit, leaves),
        }
    }
}

/// What waits on the stack: the bits of the distance above the child, so that nearer ones, and at the same distance
/// those of a lesser number, are the lesser numbers. (Distances are not negative, and so sort as their bits do.)
#[inline(always)]
fn waiting(distance: f32, child: u32) -> u64 {
    u64::from(distance.to_bits()) << 32 | u64::from(child)
}

#[inline(always)]
pub(super) fn closest<K: Kernel, L: Leaves, const STACK: usize>(
    kernel: K,
    nodes: &[Node],
    ray: &BoxRay,
    limit: f32,
    leaves: &mut L,
) {
    let mut limit = limit;
    let mut stack = ArrayVec::<u64, STACK>::new();
    let mut here = 0;
    loop {
        while here & LEAF == 0 {
            let node = &nodes[here as usize];
            let (mut met, enter) = kernel.boxes(node, ray, limit);
            if met == 0 {
                break;
            }
            let mut next = || {
                let index = met.trailing_zeros() as usize % WIDTH;
                met &= met - 1;
                (waiting(enter[index], node.children[index]), met == 0)
            };
            let (mut nearest, last) = next();
            if !last {
                // All but the nearest wait, sorted, the farthest at the bottom.
                let bottom = stack.len();
                loop {
                    let (mut other, last) = next();
                    if other < nearest {
                        std::mem::swap(&mut other, &mut nearest);
                    }
                    let mut place = stack.len();
                    stack.push(other);
                    while place > bottom && stack[place - 1] < other {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = other;
                    prefetch(kernel, nodes, leaves, other as u32);
                    if last {
                        break;
                    }
                }
            }
            here = nearest as u32;
        }
        if here & LEAF != 0 {
            limit = leaves.closest(kernel, here & !LEAF, limit);
        }
        // The next that is not beyond what was found since it began to wait.
        loop {
            let Some(next) = stack.pop() else { return };
            if f32::from_bits((next >> 32) as u32) <= limit * STRETCH {
                here = next as u32;
                break;
            }
        }
    }
}

#[inline(always)]
pub(super) fn any<K: Kernel, L: Leaves, const STACK: usize>(
    kernel: K,
    nodes: &[Node],
    ray: &BoxRay,
    limit: f32,
    leaves: &mut L,
) -> bool {
    let mut stack = ArrayVec::<u32, STACK>::new();
    stack.push(0);
    while let Some(here) = stack.pop() {
        if here & LEAF != 0 {
            if leaves.any(kernel, here & !LEAF, limit) {
                return true;
            }
            continue;
        }
        let node = &nodes[here as usize];
        let (mut met, _) = kernel.boxes(node, ray, limit);
        while met != 0 {
            let child = node.children[met.trailing_zeros() as usize % WIDTH];
            met &= met - 1;
            stack.push(child);
            prefetch(kernel, nodes, leaves, child);
        }
    }
    false
}

#[inline(always)]
fn prefetch<K: Kernel, L: Leaves>(kernel: K, nodes: &[Node], leaves: &L, child: u32) {
    if child & LEAF != 0 {
        leaves.prefetch(kernel, child & !LEAF);
    } else if let Some(node) = nodes.get(child as usize) {
        kernel.prefetch(node);
    }
}
