//! Normal maps, bump maps and holes: the same to light from either end, and the same as in Mitsuba.

mod common;

use std::sync::Arc;

use common::statistics::{assert_mean, assert_same_mean};
use common::{Lit, described, lit};
use glam::Vec3;
use lampyris::error::{Error, Result};
use lampyris::geometry::{MeshData, Ray};
use lampyris::image::Image;
use lampyris::material::Bsdf;
use lampyris::scene::{Assets, build};
use lampyris::texture::Raster;

/// Pictures that need no files.
struct Pictures;

impl Assets for Pictures {
    fn mesh(&self, _: &str, _: u32) -> Result<Arc<MeshData>> {
        Err(Error::new("there are no meshes"))
    }

    fn picture(&self, file: &str, _: bool) -> Result<Arc<Raster>> {
        let image = match file {
            "normal" => Image::from_pixels(1, 1, vec![[0.75, 0.4, 0.85]]),
            "heights" => {
                // Mitsuba has its first row at v = 0.
                let heights = [0.4, 0.8, 0.6, 0.7, 0.3, 0.9, 0.1, 0.5, 0.2];
                Image::from_pixels(3, 3, heights.map(|height| [height; 3]).to_vec())
            }
            // Two waves across.
            _ => {
                let wave = |index: usize| 0.5 + 0.5 * (index as f32 * std::f32::consts::PI / 8.0).cos();
                let pixels = (0..32 * 32).map(|index| [wave(index % 32) * wave(index / 32); 3]).collect();
                Image::from_pixels(32, 32, pixels)
            }
        };
        Ok(Arc::new(image.and_then(Raster::of_image).expect("pixels")))
    }
}

const TEXTURES: &str = "
    [textures]
    normal = { type = 'bitmap', file = 'normal' }
    heights = { type = 'bitmap', file = 'heights', raw = true }
    waves = { type = 'bitmap', file = 'waves', raw = true }\n";

fn pictured(text: &str, settings: &str) -> Lit {
    let mut description = described(&(text.to_string() + TEXTURES));
    for setting in settings.split_whitespace() {
        let (key, value) = setting.split_once('=').expect("key=value");
        if key == "integrator" {
            description.use_integrator(value).expect("an integrator");
        } else {
            description.set(key, value).expect("a setting");
        }
    }
    let scene = build(&description, &Pictures).unwrap_or_else(|error| panic!("{error}")).scene;
    Lit { description, scene }
}

const METAL: &str = "{ type = 'conductor', eta = [0.2, 0.9, 1.5], k = [3.9, 2.4, 1.9],
    roughness = { alpha = 0.2, alpha-v = 0.5 } }";
const DIFFUSE: &str = "{ type = 'diffuse', reflectance = [0.8, 0.4, 0.2] }";

#[test]
fn turned_normals_scatter_as_in_mitsuba() {
    let normals = |material: &str| format!("{{ type = 'normal-map', normals = 'normal', material = {material} }}");
    let bumps = |scale: f32, material: &str| {
        format!("{{ type = 'bump-map', height = 'heights', scale = {scale}, material = {material} }}")
    };
    for (name, material) in [
        ("normal-map", normals(DIFFUSE)),
        ("normal-map-metal", normals(METAL)),
        ("bump-map", bumps(0.4, DIFFUSE)),
        ("bump-map-metal", bumps(-0.7, METAL)),
        ("two-sided-normal-map", format!("{{ type = 'two-sided', front = {} }}", normals(METAL))),
    ] {
        let text = format!(
            "camera = {{ origin = [0, 0, 3], target = [0, 0, 0] }}
             lights = [{{ type = 'constant' }}]
             shapes = [{{ type = 'quad', corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0], material = {} }}]",
            material.replace('\n', " ")
        );
        let lit = pictured(&text, "");
        let mut lines = 0;
        for line in include_str!("data/mitsuba_bsdfs.txt").lines() {
            if line.split(' ').next() != Some(name) {
                continue;
            }
            let numbers: Vec<f32> = line.split(' ').skip(1).map(|number| number.parse().expect("a number")).collect();
            let [previous, light, radiance] = [0, 3, 6].map(|at| Vec3::from_slice(&numbers[at..at + 3]));
            if previous.z < 0.0 && !name.starts_with("two-sided") {
                continue; // Mitsuba's are black from behind.
            }
            let at = Vec3::new(-0.2, -0.1, 0.0);
            let ray = Ray { origin: at + previous, direction: -previous };
            let mut bsdf = Bsdf::default();
            let point = lit.scene.closest(&ray, &mut bsdf).expect("the quad");
            let value = Vec3::from(point.eval_radiance(light).to_rgb()) * point.cos(light);
            let off = (value - radiance).abs().max_element();
            let allowed = 5e-4 * radiance.abs().max_element() + 1e-5;
            assert!(off <= allowed, "{name} from {previous} to {light}: {value} is not {radiance}");
            lines += 1;
        }
        assert!(lines > 20, "{name} has {lines} lines");
    }
}

