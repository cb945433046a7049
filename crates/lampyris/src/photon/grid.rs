//! The cells of the photon map: which are occupied, and where their photons begin.

use glam::{UVec3, Vec3};

use crate::geometry::Bounds;

/// Cells are numbered x fastest, so that the cells of a query box form one run of photons for every row (y, z). A cell
/// is longer in y and z than in x: few rows, tight ends. Most cells are empty, as photons lie on surfaces: a bit tells,
/// and only occupied ones have a number.
#[derive(Debug)]
pub(super) struct Grid {
    origin: Vec3,
    inverse_cell: Vec3,
    size: UVec3,
    words_per_row: u32,
    /// A bit for each cell, rows padded to whole words; and one word more, without bits.
    words: Vec<Word>,
    /// `starts[i]..starts[i + 1]` are the photons of the i-th occupied cell.
    starts: Vec<u32>,
}

/// Sixty-four cells in a row.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Word {
    occupied: u64,
    /// How many cells before this word are occupied.
    rank: u32,
}

/// Length of a cell in y and z over the radius that is asked for, and over its length in x: on surfaces, larger cells
/// have more photons to try, and smaller ones more rows.
const CELL_OVER_RADIUS: f32 = 1.5;
const CELL_OVER_STEP: f32 = 4.0;

/// Cells in a word.
pub(super) const WORD: u32 = u64::BITS;

impl Grid {
    /// Without photons yet: cells for queries with about this radius, of at most `max_words` words. Photons outside
    /// the box belong to the nearest cell.
    pub(super) fn sized(bounds: &Bounds, radius: f32, max_words: u32) -> Grid {
        let extent = bounds.max - bounds.min;
        let longest = extent.max_element();
        // Where the radius says nothing, the box does; and where that says nothing, all photons lie in one point, or
        // there are none.
        let usable = |cell: f32| cell.is_finite() && cell > 0.0;
        let mut cell = [CELL_OVER_RADIUS * radius, longest].into_iter().find(|&cell| usable(cell)).unwrap_or(1.0);
        cell = cell.max(longest / 4096.0);
        loop {
            let lengths = Vec3::new(cell / CELL_OVER_STEP, cell, cell);
            // Tiny cells have no finite inverse; larger ones do.
            let inverse_cell = (1.0 / lengths).min(Vec3::splat(f32::MAX));
            // Also what is infinite saturates.
            let size = (extent * inverse_cell).floor().as_uvec3().min(UVec3::splat(1 << 20)) + UVec3::ONE;
            let words_per_row = size.x.div_ceil(WORD);
            let words = u64::from(words_per_row) * u64::from(size.y) * u64::from(size.z);
            if words <= u64::from(max_words.max(1)) {
                let words = vec![Word::default(); words as usize + 1];
                return Grid { origin: bounds.min, inverse_cell, size, words_per_row, words, starts: Vec::new() };
            }
            cell *= 1.25;
        }
    }

    /// The radius of queries for which the cells are made.
    pub(super) fn radius(&self) -> f32 {
        1.0 / (CELL_OVER_RADIUS * self.inverse_cell.y)
    }

    /// How many words there are.
    pub(super) fn word_count(&self) -> u32 {
        self.words.len() as u32 - 1
    }

    #[inline]
    fn coordinates(&self, point: Vec3) -> UVec3 {
        // Float to integer conversion saturates: what lies outside belongs to the border.
        ((point - self.origin) * self.inverse_cell).max(Vec3::ZERO).as_uvec3().min(self.size - UVec3::ONE)
    }

    /// The number of the bit of a point's cell.
    #[inline]
    pub(super) fn cell_of(&self, point: Vec3) -> u32 {
        let at = self.coordinates(point);
        (at.z * self.size.y + at.y) * (self.words_per_row * WORD) + at.x
    }

    /// How many occupied cells lie before this one.
    #[inline(always)]
    fn rank(&self, row: u32, x: u32) -> u32 {
        let word = &self.words[(row * self.words_per_row + x / WORD) as usize];
        word.rank + (word.occupied & ((1 << (x % WORD)) - 1)).count_ones()
    }

    /// Calls `visit` with ranges of photons that together hold all within `radius` of `center`.
    ///
    /// Rounding loses none: a photon whose rounded distance is below the radius lies between the rounded ends of the
    /// box, and the cell grows with the coordinate.
    #[inline(always)]
    pub(super) fn rows(&self, center: Vec3, radius: f32, mut visit: impl FnMut(usize, usize)) {
        let low = self.coordinates(center - radius);
        let high = self.coordinates(center + radius);
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                let row = z * self.size.y + y;
                let (first, last) = (self.rank(row, low.x), self.rank(row, high.x + 1));
                if first < last {
                    visit(self.starts[first as usize] as usize, self.starts[last as usize] as usize);
                }
            }
        }
    }

    /// The words, in parts of these lengths, to be filled.
    pub(super) fn split(&mut self, lengths: impl Iterator<Item = usize>) -> Vec<&mut [Word]> {
        split(&mut self.words, lengths)
    }

    /// Where the photons of each occupied cell begin, after the words were filled; and at the end, how many there are.
    pub(super) fn finish(&mut self, mut starts: Vec<u32>, photons: u32) {
        if let Some(last) = self.words.last_mut() {
            last.rank = starts.len() as u32;
        }
        starts.push(photons);
        self.starts = starts;
    }
}

/// Slices of these lengths, one after the other.
pub(super) fn split<T>(mut all: &mut [T], lengths: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    let part = |length| {
        let (part, rest) = std::mem::take(&mut all).split_at_mut(length);
        all = rest;
        part
    };
    lengths.map(part).collect()
}

/// A run of words under construction, numbered from its first cell.
impl Word {
    /// Marks a cell as occupied.
    #[inline]
    pub(super) fn occupy(words: &mut [Word], cell: u32) {
        words[(cell / WORD) as usize].occupied |= 1 << (cell % WORD);
    }

    /// Counts the occupied cells before each word; returns how many there are in all.
    pub(super) fn count(words: &mut [Word], before: u32) -> u32 {
        let mut rank = before;
        for word in words {
            word.rank = rank;
            rank += word.occupied.count_ones();
        }
        rank
    }

    /// The number of an occupied cell among the occupied.
    #[inline]
    pub(super) fn number(words: &[Word], cell: u32) -> usize {
        let word = &words[(cell / WORD) as usize];
        (word.rank + (word.occupied & ((1 << (cell % WORD)) - 1)).count_ones()) as usize
    }
}
