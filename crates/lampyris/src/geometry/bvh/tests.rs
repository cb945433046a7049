//! What a tree is built from is in it, and it is the same wherever it is built.

use glam::Vec3;

use super::kernel::{BuildKernel, Isa};
use super::portable::Portable;
use super::reference::ROW;
use super::*;

/// Boxes of some size spread over a cube, or all in one place; always the same.
fn bounds(number: u32, spread: f32) -> Bounds {
    let fraction = |by: f64| (f64::from(number + 1) * by).fract() as f32;
    let middle = spread * Vec3::new(fraction(0.618_033_988), fraction(0.754_877_666), fraction(0.569_840_291));
    let half = 0.01 * Vec3::new(fraction(0.324_7), fraction(0.871_3), fraction(0.145_7));
    Bounds { min: middle - half, max: middle + half }
}

/// Of the first so many things, every other with the next one as a pair, but for some rows that have no pairs.
fn references(count: usize, spread: f32) -> References {
    References::new(count, |first, places| {
        let (mut used, mut number, end) = (0, first, first + places.len() as u32);
        while number < end {
            let is_pair = number / ROW as u32 % 3 != 1 && used % 3 != 0 && number + 1 < end;
            let own = bounds(number, spread);
            let both = if is_pair { own.union(bounds(number + 1, spread)) } else { own };
            places[used] = Reference::new(number, is_pair, both);
            used += 1;
            number += 1 + u32::from(is_pair);
        }
        used
    })
}

fn contains(outer: Bounds, inner: Bounds) -> bool {
    outer.min.cmple(inner.min).all() && outer.max.cmpge(inner.max).all()
}

/// Notes the number of everything below a node, all of which must be within its boxes.
fn walk(tree: &Tree, contents: &Contents, node: usize, spread: f32, found: &mut Vec<u32>) {
    let node = &tree.nodes[node];
    for index in (0..WIDTH).filter(|&index| !node.bounds(index).is_empty()) {
        let before = found.len();
        let child = node.children[index];
        if child & LEAF == 0 {
            walk(tree, contents, child as usize, spread, found);
        } else {
            found.extend(contents.of(&contents.leaves[(child & !LEAF) as usize]));
            assert!((1..=4).contains(&(found.len() - before)), "{} in a leaf", found.len() - before);
        }
        assert!(found[before..].iter().all(|&number| contains(node.bounds(index), bounds(number, spread))));
    }
}

#[test]
fn everything_is_in_one_leaf_and_within_the_boxes_around_it() {
    // All in one place are split without a plane, with rows that have room left and without.
    for (count, spread) in [1, 2, 4, 5, 9, 1000, ROW, ROW + 1, 2 * ROW - 1, 5 * ROW + 77]
        .into_iter()
        .flat_map(|count| [(count, 1.0), (count, 0.0)])
    {
        let (tree, contents) = Tree::build(references(count, spread), 2).expect("a tree over something");
        let mut found = Vec::new();
        walk(&tree, &contents, 0, spread, &mut found);
        found.sort_unstable();
        assert!(found.into_iter().eq(0..count as u32), "{count} {spread}");
    }
    assert!(Tree::build(references(0, 1.0), 2).is_none());
}

#[test]
fn the_tree_is_the_same_on_every_processor_and_any_number_of_threads() {
    fn build<K: BuildKernel>(kernel: K, threads: usize, spread: f32) -> (Tree, Contents) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| Tree::build_with(kernel, references(9 * ROW, spread), 2)).expect("a tree over something")
    }
    for spread in [1.0, 0.0] {
        let (portable, contents) = build(Portable, 1, spread);
        let same = |(tree, other): (Tree, Contents)| {
            let bytes = |tree: &Tree| bytemuck::cast_slice::<Node, u8>(&tree.nodes).to_vec();
            assert!(bytes(&tree) == bytes(&portable));
            assert!((other.numbers, other.leaves) == (contents.numbers.clone(), contents.leaves.clone()));
        };
        same(build(Portable, 3, spread));
        #[cfg(target_arch = "x86_64")]
        if let Isa::Avx2(kernel) = Isa::best() {
            [1, 2, 5].into_iter().for_each(|threads| same(build(kernel, threads, spread)));
        }
    }
}
