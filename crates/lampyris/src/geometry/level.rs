//! What a ray meets in one system of coordinates: the world's, or a group's.

use super::bvh::{
    Best, BoxRay, Isa, Kernel, LANES, Leaf, Leaves, Packet, Pages, QuadPacket, Reference, References, Tree, TriangleRay,
};
use super::{Bounds, Mesh, Quad, RELATIVE_ERROR, Ray, pairs};
use glam::{Vec2, Vec3};

/// Up to this many curved and flat shapes are tried one after the other, which is faster than a tree.
pub(super) const FEW: usize = 16;

/// Something without triangles of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Item {
    /// A shape that is not a mesh, by number.
    Shape(u32),
    /// An instance, by number.
    Instance(u32),
}

/// Items and triangles, ready for rays.
#[derive(Debug)]
pub(super) struct Level {
    /// Parallelograms that every ray tries, if they are few.
    quads: Vec<QuadPacket>,
    isa: Isa,
    /// Items that every ray tries: the infinite ones, and all if there are few.
    tried: Vec<Item>,
    /// The other items, by leaf.
    items: Option<(Tree, Vec<Item>)>,
    triangles: Option<Triangles>,
    /// Around all that is finite.
    bounds: Bounds,
}

/// The triangles of all meshes.
#[derive(Debug)]
struct Triangles {
    tree: Tree,
    /// By leaf.
    packets: Pages<Packet>,
    /// The first triangle of each mesh, and the mesh's shape.
    meshes: Vec<(u32, u32)>,
}

/// A triangle of a mesh that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct TriangleHit {
    pub(super) distance: f32,
    pub(super) shape: u32,
    pub(super) triangle: u32,
    pub(super) barycentric: Vec2,
}

/// What a ray asks items for.
pub(super) trait Items {
    /// The distance to the item along the ray, if it is met before `max`, in which case the item is remembered.
    fn closest(&mut self, item: Item, max: f32) -> Option<f32>;

    /// Whether the item is met before `max`.
    fn any(&self, item: Item, max: f32) -> bool;

    /// Remembers a shape that is met at this distance.
    fn found(&mut self, shape: u32, distance: f32);
}

/// How much there is of what, and how good the tree over triangles is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TreeStatistics {
    /// Triangles in trees.
    pub triangles: usize,
    /// Packets of up to four triangles.
    pub packets: usize,
    /// Bytes of all trees and packets.
    pub bytes: usize,
    /// What a random ray costs on average, in tests of eight boxes or of a packet, by the ratio of surface areas; of
    /// the largest tree over triangles.
    pub cost: f64,
}

impl Level {
    /// From items with their boxes, none for infinite ones, and parallelograms and meshes with the numbers of their shapes.
    pub(super) fn build(items: &[(Item, Option<Bounds>)], quads: &[(u32, Quad)], meshes: &[(u32, &Mesh)]) -> Level {
        let mut finite: Vec<(Item, Bounds)> =
            items.iter().filter_map(|&(item, bounds)| Some((item, bounds?))).filter(|(_, b)| !b.is_empty()).collect();
        let infinite = items.iter().filter(|(_, bounds)| bounds.is_none()).map(|&(item, _)| item);
        let mut tried: Vec<Item> = infinite.collect();
        let few_quads = quads.len() <= FEW;
        let bounded_quads = quads.iter().map(|(shape, quad)| (Item::Shape(*shape), quad.bounds()));
        let around_quads = bounded_quads.clone().fold(Bounds::EMPTY, |around, (_, bounds)| around.union(bounds));
        if !few_quads {
            finite.extend(bounded_quads);
        }
        let around = finite.iter().fold(around_quads, |around, &(_, bounds)| around.union(bounds));
        let bounds = meshes.iter().fold(around, |around, (_, mesh)| around.union(mesh.bounds()));
        let mut tree = None;
        if finite.len() > FEW {
            tree = item_tree(&finite);
        } else {
            tried.extend(finite.iter().map(|&(item, _)| item));
        }
        let quads = if few_quads { QuadPacket::of(quads) } else { Vec::new() };
        Level { quads, isa: Isa::best(), tried, items: tree, triangles: Triangles::build(meshes), bounds }
    }

