//! Time: light arrives when it must, and its bins add up to the picture.

mod common;

use common::statistics::{Sample, assert_distribution, assert_mean, assert_same_mean};
use common::{Lit, lit, slab, square};
use lampyris::film::{Film, Layers};
use lampyris::image::luminance;
use lampyris::integrator::{Pass, Silent, integrator};
use lampyris::render::Render;
use lampyris::spectrum::Dispersion;

/// Settings of a film with these bins.
fn bins(bins: u32, start: f64, width: f64) -> String {
    format!(" time.bins={bins} time.start={start:?} time.bin-width={width:?}")
}

fn film(lit: &Lit, passes: u32, layers: Layers) -> Film {
    let mut render = Render::with_layers(&lit.scene, &lit.description, layers, &Silent);
    (0..passes).for_each(|_| render.step(&Silent));
    render.film().clone()
}

/// The mean over the picture of the luminance in each slot, before the first bin and after the last too, of each pass.
fn slots(lit: &Lit, passes: u32) -> Vec<Vec<f64>> {
    let Lit { description, scene } = lit;
    let (film, seed) = (&description.film, description.render.seed);
    let integrator = integrator(scene, film, &description.integrator, seed, &Silent);
    let slots = film.time.as_ref().expect("a film with time").bins as usize + 2;
    let pixels = f64::from(film.size[0] * film.size[1]);
    let mut each = vec![Vec::new(); slots];
    for index in 0..passes {
        let pass = Pass { index, seed };
        let exposure = integrator.expose(&scene.of_pass(seed, index), film, &pass, Layers::NONE, &Silent);
        let mut sums = vec![0.0; slots];
        for arrival in exposure.arrivals {
            sums[arrival.slot as usize] += f64::from(luminance(arrival.light)) / pixels;
        }
        each.iter_mut().zip(sums).for_each(|(values, sum)| values.push(sum));
    }
    each
}

/// A box with a point light, a ball lamp, mirror, glass, plastic; nothing is nearer to the eye than the lamp in sight.
const BOX: &str = "
    camera = { origin = [0, 0, -3.5], target = [0, 0, 0], fov = 38 }
    film = { size = [12, 10] }
    lights = [{ type = 'point', position = [0, 0.5, 0], power = 12 }]
    [[shapes]]
    type = 'plane'
    normal = [1, 0, 0]
    distance = 1
    material = { type = 'diffuse', reflectance = [0.8, 0.3, 0.3] }
    [[shapes]]
    type = 'plane'
    normal = [-1, 0, 0]
    distance = 1
    material = { type = 'diffuse', reflectance = [0.3, 0.8, 0.3] }
    [[shapes]]
    type = 'plane'
    normal = [0, 1, 0]
    distance = 1
    material = { type = 'diffuse', reflectance = 0.6 }
    [[shapes]]
    type = 'plane'
    normal = [0, 0, -1]
    distance = 1
    material = { type = 'plastic' }
    [[shapes]]
    type = 'sphere'
    center = [-0.5, -0.6, 0.25]
    radius = 0.4
    material = { type = 'mirror' }
    [[shapes]]
    type = 'sphere'
    center = [0.5, -0.6, 0.1]
    radius = 0.4
    material = { type = 'glass' }
    [[shapes]]
    type = 'sphere'
    center = [0.1, -0.2, 0.5]
    radius = 0.2
    material = { type = 'glass', roughness = { alpha = 0.3 } }
    [[shapes]]
    type = 'sphere'
    center = [0.3, 0.6, -0.25]
    radius = 0.1
    emission = { power = 4 }
    material = { type = 'diffuse' }
";

/// From the eye to the lamp in sight.
fn shortest() -> f64 {
    (0.3_f64.powi(2) + 0.6_f64.powi(2) + 3.25_f64.powi(2)).sqrt() - 0.1
}

const WAYS: [&str; 6] = [
    "integrator=path",
    "integrator=auto photons=2000",
    "integrator=photon-map photons=2000 k=20",
    "integrator=photon-map photons=2000 bandwidth=nearest k=20 direct=photons filter=tent",
    "integrator=light photons=2000 filter=gaussian",
    "integrator=path spectral=true filter=tent filter.radius=1.4",
];

