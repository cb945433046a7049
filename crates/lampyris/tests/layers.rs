//! Layers: their sum is the picture, they mean the same whoever computes them, and whoever asks for them changes nothing.

mod common;

use common::{lit, on_threads, square};
use lampyris::film::{Film, Layer, Layers};
use lampyris::image::Image;

/// A floor with a mirror ball, and a glowing disk behind them that lights both; the sky is black.
const SCENE: &str = "
film = { size = [24, 18] }
camera = { origin = [0, 1.5, -4], target = [0, 0.6, 0], fov = 50 }
[[shapes]]
type = 'quad'
corner = [-2, 0, -2]
u = [0, 0, 4]
v = [4, 0, 0]
material = { type = 'diffuse', reflectance = [0.75, 0.5, 0.25] }
[[shapes]]
type = 'sphere'
center = [0.4, 0.5, 0.2]
radius = 0.5
material = { type = 'mirror' }
[[shapes]]
type = 'disk'
center = [-0.8, 0.7, 1]
normal = [0, 0, -1]
radius = 0.5
material = { type = 'diffuse', reflectance = 0.5 }
emission = { radiance = [3, 2, 1] }
";

const WAYS: [&str; 6] = [
    "integrator=path samples=2",
    "integrator=light photons=20000",
    "integrator=photon-map photons=20000 samples=2",
    "integrator=photon-map photons=20000 direct=photons",
    "integrator=photon-map photons=20000 direct=photons bandwidth=nearest",
    "integrator=auto photons=20000 samples=2 radius=1",
];

fn layer(film: &Film, layer: Layer) -> Image {
    film.layer(layer).unwrap_or_else(|| panic!("no {}", layer.name()))
}

#[test]
fn the_picture_is_the_same_to_the_bit_with_layers_and_without() {
    for way in WAYS {
        let lit = lit(SCENE, way);
        let bits =
            |image: &Image| image.pixels().as_flattened().iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        let plain = bits(&lit.film(3, Layers::NONE).image());
        assert!(plain == bits(&lit.film(3, Layers::ALL).image()), "{way}");
        assert!(plain == bits(&lit.film(3, Layers::NONE.with(Layer::Depth)).image()), "{way}");
    }
}

#[test]
fn layers_are_the_same_to_the_bit_on_any_number_of_threads() {
    for way in WAYS {
        let lit = lit(SCENE, way);
        let on = |threads| {
            let film = on_threads(threads, || lit.film(2, Layers::ALL));
            Layer::ALL.map(|each| layer(&film, each))
        };
        assert!(on(1) == on(3), "{way}");
    }
}

#[test]
fn emission_direct_and_indirect_light_add_up_to_the_picture() {
    for way in WAYS {
        let film = lit(SCENE, way).film(4, Layers::ALL);
        let [emission, direct, indirect] =
            [Layer::Emission, Layer::Direct, Layer::Indirect].map(|each| layer(&film, each));
        for (index, pixel) in film.image().pixels().iter().enumerate() {
            for channel in 0..3 {
                let sum: f32 = [&emission, &direct, &indirect].map(|part| part.pixels()[index][channel]).iter().sum();
                assert!(
                    (sum - pixel[channel]).abs() <= 1e-5 * pixel[channel].abs().max(1e-3),
                    "{way}: {sum} {pixel:?}"
                );
            }
        }
    }
}

/// With paths of one event there is emission and direct light, and nothing else; what a longer render calls indirect is
/// what such a render lacks.
#[test]
fn emission_and_direct_light_are_what_paths_of_one_event_bring() {
    let full = lit(SCENE, "integrator=path").film(1, Layers::ALL);
    let short = lit(SCENE, "integrator=path max-bounces=1").film(1, Layers::ALL);
    // The first event's random numbers are the same, and roulette begins later.
    let largest = layer(&short, Layer::Indirect).max();
    assert!(largest < 1e-5, "a path of one event brings no indirect light, not {largest}");
    assert!(layer(&full, Layer::Indirect).mean() > 100.0 * f64::from(largest));
    for each in [Layer::Emission, Layer::Direct] {
        let apart = lampyris::compare::compare(&layer(&full, each), &layer(&short, each)).expect("same size").max_abs;
        assert!(apart < 1e-5, "{}: {apart}", each.name());
    }
}

