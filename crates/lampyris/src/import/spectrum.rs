//! Spectra to linear RGB, by the two conventions of Mitsuba's RGB mode:
//!
//! - of a surface, as it looks in daylight: the illuminant is D65, and a constant 1 is (1, 1, 1);
//! - of a light, by its power: a constant 1 has luminance 1 and the slightly red hue of equal energy.
//!
//! Colours that RGB cannot hold are clamped to 0, as there.

pub(super) use crate::spectrum::eye::Role;
use crate::spectrum::eye::{planck, rgb};

/// A spectrum as a file gives it, before we know whether it is of a surface or of a light.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Spectrum {
    /// The same at all wavelengths.
    Constant(f64),
    /// Wavelength in nm and value, in rising order, straight lines between.
    List(Vec<[f64; 2]>),
    /// An ideal black body in kelvin, times a factor.
    BlackBody { temperature: f64, scale: f64 },
}

/// The linear RGB of `spectrum`, and whether a channel had to be clamped.
pub(super) fn to_rgb(spectrum: &Spectrum, role: Role) -> ([f64; 3], bool) {
    let rgb = rgb(role, |wavelength| value_at(spectrum, wavelength));
    let clamped = rgb.map(|channel| channel.clamp(0.0, f64::from(f32::MAX)));
    (clamped, rgb.iter().any(|&channel| channel < 0.0))
}

/// The value at a wavelength in nm.
pub(super) fn value_at(spectrum: &Spectrum, wavelength: f64) -> f64 {
    match spectrum {
        Spectrum::Constant(value) => *value,
        Spectrum::BlackBody { temperature, scale } => scale * planck(wavelength, *temperature),
        Spectrum::List(pairs) => {
            let next = pairs.partition_point(|pair| pair[0] < wavelength);
            match (next.checked_sub(1).map(|before| pairs[before]), pairs.get(next)) {
                (_, Some([exact, value])) if *exact == wavelength => *value,
                (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (wavelength - x0) / (x1 - x0),
                _ => 0.0,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn close(found: [f64; 3], wanted: [f64; 3], tolerance: f64) {
        for channel in 0..3 {
            assert!((found[channel] - wanted[channel]).abs() <= tolerance, "{found:?} is not {wanted:?}");
        }
    }

    fn list(pairs: &[[f64; 2]]) -> Spectrum {
        Spectrum::List(pairs.to_vec())
    }

    #[test]
    fn a_flat_reflectance_is_grey_and_a_flat_light_has_mitsubas_hue() {
        close(to_rgb(&Spectrum::Constant(0.3), Role::Surface).0, [0.3; 3], 1e-12);
        // Mitsuba 3.9.1, scalar_rgb.
        close(to_rgb(&Spectrum::Constant(1.0), Role::Light).0, [1.204794, 0.948291, 0.908916], 1e-3);
    }

    #[test]
    fn lists_agree_with_mitsuba() {
        // The numbers are those of Mitsuba 3.9.1, scalar_rgb.
        let slope = list(&[[400.0, 0.1], [500.0, 0.2], [600.0, 0.7], [700.0, 0.6]]);
        close(to_rgb(&slope, Role::Surface).0, [0.793164, 0.408830, 0.113084], 2e-3);
        close(to_rgb(&slope, Role::Light).0, [0.913429, 0.393076, 0.096401], 2e-3);
        // This one begins and ends with a step, which Mitsuba samples more coarsely than we do.
        let bump = list(&[[450.0, 0.2], [550.0, 0.9], [650.0, 0.5]]);
        close(to_rgb(&bump, Role::Surface).0, [0.589803, 0.820081, 0.111617], 5e-3);
        close(to_rgb(&bump, Role::Light).0, [0.705150, 0.786922, 0.083943], 5e-3);
    }

    #[test]
    fn a_colour_outside_rgb_is_clamped_and_said_to_be() {
        let green = list(&[[500.0, 0.0], [550.0, 1.0], [560.0, 0.0]]);
        let (rgb, clamped) = to_rgb(&green, Role::Light);
        assert!(clamped);
        close(rgb, [0.0, 0.392355, 0.0], 5e-3);
    }

    #[test]
    fn a_black_body_reddens_as_it_cools() {
        let at = |temperature| to_rgb(&Spectrum::BlackBody { temperature, scale: 1.0 }, Role::Light).0;
        let (cool, hot) = (at(2500.0), at(9000.0));
        assert!(cool[0] / cool[2] > 4.0 && hot[0] / hot[2] < 1.0);
        // Luminance at 5000 K: the law at 556 nm is 1.2e4 W/(m² sr nm), near its mean over ȳ.
        let luminance = 0.2126 * at(5000.0)[0] + 0.7152 * at(5000.0)[1] + 0.0722 * at(5000.0)[2];
        assert!((luminance / 1.2e4 - 1.0).abs() < 0.1, "{luminance}");
    }

    proptest! {
        #[test]
        fn every_list_gives_finite_colours(
            steps in proptest::collection::vec((0.001f64..300.0, -1e30f64..1e30), 1..20), start in 0.0f64..900.0,
        ) {
            let mut wavelength = start;
            let pairs = steps.iter().map(|(step, value)| { wavelength += step; [wavelength, *value] }).collect();
            let (rgb, _) = to_rgb(&Spectrum::List(pairs), Role::Surface);
            prop_assert!(rgb.iter().all(|channel| channel.is_finite() && *channel >= 0.0));
        }
    }
}
