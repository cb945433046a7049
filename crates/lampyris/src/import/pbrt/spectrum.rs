//! Colours and spectra of parameters, as linear RGB.

use std::path::Path;

use super::super::spectrum::{Role, Spectrum, to_rgb, value_at};
use super::super::{named, value};
use super::Importer;
use super::statement::{Parameter, Statement, Values};
use crate::error::{Result, did_you_mean};
use crate::scene::description::{Ior, IorFormula};
use crate::spectrum::eye::xyz_to_rgb;
use crate::spectrum::{Dispersion, FRAUNHOFER_C, FRAUNHOFER_D, FRAUNHOFER_F};

/// Glasses by pbrt's names, and by ours.
const GLASSES: [(&str, &str); 10] = [
    ("glass-BK7", "bk7"),
    ("glass-BAF10", "baf10"),
    ("glass-FK51A", "fk51a"),
    ("glass-LASF9", "lasf9"),
    // pbrt's F5, F10 and F11 hold the data of SF5, SF10 and SF11.
    ("glass-F5", "sf5"),
    ("glass-F10", "sf10"),
    ("glass-F11", "sf11"),
    ("glass-SF5", "sf5"),
    ("glass-SF10", "sf10"),
    ("glass-SF11", "sf11"),
];

/// Standard illuminants that RGB or a black body stands for: correlated colour temperature in kelvin (CIE 15).
const ILLUMINANTS: [(&str, f64); 16] = [
    ("stdillum-A", 2856.0),
    ("stdillum-D50", 5003.0),
    ("stdillum-F1", 6430.0),
    ("stdillum-F2", 4230.0),
    ("stdillum-F3", 3450.0),
    ("stdillum-F4", 2940.0),
    ("stdillum-F5", 6350.0),
    ("stdillum-F6", 4150.0),
    ("stdillum-F7", 6500.0),
    ("stdillum-F8", 5000.0),
    ("stdillum-F9", 4150.0),
    ("stdillum-F10", 5000.0),
    ("stdillum-F11", 4000.0),
    ("stdillum-F12", 3000.0),
    ("illum-acesD60", 6000.0),
    ("stdillum-D65", 6504.0),
];

/// Brass of 70 % copper, whose name pbrt has and Mitsuba has not: the complex index that [Querry 1985] measured, as the
/// database refractiveindex.info has it, from 300 to 900 nm in steps of 10, and as RGB what Mitsuba 3.9.1 makes of it.
const BRASS: ([f32; 3], [f32; 3]) = ([0.4180, 0.5195, 1.1217], [3.6639, 2.6776, 1.7693]);

/// Weights of the channels in luminance (ITU-R BT.709).
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

