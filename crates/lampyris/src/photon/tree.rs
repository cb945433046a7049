//! A tree of boxes, to find those that a ray goes through.

use std::ops::Range;

use glam::Vec3;

use crate::geometry::{Bounds, Ray};

/// Boxes in a balanced tree, by their places in an order in which those of a leaf lie together. Equal boxes give an equal
/// tree, on any number of threads.
#[derive(Debug, Default)]
pub(super) struct BoxTree {
    /// How many boxes there are.
    count: usize,
    /// A full binary tree: the children of node i are 2 i + 1 and 2 i + 2. A power of two of leaves.
    nodes: Vec<Bounds>,
    leaves: usize,
}

/// Boxes in a leaf, about.
const LEAF: usize = 4;

/// Fewer boxes than these are not worth a thread of their own.
const FEW: usize = 8192;

impl BoxTree {
    /// The tree, and the numbers of the boxes in its order.
    pub(super) fn new(boxes: &[Bounds]) -> (BoxTree, Vec<u32>) {
        if boxes.is_empty() {
            return (BoxTree::default(), Vec::new());
        }
        let count = boxes.len();
        let leaves = count.div_ceil(LEAF).next_power_of_two();
        let mut items: Vec<Item> = (0..).zip(boxes).map(|(number, bounds)| (bounds.center(), number)).collect();
        arrange(&mut items, leaves);
        let mut tree = BoxTree { count, nodes: vec![Bounds::EMPTY; 2 * leaves - 1], leaves };
        for node in (0..tree.nodes.len()).rev() {
            tree.nodes[node] = if node + 1 < leaves {
                tree.nodes[2 * node + 1].union(tree.nodes[2 * node + 2])
            } else {
                items[tree.leaf(node)].iter().fold(Bounds::EMPTY, |all, &(_, number)| all.union(boxes[number as usize]))
            };
        }
        (tree, items.into_iter().map(|(_, number)| number).collect())
    }

    /// The places of a leaf's boxes.
    fn leaf(&self, node: usize) -> Range<usize> {
        let leaf = node + 1 - self.leaves;
        share(self.count, leaf, self.leaves)..share(self.count, leaf + 1, self.leaves)
    }

    /// Calls `visit` with ranges of places that together hold all boxes through which the ray goes before `max`.
    pub(super) fn along(&self, ray: &Ray, max: f32, mut visit: impl FnMut(Range<usize>)) {
        // Without directions of zero, which make no finite inverse.
        let inverse = ray.direction.to_array().map(|d| if d.abs() < 1e-20 { 1e20_f32.copysign(d) } else { 1.0 / d });
        let inverse = Vec3::from_array(inverse);
        let mut stack = [0_usize; 64];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let node = stack[depth];
            let Bounds { min, max: far } = self.nodes[node];
            let (low, high) = ((min - ray.origin) * inverse, (far - ray.origin) * inverse);
            let (enter, leave) = (low.min(high).max_element(), low.max(high).min_element());
            if enter.max(0.0) > leave.min(max) {
                continue;
            }
            if node + 1 < self.leaves {
                stack[depth] = 2 * node + 2;
                stack[depth + 1] = 2 * node + 1;
                depth += 2;
            } else {
                visit(self.leaf(node));
            }
        }
    }
}

/// How many of `count` things belong to the first `part` of `parts`.
fn share(count: usize, part: usize, parts: usize) -> usize {
    (count as u64 * part as u64 / parts as u64) as usize
}

/// The middle of a box, and its number.
type Item = (Vec3, u32);

/// Sorts boxes so that each of so many leaves gets its share of neighbours.
fn arrange(items: &mut [Item], leaves: usize) {
    if leaves == 1 {
        return;
    }
    let (low, high) =
        items.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), (at, _)| (low.min(*at), high.max(*at)));
    let axis = (high - low).max_position();
    let middle = items.len() / 2;
    if middle > 0 {
        // By number where places are equal: one order only.
        items.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    }
    let worth_it = items.len() > FEW;
    let (first, second) = items.split_at_mut(middle);
    if worth_it {
        rayon::join(|| arrange(first, leaves / 2), || arrange(second, leaves / 2));
    } else {
        arrange(first, leaves / 2);
        arrange(second, leaves / 2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::Sampler;

    #[test]
    fn a_ray_finds_every_box_that_it_goes_through() {
        let mut sampler = Sampler::new(4, 0, 0, 0);
        let mut point = || sampler.square().extend(sampler.uniform());
        for count in [0_usize, 1, 3, 9, 1000] {
            let boxes: Vec<Bounds> = (0..count)
                .map(|_| {
                    let (corner, side) = (point(), 0.1 * point());
                    Bounds { min: corner, max: corner + side }
                })
                .collect();
            let (tree, order) = BoxTree::new(&boxes);
            for _ in 0..50 {
                let ray = Ray { origin: point(), direction: (point() - 0.5).normalize() };
                let max = 0.7;
                let mut found = Vec::new();
                tree.along(&ray, max, |places| found.extend(order[places].iter().map(|&number| number as usize)));
                let all = found.len();
                found.sort_unstable();
                found.dedup();
                assert_eq!(found.len(), all, "twice");
                for (number, inside) in boxes.iter().enumerate() {
                    let meets = (0..=2000).any(|i| {
                        let at = ray.at(max * i as f32 / 2000.0);
                        at.cmpge(inside.min).all() && at.cmple(inside.max).all()
                    });
                    assert!(!meets || found.binary_search(&number).is_ok(), "{number} of {count}");
                }
            }
        }
    }

    /// Parts of all sizes, as halves of odd numbers are not the shares of leaves.
    #[test]
    fn every_leaf_has_its_share_whatever_the_number() {
        for count in 1..200 {
            let boxes: Vec<Bounds> =
                (0..count).map(|i| Bounds { min: Vec3::splat(i as f32), max: Vec3::splat(i as f32 + 0.5) }).collect();
            let (tree, order) = BoxTree::new(&boxes);
            let ray = Ray { origin: Vec3::splat(-1.0), direction: Vec3::ONE.normalize() };
            let mut found = Vec::new();
            tree.along(&ray, 1e9, |places| found.extend(order[places].iter().map(|&number| number as usize)));
            found.sort_unstable();
            assert!(found.into_iter().eq(0..count));
        }
    }
}
