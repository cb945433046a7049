//! Choosing a point of a square by weight.

use glam::Vec2;

use super::Distribution;

/// A piecewise constant density over the unit square: cells of equal size, in columns along x and rows along y.
#[derive(Clone, Debug)]
pub struct Grid {
    rows: Distribution,
    columns: Vec<Distribution>,
}

impl Grid {
    /// `width` × `height` cells, at least one each, whose density is proportional to `weight(column, row)`; uniform if
    /// all weights are zero.
    pub fn new(width: usize, height: usize, weight: impl Fn(usize, usize) -> f64) -> Grid {
        let mut sums = Vec::with_capacity(height);
        let columns = (0..height)
            .map(|row| {
                let weights: Vec<f64> = (0..width).map(|column| weight(column, row)).collect();
                sums.push(weights.iter().sum());
                Distribution::new(&weights)
            })
            .collect();
        Grid { rows: Distribution::new(&sums), columns }
    }

    /// The point of the unit square on which `u` falls, and the density there per area of the square.
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (row, row_probability, y) = self.rows.sample(u.y);
        let columns = &self.columns[row];
        let (column, probability, x) = columns.sample(u.x);
        let cells = Vec2::new(columns.len() as f32, self.rows.len() as f32);
        let at = Vec2::new(column as f32 + x, row as f32 + y) / cells;
        (at, row_probability * probability * cells.x * cells.y)
    }

    /// The inverse of [`Grid::sample`]: the point that falls on `at`.
    pub fn unsample(&self, at: Vec2) -> Vec2 {
        let (row, y) = cell(at.y, self.rows.len());
        let columns = &self.columns[row];
        let (column, x) = cell(at.x, columns.len());
        Vec2::new(columns.unsample(column, x), self.rows.unsample(row, y))
    }

    /// The density per area of the square.
    pub fn pdf(&self, at: Vec2) -> f32 {
        let (row, _) = cell(at.y, self.rows.len());
        let columns = &self.columns[row];
        let (column, _) = cell(at.x, columns.len());
        let probability = self.rows.probability(row) * columns.probability(column);
        probability * (columns.len() * self.rows.len()) as f32
    }
}

/// In which of so many equal parts of 0..1 a number lies, and where in it, 0 to 1.
fn cell(at: f32, cells: usize) -> (usize, f32) {
    let at = at * cells as f32;
    let cell = (at as usize).min(cells - 1);
    (cell, (at - cell as f32).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::Sampler;

    #[test]
    fn points_fall_as_often_as_the_cells_weigh() {
        let weights = [[1.0, 0.0, 2.0], [0.0, 5.0, 0.5]];
        let grid = Grid::new(3, 2, |column, row| weights[row][column]);
        let (mut sampler, mut counts, n) = (Sampler::new(1, 0, 0, 0), [[0.0_f64; 3]; 2], 40_000);
        for _ in 0..n {
            let (at, pdf) = grid.sample(sampler.square());
            assert_eq!(pdf, grid.pdf(at));
            let again = grid.sample(grid.unsample(at)).0;
            assert!((again - at).abs().max_element() < 1e-5, "{at} {again}");
            counts[(at.y * 2.0) as usize][(at.x * 3.0) as usize] += 1.0;
        }
        for (counts, weights) in counts.iter().flatten().zip(weights.iter().flatten()) {
            let due = weights / 8.5;
            // Six standard deviations: false alarm 1e-8 for all cells.
            let allowed = 6.0 * (due * (1.0 - due) * f64::from(n)).sqrt();
            assert!((counts - due * f64::from(n)).abs() <= allowed, "{counts} where {} are due", due * f64::from(n));
        }
    }
}
