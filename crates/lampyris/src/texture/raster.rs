//! Pictures as textures keep them: decoded, but no larger in memory than their file's numbers need.

use std::sync::LazyLock;

use half::f16;
use half::slice::HalfFloatSliceExt;

use crate::image::Image;
use crate::spectrum::srgb_to_linear;

/// A picture of one to four channels: grey, grey and opacity, colour, or colour and opacity. The opacity is straight:
/// colours are not multiplied by it. Texels lie row by row, the top row first, their channels side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    width: usize,
    height: usize,
    channels: usize,
    texels: Texels,
    curve: Curve,
}

/// The numbers of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// 0 to 255 for 0..1.
    Bytes(Vec<u8>),
    /// 0 to 65535 for 0..1.
    Words(Vec<u16>),
    /// Half floats.
    Halves(Vec<f16>),
    /// Floats.
    Floats(Vec<f32>),
}

/// What the numbers of the colours in a picture mean; an opacity is always linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curve {
    /// They are linear.
    Linear,
    /// They are under the sRGB curve.
    Srgb,
}

impl Raster {
    /// A picture of these texels. Floats under the sRGB curve become linear here.
    ///
    /// None unless there are one to four channels, and `width × height × channels` numbers, at least one.
    pub fn new(width: usize, height: usize, channels: usize, texels: Texels, curve: Curve) -> Option<Raster> {
        let count = width.checked_mul(height)?.checked_mul(channels)?;
        if !(1..=4).contains(&channels) || count == 0 || count != texels.len() {
            return None;
        }
        Some(Raster { width, height, channels, texels, curve: Curve::Linear }.with_curve(curve))
    }

    /// Linear floats of three channels; none of a picture without pixels.
    pub fn of_image(image: Image) -> Option<Raster> {
        let (width, height) = (image.width(), image.height());
        Raster::new(width, height, 3, Texels::Floats(image.into_pixels().into_flattened()), Curve::Linear)
    }

    /// The same colours with the opacities of as many texels beside them; as before where their number is another.
    #[must_use]
    pub fn with_opacity(self, opacity: &[f32]) -> Raster {
        if opacity.len() != self.width * self.height {
            return self;
        }
        let pixels = (0..opacity.len()).map(|index| self.color_of(index));
        let texels = pixels.zip(opacity).flat_map(|([r, g, b], &a)| [r, g, b, a]).collect();
        Raster { channels: 4, texels: Texels::Floats(texels), curve: Curve::Linear, ..self }
    }

    /// All that it is: what kind of numbers they are and how they lie, and their bytes in the machine's order.
    pub(crate) fn identity(&self) -> (String, &[u8]) {
        let (kind, bytes) = match &self.texels {
            Texels::Bytes(texels) => ("bytes", texels.as_slice()),
            Texels::Words(texels) => ("words", bytemuck::cast_slice(texels)),
            Texels::Halves(texels) => ("halves", bytemuck::cast_slice(texels.reinterpret_cast())),
            Texels::Floats(texels) => ("floats", bytemuck::cast_slice(texels)),
        };
        (format!("{kind} {:?} {}×{}×{}", self.curve, self.width, self.height, self.channels), bytes)
    }

    /// The same numbers, which mean this.
    #[must_use]
    pub fn with_curve(mut self, curve: Curve) -> Raster {
        if curve == Curve::Linear || !self.is_float() {
            self.curve = curve;
            return self;
        }
        let colors = self.colors();
        let linear = |at: usize| {
            let stored = self.texels.stored(at);
            if at % self.channels < colors { srgb_to_linear(stored) } else { stored }
        };
        self.texels = Texels::Floats((0..self.texels.len()).map(linear).collect());
        self
    }

