//! The grammar of a scene file: as a JSON Schema for editors, and as forms for our own reader.
//! Both come from the description's types and their doc comments, so that neither can fall behind.

use serde_json::{Map, Value};

use super::SceneDescription;

/// The JSON Schema (draft 2020-12) of a scene file: one pretty-printed JSON text that ends in a newline.
pub fn json_schema() -> String {
    format!("{:#}\n", Schema::of_scenes().root)
}

/// The schema of a scene file, to be asked what may stand where.
pub(crate) struct Schema {
    root: Value,
}

impl Schema {
    pub(crate) fn of_scenes() -> Schema {
        let mut root = schemars::schema_for!(SceneDescription).to_value();
        tidy(&mut root);
        let definitions = root["$defs"].clone();
        inline(&mut root, &definitions);
        // A file may leave the integrator's type out.
        if let Some(required) = root.pointer_mut("/$defs/IntegratorDescription/oneOf/0/required") {
            *required = Value::Array(Vec::new());
        }
        root["title"] = "A scene of Lampyris".into();
        Schema { root }
    }

    /// The whole scene.
    pub(crate) fn scene(&self) -> Node<'_> {
        Node { root: &self.root, here: &self.root }
    }
}

/// TOML has no null: what may be absent is not required, and that says it all. The default of a whole table is in
/// serde's notation, and the keys have their own. A table of several types with keys of its own is closed as the
/// others are.
fn tidy(schema: &mut Value) {
    match schema {
        Value::Object(keys) => {
            if let Some(Value::Array(types)) = keys.get("type")
                && let Some(only) = types.iter().find(|name| *name != "null").cloned()
            {
                keys.insert("type".into(), only);
            }
            if keys.get("default").is_some_and(|default| default.is_null() || default.is_object()) {
                keys.remove("default");
            }
            if let Some(Value::Array(choices)) = keys.get_mut("anyOf") {
                choices.retain(|choice| choice["type"] != "null");
                if let [Value::Object(only)] = &mut choices[..] {
                    let only = std::mem::take(only);
                    keys.remove("anyOf");
                    keys.extend(only);
                }
            }
            if keys.contains_key("properties") && keys.contains_key("oneOf") {
                keys.insert("unevaluatedProperties".into(), false.into());
            }
            keys.values_mut().for_each(tidy);
        }
        Value::Array(items) => items.iter_mut().for_each(tidy),
        _ => {}
    }
}

/// A type whose keys are written elsewhere gets them in place, so that all types look alike.
fn inline(schema: &mut Value, definitions: &Value) {
    match schema {
        Value::Object(keys) => {
            let target = keys.get("$ref").and_then(Value::as_str).and_then(|path| path.strip_prefix("#/$defs/"));
            let extra = target.map(|name| definitions[name]["properties"].clone());
            if let (Some(Value::Object(own)), Some(Value::Object(extra))) = (keys.get_mut("properties"), extra) {
                own.extend(extra);
                keys.remove("$ref");
                keys.insert("additionalProperties".into(), false.into());
                keys.remove("unevaluatedProperties");
            }
            keys.values_mut().for_each(|value| inline(value, definitions));
        }
        Value::Array(items) => items.iter_mut().for_each(|item| inline(item, definitions)),
        _ => {}
    }
}

/// A place in the schema.
#[derive(Clone, Copy)]
pub(crate) struct Node<'s> {
    root: &'s Value,
    here: &'s Value,
}

