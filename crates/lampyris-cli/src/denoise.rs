//! Pictures without their noise: `lampyris denoise`, and the end of `lampyris render --denoise`.

use std::path::{Path, PathBuf};

use lampyris::denoise::{Denoiser, Guides};
use lampyris::error::Result;
use lampyris::film::Layer;
use lampyris::image::Image;
use lampyris::output::{Fact, Picture, check_path, read_image, read_layer};

use crate::args::DenoiseArguments;
use crate::films::{self, is_film};
use crate::report::Failure;

/// Layers that help to tell edges and textures from noise.
pub const GUIDES: [Layer; 2] = [Layer::Albedo, Layer::Normal];

/// `lampyris denoise`.
///
/// # Errors
/// A build without denoiser, and what keeps files from being read or written. Nothing is written then.
pub fn run(arguments: &DenoiseArguments) -> Result<(), Failure> {
    let denoiser = Denoiser::new()?;
    arguments.outputs.iter().try_for_each(|path| check_path(path))?;
    let (image, layers, mut facts) = read(&arguments.input)?;
    let denoised = denoise(&denoiser, &image, &layers)?;
    facts.push(denoised_by());
    let outputs: Vec<&Path> = arguments.outputs.iter().map(PathBuf::as_path).collect();
    films::write_all(&Picture { image: &denoised, noisy: Some(&image), layers: &layers, facts: &facts }, None, &outputs)
}

/// The picture without its noise, by those of its layers that help.
///
/// # Errors
/// What the library says.
pub fn denoise(denoiser: &Denoiser, image: &Image, layers: &[(Layer, Image)]) -> Result<Image> {
    let [albedo, normal] = GUIDES.map(|guide| layers.iter().find(|(layer, _)| *layer == guide).map(|(_, image)| image));
    denoiser.denoise(image, Guides { albedo, normal })
}

/// What stands in a file, so that nobody takes the picture for an estimate.
pub fn denoised_by() -> (&'static str, Fact) {
    ("denoiser", Fact::Text("Open Image Denoise".into()))
}

type Found = (Image, Vec<(Layer, Image)>, Vec<(&'static str, Fact)>);

/// A film with all that it has; of a picture what is needed, and as it was before it was denoised, if it was.
fn read(path: &Path) -> Result<Found> {
    if is_film(path) {
        let film = films::read_picture(path)?;
        let (image, layers) = films::pictures(film.film());
        return Ok((image, layers, films::facts(&film)));
    }
    let image = read_layer(path, "noisy").or_else(|_| read_image(path))?;
    let guides = GUIDES.into_iter().filter_map(|layer| Some((layer, read_layer(path, layer.name()).ok()?)));
    Ok((image, guides.collect(), Vec::new()))
}
