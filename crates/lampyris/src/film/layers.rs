//! Layers: what a pass can tell beside its picture, for compositing, denoising and looking closer.
//!
//! The picture is a sum over light paths. Emission, direct and indirect light split it by the number of scattering
//! events between lamp and camera: none, one, more; reflection in a mirror counts as much as any other. The remaining
//! layers describe the first surface that the camera sees.

use std::str::FromStr;

use glam::Vec3;

use crate::error::{Error, did_you_mean};
use crate::image::Image;
use crate::scene::SurfacePoint;
use crate::spectrum::{Basis, Spectrum};
use crate::transport::PathState;

/// One layer. All are means over the samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layer {
    /// Linear RGB: the share of the light that the first surface does not absorb, by all its events together. Glass and
    /// mirrors have theirs, near 1; nothing has 0.
    Albedo,
    /// World coordinates: the shading normal of the first surface, on the side that is seen. Where samples differ, or
    /// meet nothing, it is shorter than 1.
    Normal,
    /// Scene units: the distance from the lens to the first surface, mean of the samples that meet one; infinite where
    /// none does.
    Depth,
    /// World coordinates, scene units: where the first surface lies, mean of the samples that meet one; 0 where none does.
    Position,
    /// Radiance: light scattered exactly once between lamp and camera.
    Direct,
    /// Radiance: light scattered more than once; the picture less `Direct` and `Emission`.
    Indirect,
    /// Radiance: lamps and surroundings seen by the camera itself.
    Emission,
}

impl Layer {
    /// Every layer.
    pub const ALL: [Layer; 7] =
        [Layer::Albedo, Layer::Normal, Layer::Depth, Layer::Position, Layer::Direct, Layer::Indirect, Layer::Emission];

    /// Its name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Layer::Albedo => "albedo",
            Layer::Normal => "normal",
            Layer::Depth => "depth",
            Layer::Position => "position",
            Layer::Direct => "direct",
            Layer::Indirect => "indirect",
            Layer::Emission => "emission",
        }
    }

    /// The names of its channels.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Layer::Normal | Layer::Position => &["X", "Y", "Z"],
            Layer::Depth => &["Z"],
            _ => &["R", "G", "B"],
        }
    }
}

/// A set of layers. From text: `all`, `none`, or names with commas between them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layers(u8);

impl Layers {
    /// The picture alone.
    pub const NONE: Layers = Layers(0);
    /// Every layer.
    pub const ALL: Layers = Layers((1 << Layer::ALL.len()) - 1);

    /// Whether there is none.
    pub fn is_empty(self) -> bool {
        self == Layers::NONE
    }

    /// Whether this one is among them.
    pub fn contains(self, layer: Layer) -> bool {
        self.0 & (1 << layer as u8) != 0
    }

    /// The same and one more.
    #[must_use]
    pub fn with(self, layer: Layer) -> Layers {
        Layers(self.0 | 1 << layer as u8)
    }

    /// Each of them, in the order of [`Layer::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Layer> {
        Layer::ALL.into_iter().filter(move |&layer| self.contains(layer))
    }
}

impl FromStr for Layers {
    type Err = Error;

    fn from_str(text: &str) -> Result<Layers, Error> {
        match text.trim() {
            "all" => return Ok(Layers::ALL),
            "none" => return Ok(Layers::NONE),
            _ => {}
        }
        text.split(',').map(str::trim).try_fold(Layers::NONE, |layers, name| {
            let known = Layer::ALL.map(Layer::name);
            match Layer::ALL.into_iter().find(|layer| layer.name() == name) {
                Some(layer) => Ok(layers.with(layer)),
                None => {
                    Err(Error::new(format!("there is no layer '{name}'")).with_hint(match did_you_mean(name, known) {
                        Some(near) => format!("did you mean {near}?"),
                        None => format!("known are {}, and all or none", known.join(" ")),
                    }))
                }
            }
        })
    }
}

/// Where the samples of a pixel leave the light that they find. Whatever else it notes, the radiance is the same to the
/// last bit.
pub trait Sink: Default + Send {
    /// Whether it has features to tell.
    const LAYERED: bool;

    /// The path of a sample has reached a surface.
    fn surface(&mut self, _point: &SurfacePoint, _path: &PathState) {}

    /// Adds radiance of light that has been scattered so many times, or more often where that is not known to be less
    /// than two.
    fn add(&mut self, light: Spectrum, events: u32);

    /// Of what was added as light of two events or more, this part had only one.
    fn was_direct(&mut self, _light: Spectrum) {}

    /// Takes this share of all that was left at another one.
    fn take(&mut self, other: &Self, share: f32);

    /// The sum of what was added, in the lanes of the pass.
    fn radiance(&self) -> Spectrum;

    /// The features as means over so many samples.
    fn features(&self, _samples: u32, _basis: &Basis) -> Option<Features> {
        None
    }
}

/// Radiance and nothing else.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plain(Spectrum);

impl Sink for Plain {
    const LAYERED: bool = false;

    #[inline]
    fn add(&mut self, light: Spectrum, _: u32) {
        self.0 += light;
    }

