//! `lampyris tonemap` and `lampyris compare`.

use std::path::Path;

use lampyris::compare::{compare as measure, difference_image};
use lampyris::error::{Error, Result};
use lampyris::output::{check_path, read_image, read_layer, write_image};
use lampyris::tonemap::ToneMap;

use crate::args::{CompareArguments, TonemapArguments};
use crate::films::{self, is_film};
use crate::report::print;

/// Brings a picture into the range of a display.
///
/// # Errors
/// An unknown operator, a parameter that it does not have, and what is wrong with the files.
pub fn tonemap(arguments: &TonemapArguments) -> Result<()> {
    let operator = operator(arguments)?;
    check_path(&arguments.output)?;
    let image = match &arguments.layer {
        layer if is_film(&arguments.input) => films::read_image(&arguments.input, layer.as_deref())?,
        Some(layer) => read_layer(&arguments.input, layer)?,
        None => read_image(&arguments.input)?,
    };
    write_image(&arguments.output, &operator.apply(&image, arguments.exposure))
}

/// The operator with the parameters that the user gave.
fn operator(arguments: &TonemapArguments) -> Result<ToneMap> {
    let mut operator: ToneMap = arguments.operator.parse()?;
    let given = [
        ("gamma", arguments.gamma),
        ("value", arguments.value),
        ("key", arguments.key),
        ("white", arguments.white),
        ("phi", arguments.phi),
        ("epsilon", arguments.epsilon),
    ];
    for (name, number) in given {
        let Some(number) = number else { continue };
        match (name, &mut operator) {
            ("gamma", ToneMap::Gamma { gamma } | ToneMap::GammaClamp { gamma, .. }) => *gamma = number,
            ("value", ToneMap::EqualizeClamp { value } | ToneMap::GammaClamp { value, .. }) => *value = number,
            ("key", ToneMap::Reinhard { key, .. } | ToneMap::ReinhardLocal { key, .. }) => *key = number,
            ("white", ToneMap::Reinhard { white, .. }) => *white = Some(number),
            ("phi", ToneMap::ReinhardLocal { phi, .. }) => *phi = number,
            ("epsilon", ToneMap::ReinhardLocal { epsilon, .. }) => *epsilon = number,
            _ => {
                return Err(Error::new(format!("the operator {} has no {name}", operator.name()))
                    .with_hint(format!("leave --{name} out, or see 'lampyris tonemap --help' for who has it")));
            }
        }
    }
    operator.check()?;
    Ok(operator)
}

/// Prints how far two pictures are apart.
///
/// # Errors
/// What is wrong with the files, or pictures of different sizes.
pub fn compare(arguments: &CompareArguments) -> Result<()> {
    if let Some(output) = &arguments.output {
        check_path(output)?;
    }
    let read = |path: &Path| if is_film(path) { films::read_image(path, None) } else { read_image(path) };
    let (image, reference) = (read(&arguments.image)?, read(&arguments.reference)?);
    let found = measure(&image, &reference)?;
    if let Some(output) = &arguments.output {
        write_image(output, &difference_image(&image, &reference)?)?;
    }
    let mut rows = vec![
        ("relMSE", found.rel_mse),
        ("relMSE, trimmed", found.rel_mse_trimmed),
        ("RMSE", found.rmse),
        ("mean ratio", found.mean_ratio),
        ("largest difference", found.max_abs),
        ("FLIP", found.flip),
    ];
    let broken = [("broken pixels", found.non_finite), ("broken in reference", found.non_finite_reference)];
    rows.extend(broken.iter().filter(|(_, pixels)| *pixels > 0).map(|&(name, pixels)| (name, pixels as f64)));
    let table: String = rows.iter().map(|(name, value)| format!("{name:<20}{}\n", figures(*value))).collect();
    print(&table)
}

/// Six figures that count.
fn figures(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || !size.is_finite() || value.fract() == 0.0 && size < 1e9 => format!("{value}"),
        size if (1e-4..1e6).contains(&size) => {
            let decimals = (5 - size.log10().floor() as i32).max(0) as usize;
            format!("{value:.decimals$}")
        }
        _ => format!("{value:.5e}"),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::args::{Arguments, Command};

    fn chosen(options: &str) -> Result<ToneMap> {
        let line = format!("lampyris tonemap a.exr -o b.png {options}");
        match Arguments::try_parse_from(line.split_whitespace()).expect("well-formed").command {
            Command::Tonemap(arguments) => operator(&arguments),
            other => panic!("not tonemap: {other:?}"),
        }
    }

    #[test]
    fn parameters_reach_the_operator_that_has_them() {
        assert_eq!(chosen("").expect("the default"), ToneMap::Reinhard { key: 0.18, white: None });
        assert_eq!(
            chosen("--operator gamma-clamp --gamma 3 --value 2").expect("both"),
            ToneMap::GammaClamp { gamma: 3.0, value: 2.0 }
        );
        assert_eq!(
            chosen("--operator reinhard-local --phi 4 --epsilon 0.1 --key 1").expect("all"),
            ToneMap::ReinhardLocal { key: 1.0, phi: 4.0, epsilon: 0.1 }
        );
    }

    #[test]
    fn a_parameter_of_another_operator_is_an_error() {
        let error = chosen("--operator filmic --gamma 2").expect_err("no gamma");
        assert_eq!(error.message, "the operator filmic has no gamma");
        chosen("--operator gamma --gamma 0").expect_err("makes no picture");
    }

    #[test]
    fn measures_have_six_figures() {
        let values = [0.0, 1.0, 0.123_456_78, 12.345_678, 1.234_567_8e-7, f64::NAN];
        assert_eq!(values.map(figures), ["0", "1", "0.123457", "12.3457", "1.23457e-7", "NaN"]);
    }
}
