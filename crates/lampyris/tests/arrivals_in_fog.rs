//! Light in fog arrives when it must, by closed forms and by all integrators alike.

mod common;

use common::lit;
use common::statistics::{Sample, assert_mean, assert_same_mean};
use common::time::{bins, slots};

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
