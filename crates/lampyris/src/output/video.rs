//! Pictures one after the other: animated PNG and GIF.

use std::path::Path;

use ::gif::{Encoder, Frame, Repeat};

use super::png::codes;
use crate::error::{Error, Result};
use crate::image::Image;

/// A format for moving pictures that we write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VideoFormat {
    /// Animated PNG: every bit of each picture, 8 bits a channel.
    Apng,
    /// GIF: 256 colours a picture, and times in hundredths of a second.
    Gif,
}

impl VideoFormat {
    /// The format that the extension of `path` names, in either case; none if it names another.
    pub fn of(path: &Path) -> Option<VideoFormat> {
        match path.extension()?.to_string_lossy().to_lowercase().as_str() {
            "apng" => Some(VideoFormat::Apng),
            "gif" => Some(VideoFormat::Gif),
            _ => None,
        }
    }
}

/// Fails if a film cannot have so many pictures a second.
///
/// # Errors
/// A rate that is not between 0.1 and 240.
pub fn check_frame_rate(frames_per_second: f64) -> Result<()> {
    match (0.1..=240.0).contains(&frames_per_second) {
        true => Ok(()),
        false => Err(Error::new(format!("a film has between 0.1 and 240 pictures a second, not {frames_per_second}"))),
    }
}

/// The bytes of a film that goes on for ever, of pictures of one size in linear display light.
///
/// # Errors
/// No picture, pictures of several sizes or larger than the format can tell, or a rate that is not between 0.1 and 240 a second.
pub fn encode_video(
    format: VideoFormat,
    frames_per_second: f64,
    frames: impl ExactSizeIterator<Item = Image>,
) -> Result<Vec<u8>> {
    check_frame_rate(frames_per_second)?;
    let mut frames = frames.peekable();
    let Some(first) = frames.peek() else { return Err(Error::new("a film needs at least one picture")) };
    let size = (first.width(), first.height());
    let frames = frames.map(|frame| match (frame.width(), frame.height()) == size {
        true => Ok(codes(&frame)),
        false => Err(Error::new("the pictures of a film must have one size")),
    });
    match format {
        VideoFormat::Apng => apng(size, frames_per_second, frames),
        VideoFormat::Gif => gif(size, frames_per_second, frames),
    }
}

fn apng(
    (width, height): (usize, usize),
    rate: f64,
    frames: impl ExactSizeIterator<Item = Result<Vec<u8>>>,
) -> Result<Vec<u8>> {
    let fail = |error: ::png::EncodingError| Error::new(format!("the film cannot be written as PNG: {error}"));
    let side = |length: usize| u32::try_from(length).map_err(|_| Error::new("the film is too large for PNG"));
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, side(width)?, side(height)?);
    encoder.set_color(::png::ColorType::Rgb);
    encoder.set_depth(::png::BitDepth::Eight);
    let count = u32::try_from(frames.len()).map_err(|_| Error::new("the film has too many pictures for PNG"))?;
    // 0 plays are endless ones.
    encoder.set_animated(count, 0).map_err(fail)?;
    encoder.set_frame_delay(100, (rate * 100.0).round() as u16).map_err(fail)?;
    let mut writer = encoder.write_header().map_err(fail)?;
    for frame in frames {
        writer.write_image_data(&frame?).map_err(fail)?;
    }
    writer.finish().map_err(fail)?;
    Ok(bytes)
}

fn gif((width, height): (usize, usize), rate: f64, frames: impl Iterator<Item = Result<Vec<u8>>>) -> Result<Vec<u8>> {
    // From 1, best, to 30, fastest.
    const QUANTIZATION: i32 = 10;
    let fail = |error: ::gif::EncodingError| Error::new(format!("the film cannot be written as GIF: {error}"));
    let side = |length: usize| {
        u16::try_from(length)
            .map_err(|_| Error::new("a GIF is at most 65535 pixels wide and high").with_hint("use .apng"))
    };
    let (width, height) = (side(width)?, side(height)?);
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height, &[]).map_err(fail)?;
    encoder.set_repeat(Repeat::Infinite).map_err(fail)?;
    for frame in frames {
        let mut frame = Frame::from_rgb_speed(width, height, &frame?, QUANTIZATION);
        // Viewers take less than two hundredths for a mistake.
        frame.delay = (100.0 / rate).round().max(2.0) as u16;
        encoder.write_frame(&frame).map_err(fail)?;
    }
    drop(encoder);
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three greys, one after the other.
    fn frames() -> Vec<Image> {
        [0.0, 0.5, 1.0].map(|grey| Image::new(4, 2).map(|_| [grey; 3])).to_vec()
    }

    #[test]
    fn an_apng_has_all_pictures_and_their_time() {
        let bytes = encode_video(VideoFormat::Apng, 25.0, frames().into_iter()).expect("encodes");
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().expect("valid");
        let animation = reader.info().animation_control.expect("animated");
        assert_eq!((animation.num_frames, animation.num_plays), (3, 0));
        let mut buffer = vec![0; reader.output_buffer_size().expect("a size")];
        for code in [0, 188, 255] {
            reader.next_frame(&mut buffer).expect("a picture");
            assert!(buffer.iter().all(|&value| value == code), "{buffer:?}");
            let frame = reader.info().frame_control.expect("a time");
            assert_eq!(f64::from(frame.delay_den) / f64::from(frame.delay_num), 25.0);
        }
    }

    #[test]
    fn a_gif_has_all_pictures_and_their_time() {
        let bytes = encode_video(VideoFormat::Gif, 20.0, frames().into_iter()).expect("encodes");
        let mut options = ::gif::DecodeOptions::new();
        options.set_color_output(::gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&bytes[..]).expect("valid");
        for code in [0, 188, 255] {
            let frame = decoder.read_next_frame().expect("valid").expect("a picture");
            assert_eq!((frame.delay, frame.width, frame.height), (5, 4, 2));
            assert!(frame.buffer.chunks(4).all(|pixel| pixel == [code, code, code, 255]), "{:?}", frame.buffer);
        }
        assert!(decoder.read_next_frame().expect("valid").is_none());
    }

    #[test]
    fn what_makes_no_film_is_refused() {
        assert!(encode_video(VideoFormat::Apng, 25.0, Vec::new().into_iter()).is_err());
        assert!(encode_video(VideoFormat::Gif, 0.0, frames().into_iter()).is_err());
        let mixed = vec![Image::new(1, 1), Image::new(2, 1)];
        assert!(encode_video(VideoFormat::Gif, 10.0, mixed.into_iter()).is_err());
        let wide = vec![Image::new(70_000, 1)];
        let error = encode_video(VideoFormat::Gif, 10.0, wide.into_iter()).expect_err("too wide");
        assert!(error.to_string().contains("65535"), "{error}");
    }
}