#[test]
fn bins_and_what_is_outside_add_up_to_the_picture() {
    for way in WAYS {
        // Some light before, some after.
        let film = film(&lit(BOX, &(way.to_string() + &bins(30, 4.5, 0.05))), 3, Layers::NONE);
        let [before, after] = film.share_outside_bins().expect("light");
        assert!(before > 0.01 && after > 0.01 && before + after < 0.9, "{way}: {before} {after}");
        let image = film.image();
        for (pixel, expected) in image.pixels().iter().enumerate() {
            let outside = film.outside_bins(pixel).expect("time");
            for channel in 0..3 {
                let all = film.bins(pixel).into_iter().chain(outside).map(|light| f64::from(light[channel]));
                let (sum, expected) = (all.sum::<f64>(), f64::from(expected[channel]));
                assert!((sum - expected).abs() < 1e-5 * expected + 1e-9, "{way}: {sum} is not {expected}");
            }
        }
    }
}

#[test]
fn time_changes_neither_the_picture_nor_its_layers() {
    for way in WAYS {
        let plain = film(&lit(BOX, way), 2, Layers::NONE);
        assert_eq!(plain.clock(), None);
        let timed = film(&lit(BOX, &(way.to_string() + &bins(30, 4.5, 0.05))), 2, Layers::NONE);
        assert!(plain.image() == timed.image(), "{way}");
        let (layered, both) = (
            film(&lit(BOX, way), 2, Layers::ALL),
            film(&lit(BOX, &(way.to_string() + &bins(9, 3.0, 0.5))), 2, Layers::ALL),
        );
        for layer in Layers::ALL.iter() {
            let [a, b] = [&layered, &both].map(|film| film.layer(layer).map(|image| image.pixels().to_vec()));
            assert!(a == b, "{way}, {}", layer.name());
        }
    }
}

#[test]
fn nothing_comes_before_the_shortest_path() {
    for way in WAYS {
        let start = shortest() * (1.0 - 1e-5);
        let film = film(&lit(BOX, &(way.to_string() + &bins(100, start, 0.01))), 4, Layers::NONE);
        let mut first = 0.0;
        for pixel in 0..film.size()[0] * film.size()[1] {
            assert_eq!(film.outside_bins(pixel).expect("time")[0], [0.0; 3], "{way}");
            // The front half of the lamp.
            first += film.bins(pixel)[..10].iter().map(|light| light[1]).sum::<f32>();
        }
        assert!(first > 0.0, "{way}: the lamp itself is seen at once");
    }
}

#[test]
fn any_threads_and_any_order_of_passes_give_the_same_film() {
    for way in WAYS {
        let lit = lit(BOX, &(way.to_string() + " time.bins=20 time.variance=true"));
        let on = |threads: usize, order: [u32; 3]| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                let mut render = Render::new(&lit.scene, &lit.description, &Silent);
                order.iter().for_each(|&pass| assert!(render.step_in(&(pass..pass + 1), &Silent)));
                render.film().clone()
            })
        };
        assert!(on(1, [0, 1, 2]) == on(3, [2, 0, 1]), "{way}");
    }
}

/// A power of two changes exponents alone.
#[test]
fn time_scales_with_the_scene_to_the_bit() {
    let text = |scale: f64| {
        format!(
            "camera = {{ origin = [0, 0, {eye:?}], target = [0, 0, 0], fov = 38 }}
             film = {{ size = [6, 6] }}
             [[shapes]]
             type = 'sphere'
             radius = {scale:?}
             flip-normal = true
             emission = {{ radiance = 1 }}
             [[shapes]]
             type = 'sphere'
             center = [{off:?}, 0, 0]
             radius = {off:?}
             material = {{ type = 'glass' }}",
            eye = -0.75 * scale,
            off = 0.25 * scale,
        )
    };
    for way in [
        "integrator=path",
        "integrator=auto photons=2000",
        "integrator=photon-map photons=2000",
        "integrator=light photons=2000",
    ] {
        // With a range that the pilot finds.
        let seen = |scale: f64| film(&lit(&text(scale), &format!("{way} time.bins=40")), 2, Layers::NONE);
        let (one, large) = (seen(1.0), seen(1024.0));
        let clocks = [&one, &large].map(|film| film.clock().expect("time").clone());
        assert_eq!(
            (1024.0 * clocks[0].start(), 1024.0 * clocks[0].bin_width()),
            (clocks[1].start(), clocks[1].bin_width())
        );
        assert!((0..36).all(|pixel| one.bins(pixel) == large.bins(pixel)), "{way}");
    }
}

