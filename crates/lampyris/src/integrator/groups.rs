//! Which pixels' paths lend each other what they find (theory §4.7).

use std::ops::Range;

use super::Pass;
use crate::sampler::{Sampler, purpose};

/// The pixels of a picture in groups, each of which is at least one, all of them in some group.
pub(super) struct Groups<'a> {
    pass: &'a Pass,
    /// Pixels in a row, some of which may lie beside the picture.
    width: usize,
    /// Whether there is more than one in a group.
    share: bool,
}

/// A group is drawn from a tile of so many pixels, anew in each pass: paths of pixels nearby find much the same, but the noise
/// of those that touch should not be alike.
const TILE: [usize; 2] = [8, 8];

/// Pixels of a group: more of them leave less noise, but each is asked about what every other has found; measured.
pub(super) const GROUP: usize = 16;

impl<'a> Groups<'a> {
    /// Of more than one pixel if they share.
    pub(super) fn new(pass: &'a Pass, width: usize, share: bool) -> Groups<'a> {
        Groups { pass, width, share }
    }

    /// Pixels that the largest group has.
    pub(super) fn most(&self) -> usize {
        if self.share { GROUP } else { 1 }
    }

    /// So many rows stay together; no group lies across the border of two of these strips.
    pub(super) fn rows(&self) -> usize {
        if self.share { TILE[1] } else { 1 }
    }

    /// The groups of a strip, their pixels by column and row.
    pub(super) fn of_strip(&self, rows: Range<usize>) -> impl Iterator<Item = Vec<[usize; 2]>> {
        let columns = if self.share { TILE[0] } else { 1 };
        (0..self.width).step_by(columns).flat_map(move |first| {
            let columns = first..(first + columns).min(self.width);
            let mut pixels: Vec<[usize; 2]> = rows.clone().flat_map(|y| columns.clone().map(move |x| [x, y])).collect();
            if self.share {
                let tile = (rows.start * self.width + first) as u64;
                let mut sampler = Sampler::new(self.pass.seed, self.pass.index, purpose::GROUPS, tile);
                pixels.sort_by_cached_key(|_| sampler.uniform().to_bits());
            }
            let groups: Vec<Vec<[usize; 2]>> = pixels.chunks(self.most()).map(<[_]>::to_vec).collect();
            groups
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(groups: &Groups, height: usize) -> Vec<[usize; 2]> {
        let strips = (0..height).step_by(groups.rows()).map(|y| y..(y + groups.rows()).min(height));
        strips.flat_map(|rows| groups.of_strip(rows).flatten().collect::<Vec<_>>()).collect()
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
