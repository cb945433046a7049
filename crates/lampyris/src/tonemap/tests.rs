use proptest::prelude::*;

use super::*;

fn grey(values: &[f32]) -> Image {
    Image::from_pixels(values.len(), 1, values.iter().map(|&v| [v; 3]).collect()).expect("one row")
}

fn reds(operator: ToneMap, values: &[f32], exposure: f32) -> Vec<f32> {
    operator.apply(&grey(values), exposure).pixels().iter().map(|pixel| pixel[0]).collect()
}

fn default_of(name: &str) -> ToneMap {
    name.parse().expect("a known name")
}

fn near(found: &[f32], expected: &[f32]) {
    let close = found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-5);
    assert!(close && found.len() == expected.len(), "{found:?} is not {expected:?}");
}

#[test]
fn clamp_cuts_off_at_one() {
    assert_eq!(reds(ToneMap::Clamp, &[0.0, 0.25, 1.0, 7.0], 0.0), [0.0, 0.25, 1.0, 1.0]);
}

#[test]
fn equalize_takes_the_largest_value_to_one_exactly() {
    for largest in [0.3, 1.0, 7.3, 1e-30, 1e30] {
        let mapped = reds(ToneMap::Equalize, &[0.0, largest / 4.0, largest], 0.0);
        assert_eq!((mapped[0], mapped[2]), (0.0, 1.0));
        near(&mapped, &[0.0, 0.25, 1.0]);
    }
}

#[test]
fn equalize_clamp_divides_by_its_value() {
    assert_eq!(reds(ToneMap::EqualizeClamp { value: 4.0 }, &[1.0, 4.0, 9.0], 0.0), [0.25, 1.0, 1.0]);
}

#[test]
fn gamma_raises_what_was_equalized() {
    assert_eq!(reds(ToneMap::Gamma { gamma: 2.0 }, &[1.0, 4.0, 16.0], 0.0), [0.25, 0.5, 1.0]);
    let values = [0.1, 0.7, 3.0];
    assert_eq!(reds(ToneMap::Gamma { gamma: 1.0 }, &values, 0.0), reds(ToneMap::Equalize, &values, 0.0));
}

#[test]
fn gamma_clamp_cuts_off_before_the_power() {
    let operator = ToneMap::GammaClamp { gamma: 2.0, value: 4.0 };
    assert_eq!(reds(operator, &[1.0, 4.0, 16.0], 0.0), [0.5, 1.0, 1.0]);
}

#[test]
fn reinhard_takes_a_constant_picture_to_key_over_one_plus_key() {
    for value in [1e-4, 1.0, 300.0] {
        near(&reds(ToneMap::Reinhard { key: 0.18, white: None }, &[value; 5], 0.0), &[0.18 / 1.18; 5]);
    }
}

#[test]
fn reinhard_takes_its_white_to_one() {
    // Two values around an average of 1: L is 0.18 · 4 = 0.72 and 0.18 / 4.
    let mapped = reds(ToneMap::Reinhard { key: 0.18, white: Some(0.72) }, &[4.0, 0.25], 0.0);
    near(&mapped, &[1.0, 0.045 * (1.0 + 0.045 / (0.72 * 0.72)) / 1.045]);
}

#[test]
fn black_pixels_do_not_count_in_the_average() {
    let operator = default_of("reinhard");
    near(&reds(operator, &[2.0, 0.0, 0.0, 0.0], 0.0), &[0.18 / 1.18, 0.0, 0.0, 0.0]);
}

#[test]
fn reinhard_keeps_the_chromaticity() {
    let image = Image::from_pixels(2, 1, vec![[0.4, 0.2, 0.1], [3.0, 1.0, 2.0]]).expect("two pixels");
    for name in ["reinhard", "reinhard-local", "filmic"] {
        // Dark enough for nothing to be cut off.
        let mapped = default_of(name).apply(&image, -3.0);
        for (a, b) in mapped.pixels().iter().zip(image.pixels()) {
            near(&[a[1] / a[0], a[2] / a[0]], &[b[1] / b[0], b[2] / b[0]]);
        }
    }
}

#[test]
fn local_equals_global_on_a_constant_picture() {
    let image = Image::new(30, 20).map(|_| [0.4; 3]);
    let [local, global] = ["reinhard-local", "reinhard"].map(|name| default_of(name).apply(&image, 1.0));
    for (a, b) in local.pixels().iter().zip(global.pixels()) {
        near(a, b);
    }
}