    #[inline]
    fn take(&mut self, other: &Plain, share: f32) {
        self.0 += other.0 * share;
    }

    #[inline]
    fn radiance(&self) -> Spectrum {
        self.0
    }
}

/// Radiance, and all that the layers need.
#[derive(Clone, Copy, Debug, Default)]
pub struct Layered {
    radiance: Spectrum,
    emission: Spectrum,
    direct: Spectrum,
    albedo: Spectrum,
    normal: Vec3,
    position: Vec3,
    depth: f32,
    met: f32,
}

impl Sink for Layered {
    const LAYERED: bool = true;

    fn surface(&mut self, point: &SurfacePoint, path: &PathState) {
        if path.bounce > 0 {
            return;
        }
        let normal = point.frame.normal;
        self.albedo += point.albedo();
        self.normal += if normal.dot(point.to_previous) < 0.0 { -normal } else { normal };
        self.position += point.surface.position;
        self.depth += point.distance;
        self.met += 1.0;
    }

    fn add(&mut self, light: Spectrum, events: u32) {
        self.radiance += light;
        match events {
            0 => self.emission += light,
            1 => self.direct += light,
            _ => {}
        }
    }

    fn was_direct(&mut self, light: Spectrum) {
        self.direct += light;
    }

    fn take(&mut self, other: &Layered, share: f32) {
        self.radiance += other.radiance * share;
        self.emission += other.emission * share;
        self.direct += other.direct * share;
        self.albedo += other.albedo * share;
        self.normal += other.normal * share;
        self.position += other.position * share;
        self.depth += other.depth * share;
        self.met += other.met * share;
    }

    fn radiance(&self) -> Spectrum {
        self.radiance
    }

    fn features(&self, samples: u32, basis: &Basis) -> Option<Features> {
        let n = samples as f32;
        Some(Features {
            emission: basis.to_rgb(self.emission / n),
            direct: basis.to_rgb(self.direct / n),
            albedo: basis.to_rgb(self.albedo / n),
            // As the weight of the pass has it.
            normal: (self.normal * (basis.white() / n)).to_array(),
            position: (self.position / n).to_array(),
            depth: self.depth / n,
            met: self.met / n,
        })
    }
}

/// What the layers of a pixel are made of: means over all samples of a pass, weighted as its picture. Samples that meet
/// nothing count as 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Features {
    /// Radiance of lamps and surroundings in plain sight.
    pub emission: [f32; 3],
    /// Radiance of light scattered once.
    pub direct: [f32; 3],
    /// Share of the light that is not absorbed.
    pub albedo: [f32; 3],
    /// Shading normal, in world coordinates.
    pub normal: [f32; 3],
    /// Of the first surface, in world coordinates.
    pub position: [f32; 3],
    /// Distance of the first surface.
    pub depth: f32,
    /// Share of the samples that meet a surface.
    pub met: f32,
}

/// A pass: its picture, and the features of its pixels if layers were asked for and the pass has them.
#[derive(Clone, Debug)]
pub struct Exposure {
    /// Linear radiance: the sum of the samples of each pixel, times what they weigh, over how many there are.
    pub image: Image,
    /// Of each pixel, row by row, or none at all.
    pub features: Vec<Features>,
    /// What the samples of a pixel weigh on average, which is 1 on average over passes; empty where it is 1 in each. A
    /// [`Film`](super::Film) divides by its mean, which takes away the noise that the weights have of themselves.
    pub weights: Vec<f32>,
}

impl From<Image> for Exposure {
    fn from(image: Image) -> Exposure {
        Exposure { image, features: Vec::new(), weights: Vec::new() }
    }
}

impl Exposure {
    /// Adds radiance in linear RGB to a pixel.
    pub fn add(&mut self, pixel: usize, light: [f32; 3], is_direct: bool) {
        let add = |sum: &mut [f32; 3]| *sum = [0, 1, 2].map(|channel| sum[channel] + light[channel]);
        add(&mut self.image.pixels_mut()[pixel]);
        if let Some(features) = self.features.get_mut(pixel).filter(|_| is_direct) {
            add(&mut features.direct);
        }
    }
}

/// Sums over passes of what some layers are made of.
#[derive(Clone, Debug)]
pub(super) struct LayerSums {
    layers: Layers,
    /// Whether any pass had features.
    has_any: bool,
    /// Of each feature that is summed, three numbers a pixel.
    sums: Vec<(Feature, Vec<[f64; 3]>)>,
}

/// What is summed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Feature {
    Albedo,
    Normal,
    Position,
    Direct,
    Emission,
    /// Depth, and the share of the samples that met anything.
    Reach,
}

impl Feature {
    const ALL: [Feature; 6] =
        [Feature::Albedo, Feature::Normal, Feature::Position, Feature::Direct, Feature::Emission, Feature::Reach];

    fn of(self, features: &Features) -> [f32; 3] {
        match self {
            Feature::Albedo => features.albedo,
            Feature::Normal => features.normal,
            Feature::Position => features.position,
            Feature::Direct => features.direct,
            Feature::Emission => features.emission,
            Feature::Reach => [features.depth, features.met, 0.0],
        }
    }

