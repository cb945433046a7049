//! Light of wavelengths: glass bends each by its own index, and what no glass separates looks as it does without them.
//!
//! The wavelengths of passes lie evenly over passes, so that passes are no independent samples; rounds of 16 in a row are, as
//! far as a test of their means goes: each round covers the spectrum.

mod common;

use common::statistics::{Sample, assert_mean, assert_same_mean};
use common::{Lit, described, lit, on_threads};
use glam::{Vec2, Vec3};
use lampyris::film::{Layer, Layers};
use lampyris::geometry::Ray;
use lampyris::image::{Image, luminance};
use lampyris::integrator::Silent;
use lampyris::material::{Event, Lobes};
use lampyris::render::Render;
use lampyris::sampler::Sampler;
use lampyris::scene::{NoAssets, Scene, SurfacePoint, build};
use lampyris::spectrum::{Dispersion, FRAUNHOFER_C, FRAUNHOFER_D, FRAUNHOFER_F, Spectrum};
use lampyris::texture::Lookup;
use lampyris::transport::{End, Limits, Origin, PathState, Visitor, Walked, walk};

/// Passes whose wavelengths together cover the spectrum.
const ROUND: usize = 16;

/// Means over the picture, per channel, of each round of passes.
fn rounds(lit: &Lit, count: usize) -> [Vec<f64>; 3] {
    let means = lit.means((count * ROUND) as u32);
    means.map(|means| means.chunks(ROUND).map(|round| round.iter().sum::<f64>() / ROUND as f64).collect())
}

/// Follows these lobes at these vertices, and nothing at later ones.
struct Follow<'a>(&'a [Event]);

impl Visitor for Follow<'_> {
    fn vertex(&mut self, _: &SurfacePoint, path: &PathState, _: &mut Sampler) -> Lobes {
        self.0.get(path.bounce as usize).map_or(Lobes::NONE, |&event| event.into())
    }
}

fn follow(scene: &Scene, ray: Ray, carried: Spectrum, events: &[Event], index: u64) -> Walked {
    let limits = Limits { max_bounces: 16, roulette_from: 100 };
    let mut sampler = Sampler::new(1, 0, 9, index);
    walk(scene, PathState::new(ray, carried), Origin::Light, &limits, &mut sampler, &mut Follow(events))
}

/// Nobody looks at these scenes.
const UNSEEN: &str = "
    film = { size = [1, 1] }
    camera = { origin = [0, 0, 50], target = [0, 0, 0] }
    lights = [{ type = 'point', position = [50, 50, 0], power = 1 }]\n";

/// Both faces of a prism of 60° whose edge lies along z through the origin, the bulk below it.
fn prism(substance: &str) -> Lit {
    let (sine, cosine) = 30_f64.to_radians().sin_cos();
    let glass = format!("material = {{ type = 'glass', ior = '{substance}' }}");
    let face =
        |u: String, v: String| format!("[[shapes]]\ntype = 'quad'\ncorner = [0, 0, 0]\nu = {u}\nv = {v}\n{glass}\n");
    let (left, right) =
        (format!("[{}, {}, 0]", -4.0 * sine, -4.0 * cosine), format!("[{}, {}, 0]", 4.0 * sine, -4.0 * cosine));
    let z = || "[0, 0, 4]".to_string();
    lit(&(UNSEEN.to_string() + &face(left, z()) + &face(z(), right)), "")
}

/// The least angle in degrees by which a prism of 60° turns light.
fn least_deviation(index: f64) -> f64 {
    (2.0 * (0.5 * index).asin()).to_degrees() - 60.0
}

#[test]
fn a_prism_has_the_angles_of_the_lines_of_fraunhofer() {
    let bk7 = Dispersion::of_substance("bk7").expect("bk7");
    for (line, degrees) in [(FRAUNHOFER_F, 39.1381), (FRAUNHOFER_D, 38.6467), (FRAUNHOFER_C, 38.4291)] {
        assert!((least_deviation(bk7.at(line)) - degrees).abs() < 1e-4, "{line}: {}", least_deviation(bk7.at(line)));
    }
}

