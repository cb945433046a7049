//! A picture in memory: linear radiance, three floats a pixel.
pub(crate) mod convolve;

/// Linear RGB radiance, row by row, the top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
}

impl Image {
    /// A black picture.
    pub fn new(width: usize, height: usize) -> Image {
        Image { width, height, pixels: vec![[0.0; 3]; width * height] }
    }

    /// A picture of these pixels, row by row; `None` unless there are `width × height` of them.
    pub fn from_pixels(width: usize, height: usize, pixels: Vec<[f32; 3]>) -> Option<Image> {
        (width.checked_mul(height) == Some(pixels.len())).then_some(Image { width, height, pixels })
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels, row by row, the top row first.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// All pixels, row by row, the top row first.
    pub fn into_pixels(self) -> Vec<[f32; 3]> {
        self.pixels
    }

    /// All pixels, to change.
    pub fn pixels_mut(&mut self) -> &mut [[f32; 3]] {
        &mut self.pixels
    }

    /// The pixel in column `x`, row `y`.
    ///
    /// # Panics
    /// Outside the picture.
    pub fn pixel(&self, x: usize, y: usize) -> [f32; 3] {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) lies outside {}×{}", self.width, self.height);
        self.pixels[y * self.width + x]
    }

    /// The same picture with each pixel changed by `change`.
    #[must_use]
    pub fn map(&self, change: impl Fn([f32; 3]) -> [f32; 3]) -> Image {
        Image { width: self.width, height: self.height, pixels: self.pixels.iter().map(|&p| change(p)).collect() }
    }

    /// The mean over pixels and channels.
    pub fn mean(&self) -> f64 {
        let sum: f64 = self.pixels.iter().flatten().map(|&value| f64::from(value)).sum();
        sum / (3 * self.pixels.len()).max(1) as f64
    }

    /// The largest finite value of any channel, or 0 in a black picture.
    pub fn max(&self) -> f32 {
        self.pixels.iter().flatten().copied().filter(|v| v.is_finite()).fold(0.0, f32::max)
    }
}

/// What a display can show of a value: cut off at 0 and 1, and 0 for what is no number.
pub(crate) fn displayable(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

/// Relative luminance of linear sRGB, ITU-R BT.709.
pub fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.212_671 * r + 0.715_16 * g + 0.072_169 * b
}