/// Means over the picture agree within a few hundredths, which is the noise of these seeds; the photon map's radius moves light within
/// the picture, and hardly out of it. Light tracing sees nothing in mirrors, so its ball is of chalk.
#[test]
fn all_integrators_mean_the_same_by_each_layer() {
    let chalk = SCENE.replace("{ type = 'mirror' }", "{ type = 'diffuse', reflectance = 0.9 }");
    let path = WAYS[0];
    for (scene, ways) in [(chalk.as_str(), [WAYS[1]].as_slice()), (SCENE, &WAYS[2..])] {
        let films = |way: &str| lit(scene, way).film(128, Layers::ALL);
        let reference = films(path);
        for (way, film) in ways.iter().map(|way| (way, films(way))) {
            // These are of the method, and the caustic of the lamp in the ball is too faint and too small.
            let of_method = [Layer::Variance, Layer::Samples, Layer::Caustic];
            for each in Layer::ALL.into_iter().filter(|each| !of_method.contains(each)) {
                let [found, expected] = [&film, &reference].map(|film| mean_size(&layer(film, each)));
                // There is little indirect light here, so it is the noisiest, and some blurs beyond the floor's edges.
                let bound = if each == Layer::Indirect { 0.12 } else { 0.03 };
                assert!((found - expected).abs() < bound * expected, "{}: {way}: {found}, {expected}", each.name());
            }
        }
    }
}

/// The mean absolute value of all that is finite.
fn mean_size(image: &Image) -> f64 {
    let finite: Vec<f32> = image.pixels().as_flattened().iter().copied().filter(|value| value.is_finite()).collect();
    finite.iter().map(|&value| f64::from(value.abs())).sum::<f64>() / finite.len() as f64
}

#[test]
fn features_are_those_of_the_first_surface_that_is_no_mirror() {
    // A pixel of the floor in front of the ball, one of the ball's middle, one of the sky.
    let film = lit(SCENE, "integrator=path samples=4").film(2, Layers::ALL);
    let [albedo, normal, depth, position] =
        [Layer::Albedo, Layer::Normal, Layer::Depth, Layer::Position].map(|each| layer(&film, each));
    let floor = (12, 14);
    assert_eq!(albedo.pixel(floor.0, floor.1), [0.75, 0.5, 0.25]);
    let [x, y, z] = normal.pixel(floor.0, floor.1);
    assert!(x.abs() < 1e-6 && (y - 1.0).abs() < 1e-6 && z.abs() < 1e-6, "{:?}", (x, y, z));
    let at = glam::Vec3::from(position.pixel(floor.0, floor.1));
    assert!(at.y.abs() < 1e-5, "{at}");
    let distance = at.distance(glam::Vec3::new(0.0, 1.5, -4.0));
    assert!((depth.pixel(floor.0, floor.1)[0] - distance).abs() < 0.01 * distance, "{distance}");
    assert_eq!((depth.pixel(0, 0)[0], albedo.pixel(0, 0), normal.pixel(0, 0)), (f32::INFINITY, [0.0; 3], [0.0; 3]));
}

