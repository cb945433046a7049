//! The picture as far as it is known, row by row.

use std::sync::{Mutex, MutexGuard, PoisonError};

use lampyris::image::Image;

/// What there is to show: the mean of the passes so far, and where the pass under way is done with a row, with it. Locked
/// for no longer than it takes to copy.
#[derive(Debug)]
pub struct Canvas(Mutex<State>);

#[derive(Debug)]
struct State {
    /// Mean of the whole passes.
    mean: Image,
    passes: u32,
    shown: Image,
    /// When each row changed last, by `clock`; 0 for never.
    changed: Vec<u64>,
    clock: u64,
}

/// Rows that lie side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// The number of the first, from the top.
    pub first: usize,
    /// How many there are.
    pub count: usize,
    /// Their pixels.
    pub pixels: Vec<[f32; 3]>,
}

impl Canvas {
    /// Black.
    pub fn new([width, height]: [u32; 2]) -> Canvas {
        let black = Image::new(width as usize, height as usize);
        let changed = vec![0; height as usize];
        Canvas(Mutex::new(State { mean: black.clone(), passes: 0, shown: black, changed, clock: 0 }))
    }

    /// A row of the pass under way.
    pub fn row(&self, y: usize, pixels: &[[f32; 3]]) {
        let mut state = self.state();
        let State { mean, passes, shown, changed, clock } = &mut *state;
        let width = mean.width();
        if y >= changed.len() || pixels.len() != width {
            return;
        }
        let (before, row) = (*passes as f32, y * width..(y + 1) * width);
        for ((shown, mean), new) in shown.pixels_mut()[row.clone()].iter_mut().zip(&mean.pixels()[row]).zip(pixels) {
            *shown = std::array::from_fn(|channel| (mean[channel] * before + new[channel]) / (before + 1.0));
        }
        *clock += 1;
        changed[y] = *clock;
    }

    /// The mean of so many whole passes.
    pub fn passed(&self, image: Image, passes: u32) {
        let mut state = self.state();
        state.clock += 1;
        let clock = state.clock;
        state.changed.fill(clock);
        state.shown.clone_from(&image);
        state.mean = image;
        state.passes = passes;
    }

    /// The size.
    pub fn size(&self) -> (usize, usize) {
        let state = self.state();
        (state.shown.width(), state.shown.height())
    }

    /// All of it; none as long as there is nothing to see.
    pub fn image(&self) -> Option<Image> {
        let state = self.state();
        (state.clock > 0).then(|| state.shown.clone())
    }

    /// What has changed since `seen`, in blocks of at most so many rows; `seen` becomes now.
    pub fn since(&self, seen: &mut u64, most_rows: usize) -> Vec<Rows> {
        let state = self.state();
        let width = state.shown.width();
        let mut blocks: Vec<Rows> = Vec::new();
        for (y, _) in state.changed.iter().enumerate().filter(|&(_, &at)| at > *seen) {
            let row = &state.shown.pixels()[y * width..(y + 1) * width];
            match blocks.last_mut() {
                Some(block) if block.first + block.count == y && block.count < most_rows => {
                    block.count += 1;
                    block.pixels.extend_from_slice(row);
                }
                _ => blocks.push(Rows { first: y, count: 1, pixels: row.to_vec() }),
            }
        }
        *seen = state.clock;
        blocks
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_a_pass_count_as_much_as_those_before() {
        let canvas = Canvas::new([1, 2]);
        assert!(canvas.image().is_none());
        canvas.row(1, &[[3.0; 3]]);
        assert_eq!(canvas.image().expect("a row").pixels(), [[0.0; 3], [3.0; 3]]);
        canvas.passed(Image::from_pixels(1, 2, vec![[1.0; 3], [2.0; 3]]).expect("two pixels"), 2);
        canvas.row(0, &[[4.0; 3]]);
        assert_eq!(canvas.image().expect("a row").pixels(), [[2.0; 3], [2.0; 3]]);
    }

    #[test]
    fn only_what_is_new_is_told_in_blocks() {
        let canvas = Canvas::new([1, 5]);
        let mut seen = 0;
        assert!(canvas.since(&mut seen, 2).is_empty());
        for y in [4, 0, 1, 2] {
            canvas.row(y, &[[y as f32; 3]]);
        }
        let blocks: Vec<(usize, usize)> =
            canvas.since(&mut seen, 2).iter().map(|rows| (rows.first, rows.count)).collect();
        assert_eq!(blocks, [(0, 2), (2, 1), (4, 1)]);
        assert!(canvas.since(&mut seen, 2).is_empty());
        canvas.row(3, &[[3.0; 3]]);
        assert_eq!(canvas.since(&mut seen, 2), [Rows { first: 3, count: 1, pixels: vec![[3.0; 3]] }]);
    }
}