/// What may stand at a place of a scene file.
pub(crate) enum Form<'s> {
    /// A table of these keys.
    Table(Fields<'s>),
    /// A table whose `type` decides which keys it has.
    Tagged(Tagged<'s>),
    /// A table of a single key out of these.
    Step(Vec<(&'s str, Node<'s>)>),
    /// A table of free names.
    Named(Node<'s>),
    /// The name of a thing, or the thing itself.
    NameOr(Node<'s>),
    /// A list, of this many items where that is fixed.
    List(Node<'s>, Option<usize>),
    Number,
    /// A number, or three.
    OneOrThree,
    /// A whole number from 0 to this.
    Whole(u64),
    Boolean,
    Text,
    /// One of these words.
    Word(Vec<&'s str>),
    Color,
    Paint,
    /// A number, the name of a substance, or one of these formulas.
    Ior(Node<'s>),
}

/// The keys of a table.
#[derive(Clone, Copy)]
pub(crate) struct Fields<'s> {
    root: &'s Value,
    table: &'s Value,
}

/// The types of a tagged table.
pub(crate) struct Tagged<'s> {
    /// What a user calls such a thing, such as "shape".
    pub(crate) noun: String,
    /// Keys that all types have and that serde knows beside the type's own, which it knows under this name.
    pub(crate) shared: Option<(Fields<'s>, &'static str)>,
    /// The types.
    pub(crate) variants: Vec<(&'s str, Fields<'s>)>,
    /// The type where none is given.
    pub(crate) default: Option<&'s str>,
}

impl<'s> Node<'s> {
    fn at(self, here: &'s Value) -> Node<'s> {
        Node { here, ..self }
    }

    /// The definition that the place refers to, with its name.
    fn resolve(self) -> (&'s str, &'s Value) {
        match self.here["$ref"].as_str().and_then(|target| target.strip_prefix("#/$defs/")) {
            Some(name) => (name, &self.root["$defs"][name]),
            None => ("", self.here),
        }
    }

    /// What stands here where nothing is written, if the schema says so.
    pub(crate) fn default(self) -> Option<&'s Value> {
        self.here.get("default")
    }

    /// What may stand here.
    pub(crate) fn form(self) -> Form<'s> {
        let (name, schema) = self.resolve();
        match name {
            "Color" => return Form::Color,
            "Paint" => return Form::Paint,
            _ => {}
        }
        if let Some(choices) = schema["anyOf"].as_array() {
            return match choices.iter().find(|choice| choice.get("$ref").is_some()) {
                Some(formula) if name == "Ior" => Form::Ior(self.at(formula)),
                Some(thing) => Form::NameOr(self.at(thing)),
                None => Form::OneOrThree,
            };
        }
        if let Some(choices) = schema["oneOf"].as_array() {
            let words: Vec<&str> = choices.iter().filter_map(|choice| choice["const"].as_str()).collect();
            if !words.is_empty() {
                return Form::Word(words);
            }
            return self.tagged(name, schema, choices).map_or_else(|| self.step(choices), Form::Tagged);
        }
        match schema["type"].as_str() {
            Some("object") => match schema.get("additionalProperties") {
                Some(items) if items.is_object() => Form::Named(self.at(items)),
                _ => Form::Table(Fields { root: self.root, table: schema }),
            },
            Some("array") => {
                Form::List(self.at(&schema["items"]), schema["maxItems"].as_u64().map(|length| length as usize))
            }
            Some("integer") if schema["format"] == "uint32" => Form::Whole(u32::MAX.into()),
            Some("integer") => Form::Whole(u64::MAX),
            Some("number") => Form::Number,
            Some("boolean") => Form::Boolean,
            _ => Form::Text,
        }
    }

    fn tagged(self, name: &str, schema: &'s Value, choices: &'s [Value]) -> Option<Tagged<'s>> {
        let fields = |table| Fields { root: self.root, table };
        let tag = |choice: &'s Value| choice["properties"]["type"]["const"].as_str();
        let variants: Vec<_> =
            choices.iter().map(|choice| Some((tag(choice)?, fields(choice)))).collect::<Option<_>>()?;
        let default = variants.iter().find(|(_, fields)| !fields.required().any(|key| key == "type"));
        Some(Tagged {
            noun: name.strip_suffix("Description").unwrap_or(name).to_lowercase(),
            shared: schema.get("properties").map(|_| (fields(schema), "geometry")),
            default: default.map(|(name, _)| *name),
            variants,
        })
    }

    fn step(self, choices: &'s [Value]) -> Form<'s> {
        let keys = choices.iter().filter_map(|choice| choice["properties"].as_object()).flatten();
        Form::Step(keys.map(|(key, value)| (key.as_str(), self.at(value))).collect())
    }
}

impl<'s> Fields<'s> {
    fn properties(self) -> Option<&'s Map<String, Value>> {
        self.table["properties"].as_object()
    }

    /// What the value of `key` may be, if there is such a key.
    pub(crate) fn get(self, key: &str) -> Option<Node<'s>> {
        let here = self.properties()?.get(key).filter(|_| key != "type")?;
        Some(Node { root: self.root, here })
    }

    /// All keys but `type`.
    pub(crate) fn keys(self) -> impl Iterator<Item = &'s str> {
        self.properties().into_iter().flatten().map(|(key, _)| key.as_str()).filter(|key| *key != "type")
    }

    /// The keys that must be there.
    pub(crate) fn required(self) -> impl Iterator<Item = &'s str> {
        self.table["required"].as_array().into_iter().flatten().filter_map(Value::as_str)
    }
}

