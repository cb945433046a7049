//! The tests that a traversal consists of, once for each kind of processor.

use super::packet::{Lanes, Packet, TriangleRay};
use super::portable::Portable;
use super::quads::QuadPacket;
use super::traverse::BoxRay;
#[cfg(target_arch = "x86_64")]
use super::x86::Avx2;
use super::{Node, WIDTH};
use crate::geometry::Ray;

/// The instructions that a tree is traversed with, chosen once when it is built.
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
