//! Triangles as rays meet them: four at a time.

use bytemuck::{Pod, Zeroable};
use glam::Vec2;

use super::LANES;
use super::kernel::Kernel;
use crate::geometry::Ray;

/// Up to four triangles.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub(in super::super) struct Packet {
    /// By corner, axis and triangle; lanes without a triangle are not numbers, and no ray meets them.
    pub(super) corners: [[[f32; LANES]; 3]; 3],
    /// The triangles' numbers.
    numbers: [u32; LANES],
}

/// A ray as triangles meet it: moved to the origin and sheared, its longest axis becomes z and the others vanish, so
/// that the test is one of three edges around a point in the plane. Two triangles with an edge in common compute
/// the same number for it but for its sign, so that no ray passes between them [Woop, Benthin and Wald 2013].
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct TriangleRay {
    pub(super) origin: [f32; 3],
    /// The axes that become x, y and z.
    pub(super) axes: [usize; 3],
    /// What of z is taken from x and y, and what z is multiplied by.
    pub(super) shear: [f32; 3],
}

/// The triangles of a packet that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Lanes {
    /// A bit for each.
    pub(super) met: u32,
    pub(super) distance: [f32; LANES],
    /// The barycentric coordinates of the second and third corners.
    pub(super) barycentric: [[f32; LANES]; 2],
}

/// The nearest triangle so far; of several at the same distance the one with the least number, so that the order in
/// which they are tried does not matter.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Best {
    pub(in super::super) distance: f32,
    pub(in super::super) number: u32,
    pub(in super::super) barycentric: Vec2,
}

impl Packet {
    /// Of at most four triangles, by number and corners.
    pub(in super::super) fn new(triangles: impl Iterator<Item = (u32, [[f32; 3]; 3])>) -> Packet {
        let mut packet = Packet { corners: [[[f32::NAN; LANES]; 3]; 3], numbers: [u32::MAX; LANES] };
        for (lane, (number, corners)) in triangles.take(LANES).enumerate() {
            packet.numbers[lane] = number;
            for (rows, corner) in packet.corners.iter_mut().zip(corners) {
                for (row, coordinate) in rows.iter_mut().zip(corner) {
                    row[lane] = coordinate;
                }
            }
        }
        packet
    }

    /// How many triangles there are.
    pub(in super::super) fn len(&self) -> usize {
        self.numbers.iter().filter(|&&number| number != u32::MAX).count()
    }

    /// The nearest of its triangles and what was the nearest before.
    #[inline(always)]
    pub(in super::super) fn closest<K: Kernel>(&self, kernel: K, ray: &TriangleRay, best: &mut Best) {
        let Some(lanes) = kernel.triangles(self, ray, best.distance) else { return };
        let mut met = lanes.met;
        while met != 0 {
            let lane = met.trailing_zeros() as usize % LANES;
            met &= met - 1;
            let (distance, number) = (lanes.distance[lane], self.numbers[lane]);
            if distance < best.distance || distance == best.distance && number < best.number {
                let barycentric = Vec2::new(lanes.barycentric[0][lane], lanes.barycentric[1][lane]);
                *best = Best { distance, number, barycentric };
            }
        }
    }

    /// Whether a ray meets any of its triangles.
    #[inline(always)]
    pub(in super::super) fn any<K: Kernel>(&self, kernel: K, ray: &TriangleRay, limit: f32) -> bool {
        kernel.triangles(self, ray, limit).is_some()
    }
}

impl TriangleRay {
    #[inline]
    pub(in super::super) fn new(ray: &Ray) -> TriangleRay {
        let z = ray.direction.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let [along_x, along_y, along_z] = axes.map(|axis| ray.direction[axis]);
        let shear = [along_x / along_z, along_y / along_z, 1.0 / along_z];
        TriangleRay { origin: ray.origin.to_array(), axes, shear }
    }
}
