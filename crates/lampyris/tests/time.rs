//! Time: its bins add up to the picture and change nothing about it, and scale, split and unwarp as they must.

mod common;

use common::lit;
use common::time::bins;
use lampyris::film::Layers;

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
    // Without a radius, it would go by the bins.
    "integrator=auto photons=2000 radius=3",
    "integrator=photon-map photons=2000 k=20",
    "integrator=photon-map photons=2000 bandwidth=nearest k=20 direct=photons filter=tent",
    "integrator=light photons=2000 filter=gaussian",
    "integrator=path spectral=true filter=tent filter.radius=1.4",
];

#[test]
fn bins_and_what_is_outside_add_up_to_the_picture() {
    for way in WAYS {
        // Some light before, some after.
        let film = lit(BOX, &(way.to_string() + &bins(30, 4.5, 0.05))).film(3, Layers::NONE);
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
        let plain = lit(BOX, way).film(2, Layers::NONE);
        assert_eq!(plain.clock(), None);
        let timed = lit(BOX, &(way.to_string() + &bins(30, 4.5, 0.05))).film(2, Layers::NONE);
        assert!(plain.image() == timed.image(), "{way}");
        let (layered, both) = (
            lit(BOX, way).film(2, Layers::ALL),
            lit(BOX, &(way.to_string() + &bins(9, 3.0, 0.5))).film(2, Layers::ALL),
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
        let film = lit(BOX, &(way.to_string() + &bins(100, start, 0.01))).film(4, Layers::NONE);
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
        assert!(lit.film_on(1, [0, 1, 2]) == lit.film_on(3, [2, 0, 1]), "{way}");
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
        let seen = |scale: f64| lit(&text(scale), &format!("{way} time.bins=40")).film(2, Layers::NONE);
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
            .map(|(count, width)| lit(BOX, &(way.to_string() + &bins(count, 3.3, width))).film(2, Layers::NONE));
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
            lit(text, &format!("{way} time.unwarp={unwarp}{}", bins(64, start, 0.0625))).film(2, Layers::NONE)
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
