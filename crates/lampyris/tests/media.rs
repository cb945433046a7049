//! Participating media against exact answers: Beer and Lambert's law, light in fog in closed form, furnaces, and the pulse
//! in an infinite medium.

mod common;

use std::f64::consts::PI;
use std::sync::Arc;

use common::statistics::{Sample, assert_mean};
use common::{Lit, described, lit};
use glam::Vec3;
use lampyris::error::Result;
use lampyris::geometry::{MeshData, Ray};
use lampyris::material::Lobes;
use lampyris::medium::VolumeData;
use lampyris::sampler::Sampler;
use lampyris::scene::{Assets, NoAssets, SurfacePoint, build};
use lampyris::spectrum::Spectrum;
use lampyris::texture::Raster;
use lampyris::transport::{Limits, Origin, PathState, Segment, Visitor, walk};

/// Looks along +z from the origin, through one pixel as narrow as a ray.
const RAY: &str = "
    camera = { origin = [0, 0, 0], target = [0, 0, 1], fov = 0.01 }
    film = { size = [1, 1] }\n";

#[track_caller]
fn assert_radiance(name: &str, text: &str, settings: &str, expected: [f64; 3], power: f64) {
    let means = lit(text, settings).means(40);
    for (values, expected) in means.iter().zip(expected) {
        // Where nothing is left to chance there is rounding.
        assert_mean(&format!("{name}, {settings}"), values, expected, 1e-5 * expected, power);
    }
}

#[test]
fn an_absorbing_slab_dims_what_is_behind_it_by_beer_and_lambert() {
    let text = RAY.to_string()
        + "lights = [{ type = 'constant', radiance = 1 }]
           media = { ink = { type = 'homogeneous', sigma-a = [0.5, 1, 2] } }
           [[shapes]]
           type = 'cube'
           transform = [{ translate = [0, 0, 5] }]
           interior = 'ink'";
    for settings in ["integrator=path", "integrator=photon-map", "integrator=auto", "integrator=light"] {
        assert_radiance("slab", &text, settings, [1.0_f64, 2.0, 4.0].map(|depth| (-depth).exp()), 0.05);
    }
}

/// A glass cube in ink, clear inside, and two cubes that overlap, of which the more important one counts.
#[test]
fn clear_interiors_displace_and_priorities_decide() {
    let scene = |shapes: &str| {
        RAY.to_string()
            + "lights = [{ type = 'point', position = [0, 9, 0], intensity = 1 }]
               medium = 'ink'
               [media]
               ink = { type = 'homogeneous', sigma-a = 0.1 }
               tar = { type = 'homogeneous', sigma-a = 0.7 }
               [[shapes]]
               type = 'quad'
               corner = [-1, -1, 10]
               u = [0, 2, 0]
               v = [2, 0, 0]
               emission = { radiance = 1 }\n"
            + shapes
    };
    let cube = |z: f32, keys: &str| {
        format!("[[shapes]]\ntype = 'cube'\ntransform = [{{ translate = [0, 0, {z}] }}]\n{keys}\n")
    };
    // Ten of ink; eight of ink and two of nothing; cubes from 3 to 5 and 4 to 6.
    let overlapping = |first, second| {
        cube(4.0, &format!("interior = 'clear'\npriority = {first}"))
            + &cube(5.0, &format!("interior = 'tar'\npriority = {second}"))
    };
    for (shapes, depth) in [
        (String::new(), 1.0),
        (cube(5.0, "interior = 'clear'"), 0.8),
        (cube(5.0, "interior = 'tar'"), 0.8 + 1.4),
        (overlapping(1, 0), 0.7 + 0.7),
        (overlapping(0, 1), 0.7 + 1.4),
        // The eye in one of them.
        (cube(0.5, "interior = 'tar'"), 0.85 + 1.5 * 0.7),
    ] {
        assert_radiance(&shapes, &scene(&shapes), "integrator=path max_bounces=0", [f64::exp(-depth); 3], 0.1);
    }
}

/// ∫ σs p I e^(−σt (t + d)) / d² dt over the ray, for a point light of intensity I at (h, 0, z0): Simpson's rule.
fn airlight(scattering: f64, extinction: f64, phase: impl Fn(f64) -> f64, [h, z0, from, to]: [f64; 4]) -> f64 {
    let pieces = 20_000;
    let step = (to - from) / f64::from(pieces);
    let value = |t: f64| {
        let d2 = h * h + (t - z0) * (t - z0);
        let cos = (t - z0) / d2.sqrt();
        // From the light to the point and on to the eye: the eye lies towards −z.
        scattering * phase(-cos) * (-extinction * (t + d2.sqrt())).exp() / d2
    };
    let piece = |i: i32| {
        let t = from + f64::from(i) * step;
        (value(t) + 4.0 * value(t + 0.5 * step) + value(t + step)) / 6.0
    };
    step * (0..pieces).map(piece).sum::<f64>()
}