#[test]
fn pairs_of_half_bins_are_bins() {
    for way in WAYS {
        let [whole, halves] = [(20, 0.2), (40, 0.1)]
            .map(|(count, width)| film(&lit(BOX, &(way.to_string() + &bins(count, 3.3, width))), 2, Layers::NONE));
        for pixel in 0..120 {
            let halves = halves.bins(pixel);
            for (whole, pair) in whole.bins(pixel).iter().zip(halves.chunks(2)) {
                let (sum, whole) = (pair[0][0] + pair[1][0], whole[0]);
                assert!((sum - whole).abs() <= 1e-5 * whole, "{way}: {sum} {whole}");
            }
        }
    }
}

/// Parallel rays meet a wall at one distance.
#[test]
fn unwarping_takes_the_way_to_the_camera_away_and_nothing_else() {
    let text = "
        camera = { origin = [0, 0, -4], target = [0, 0, 0], projection = 'orthographic', width = 1 }
        film = { size = [4, 4] }
        lights = [{ type = 'point', position = [0.5, 0.7, -1], power = 12 }]
        [[shapes]]
        type = 'quad'
        corner = [-1, -1, 0]
        u = [0, 2, 0]
        v = [2, 0, 0]
        material = { type = 'diffuse', reflectance = 0.5 }
        [[shapes]]
        type = 'quad'
        corner = [2, -2, -4]
        u = [0, 0, 8]
        v = [0, 4, 0]
        material = { type = 'diffuse', reflectance = 0.5 }";
    for way in [
        "integrator=path",
        "integrator=auto photons=2000",
        "integrator=photon-map photons=2000",
        "integrator=light photons=2000",
    ] {
        let seen = |start: f64, unwarp: &str| {
            film(&lit(text, &format!("{way} time.unwarp={unwarp}{}", bins(64, start, 0.0625))), 2, Layers::NONE)
        };
        let warped = seen(4.5, "none");
        for unwarp in ["first-surface", "last-segment"] {
            let unwarped = seen(0.5, unwarp);
            let (mut moved, mut all) = (0.0, 0.0);
            for pixel in 0..16 {
                for (a, b) in warped.bins(pixel).iter().zip(unwarped.bins(pixel)) {
                    moved += f64::from((a[0] - b[0]).abs());
                    all += f64::from(a[0]);
                }
            }
            // Rounding can move what lies on an edge.
            assert!(all > 0.0 && moved < 1e-3 * all, "{way}, {unwarp}: {moved} of {all}");
        }
    }
}

/// A point light I above a floor of reflectance ρ: L = (ρ/π) I cos/d², at the time d + r alone.
#[test]
fn a_point_on_a_floor_is_lit_when_light_has_come_to_it_and_on_to_the_eye() {
    let text = "
        camera = { origin = [0, 2, 0], target = [1, 0, 0], up = [0, 0, 1], fov = 0.02 }
        film = { size = [1, 1] }
        lights = [{ type = 'point', position = [2.5, 1.25, 0], intensity = 3 }]
        [[shapes]]
        type = 'plane'
        normal = [0, 1, 0]
        distance = 0
        material = { type = 'diffuse', reflectance = 0.7 }";
    let (to_eye, to_lamp) = (5.0_f64.sqrt(), (1.5_f64.powi(2) + 1.25_f64.powi(2)).sqrt());
    let expected = 0.7 / std::f64::consts::PI * 3.0 * (1.25 / to_lamp) / to_lamp.powi(2);
    for (unwarp, at) in [("none", to_eye + to_lamp), ("first-surface", to_lamp)] {
        for way in ["path", "auto photons=100", "photon-map photons=100"] {
            let range = bins(3, at - 0.0015, 0.001);
            let film = film(&lit(text, &format!("integrator={way} time.unwarp={unwarp}{range}")), 1, Layers::NONE);
            let seen: Vec<f64> = film.bins(0).iter().map(|light| f64::from(light[1])).collect();
            assert!((seen[1] / expected - 1.0).abs() < 1e-3, "{way}, {unwarp}: {seen:?}");
            assert_eq!((seen[0], seen[2]), (0.0, 0.0), "{way}, {unwarp}");
            assert_eq!(film.outside_bins(0), Some([[0.0; 3]; 2]), "{way}, {unwarp}");
        }
    }
}