#[test]
fn local_keeps_more_contrast_inside_a_bright_region_than_global() {
    // Left dark; right bright, with a faint pattern of one pixel.
    let mut image = Image::new(80, 40);
    for (index, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let x = index % 80;
        *pixel = [if x < 40 { 0.05 } else { 20.0 + 2.0 * (x % 2) as f32 }; 3];
    }
    let contrast = |name: &str| {
        let mapped = default_of(name).apply(&image, 0.0);
        mapped.pixel(61, 20)[0] - mapped.pixel(60, 20)[0]
    };
    assert!(
        contrast("reinhard-local") > 2.0 * contrast("reinhard"),
        "{} {}",
        contrast("reinhard-local"),
        contrast("reinhard")
    );
}

#[test]
fn filmic_has_the_values_of_its_fit() {
    near(&reds(ToneMap::Filmic, &[0.0, 0.18, 1.0], 0.0), &[0.0, 0.266_899, 0.803_797]);
}

#[test]
fn a_stop_doubles_what_the_curve_is_given() {
    assert_eq!(reds(ToneMap::Clamp, &[0.2], 1.0), reds(ToneMap::Clamp, &[0.4], 0.0));
    assert_eq!(reds(ToneMap::Equalize, &[1.0, 4.0], 1.0), [0.5, 1.0]);
    assert_eq!(reds(ToneMap::Equalize, &[1.0, 4.0], -1.0), [0.125, 0.5]);
    near(&reds(default_of("reinhard"), &[5.0], 1.0), &[0.36 / 1.36]);
    near(&reds(default_of("reinhard-local"), &[5.0], 1.0), &[0.36 / 1.36]);
    assert_eq!(reds(ToneMap::Filmic, &[0.2], 1.0), reds(ToneMap::Filmic, &[0.4], 0.0));
}

#[test]
fn a_black_picture_stays_black() {
    for (name, operator) in ToneMap::ALL {
        assert_eq!(operator.apply(&Image::new(3, 2), 2.0), Image::new(3, 2), "{name}");
    }
}

#[test]
fn what_is_not_finite_counts_as_the_largest_or_as_black() {
    let image = grey(&[f32::INFINITY, f32::NAN, -1.0, 2.0, f32::NEG_INFINITY]);
    let same = grey(&[2.0, 0.0, 0.0, 2.0, 0.0]);
    for (name, operator) in ToneMap::ALL {
        assert_eq!(operator.apply(&image, 0.0), operator.apply(&same, 0.0), "{name}");
    }
}

#[test]
fn names_are_read_back_and_near_ones_proposed() {
    for (name, operator) in ToneMap::ALL {
        assert_eq!((name.parse(), operator.name()), (Ok(operator), name));
    }
    assert_eq!("equalise-clamp".parse(), Ok(ToneMap::EqualizeClamp { value: 1.0 }));
    let error = "reinhart".parse::<ToneMap>().expect_err("unknown");
    assert!(error.to_string().ends_with("did you mean 'reinhard'?"), "{error}");
}

#[test]
fn parameters_that_make_no_picture_are_refused() {
    assert!(ToneMap::ALL.iter().all(|(_, operator)| operator.check().is_ok()));
    for operator in [
        ToneMap::Gamma { gamma: 0.0 },
        ToneMap::EqualizeClamp { value: -1.0 },
        ToneMap::GammaClamp { gamma: 2.2, value: f32::NAN },
        ToneMap::Reinhard { key: 0.18, white: Some(0.0) },
        ToneMap::ReinhardLocal { key: 0.18, phi: f32::INFINITY, epsilon: 0.05 },
    ] {
        assert!(operator.check().is_err(), "{operator:?}");
    }
}

proptest! {
    #[test]
    fn results_lie_in_0_to_1(
        values in proptest::collection::vec(any::<f32>(), 3..60),
        exposure in -20.0f32..20.0,
        which in 0usize..8,
    ) {
        let pixels: Vec<[f32; 3]> = values.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        let image = Image::from_pixels(pixels.len(), 1, pixels).expect("one row");
        let mapped = ToneMap::ALL[which].1.apply(&image, exposure);
        prop_assert!(mapped.pixels().iter().flatten().all(|v| (0.0..=1.0).contains(v)));
    }

    #[test]
    fn what_is_brighter_stays_at_least_as_bright(
        mut values in proptest::collection::vec(0.0f32..100.0, 2..40),
        // Not the local operator: it darkens beside what is bright, that is its purpose.
        name in proptest::sample::select(
            vec!["clamp", "equalize", "equalize-clamp", "gamma", "gamma-clamp", "reinhard", "filmic"]
        ),
    ) {
        values.sort_by(f32::total_cmp);
        let mapped = reds(default_of(name), &values, 0.0);
        prop_assert!(mapped.windows(2).all(|pair| pair[1] >= pair[0] - 1e-6), "{:?}", mapped);
    }
}
