//! What a film is of, and what sets it apart from another.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::scene::{Fingerprint, SceneDescription};

/// Everything that a pass depends on beside its number. What has the same identity can be merged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Of the program: another one may compute otherwise.
    version: String,
    /// Of all but camera and settings.
    scene: Fingerprint,
    seed: u64,
    /// Whether light was made to have wavelengths, or not to.
    spectral: Option<bool>,
    integrator: Value,
    film: Value,
    camera: Value,
}

impl Identity {
    /// Of a scene with this fingerprint, rendered as its description says.
    pub fn new(scene: Fingerprint, description: &SceneDescription) -> Identity {
        // What can be said in a scene file can be said in JSON.
        let value = |part: serde_json::Result<Value>| part.unwrap_or_default();
        Identity {
            version: env!("CARGO_PKG_VERSION").into(),
            scene,
            seed: description.render.seed,
            spectral: description.render.spectral,
            integrator: value(serde_json::to_value(&description.integrator)),
            film: value(serde_json::to_value(&description.film)),
            camera: value(serde_json::to_value(&description.camera)),
        }
    }

    /// What sets another identity apart from this one, such as `seed: 1 instead of 2`; none if nothing does.
    pub fn difference(&self, other: &Identity) -> Option<String> {
        if self.version != other.version {
            return Some(format!("made by version {} instead of {}", other.version, self.version));
        }
        if self.seed != other.seed {
            return Some(format!("of seed {} instead of {}", other.seed, self.seed));
        }
        let word = |spectral: Option<bool>| spectral.map_or(Value::Null, Value::Bool);
        if let Some(difference) = difference("render.spectral", &word(self.spectral), &word(other.spectral)) {
            return Some(difference);
        }
        let parts = [
            ("integrator", &self.integrator, &other.integrator),
            ("film", &self.film, &other.film),
            ("camera", &self.camera, &other.camera),
        ];
        let of_setting = parts.into_iter().find_map(|(name, own, other)| difference(name, own, other));
        of_setting.or_else(|| (self.scene != other.scene).then(|| "of another scene".to_string()))
    }

    /// The name of the integrator, for those who look at a film.
    pub fn integrator(&self) -> &str {
        let name = self.integrator.as_object().and_then(|tagged| tagged.keys().next());
        name.map_or("unknown", String::as_str)
    }

    /// The seed.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The version of the program.
    pub fn version(&self) -> &str {
        &self.version
    }
}

/// The first key whose value differs, with both values.
fn difference(key: &str, own: &Value, other: &Value) -> Option<String> {
    let none = &Value::Null;
    match (own, other) {
        (Value::Object(own), Value::Object(other)) => {
            let keys = own.keys().chain(other.keys().filter(|key| !own.contains_key(*key)));
            let mut pairs = keys.map(|name| (name, own.get(name).unwrap_or(none), other.get(name).unwrap_or(none)));
            pairs.find_map(|(name, own, other)| difference(&format!("{key}.{name}"), own, other))
        }
        _ => (!is_same(own, other)).then(|| format!("of another {key}: {} instead of {}", said(other), said(own))),
    }
}

/// Whether two values are the same, one of which may have been written and read again: the last bit of a double can be
/// lost on the way, and settings have single precision.
fn is_same(own: &Value, other: &Value) -> bool {
    match (own, other) {
        (Value::Array(own), Value::Array(other)) => {
            own.len() == other.len() && own.iter().zip(other).all(|(own, other)| is_same(own, other))
        }
        (Value::Number(own), Value::Number(other)) if own.is_f64() && other.is_f64() => {
            own.as_f64().map(|value| value as f32) == other.as_f64().map(|value| value as f32)
        }
        _ => own == other,
    }
}

/// A value as people would say it.
fn said(value: &Value) -> String {
    match value {
        Value::Null => "none".into(),
        Value::String(text) => text.clone(),
        Value::Object(_) => "another".into(),
        value => value.to_string(),
    }
}