    /// The box around all that is finite.
    pub(super) fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The nearest triangle before `max` and before the nearest item, which `items` then knows.
    #[inline]
    pub(super) fn closest(&self, ray: &Ray, max: f32, items: &mut impl Items) -> Option<TriangleHit> {
        let mut max = max;
        for packet in &self.quads {
            if let Some((distance, shape)) = packet.closest(self.isa, ray, max) {
                items.found(shape, distance);
                max = distance;
            }
        }
        for &item in &self.tried {
            max = items.closest(item, max).unwrap_or(max);
        }
        if self.items.is_none() && self.triangles.is_none() {
            return None;
        }
        let box_ray = BoxRay::new(ray)?;
        if let Some((tree, in_leaves)) = &self.items {
            let mut leaves = ItemLeaves { items, in_leaves, max };
            tree.closest(&box_ray, max, &mut leaves);
            max = leaves.max;
        }
        self.triangles.as_ref()?.closest(ray, &box_ray, max)
    }

    /// Whether anything is met before `max`.
    #[inline]
    pub(super) fn any(&self, ray: &Ray, max: f32, items: &mut impl Items) -> bool {
        if self.quads.iter().any(|packet| packet.any(self.isa, ray, max))
            || self.tried.iter().any(|&item| items.any(item, max))
        {
            return true;
        }
        if self.items.is_none() && self.triangles.is_none() {
            return false;
        }
        let Some(box_ray) = BoxRay::new(ray) else { return false };
        // The triangles first: they are most of what there is.
        if let Some(Triangles { tree, packets, .. }) = &self.triangles {
            let mut leaves = TriangleLeaves::new(packets, ray, max);
            if tree.any(&box_ray, leaves.best.distance, &mut leaves) {
                return true;
            }
        }
        let Some((tree, in_leaves)) = &self.items else { return false };
        tree.any(&box_ray, max, &mut ItemLeaves { items, in_leaves, max })
    }

    #[cfg(test)]
    pub(super) fn make_portable(&mut self) {
        self.isa = Isa::portable();
        let trees = self.items.iter_mut().map(|(tree, _)| tree);
        trees.chain(self.triangles.iter_mut().map(|triangles| &mut triangles.tree)).for_each(Tree::make_portable);
    }

    pub(super) fn statistics(&self) -> TreeStatistics {
        let of_items = self.items.as_ref().map_or(0, |(tree, items)| tree.bytes() + size_of_val(items.as_slice()));
        let Some(Triangles { tree, packets, .. }) = &self.triangles else {
            return TreeStatistics { bytes: of_items, ..TreeStatistics::default() };
        };
        TreeStatistics {
            triangles: packets.iter().map(Packet::len).sum(),
            packets: packets.len(),
            bytes: of_items + tree.bytes() + size_of_val(&packets[..]),
            cost: tree.cost(),
        }
    }
}

fn item_tree(finite: &[(Item, Bounds)]) -> Option<(Tree, Vec<Item>)> {
    // Their boxes are computed with some rounding, unlike those of triangles.
    let padded = |bounds: Bounds| {
        let pad = Vec3::splat(RELATIVE_ERROR * bounds.min.abs().max(bounds.max.abs()).max_element());
        Bounds { min: bounds.min - pad, max: bounds.max + pad }
    };
    let references = References::new(finite.len(), |first, places| {
        for (number, place) in (first..).zip(places.iter_mut()) {
            *place = Reference::new(number, false, padded(finite[number as usize].1));
        }
        places.len()
    });
    let (tree, contents) = Tree::build(references, 0)?;
    let numbers = contents.leaves.iter().flat_map(|leaf| contents.of(leaf));
    let items = numbers.map(|number| finite[number as usize].0).collect();
    Some((tree, items))
}