impl Importer<'_> {
    /// A colour parameter; `None` without it.
    pub(super) fn color(&mut self, statement: &Statement, name: &'static str, role: Role) -> Result<Option<[f64; 3]>> {
        let Some(parameter) = statement.parameter(name) else { return Ok(None) };
        let spot = parameter.spot;
        let fault =
            |message: &str| Err(self.reader.fault(spot, format!("'{name}' of {} {message}", statement.called())));
        match (parameter.kind.as_str(), &parameter.values) {
            ("blackbody", Values::Numbers(numbers)) => match numbers[..] {
                [temperature] if temperature > 0.0 => Ok(Some(self.black_body(temperature, role))),
                // The way of pbrt-v3: temperature and factor.
                [temperature, scale] if temperature > 0.0 => {
                    Ok(Some(self.black_body(temperature, role).map(|channel| channel * scale)))
                }
                _ => fault("must be one temperature in kelvin above 0"),
            },
            ("spectrum", Values::Numbers(numbers)) => match (numbers.len() % 2, value::rising(pairs(numbers))) {
                (0, Ok(spectrum)) => Ok(Some(self.seen(&spectrum, parameter, role))),
                (0, Err(message)) => Err(self.reader.fault(spot, message)),
                _ => fault("must be pairs of wavelength and value"),
            },
            ("spectrum", Values::Texts(texts)) => match texts.first().map(String::as_str) {
                Some(text) => self.named_spectrum(parameter, text, role).map(Some),
                None => fault("has no value"),
            },
            ("xyz", Values::Numbers(numbers)) => match numbers[..] {
                [x, y, z] => Ok(Some(xyz_to_rgb([x, y, z]).map(|channel| channel.max(0.0)))),
                _ => fault("must be three numbers"),
            },
            (_, Values::Numbers(numbers)) => match numbers[..] {
                [grey] => Ok(Some([grey; 3])),
                [r, g, b] => Ok(Some([r, g, b])),
                _ => fault("must be three numbers"),
            },
            _ => fault("must be a colour"),
        }
    }

    /// A spectrum by name or from a file.
    fn named_spectrum(&mut self, parameter: &Parameter, text: &str, role: Role) -> Result<[f64; 3]> {
        if let Some(found) = metal(text) {
            return Ok(found.map(f64::from));
        }
        if let Some(dispersion) = substance(text).and_then(Dispersion::of_substance) {
            return Ok([dispersion.at_d(); 3]);
        }
        if text == "stdillum-D65" {
            return Ok([1.0; 3]);
        }
        if let Some((_, temperature)) = ILLUMINANTS.iter().find(|(known, _)| *known == text) {
            if text != "stdillum-A" {
                self.warn(parameter.spot, format!("'{text}' is not known here: a black body of its colour is used"));
            }
            return Ok(self.black_body(*temperature, role));
        }
        if Path::new(text).extension().is_some() {
            let bytes = self.reader.bytes(Path::new(text), parameter.spot)?;
            let spectrum = value::spectrum_file(&String::from_utf8_lossy(&bytes))
                .map_err(|message| self.reader.fault(parameter.spot, format!("'{text}': {message}")))?;
            return Ok(self.seen(&spectrum, parameter, role));
        }
        let metals = ["Ag", "Al", "Au", "Cu", "CuZn", "MgO", "TiO2"];
        let metals = metals.iter().flat_map(|metal| [format!("metal-{metal}-eta"), format!("metal-{metal}-k")]);
        let names: Vec<String> = metals
            .chain(GLASSES.iter().map(|(name, _)| name.to_string()))
            .chain(ILLUMINANTS.iter().map(|(name, _)| name.to_string()))
            .collect();
        let error = self.reader.fault(parameter.spot, format!("there is no spectrum named '{text}'"));
        Err(match did_you_mean(text, names.iter().map(String::as_str)) {
            Some(near) => error.with_hint(format!("did you mean '{near}'?")),
            None => error.with_hint("a file of a spectrum ends in .spd"),
        })
    }

    fn black_body(&self, temperature: f64, role: Role) -> [f64; 3] {
        let (rgb, _) = to_rgb(&Spectrum::BlackBody { temperature, scale: 1.0 }, Role::Light);
        let luminance = luminance(rgb);
        // Of no visible light at all: red.
        let normal = if luminance > 0.0 { rgb.map(|channel| channel / luminance) } else { [1.0, 0.0, 0.0] };
        if role == Role::Surface { normal.map(|channel| channel.min(1.0)) } else { normal }
    }

    fn seen(&mut self, spectrum: &Spectrum, parameter: &Parameter, role: Role) -> [f64; 3] {
        let (rgb, clamped) = to_rgb(spectrum, role);
        if clamped {
            self.warn(
                parameter.spot,
                format!("the colour of '{}' is out of the range of RGB and is cut", parameter.name),
            );
        }
        match luminance(rgb) {
            luminance if role == Role::Light && luminance > 0.0 => rgb.map(|channel| channel / luminance),
            _ => rgb,
        }
    }

    /// An index of refraction that may depend on the wavelength: a number, a glass, or a spectrum, of which Cauchy's formula
    /// keeps the index and the Abbe number.
    pub(super) fn dispersion(&mut self, statement: &Statement, names: &[&'static str], default: f32) -> Result<Ior> {
        let parameter = names.iter().find(|name| statement.has(name)).and_then(|name| statement.parameter(name));
        let found = match parameter.map(|parameter| (parameter.kind.as_str(), &parameter.values)) {
            Some(("spectrum", Values::Texts(texts))) => texts.first().and_then(|text| glass(text)),
            Some(("spectrum", Values::Numbers(numbers))) => of_pairs(numbers),
            _ => None,
        };
        match found {
            Some(ior) => {
                statement.ignore(names);
                Ok(ior)
            }
            None => Ok(self.ior(statement, names, default)?.into()),
        }
    }

    /// An index of refraction: a number, a glass, or a spectrum, which becomes its green.
    pub(super) fn ior(&mut self, statement: &Statement, names: &[&'static str], default: f32) -> Result<f32> {
        let Some(name) = names.iter().find(|name| statement.has(name)) else {
            statement.ignore(names);
            return Ok(default);
        };
        let kind = statement.parameter(name).map(|parameter| parameter.kind.clone()).unwrap_or_default();
        if kind == "texture" {
            let spot = statement.spot_of(name);
            self.warn(spot, format!("an '{name}' that varies is not supported: {default} is used"));
            return Ok(default);
        }
        let ior = self.color(statement, name, Role::Surface)?.map_or(default, |rgb| rgb[1] as f32);
        if kind == "spectrum" {
            let spot = statement.spot_of(name);
            self.warn(spot, format!("this disperses nothing here: all colours are refracted by {ior}"));
        }
        Ok(ior)
    }
}

/// Our name for one of pbrt's glasses.
fn substance(text: &str) -> Option<&'static str> {
    GLASSES.iter().find(|(known, _)| *known == text).map(|(_, substance)| *substance)
}

/// The index of one of pbrt's glasses.
fn glass(text: &str) -> Option<Ior> {
    substance(text).map(|substance| Ior::Substance(substance.to_string()))
}

/// Cauchy's formula with the index and the Abbe number of a spectrum of pairs; none where red is refracted more than blue.
fn of_pairs(numbers: &[f64]) -> Option<Ior> {
    let pairs = numbers.len().is_multiple_of(2).then(|| value::rising(pairs(numbers)).ok())??;
    let [f, d, c] = [FRAUNHOFER_F, FRAUNHOFER_D, FRAUNHOFER_C].map(|line| value_at(&pairs, line));
    (d > 1.0 && f > c && c > 1.0).then(|| Ior::Formula(IorFormula::Abbe([d as f32, ((d - 1.0) / (f - c)) as f32])))
}

/// The real or imaginary part of the index of one of pbrt's metals.
fn metal(text: &str) -> Option<[f32; 3]> {
    let (metal, part) = text.strip_prefix("metal-")?.rsplit_once('-')?;
    let (eta, k) = if metal == "CuZn" { BRASS } else { named::conductor(metal)? };
    match part {
        "eta" => Some(eta),
        "k" => Some(k),
        _ => None,
    }
}

fn pairs(numbers: &[f64]) -> Vec<[f64; 2]> {
    numbers.as_chunks().0.to_vec()
}

fn luminance(rgb: [f64; 3]) -> f64 {
    rgb.iter().zip(LUMINANCE).map(|(channel, weight)| channel * weight).sum()
}
