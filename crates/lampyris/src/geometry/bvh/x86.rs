//! The kernel for processors with AVX2.
//!
//! The only unsafe code of the library: calls of functions that need AVX2, and vector loads from behind a pointer, which
//! the standard library has no safe form of.

#![allow(unsafe_code)]

use std::arch::x86_64::*;

use super::kernel::Kernel;
use super::packet::{Lanes, Packet, TriangleRay};
use super::quads::QuadPacket;
use super::traverse::{self, BoxRay, Leaves, STRETCH};
use super::{LANES, Node, WIDTH};
use crate::geometry::Ray;

/// Proof that the processor has AVX2, BMI1 and BMI2.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Avx2(());

impl Avx2 {
    /// None where the processor lacks any of the three.
    pub(super) fn detect() -> Option<Avx2> {
        let all =
            is_x86_feature_detected!("avx2") && is_x86_feature_detected!("bmi1") && is_x86_feature_detected!("bmi2");
        all.then_some(Avx2(()))
    }

    #[inline]
    pub(super) fn closest<L: Leaves, const STACK: usize>(
        self,
        nodes: &[Node],
        ray: &BoxRay,
        limit: f32,
        leaves: &mut L,
    ) {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { closest::<L, STACK>(self, nodes, ray, limit, leaves) }
    }

    #[inline]
    pub(super) fn any<L: Leaves, const STACK: usize>(
        self,
        nodes: &[Node],
        ray: &BoxRay,
        limit: f32,
        leaves: &mut L,
    ) -> bool {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { any::<L, STACK>(self, nodes, ray, limit, leaves) }
    }
}

#[target_feature(enable = "avx2,bmi1,bmi2")]
fn closest<L: Leaves, const STACK: usize>(kernel: Avx2, nodes: &[Node], ray: &BoxRay, limit: f32, leaves: &mut L) {
    traverse::closest::<Avx2, L, STACK>(kernel, nodes, ray, limit, leaves);
}

#[target_feature(enable = "avx2,bmi1,bmi2")]
fn any<L: Leaves, const STACK: usize>(kernel: Avx2, nodes: &[Node], ray: &BoxRay, limit: f32, leaves: &mut L) -> bool {
    traverse::any::<Avx2, L, STACK>(kernel, nodes, ray, limit, leaves)
}

impl Kernel for Avx2 {
    #[inline(always)]
    fn boxes(self, node: &Node, ray: &BoxRay, limit: f32) -> (u32, [f32; WIDTH]) {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { boxes(node, ray, limit) }
    }

    #[inline(always)]
    fn triangles(self, packet: &Packet, ray: &TriangleRay, limit: f32) -> Option<Lanes> {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { triangles(packet, ray, limit) }
    }

    #[inline(always)]
    fn quads(self, packet: &QuadPacket, ray: &Ray, limit: f32) -> (u32, [f32; WIDTH]) {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { quads(packet, ray, limit) }
    }

    #[inline(always)]
    fn prefetch<T>(self, item: &T) {
        let first = std::ptr::from_ref(item).cast::<i8>();
        for line in 0..size_of::<T>().div_ceil(LINE) {
            // SAFETY: a hint that cannot fail, wherever it points; and it points into `item`.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(first.wrapping_add(line * LINE)) };
        }
    }
}

/// Bytes of a line of the processor's cache.
const LINE: usize = 64;

#[inline]
#[target_feature(enable = "avx2")]
fn row8(row: &[f32; WIDTH]) -> __m256 {
    // SAFETY: eight floats are what is loaded.
    unsafe { _mm256_loadu_ps(row.as_ptr()) }
}

#[inline]
#[target_feature(enable = "avx2")]
fn row4(row: &[f32; LANES]) -> __m128 {
    // SAFETY: four floats are what is loaded.
    unsafe { _mm_loadu_ps(row.as_ptr()) }
}

#[inline]
#[target_feature(enable = "avx2")]
fn floats4(lanes: __m128) -> [f32; LANES] {
    let mut floats = [0.0; LANES];
    // SAFETY: four floats are what is stored.
    unsafe { _mm_storeu_ps(floats.as_mut_ptr(), lanes) };
    floats
}

#[inline]
#[target_feature(enable = "avx2")]
fn boxes(node: &Node, ray: &BoxRay, limit: f32) -> (u32, [f32; WIDTH]) {
    let mut enter = _mm256_setzero_ps();
    let mut leave = _mm256_set1_ps(limit);
    for axis in 0..3 {
        let (origin, inverse) = (_mm256_set1_ps(ray.origin[axis]), _mm256_set1_ps(ray.inverse[axis]));
        let (near, far) = (row8(&node.rows[ray.enter[axis]]), row8(&node.rows[ray.leave[axis]]));
        enter = _mm256_max_ps(_mm256_mul_ps(_mm256_sub_ps(near, origin), inverse), enter);
        leave = _mm256_min_ps(_mm256_mul_ps(_mm256_sub_ps(far, origin), inverse), leave);
    }
    let met = _mm256_cmp_ps::<_CMP_LE_OQ>(enter, _mm256_mul_ps(leave, _mm256_set1_ps(STRETCH)));
    let mut floats = [0.0; WIDTH];
    // SAFETY: eight floats are what is stored.
    unsafe { _mm256_storeu_ps(floats.as_mut_ptr(), enter) };
    (_mm256_movemask_ps(met) as u32, floats)
}

