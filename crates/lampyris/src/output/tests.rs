//! What holds for every format.

use std::path::{Path, PathBuf};

use proptest::prelude::*;

use super::*;
use crate::shared_tests::shared;
use crate::spectrum::srgb_to_linear;

/// A picture with small, large, zero and negative values, none of them alike.
fn sample() -> Image {
    let mut image = Image::new(21, 13);
    for (index, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let at = index as f32;
        *pixel = [at * 0.01, (at * 0.7).sin().abs() * 3.0, if index % 7 == 0 { 0.0 } else { 1.0 / (at + 1.0) }];
    }
    image
}

fn jpeg() -> Vec<u8> {
    let codes: Vec<u8> = sample().pixels().iter().flatten().map(|v| (v.min(1.0) * 255.0) as u8).collect();
    let mut bytes = Vec::new();
    ::image::codecs::jpeg::JpegEncoder::new(&mut bytes)
        .encode(&codes, 21, 13, ::image::ExtendedColorType::Rgb8)
        .expect("encodes");
    bytes
}

fn tga() -> Vec<u8> {
    let codes: Vec<u8> = (0..21 * 13 * 4).map(|i| (i / 16) as u8).collect();
    let mut bytes = Vec::new();
    ::image::codecs::tga::TgaEncoder::new(&mut bytes)
        .encode(&codes, 21, 13, ::image::ExtendedColorType::Rgba8)
        .expect("encodes");
    bytes
}

/// A valid file of every format that is read; the name of a TGA must say so.
fn files() -> Vec<(&'static str, Vec<u8>)> {
    let mut files: Vec<_> =
        Format::ALL.map(|f| (f.extension(), encode(f, &sample()).expect("encodes"))).into_iter().collect();
    let mut p6 = b"P6 21 13 255\n".to_vec();
    p6.extend((0..21 * 13 * 3).map(|i| i as u8));
    files.extend([("P6", p6), ("jpeg", jpeg()), ("tga", tga())]);
    files
}

fn image() -> impl Strategy<Value = Image> {
    (1usize..20, 1usize..20).prop_flat_map(|(width, height)| {
        let value = prop_oneof![0.0f32..1.0, 0.0f32..1e4, Just(0.0)];
        proptest::collection::vec(proptest::array::uniform3(value), width * height)
            .prop_map(move |pixels| Image::from_pixels(width, height, pixels).expect("as many as its size says"))
    })
}

proptest! {
    #[test]
    fn formats_of_floats_keep_every_bit(image in image()) {
        for format in [Format::Exr, Format::Npy, Format::Pfm] {
            let bytes = encode(format, &image).expect("encodes");
            prop_assert_eq!(&decode("x", &bytes).expect("decodes"), &image);
        }
    }

    #[test]
    fn ppm_is_exact_to_half_a_step(image in image()) {
        let decoded = decode("x", &encode(Format::Ppm, &image).expect("encodes")).expect("decodes");
        let half_a_step = image.max() * (0.5 / 65535.0 + f32::EPSILON);
        for (a, b) in decoded.pixels().iter().flatten().zip(image.pixels().iter().flatten()) {
            prop_assert!((a - b).abs() <= half_a_step);
        }
    }

    #[test]
    fn hdr_is_exact_to_half_a_step_of_the_largest_channel(image in image()) {
        let decoded = decode("x", &encode(Format::Hdr, &image).expect("encodes")).expect("decodes");
        for (a, b) in decoded.pixels().iter().zip(image.pixels()) {
            let largest = b.iter().copied().fold(0.0, f32::max);
            for channel in 0..3 {
                prop_assert!((a[channel] - b[channel]).abs() <= largest / 255.0, "{:?} became {:?}", b, a);
            }
        }
    }

    #[test]
    fn png_is_exact_to_half_a_code_value(image in image()) {
        let decoded = decode("x", &encode(Format::Png, &image).expect("encodes")).expect("decodes");
        for (a, b) in decoded.pixels().iter().flatten().zip(image.pixels().iter().flatten()) {
            let codes = [*a, b.min(1.0)].map(|v| crate::spectrum::linear_to_srgb(v) * 255.0);
            prop_assert!((codes[0] - codes[1]).abs() <= 0.501);
        }
    }

    #[test]
    fn arbitrary_bytes_are_refused_without_panic(
        which in 0..files().len(),
        bytes in proptest::collection::vec(any::<u8>(), 0..300),
    ) {
        let (_, valid) = &files()[which];
        let _ = decode_texture("x", &bytes, false);
        let _ = decode_texture("x.tga", &bytes, false);
        let _ = decode_texture("x.tga", &[&valid[..valid.len().min(8)], &bytes[..]].concat(), true);
    }

    #[test]
    fn damaged_files_do_not_panic(
        which in 0..files().len(),
        damage in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..6),
        header_only in any::<bool>(),
    ) {
        let (_, mut bytes) = files().swap_remove(which);
        let length = if header_only { bytes.len().min(400) } else { bytes.len() };
        for (at, value) in damage {
            bytes[at.index(length)] = value;
        }
        let _ = decode_texture("x.tga", &bytes, false);
    }
}

