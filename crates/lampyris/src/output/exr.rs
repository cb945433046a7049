//! OpenEXR.

use std::io::Cursor;

use ::exr::image::{AnyChannels, Encoding, FlatSamples, Layer, SpecificChannels};
use ::exr::meta::MetaData;
use ::exr::prelude::{Compression, LineOrder, ReadChannels, ReadLayers, Vec2, WritableImage, read};

use super::limits::check_compressed_size;
use crate::error::{Error, Result};
use crate::image::Image;

/// 32-bit floats in channels R, G and B, in scan lines, with lossless ZIP compression.
pub(super) fn encode(image: &Image) -> Result<Vec<u8>> {
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: ::exr::image::Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let channels = SpecificChannels::rgb(|position: Vec2<usize>| {
        let [r, g, b] = image.pixel(position.x(), position.y());
        (r, g, b)
    });
    let mut bytes = Vec::new();
    ::exr::image::Image::from_encoded_channels((image.width(), image.height()), encoding, channels)
        .write()
        .non_parallel()
        .to_buffered(Cursor::new(&mut bytes))
        .map_err(|error| Error::new(format!("the picture cannot be written as EXR: {error}")))?;
    Ok(bytes)
}

/// Reads the first colour in the file: channels R, G and B, or Y alone, by those names first and then under any
/// layer's name (`beauty.R`). The picture is the data window; the display window is not filled up.
/// With it comes the opacity: channel A of the same layer, where there is one.
pub(super) fn decode(bytes: &[u8]) -> Result<(Image, Option<Vec<f32>>)> {
    // In builds with debug assertions the crate asserts what only a damaged file breaks; without them it returns
    // errors. Either way nothing outlives the failed attempt.
    let decoded = std::panic::catch_unwind(|| decode_trusting(bytes));
    decoded.unwrap_or_else(|_| Err(Error::new("the EXR file is damaged")))
}

fn decode_trusting(bytes: &[u8]) -> Result<(Image, Option<Vec<f32>>)> {
    check_header(bytes)?;
    let file = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(fail)?;
    let colour = file.layer_data.iter().find_map(|layer| Some((layer, colour_channels(&layer.channel_data)?)));
    let Some((layer, channels)) = colour else {
        let names = file.layer_data.iter().flat_map(|layer| &layer.channel_data.list);
        let names: Vec<_> = names.map(|channel| channel.name.to_string()).collect();
        return Err(Error::new("the EXR file has no colour: neither channels R, G, B nor Y")
            .with_hint(format!("it has {}", names.join(" "))));
    };
    Ok((picture(layer, channels), opacity(layer, channels)))
}

fn fail(error: ::exr::error::Error) -> Error {
    match error {
        ::exr::error::Error::NotSupported(what) => Error::new(format!("the EXR file cannot be read: {what}")),
        error => Error::new(format!("the EXR file is damaged: {error}")),
    }
}

/// Refuses sizes that the file cannot hold, before anything is allocated for them.
fn check_header(bytes: &[u8]) -> Result<()> {
    // Deflate makes at most 1032 bytes of one, which is this many pixels where a pixel is one half. The DCT of
    // DWA packs 64 into one first.
    const PIXELS_PER_BYTE: u64 = 1032 / 2;
    const PIXELS_PER_BYTE_OF_DWA: u64 = 64 * PIXELS_PER_BYTE;
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(fail)?;
    for header in &meta.headers {
        if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
            return Err(Error::new(
                "the EXR file has channels of lower resolution than its pixels, which are not read",
            )
            .with_hint("save it as RGB"));
        }
        let ratio = match header.compression {
            Compression::DWAA(_) | Compression::DWAB(_) => PIXELS_PER_BYTE_OF_DWA,
            _ => PIXELS_PER_BYTE,
        };
        let Vec2(width, height) = header.layer_size;
        // Channels lie in memory side by side, all of them.
        let width_of_all = (width as u64).saturating_mul(header.channels.list.len().max(1) as u64);
        check_compressed_size(width as u64, height as u64, bytes.len(), ratio)?;
        check_compressed_size(width_of_all, (height as u64).div_ceil(4), bytes.len(), ratio)?;
    }
    Ok(())
}