/// A white floor seen through a pane of glass and in a mirror that is tilted by 45°, by every integrator: the pane lets
/// 1 - R = 2n/(n² + 1) through, and the rest sees nothing.
#[test]
fn features_look_through_glass_and_mirrors() {
    let scene = "
        film = { size = [2, 2] }
        camera = { origin = [0, 1, -4], target = [0, 1, 0], fov = 1 }
        lights = [{ type = 'point', position = [0, 2, -1], intensity = 1 }]
        [[shapes]]
        type = 'cube'
        transform = [{ scale = [3, 3, 0.1] }, { translate = [0, 0, -2] }]
        material = { type = 'glass', ior = 1.5 }
        [[shapes]]
        type = 'quad'
        corner = [1, 0.5, -0.5]
        u = [-2, 0, 0]
        v = [0, 1, 1]
        material = { type = 'mirror', reflectance = 0.8 }
        [[shapes]]
        type = 'quad'
        corner = [-3, 3, -1.5]
        u = [6, 0, 0]
        v = [0, 0, 3]
        material = { type = 'diffuse', reflectance = [1, 0.5, 0] }";
    let ways = [
        ("integrator=path samples=16", 16),
        ("integrator=light photons=10", 256),
        ("integrator=photon-map photons=100 radius=1", 256),
        ("integrator=auto photons=100 samples=16", 16),
    ];
    for (way, passes) in ways {
        let film = lit(scene, way).film(passes, Layers::ALL);
        let mean = |each| means(&layer(&film, each));
        let through = 2.0 * 1.5 / (1.5 * 1.5 + 1.0);
        let ([red, green, blue], [_, _, z]) = (mean(Layer::Albedo), mean(Layer::Position));
        // Of 1024 samples, 8 % are reflected by the pane: ten standard deviations are less than a tenth.
        assert!(
            (red - 0.8 * through).abs() < 0.1 && (green - 0.5 * red).abs() < 1e-5 && blue == 0.0,
            "{way}: {red} {green} {blue}"
        );
        assert!(z.abs() < 0.05, "{way}: {z}");
        let [x, y, _] = mean(Layer::Normal);
        assert!(x.abs() < 1e-5 && (y + through).abs() < 0.1, "{way}: {y}");
        let depth = mean(Layer::Depth)[0];
        assert!((depth - 6.0).abs() < 0.1, "{way}: {depth}");
    }
}

/// Below a ball of glass, all light of a large lamp comes through the ball or past it: by every integrator the same part is
/// caustic, and in the shadow nearly all of it.
#[test]
fn caustics_are_the_light_that_glass_throws_on_the_floor() {
    let scene = "film = { size = [8, 8] }
        camera = { origin = [0, 0.3, -3], target = [0, 0, 0], fov = 20 }
        [[shapes]]
        type = 'sphere'
        center = [0, 1, 0]
        radius = 0.5
        material = { type = 'glass' }
        [[shapes]]
        type = 'disk'
        center = [0, 3, 0]
        normal = [0, -1, 0]
        radius = 0.8
        material = { type = 'diffuse', reflectance = 0 }
        emission = { radiance = 10 }\n"
        .to_string()
        + &square(0.0, 2.0, false, "{ type = 'diffuse', reflectance = 0.8 }");
    let ways = [
        ("integrator=path samples=64", 16),
        ("integrator=light photons=50000", 8),
        ("integrator=photon-map photons=50000 radius=0.05", 8),
        ("integrator=photon-map photons=50000 direct=photons bandwidth=fixed radius=0.05", 8),
        ("integrator=auto photons=50000 samples=64", 8),
    ];
    let share = |(way, passes): (&str, u32)| {
        let film = lit(&scene, way).film(passes, Layers::ALL);
        let [caustic, indirect] = [Layer::Caustic, Layer::Indirect].map(|each| means(&layer(&film, each))[1]);
        assert!(caustic > 0.5 * indirect && caustic <= indirect, "{way}: {caustic} of {indirect}");
        let samples = means(&layer(&film, Layer::Samples))[0];
        let due = f64::from(passes * if way.contains("samples") { 64 } else { 1 });
        assert!((samples - due).abs() < 1e-3, "{way}: {samples} samples");
        caustic
    };
    let [path, others @ ..] = ways.map(share);
    // The noise of these seeds is a few hundredths.
    assert!(others.iter().all(|other| (other - path).abs() < 0.1 * path), "{path} and {others:?}");
}

/// Of each channel.
fn means(image: &Image) -> [f64; 3] {
    [0, 1, 2].map(|channel| common::channel_mean(image, channel))
}

#[test]
fn a_picture_of_the_photon_map_has_no_layers() {
    let film = lit(SCENE, "integrator=photon-map photons=1000 show=photons").film(1, Layers::ALL);
    assert!(Layer::ALL.into_iter().all(|each| film.layer(each).is_none()));
}
