//! The graphics state: the current transform, material and light.

use std::rc::Rc;

use glam::{DMat4, DVec3};

use super::Importer;
use super::material::Use;
use super::medium::Sides;
use super::statement::{Parameter, Statement};
use crate::error::Result;

/// Parameters that `Attribute` may set at a time: more than any statement knows.
const MOST_ATTRIBUTES: usize = 64;

/// More parameters than [`MOST_ATTRIBUTES`].
pub(super) struct TooMany;

/// What holds for the shapes and lights that follow.
#[derive(Clone)]
pub(super) struct State {
    /// From object to world; before `WorldBegin` from world to camera.
    pub ctm: DMat4,
    /// Whether transforms apply at the shutter's opening, the only moment that we draw.
    active: bool,
    pub reverse: bool,
    pub material: Use,
    pub area_light: Option<Rc<Statement>>,
    /// What is on either side of a surface.
    pub media: Sides,
    /// Parameters set by `Attribute`, with what they are for.
    attributes: Rc<Vec<(String, Vec<Parameter>)>>,
}

impl Default for State {
    fn default() -> State {
        State {
            ctm: DMat4::IDENTITY,
            active: true,
            reverse: false,
            material: Use::Default,
            area_light: None,
            media: Sides::default(),
            attributes: Rc::default(),
        }
    }
}

impl State {
    /// Sets parameters for all statements of a sort that follow, in place of those of the same name.
    ///
    /// # Errors
    /// Where too many would be carried along from statement to statement.
    pub fn attribute(&mut self, mut statement: Statement) -> Result<(), TooMany> {
        let sort = statement.sort().to_string();
        let attributes = Rc::make_mut(&mut self.attributes);
        for (_, earlier) in attributes.iter_mut().filter(|(other, _)| *other == sort) {
            earlier.retain(|parameter| !statement.has(&parameter.name));
        }
        attributes.retain(|(_, parameters)| !parameters.is_empty());
        attributes.push((sort, std::mem::take(&mut statement.parameters)));
        let count: usize = attributes.iter().map(|(_, parameters)| parameters.len()).sum();
        if count > MOST_ATTRIBUTES { Err(TooMany) } else { Ok(()) }
    }

    /// Adds the parameters that hold for the statement; later ones go first.
    pub fn inherit(&self, statement: &mut Statement) {
        let target = match statement.keyword {
            "Shape" => "shape",
            "LightSource" | "AreaLightSource" => "light",
            "Material" | "MakeNamedMaterial" => "material",
            "MakeNamedMedium" => "medium",
            "Texture" => "texture",
            _ => return,
        };
        for (_, parameters) in self.attributes.iter().rev().filter(|(sort, _)| sort == target) {
            statement.inherit(parameters);
        }
    }
}

impl Importer<'_> {
    /// Whether the statement is one about transforms, which it then has done.
    pub(super) fn transform_statement(&mut self, statement: &Statement) -> Result<bool> {
        let numbers = &statement.numbers;
        let point = |at: usize| DVec3::new(numbers[at], numbers[at + 1], numbers[at + 2]);
        let ctm = self.state.ctm;
        let changed = match statement.keyword {
            "Identity" => DMat4::IDENTITY,
            "Translate" => ctm * DMat4::from_translation(point(0)),
            "Scale" => ctm * DMat4::from_scale(point(0)),
            "Rotate" => match point(1).try_normalize() {
                Some(axis) => ctm * DMat4::from_axis_angle(axis, numbers[0].to_radians()),
                None => return Err(self.reader.fault(statement.spot, "the axis of a rotation must not be zero")),
            },
            "LookAt" => match look_at(point(0), point(3), point(6)) {
                Some(matrix) => ctm * matrix,
                None => {
                    let error = self.reader.fault(statement.spot, "LookAt does not say where to look");
                    return Err(error.with_hint("eye and target must differ, and up must point elsewhere"));
                }
            },
            "Transform" => matrix(numbers),
            "ConcatTransform" => ctm * matrix(numbers),
            "CoordinateSystem" => {
                self.systems.insert(statement.sort().to_string(), ctm);
                return Ok(true);
            }
            "CoordSysTransform" => match self.systems.get(statement.sort()) {
                Some(&matrix) => matrix,
                None => {
                    let message = format!("there is no coordinate system '{}': nothing is changed", statement.sort());
                    self.warn(statement.spot, message);
                    return Ok(true);
                }
            },
            "ActiveTransform" => {
                self.state.active = statement.sort() != "EndTime";
                if statement.sort() != "All" {
                    self.warn(statement.spot, "motion is not supported: the scene is drawn as the shutter opens");
                }
                return Ok(true);
            }
            "TransformTimes" => return Ok(true),
            _ => return Ok(false),
        };
        if self.state.active {
            self.state.ctm = changed;
        }
        Ok(true)
    }
}

/// pbrt writes its matrices column by column, the translation last.
fn matrix(numbers: &[f64]) -> DMat4 {
    let columns: [f64; 16] = std::array::from_fn(|index| numbers.get(index).copied().unwrap_or(0.0));
    DMat4::from_cols_array(&columns)
}

/// From world to a left-handed camera that looks along +z, +y up and +x to the right.
fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Option<DMat4> {
    let forward = (target - eye).try_normalize()?;
    let right = up.try_normalize()?.cross(forward).try_normalize()?;
    let up = forward.cross(right);
    let to_world = DMat4::from_cols(right.extend(0.0), up.extend(0.0), forward.extend(0.0), eye.extend(1.0));
    Some(to_world.inverse())
}
