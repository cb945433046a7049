//! Complex amplitudes in place of time bins: those of closed forms, and of the bins of the same render.

mod common;

use std::f64::consts::PI;

use common::lit;
use common::time::POINT_OVER_FLOOR;
use lampyris::film::Layers;
use lampyris::image::luminance;
use lampyris::transient::{LightKind, TimeLayer};

/// A point light above a floor: L = (ρ/π) I cos/d² arrives at the time d + r alone, and turns the amplitude of a frequency f by
/// 2π f (d + r - start).
#[test]
fn a_single_arrival_has_the_phase_of_its_time() {
    let (to_eye, to_lamp) = (5.0_f64.sqrt(), (1.5_f64.powi(2) + 1.25_f64.powi(2)).sqrt());
    let light = 0.7 / PI * 3.0 * (1.25 / to_lamp) / to_lamp.powi(2);
    let frequencies = [0.0, 0.37, 1.0, 5.2];
    for (unwarp, at) in [("none", to_eye + to_lamp), ("first-surface", to_lamp)] {
        for way in ["path", "auto photons=100", "photon-map photons=100"] {
            let settings = "time.frequencies=0,0.37,1,5.2 time.start=0.3 time.layers=direct,indirect";
            let film = lit(POINT_OVER_FLOOR, &format!("integrator={way} time.unwarp={unwarp} {settings}"))
                .film(2, Layers::NONE);
            let amplitudes = film.amplitudes(0, Some(TimeLayer::Kind(LightKind::Direct))).expect("kept");
            assert_eq!(amplitudes, film.amplitudes(0, None).expect("kept"), "all light is direct");
            for (frequency, [real, imaginary]) in frequencies.into_iter().zip(amplitudes) {
                let angle = -2.0 * PI * frequency * (at - 0.3);
                let expected = [angle.cos(), angle.sin()].map(|part| light * part);
                let found = [real[1], imaginary[1]].map(f64::from);
                let off = (found[0] - expected[0]).hypot(found[1] - expected[1]);
                assert!(off < 2e-3 * light, "{way}, {unwarp}, {frequency}: {found:?} is not {expected:?}");
            }
        }
    }
}

/// A room with a mirror and glass.
const ROOM: &str = "
    camera = { origin = [0, 0, -0.9], target = [0, 0, 0], fov = 70 }
    film = { size = [6, 5] }
    lights = [{ type = 'point', position = [0, 0.7, 0], power = 12 }]
    [[shapes]]
    type = 'cube'
    flip-normal = true
    material = { type = 'diffuse', reflectance = [0.8, 0.6, 0.4] }
    [[shapes]]
    type = 'sphere'
    center = [-0.4, -0.5, 0.25]
    radius = 0.4
    material = { type = 'mirror' }
    [[shapes]]
    type = 'sphere'
    center = [0.4, -0.5, 0.1]
    radius = 0.4
    material = { type = 'glass' }";

const WAYS: [&str; 4] = [
    "integrator=path",
    // Without a radius, it would go by the bins.
    "integrator=auto photons=2000 radius=3 filter=tent",
    "integrator=photon-map photons=2000 k=20",
    "integrator=light photons=2000 filter=gaussian",
];

/// Of the same paths, which bins move by no more than half a bin: |exp(iθ) - 1| ≤ θ = π f Δ.
#[test]
fn amplitudes_are_those_of_narrow_bins() {
    let (frequencies, width) = ([0.0, 0.5, 1.25], 0.01);
    for way in WAYS {
        let range = format!(" max-bounces=8 time.bins=6000 time.start=0 time.bin-width={width}");
        let binned = lit(ROOM, &(way.to_string() + &range)).film(2, Layers::NONE);
        assert_eq!(binned.share_outside_bins(), Some([0.0; 2]), "{way}: all light is in the bins");
        let expected = binned.transient(None).expect("time").phasors(&frequencies).expect("finite");
        let direct = lit(ROOM, &format!("{way} max-bounces=8 time.frequencies=0,0.5,1.25")).film(2, Layers::NONE);
        assert!(direct.image() == binned.image(), "{way}: the picture is the same");
        let found = direct.phasors(None).expect("kept");
        assert_eq!((found.values.len(), &found.frequencies), (expected.values.len(), &expected.frequencies));
        let pairs = found.values.chunks(2).zip(expected.values.chunks(2)).enumerate();
        for (place, (found, expected)) in pairs {
            let light = f64::from(luminance(direct.image().pixels()[place / frequencies.len()]));
            let allowed = (PI * frequencies[place % frequencies.len()] * width + 1e-4) * light;
            let off = f64::from((found[0] - expected[0]).hypot(found[1] - expected[1]));
            assert!(off <= allowed, "{way}: {found:?} is not {expected:?}");
        }
    }
}

#[test]
fn any_threads_and_any_order_of_passes_give_the_same_amplitudes() {
    for way in WAYS {
        let lit = lit(ROOM, &format!("{way} time.bins=400 time.bin-width=0.05 time.phasor={{mean=0.4,sigma=3}}"));
        let (one, other) = (lit.film_on(1, [0, 1, 2]), lit.film_on(3, [2, 0, 1]));
        assert!(one == other, "{way}");
        // Mean 20 / 0.4 = 50, σ 20 / 18: from 46 to 54.
        let frequencies = one.clock().expect("time").frequencies();
        assert_eq!((frequencies.len(), frequencies[0]), (9, 2.3), "{way}");
        assert!(one.transient(None).is_err() && one.outside_bins(0).is_none(), "there are no bins");
    }
}
