//! A statement with its parameters, and asking for them.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;

use glam::DVec3;

use super::super::source::Spot;
use crate::error::{Warning, did_you_mean};

/// The values of a parameter, all of one sort.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Values {
    Empty,
    Numbers(Vec<f64>),
    Texts(Vec<String>),
    Booleans(Vec<bool>),
}

/// A named value.
#[derive(Clone, Debug)]
pub(super) struct Parameter {
    /// What it is declared to be: `float`, `rgb`, `texture`, ...
    pub kind: String,
    pub name: String,
    pub values: Values,
    pub spot: Spot,
    /// Whether anyone has asked for it, or it comes from `Attribute`, where it may be meant for others.
    used: Cell<bool>,
}

impl Parameter {
    pub fn new(kind: &str, name: &str, spot: Spot) -> Parameter {
        let (kind, name) = (kind.to_string(), name.to_string());
        Parameter { kind, name, values: Values::Empty, spot, used: Cell::new(false) }
    }

    pub fn numbers(&self) -> Option<&[f64]> {
        match &self.values {
            Values::Numbers(numbers) => Some(numbers),
            Values::Empty => Some(&[]),
            _ => None,
        }
    }

    pub fn text(&self) -> Option<&str> {
        match &self.values {
            Values::Texts(texts) => texts.first().map(String::as_str),
            _ => None,
        }
    }
}

/// What is wrong with a value: where, and why.
pub(super) type Wrong = (Spot, String);

/// A statement.
#[derive(Clone, Debug)]
pub(super) struct Statement {
    pub keyword: &'static str,
    /// Strings right after the keyword.
    pub texts: Vec<String>,
    /// Numbers right after the keyword.
    pub numbers: Vec<f64>,
    pub parameters: Vec<Parameter>,
    pub spot: Spot,
    /// Names that were asked for, to propose them for wrong ones.
    asked: RefCell<BTreeSet<&'static str>>,
}

impl Statement {
    pub fn new(keyword: &'static str, spot: Spot) -> Statement {
        let asked = RefCell::default();
        Statement { keyword, texts: Vec::new(), numbers: Vec::new(), parameters: Vec::new(), spot, asked }
    }

    /// The first string after the keyword: mostly what sort of shape, light, ... it is.
    pub fn sort(&self) -> &str {
        self.texts.first().map_or("", String::as_str)
    }

    /// Adds parameters set by `Attribute`, which go after the statement's own.
    pub fn inherit(&mut self, parameters: &[Parameter]) {
        let inherited = parameters.iter().cloned().inspect(|parameter| parameter.used.set(true));
        self.parameters.extend(inherited);
    }

    pub fn parameter(&self, name: &'static str) -> Option<&Parameter> {
        self.asked.borrow_mut().insert(name);
        let mut same = self.parameters.iter().filter(|parameter| parameter.name == name);
        let first = same.next()?;
        first.used.set(true);
        Some(first)
    }

    pub fn has(&self, name: &str) -> bool {
        self.parameters.iter().any(|parameter| parameter.name == name)
    }

    /// Whether `name` is there and more than a number 0.
    pub fn varied(&self, name: &str) -> bool {
        let parameter = self.parameters.iter().find(|parameter| parameter.name == name);
        parameter
            .is_some_and(|parameter| parameter.numbers().is_none_or(|values| values.iter().any(|&value| value != 0.0)))
    }

    /// Where `name` stands, or the statement itself without it.
    pub fn spot_of(&self, name: &str) -> Spot {
        self.parameters.iter().find(|parameter| parameter.name == name).map_or(self.spot, |parameter| parameter.spot)
    }

    /// How messages call it.
    pub fn called(&self) -> String {
        let sort = match (self.keyword, &self.texts[..]) {
            ("Texture", [_, _, sort]) => sort,
            _ => self.sort(),
        };
        format!("{} '{sort}'", self.keyword)
    }

    /// Marks parameters that make no difference to us.
    pub fn ignore(&self, names: &[&'static str]) {
        for name in names {
            self.parameter(name);
        }
    }

    fn wrong(&self, parameter: &Parameter, wanted: &str) -> Wrong {
        (parameter.spot, format!("'{}' of {} must be {wanted}", parameter.name, self.called()))
    }

    pub fn optional_number(&self, name: &'static str) -> Result<Option<f64>, Wrong> {
        let Some(parameter) = self.parameter(name) else { return Ok(None) };
        match parameter.numbers() {
            Some([value]) => Ok(Some(*value)),
            _ => Err(self.wrong(parameter, "one number")),
        }
    }

    pub fn number(&self, name: &'static str, default: f64) -> Result<f64, Wrong> {
        Ok(self.optional_number(name)?.unwrap_or(default))
    }

    /// A whole number that is not negative.
    pub fn count(&self, name: &'static str) -> Result<Option<u32>, Wrong> {
        let Some(value) = self.optional_number(name)? else { return Ok(None) };
        if value >= 0.0 && value.fract() == 0.0 && value <= f64::from(u32::MAX) {
            return Ok(Some(value as u32));
        }
        Err((
            self.spot_of(name),
            format!("'{name}' of {} must be a whole number of at least 0, not {value}", self.called()),
        ))
    }

    pub fn boolean(&self, name: &'static str, default: bool) -> Result<bool, Wrong> {
        let Some(parameter) = self.parameter(name) else { return Ok(default) };
        match (&parameter.values, parameter.text()) {
            (Values::Booleans(values), _) if values.len() == 1 => Ok(values[0]),
            // The way of pbrt-v3.
            (_, Some("true")) => Ok(true),
            (_, Some("false")) => Ok(false),
            _ => Err(self.wrong(parameter, "true or false")),
        }
    }

    pub fn text(&self, name: &'static str) -> Result<Option<&str>, Wrong> {
        let Some(parameter) = self.parameter(name) else { return Ok(None) };
        match parameter.text() {
            Some(text) => Ok(Some(text)),
            None => Err(self.wrong(parameter, "a text in quotes")),
        }
    }

    pub fn numbers(&self, name: &'static str) -> Result<Option<&[f64]>, Wrong> {
        let Some(parameter) = self.parameter(name) else { return Ok(None) };
        match parameter.numbers() {
            Some(numbers) => Ok(Some(numbers)),
            None => Err(self.wrong(parameter, "a list of numbers")),
        }
    }

    pub fn point(&self, name: &'static str, default: DVec3) -> Result<DVec3, Wrong> {
        let Some(parameter) = self.parameter(name) else { return Ok(default) };
        match parameter.numbers() {
            Some([x, y, z]) => Ok(DVec3::new(*x, *y, *z)),
            _ => Err(self.wrong(parameter, "three numbers")),
        }
    }

    /// What nobody asked for, once.
    pub fn leftovers(&self) -> Vec<(Spot, Warning)> {
        let unused = self.parameters.iter().filter(|parameter| !parameter.used.replace(true));
        let warning = |parameter: &Parameter| {
            let message = format!("'{}' of {} is not known and is ignored", parameter.name, self.called());
            match did_you_mean(&parameter.name, self.asked.borrow().iter().copied()) {
                Some(near) if near != parameter.name => {
                    Warning::new(message).with_hint(format!("did you mean '{near}'?"))
                }
                _ => Warning::new(message),
            }
        };
        unused.map(|parameter| (parameter.spot, warning(parameter))).collect()
    }
}
