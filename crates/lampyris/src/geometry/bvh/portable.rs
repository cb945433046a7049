//! The kernel for any processor, and the oracle of the others.

use super::bins::{Bins, FRACTION, Grid, MAX_BINS, Split, WHOLE};
use super::collapse::Costs;
use super::kernel::{BuildKernel, Kernel};
use super::packet::{Lanes, Packet, TriangleRay};
use super::quads::QuadPacket;
use super::reference::{Extent, Reference};
use super::traverse::{BoxRay, STRETCH};
use super::{LANES, Node, WIDTH};
use crate::geometry::Ray;

/// Lane after lane.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Portable;

/// The greater; the second if either is not a number, as the instruction has it.
#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The lesser; the second if either is not a number.
#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

impl Kernel for Portable {
    #[inline(always)]
    fn boxes(self, node: &Node, ray: &BoxRay, limit: f32) -> (u32, [f32; WIDTH]) {
        let mut enter = [0.0; WIDTH];
        let mut leave = [limit; WIDTH];
        for axis in 0..3 {
            let (near, far) = (&node.rows[ray.enter[axis]], &node.rows[ray.leave[axis]]);
            for lane in 0..WIDTH {
                // Zero times infinity, on the plane of a box along which the ray goes, leaves the bounds as they are.
                enter[lane] = max((near[lane] - ray.origin[axis]) * ray.inverse[axis], enter[lane]);
                leave[lane] = min((far[lane] - ray.origin[axis]) * ray.inverse[axis], leave[lane]);
            }
        }
        let bit = |lane: usize| u32::from(enter[lane] <= leave[lane] * STRETCH) << lane;
        ((0..WIDTH).map(bit).sum(), enter)
    }

    #[inline(always)]
    fn triangles(self, packet: &Packet, ray: &TriangleRay, limit: f32) -> Option<Lanes> {
        let mut lanes = Lanes { met: 0, distance: [0.0; LANES], barycentric: [[0.0; LANES]; 2] };
        for lane in 0..LANES {
            let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = packet.corners.map(|corner| {
                let [x, y, z] = ray.axes.map(|axis| corner[axis][lane] - ray.origin[axis]);
                [x - ray.shear[0] * z, y - ray.shear[1] * z, z]
            });
            let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
            let inside = min(u, min(v, w)) >= 0.0 || max(u, max(v, w)) <= 0.0;
            if !inside {
                continue;
            }
            // Infinite, and then not a number, for triangles without an area.
            let inverse = 1.0 / (u + (v + w));
            let (u, v, w) = (u * inverse, v * inverse, w * inverse);
            let distance = (u * az + (v * bz + w * cz)) * ray.shear[2];
            if distance > 0.0 && distance <= limit {
                lanes.met |= 1 << lane;
                lanes.distance[lane] = distance;
                lanes.barycentric[0][lane] = v;
                lanes.barycentric[1][lane] = w;
            }
        }
        (lanes.met != 0).then_some(lanes)
    }

    #[inline(always)]
    fn quads(self, packet: &QuadPacket, ray: &Ray, limit: f32) -> (u32, [f32; WIDTH]) {
        let dot = |rows: &[[f32; WIDTH]; 3], lane: usize, [x, y, z]: [f32; 3]| {
            rows[0][lane] * x + rows[1][lane] * y + rows[2][lane] * z
        };
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let (mut met, mut distances) = (0, [0.0; WIDTH]);
        for (lane, place) in distances.iter_mut().enumerate() {
            let to_origin = [0, 1, 2].map(|axis| packet.origin[axis][lane] - origin[axis]);
            let distance = dot(&packet.normal, lane, to_origin) / dot(&packet.normal, lane, direction);
            let point = [0, 1, 2].map(|axis| direction[axis] * distance - to_origin[axis]);
            let (a, b) = (dot(&packet.dual_u, lane, point), dot(&packet.dual_v, lane, point));
            let inside = (0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b);
            met |= u32::from(distance > 0.0 && distance < limit && inside) << lane;
            *place = distance;
        }
        (met, distances)
    }

    #[inline(always)]
    fn prefetch<T>(self, _: &T) {}
}

impl BuildKernel for Portable {
    type Planes = [f32; 8];

    #[inline(always)]
    fn planes(self, extent: &Extent) -> [f32; 8] {
        extent.0
    }

    #[inline(always)]
    fn extent(self, planes: [f32; 8]) -> Extent {
        Extent(planes)
    }

    #[inline(always)]
    fn least(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        let mut least = b;
        for lane in 0..8 {
            least[lane] = min(a[lane], b[lane]);
        }
        least
    }

    #[inline(always)]
    fn middle(self, planes: [f32; 8]) -> [f32; 8] {
        let [x, y, z, w, to_x, to_y, to_z, to_w] = planes;
        [x - to_x, y - to_y, z - to_z, w - to_w, to_x - x, to_y - y, to_z - z, to_w - w]
    }

    #[inline(always)]
    fn places(self, grid: &Grid, middle: [f32; 8]) -> [u32; 3] {
        let mut places = [0; 3];
        for (axis, bin) in places.iter_mut().enumerate() {
            let place = (middle[axis] - grid.least[axis]) * grid.scale[axis];
            *bin = ((min(place, grid.last) + WHOLE).to_bits() >> FRACTION) % MAX_BINS as u32;
        }
        places
    }

    #[inline(always)]
    fn sides(self, grid: &Grid, split: Split, middle: [f32; 8]) -> (bool, [[f32; 8]; 2]) {
        let is_left = self.places(grid, middle)[split.axis] < split.bin as u32;
        (is_left, if is_left { [middle, Extent::EMPTY.0] } else { [Extent::EMPTY.0, middle] })
    }

    #[inline(always)]
    fn area(self, planes: [f32; 8]) -> f32 {
        // The signs of two sizes of the other sign cancel out.
        let [x, y, z] = [0, 1, 2].map(|axis| planes[axis] + planes[axis + 4]);
        x * y + y * z + z * x
    }

    fn fill(self, bins: &mut Bins, references: &[Reference], grid: &Grid) {
        bins.fill(self, references, grid);
    }

    fn best(self, bins: &Bins, grid: &Grid, leaf_bits: u32) -> Option<Split> {
        bins.best(self, grid, leaf_bits)
    }

    fn partition(
        self,
        split: Split,
        grid: &Grid,
        references: &[Reference],
        left: &mut [Reference],
        right: &mut [Reference],
    ) -> [Extent; 2] {
        split.partition(self, grid, references, left, right)
    }

    fn costs(self, area: f32, a: &Costs, b: &Costs) -> (Costs, u32) {
        Costs::around(area, a, b)
    }
}
