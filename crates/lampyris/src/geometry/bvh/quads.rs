//! Parallelograms as rays meet them: eight at a time. Rooms are made of them, and few shapes are tried faster than a tree
//! of them is descended.

use super::WIDTH;
use super::kernel::{Isa, Kernel};
use crate::geometry::{Quad, Ray};

/// Up to eight parallelograms; all rows are by axis and parallelogram.
#[derive(Clone, Debug)]
pub(in super::super) struct QuadPacket {
    pub(super) origin: [[f32; WIDTH]; 3],
    /// Zero in lanes without a parallelogram, which no ray meets.
    pub(super) normal: [[f32; WIDTH]; 3],
    pub(super) dual_u: [[f32; WIDTH]; 3],
    pub(super) dual_v: [[f32; WIDTH]; 3],
    /// The numbers of the shapes.
    shapes: [u32; WIDTH],
}

impl QuadPacket {
    /// Packets of all of these, by number.
    pub(in super::super) fn of(quads: &[(u32, Quad)]) -> Vec<QuadPacket> {
        quads.chunks(WIDTH).map(QuadPacket::new).collect()
    }

    fn new(quads: &[(u32, Quad)]) -> QuadPacket {
        let nothing = [[0.0; WIDTH]; 3];
        let mut packet = QuadPacket {
            origin: nothing,
            normal: nothing,
            dual_u: nothing,
            dual_v: nothing,
            shapes: [u32::MAX; WIDTH],
        };
        for (lane, (shape, quad)) in quads.iter().enumerate() {
            packet.shapes[lane] = *shape;
            let flat = quad.flat();
            for axis in 0..3 {
                packet.origin[axis][lane] = flat.origin[axis];
                packet.normal[axis][lane] = flat.normal[axis];
                packet.dual_u[axis][lane] = flat.dual_u[axis];
                packet.dual_v[axis][lane] = flat.dual_v[axis];
            }
        }
        packet
    }

    /// The nearest that the ray meets before `limit`, by distance and shape; the first of several at one distance.
    #[inline]
    pub(in super::super) fn closest(&self, isa: Isa, ray: &Ray, limit: f32) -> Option<(f32, u32)> {
        let (mut met, distances) = self.met(isa, ray, limit);
        let mut nearest = None;
        while met != 0 {
            let lane = met.trailing_zeros() as usize % WIDTH;
            met &= met - 1;
            if nearest.is_none_or(|(distance, _)| distances[lane] < distance) {
                nearest = Some((distances[lane], self.shapes[lane]));
            }
        }
        nearest
    }

    /// Whether the ray meets any before `limit`.
    #[inline]
    pub(in super::super) fn any(&self, isa: Isa, ray: &Ray, limit: f32) -> bool {
        self.met(isa, ray, limit).0 != 0
    }

    #[inline]
    fn met(&self, isa: Isa, ray: &Ray, limit: f32) -> (u32, [f32; WIDTH]) {
        match isa {
            Isa::Portable(kernel) => kernel.quads(self, ray, limit),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(kernel) => kernel.quads(self, ray, limit),
        }
    }
}