/// Light of each wavelength enters under the angle of its least deviation and leaves turned by just that; light of all four
/// goes on as one of them.
#[test]
fn a_prism_turns_every_wavelength_by_its_own_angle() {
    for substance in ["bk7", "sf11"] {
        let (prism, glass) = (prism(substance), Dispersion::of_substance(substance).expect("glass"));
        for pass in 0..8 {
            let scene = prism.scene.of_pass(0, pass);
            let nanometres = scene.basis().nanometres().expect("the glass disperses");
            for (lane, wavelength) in nanometres.into_iter().enumerate() {
                let deviation = least_deviation(glass.at(wavelength.into()));
                let (sine, cosine) = (0.5 * deviation).to_radians().sin_cos();
                let direction = Vec3::new(cosine as f32, sine as f32, 0.0);
                let at = Vec3::new(-1.0, -(3_f32.sqrt()), 2.0);
                let ray = Ray { origin: at - 3.0 * direction, direction };
                let turned =
                    |walked: &Walked| f64::from(direction.angle_between(walked.path.ray.direction)).to_degrees();
                let through = [Event::Refraction; 2];
                let walked = follow(&scene, ray, Spectrum::ONE.only(lane), &through, 0);
                assert_eq!((walked.end, walked.path.bounce), (End::Escaped, 2));
                assert!((turned(&walked) - deviation).abs() < 1e-3, "{wavelength} nm: {} {deviation}", turned(&walked));
                let all = (0..64).map(|index| follow(&scene, ray, Spectrum::ONE, &through, index));
                let same: Vec<Walked> = all.filter(|walked| walked.path.throughput.lanes()[lane] > 0.0).collect();
                assert!((4..40).contains(&same.len()), "{} of 64 follow lane {lane}", same.len());
                for walked in same {
                    let throughput = walked.path.throughput;
                    assert!((turned(&walked) - deviation).abs() < 1e-3 && throughput == throughput.only(lane));
                    // All that was carried, but for what the faces reflect.
                    assert!((2.5..4.0).contains(&throughput.max()), "{throughput:?}");
                }
            }
        }
    }
}

const ANGLES: f64 = 0.125;

/// Of a wavelength in nm the angle beyond which there is no light, and that where there is most.
struct Bow {
    wavelength: f64,
    last: f64,
    brightest: f64,
}