/// Seen from a plane in front of the eye, the same floor is lit by so much earlier, and nothing before the plane is seen.
#[test]
fn from_a_near_plane_on_the_way_to_the_eye_counts() {
    let scene = |near: f64, extra: &str| {
        format!(
            "camera = {{ origin = [0, 3, 0], target = [0, 0, 0], up = [0, 0, 1], fov = 4, near-distance = {near} }}
            film = {{ size = [1, 1], filter = {{ type = 'box' }} }}
            lights = [{{ type = 'point', position = [0, 1, 1], intensity = 1 }}]
            [[shapes]]
            type = 'quad'
            corner = [-3, 0, -3]
            u = [0, 0, 6]
            v = [6, 0, 0]
            {extra}"
        )
    };
    let pane = "[[shapes]]\ntype = 'quad'\ncorner = [-1, 2, -1]\nu = [0, 0, 2]\nv = [2, 0, 0]\n";
    // 3 to the eye and the root of 2 to the lamp, within the pixel's 0.1 and a bin.
    for (near, extra, time) in
        [(0.0, "", 3.0 + 2.0_f64.sqrt()), (1.25, "", 1.75 + 2.0_f64.sqrt()), (1.25, pane, 1.75 + 2.0_f64.sqrt())]
    {
        for way in [
            "integrator=path max-bounces=1",
            "integrator=light photons=20000 max-bounces=1",
            "integrator=auto max-bounces=1",
        ] {
            let lit = lit(&scene(near, extra), &(way.to_string() + &bins(80, 0.0, 0.1)));
            let found = lit_bins(&film(&lit, 8, Layers::NONE));
            assert!(
                found.iter().all(|&from| (from + 0.05 - time).abs() < 0.15),
                "{way}, {near}: {found:?} without {time}"
            );
            assert!(!found.is_empty(), "{way}, {near}");
        }
    }
}

/// The time at which each of these slots begins that have light, at the only pixel.
fn lit_bins(film: &Film) -> Vec<f64> {
    let clock = film.clock().expect("time");
    let bins = film.bins(0).into_iter().zip(0..);
    bins.filter(|(light, _)| light[1] > 0.0)
        .map(|(_, bin)| clock.start() + clock.bin_width() * f64::from(bin))
        .collect()
}

#[test]
fn a_slab_delays_light_by_its_thickness_times_index_less_one() {
    let text = "
        camera = { origin = [0, 2, 0], target = [0, 0, 0], up = [0, 0, 1], fov = 0.002 }
        film = { size = [1, 1] }
        lights = [{ type = 'point', position = [1, 0.5, 0], intensity = 3 }]\n"
        .to_string()
        + &slab(1.0, 0.75, 0.3, "{ type = 'glass', ior = 1.6 }")
        + &square(0.0, 2.0, false, "{ type = 'diffuse', reflectance = 0.5 }");
    let at = 2.0 + 0.6 * 0.25 + (1.0_f64 + 0.25).sqrt();
    for way in ["path", "auto photons=100", "photon-map photons=100"] {
        // As short as one bin, which is all that light takes straight through; what the slab reflects within comes later.
        let film = film(&lit(&text, &format!("integrator={way}{}", bins(1, at - 1e-4, 2e-4))), 4, Layers::NONE);
        assert!(film.bins(0)[0][1] > 0.05, "{way}");
        assert_eq!(film.outside_bins(0).expect("time")[0], [0.0; 3], "{way}");
    }
}

/// A pulse is as slow as its group index says, which is 1.54136 for N-BK7 at the line d; the index that bends light is 1.51680.
#[test]
fn a_pulse_is_slower_in_glass_than_the_index_that_bends_it_says_if_group_indices_are_asked_for() {
    let glass = Dispersion::of_substance("bk7").expect("bk7");
    let text = "
        camera = { origin = [0, 2, 0], target = [0, 0, 0], up = [0, 0, 1], fov = 0.002 }
        film = { size = [1, 1] }
        lights = [{ type = 'point', position = [1, 0.5, 0], intensity = 3 }]\n"
        .to_string()
        + &slab(1.0, 0.75, 0.3, "{ type = 'glass', ior = 'bk7' }")
        + &square(0.0, 2.0, false, "{ type = 'diffuse', reflectance = 0.5 }");
    let at = |index: f64| 2.0 + 0.25 * (index - 1.0) + (1.0_f64 + 0.25).sqrt();
    for way in ["path", "auto photons=100", "photon-map photons=100"] {
        for (index, value) in [("phase", 1.51680), ("group", 1.54136)] {
            let range = bins(1, at(value) - 1e-4, 2e-4);
            let settings = format!("integrator={way} time.index={index} spectral=false{range}");
            let film = film(&lit(&text, &settings), 4, Layers::NONE);
            assert!(film.bins(0)[0][1] > 0.05, "{way}, {index}");
            assert_eq!(film.outside_bins(0).expect("time")[0], [0.0; 3], "{way}, {index}");
        }
        // Of all colours, red is the first.
        let settings = format!("integrator={way} time.index=group{}", bins(1, at(glass.group_at(830.0)) - 1e-4, 0.03));
        let film = film(&lit(&text, &settings), 8, Layers::NONE);
        assert!(film.bins(0)[0][1] > 0.05, "{way}");
        assert_eq!(film.outside_bins(0).expect("time")[0], [0.0; 3], "{way}");
    }
}

