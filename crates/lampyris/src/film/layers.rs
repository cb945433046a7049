//! Layers: what a pass can tell beside its picture, for compositing, denoising and looking closer.
//!
//! The picture is a sum over light paths. Emission, direct and indirect light split it by the number of scattering
//! events between lamp and camera: none, one, more; reflection in a mirror counts as much as any other. The remaining
//! layers describe the first surface that the camera sees with a smooth lobe, also through glass and in mirrors: what a
//! denoiser should keep apart.

use std::str::FromStr;

use super::Features;
use super::exact::ExactSums;
use crate::error::{Error, did_you_mean};

/// One layer. All are means over the samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layer {
    /// Linear RGB: the share of the light that the first surface with a smooth lobe does not absorb, by all its events
    /// together, times what glass and mirrors before it let through; 0 where there is none.
    Albedo,
    /// World coordinates: the shading normal of that surface, on the side that is seen. Where samples differ, or meet
    /// nothing, it is shorter than 1.
    Normal,
    /// Scene units: the length of the way from the lens to that surface, mean of the samples that meet one; infinite where
    /// none does.
    Depth,
    /// World coordinates, scene units: where that surface lies, mean of the samples that meet one; 0 where none does.
    Position,
    /// Radiance: light scattered exactly once between lamp and camera.
    Direct,
    /// Radiance: light scattered more than once; the picture less `Direct` and `Emission`.
    Indirect,
    /// Radiance: caustics, the part of `Indirect` that mirrors and glass alone brought from a lamp to a smooth surface, seen
    /// by the camera itself or through mirrors and glass.
    Caustic,
    /// Radiance: lamps and surroundings seen by the camera itself.
    Emission,
    /// Radiance²: the variance of the picture's luminance, as the differences between passes tell it (theory §6). There is
    /// none before the second pass.
    Variance,
    /// Camera samples of the pixel in all passes, by what they weigh.
    Samples,
}

impl Layer {
    /// Every layer.
    pub const ALL: [Layer; 10] = [
        Layer::Albedo,
        Layer::Normal,
        Layer::Depth,
        Layer::Position,
        Layer::Direct,
        Layer::Indirect,
        Layer::Caustic,
        Layer::Emission,
        Layer::Variance,
        Layer::Samples,
    ];

    /// Its name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Layer::Albedo => "albedo",
            Layer::Normal => "normal",
            Layer::Depth => "depth",
            Layer::Position => "position",
            Layer::Direct => "direct",
            Layer::Indirect => "indirect",
            Layer::Caustic => "caustic",
            Layer::Emission => "emission",
            Layer::Variance => "variance",
            Layer::Samples => "samples",
        }
    }

    /// The names of its channels.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Layer::Normal | Layer::Position => &["X", "Y", "Z"],
            Layer::Depth => &["Z"],
            Layer::Variance | Layer::Samples => &["Y"],
            _ => &["R", "G", "B"],
        }
    }
}

/// A set of layers. From text: `all`, `none`, or names with commas between them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layers(u16);

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

/// Sums over passes of what some layers are made of.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LayerSums {
    layers: Layers,
    /// Whether any pass had features.
    has_any: bool,
    /// Of each feature that is summed, as many numbers a pixel as it has.
    sums: Vec<(Feature, ExactSums)>,
}

/// What is summed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Feature {
    Albedo,
    Normal,
    Position,
    Direct,
    Caustic,
    Emission,
    /// Depth, and the share of the samples that met anything.
    Reach,
}

impl Feature {
    const ALL: [Feature; 7] = [
        Feature::Albedo,
        Feature::Normal,
        Feature::Position,
        Feature::Direct,
        Feature::Caustic,
        Feature::Emission,
        Feature::Reach,
    ];

    /// Those of which these layers are made.
    fn needed(layers: Layers) -> impl Iterator<Item = Feature> {
        Feature::ALL.into_iter().filter(move |feature| layers.iter().any(|layer| feature.is_in(layer)))
    }

    /// How many numbers it has.
    fn channels(self) -> usize {
        if self == Feature::Reach { 2 } else { 3 }
    }

    fn of(self, features: &Features) -> [f32; 3] {
        match self {
            Feature::Albedo => features.albedo,
            Feature::Normal => features.normal,
            Feature::Position => features.position,
            Feature::Direct => features.direct,
            Feature::Caustic => features.caustic,
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
            Layer::Caustic => self == Feature::Caustic,
            Layer::Emission => self == Feature::Emission,
            Layer::Indirect => matches!(self, Feature::Direct | Feature::Emission),
            // The film knows them by itself.
            Layer::Variance | Layer::Samples => false,
        }
    }
}

impl LayerSums {
    pub(super) fn new(layers: Layers, pixels: usize) -> LayerSums {
        let sums = Feature::needed(layers).map(|feature| (feature, ExactSums::new(feature.channels() * pixels)));
        LayerSums { layers, has_any: false, sums: sums.collect() }
    }