/// A drop of water in parallel light: linear RGB of what leaves it after one reflection inside, by the angle to the way back
/// to the sun, in bins of [`ANGLES`] degrees; and the bow of each wavelength.
fn rainbow(passes: u32) -> (Vec<[f64; 3]>, Vec<Bow>) {
    let drop = lit(
        &(UNSEEN.to_string()
            + "[[shapes]]
               type = 'sphere'
               material = { type = 'glass', ior = 'water' }\n"),
        "",
    );
    let (mut colors, mut bows) = (vec![[0.0; 3]; (60.0 / ANGLES) as usize], Vec::new());
    let steps = 6000;
    for pass in 0..passes {
        let scene = drop.scene.of_pass(0, pass);
        let nanometres = scene.basis().nanometres().expect("water disperses");
        for (lane, wavelength) in nanometres.into_iter().enumerate() {
            let mut bins = vec![0.0; colors.len()];
            for step in 0..steps {
                // Uniform over the drop's section, from its middle to its rim.
                let aside = ((step as f32 + 0.5) / steps as f32).sqrt();
                let ray = Ray { origin: Vec3::new(-9.0, aside, 0.0), direction: Vec3::X };
                let events = [Event::Refraction, Event::Specular, Event::Refraction];
                let walked = follow(&scene, ray, Spectrum::ONE.only(lane), &events, step);
                if walked.end == End::Escaped {
                    let angle = f64::from(walked.path.ray.direction.angle_between(Vec3::NEG_X)).to_degrees();
                    let rgb = scene.basis().to_rgb(walked.path.throughput);
                    let bin = (angle / ANGLES) as usize;
                    bins[bin] += f64::from(walked.path.throughput.max());
                    (0..3).for_each(|channel| colors[bin][channel] += f64::from(rgb[channel]));
                }
            }
            let place = |bin: Option<usize>| (bin.expect("light") as f64 + 0.5) * ANGLES;
            let last = bins.iter().rposition(|&light| light > 0.0);
            let brightest = (0..bins.len()).max_by(|&a, &b| bins[a].total_cmp(&bins[b]));
            bows.push(Bow { wavelength: wavelength.into(), last: place(last), brightest: place(brightest) });
        }
    }
    (colors, bows)
}

#[test]
fn a_drop_of_water_makes_a_rainbow_of_42_degrees_red_outside() {
    let (colors, bows) = rainbow(16);
    let water = Dispersion::of_substance("water").expect("water");
    // [Descartes 1637]: the angle 4r - 2i is largest where cos² i = (n² - 1) / 3.
    let descartes = |wavelength: f64| {
        let index = water.at(wavelength);
        let incidence = ((index * index - 1.0) / 3.0).sqrt().acos();
        (4.0 * (incidence.sin() / index).asin() - 2.0 * incidence).to_degrees()
    };
    assert!((descartes(700.0) - 42.44).abs() < 0.01 && (descartes(404.7) - 40.63).abs() < 0.01);
    for Bow { wavelength, last, brightest } in bows {
        let exact = descartes(wavelength);
        assert!(
            (last - exact).abs() < ANGLES && (brightest - exact).abs() < 1.5 * ANGLES,
            "{wavelength}: {last} {exact}"
        );
    }
    let brightest = |channel: usize| {
        let bin = (0..colors.len()).max_by(|&a, &b| colors[a][channel].total_cmp(&colors[b][channel]));
        (bin.expect("light") as f64 + 0.5) * ANGLES
    };
    for (channel, degrees) in [42.0, 41.6, 40.9].into_iter().enumerate() {
        assert!((brightest(channel) - degrees).abs() < 0.2, "channel {channel}: {}", brightest(channel));
    }
    let [red, green, blue] = colors[(42.3 / ANGLES) as usize];
    assert!(red > 5.0 * green.abs() && red > 5.0 * blue.abs(), "the outer rim is red: {red} {green} {blue}");
    assert!(colors[(43.0 / ANGLES) as usize..].iter().flatten().all(|&light| light == 0.0), "beyond it is dark");
}

/// The two ways of a path of four wavelengths and of a path of one must have the same mean: weights, directions and the
/// change of radiance, at a smooth and at a rough boundary.
#[test]
fn what_happens_to_four_wavelengths_together_happens_to_each_alone() {
    let tries = 200_000;
    for roughness in ["", ", roughness = { alpha = 0.05 }", ", roughness = { alpha = 0.4, multiple-scattering = true }"]
    {
        let text = format!(
            "{UNSEEN}[[shapes]]\ntype = 'sphere'\nmaterial = {{ type = 'glass', ior = 'n-sf66', reflectance = [1, 0.8, 0.6]{roughness} }}\n"
        );
        let lit = lit(&text, "");
        let scene = lit.scene.of_pass(0, 3);
        let id = scene.shapes()[0].material;
        // From outside, and from inside near the critical angle, beyond which some wavelengths are reflected all.
        for to_previous in [Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.515, 0.0, -0.857).normalize()] {
            let sums = |carried: Spectrum| {
                let at = Lookup { basis: scene.basis(), carried: &carried, ..Lookup::point(Vec2::ZERO) };
                let bsdf = scene.materials().bsdf(id, &at, to_previous.z > 0.0);
                let mut values: [[Vec<f64>; 4]; 4] = Default::default();
                for index in 0..tries {
                    let mut sampler = Sampler::new(0, 0, 7, index);
                    let scattered = bsdf.sample(to_previous, Lobes::ALL, &mut sampler);
                    for lane in 0..4 {
                        let (weight, direction, ratio) =
                            scattered.as_ref().map_or((0.0, Vec3::ZERO, 1.0), |scattered| {
                                (scattered.weight.lanes()[lane], scattered.to_next, scattered.ior_ratio.lanes()[lane])
                            });
                        let tests = [1.0, direction.x, direction.z, 1.0 / (ratio * ratio)];
                        for (values, test) in values[lane].iter_mut().zip(tests) {
                            values.push(f64::from(weight * test));
                        }
                    }
                }
                values
            };
            let together = sums(Spectrum::from_lanes([0.4, 1.0, 0.7, 0.2]));
            for lane in 0..4 {
                let alone = sums(Spectrum::ONE.only(lane));
                for test in 0..4 {
                    let name = format!("'{roughness}' {to_previous} lane {lane} test {test}");
                    assert_same_mean(&name, &together[lane][test], &alone[lane][test], 96, 1e-6);
                }
            }
        }
    }
}