impl Triangles {
    fn build(meshes: &[(u32, &Mesh)]) -> Option<Triangles> {
        let mut total = 0_u32;
        let mut starts = Vec::with_capacity(meshes.len());
        for &(shape, mesh) in meshes {
            starts.push((total, shape));
            total += mesh.len() as u32;
        }
        let corners = |number: u32| {
            let mesh = mesh_of(&starts, number);
            meshes[mesh].1.corners((number - starts[mesh].0) as usize)
        };
        let references = pairs::references(total, corners);
        let (tree, contents) = Tree::build(references, LANES.ilog2())?;
        let packet = |leaf: &Leaf| Packet::new(contents.of(leaf).map(|number| (number, corners(number))));
        let packets = Pages::from_each(&contents.leaves, packet);
        Some(Triangles { tree, packets, meshes: starts })
    }

    #[inline]
    fn closest(&self, ray: &Ray, box_ray: &BoxRay, max: f32) -> Option<TriangleHit> {
        let mut leaves = TriangleLeaves::new(&self.packets, ray, max);
        self.tree.closest(box_ray, leaves.best.distance, &mut leaves);
        let Best { distance, number, barycentric } = leaves.best;
        if number == u32::MAX {
            return None;
        }
        let (first, shape) = self.meshes[mesh_of(&self.meshes, number)];
        Some(TriangleHit { distance, shape, triangle: number - first, barycentric })
    }
}

/// The index of the mesh that a triangle belongs to.
#[inline]
fn mesh_of(starts: &[(u32, u32)], number: u32) -> usize {
    starts.partition_point(|&(first, _)| first <= number) - 1
}

/// The triangles of a tree as one ray meets them.
struct TriangleLeaves<'a> {
    packets: &'a [Packet],
    ray: TriangleRay,
    best: Best,
}

impl<'a> TriangleLeaves<'a> {
    #[inline]
    fn new(packets: &'a [Packet], ray: &Ray, max: f32) -> TriangleLeaves<'a> {
        let best = Best { distance: max.next_down(), number: u32::MAX, barycentric: Vec2::ZERO };
        TriangleLeaves { packets, ray: TriangleRay::new(ray), best }
    }
}

impl Leaves for TriangleLeaves<'_> {
    #[inline(always)]
    fn closest<K: Kernel>(&mut self, kernel: K, leaf: u32, _: f32) -> f32 {
        self.packets[leaf as usize].closest(kernel, &self.ray, &mut self.best);
        self.best.distance
    }

    #[inline(always)]
    fn any<K: Kernel>(&mut self, kernel: K, leaf: u32, limit: f32) -> bool {
        self.packets[leaf as usize].any(kernel, &self.ray, limit)
    }

    #[inline(always)]
    fn prefetch<K: Kernel>(&self, kernel: K, leaf: u32) {
        if let Some(packet) = self.packets.get(leaf as usize) {
            kernel.prefetch(packet);
        }
    }
}

/// The items of a tree as one ray meets them.
struct ItemLeaves<'a, I> {
    items: &'a mut I,
    in_leaves: &'a [Item],
    max: f32,
}

impl<I: Items> Leaves for ItemLeaves<'_, I> {
    #[inline(always)]
    fn closest<K: Kernel>(&mut self, _: K, leaf: u32, _: f32) -> f32 {
        self.max = self.items.closest(self.in_leaves[leaf as usize], self.max).unwrap_or(self.max);
        self.max
    }

    #[inline(always)]
    fn any<K: Kernel>(&mut self, _: K, leaf: u32, _: f32) -> bool {
        self.items.any(self.in_leaves[leaf as usize], self.max)
    }

    #[inline(always)]
    fn prefetch<K: Kernel>(&self, _: K, _: u32) {}
}