fn isotropic(_: f64) -> f64 {
    0.25 / PI
}

/// A point light of this intensity at (h, 0, z0) in fog that ends at a black wall at z = 3.
fn fog(medium: &str, intensity: f64) -> String {
    RAY.to_string()
        + &format!(
            "lights = [{{ type = 'point', position = [0.5, 0, 1], intensity = {intensity} }}]
             medium = 'fog'
             media = {{ fog = {{ type = 'homogeneous', {medium} }} }}
             [[shapes]]
             type = 'quad'
             corner = [-9, -9, 3]
             u = [0, 18, 0]
             v = [18, 0, 0]
             material = {{ type = 'diffuse', reflectance = 0 }}\n"
        )
}

const ONCE: &str = "integrator=path max_bounces=1 samples=400";

#[test]
fn a_point_light_in_fog_shines_as_the_closed_form_says() {
    let anchor = airlight(0.8, 1.0, isotropic, [0.5, 1.0, 0.0, 3.0]) / (4.0 * PI);
    assert!((anchor / 4.781_382e-3 - 1.0).abs() < 1e-6, "{anchor}");
    let text = fog("sigma-t = 1, albedo = 0.8", 0.25 / PI);
    assert_radiance("fog", &text, ONCE, [anchor; 3], 0.1);
}

#[test]
fn fog_of_any_colour_and_phase_function_shines_as_the_closed_form_says() {
    let hg = |g: f64| move |cos: f64| (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5));
    let at = [0.5, 1.0, 0.0, 3.0];
    let text = fog("sigma-s = [0.2, 0.8, 3], sigma-a = [0.3, 0.2, 0]", 1.0);
    let expected = [(0.2, 0.5), (0.8, 1.0), (3.0, 3.0)].map(|(s, t)| airlight(s, t, isotropic, at));
    assert_radiance("coloured fog", &text, ONCE, expected, 0.2);
    for g in [-0.5, 0.7] {
        let phase = format!("sigma-t = 1, albedo = 0.8, phase = {{ type = 'henyey-greenstein', g = {g} }}");
        assert_radiance("phase", &fog(&phase, 1.0), ONCE, [airlight(0.8, 1.0, hg(g), at); 3], 0.2);
    }
}

/// The cube of fog that mitransient was measured with.
#[test]
fn a_cube_of_fog_seen_from_outside_is_lit_through_its_border() {
    let text = "
        camera = { origin = [0, 0, -10], target = [0, 0, 0], fov = 0.01 }
        film = { size = [1, 1] }
        lights = [{ type = 'point', position = [0.5, 0, 0], intensity = 1 }]
        media = { fog = { type = 'homogeneous', sigma-t = 0.3, albedo = 0.8 } }
        [[shapes]]
        type = 'cube'
        transform = [{ scale = 2 }]
        interior = 'fog'\n";
    assert_radiance("cube", text, ONCE, [0.044_960_5; 3], 0.1);
    // Where a shadow ray has to go through the border.
    let outside = text.replace("[0.5, 0, 0]", "[0, 3, 0]");
    let step = 1e-4;
    let value = |z: f64| {
        let d = (9.0 + z * z).sqrt();
        0.24 * 0.25 / PI * (-0.3 * (z + 2.0 + d * 2.0 / 3.0)).exp() / (d * d)
    };
    // Through the side as long as the light comes in there.
    let expected: f64 = (0..40_000).map(|i| value(-2.0 + (f64::from(i) + 0.5) * step) * step).sum();
    assert_radiance("lamp outside", &outside, ONCE, [expected; 3], 0.1);
}

/// Nothing is absorbed: what shines all around shines out of the fog as well, and a border that refracts changes nothing.
#[test]
fn fog_that_absorbs_nothing_is_invisible_in_a_furnace() {
    for material in ["{ type = 'none' }", "{ type = 'glass', ior = 1.5 }"] {
        for (phase, sigma) in
            [("{ type = 'isotropic' }", "[0.5, 1, 2]"), ("{ type = 'henyey-greenstein', g = 0.7 }", "3")]
        {
            let text = RAY.to_string()
                + &format!(
                    "lights = [{{ type = 'constant', radiance = 1 }}]
                     media = {{ milk = {{ type = 'homogeneous', sigma-t = {sigma}, albedo = 1, phase = {phase} }} }}
                     [[shapes]]
                     type = 'sphere'
                     center = [0.2, 0.1, 4]
                     material = {material}
                     interior = 'milk'"
                );
            assert_radiance("furnace", &text, "integrator=path samples=400", [1.0; 3], 0.06);
        }
    }
}

