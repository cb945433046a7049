//! Which pixels' paths lend each other what they find (theory §4.7).

use std::ops::Range;

use super::Pass;
use crate::sampler::{Sampler, purpose};

/// The pixels of a picture in groups, each of which is at least one, all of them in some group.
pub(super) struct Groups<'a> {
    pass: &'a Pass,
    /// Pixels in a row, some of which may lie beside the picture.
    width: usize,
    /// Of the tiles from which groups are drawn.
    tile: usize,
    /// Where the second tile of a row and of a column begins.
    offset: [usize; 2],
}

/// A group is drawn from a tile of so many pixels in width and height, anew in each pass: paths of pixels nearby find much the
/// same, but the noise of those that touch should not be alike.
const TILE: usize = 8;

/// Pixels of a group: more of them leave less noise, but each is asked about what every other has found; measured.
const GROUP: usize = 16;

impl<'a> Groups<'a> {
    /// Of more than one pixel if they share.
    pub(super) fn new(pass: &'a Pass, width: usize, share: bool) -> Groups<'a> {
        let tile = if share { TILE } else { 1 };
        let mut sampler = Sampler::new(pass.seed, pass.index, purpose::GROUPS, u64::MAX);
        // Other tiles in each pass, so that none shows.
        let offset = [(); 2].map(|()| 1 + (sampler.uniform() * tile as f32) as usize);
        Groups { pass, width, tile, offset }
    }

    /// Pixels that the largest group has.
    pub(super) fn most(&self) -> usize {
        GROUP.min(self.tile * self.tile)
    }

    /// So many rows in strips: no group lies across the border of two.
    pub(super) fn strips(&self, rows: usize) -> Vec<Range<usize>> {
        self.tiles(rows, self.offset[1]).collect()
    }

    /// The groups of a strip, their pixels by column and row.
    pub(super) fn of_strip(&self, rows: Range<usize>) -> impl Iterator<Item = Vec<[usize; 2]>> {
        self.tiles(self.width, self.offset[0]).flat_map(move |columns| {
            let mut pixels: Vec<[usize; 2]> = rows.clone().flat_map(|y| columns.clone().map(move |x| [x, y])).collect();
            if pixels.len() > 1 {
                let tile = (rows.start * self.width + columns.start) as u64;
                let mut sampler = Sampler::new(self.pass.seed, self.pass.index, purpose::GROUPS, tile);
                pixels.sort_by_cached_key(|_| sampler.uniform().to_bits());
            }
            let groups: Vec<Vec<[usize; 2]>> = pixels.chunks(self.most()).map(<[_]>::to_vec).collect();
            groups
        })
    }

    /// So many pixels in tiles, of which the second begins here.
    fn tiles(&self, pixels: usize, second: usize) -> impl Iterator<Item = Range<usize>> {
        let tile = self.tile;
        let later = (second..pixels).step_by(tile).map(move |first| first..(first + tile).min(pixels));
        std::iter::once(0..second.min(pixels)).chain(later)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(groups: &Groups, height: usize) -> Vec<[usize; 2]> {
        groups.strips(height).into_iter().flat_map(|rows| groups.of_strip(rows).flatten().collect::<Vec<_>>()).collect()
    }

    #[test]
    fn every_pixel_is_in_one_group() {
        let pass = Pass { index: 3, seed: 1 };
        for share in [false, true] {
            let groups = Groups::new(&pass, 21, share);
            let mut pixels = all(&groups, 19);
            let ordered: Vec<[usize; 2]> = (0..19).flat_map(|y| (0..21).map(move |x| [x, y])).collect();
            assert_eq!(pixels == ordered, !share);
            pixels.sort_unstable_by_key(|&[x, y]| [y, x]);
            assert_eq!(pixels, ordered);
        }
    }

    #[test]
    fn every_pass_has_other_groups() {
        let of = |index| all(&Groups::new(&Pass { index, seed: 1 }, 16, true), 16);
        assert_eq!(of(0), of(0));
        assert_ne!(of(0), of(1));
    }
}
