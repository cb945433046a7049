//! Affine transforms as people write them: a list of steps, or a matrix.

use std::borrow::Cow;

use glam::{Mat4, Vec3};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// An affine transform. In a file: a list of steps, each applied after the one before it, of
/// `{ translate = [x, y, z] }`, `{ scale = s }` or `{ scale = [x, y, z] }`,
/// `{ rotate = { axis = [x, y, z], degrees = d } }`, `{ matrix = [16 numbers, row by row] }`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transform(pub Mat4);

impl Transform {
    /// Whether it changes nothing.
    pub fn is_identity(&self) -> bool {
        self.0 == Mat4::IDENTITY
    }

    /// From 16 numbers, row by row, the last column being the translation.
    pub fn from_rows(rows: &[f32; 16]) -> Transform {
        Transform(Mat4::from_cols_array(rows).transpose())
    }
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
enum Step {
    Translate([f32; 3]),
    Scale(Scale),
    Rotate(Rotate),
    Matrix([f32; 16]),
}

#[derive(Deserialize, Serialize)]
#[serde(untagged)]
enum Scale {
    Uniform(f32),
    PerAxis([f32; 3]),
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Rotate {
    axis: [f32; 3],
    degrees: f32,
}

impl Step {
    fn matrix(&self) -> Result<Mat4, &'static str> {
        Ok(match self {
            Step::Translate(by) => Mat4::from_translation(Vec3::from_array(*by)),
            Step::Scale(Scale::Uniform(by)) => Mat4::from_scale(Vec3::splat(*by)),
            Step::Scale(Scale::PerAxis(by)) => Mat4::from_scale(Vec3::from_array(*by)),
            Step::Rotate(Rotate { axis, degrees }) => {
                let axis = Vec3::from_array(*axis).try_normalize().ok_or("the axis of a rotation must not be zero")?;
                Mat4::from_axis_angle(axis, degrees.to_radians())
            }
            Step::Matrix(rows) => Transform::from_rows(rows).0,
        })
    }
}

impl<'de> Deserialize<'de> for Transform {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Transform, D::Error> {
        let mut all = Mat4::IDENTITY;
        for step in Vec::<Step>::deserialize(deserializer)? {
            all = step.matrix().map_err(serde::de::Error::custom)? * all;
        }
        Ok(Transform(all))
    }
}

impl Serialize for Transform {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let matrix = Step::Matrix(self.0.transpose().to_cols_array());
        serializer.collect_seq((!self.is_identity()).then_some(matrix))
    }
}

impl JsonSchema for Transform {
    fn schema_name() -> Cow<'static, str> {
        "Transform".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let vector =
            serde_json::json!({ "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 });
        json_schema!({
            "description": "Steps, each applied after the one before it.",
            "type": "array",
            "items": { "oneOf": [
                { "type": "object", "properties": { "translate": vector }, "required": ["translate"], "additionalProperties": false },
                { "type": "object", "properties": { "scale": { "anyOf": [{ "type": "number" }, vector] } }, "required": ["scale"], "additionalProperties": false },
                { "type": "object", "properties": { "rotate": {
                    "type": "object",
                    "properties": { "axis": vector, "degrees": { "type": "number" } },
                    "required": ["axis", "degrees"], "additionalProperties": false
                } }, "required": ["rotate"], "additionalProperties": false },
                { "type": "object", "properties": { "matrix": {
                    "type": "array", "items": { "type": "number" }, "minItems": 16, "maxItems": 16,
                    "description": "Row by row."
                } }, "required": ["matrix"], "additionalProperties": false }
            ] }
        })
    }
}