/// Where a path is after so much way, and what it still carries.
struct At {
    way: f64,
    found: Option<(Vec3, f32)>,
}

impl Visitor for At {
    fn vertex(&mut self, _: &SurfacePoint, _: &PathState, _: &mut Sampler) -> Lobes {
        Lobes::NONE
    }

    fn segment(&mut self, segment: &Segment, path: &PathState, _: &mut Sampler) {
        let left = self.way - path.optical_length;
        if (0.0..f64::from(segment.length)).contains(&left) {
            self.found = Some((segment.ray.at(left as f32), path.throughput.max()));
        }
    }
}

/// What is left of each of many paths from the origin after three units of way, and the squared distance of those alive.
fn after_three(lit: &Lit) -> (Vec<f64>, Vec<f64>) {
    let limits = Limits { max_bounces: 1000, roulette_from: 0 };
    let (mut alive, mut squares) = (Vec::new(), Vec::new());
    for index in 0..100_000 {
        let mut at = At { way: 3.0, found: None };
        let mut sampler = Sampler::new(1, 0, 0, index);
        let path = PathState::new(Ray { origin: Vec3::ZERO, direction: Vec3::Z }, Spectrum::ONE);
        walk(&lit.scene, path, Origin::Light, &limits, &mut sampler, &mut at);
        alive.push(at.found.map_or(0.0, |(_, weight)| f64::from(weight)));
        squares.extend(at.found.map(|(position, _)| f64::from(position.length_squared())));
    }
    (alive, squares)
}

/// Alive fraction e^(−σa s), and ⟨r²⟩ = 2 ℓ² (s/ℓ − 1 + e^(−s/ℓ)) of those alive, ℓ = 1 / (σs (1 − g)).
#[test]
fn a_pulse_in_an_infinite_medium_decays_and_spreads_as_it_must() {
    for (g, spread) in [(0.0, 2.501_239), (0.8, 6.264_928)] {
        let text = format!(
            "{RAY}
             lights = [{{ type = 'point', position = [0, 0, 0], intensity = 1 }}]
             medium = 'fog'
             media.fog = {{ type = 'homogeneous', sigma-s = 2, sigma-a = 0.25, phase = {{ type = 'henyey-greenstein', g = {g} }} }}"
        );
        let (alive, squares) = after_three(&lit(&text, ""));
        assert_mean("alive", &alive, f64::exp(-0.75), 0.0, 0.03);
        assert_mean("spread", &squares, spread, 0.0, 0.05);
        assert!(Sample::of(&alive).variance > 0.0);
    }
}

/// A grid of these densities, by any name.
struct Densities(VolumeData);

impl Assets for Densities {
    fn mesh(&self, file: &str, index: u32) -> Result<Arc<MeshData>> {
        NoAssets.mesh(file, index)
    }

    fn picture(&self, file: &str, raw: bool) -> Result<Arc<Raster>> {
        NoAssets.picture(file, raw)
    }

    fn volume(&self, _: &str) -> Result<Arc<VolumeData>> {
        Ok(Arc::new(self.0.clone()))
    }
}

/// A scene with these densities.
fn lit_in(text: &str, settings: &str, densities: &Densities) -> Lit {
    let mut description = described(text);
    for setting in settings.split_whitespace() {
        let (key, value) = setting.split_once('=').expect("key=value");
        let set = match key {
            "integrator" => description.use_integrator(value),
            _ => description.set(key, value),
        };
        set.unwrap_or_else(|error| panic!("{error}"));
    }
    let scene = build(&description, densities).unwrap_or_else(|error| panic!("{error}")).scene;
    Lit { description, scene }
}

/// A cloud whose density is 1 in the first quarter of its box, where the bound is ten times as high, as far as a second
/// value, ten times as high, is away. The box reaches from -500 to 3500, so that
/// everything lies in the first quarter.
fn even_cloud(keys: &str) -> (String, Densities) {
    let medium = format!(
        "media.fog = {{ type = 'grid', file = 'any', transform = [{{ scale = 4000 }}, {{ translate = [-500, -2000, -2000] }}], {keys} }}"
    );
    let bounds = [[0.0; 3], [1.0; 3]];
    (medium, Densities(VolumeData { size: [2, 1, 1], channels: 1, bounds, values: vec![1.0, 10.0] }))
}

