//! Light arrives at surfaces when it must, by closed forms and by all integrators alike.

mod common;

use common::statistics::{Sample, assert_distribution, assert_mean, assert_same_mean};
use common::time::{POINT_OVER_FLOOR, bins, lit_bins, slots};
use common::{lit, slab, square};
use lampyris::film::Layers;
use lampyris::spectrum::Dispersion;

/// A point light I above a floor of reflectance ρ: L = (ρ/π) I cos/d², at the time d + r alone.
#[test]
fn a_point_on_a_floor_is_lit_when_light_has_come_to_it_and_on_to_the_eye() {
    let (to_eye, to_lamp) = (5.0_f64.sqrt(), (1.5_f64.powi(2) + 1.25_f64.powi(2)).sqrt());
    let expected = 0.7 / std::f64::consts::PI * 3.0 * (1.25 / to_lamp) / to_lamp.powi(2);
    for (unwarp, at) in [("none", to_eye + to_lamp), ("first-surface", to_lamp)] {
        for way in ["path", "auto photons=100", "photon-map photons=100"] {
            let range = bins(3, at - 0.0015, 0.001);
            let film =
                lit(POINT_OVER_FLOOR, &format!("integrator={way} time.unwarp={unwarp}{range}")).film(1, Layers::NONE);
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
            "integrator=auto photons=100 max-bounces=1",
        ] {
            let lit = lit(&scene(near, extra), &(way.to_string() + &bins(80, 0.0, 0.1)));
            let found = lit_bins(&lit.film(8, Layers::NONE));
            assert!(
                found.iter().all(|&from| (from + 0.05 - time).abs() < 0.15),
                "{way}, {near}: {found:?} without {time}"
            );
            assert!(!found.is_empty(), "{way}, {near}");
        }
    }
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
        let film = lit(&text, &format!("integrator={way}{}", bins(1, at - 1e-4, 2e-4))).film(4, Layers::NONE);
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
            let film = lit(&text, &settings).film(4, Layers::NONE);
            assert!(film.bins(0)[0][1] > 0.05, "{way}, {index}");
            assert_eq!(film.outside_bins(0).expect("time")[0], [0.0; 3], "{way}, {index}");
        }
        // Of all colours, red is the first.
        let settings = format!("integrator={way} time.index=group{}", bins(1, at(glass.group_at(830.0)) - 1e-4, 0.03));
        let film = lit(&text, &settings).film(8, Layers::NONE);
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
        let film = lit(text, &format!("integrator={way}{range}")).film(4, Layers::NONE);
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
