//! What building and traversing consist of, once for each kind of processor.

use super::bins::{Bins, Grid, Split};
use super::collapse::Costs;
use super::packet::{Lanes, Packet, TriangleRay};
use super::portable::Portable;
use super::quads::QuadPacket;
use super::reference::{Extent, Reference};
use super::traverse::BoxRay;
#[cfg(target_arch = "x86_64")]
use super::x86::Avx2;
use super::{Node, WIDTH};
use crate::geometry::Ray;

/// The instructions that a tree is built and traversed with, chosen once when it is built.
#[derive(Clone, Copy, Debug)]
pub(in super::super) enum Isa {
    /// What every processor has.
    Portable(Portable),
    /// Eight boxes at a time.
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
}

/// The tests. All kernels give the same bits.
pub(in super::super) trait Kernel: Copy {
    /// The boxes that a ray meets between its origin and `limit`, a bit each, and where it enters them.
    fn boxes(self, node: &Node, ray: &BoxRay, limit: f32) -> (u32, [f32; WIDTH]);

    /// The triangles that a ray meets at distances above 0 and not above `limit`; none if there are none.
    fn triangles(self, packet: &Packet, ray: &TriangleRay, limit: f32) -> Option<Lanes>;

    /// The parallelograms that a ray meets at distances above 0 and below `limit`, a bit each, and where it meets the
    /// planes.
    fn quads(self, packet: &QuadPacket, ray: &Ray, limit: f32) -> (u32, [f32; WIDTH]);

    /// Tells the memory that `item` will be asked for.
    fn prefetch<T>(self, item: &T);
}

/// What trees are built with. All kernels give the same bits.
pub(super) trait BuildKernel: Copy + Send + Sync {
    /// The planes of a box.
    type Planes: Copy;

    fn planes(self, extent: &Extent) -> Self::Planes;
    fn extent(self, planes: Self::Planes) -> Extent;

    /// The lesser of each; the second if either is not a number or they are equal, so that the sign of zero does not
    /// depend on how many were united before.
    fn least(self, a: Self::Planes, b: Self::Planes) -> Self::Planes;

    /// The box around twice the middle of a box, that is, around a point.
    fn middle(self, planes: Self::Planes) -> Self::Planes;

    /// The bins of a middle, on each axis (see [`Grid`]).
    fn places(self, grid: &Grid, middle: Self::Planes) -> [u32; 3];

    /// Whether a middle is in a bin below that of a split; the middle if it is, else the planes of an empty box; and the
    /// other of the two.
    fn sides(self, grid: &Grid, split: Split, middle: Self::Planes) -> (bool, [Self::Planes; 2]);

    /// Half the surface area; of what is empty, infinity.
    fn area(self, planes: Self::Planes) -> f32;

    /// Puts references into the bins of a grid, which may have held anything.
    fn fill(self, bins: &mut Bins, references: &[Reference], grid: &Grid);

    /// The best split (see [`Bins::best`]).
    fn best(self, bins: &Bins, grid: &Grid, leaf_bits: u32) -> Option<Split>;

    /// Copies references to either side of a split (see [`Split::partition`]).
    fn partition(
        self,
        split: Split,
        grid: &Grid,
        references: &[Reference],
        left: &mut [Reference],
        right: &mut [Reference],
    ) -> [Extent; 2];

    /// What a node with this area around two others costs, and its shares.
    fn costs(self, area: f32, a: &Costs, b: &Costs) -> (Costs, u32);
}

impl Isa {
    #[cfg(test)]
    pub(in super::super) fn portable() -> Isa {
        Isa::Portable(Portable)
    }

    /// The fastest that this processor has.
    pub(in super::super) fn best() -> Isa {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = Avx2::detect() {
            return Isa::Avx2(avx2);
        }
        Isa::Portable(Portable)
    }
}
