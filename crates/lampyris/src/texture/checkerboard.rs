//! Squares of two colours.

use glam::{Affine2, Vec2};

use crate::spectrum::Spectrum;

/// Two colours in squares of half a unit of (u, v).
#[derive(Clone, Debug)]
pub struct Checkerboard {
    /// Where (u mod 1 > ½) and (v mod 1 > ½) are both true or both false.
    pub color0: Spectrum,
    /// Elsewhere.
    pub color1: Spectrum,
    /// Applied to (u, v) first.
    pub to_uv: Affine2,
}

impl Checkerboard {
    /// The colour at these texture coordinates.
    pub fn at(&self, uv: Vec2) -> Spectrum {
        let p = self.to_uv.transform_point2(uv).fract_gl();
        if (p.x > 0.5) == (p.y > 0.5) { self.color0 } else { self.color1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_squares_differ_and_diagonal_ones_do_not() {
        let board = Checkerboard { color0: Spectrum::ONE, color1: Spectrum::ZERO, to_uv: Affine2::IDENTITY };
        assert_eq!(board.at(Vec2::new(0.2, 0.2)), Spectrum::ONE);
        assert_eq!(board.at(Vec2::new(0.7, 0.2)), Spectrum::ZERO);
        assert_eq!(board.at(Vec2::new(0.7, 0.7)), Spectrum::ONE);
        assert_eq!(board.at(Vec2::new(-0.3, 1.2)), Spectrum::ZERO);
    }
}