/// The homogeneous medium and the cloud of the same density are the same, however many null collisions there are: in
/// their light, and in how long paths are.
#[test]
fn an_even_cloud_is_a_homogeneous_medium() {
    let (medium, densities) = even_cloud("sigma-t = 0.3, albedo = 0.8");
    let text = format!(
        "{RAY}
         {medium}
         lights = [{{ type = 'point', position = [0.5, 0, 10], intensity = 1 }}]
         [[shapes]]
         type = 'cube'
         transform = [{{ scale = 2 }}, {{ translate = [0, 0, 10] }}]
         interior = 'fog'\n"
    );
    for (settings, bias) in [
        (ONCE, 0.0),
        (
            "integrator=photon-map max_bounces=1 volume=beams volume-radius=0.03 radius=1 bandwidth=fixed photons=10000",
            0.005,
        ),
        (
            "integrator=photon-map max_bounces=1 volume=points volume-radius=0.1 radius=1 bandwidth=fixed photons=20000",
            0.02,
        ),
        (
            "integrator=photon-map max_bounces=1 volume=balls volume-radius=0.1 radius=1 bandwidth=fixed photons=20000 samples=64",
            0.02,
        ),
    ] {
        let lit = lit_in(&text, settings, &densities);
        for values in lit.means(40) {
            assert_mean(settings, &values, 0.044_960_5, bias * 0.045, 0.4);
        }
    }
    let (medium, densities) = even_cloud("sigma-t = 2.25, albedo = 0.888888888");
    let lights = "lights = [{ type = 'point', position = [0, 0, 0], intensity = 1 }]";
    let text = format!("medium = 'fog'\n{RAY} {medium}\n{lights}");
    let (alive, squares) = after_three(&lit_in(&text, "", &densities));
    assert_mean("alive", &alive, f64::exp(-0.75), 0.0, 0.03);
    assert_mean("spread", &squares, 2.501_239, 0.0, 0.05);
}

/// A slope of density, of three colours, absorbs by its integral.
#[test]
fn a_cloud_of_colours_absorbs_by_the_integral_of_its_density() {
    // Along z from 4 to 6: 1, 2 and 3 in the middles of thirds in red, three times as much and half in the others.
    let values = [1.0, 2.0, 3.0].iter().flat_map(|&red| [red, 3.0 * red, 0.5 * red]).collect();
    let densities = Densities(VolumeData { size: [1, 1, 3], channels: 3, bounds: [[0.0; 3], [1.0; 3]], values });
    let text = RAY.to_string()
        + "lights = [{ type = 'constant', radiance = 1 }]
           media.ink = { type = 'grid', file = 'any', sigma-t = 0.25, albedo = 0, transform = [{ translate = [-0.5, -0.5, -0.5] }, { scale = 2 }, { translate = [0, 0, 5] }] }
           [[shapes]]
           type = 'cube'
           transform = [{ translate = [0, 0, 5] }]
           interior = 'ink'";
    // The mean of 1, 2, 3 linear between and even at the ends is 2, and the cube is 2 deep.
    let lit = lit_in(&text, "integrator=path samples=400", &densities);
    for (values, factor) in lit.means(40).iter().zip([1.0_f64, 3.0, 0.5]) {
        assert_mean("cloud", values, (-factor).exp(), 0.0, 0.3);
    }
}

/// Fog has a length in it: where all lengths are so many times as long, it must be as thin.
#[test]
fn fog_has_no_unit() {
    let picture = |scale: f64, settings: &str| {
        let text = format!(
            "camera = {{ origin = [0, 0, {0:?}], target = [0, 0, 0] }}
             film = {{ size = [8, 8] }}
             lights = [{{ type = 'point', position = [{1:?}, {2:?}, 0], intensity = {3:?} }}]
             media = {{ fog = {{ type = 'homogeneous', sigma-t = {4:?}, albedo = 0.9 }} }}
             [[shapes]]
             type = 'sphere'
             radius = {2:?}
             interior = 'fog'\n",
            -4.0 * scale,
            0.3 * scale,
            scale,
            scale * scale,
            1.0 / scale
        );
        lit(&text, settings).image(4)
    };
    for settings in ["integrator=path samples=4", "integrator=photon-map photons=2000", "integrator=auto photons=2000"]
    {
        let mean = |scale| common::channel_mean(&picture(scale, settings), 0);
        for scale in [1024.0, 1.0 / 1024.0] {
            assert!((mean(scale) / mean(1.0) - 1.0).abs() < 1e-4, "{settings}: {} is not {}", mean(scale), mean(1.0));
        }
    }
}
