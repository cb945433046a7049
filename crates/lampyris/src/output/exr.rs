//! OpenEXR.

use std::io::Cursor;

use ::exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Layer};
use ::exr::meta::MetaData;
use ::exr::meta::attribute::{AttributeValue, Text};
use ::exr::meta::header::LayerAttributes;
use ::exr::prelude::{Compression, LineOrder, ReadChannels, ReadLayers, SmallVec, Vec2, WritableImage, read};

use super::limits::check_compressed_size;
use super::{Fact, Picture};
use crate::error::{Error, Result};
use crate::image::Image;

/// 32-bit floats in scan lines, with lossless ZIP compression: the picture in channels R, G and B, the layers in channels
/// with their names before a dot, and the facts as attributes of the header, `software` and `lampyris:NAME`.
pub(super) fn encode(picture: &Picture<'_>) -> Result<Vec<u8>> {
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: ::exr::image::Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let channel = |name: &str, image: &Image, index: usize| {
        let samples = image.pixels().iter().map(|pixel| pixel[index]).collect();
        AnyChannel::new(name, FlatSamples::F32(samples))
    };
    let image = picture.image;
    let mut list: SmallVec<[AnyChannel<FlatSamples>; 4]> =
        ["R", "G", "B"].iter().enumerate().map(|(index, name)| channel(name, image, index)).collect();
    let noisy = picture.noisy.map(|image| ("noisy", ["R", "G", "B"].as_slice(), image));
    let layers = picture.layers.iter().map(|(layer, image)| (layer.name(), layer.channels(), image));
    for (layer, names, image) in layers.chain(noisy) {
        let names = names.iter().enumerate();
        list.extend(names.map(|(index, name)| channel(&format!("{layer}.{name}"), image, index)));
    }
    let size = (image.width(), image.height());
    let layer = Layer::new(size, attributes(picture.facts), encoding, AnyChannels::sort(list));
    let mut bytes = Vec::new();
    ::exr::image::Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(Cursor::new(&mut bytes))
        .map_err(|error| Error::new(format!("the picture cannot be written as EXR: {error}")))?;
    Ok(bytes)
}

fn attributes(facts: &[(&str, Fact)]) -> LayerAttributes {
    // Readers take the bytes for UTF-8, as OpenEXR's own tools do.
    let text = |text: &str| Text::from_slice_unchecked(text.as_bytes());
    let value = |fact: &Fact| match fact {
        Fact::Text(words) => AttributeValue::Text(text(words)),
        Fact::Whole(number) => AttributeValue::I32(*number),
        Fact::Number(number) => AttributeValue::F64(*number),
    };
    LayerAttributes {
        software_name: Some(text(concat!("Lampyris ", env!("CARGO_PKG_VERSION")))),
        other: facts.iter().map(|(name, fact)| (text(&format!("lampyris:{name}")), value(fact))).collect(),
        ..LayerAttributes::default()
    }
}

/// Reads the first colour in the file: channels R, G and B, or Y alone, by those names first and then under any
/// layer's name (`beauty.R`). The picture is the data window; the display window is not filled up.
/// With it comes the opacity: channel A of the same layer, where there is one.
pub(super) fn decode(bytes: &[u8]) -> Result<(Image, Option<Vec<f32>>)> {
    decode_both(bytes, None)
}

/// The layer that is `asked` for by name: channels R, G, B or X, Y, Z, or one channel alone.
pub(super) fn decode_layer(bytes: &[u8], asked: &str) -> Result<Image> {
    Ok(decode_both(bytes, Some(asked))?.0)
}

fn decode_both(bytes: &[u8], asked: Option<&str>) -> Result<(Image, Option<Vec<f32>>)> {
    // In builds with debug assertions the crate asserts what only a damaged file breaks; without them it returns
    // errors. Either way nothing outlives the failed attempt.
    let decoded = std::panic::catch_unwind(|| decode_trusting(bytes, asked));
    decoded.unwrap_or_else(|_| Err(Error::new("the EXR file is damaged")))
}