/// A ball of glass in a bright sky is as bright as the sky, in every colour.
#[test]
fn glass_in_a_furnace_is_invisible() {
    let scene = |material: &str| {
        format!(
            "film = {{ size = [8, 8] }}
             camera = {{ origin = [0, 0, 3], target = [0, 0, 0], fov = 30 }}
             lights = [{{ type = 'constant', radiance = [1, 2, 0.5] }}]
             [[shapes]]
             type = 'sphere'
             material = {{ type = 'glass', ior = 'sf11'{material} }}\n"
        )
    };
    let photon_map = "integrator=photon-map photons=100 bandwidth=fixed radius=0.3 samples=8";
    for way in ["integrator=path samples=8", "integrator=auto photons=1000 samples=8", photon_map] {
        let means = rounds(&lit(&scene(""), &format!("{way} max_bounces=200")), 16);
        for (values, expected) in means.iter().zip([1.0, 2.0, 0.5]) {
            assert_mean(way, values, expected, 0.002 * expected, 0.06);
        }
    }
}

/// A box of coloured walls and a ball, lit by a lamp of a colour: seen once reflected.
fn room(extra: &str, max_bounces: u32, wall: &str) -> String {
    format!(
        "film = {{ size = [12, 12] }}
         camera = {{ origin = [0.1, 0.6, -0.9], target = [0, -1, 0.1], fov = 40 }}
         integrator = {{ type = 'path', max-bounces = {max_bounces} }}
         render = {{ {extra} }}
         [[shapes]]
         type = 'cube'
         flip-normal = true
         material = {{ type = 'diffuse', reflectance = {wall} }}
         [[shapes]]
         type = 'quad'
         corner = [-0.3, 0.9, -0.3]
         u = [0.6, 0, 0]
         v = [0, 0, 0.6]
         emission = {{ radiance = 4 }}
         [[shapes]]
         type = 'sphere'
         center = [0.15, -0.5, 0.1]
         radius = 0.2
         material = {{ type = 'glass', ior = 1.5 }}\n"
    )
}

const WAYS: [&str; 4] = [
    "integrator=path samples=8",
    "integrator=auto photons=4000 samples=4",
    "integrator=light photons=4000",
    "integrator=photon-map photons=4000 bandwidth=fixed radius=0.1 samples=2",
];

/// Without dispersion light of wavelengths makes the picture of light without them: exactly for greys, and for colours that
/// light meets once.
#[test]
fn without_dispersion_there_is_no_difference() {
    for (bounces, wall) in [(8, "0.6"), (1, "[0.9, 0.05, 0.3]"), (1, "[0.05, 0.1, 0.8]")] {
        for way in WAYS {
            let seen = |spectral: &str| {
                rounds(&lit(&room(spectral, bounces, wall), &format!("{way} max_bounces={bounces}")), 16)
            };
            let (with, without) = (seen("spectral = true"), seen("spectral = false, seed = 1"));
            for channel in 0..3 {
                assert_same_mean(&format!("{wall} {way} {channel}"), &with[channel], &without[channel], 36, 0.004);
            }
        }
    }
}

