//! Photons sorted by cell, on all threads, to the same order on any number of them: that of the cells, and within a
//! cell that in which they came.

use glam::Vec3;
use rayon::prelude::*;

use super::Photon;
use super::grid::{Grid, WORD, Word, split};
use crate::geometry::Bounds;

/// Where a photon lies before it is sorted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) block: u32,
    pub(super) index: u32,
}

/// Photons that one thread looks at in one go.
const CHUNK: usize = 8192;

/// Ranges of cells that hold about equally many photons.
const PARTS: usize = 64;

/// Words for each photon, at most: a fraction of what the photon itself takes.
const WORDS_PER_PHOTON: f64 = 0.5;

/// The grid for queries with this radius, and the places of the photons in its order.
pub(super) fn sort(blocks: &[Vec<Photon>], radius: f32) -> (Grid, Vec<Place>) {
    let count = blocks.iter().map(Vec::len).sum::<usize>();
    let sample = sample(blocks, count);
    let max_words = ((WORDS_PER_PHOTON * count as f64) as u32).clamp(64, 1 << 25);
    let mut grid = Grid::sized(&robust_bounds(&sample), radius, max_words);
    let parts = Parts::of(&grid, &sample);

    // Each chunk by itself, by part; then each part by itself, by cell. Nobody writes where another does.
    let chunk = |(block, photons): (usize, &Vec<Photon>)| {
        let places = (0..photons.len() as u32).step_by(CHUNK).map(move |index| Place { block: block as u32, index });
        places.collect::<Vec<Place>>()
    };
    let chunks: Vec<Place> = blocks.iter().enumerate().flat_map(chunk).collect();
    let chunks: Vec<Chunk> = chunks.into_par_iter().map(|first| Chunk::sort(blocks, first, &grid, &parts)).collect();

    let lengths: Vec<usize> = (0..PARTS).map(|part| chunks.iter().map(|chunk| chunk.of(part).len()).sum()).collect();
    let begins: Vec<usize> = sums(lengths.iter().copied());
    let mut order = vec![Place::default(); count];
    let work: Vec<_> = grid.split(parts.words()).into_iter().zip(split(&mut order, lengths.into_iter())).collect();
    let mut sorted: Vec<(&mut [Word], Vec<u32>)> = work
        .into_par_iter()
        .enumerate()
        .map(|(part, (words, order))| {
            let entries = chunks.iter().flat_map(|chunk| chunk.of(part).iter().map(|entry| (chunk.first, *entry)));
            let starts = sort_part(entries, parts.begins[part] * WORD, begins[part] as u32, words, order);
            (words, starts)
        })
        .collect();
    let ranks = sums(sorted.iter().map(|(_, starts)| starts.len()));
    sorted.par_iter_mut().zip(ranks).for_each(|((words, _), rank)| _ = Word::count(words, rank as u32));
    let starts: Vec<Vec<u32>> = sorted.into_iter().map(|(_, starts)| starts).collect();
    grid.finish(starts.concat(), count as u32);
    (grid, order)
}

/// Counting sort of the photons of one part by cell. Fills its words and its stretch of the order; returns where the
/// photons of each occupied cell begin in the whole order. Cells count from `first_cell`, photons from `begin`.
fn sort_part(
    entries: impl Iterator<Item = (Place, Entry)> + Clone,
    first_cell: u32,
    begin: u32,
    words: &mut [Word],
    order: &mut [Place],
) -> Vec<u32> {
    entries.clone().for_each(|(_, entry)| Word::occupy(words, entry.cell - first_cell));
    let mut starts = vec![0; Word::count(words, 0) as usize];
    entries.clone().for_each(|(_, entry)| starts[Word::number(words, entry.cell - first_cell)] += 1);
    let mut start = begin;
    for count in &mut starts {
        start += std::mem::replace(count, start);
    }
    let mut next = starts.clone();
    for (first, entry) in entries {
        let next = &mut next[Word::number(words, entry.cell - first_cell)];
        order[(*next - begin) as usize] = Place { block: first.block, index: first.index + entry.offset };
        *next += 1;
    }
    starts
}

/// A photon of a chunk.
#[derive(Clone, Copy, Default)]
struct Entry {
    cell: u32,
    offset: u32,
}

/// Some successive photons of a block, sorted by part.
struct Chunk {
    first: Place,
    entries: Vec<Entry>,
    /// Where each part begins, and the end.
    begins: [u32; PARTS + 1],
}

impl Chunk {
    fn sort(blocks: &[Vec<Photon>], first: Place, grid: &Grid, parts: &Parts) -> Chunk {
        let photons = &blocks[first.block as usize][first.index as usize..];
        let photons = &photons[..photons.len().min(CHUNK)];
        let cells: Vec<u32> = photons.iter().map(|photon| grid.cell_of(photon.position)).collect();
        let mut begins = [0; PARTS + 1];
        cells.iter().for_each(|&cell| begins[parts.of_cell(cell) + 1] += 1);
        for part in 0..PARTS {
            begins[part + 1] += begins[part];
        }
        let mut next = begins;
        let mut entries = vec![Entry::default(); cells.len()];
        for (&cell, offset) in cells.iter().zip(0..) {
            let next = &mut next[parts.of_cell(cell)];
            entries[*next as usize] = Entry { cell, offset };
            *next += 1;
        }
        Chunk { first, entries, begins }
    }