/// The first photon on a floor below glass has come straight down through it.
#[test]
fn photons_are_slow_by_the_same_index() {
    let text = "
        camera = { origin = [0, 2, 0], target = [0, 0, 0], up = [0, 0, 1] }
        film = { size = [1, 1] }
        lights = [{ type = 'point', position = [0, 1.5, 0], power = 1 }]\n"
        .to_string()
        + &slab(1.0, 0.5, 3.0, "{ type = 'glass', ior = 'bk7' }")
        + &square(0.0, 3.0, false, "{ type = 'diffuse', reflectance = 0 }");
    for (index, value) in [("phase", 1.51680), ("group", 1.54136)] {
        let settings = format!("integrator=photon-map photons=100000 direct=photons spectral=false time.index={index}");
        let lit = lit(&text, &settings);
        let map = lit.map(0);
        let first = map.photons().iter().map(|photon| f64::from(photon.optical_length)).fold(f64::INFINITY, f64::min);
        let expected = 1.5 + 0.5 * (value - 1.0);
        // Less what rays begin off a surface.
        assert!((-3e-5..1e-3).contains(&(first - expected)), "{index}: {first} is not {expected}");
    }
}

/// The eye looks into a mirror at a floor, which the lamp lights directly, and by the mirror, which only photons find. The
/// latter are read within some distance, and have the right time all the same.
#[test]
fn a_mirror_delays_light_by_the_way_to_it() {
    let text = "
        camera = { origin = [0, 1, 0], target = [2, 0.5, 0], fov = 0.02 }
        film = { size = [1, 1] }
        lights = [{ type = 'point', position = [0.5, 1.2, 1], intensity = 3 }]
        [[shapes]]
        type = 'quad'
        corner = [2, -2, -2]
        u = [0, 0, 4]
        v = [0, 4, 0]
        material = { type = 'mirror' }
        [[shapes]]
        type = 'quad'
        corner = [-1, 0, -2]
        u = [0, 0, 4]
        v = [3, 0, 0]
        material = { type = 'diffuse', reflectance = 0.5 }";
    let to_eye = 17.0_f64.sqrt();
    let direct = to_eye + (0.25_f64 + 1.44 + 1.0).sqrt();
    let by_mirror = to_eye + (3.5_f64.powi(2) + 1.44 + 1.0).sqrt();
    let width = 0.01;
    let near = |found: &[f64], at: f64| found.iter().filter(|&&bin| (bin - at).abs() < 2.0 * width).count();
    for (way, finds_caustics) in [
        ("path samples=16", false),
        ("auto photons=20000 radius=100", true),
        ("photon-map photons=20000 bandwidth=fixed radius=0.3", true),
        ("photon-map photons=20000 bandwidth=fixed radius=0.3 direct=photons", true),
    ] {
        let range = bins(1000, 0.5 * width, width);
        let film = film(&lit(text, &format!("integrator={way}{range}")), 4, Layers::NONE);
        let found = lit_bins(&film);
        let expected = near(&found, direct) + near(&found, by_mirror);
        assert!(near(&found, direct) > 0, "{way}: {found:?}");
        assert_eq!(near(&found, by_mirror) > 0, finds_caustics, "{way}: {found:?}");
        // Within a radius of 0.3, the way to the lamp differs by 0.25, and none is seen.
        assert_eq!(found.len(), expected, "{way}: {found:?} for {direct} and {by_mirror}");
    }
}