/// What a saturated wall does to light again and again depends on more than three numbers; that it stays near is what the
/// smoothness of the primaries' curves is for.
#[test]
fn repeated_reflections_off_a_colour_stay_near_it() {
    let seen = |spectral: &str| rounds(&lit(&room(spectral, 8, "[0.8, 0.4, 0.2]"), "integrator=path samples=8"), 8);
    let (with, without) = (seen("spectral = true"), seen("spectral = false"));
    for channel in 0..3 {
        let [a, b] = [&with, &without].map(|means| Sample::of(&means[channel]).mean);
        assert!((a / b - 1.0).abs() < 0.1, "channel {channel}: {a} and {b}");
    }
}

/// The caustic of a ball of glass that disperses strongly, under a lamp that paths can find, too; the ball is out of sight,
/// so that light tracing sees all that can be seen.
const CAUSTIC: &str = "
    film = { size = [8, 8] }
    camera = { origin = [0, -0.2, -2.5], target = [0, -1, 0.1], fov = 22 }
    [[shapes]]
    type = 'quad'
    corner = [-2, -1, -2]
    u = [0, 0, 4]
    v = [4, 0, 0]
    material = { type = 'diffuse', reflectance = [0.8, 0.6, 0.4] }
    [[shapes]]
    type = 'sphere'
    center = [0, 3, 0]
    radius = 0.5
    emission = { radiance = [3, 4, 5] }
    [[shapes]]
    type = 'sphere'
    center = [0, 0, 0]
    radius = 0.4
    material = { type = 'glass', ior = 'n-sf66' }\n";

#[test]
fn all_integrators_agree_on_a_coloured_caustic_of_smooth_and_of_rough_glass() {
    let rough = CAUSTIC.replace("'n-sf66'", "'n-sf66', roughness = { alpha = 0.15 }");
    for scene in [CAUSTIC, &rough] {
        let reference = rounds(&lit(scene, "integrator=path samples=32"), 20);
        for way in [
            "integrator=photon-map photons=8000 bandwidth=fixed radius=0.03 samples=8 seed=1",
            "integrator=light photons=20000 seed=1",
            "integrator=auto photons=8000 samples=16 seed=1",
        ] {
            let seen = rounds(&lit(scene, way), 20);
            for channel in 0..3 {
                let name = format!("{way}, channel {channel}, {scene}");
                assert_same_mean(&name, &reference[channel], &seen[channel], 18, 0.005);
                let ratio = Sample::of(&seen[channel]).mean / Sample::of(&reference[channel]).mean;
                assert!((ratio - 1.0).abs() < 0.05, "{name}: {ratio}");
            }
        }
    }
}

/// Mean squared error of pictures of so many passes from the mean of all, summed over pixels, of what `of` makes of a pixel.
fn error(images: &[Image], passes: usize, of: impl Fn([f32; 3]) -> f32) -> f64 {
    let count = images[0].pixels().len();
    let mean = |images: &[Image], pixel: usize| {
        images.iter().map(|image| f64::from(of(image.pixels()[pixel]))).sum::<f64>() / images.len() as f64
    };
    let all: Vec<f64> = (0..count).map(|pixel| mean(images, pixel)).collect();
    let groups = images.chunks(passes);
    let squares =
        groups.clone().map(|group| (0..count).map(|pixel| (mean(group, pixel) - all[pixel]).powi(2)).sum::<f64>());
    squares.sum::<f64>() / (groups.len() - 1) as f64
}

/// The noise of colours, red less green, fades with the passes at least as fast as that of brightness: 16 times as many
/// passes leave a sixteenth of it.
#[test]
fn coloured_noise_fades_as_grey_noise_does() {
    let images = lit(CAUSTIC, "integrator=photon-map photons=4000 bandwidth=fixed radius=0.1 samples=2").passes(1024);
    let grey = |[r, g, b]: [f32; 3]| r + g + b;
    let color = |[r, g, _]: [f32; 3]| r - g;
    for (name, of) in [("grey", &grey as &dyn Fn([f32; 3]) -> f32), ("coloured", &color)] {
        let (few, many) = (error(&images, 2, of), error(&images, 32, of));
        assert!(few / many > 11.0, "{name}: {few} for 2 passes, {many} for 32");
    }
}