#[test]
fn a_file_cut_short_anywhere_is_an_error() {
    for (name, bytes) in files() {
        // Decoders of JPEG fill up what is missing, and a PNG is whole before its last chunk; a PPM in text does
        // not miss the digits of its last number.
        let tail = match name {
            "jpeg" => continue,
            "png" => 16,
            "ppm" => 6,
            _ => 1,
        };
        for length in (0..=bytes.len() - tail).step_by(7).chain([bytes.len() - tail]) {
            assert!(decode("x.tga", &bytes[..length]).is_err(), "{name} cut to {length} of {}", bytes.len());
        }
    }
}

#[test]
fn a_jpeg_cut_short_does_not_panic() {
    let bytes = jpeg();
    for length in 0..bytes.len() {
        let _ = decode("x", &bytes[..length]);
    }
}

#[test]
fn negative_and_infinite_values_survive_in_formats_of_floats() {
    let image = Image::from_pixels(1, 1, vec![[-1.5, f32::INFINITY, f32::MIN_POSITIVE / 4.0]]).expect("one pixel");
    for format in [Format::Exr, Format::Npy, Format::Pfm] {
        let decoded = decode("x", &encode(format, &image).expect("encodes")).expect("decodes");
        assert_eq!(decoded, image, "{format:?}");
    }
}

#[test]
fn textures_are_decoded_from_srgb_unless_raw() {
    let p6 = b"P6 1 1 255\n\x00\x80\xff".to_vec();
    let png = {
        let mut bytes = Vec::new();
        let encoder = ::image::codecs::png::PngEncoder::new(&mut bytes);
        let rgb = ::image::ExtendedColorType::Rgb8;
        ::image::ImageEncoder::write_image(encoder, &[0, 0x80, 0xff], 1, 1, rgb).expect("encodes");
        bytes
    };
    let half = 128.0 / 255.0;
    for bytes in [p6, png] {
        let pixel = |raw| decode_texture("x", &bytes, raw).expect("decodes").color(0, 0);
        assert_eq!(pixel(true), [0.0, half, 1.0]);
        assert_eq!(pixel(false), [0.0, srgb_to_linear(half), 1.0]);
    }
}

#[test]
fn textures_of_floats_stay_as_they_are() {
    for format in [Format::Exr, Format::Npy, Format::Pfm, Format::Ppm] {
        let bytes = encode(format, &sample()).expect("encodes");
        let pixels = [false, true].map(|raw| decode_texture("x", &bytes, raw).expect("decodes"));
        assert_eq!(pixels[0], pixels[1], "{format:?}");
    }
}

#[test]
fn greys_transparency_and_16_bits_in_png_are_read() {
    use ::image::{DynamicImage, ImageBuffer, ImageFormat, LumaA};
    let pixels = ImageBuffer::from_pixel(1, 1, LumaA([0x8000u16, 0x1234]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    DynamicImage::ImageLumaA16(pixels).write_to(&mut bytes, ImageFormat::Png).expect("encodes");
    let image = decode_texture("x", bytes.get_ref(), true).expect("decodes");
    assert_eq!(image.color(0, 0), [32768.0 / 65535.0; 3]);
    assert_eq!((image.opacity(0, 0), image.bytes()), (0x1234 as f32 / 65535.0, 4));
}

#[test]
fn a_picture_without_pixels_is_not_written() {
    for format in Format::ALL {
        assert!(encode(format, &Image::new(0, 4)).is_err(), "{format:?}");
    }
}

#[test]
fn an_unknown_extension_is_refused_with_the_known_ones() {
    let error = check_path(Path::new("a.tiff")).expect_err("unknown").to_string();
    assert!(error.contains("'.tiff'") && error.contains(".exr .hdr .npy .pfm .png .ppm"), "{error}");
    let error = check_path(Path::new("a.exrr")).expect_err("unknown").to_string();
    assert!(error.contains("did you mean .exr?"), "{error}");
    assert!(check_path(Path::new("a")).expect_err("none").to_string().contains("no extension"));
}

#[test]
fn a_checked_path_is_written_in_either_case_and_read_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.PFM");
    check_path(&path).expect("can be written");
    assert!(!path.exists(), "checking writes nothing");
    write_image(&path, &sample()).expect("writes");
    assert_eq!(read_image(&path).expect("reads"), sample());
    assert!(check_path(&folder.path().join("no/a.exr")).is_err());
}

#[test]
fn an_error_names_the_file() {
    let error = decode("lamp.png", &encode(Format::Png, &sample()).expect("encodes")[..60]).expect_err("cut short");
    assert!(error.to_string().starts_with("lamp.png: "), "{error}");
    let missing = read_image(Path::new("/no/such.exr")).expect_err("missing");
    assert!(missing.message.contains("no such file"), "{missing}");
}

/// Every picture below a folder.
fn pictures(folder: &Path, extensions: &[&str], found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            pictures(&path, extensions, found);
        } else if path.extension().is_some_and(|e| extensions.iter().any(|known| e == *known)) {
            found.push(path);
        }
    }
}

#[test]
fn pictures_from_other_programs_are_read() {
    let Some(root) = shared("") else { return };
    let mut paths = Vec::new();
    pictures(&root, &["npy", "exr", "hdr", "pfm", "png", "jpg"], &mut paths);
    for path in paths {
        let bytes = std::fs::read(&path).expect("readable");
        if bytes.starts_with(b"version https://git-lfs") {
            continue;
        }
        let image = decode(&path.to_string_lossy(), &bytes).unwrap_or_else(|error| panic!("{error}"));
        assert!(image.mean() > 0.0 && image.max() > 0.0, "{} is black", path.display());
    }
}