/// Of a point light at height h above an endless floor, which gets half of its light, the share h/s² arrives at time s, per
/// unit of time; and nothing before h.
#[test]
fn photons_arrive_on_a_floor_by_the_square_of_their_time() {
    let text = "
        camera = { origin = [0, 2, 0], target = [0, 0, 0], up = [0, 0, 1] }
        film = { size = [1, 1] }
        lights = [{ type = 'point', position = [0, 1.5, 0], power = 1 }]
        [[shapes]]
        type = 'plane'
        normal = [0, 1, 0]
        distance = 0
        material = { type = 'diffuse', reflectance = 0 }";
    let lit = lit(text, "integrator=photon-map photons=200000 direct=photons bandwidth=fixed radius=1");
    let edges: Vec<f64> = (0..40).map(|bin| 1.5 + 0.25 * f64::from(bin)).collect();
    let mut counts = vec![0.0; edges.len() - 1];
    for photon in lit.map(0).photons() {
        let at = f64::from(photon.optical_length);
        assert!(at > 1.5 * (1.0 - 1e-6), "{at}");
        if let Some(bin) = (1..edges.len()).find(|&bin| at < edges[bin]) {
            counts[bin - 1] += 1.0;
        }
    }
    let expected: Vec<f64> = edges.windows(2).map(|edge| 1e5 * 1.5 * (1.0 / edge[0] - 1.0 / edge[1])).collect();
    assert_distribution("arrivals", &counts, &expected, 2e5);
}

/// What arrives in a sphere of radius 1 in each unit of time after its whole wall has flashed, over what flashed, where the
/// wall reflects this share: chords of length l have the density l/2, so that E = f + ρ f∗E.
fn echoes(reflectance: f64, units: usize) -> Vec<f64> {
    const STEPS: usize = 500;
    let step = 1.0 / STEPS as f64;
    let chords: Vec<f64> = (0..2 * STEPS).map(|i| (2 * i + 1) as f64 * step * step / 4.0).collect();
    let mut echoes: Vec<f64> = Vec::new();
    for k in 0..units * STEPS {
        // What two cells make together falls half into the cell of their sum, and half into the next.
        let made = |sum: usize| -> f64 {
            (1..chords.len().min(sum + 1)).map(|i| chords[i] * echoes[sum - i]).sum::<f64>() / 2.0
        };
        let last = if k > 0 { made(k - 1) + chords[0] * echoes[k - 1] / 2.0 } else { 0.0 };
        let first = chords.get(k).copied().unwrap_or(0.0);
        let all = first + reflectance * (made(k) + last);
        echoes.push(all / (1.0 - reflectance * chords[0] / 2.0));
    }
    echoes.chunks(STEPS).map(|unit| unit.iter().sum()).collect()
}

#[test]
fn echoes_are_those_of_the_notes() {
    let known = [0.2584, 0.8823, 0.4665, 0.5473, 0.4237, 0.3680, 0.3151, 0.2635, 0.2254, 0.1903];
    for (echo, known) in echoes(0.8, 10).into_iter().zip(known) {
        assert!((echo - known).abs() < 4e-4, "{echo} {known}");
    }
    let (all, late): (f64, Vec<f64>) = (echoes(0.8, 60).iter().sum(), echoes(0.8, 30));
    assert!((all - 5.0).abs() < 2e-3, "{all}");
    assert!((late[29] / late[28] - (-0.165_120_f64).exp()).abs() < 1e-4);
}

/// Light that goes to and fro within a sphere fades as theory says, bin by bin, however often it was reflected.
#[test]
fn light_in_a_sphere_fades_as_its_chords_say() {
    let text = "
        camera = { origin = [0, 0, 0], target = [0, 0, 1], fov = 90 }
        film = { size = [16, 16] }
        [[shapes]]
        type = 'sphere'
        flip-normal = true
        emission = { radiance = 1 }
        material = { type = 'diffuse', reflectance = 0.8 }";
    let range = bins(10, 0.0, 1.0) + " time.unwarp=first-surface max-bounces=80";
    // The wall itself is seen when it flashes; then what it reflects.
    let mut expected: Vec<f64> = echoes(0.8, 10).into_iter().map(|echo| 0.8 * echo).collect();
    expected[0] += 1.0;
    expected.push(5.0 - expected.iter().sum::<f64>());
    for (way, bias, power) in [
        ("path samples=64", 0.0, 0.02),
        ("photon-map photons=50000 bandwidth=fixed radius=0.1 samples=2 direct=photons", 1e-3, 0.03),
        ("photon-map photons=50000 bandwidth=fixed radius=0.1 samples=16", 1e-3, 0.03),
        ("auto photons=16384 samples=16", 1e-3, 0.05),
        ("light photons=50000", 0.0, 0.05),
    ] {
        let found = slots(&lit(text, &format!("integrator={way}{range}")), 50);
        assert!(found[0].iter().all(|&light| light == 0.0), "{way}: nothing before");
        for (bin, (values, expected)) in found[1..].iter().zip(&expected).enumerate() {
            assert_mean(&format!("{way}, bin {bin}"), values, *expected, bias * expected, power);
        }
    }
}