fn decode_trusting(bytes: &[u8], asked: Option<&str>) -> Result<(Image, Option<Vec<f32>>)> {
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
    let channels = |channels: &AnyChannels<FlatSamples>| match asked {
        None => colour_channels(channels),
        Some(name) => layer_channels(channels, name),
    };
    let found = file.layer_data.iter().find_map(|layer| Some((layer, channels(&layer.channel_data)?)));
    let Some((layer, channels)) = found else {
        let names = file.layer_data.iter().flat_map(|layer| &layer.channel_data.list);
        let names: Vec<_> = names.map(|channel| channel.name.to_string()).collect();
        let message = match asked {
            None => "the EXR file has no colour: neither channels R, G, B nor Y".to_string(),
            Some(name) => format!("the EXR file has no layer '{name}'"),
        };
        return Err(Error::new(message).with_hint(format!("its channels are {}", names.join(" "))));
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
    // DWA packs 64 into one first, but its pieces begin with 88 bytes each.
    const PIXELS_PER_BYTE: u64 = 1032 / 2;
    const PIXELS_PER_BYTE_OF_DWA: u64 = 4 * PIXELS_PER_BYTE;
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
    let colour_of = |layer: &str| find(&names, layer, &["R", "G", "B"]).or_else(|| find(&names, layer, &["Y"; 3]));
    let layers = names.iter().filter_map(|name| name.rfind('.').map(|dot| &name[..=dot]));
    std::iter::once("").chain(layers).find_map(colour_of)
}

/// The indices of three channels of this layer, or three times that of its only one.
fn layer_channels(channels: &AnyChannels<FlatSamples>, layer: &str) -> Option<[usize; 3]> {
    let names: Vec<_> = channels.list.iter().map(|channel| channel.name.to_string()).collect();
    let layer = format!("{layer}.");
    let of_three = || find(&names, &layer, &["R", "G", "B"]).or_else(|| find(&names, &layer, &["X", "Y", "Z"]));
    of_three().or_else(|| {
        let mut own = (0..names.len()).filter(|&index| names[index].starts_with(&layer));
        own.next().filter(|_| own.next().is_none()).map(|index| [index; 3])
    })
}

/// The indices of these channels of a layer, whose name ends in a dot or is empty.
fn find(names: &[String], layer: &str, channels: &[&str; 3]) -> Option<[usize; 3]> {
    let index = |channel: &str| names.iter().position(|name| *name == format!("{layer}{channel}"));
    let [first, second, third] = channels.map(index);
    Some([first?, second?, third?])
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
    fn a_layer_is_found_by_its_name() {
        let channels =
            [("R", 7.0), ("depth.Z", 9.0), ("n.X", 1.0), ("n.Y", 2.0), ("n.Z", 3.0)].map(|(n, v)| (n, single(v, v)));
        let bytes = file(&channels);
        assert_eq!(decode_layer(&bytes, "n").expect("there").pixel(0, 0), [1.0, 2.0, 3.0]);
        assert_eq!(decode_layer(&bytes, "depth").expect("there").pixel(1, 0), [9.0; 3]);
        let error = decode_layer(&bytes, "albedo").expect_err("not there").to_string();
        assert!(error.contains("no layer 'albedo'") && error.contains("depth.Z"), "{error}");
    }

    /// What stands in the header, with OpenEXR's names for kinds.
    #[test]
    fn layers_and_facts_are_written() {
        let image = Image::from_pixels(2, 1, vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]).expect("two pixels");
        let depth = image.map(|pixel| [pixel[0]; 3]);
        let facts =
            [("scene", Fact::Text("küche.xml".into())), ("passes", Fact::Whole(16)), ("seconds", Fact::Number(0.25))];
        let layers = [(crate::film::Layer::Normal, image.clone()), (crate::film::Layer::Depth, depth.clone())];
        let bytes =
            encode(&Picture { image: &image, noisy: Some(&depth), layers: &layers, facts: &facts }).expect("encodes");
        assert_eq!(decode(&bytes).expect("a picture").0, image);
        assert_eq!(decode_layer(&bytes, "normal").expect("a layer"), image);
        assert_eq!(decode_layer(&bytes, "depth").expect("a layer"), depth);
        assert_eq!(decode_layer(&bytes, "noisy").expect("a layer"), depth);
        let header = &MetaData::read_from_buffered(Cursor::new(&bytes), true).expect("valid").headers[0];
        let names: Vec<String> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
        assert_eq!(
            names,
            ["B", "G", "R", "depth.Z", "noisy.B", "noisy.G", "noisy.R", "normal.X", "normal.Y", "normal.Z"]
        );
        let fact = |name: &str| header.own_attributes.other.get(&Text::from(name)).cloned();
        let scene = Text::from_slice_unchecked("küche.xml".as_bytes());
        assert_eq!(fact("lampyris:scene"), Some(AttributeValue::Text(scene)));
        assert_eq!(fact("lampyris:passes"), Some(AttributeValue::I32(16)));
        assert_eq!(fact("lampyris:seconds"), Some(AttributeValue::F64(0.25)));
        let software = header.own_attributes.software_name.as_ref().map(ToString::to_string);
        assert!(software.is_some_and(|name| name.starts_with("Lampyris ")));
    }

    #[test]
    fn a_file_without_colour_says_what_it_has() {
        let error = decode(&file(&[("Z", single(1.0, 2.0))])).expect_err("no colour");
        assert!(error.to_string().contains("no colour") && error.to_string().contains('Z'), "{error}");
    }
}