/// A bumpy plane under a lamp, seen from above; the camera sees all of it but its edges.
fn bumpy(material: &str) -> String {
    format!(
        "camera = {{ origin = [0, 0, 4], target = [0, 0, 0], fov = 20 }}
         film = {{ size = [8, 8] }}
         shapes = [
             {{ type = 'quad', corner = [-2, -2, 0], u = [4, 0, 0], v = [0, 4, 0], material = {} }},
             {{ type = 'disk', center = [1.5, 0.5, 3], normal = [-0.4, -0.1, -1], radius = 0.6,
                emission = {{ radiance = [3, 3, 3] }} }},
             {{ type = 'quad', corner = [-2, -2, 0], u = [0, 0, 3], v = [0, 4, 0],
                material = {{ type = 'diffuse', reflectance = 0.6 }} }},
         ]",
        material.replace('\n', " ")
    )
    .replace('\n', " ")
    .replace("film =", "\nfilm =")
    .replace("shapes =", "\nshapes =")
}

/// Path tracing, light tracing and both kinds of photon maps must see the same light on a plane whose normals a texture
/// turns. Where a direction grazes, the normal is turned again for whoever looks, from the camera or from the lamp: below
/// 0.5 % here.
#[test]
fn light_from_the_lamp_and_from_the_camera_agree_on_a_bumpy_plane() {
    for material in [
        "{ type = 'bump-map', height = 'waves', scale = 0.15, material = { type = 'diffuse', reflectance = 0.7 } }",
        "{ type = 'bump-map', height = 'waves', scale = 0.1,
           material = { type = 'conductor', metal = 'Au', roughness = { alpha = 0.4 } } }",
    ] {
        let means = |settings: &str| pictured(&bumpy(material), settings).means(40);
        let path = means("integrator=path samples=64");
        for way in [
            "integrator=light photons=40000",
            "integrator=photon-map photons=20000 bandwidth=fixed radius=0.05 direct=next-event samples=16",
            "integrator=photon-map photons=20000 bandwidth=fixed radius=0.05 direct=photons samples=16",
            "integrator=auto photons=20000 radius=0.2 samples=16",
        ] {
            let other = means(way);
            assert_same_mean(&format!("{material}, {way}"), &path[1], &other[1], 6, 0.005);
        }
    }
}

/// A floor under a sheet with holes, lit by `light` through them.
fn under_a_sheet(light: &str) -> String {
    format!(
        "camera = {{ origin = [0, 0.5, 0], target = [0, 0, 0], up = [0, 0, 1], fov = 40 }}
         film = {{ size = [4, 4] }}
         {light}
         [[shapes]]
         type = 'quad'
         corner = [-1, 0, -1]
         u = [0, 0, 2]
         v = [2, 0, 0]
         material = {{ type = 'diffuse', reflectance = 0.5 }}
         [[shapes]]
         type = 'quad'
         corner = [-1.2, 1, -1.2]
         u = [2.4, 0, 0]
         v = [0, 0, 2.4]
         material = {{ type = 'mask', opacity = 0.7, material = {{ type = 'diffuse', reflectance = 0 }} }}"
    )
}

/// Every way to compute light.
const WAYS: [&str; 5] = [
    "integrator=path samples=64",
    "integrator=light photons=80000",
    "integrator=photon-map photons=40000 bandwidth=fixed radius=0.1 direct=next-event samples=16",
    "integrator=photon-map photons=40000 bandwidth=fixed radius=0.1 direct=photons samples=16",
    "integrator=auto photons=40000 radius=0.2 samples=16",
];

#[test]
fn parallel_light_comes_through_holes_once() {
    let text = under_a_sheet("lights = [{ type = 'directional', direction = [0, -1, 0], irradiance = 2 }]");
    for way in WAYS {
        let expected = 0.3 * 2.0 * 0.5 / std::f64::consts::PI;
        assert_mean(way, &lit(&text, way).means(40)[0], expected, 0.0, 0.1);
    }
}

/// The sky gives the same radiance in all directions: through holes 0.3 of it.
#[test]
fn the_sky_is_seen_through_holes_once() {
    let text =
        under_a_sheet("lights = [{ type = 'constant', radiance = 1 }]").replace("[-1.2, 1, -1.2]", "[-300, 1, -300]");
    let text = text.replace("u = [2.4, 0, 0]", "u = [600, 0, 0]").replace("v = [0, 0, 2.4]", "v = [0, 0, 600]");
    // Photons from the sky would spread over the whole sheet.
    assert_mean("sky", &lit(&text, WAYS[0]).means(40)[0], 0.3 * 0.5, 0.001, 0.02);
}

/// A lamp behind the sheet, found by shadow rays and by chance, and through two sheets at once.
#[test]
fn a_lamp_behind_two_sheets_gives_all_ways_the_same_light() {
    let sheet = "
         [[shapes]]
         type = 'quad'
         corner = [-3, 1.3, -3]
         u = [6, 0, 0]
         v = [0, 0, 6]
         material = { type = 'mask', opacity = 0.4, material = { type = 'diffuse', reflectance = 0.5 } }
         [[shapes]]
         type = 'sphere'
         center = [0.3, 2, 0]
         radius = 0.4
         emission = { radiance = 20 }";
    let text = under_a_sheet("") + sheet;
    // Nothing goes round the sheet that is mostly holes.
    let text = text.replace("[-1.2, 1, -1.2]", "[-3, 1, -3]");
    let text = text.replace("u = [2.4, 0, 0]", "u = [6, 0, 0]").replace("v = [0, 0, 2.4]", "v = [0, 0, 6]");
    let path = lit(&text, WAYS[0]).means(60);
    let mean = path[0].iter().sum::<f64>() / path[0].len() as f64;
    assert!(mean > 0.05, "{mean}");
    for way in &WAYS[1..] {
        assert_same_mean(way, &path[0], &lit(&text, way).means(60)[0], 3, 0.005);
    }
}