    pub(super) fn layers(&self) -> Layers {
        self.layers
    }

    pub(super) fn has_any(&self) -> bool {
        self.has_any
    }

    /// How many numbers a pixel has for these layers.
    pub(super) fn channels(layers: Layers) -> usize {
        Feature::needed(layers).map(Feature::channels).sum()
    }

    /// All sums, in an order that depends on the layers alone.
    pub(super) fn sums(&self) -> impl Iterator<Item = &ExactSums> {
        self.sums.iter().map(|(_, sums)| sums)
    }

    /// The same, to be changed.
    pub(super) fn sums_mut(&mut self) -> impl Iterator<Item = &mut ExactSums> {
        self.sums.iter_mut().map(|(_, sums)| sums)
    }

    /// The same, if any pass had features or if none had.
    pub(super) fn with_any(self, has_any: bool) -> LayerSums {
        LayerSums { has_any, ..self }
    }

    /// Adds the features of a pass, of each pixel or none at all.
    pub(super) fn add(&mut self, features: &[Features]) {
        if features.is_empty() {
            return;
        }
        self.has_any = true;
        for (feature, sums) in &mut self.sums {
            let channels = feature.channels();
            sums.add_each(|index| f64::from(feature.of(&features[index / channels])[index % channels]));
        }
    }

    /// Adds those of another film of the same size and layers.
    pub(super) fn merge(&mut self, other: &LayerSums) {
        self.has_any |= other.has_any;
        self.sums.iter_mut().zip(&other.sums).for_each(|((_, own), (_, others))| own.merge(others));
    }

    /// The values of a layer, if it was asked for and there are any; `picture` gives the sums of the picture, and `weight`
    /// says by what the sums of a pixel are divided.
    pub(super) fn values(
        &self,
        layer: Layer,
        picture: impl Fn(usize) -> [f64; 3],
        weight: impl Fn(usize) -> f64,
    ) -> Option<Vec<[f32; 3]>> {
        let sums = |feature: Feature| {
            let (_, sums) = self.sums.iter().find(|(each, _)| *each == feature)?;
            let channels = feature.channels();
            let sum = move |pixel: usize| {
                [0, 1, 2].map(|c| if c < channels { sums.value(channels * pixel + c) } else { 0.0 })
            };
            Some((sums.len() / channels, sum))
        };
        let mean = |feature: Feature| {
            let (pixels, sum) = sums(feature)?;
            Some((0..pixels).map(|pixel| sum(pixel).map(|value| (value / weight(pixel)) as f32)).collect())
        };
        if !self.layers.contains(layer) || !self.has_any {
            return None;
        }
        match layer {
            Layer::Variance | Layer::Samples => None,
            Layer::Albedo => mean(Feature::Albedo),
            Layer::Normal => mean(Feature::Normal),
            Layer::Direct => mean(Feature::Direct),
            Layer::Caustic => mean(Feature::Caustic),
            Layer::Emission => mean(Feature::Emission),
            Layer::Depth => {
                let (pixels, reach) = sums(Feature::Reach)?;
                let depth = |[depth, met, _]: [f64; 3]| if met > 0.0 { (depth / met) as f32 } else { f32::INFINITY };
                Some((0..pixels).map(|pixel| [depth(reach(pixel)); 3]).collect())
            }
            Layer::Position => {
                let ((pixels, position), (_, reach)) = (sums(Feature::Position)?, sums(Feature::Reach)?);
                let of_met = |sum: [f64; 3], [_, met, _]: [f64; 3]| {
                    sum.map(|value| if met > 0.0 { (value / met) as f32 } else { 0.0 })
                };
                Some((0..pixels).map(|pixel| of_met(position(pixel), reach(pixel))).collect())
            }
            Layer::Indirect => {
                let ((pixels, direct), (_, emission)) = (sums(Feature::Direct)?, sums(Feature::Emission)?);
                let rest = |pixel: usize| {
                    let (all, direct, emission) = (picture(pixel), direct(pixel), emission(pixel));
                    std::array::from_fn(|c| ((all[c] - direct[c] - emission[c]) / weight(pixel)) as f32)
                };
                Some((0..pixels).map(rest).collect())
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
        assert_eq!(Layer::ALL.map(features), [1, 1, 1, 2, 1, 2, 1, 1, 0, 0]);
    }

    #[test]
    fn depth_and_position_are_those_of_the_samples_that_meet_something() {
        let mut sums = LayerSums::new(Layers::ALL, 2);
        let half = Features { depth: 2.0, met: 0.5, position: [1.0, 0.0, -2.0], ..Features::default() };
        for _ in 0..3 {
            sums.add(&[half, Features::default()]);
        }
        let values = |layer| sums.values(layer, |_| [0.0; 3], |_| 3.0).expect("asked for");
        assert_eq!(values(Layer::Depth), [[4.0; 3], [f32::INFINITY; 3]]);
        assert_eq!(values(Layer::Position), [[2.0, 0.0, -4.0], [0.0; 3]]);
    }
}