    fn of(&self, part: usize) -> &[Entry] {
        &self.entries[self.begins[part] as usize..self.begins[part + 1] as usize]
    }
}

/// Ranges of words, so cut that each holds about as many photons of the sample.
struct Parts {
    /// The first word of each, and the end.
    begins: [u32; PARTS + 1],
    /// A cell's number shifted by this much to the right is its place in the table.
    shift: u32,
    table: Vec<u8>,
}

impl Parts {
    fn of(grid: &Grid, sample: &[Vec3]) -> Parts {
        const TABLE: u32 = 4096;
        let words = grid.word_count();
        // In steps of a power of two words, that there may be a table.
        let step = words.div_ceil(TABLE).next_power_of_two();
        let mut steps: Vec<u32> = sample.iter().map(|&point| grid.cell_of(point) / WORD / step).collect();
        steps.sort_unstable();
        let mut begins = [0; PARTS + 1];
        for (part, begin) in begins.iter_mut().enumerate().take(PARTS).skip(1) {
            // Behind the step at the quantile, that this may be alone in its part.
            let quantile = steps.get(part * steps.len() / PARTS).map_or(0, |step| step + 1);
            *begin = (quantile * step).min(words);
        }
        begins[PARTS] = words;
        let part_of = |place: u32| begins[1..PARTS].partition_point(|&begin| begin <= place * step) as u8;
        let table = (0..words.div_ceil(step)).map(part_of).collect();
        Parts { begins, shift: (step * WORD).trailing_zeros(), table }
    }

    #[inline]
    fn of_cell(&self, cell: u32) -> usize {
        usize::from(self.table[(cell >> self.shift) as usize])
    }

    /// How many words each has.
    fn words(&self) -> impl Iterator<Item = usize> + '_ {
        self.begins.windows(2).map(|pair| (pair[1] - pair[0]) as usize)
    }
}

/// The sum of those before each.
fn sums(lengths: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut sum = 0;
    let before = |length| {
        sum += length;
        sum - length
    };
    lengths.map(before).collect()
}

/// The positions of some four thousand photons.
fn sample(blocks: &[Vec<Photon>], count: usize) -> Vec<Vec3> {
    blocks.iter().flatten().step_by((count / 4096).max(1)).map(|photon| photon.position).collect()
}

/// The box that holds nearly all points: a few far ones (photons run far on an infinite plane) must not make the cells
/// of all others large.
fn robust_bounds(sample: &[Vec3]) -> Bounds {
    let sorted = |axis: usize| {
        let mut values: Vec<f32> = sample.iter().map(|point| point[axis]).collect();
        values.sort_unstable_by(f32::total_cmp);
        values
    };
    let mut bounds = Bounds::EMPTY;
    if sample.is_empty() {
        return Bounds { min: Vec3::ZERO, max: Vec3::ZERO };
    }
    for axis in 0..3 {
        let values = sorted(axis);
        let cut = values.len() / 200;
        let (low, high) = (values[cut], values[values.len() - 1 - cut]);
        let margin = 0.05 * (high - low);
        bounds.min[axis] = (low - margin).max(values[0]);
        bounds.max[axis] = (high + margin).min(values[values.len() - 1]);
    }
    bounds
}

/// About how far the `nearest`-th nearest photon is from a typical photon, as if they lay on a surface: the median over
/// some photons of the distance to their eighth nearest within a thinned-out set, scaled.
pub(super) fn typical_distance(blocks: &[Vec<Photon>], nearest: usize) -> f32 {
    const EIGHTH: usize = 8;
    let count = blocks.iter().map(Vec::len).sum::<usize>();
    let thinned = sample(blocks, count);
    let distances: Vec<Option<f32>> = thinned
        .par_iter()
        .step_by((thinned.len() / 64).max(1))
        .map(|&center| {
            let mut distances: Vec<f32> = thinned.iter().map(|point| point.distance_squared(center)).collect();
            // The photon itself is the nearest.
            (distances.len() > EIGHTH).then(|| *distances.select_nth_unstable_by(EIGHTH, f32::total_cmp).1)
        })
        .collect();
    let mut distances: Vec<f32> = distances.into_iter().flatten().collect();
    if distances.is_empty() {
        return f32::INFINITY;
    }
    let middle = distances.len() / 2;
    let median = *distances.select_nth_unstable_by(middle, f32::total_cmp).1;
    let thinning = (count / 4096).max(1);
    (median * nearest as f32 / (EIGHTH * thinning) as f32).sqrt()
}
