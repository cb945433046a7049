//! What trees are built over: boxes with numbers.

use rayon::prelude::*;

use super::kernel::BuildKernel;
use super::pages::Pages;
use super::portable::Portable;
use crate::geometry::Bounds;

/// A box, by its planes: the least x, y and z, and in the second half the greatest with the other sign, so that a box
/// around others has the least of each plane. The fourth of each half tells nothing.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(super) struct Extent(pub(super) [f32; 8]);

/// The box of something with a number, or of two whose numbers follow on each other, in one vector.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub(in super::super) struct Reference {
    /// As in [`Extent`]. The fourth of the first half holds the bits of the number and [`NORMAL`], that of the second in
    /// its bit [`PAIR`] whether there are two.
    planes: [f32; 8],
}

/// The bits of the least normal number. Processors take many times as long for lesser ones, but zero, even where nobody
/// asks what comes out.
const NORMAL: u32 = f32::MIN_POSITIVE.to_bits();
const PAIR: u32 = 30;

/// References in rows of [`ROW`] places, of each of which only the first ones may be used.
pub(in super::super) struct References {
    places: Pages<Reference>,
    /// How many are used, by row.
    used: Vec<usize>,
}

/// References that a thread makes, bins or sorts at a time.
pub(super) const ROW: usize = 1 << 13;

impl Extent {
    pub(super) const EMPTY: Extent = Extent([f32::INFINITY; 8]);

    pub(super) fn union(self, other: Extent) -> Extent {
        Extent(Portable.least(other.0, self.0))
    }

    /// Half the surface area.
    pub(super) fn area(self) -> f32 {
        Portable.area(self.0)
    }

    pub(super) fn bounds(&self) -> Bounds {
        let [x, y, z, _, to_x, to_y, to_z, _] = self.0;
        Bounds { min: glam::Vec3::new(x, y, z), max: -glam::Vec3::new(to_x, to_y, to_z) }
    }
}

impl Reference {
    #[inline]
    pub(in super::super) fn new(number: u32, is_pair: bool, bounds: Bounds) -> Reference {
        let (min, max) = (bounds.min, -bounds.max);
        let number = f32::from_bits(number.wrapping_add(NORMAL));
        let pair = f32::from_bits(u32::from(is_pair) << PAIR);
        Reference { planes: [min.x, min.y, min.z, number, max.x, max.y, max.z, pair] }
    }

    #[inline(always)]
    pub(in super::super) fn number(&self) -> u32 {
        self.planes[3].to_bits().wrapping_sub(NORMAL)
    }

    #[inline(always)]
    pub(in super::super) fn is_pair(&self) -> bool {
        self.planes[7].to_bits() >> PAIR != 0
    }

    #[inline(always)]
    pub(super) fn extent(&self) -> Extent {
        Extent(self.planes)
    }
}

impl References {
    /// Of `count` things. `make` is given the first number of a row and writes the references to the things that have a
    /// place in the row, of which it says how many there are.
    pub(in super::super) fn new(count: usize, make: impl Fn(u32, &mut [Reference]) -> usize + Sync) -> References {
        let mut places = Pages::zeroed(count);
        let rows = places.par_chunks_mut(ROW).enumerate();
        let used = rows.map(|(row, places)| make((row * ROW) as u32, places)).collect();
        References { places, used }
    }

    pub(super) fn len(&self) -> usize {
        self.used.iter().sum()
    }

    /// The used places, by row.
    pub(in super::super) fn rows(&self) -> Vec<&[Reference]> {
        self.places.chunks(ROW).zip(&self.used).map(|(row, &used)| &row[..used]).collect()
    }

    /// As many places as are used, which hold anything.
    pub(super) fn space(&mut self) -> &mut [Reference] {
        let len = self.len();
        &mut self.places[..len]
    }

    /// All references side by side.
    pub(super) fn pack(&mut self) -> &mut [Reference] {
        let mut len = 0;
        for (row, &used) in self.used.iter().enumerate() {
            self.places.copy_within(row * ROW..row * ROW + used, len);
            len += used;
        }
        // Rows are what they were only if all are full.
        self.used = vec![ROW; len / ROW];
        self.used.push(len % ROW);
        &mut self.places[..len]
    }
}