impl<'s> Tagged<'s> {
    /// The keys of the type `name`.
    pub(crate) fn variant(&self, name: &str) -> Option<(&'s str, Fields<'s>)> {
        self.variants.iter().copied().find(|(known, _)| *known == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_schema_in_the_documentation_is_current() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scene.schema.json");
        let written = std::fs::read_to_string(path).unwrap_or_default();
        assert!(
            written == json_schema(),
            "run `cargo run --release -- schema > docs/scene.schema.json` from the folder of the project"
        );
    }

    #[test]
    fn a_schema_knows_no_null() {
        assert!(!json_schema().contains("null"), "TOML cannot write it");
    }

    /// Adds the key paths of all places around and below `node` whose form is `wanted`, each definition once.
    fn collect(node: Node<'_>, path: &str, seen: &mut Vec<String>, wanted: fn(&Form<'_>) -> bool) -> Vec<String> {
        let (name, _) = node.resolve();
        if seen.iter().any(|known| known == name) {
            return Vec::new();
        }
        if !name.is_empty() {
            seen.push(name.to_string());
        }
        let form = node.form();
        let mut found: Vec<String> = wanted(&form).then(|| path.to_string()).into_iter().collect();
        let below: Vec<(String, Node<'_>)> = match form {
            Form::Table(fields) => nodes(path, fields),
            Form::Tagged(tagged) => {
                let shared = tagged.shared.iter().flat_map(|(fields, _)| nodes(path, *fields));
                let own = tagged.variants.iter().flat_map(|(name, own)| nodes(&format!("{path}:{name}"), *own));
                shared.chain(own).collect()
            }
            Form::Step(steps) => steps.iter().map(|(key, node)| (format!("{path}.{key}"), *node)).collect(),
            Form::Named(item) | Form::NameOr(item) | Form::Ior(item) | Form::List(item, _) => {
                vec![(path.to_string(), item)]
            }
            _ => Vec::new(),
        };
        for (path, node) in below {
            found.extend(collect(node, &path, seen, wanted));
        }
        found
    }

    fn nodes<'s>(path: &str, fields: Fields<'s>) -> Vec<(String, Node<'s>)> {
        fields.keys().filter_map(|key| Some((format!("{path}.{key}"), fields.get(key)?))).collect()
    }

    fn all(wanted: fn(&Form<'_>) -> bool) -> Vec<String> {
        collect(Schema::of_scenes().scene(), "", &mut Vec::new(), wanted)
    }

    /// `Text` is what a place falls back to whose form is not known; it must hold for texts alone.
    #[test]
    fn only_texts_are_taken_for_texts() {
        assert_eq!(
            all(|form| matches!(form, Form::Text)),
            [
                ".camera.capture.wall",
                ".camera.irradiance-of",
                ".groups.interior",
                ".groups.material:conductor.metal",
                ".groups.material:normal-map.normals",
                ".groups.material:bump-map.height",
                ".groups.name",
                ".groups:mesh.file",
                ".groups:instance.group",
                ".lights:environment.file",
                ".lights:projector.texture",
                ".media:grid.albedo-file",
                ".media:grid.file",
                ".medium",
                ".textures:bitmap.file"
            ]
        );
    }

    #[test]
    fn every_choice_of_types_is_known() {
        assert_eq!(
            all(|form| matches!(form, Form::Tagged(_))),
            [
                ".film.filter",
                ".groups",
                ".groups.material",
                ".integrator",
                ".lights",
                ".media",
                ".media:homogeneous.phase",
                ".textures"
            ]
        );
    }
}
