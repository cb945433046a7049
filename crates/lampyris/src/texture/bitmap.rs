//! Pictures on surfaces.

use std::sync::Arc;

use glam::{Affine2, Vec2};

use super::Wrap;
use crate::image::Image;
use crate::spectrum::Spectrum;

/// A picture over the unit square of texture coordinates, (0, 0) at its bottom left corner. Values are cut to 0..1.
#[derive(Clone, Debug)]
pub struct Bitmap {
    /// The picture, linear, at least one pixel.
    pub image: Arc<Image>,
    /// Nearest pixel instead of bilinear interpolation.
    pub nearest: bool,
    /// What is outside the unit square.
    pub wrap: Wrap,
    /// Applied to (u, v) first.
    pub to_uv: Affine2,
}

impl Bitmap {
    /// The colour at these texture coordinates.
    pub fn at(&self, uv: Vec2) -> Spectrum {
        let size = Vec2::new(self.image.width() as f32, self.image.height() as f32);
        let uv = self.to_uv.transform_point2(uv);
        let pixel = Vec2::new(uv.x, 1.0 - uv.y) * size;
        if !pixel.is_finite() {
            return Spectrum::ZERO;
        }
        if self.nearest {
            let corner = pixel.floor();
            return self.pixel(corner.x as i64, corner.y as i64);
        }
        let corner = (pixel - 0.5).floor();
        let t = pixel - 0.5 - corner;
        let (x, y) = (corner.x as i64, corner.y as i64);
        let row = |y| self.pixel(x, y) * (1.0 - t.x) + self.pixel(x + 1, y) * t.x;
        row(y) * (1.0 - t.y) + row(y + 1) * t.y
    }

    fn pixel(&self, x: i64, y: i64) -> Spectrum {
        let pixel = self.image.pixel(self.wrapped(x, self.image.width()), self.wrapped(y, self.image.height()));
        Spectrum::from_rgb(pixel.map(|value| value.clamp(0.0, 1.0)))
    }

    fn wrapped(&self, index: i64, size: usize) -> usize {
        let size = size as i64;
        let wrapped = match self.wrap {
            Wrap::Repeat => index.rem_euclid(size),
            Wrap::Clamp | Wrap::Black | Wrap::White => index.clamp(0, size - 1),
            Wrap::Mirror => {
                let index = index.rem_euclid(2 * size);
                index.min(2 * size - 1 - index)
            }
        };
        wrapped as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_by_one(wrap: Wrap, nearest: bool) -> Bitmap {
        let image = Image::from_pixels(2, 1, vec![[0.0; 3], [1.0; 3]]).expect("two pixels");
        Bitmap { image: Arc::new(image), nearest, wrap, to_uv: Affine2::IDENTITY }
    }

    fn grey(bitmap: &Bitmap, u: f32) -> f32 {
        bitmap.at(Vec2::new(u, 0.5)).to_rgb()[0]
    }

    #[test]
    fn pixel_centres_have_their_own_colour_and_the_middle_the_mean() {
        let bitmap = two_by_one(Wrap::Clamp, false);
        assert_eq!([0.25, 0.5, 0.75].map(|u| grey(&bitmap, u)), [0.0, 0.5, 1.0]);
    }

    #[test]
    fn outside_the_square_the_picture_repeats_clamps_or_mirrors() {
        assert_eq!(grey(&two_by_one(Wrap::Repeat, true), 1.25), 0.0);
        assert_eq!(grey(&two_by_one(Wrap::Clamp, true), 1.25), 1.0);
        assert_eq!(grey(&two_by_one(Wrap::Mirror, true), 1.25), 1.0);
        assert_eq!(grey(&two_by_one(Wrap::Mirror, true), 1.75), 0.0);
    }
}