/// Of all that can see a diffuse box, bin by bin; odds of a false alarm as everywhere, over all bins together.
#[test]
fn all_ways_agree_on_when_light_arrives() {
    let text = "
        film = { size = [16, 16] }
        camera = { origin = [0.1, 0.6, -0.9], target = [0, -1, 0.1], fov = 40 }
        lights = [{ type = 'point', position = [-0.4, 0.7, 0.3], intensity = 1.5 }]
        [[shapes]]
        type = 'cube'
        flip-normal = true
        material = { type = 'diffuse', reflectance = 0.6 }
        [[shapes]]
        type = 'sphere'
        center = [0.15, -0.5, 0.1]
        radius = 0.2
        material = { type = 'diffuse', reflectance = 0.4 }
        [[shapes]]
        type = 'quad'
        corner = [0.2, 0.9, -0.2]
        u = [0.4, 0, 0]
        v = [0, 0, 0.4]
        emission = { radiance = 2, two-sided = true }";
    let (range, passes) = (bins(24, 2.5, 0.25), 30);
    let reference = slots(&lit(text, &format!("integrator=path samples=32{range}")), passes);
    assert!(reference.iter().all(|values| Sample::of(values).mean > 0.0), "every bin has light");
    for (way, bias) in [
        ("light photons=16384", 0.0),
        ("photon-map photons=16384 bandwidth=fixed radius=0.04 samples=8", 0.01),
        ("photon-map photons=16384 bandwidth=nearest k=20 radius=0.04 direct=photons samples=2", 0.01),
        ("auto photons=16384 samples=8 radius=0.6", 0.005),
    ] {
        let found = slots(&lit(text, &format!("integrator={way}{range} seed=1")), passes);
        for (slot, (a, b)) in reference.iter().zip(&found).enumerate() {
            assert_same_mean(&format!("{way}, slot {slot}"), a, b, reference.len(), bias);
        }
    }
}

/// A ray that passes a lamp of 1 W at a distance of h = 0.5 after z0 = 1.
const FOG: &str = "
        camera = { origin = [0, 0, 0], target = [0, 0, 1], fov = 0.01 }
        film = { size = [1, 1] }
        lights = [{ type = 'point', position = [0.5, 0, 1], power = 1 }]
        medium = 'fog'
        media = { fog = { type = 'homogeneous', sigma-t = 1, albedo = 0.8 } }\n";

/// Ways to see light in fog, and how much their kernels blur.
const IN_FOG: [(&str, f64); 4] = [
    ("path samples=400", 0.0),
    ("photon-map volume=beams volume-radius=0.02 bandwidth=fixed radius=1 photons=8000", 0.01),
    ("photon-map volume=points volume-radius=0.06 bandwidth=fixed radius=1 photons=40000", 0.03),
    ("photon-map volume=balls volume-radius=0.1 bandwidth=fixed radius=1 photons=20000 samples=64", 0.05),
];

/// Light that fog scatters once has a closed form in time: L(s) = 2 σs p I e^(−σt s) / ((s − z0)² + h²), here integrated over
/// bins by quadrature, for σs = 0.8, σt = 1, h = 0.5, z0 = 1 and a lamp of 1 W.
#[test]
fn light_in_fog_arrives_as_the_closed_form_says() {
    const EXPECTED: [f64; 5] = [1.441_44e-3, 1.669_03e-3, 7.977_06e-4, 3.909_34e-4, 2.033_06e-4];
    for (way, bias) in IN_FOG {
        let settings = format!("integrator={way} max-bounces=1");
        let found = slots(&lit(FOG, &(settings.clone() + &bins(5, 1.0, 0.25))), 40);
        assert!(found[0].iter().all(|&light| light == 0.0), "{way}");
        for (bin, expected) in EXPECTED.into_iter().enumerate() {
            assert_mean(
                &format!("{way}, bin {bin}"),
                &found[bin + 1],
                expected,
                bias * expected,
                if bias > 0.0 { 2.0 } else { 0.5 },
            );
        }
    }
}

