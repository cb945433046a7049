//! Choosing a point of a square by weight, from tables so small that many of them stay near the processor.

use glam::Vec2;

/// Cells a side.
pub(super) const ACROSS: usize = 16;

/// A piecewise constant density over the unit square, as [`Grid`](crate::math::Grid) is one: of cells in columns along x and
/// rows along y.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct Mosaic {
    /// Where each row begins, in 65,536ths of all.
    rows: Row,
    /// And each cell of a row, of that row.
    cells: [Row; ACROSS],
}

type Row = [u16; ACROSS];

const WHOLE: f32 = 65_536.0;

impl Mosaic {
    /// Of cells with these positive weights, by rows: as near to them as 65,536ths can be, of which each row and each cell of a
    /// row has at least one.
    pub fn new(weights: &[f32; ACROSS * ACROSS]) -> Mosaic {
        let of_row = |row: usize| &weights[row * ACROSS..(row + 1) * ACROSS];
        let sums: [f32; ACROSS] = std::array::from_fn(|row| of_row(row).iter().sum());
        Mosaic { rows: starts(&sums), cells: std::array::from_fn(|row| starts(of_row(row))) }
    }

    /// The point of the unit square on which `u` falls, and the density there per area of the square.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (row, height, y) = choose(&self.rows, u.y);
        let (column, width, x) = choose(&self.cells[row], u.x);
        (Vec2::new(column as f32 + x, row as f32 + y) / ACROSS as f32, density(width, height))
    }

    /// The density per area of the square.
    #[inline]
    pub fn pdf(&self, at: Vec2) -> f32 {
        let [column, row] = (at * ACROSS as f32).to_array().map(|at| (at as usize).min(ACROSS - 1));
        density(share(&self.cells[row], column), share(&self.rows, row))
    }
}

#[inline]
fn density(width: f32, height: f32) -> f32 {
    const CELLS: f32 = (ACROSS * ACROSS) as f32;
    width * height * (CELLS / (WHOLE * WHOLE))
}

/// Where parts of these weights begin.
fn starts(weights: &[f32]) -> Row {
    let total: f64 = weights.iter().copied().map(f64::from).sum();
    let spare = f64::from(WHOLE) - ACROSS as f64;
    let mut before = 0.0;
    std::array::from_fn(|part| {
        let start = part as f64 + spare * if total > 0.0 { before / total } else { part as f64 / ACROSS as f64 };
        before += f64::from(weights[part]);
        start as u16
    })
}

/// How much a part has.
#[inline]
fn share(starts: &Row, part: usize) -> f32 {
    let end = starts.get(part + 1).map_or(WHOLE, |&end| f32::from(end));
    end - f32::from(starts[part])
}

/// The part on which `u` falls, how much it has, and where in it.
#[inline]
fn choose(starts: &Row, u: f32) -> (usize, f32, f32) {
    let at = u * WHOLE;
    let whole = at as u16;
    let not_above: u16 = starts.iter().map(|&start| u16::from(start <= whole)).sum();
    let part = usize::from(not_above.max(1) - 1);
    let share = share(starts, part);
    (part, share, ((at - f32::from(starts[part])) / share).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::Sampler;

    fn weights() -> [f32; ACROSS * ACROSS] {
        std::array::from_fn(|cell| if cell % 7 == 0 { 1e-9 } else { (cell * cell % 31) as f32 + 0.1 })
    }

    #[test]
    fn the_density_adds_up_to_one_and_follows_the_weights() {
        let (weights, mosaic) = (weights(), Mosaic::new(&weights()));
        let middle = |cell: usize| (Vec2::new((cell % ACROSS) as f32, (cell / ACROSS) as f32) + 0.5) / ACROSS as f32;
        let (total, cells) = (weights.iter().sum::<f32>(), (ACROSS * ACROSS) as f32);
        let mut sum = 0.0;
        for (cell, weight) in weights.iter().enumerate() {
            let pdf = mosaic.pdf(middle(cell));
            assert!(pdf > 0.0 && (pdf - weight / total * cells).abs() < 0.02, "{cell}: {pdf}");
            sum += f64::from(pdf);
        }
        assert!((sum / f64::from(cells) - 1.0).abs() < 1e-6, "{sum}");
    }

    #[test]
    fn points_fall_as_often_as_the_density_says() {
        let (mosaic, mut sampler, n) = (Mosaic::new(&weights()), Sampler::new(1, 0, 0, 0), 200_000);
        let mut counts = [0.0; ACROSS * ACROSS];
        for _ in 0..n {
            let (at, pdf) = mosaic.sample(sampler.square());
            assert_eq!(pdf, mosaic.pdf(at), "{at}");
            counts[(at.y * 16.0) as usize * ACROSS + (at.x * 16.0) as usize] += 1.0;
        }
        for (cell, count) in counts.iter().enumerate() {
            let at = (Vec2::new((cell % ACROSS) as f32, (cell / ACROSS) as f32) + 0.5) / ACROSS as f32;
            let due = f64::from(mosaic.pdf(at)) / (ACROSS * ACROSS) as f64;
            // Seven standard deviations, and a few for the rarest: false alarm 1e-9 for all cells.
            let allowed = 7.0 * (due * f64::from(n)).sqrt() + 7.0;
            assert!((count - due * f64::from(n)).abs() <= allowed, "{cell}: {count}");
        }
    }

    #[test]
    fn no_number_falls_beside_the_square() {
        let mosaic = Mosaic::new(&[0.0; ACROSS * ACROSS]);
        for u in [0.0, 0.5, crate::math::ONE_MINUS_EPSILON] {
            let (at, pdf) = mosaic.sample(Vec2::splat(u));
            assert!((at - u).abs().max_element() < 1e-3 && (pdf - 1.0).abs() < 1e-3, "{u}: {at}, {pdf}");
        }
    }
}