    /// The same picture in less memory, where nothing is lost by it: grey in one channel, no opacity where all is
    /// opaque, floats as halves where these hold the same values.
    #[must_use]
    pub fn compact(mut self) -> Raster {
        if let Texels::Floats(values) = &self.texels
            && values.iter().all(|&value| f16::from_f32(value).to_f32().to_bits() == value.to_bits())
        {
            self.texels = Texels::Halves(values.iter().map(|&value| f16::from_f32(value)).collect());
        }
        let grey =
            self.colors() == 3 && self.texels.all(self.channels, |texel| texel[0] == texel[1] && texel[1] == texel[2]);
        let opaque = self.has_opacity()
            && match &self.texels {
                Texels::Bytes(values) => opaque(values, self.channels, u8::MAX),
                Texels::Words(values) => opaque(values, self.channels, u16::MAX),
                Texels::Halves(values) => opaque(values, self.channels, f16::ONE),
                Texels::Floats(values) => opaque(values, self.channels, 1.0),
            };
        let colors = if grey { 1 } else { self.colors() };
        let opacity = (self.has_opacity() && !opaque).then_some(self.channels - 1);
        let kept: Vec<usize> = (0..colors).chain(opacity).collect();
        if kept.len() < self.channels {
            self.texels = self.texels.keep(self.channels, &kept);
            self.channels = kept.len();
        }
        self
    }

    /// Texels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Whether there is an opacity.
    pub fn has_opacity(&self) -> bool {
        self.channels.is_multiple_of(2)
    }

    /// How many numbers a texel has.
    pub(super) fn channels(&self) -> usize {
        self.channels
    }

    pub(super) fn is_byte(&self) -> bool {
        matches!(self.texels, Texels::Bytes(_))
    }

    pub(super) fn is_half(&self) -> bool {
        matches!(self.texels, Texels::Halves(_))
    }

    /// Whether the numbers are such that they can lie outside 0..1.
    pub fn is_float(&self) -> bool {
        matches!(self.texels, Texels::Halves(_) | Texels::Floats(_))
    }

    /// Memory that the texels take.
    pub fn bytes(&self) -> usize {
        match &self.texels {
            Texels::Bytes(values) => values.len(),
            Texels::Words(values) => 2 * values.len(),
            Texels::Halves(values) => 2 * values.len(),
            Texels::Floats(values) => 4 * values.len(),
        }
    }

    /// The linear colour of the texel in column `x`, row `y`.
    ///
    /// # Panics
    /// Outside the picture.
    #[inline]
    pub fn color(&self, x: usize, y: usize) -> [f32; 3] {
        self.color_of(self.index(x, y))
    }

    /// The opacity of the texel in column `x`, row `y`: 1 where there is none.
    ///
    /// # Panics
    /// Outside the picture.
    #[inline]
    pub fn opacity(&self, x: usize, y: usize) -> f32 {
        let index = self.index(x, y);
        if self.has_opacity() { self.texels.stored((index + 1) * self.channels - 1) } else { 1.0 }
    }

    /// As linear floats, without opacity.
    pub fn to_image(&self) -> Image {
        let mut image = Image::new(self.width, self.height);
        image.pixels_mut().iter_mut().enumerate().for_each(|(index, pixel)| *pixel = self.color_of(index));
        image
    }

    /// Channels that are no opacity.
    fn colors(&self) -> usize {
        self.channels - usize::from(self.has_opacity())
    }

    #[inline]
    fn index(&self, x: usize, y: usize) -> usize {
        assert!(x < self.width && y < self.height, "texel ({x}, {y}) lies outside {}×{}", self.width, self.height);
        y * self.width + x
    }

    #[inline]
    fn color_of(&self, index: usize) -> [f32; 3] {
        let first = index * self.channels;
        if self.channels < 3 {
            return [self.linear(first); 3];
        }
        [self.linear(first), self.linear(first + 1), self.linear(first + 2)]
    }

    #[inline]
    fn linear(&self, at: usize) -> f32 {
        match (&self.texels, self.curve) {
            (Texels::Bytes(values), Curve::Srgb) => BYTES[usize::from(values[at])],
            (Texels::Words(values), Curve::Srgb) => WORDS[usize::from(values[at])],
            (texels, _) => texels.stored(at),
        }
    }
}

/// What the codes of 8 bits under the sRGB curve stand for.
static BYTES: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|code| srgb_to_linear(code as f32 / 255.0)));

/// What the codes of 16 bits under the sRGB curve stand for.
static WORDS: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=u16::MAX).map(|code| srgb_to_linear(f32::from(code) / 65535.0)).collect());

impl Texels {
    fn len(&self) -> usize {
        match self {
            Texels::Bytes(values) => values.len(),
            Texels::Words(values) => values.len(),
            Texels::Halves(values) => values.len(),
            Texels::Floats(values) => values.len(),
        }
    }