#[inline]
#[target_feature(enable = "avx2")]
fn triangles(packet: &Packet, ray: &TriangleRay, limit: f32) -> Option<Lanes> {
    let [shear_x, shear_y, shear_z] = [_mm_set1_ps(ray.shear[0]), _mm_set1_ps(ray.shear[1]), _mm_set1_ps(ray.shear[2])];
    let sheared = |corner: &[[f32; LANES]; 3]| {
        let [x, y, z] = ray.axes;
        let x = _mm_sub_ps(row4(&corner[x]), _mm_set1_ps(ray.origin[x]));
        let y = _mm_sub_ps(row4(&corner[y]), _mm_set1_ps(ray.origin[y]));
        let z = _mm_sub_ps(row4(&corner[z]), _mm_set1_ps(ray.origin[z]));
        [_mm_sub_ps(x, _mm_mul_ps(shear_x, z)), _mm_sub_ps(y, _mm_mul_ps(shear_y, z)), z]
    };
    let [ax, ay, az] = sheared(&packet.corners[0]);
    let [bx, by, bz] = sheared(&packet.corners[1]);
    let [cx, cy, cz] = sheared(&packet.corners[2]);
    let u = _mm_sub_ps(_mm_mul_ps(cx, by), _mm_mul_ps(cy, bx));
    let v = _mm_sub_ps(_mm_mul_ps(ax, cy), _mm_mul_ps(ay, cx));
    let w = _mm_sub_ps(_mm_mul_ps(bx, ay), _mm_mul_ps(by, ax));
    let zero = _mm_setzero_ps();
    let above = _mm_cmpge_ps(_mm_min_ps(u, _mm_min_ps(v, w)), zero);
    let below = _mm_cmple_ps(_mm_max_ps(u, _mm_max_ps(v, w)), zero);
    let inside = _mm_or_ps(above, below);
    if _mm_movemask_ps(inside) == 0 {
        return None;
    }
    let inverse = _mm_div_ps(_mm_set1_ps(1.0), _mm_add_ps(u, _mm_add_ps(v, w)));
    let [u, v, w] = [_mm_mul_ps(u, inverse), _mm_mul_ps(v, inverse), _mm_mul_ps(w, inverse)];
    let distance = _mm_add_ps(_mm_mul_ps(u, az), _mm_add_ps(_mm_mul_ps(v, bz), _mm_mul_ps(w, cz)));
    let distance = _mm_mul_ps(distance, shear_z);
    let ahead = _mm_and_ps(_mm_cmpgt_ps(distance, zero), _mm_cmple_ps(distance, _mm_set1_ps(limit)));
    let met = _mm_movemask_ps(_mm_and_ps(inside, ahead)) as u32;
    (met != 0).then(|| Lanes { met, distance: floats4(distance), barycentric: [floats4(v), floats4(w)] })
}

#[inline]
#[target_feature(enable = "avx2")]
fn quads(packet: &QuadPacket, ray: &Ray, limit: f32) -> (u32, [f32; WIDTH]) {
    let dot = |rows: &[[f32; WIDTH]; 3], [x, y, z]: [__m256; 3]| {
        let xy = _mm256_add_ps(_mm256_mul_ps(row8(&rows[0]), x), _mm256_mul_ps(row8(&rows[1]), y));
        _mm256_add_ps(xy, _mm256_mul_ps(row8(&rows[2]), z))
    };
    let direction = ray.direction.to_array().map(|coordinate| _mm256_set1_ps(coordinate));
    let to_origin = [0, 1, 2].map(|axis| _mm256_sub_ps(row8(&packet.origin[axis]), _mm256_set1_ps(ray.origin[axis])));
    let distance = _mm256_div_ps(dot(&packet.normal, to_origin), dot(&packet.normal, direction));
    let point = [0, 1, 2].map(|axis| _mm256_sub_ps(_mm256_mul_ps(direction[axis], distance), to_origin[axis]));
    let (zero, one) = (_mm256_setzero_ps(), _mm256_set1_ps(1.0));
    let within = |x: __m256| _mm256_and_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(x, zero), _mm256_cmp_ps::<_CMP_LE_OQ>(x, one));
    let inside = _mm256_and_ps(within(dot(&packet.dual_u, point)), within(dot(&packet.dual_v, point)));
    let ahead = _mm256_and_ps(
        _mm256_cmp_ps::<_CMP_GT_OQ>(distance, zero),
        _mm256_cmp_ps::<_CMP_LT_OQ>(distance, _mm256_set1_ps(limit)),
    );
    let mut floats = [0.0; WIDTH];
    // SAFETY: eight floats are what is stored.
    unsafe { _mm256_storeu_ps(floats.as_mut_ptr(), distance) };
    (_mm256_movemask_ps(_mm256_and_ps(inside, ahead)) as u32, floats)
}
