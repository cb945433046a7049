//! The kernel for processors with AVX2.
//!
//! The only unsafe code of the library: calls of functions that need AVX2, and vector loads from behind a pointer, which
//! the standard library has no safe form of.

#![allow(unsafe_code)]

use std::arch::x86_64::*;

use super::bins::{Bins, FRACTION, Grid, MAX_BINS, Split, WHOLE};
use super::collapse::Costs;
use super::kernel::{BuildKernel, Kernel};
use super::packet::{Lanes, Packet, TriangleRay};
use super::quads::QuadPacket;
use super::reference::{Extent, Reference};
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

impl BuildKernel for Avx2 {
    type Planes = __m256;

    #[inline(always)]
    fn planes(self, extent: &Extent) -> __m256 {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { row8(&extent.0) }
    }

    #[inline(always)]
    fn extent(self, planes: __m256) -> Extent {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        Extent(unsafe { floats8(planes) })
    }

    #[inline(always)]
    fn least(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { _mm256_min_ps(a, b) }
    }

    #[inline(always)]
    fn middle(self, planes: __m256) -> __m256 {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { _mm256_sub_ps(planes, _mm256_permute2f128_ps::<1>(planes, planes)) }
    }

    #[inline(always)]
    fn places(self, grid: &Grid, middle: __m256) -> [u32; 3] {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { places_of(grid, middle) }
    }

    #[inline(always)]
    fn sides(self, grid: &Grid, split: Split, middle: __m256) -> (bool, [__m256; 2]) {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { sides(grid, split, middle) }
    }

    #[inline(always)]
    fn area(self, planes: __m256) -> f32 {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { area(planes) }
    }

    fn fill(self, bins: &mut Bins, references: &[Reference], grid: &Grid) {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { fill(self, bins, references, grid) };
    }

    fn best(self, bins: &Bins, grid: &Grid, leaf_bits: u32) -> Option<Split> {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { best(self, bins, grid, leaf_bits) }
    }

    fn partition(
        self,
        split: Split,
        grid: &Grid,
        references: &[Reference],
        left: &mut [Reference],
        right: &mut [Reference],
    ) -> [Extent; 2] {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { partition(self, split, grid, references, left, right) }
    }

    fn costs(self, area: f32, a: &Costs, b: &Costs) -> (Costs, u32) {
        // SAFETY: an `Avx2` exists only where `detect` found what the function needs.
        unsafe { costs(area, a, b) }
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn places(grid: &Grid, middle: __m256) -> __m128i {
    let place = _mm_sub_ps(_mm256_castps256_ps128(middle), row4(&grid.least));
    let place = _mm_min_ps(_mm_mul_ps(place, row4(&grid.scale)), _mm_set1_ps(grid.last));
    let bits = _mm_castps_si128(_mm_add_ps(place, _mm_set1_ps(WHOLE)));
    _mm_and_si128(_mm_srli_epi32::<{ FRACTION as i32 }>(bits), _mm_set1_epi32(MAX_BINS as i32 - 1))
}

#[inline]
#[target_feature(enable = "avx2")]
fn places_of(grid: &Grid, middle: __m256) -> [u32; 3] {
    let places = places(grid, middle);
    let [x, y] = [_mm_extract_epi32::<0>(places), _mm_extract_epi32::<1>(places)];
    [x, y, _mm_extract_epi32::<2>(places)].map(|place| place as u32)
}

#[inline]
#[target_feature(enable = "avx2")]
fn sides(grid: &Grid, split: Split, middle: __m256) -> (bool, [__m256; 2]) {
    let below = _mm_cmplt_epi32(places(grid, middle), _mm_set1_epi32(split.bin as i32));
    let is_left = _mm_movemask_ps(_mm_castsi128_ps(below)) >> split.axis & 1 != 0;
    let everywhere = _mm256_permutevar8x32_epi32(_mm256_castsi128_si256(below), _mm256_set1_epi32(split.axis as i32));
    let (mask, nothing) = (_mm256_castsi256_ps(everywhere), _mm256_set1_ps(f32::INFINITY));
    (is_left, [_mm256_blendv_ps(nothing, middle, mask), _mm256_blendv_ps(middle, nothing, mask)])
}

#[inline]
#[target_feature(enable = "avx2")]
fn area(planes: __m256) -> f32 {
    let sizes = _mm_add_ps(_mm256_castps256_ps128(planes), _mm256_extractf128_ps::<1>(planes));
    let products = _mm_mul_ps(sizes, _mm_permute_ps::<0b00_00_10_01>(sizes));
    let sum = _mm_add_ss(products, _mm_movehdup_ps(products));
    _mm_cvtss_f32(_mm_add_ss(sum, _mm_movehl_ps(products, products)))
}

#[target_feature(enable = "avx2")]
fn fill(kernel: Avx2, bins: &mut Bins, references: &[Reference], grid: &Grid) {
    bins.fill(kernel, references, grid);
}

#[target_feature(enable = "avx2")]
fn best(kernel: Avx2, bins: &Bins, grid: &Grid, leaf_bits: u32) -> Option<Split> {
    bins.best(kernel, grid, leaf_bits)
}

#[target_feature(enable = "avx2")]
fn partition(
    kernel: Avx2,
    split: Split,
    grid: &Grid,
    references: &[Reference],
    left: &mut [Reference],
    right: &mut [Reference],
) -> [Extent; 2] {
    split.partition(kernel, grid, references, left, right)
}

#[target_feature(enable = "avx2")]
fn costs(area: f32, a: &Costs, b: &Costs) -> (Costs, u32) {
    Costs::around(area, a, b)
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
fn floats8(lanes: __m256) -> [f32; WIDTH] {
    let mut floats = [0.0; WIDTH];
    // SAFETY: eight floats are what is stored.
    unsafe { _mm256_storeu_ps(floats.as_mut_ptr(), lanes) };
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
    (_mm256_movemask_ps(met) as u32, floats8(enter))
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
    (_mm256_movemask_ps(_mm256_and_ps(inside, ahead)) as u32, floats8(distance))
}
