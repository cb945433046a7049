//! Layers in time: they add up to all light, change nothing about it, and mean the same for every integrator.

mod common;

use common::statistics::{Sample, assert_same_mean};
use common::time::{arriving, slot_count};
use common::{Lit, lit};
use lampyris::film::{Layer, Layers};
use lampyris::transient::{LightKind, TimeLayer};

/// A ball lamp in sight, and a floor and a wall with the caustic of a glass ball that is out of sight.
const SCENE: &str = "
    camera = { origin = [0, 1.4, -2.2], target = [0.1, 0, 0.3], fov = 50 }
    film = { size = [8, 8] }
    [[shapes]]
    type = 'plane'
    normal = [0, 1, 0]
    distance = 0
    material = { type = 'diffuse', reflectance = [0.8, 0.6, 0.4] }
    [[shapes]]
    type = 'plane'
    normal = [0, 0, -1]
    distance = 1
    material = { type = 'diffuse', reflectance = 0.6 }
    [[shapes]]
    type = 'sphere'
    center = [0.3, 2.1, 0.1]
    radius = 0.6
    material = { type = 'glass' }
    [[shapes]]
    type = 'sphere'
    center = [0.4, 3.6, 0.0]
    radius = 0.3
    emission = { power = 8 }
    material = { type = 'diffuse', reflectance = 0 }
    [[shapes]]
    type = 'sphere'
    center = [-0.4, 0.25, 0.2]
    radius = 0.1
    emission = { power = 0.5 }
    material = { type = 'diffuse', reflectance = 0 }";

const FOG: &str = "
    medium = 'fog'
    media = { fog = { type = 'homogeneous', sigma-t = 0.1, albedo = 0.8 } }\n";

const LAYERS: &str = " time.layers=emission,direct,caustic,indirect,volume time.bounces=2 max-bounces=6";

const BOUNCES: [TimeLayer; 4] =
    [TimeLayer::Bounces(0), TimeLayer::Bounces(1), TimeLayer::Bounces(2), TimeLayer::MoreBounces];

const WAYS: [&str; 5] = [
    "integrator=path samples=2",
    "integrator=auto photons=2000",
    "integrator=photon-map photons=2000 k=20",
    "integrator=photon-map photons=2000 bandwidth=nearest k=20 direct=photons filter=tent",
    "integrator=light photons=2000 filter=gaussian",
];

#[test]
fn layers_add_up_to_all_light_in_every_bin_and_change_none_of_it() {
    let scene = FOG.to_string() + SCENE;
    for way in WAYS {
        let range = " time.bins=12 time.start=0 time.bin-width=0.75";
        let film_with = |layers: &str| lit(&scene, &format!("{way}{range}{layers}")).film(3, Layers::NONE);
        let (plain, layered) = (film_with(" max-bounces=6"), film_with(LAYERS));
        let [all, bare] = [&layered, &plain].map(|film| film.transient(None).expect("time"));
        assert!(all.values() == bare.values(), "{way}: layers must not change what they are parts of");
        for parts in [LightKind::ALL.map(TimeLayer::Kind).to_vec(), BOUNCES.to_vec()] {
            let parts: Vec<_> = parts.iter().map(|&part| layered.transient(Some(part)).expect("kept")).collect();
            for (place, &all) in all.values().iter().enumerate() {
                let sum: f32 = parts.iter().map(|part| part.values()[place]).sum();
                assert!((sum - all).abs() <= 1e-5 * all, "{way}: {sum} is not {all}");
            }
            for part in &parts {
                let light: f32 = part.values().iter().sum();
                assert!(light > 0.0, "{way}: every layer has light");
            }
        }
        assert!(plain.transient(Some(TimeLayer::MoreBounces)).is_err());
    }
}

/// Without media, where kinds of light are those of the picture's layers.
#[test]
fn layers_in_time_add_up_to_those_of_the_picture() {
    for way in WAYS {
        let settings = format!("{way} time.bins=10 time.start=0 time.bin-width=10{LAYERS}");
        let film = lit(SCENE, &settings).film(3, Layers::ALL);
        for (kind, layer) in [
            (LightKind::Emission, Layer::Emission),
            (LightKind::Direct, Layer::Direct),
            (LightKind::Caustic, Layer::Caustic),
        ] {
            let sums = film.transient(Some(TimeLayer::Kind(kind))).expect("kept").steady();
            let layer = film.layer(layer).expect("asked for");
            for (sum, expected) in sums.pixels().as_flattened().iter().zip(layer.pixels().as_flattened()) {
                assert!((sum - expected).abs() <= 1e-5 * expected, "{way}, {}: {sum} {expected}", kind.name());
            }
        }
    }
}

/// The luminance of each layer in all pixels and bins, of each pass.
fn parts(lit: &Lit, passes: u32) -> Vec<Vec<f64>> {
    let (slots, time) = (slot_count(lit), lit.description.film.time.as_ref().expect("a film with time"));
    arriving(lit, passes, 1 + time.layers().count(), |arrival| arrival.slot as usize / slots)
}

#[test]
fn every_integrator_means_the_same_by_its_layers() {
    let (scene, passes) = (FOG.to_string() + SCENE, 40);
    let range = format!(" time.bins=1 time.start=0 time.bin-width=100{LAYERS}");
    let reference = parts(&lit(&scene, &format!("integrator=path samples=256{range}")), passes);
    assert!(reference.iter().all(|values| Sample::of(values).mean > 0.0), "every layer has light");
    for (way, bias) in [
        ("light photons=40000", 0.0),
        ("auto photons=20000 samples=8", 0.03),
        ("photon-map photons=20000 samples=8 bandwidth=fixed radius=0.03 volume=points volume-radius=0.05", 0.03),
    ] {
        let found = parts(&lit(&scene, &format!("integrator={way}{range} seed=1")), passes);
        for (layer, (a, b)) in reference.iter().zip(&found).enumerate() {
            assert_same_mean(&format!("{way}, layer {layer}"), a, b, 3 * reference.len(), bias);
        }
    }
}