/// Particles that hold light back, by 0.4 on average, bring it as the closed form convolved with the density of the delay.
#[test]
fn delayed_light_in_fog_arrives_as_the_convolution_says() {
    const STEP: f64 = 1e-4;
    let (delay, bins_of, start, width) = (0.4, 8, 1.0, 0.25);
    let kept_by = |time: f64| if time > 0.0 { 1.0 - (-time / delay).exp() } else { 0.0 };
    let mut expected = vec![0.0; bins_of];
    // What is scattered at t comes by a way of t + d, in fog without an end.
    for t in (0..250_000).map(|step| STEP * (f64::from(step) + 0.5)) {
        let distance = 0.5_f64.hypot(t - 1.0);
        let light = 0.8 / (4.0 * std::f64::consts::PI).powi(2) * (-t - distance).exp() / distance.powi(2) * STEP;
        for (bin, sum) in expected.iter_mut().enumerate() {
            let [from, to] = [bin, bin + 1].map(|edge| kept_by(start + width * edge as f64 - t - distance));
            *sum += light * (to - from);
        }
    }
    for (way, bias) in IN_FOG {
        let text = FOG.replace("albedo = 0.8", "albedo = 0.8, delay = 0.4");
        let seen = |text: &str| {
            let range = bins(bins_of as u32, start, width);
            lit(text, &format!("integrator={way} max-bounces=1{range}"))
        };
        let found = slots(&seen(&text), 40);
        assert!(found[0].iter().all(|&light| light == 0.0), "{way}");
        for (bin, &expected) in expected.iter().enumerate() {
            let power = if bias > 0.0 { 2.0 } else { 0.5 };
            assert_mean(&format!("{way}, bin {bin}"), &found[bin + 1], expected, bias * expected, power);
        }
        assert!(seen(&text).image(2) == seen(FOG).image(2), "{way}: the picture is the same");
    }
}

/// In fog that scatters often; odds of a false alarm as everywhere, over all bins together.
#[test]
fn all_ways_agree_on_delays() {
    let text = "
        camera = { origin = [0, 0.3, -3], target = [0, 0, 0], fov = 40 }
        film = { size = [8, 8] }
        lights = [{ type = 'point', position = [0.4, 1.5, 0.2], power = 10 }]
        medium = 'fog'
        media = { fog = { type = 'homogeneous', sigma-t = 0.5, albedo = 0.9, delay-seconds = 4e-9 } }
        [[shapes]]
        type = 'plane'
        normal = [0, 1, 0]
        distance = 0
        material = { type = 'diffuse', reflectance = 0.5 }";
    let (range, passes) = (bins(8, 3.0, 1.0) + " max-bounces=6", 40);
    let reference = slots(&lit(text, &format!("integrator=path samples=128{range}")), passes);
    assert!(reference[1..].iter().all(|values| Sample::of(values).mean > 0.0), "every bin has light");
    for (way, bias) in [
        ("light photons=40000", 0.0),
        ("photon-map photons=20000 bandwidth=fixed radius=0.05 samples=4 volume=beams volume-radius=0.05", 0.02),
        ("photon-map photons=20000 bandwidth=fixed radius=0.05 samples=4 volume=points volume-radius=0.1", 0.03),
        ("auto photons=16384 samples=4", 0.03),
    ] {
        let found = slots(&lit(text, &format!("integrator={way}{range} seed=1")), passes);
        for (slot, (a, b)) in reference.iter().zip(&found).enumerate() {
            assert_same_mean(&format!("{way}, slot {slot}"), a, b, 4 * reference.len(), bias);
        }
    }
}

/// The same without the way from where it was scattered to the camera: by the distance of that place to the lamp, which is at
/// least h.
#[test]
fn light_in_fog_is_seen_where_it_is_without_the_way_to_the_camera() {
    const STEP: f64 = 1e-4;
    let mut expected = [0.0; 3];
    for t in (0..300_000).map(|step| STEP * (f64::from(step) + 0.5)) {
        let distance = 0.5_f64.hypot(t - 1.0);
        let light = 0.8 / (4.0 * std::f64::consts::PI).powi(2) * (-t - distance).exp() / distance.powi(2) * STEP;
        if let Some(bin) = expected.get_mut(((distance - 0.45) / 0.25) as usize) {
            *bin += light;
        }
    }
    for (way, bias) in IN_FOG {
        for unwarp in ["first-surface", "last-segment"] {
            let settings = format!("integrator={way} max-bounces=1 time.unwarp={unwarp}{}", bins(3, 0.45, 0.25));
            let found = slots(&lit(FOG, &settings), 40);
            assert!(bias > 0.0 || found[0].iter().all(|&light| light == 0.0), "{way}");
            for (bin, expected) in expected.into_iter().enumerate() {
                let power = if bias > 0.0 { 2.0 } else { 0.5 };
                assert_mean(&format!("{way}, {unwarp}, bin {bin}"), &found[bin + 1], expected, bias * expected, power);
            }
        }
    }
}
