//! Squares of two colours.

use glam::Affine2;

use super::{Lookup, Texture};
use crate::spectrum::Spectrum;

/// Two colours in squares of half a unit of (u, v).
#[derive(Clone, Debug)]
pub struct Checkerboard {
    /// Where (u mod 1 > ½) and (v mod 1 > ½) are both true or both false.
    pub color0: Texture,
    /// Elsewhere.
    pub color1: Texture,
    /// Applied to (u, v) first.
    pub to_uv: Affine2,
}

impl Checkerboard {
    /// The colour there.
    pub fn at(&self, lookup: &Lookup) -> Spectrum {
        let p = self.to_uv.transform_point2(lookup.uv).fract_gl();
        if (p.x > 0.5) == (p.y > 0.5) { self.color0.at(lookup) } else { self.color1.at(lookup) }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    #[test]
    fn neighbouring_squares_differ_and_diagonal_ones_do_not() {
        let [color0, color1] = [Spectrum::ONE, Spectrum::ZERO].map(Texture::Constant);
        let board = Checkerboard { color0, color1, to_uv: Affine2::IDENTITY };
        let at = |u, v| board.at(&Lookup::point(Vec2::new(u, v)));
        assert_eq!(at(0.2, 0.2), Spectrum::ONE);
        assert_eq!(at(0.7, 0.2), Spectrum::ZERO);
        assert_eq!(at(0.7, 0.7), Spectrum::ONE);
        assert_eq!(at(-0.3, 1.2), Spectrum::ZERO);
    }
}
