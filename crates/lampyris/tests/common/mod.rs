//! What all tests of light share: scenes from text, renders of them, and statistics with stated odds.

#![allow(dead_code, reason = "every test file uses another part of it")]

pub mod materials;
pub mod rates;
pub mod statistics;
pub mod time;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use lampyris::error::Result;
use lampyris::film::{Film, Layers};
use lampyris::geometry::MeshData;
use lampyris::image::Image;
use lampyris::import::toml::read_str;
use lampyris::integrator::{Pass, PhotonMapping, Silent};
use lampyris::photon::PhotonMap;
use lampyris::render::Render;
use lampyris::scene::description::{IntegratorDescription, SceneDescription};
use lampyris::scene::{Assets, NoAssets, Scene, build};
use lampyris::texture::Raster;

/// A scene with the description that it was built from.
pub struct Lit {
    pub description: SceneDescription,
    pub scene: Scene,
}

/// The description in the text of a scene file.
pub fn described(text: &str) -> SceneDescription {
    read_str(Path::new("test.toml"), text).unwrap_or_else(|error| panic!("{error}\n{text}")).description
}

/// The scene in the text of a scene file, with settings such as `integrator=path` or `photons=1000`, by spaces.
pub fn lit(text: &str, settings: &str) -> Lit {
    built(described(text), settings)
}

/// The same with these pictures, by the names that its textures give them.
pub fn lit_with(text: &str, settings: &str, pictures: &[(&'static str, Raster)]) -> Lit {
    let pictures = pictures.iter().map(|(name, picture)| (*name, Arc::new(picture.clone()))).collect();
    built_with(described(text), settings, &Painted(pictures))
}

/// The same from a description.
pub fn built(description: SceneDescription, settings: &str) -> Lit {
    built_with(description, settings, &Painted::default())
}

fn built_with(mut description: SceneDescription, settings: &str, assets: &dyn Assets) -> Lit {
    for setting in settings.split_whitespace() {
        let (key, value) = setting.split_once('=').expect("key=value");
        if key == "integrator" {
            description.use_integrator(value).unwrap_or_else(|error| panic!("{error}"));
        } else {
            description.set(key, value).unwrap_or_else(|error| panic!("{error}"));
        }
    }
    let scene = build(&description, assets).unwrap_or_else(|error| panic!("{error}")).scene;
    Lit { description, scene }
}

/// For scenes that name a picture: these, and by any other name a small one with a bright and a black corner.
#[derive(Default)]
pub struct Painted(HashMap<&'static str, Arc<Raster>>);

impl Assets for Painted {
    fn mesh(&self, file: &str, index: u32) -> Result<Arc<MeshData>> {
        NoAssets.mesh(file, index)
    }

    fn picture(&self, file: &str, _: bool) -> Result<Arc<Raster>> {
        if let Some(picture) = self.0.get(file) {
            return Ok(Arc::clone(picture));
        }
        let (width, height) = if file.contains("square") { (8, 8) } else { (12, 7) };
        let pixel = |index: usize| {
            let (x, y) = ((index % width) as f32 / width as f32, (index / width) as f32 / height as f32);
            let bright = if x > 0.6 && (0.2..0.4).contains(&y) { 9.0 } else { 0.0 };
            if x < 0.3 && y < 0.5 { [0.0; 3] } else { [x + bright, 0.5 + bright * y, 1.0 - y + bright] }
        };
        let image = Image::from_pixels(width, height, (0..width * height).map(pixel).collect());
        Ok(Arc::new(image.and_then(Raster::of_image).expect("as many pixels")))
    }
}

impl Lit {
    /// The mean picture of so many passes.
    pub fn image(&self, passes: u32) -> Image {
        self.film(passes, Layers::NONE).image()
    }

    /// The film of so many passes, with these layers.
    pub fn film(&self, passes: u32, layers: Layers) -> Film {
        let mut render = Render::with_layers(&self.scene, &self.description, layers, &Silent);
        (0..passes).for_each(|_| render.step(&Silent));
        render.film().clone()
    }

    /// The film of these passes, one after the other, on so many threads.
    pub fn film_on(&self, threads: usize, passes: [u32; 3]) -> Film {
        on_threads(threads, || {
            let mut render = Render::new(&self.scene, &self.description, &Silent);
            passes.iter().for_each(|&pass| assert!(render.step_in(&(pass..pass + 1), &Silent)));
            render.film().clone()
        })
    }

    /// The picture of each pass: the mean over passes is the picture, with any filter.
    pub fn passes(&self, passes: u32) -> Vec<Image> {
        let Lit { description, scene } = self;
        let (film, seed) = (&description.film, description.render.seed);
        let integrator = lampyris::integrator::integrator(scene, film, &description.integrator, seed, &Silent);
        (0..passes)
            .map(|index| {
                integrator.expose(&scene.of_pass(seed, index), film, &Pass { index, seed }, Layers::NONE, &Silent).image
            })
            .collect()
    }

    /// For each pass the mean over the picture, per channel.
    pub fn means(&self, passes: u32) -> [Vec<f64>; 3] {
        let images = self.passes(passes);
        [0, 1, 2].map(|channel| images.iter().map(|image| channel_mean(image, channel)).collect())
    }

    /// The photon map of a pass.
    pub fn map(&self, pass: u32) -> PhotonMap {
        let IntegratorDescription::PhotonMap(settings) = &self.description.integrator else {
            panic!("not a photon map");
        };
        let (film, seed) = (&self.description.film, self.description.render.seed);
        let mapping = PhotonMapping::new(&self.scene, film, settings.clone(), seed, &Silent);
        mapping.map(&self.scene, &Pass { index: pass, seed }, &Silent)
    }
}

/// What comes of some work on so many threads.
pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work)
}

/// The mean over the picture of one channel.
pub fn channel_mean(image: &Image, channel: usize) -> f64 {
    image.pixels().iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>() / image.pixels().len() as f64
}

/// A level square around the y axis at this height, its edges twice `half`, its normal up unless it is flipped.
pub fn square(y: f32, half: f32, flip: bool, material: &str) -> String {
    format!(
        "[[shapes]]
         type = 'quad'
         corner = [{0}, {y}, {0}]
         u = [0, 0, {1}]
         v = [{1}, 0, 0]
         flip-normal = {flip}
         material = {material}\n",
        -half,
        2.0 * half
    )
}

/// Two such squares, between which light is in this kind of glass.
pub fn slab(top: f32, bottom: f32, half: f32, glass: &str) -> String {
    square(top, half, false, glass) + &square(bottom, half, true, glass)
}
