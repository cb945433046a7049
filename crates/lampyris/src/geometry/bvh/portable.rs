//! The kernel for any processor, and the oracle of the others.

use super::kernel::Kernel;
use super::packet::{Lanes, Packet, TriangleRay};
use super::quads::QuadPacket;
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