/// That passes tint white is known, and neither changes the brightness of the picture nor counts as its error; nor does it
/// change what layers of geometry say.
#[test]
fn a_white_sky_has_its_brightness_and_no_error_after_any_number_of_passes() {
    let sky = "film = { size = [4, 4] }
        camera = { origin = [0, 0, 3], target = [0, 0, 0], fov = 30 }
        render = { spectral = true }
        lights = [{ type = 'constant' }]
        [[shapes]]
        type = 'quad'
        corner = [-9, -9, -1]
        u = [18, 0, 0]
        v = [0, 18, 0]
        emission = { radiance = 1 }\n";
    let lit = lit(sky, "integrator=path");
    let mut render = Render::with_layers(&lit.scene, &lit.description, Layers::ALL, &Silent);
    for passes in 1..6 {
        render.step(&Silent);
        let (image, normal) = (render.film().image(), render.film().layer(Layer::Normal).expect("normals"));
        let seen = luminance(image.pixel(1, 1));
        assert!((seen - 1.0).abs() < 1e-5, "{seen} after {passes}");
        assert!((normal.pixel(1, 1)[2] - 1.0).abs() < 1e-5, "{:?}", normal.pixel(1, 1));
        assert!(render.film().relative_error().is_none_or(|error| error < 1e-4));
    }
}

#[test]
fn a_spectral_picture_has_the_same_bits_on_any_number_of_threads() {
    for way in WAYS {
        let lit = lit(CAUSTIC, way);
        assert!(lit.scene.is_spectral());
        let on = |threads: usize| on_threads(threads, || lit.image(4).pixels().to_vec());
        assert!(on(1) == on(5), "{way}");
        let passes = lit.passes(4);
        assert!(passes[3].pixels() == lit.passes(4)[3].pixels() && passes[0].pixels() != passes[1].pixels(), "{way}");
    }
}

#[test]
fn what_is_no_index_of_refraction_is_told() {
    let fault = |ior: &str| {
        let text = format!("{UNSEEN}[[shapes]]\ntype = 'sphere'\nmaterial = {{ type = 'glass', ior = {ior} }}\n");
        build(&described(&text), &NoAssets).expect_err("no index").to_string()
    };
    assert_eq!(fault("'diamand'"), "no substance named 'diamand' is known; did you mean 'diamond'?");
    assert!(fault("'butter'").contains("known are bk7,"), "{}", fault("'butter'"));
    assert!(fault("{ cauchy = [1.5, 4000] }").contains("at 380 nm, which is no index"), "λ in nm");
    assert!(fault("{ sellmeier = [1, 0, 0, 0.3, 0, 0] }").contains("no index"), "a resonance at 548 nm");
    assert!(fault("{ abbe = [1.5, 0] }").contains("ior must be greater than 0"));
    assert!(fault("{ abbe = [1.5, 0.1] }").contains("no index"));
}

#[test]
fn only_what_disperses_has_wavelengths_unless_the_file_says_otherwise() {
    let spectral = |material: &str, render: &str| {
        let text =
            format!("{UNSEEN}render = {{ {render} }}\n[[shapes]]\ntype = 'sphere'\nmaterial = {{ {material} }}\n");
        lit(&text, "").scene.is_spectral()
    };
    assert!(!spectral("type = 'glass', ior = 1.7", "") && !spectral("type = 'glass', ior = { cauchy = [1.5, 0] }", ""));
    assert!(spectral("type = 'glass', ior = 'diamond'", "") && spectral("type = 'glass', exterior-ior = 'water'", ""));
    assert!(spectral("type = 'glass', ior = { abbe = [1.5, 30] }, roughness = { alpha = 0.1 }", ""));
    assert!(spectral("type = 'diffuse'", "spectral = true"));
    assert!(!spectral("type = 'glass', ior = 'diamond'", "spectral = false"));
}