    /// Whether a layer is made of it.
    fn is_in(self, layer: Layer) -> bool {
        match layer {
            Layer::Albedo => self == Feature::Albedo,
            Layer::Normal => self == Feature::Normal,
            Layer::Depth => self == Feature::Reach,
            Layer::Position => matches!(self, Feature::Position | Feature::Reach),
            Layer::Direct => self == Feature::Direct,
            Layer::Emission => self == Feature::Emission,
            Layer::Indirect => matches!(self, Feature::Direct | Feature::Emission),
        }
    }
}

impl LayerSums {
    pub(super) fn new(layers: Layers, pixels: usize) -> LayerSums {
        let is_needed = |feature: &Feature| layers.iter().any(|layer| feature.is_in(layer));
        let sums = Feature::ALL.into_iter().filter(is_needed);
        LayerSums { layers, has_any: false, sums: sums.map(|feature| (feature, vec![[0.0; 3]; pixels])).collect() }
    }

    pub(super) fn layers(&self) -> Layers {
        self.layers
    }

    pub(super) fn add(&mut self, features: &[Features]) {
        self.has_any |= !features.is_empty();
        for (feature, sums) in &mut self.sums {
            for (sum, features) in sums.iter_mut().zip(features) {
                let values = feature.of(features);
                *sum = std::array::from_fn(|channel| sum[channel] + f64::from(values[channel]));
            }
        }
    }

    /// The values of a layer, if it was asked for and there are any; `pictures` are the sums of the picture, and `weight`
    /// says by what the sums of a pixel are divided.
    pub(super) fn values(
        &self,
        layer: Layer,
        pictures: &[[f64; 3]],
        weight: impl Fn(usize) -> f64,
    ) -> Option<Vec<[f32; 3]>> {
        let sums = |feature: Feature| Some(&self.sums.iter().find(|(each, _)| *each == feature)?.1);
        let mean = |feature: Feature| {
            let mean = |(pixel, sum): (usize, &[f64; 3])| sum.map(|value| (value / weight(pixel)) as f32);
            Some(sums(feature)?.iter().enumerate().map(mean).collect::<Vec<_>>())
        };
        if !self.layers.contains(layer) || !self.has_any {
            return None;
        }
        match layer {
            Layer::Albedo => mean(Feature::Albedo),
            Layer::Normal => mean(Feature::Normal),
            Layer::Direct => mean(Feature::Direct),
            Layer::Emission => mean(Feature::Emission),
            Layer::Depth => {
                let depth = |&[depth, met, _]: &[f64; 3]| if met > 0.0 { (depth / met) as f32 } else { f32::INFINITY };
                Some(sums(Feature::Reach)?.iter().map(|reach| [depth(reach); 3]).collect())
            }
            Layer::Position => {
                let of_met = |(sum, &[_, met, _]): (&[f64; 3], &[f64; 3])| {
                    sum.map(|value| if met > 0.0 { (value / met) as f32 } else { 0.0 })
                };
                Some(sums(Feature::Position)?.iter().zip(sums(Feature::Reach)?).map(of_met).collect())
            }
            Layer::Indirect => {
                let parts = sums(Feature::Direct)?.iter().zip(sums(Feature::Emission)?);
                let rest = |pixel: usize, all: &[f64; 3], direct: &[f64; 3], emission: &[f64; 3]| {
                    std::array::from_fn(|c| ((all[c] - direct[c] - emission[c]) / weight(pixel)) as f32)
                };
                let all = pictures.iter().zip(parts).enumerate();
                Some(all.map(|(pixel, (all, (direct, emission)))| rest(pixel, all, direct, emission)).collect())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_of_layers_are_read_from_text() {
        let parsed = |text: &str| text.parse::<Layers>();
        assert_eq!(parsed("all").expect("all"), Layers::ALL);
        assert!(parsed("none").expect("none").is_empty());
        let two: Vec<Layer> = parsed("depth, albedo").expect("two").iter().collect();
        assert_eq!(two, [Layer::Albedo, Layer::Depth]);
        let error = parsed("albedo,norml").expect_err("unknown");
        assert_eq!(error.to_string(), "there is no layer 'norml'; did you mean normal?");
    }

    #[test]
    fn only_what_the_layers_need_is_summed() {
        let features = |layer| LayerSums::new(Layers::NONE.with(layer), 1).sums.len();
        assert_eq!(Layer::ALL.map(features), [1, 1, 1, 2, 1, 2, 1]);
    }

    #[test]
    fn depth_and_position_are_those_of_the_samples_that_meet_something() {
        let mut sums = LayerSums::new(Layers::ALL, 2);
        let half = Features { depth: 2.0, met: 0.5, position: [1.0, 0.0, -2.0], ..Features::default() };
        for _ in 0..3 {
            sums.add(&[half, Features::default()]);
        }
        let values = |layer| sums.values(layer, &[[0.0; 3]; 2], |_| 3.0).expect("asked for");
        assert_eq!(values(Layer::Depth), [[4.0; 3], [f32::INFINITY; 3]]);
        assert_eq!(values(Layer::Position), [[2.0, 0.0, -4.0], [0.0; 3]]);
    }
}