/// The indices of the channels to show as red, green and blue.
fn colour_channels(channels: &AnyChannels<FlatSamples>) -> Option<[usize; 3]> {
    let names: Vec<_> = channels.list.iter().map(|channel| channel.name.to_string()).collect();
    let find = |layer: &str, channel: &str| names.iter().position(|name| *name == format!("{layer}{channel}"));
    let colour_of = |layer: &str| {
        let rgb = || Some([find(layer, "R")?, find(layer, "G")?, find(layer, "B")?]);
        rgb().or_else(|| Some([find(layer, "Y")?; 3]))
    };
    let layers = names.iter().filter_map(|name| name.rfind('.').map(|dot| &name[..=dot]));
    std::iter::once("").chain(layers).find_map(colour_of)
}

fn picture(layer: &Layer<AnyChannels<FlatSamples>>, channels: [usize; 3]) -> Image {
    let mut image = Image::new(layer.size.x(), layer.size.y());
    for (channel, index) in channels.into_iter().enumerate() {
        let samples = layer.channel_data.list[index].sample_data.values_as_f32();
        for (pixel, sample) in image.pixels_mut().iter_mut().zip(samples) {
            pixel[channel] = sample;
        }
    }
    image
}

/// The channel A of the layer to which these channels belong.
fn opacity(layer: &Layer<AnyChannels<FlatSamples>>, channels: [usize; 3]) -> Option<Vec<f32>> {
    let list = &layer.channel_data.list;
    let color = list[channels[0]].name.to_string();
    let name = format!("{}A", &color[..color.rfind('.').map_or(0, |dot| dot + 1)]);
    let channel = list.iter().find(|channel| channel.name.to_string() == name)?;
    Some(channel.sample_data.values_as_f32().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::exr::prelude::{AnyChannel, SmallVec};

    fn file(channels: &[(&str, FlatSamples)]) -> Vec<u8> {
        let list: SmallVec<_> =
            channels.iter().map(|(name, samples)| AnyChannel::new(*name, samples.clone())).collect();
        let mut bytes = Vec::new();
        ::exr::image::Image::from_channels((2, 1), AnyChannels::sort(list))
            .write()
            .to_buffered(Cursor::new(&mut bytes))
            .expect("encodes");
        bytes
    }

    fn single(a: f32, b: f32) -> FlatSamples {
        FlatSamples::F32(vec![a, b])
    }

    #[test]
    fn alpha_is_dropped_and_half_is_read() {
        let half = FlatSamples::F16([0.5, 2.0].map(::exr::prelude::f16::from_f32).to_vec());
        let bytes = file(&[("R", single(1.0, 2.0)), ("G", half), ("B", single(5.0, 6.0)), ("A", single(0.0, 0.0))]);
        assert_eq!(decode(&bytes).expect("valid").0.pixels(), [[1.0, 0.5, 5.0], [2.0, 2.0, 6.0]]);
        assert_eq!(decode(&bytes).expect("valid").1, Some(vec![0.0, 0.0]));
    }

    #[test]
    fn luminance_alone_is_grey() {
        assert_eq!(decode(&file(&[("Y", single(1.0, 2.0))])).expect("valid").0.pixels(), [[1.0; 3], [2.0; 3]]);
    }

    #[test]
    fn the_colour_of_a_named_layer_is_found() {
        let channels =
            [("depth.Z", 9.0), ("beauty.R", 1.0), ("beauty.G", 2.0), ("beauty.B", 3.0)].map(|(n, v)| (n, single(v, v)));
        assert_eq!(decode(&file(&channels)).expect("valid").0.pixel(0, 0), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn a_file_without_colour_says_what_it_has() {
        let error = decode(&file(&[("Z", single(1.0, 2.0))])).expect_err("no colour");
        assert!(error.to_string().contains("no colour") && error.to_string().contains('Z'), "{error}");
    }
}