    /// The number as a float, whatever its curve.
    #[inline]
    fn stored(&self, at: usize) -> f32 {
        match self {
            Texels::Bytes(values) => f32::from(values[at]) / 255.0,
            Texels::Words(values) => f32::from(values[at]) / 65535.0,
            Texels::Halves(values) => values[at].to_f32(),
            Texels::Floats(values) => values[at],
        }
    }

    fn all(&self, channels: usize, test: impl Fn([f32; 3]) -> bool) -> bool {
        let firsts = (0..self.len()).step_by(channels);
        firsts.into_iter().all(|first| test([0, 1, 2].map(|channel| self.stored(first + channel))))
    }

    /// These channels alone.
    fn keep(self, channels: usize, kept: &[usize]) -> Texels {
        match self {
            Texels::Bytes(values) => Texels::Bytes(keep(&values, channels, kept)),
            Texels::Words(values) => Texels::Words(keep(&values, channels, kept)),
            Texels::Halves(values) => Texels::Halves(keep(&values, channels, kept)),
            Texels::Floats(values) => Texels::Floats(keep(&values, channels, kept)),
        }
    }
}

fn keep<T: Copy>(values: &[T], channels: usize, kept: &[usize]) -> Vec<T> {
    values.chunks_exact(channels).flat_map(|texel| kept.iter().map(|&channel| texel[channel])).collect()
}

fn opaque<T: Copy + PartialEq>(values: &[T], channels: usize, one: T) -> bool {
    values.chunks_exact(channels).all(|texel| texel[channels - 1] == one)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_decoded_by_their_curve_and_opacity_never() {
        let picture = |curve| Raster::new(1, 1, 4, Texels::Bytes(vec![0, 128, 255, 128]), curve).expect("one texel");
        let half = 128.0 / 255.0;
        assert_eq!(picture(Curve::Linear).color(0, 0), [0.0, half, 1.0]);
        assert_eq!(picture(Curve::Srgb).color(0, 0), [0.0, srgb_to_linear(half), 1.0]);
        assert_eq!(picture(Curve::Srgb).opacity(0, 0), half);
        let words = Raster::new(1, 1, 2, Texels::Words(vec![0x8000, 0x8000]), Curve::Srgb).expect("one texel");
        let half = 32768.0 / 65535.0;
        assert_eq!((words.color(0, 0), words.opacity(0, 0)), ([srgb_to_linear(half); 3], half));
        let floats = Raster::new(1, 1, 2, Texels::Floats(vec![0.5, 0.5]), Curve::Srgb).expect("one texel");
        assert_eq!((floats.color(0, 0), floats.opacity(0, 0)), ([srgb_to_linear(0.5); 3], 0.5));
    }

    #[test]
    fn what_is_not_needed_takes_no_memory_and_no_value_changes() {
        let of = |channels, texels| Raster::new(2, 1, channels, texels, Curve::Linear).expect("two texels");
        for (picture, bytes) in [
            (of(3, Texels::Bytes(vec![7, 7, 7, 9, 9, 9])), 2),
            (of(3, Texels::Bytes(vec![7, 7, 7, 9, 9, 8])), 6),
            (of(4, Texels::Bytes(vec![1, 2, 3, 255, 4, 5, 6, 255])), 6),
            (of(4, Texels::Bytes(vec![2, 2, 2, 255, 6, 6, 6, 254])), 4),
            (of(2, Texels::Words(vec![2, 65535, 6, 65535])), 4),
            (of(1, Texels::Floats(vec![0.5, 65504.0])), 4),
            (of(1, Texels::Floats(vec![0.1, f32::INFINITY])), 8),
        ] {
            let compact = picture.clone().compact();
            assert_eq!(compact.bytes(), bytes);
            for x in 0..2 {
                assert_eq!(compact.color(x, 0), picture.color(x, 0));
                assert_eq!(compact.opacity(x, 0), picture.opacity(x, 0));
            }
        }
    }

    #[test]
    fn sizes_that_do_not_fit_make_no_picture() {
        let of = |width, height, channels| {
            Raster::new(width, height, channels, Texels::Bytes(vec![0; 6]), Curve::Linear).is_some()
        };
        assert!(of(2, 1, 3) && of(3, 2, 1));
        assert!(!of(2, 2, 3) && !of(6, 1, 0) && !of(usize::MAX, 2, 3) && !of(1, 1, 6));
        assert!(Raster::new(0, 4, 3, Texels::Bytes(vec![]), Curve::Linear).is_none());
    }
}
