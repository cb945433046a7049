//! The other way: a description as people would write it. What says no more than the default is left out.

use serde_json::{Map, Value};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::super::description::SceneDescription;
use super::super::schema::{Fields, Form, Node, Schema};

/// A key and its value, as they stand in the file.
type Entry = (String, String);

/// The text of a scene file in TOML that says what `description` says; none if it holds triangles, which a file holds
/// only by the names of other files, or a number that TOML has no way to write.
pub(crate) fn text(description: &SceneDescription) -> Option<String> {
    let schema = Schema::of_scenes();
    let value = serde_json::to_value(description).ok()?;
    let (Form::Table(fields), Value::Object(keys)) = (schema.scene().form(), &value) else { return None };
    let mut sections = Vec::new();
    for (key, node, value) in said(fields, keys) {
        match (node.form(), value) {
            (Form::List(item, _), Value::Array(values)) => {
                for value in values {
                    section(&format!("[[{key}]]"), entries(item, value)?, &mut sections);
                }
            }
            _ => section(&format!("[{key}]"), entries(node, value)?, &mut sections),
        }
    }
    let text = sections.join("\n");
    (read_back(&schema, &text).as_ref() == Some(description)).then_some(text)
}

/// What the text says to a reader. That it is what was to be written is worth the little time: whoever converts a scene
/// may throw the old file away, and a number that is none would become a default without a word.
fn read_back(schema: &Schema, text: &str) -> Option<SceneDescription> {
    let tree = DeTable::parse(text).ok()?;
    let tree = Spanned::new(tree.span(), DeValue::Table(tree.into_inner()));
    super::read(schema.scene(), "", tree, &mut |_, _| {}).ok()
}

/// A heading with its entries, unless there are none.
fn section(heading: &str, entries: Vec<Entry>, sections: &mut Vec<String>) {
    if !entries.is_empty() {
        let lines: String = entries.iter().map(|(key, value)| format!("{key} = {value}\n")).collect();
        sections.push(format!("{heading}\n{lines}"));
    }
}

/// What stands in the table that says `value`; none if it is no table.
fn entries(node: Node<'_>, value: &Value) -> Option<Vec<Entry>> {
    match (node.form(), value) {
        (Form::Table(fields), Value::Object(keys)) => of_fields(fields, keys),
        (Form::Tagged(tagged), Value::Object(keys)) => {
            let own = match tagged.shared {
                Some((_, own)) => keys.get(own)?.as_object()?,
                None => keys,
            };
            let (name, own) = own.iter().next()?;
            let (_, fields) = tagged.variant(name)?;
            let mut all = vec![("type".to_string(), quoted(name))];
            all.extend(of_fields(fields, own.as_object()?)?);
            if let Some((shared, _)) = tagged.shared {
                all.extend(of_fields(shared, keys)?);
            }
            Some(all)
        }
        (Form::Named(item), Value::Object(names)) => {
            names.iter().map(|(name, value)| Some((key(name), inline(item, value)?))).collect()
        }
        (Form::NameOr(thing) | Form::Ior(thing), Value::Object(_)) => entries(thing, value),
        (_, Value::Object(keys)) => keys.iter().map(|(name, value)| Some((key(name), plain(value)?))).collect(),
        _ => None,
    }
}

fn of_fields(fields: Fields<'_>, keys: &Map<String, Value>) -> Option<Vec<Entry>> {
    said(fields, keys).map(|(name, node, value)| Some((key(name), inline(node, value)?))).collect()
}

/// Those of `keys` that the table may have, but for what is absent, empty or the default.
fn said<'a>(fields: Fields<'a>, keys: &'a Map<String, Value>) -> impl Iterator<Item = (&'a str, Node<'a>, &'a Value)> {
    let is_empty = |value: &Value| match value {
        Value::Null => true,
        Value::Array(items) => items.is_empty(),
        Value::Object(names) => names.is_empty(),
        _ => false,
    };
    let given = fields.keys().filter_map(move |key| Some((key, fields.get(key)?, keys.get(key)?)));
    given.filter(move |(_, node, value)| !is_empty(value) && node.default() != Some(value))
}

/// A value on one line; lists of tables have a line for each item.
fn inline(node: Node<'_>, value: &Value) -> Option<String> {
    match (node.form(), value) {
        (Form::List(item, _), Value::Array(values)) => list(values, |value| inline(item, value)),
        (_, Value::Object(_)) => Some(table(&entries(node, value)?)),
        _ => plain(value),
    }
}

fn plain(value: &Value) -> Option<String> {
    match value {
        Value::Bool(flag) => Some(flag.to_string()),
        Value::String(text) => Some(quoted(text)),
        Value::Array(values) => list(values, plain),
        Value::Object(keys) => {
            let entries: Option<Vec<Entry>> =
                keys.iter().map(|(name, value)| Some((key(name), plain(value)?))).collect();
            Some(table(&entries?))
        }
        Value::Number(number) => match (number.as_i64(), number.is_f64()) {
            (Some(whole), _) => Some(whole.to_string()),
            // Numbers of a description have single precision: the shortest text that says so, not all of its digits.
            (None, true) => number.as_f64().map(|number| short(number as f32)),
            (None, false) => None,
        },
        Value::Null => None,
    }
}

/// A number as short as it can be; TOML asks for a digit on both sides of a point, or for an exponent.
fn short(number: f32) -> String {
    let text =
        if number == 0.0 || (1e-4..1e7).contains(&number.abs()) { number.to_string() } else { format!("{number:e}") };
    if text.contains(['.', 'e']) { text } else { text + ".0" }
}

fn list(values: &[Value], write: impl Fn(&Value) -> Option<String>) -> Option<String> {
    let items = values.iter().map(write).collect::<Option<Vec<String>>>()?;
    Some(match values {
        [_, _, ..] if values.iter().all(Value::is_object) => format!("[\n    {},\n]", items.join(",\n    ")),
        _ => format!("[{}]", items.join(", ")),
    })
}

fn table(entries: &[Entry]) -> String {
    let entries: Vec<String> = entries.iter().map(|(key, value)| format!("{key} = {value}")).collect();
    format!("{{ {} }}", entries.join(", "))
}

/// A name as a key: bare where TOML allows it.
fn key(name: &str) -> String {
    let is_bare = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
    if !name.is_empty() && name.bytes().all(is_bare) { name.to_string() } else { quoted(name) }
}

fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for character in text.chars() {
        match character {
            '"' | '\\' => quoted.extend(['\\', character]),
            control if control.is_control() => quoted += &format!("\\u{:04X}", u32::from(control)),
            other => quoted.push(other),
        }
    }
    quoted + "\""
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::import::toml;

    fn read(text: &str) -> SceneDescription {
        toml::read_str(Path::new("s.toml"), text).unwrap_or_else(|error| panic!("{error}\n{text}")).description
    }

    const SCENE: &str = "camera = { origin = [0, 0, 4], target = [0, 0.1, 0], fov = 35.5 }
        film = { size = [40, 30], filter = { type = 'tent' } }
        integrator = { type = 'photon-map', k = 20, radius = 0.1 }
        textures = { wood = { type = 'bitmap', file = 'wood.png', wrap = 'mirror' },
                     board = { type = 'checkerboard', color0 = 'wood', color1 = [0.1, 0.2, 0.3] } }
        materials = { floor = { type = 'two-sided', front = { type = 'plastic', reflectance = 'board' } },
                      shiny = { type = 'principled', metallic = 1, base-color = [0.9, 0.6, 0.1] },
                      flint = { type = 'glass', ior = { abbe = [1.7847, 25.8] }, exterior-ior = 'water' },
                      gold = { type = 'conductor', metal = 'Au', roughness = { alpha = 0.2 } } }
        groups = { pair = [{ type = 'sphere', material = 'gold' }, { type = 'cube', material = { type = 'mirror' } }] }
        lights = [{ type = 'sky', sun-direction = [1, 1, 0] }, { type = 'point', position = [0, 1, 0], power = 3 }]
        shapes = [{ type = 'quad', corner = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0], material = 'floor',
                    emission = { radiance = 'wood', scale = 3 } },
                  { type = 'instance', group = 'pair', transform = [{ translate = [1, 2, 3] }, { scale = 2 }] },
                  { type = 'mesh', file = 'bunny.obj', smooth = true, name = 'bunny' }]";

    #[test]
    fn a_scene_says_the_same_after_a_round_trip() {
        let first = read(SCENE);
        let written = text(&first).expect("a scene");
        assert_eq!(read(&written), first, "{written}");
        assert!(!written.contains("nearest") && !written.contains("max-bounces"), "defaults are left out: {written}");
    }

    #[test]
    fn it_looks_as_people_write_it() {
        let written = text(&read(SCENE)).expect("a scene");
        let lamp = "[[lights]]\ntype = \"point\"\nposition = [0.0, 1.0, 0.0]\npower = 3.0\n";
        let gold = "gold = { type = \"conductor\", metal = \"Au\", roughness = { alpha = 0.2 } }\n";
        for part in [lamp, gold, "size = [40, 30]\n", "filter = { type = \"tent\" }\n"] {
            assert!(written.contains(part), "no {part} in\n{written}");
        }
    }

    #[test]
    fn names_may_hold_anything() {
        let mut scene = read(SCENE);
        let odd = "a \"b\" \\ = [c] # \n\u{7f}ä 💡";
        scene.shapes[0].name = Some(odd.into());
        let gold = scene.materials.remove("gold").expect("gold");
        scene.materials.insert(odd.into(), gold.clone());
        scene.materials.insert(String::new(), gold);
        assert_eq!(read(&text(&scene).expect("a scene")), scene);
    }

    #[test]
    fn what_toml_cannot_hold_is_told() {
        let mut scene = read(SCENE);
        scene.render.seed = u64::MAX;
        assert_eq!(text(&scene), None, "TOML's whole numbers have 63 bits");
        let mut scene = read(SCENE);
        scene.camera.as_mut().expect("a camera").aperture_radius = f32::NAN;
        assert_eq!(text(&scene), None);
    }

    proptest::proptest! {
        #[test]
        fn numbers_keep_every_bit(bits: [u32; 3]) {
            let origin = bits.map(f32::from_bits);
            proptest::prop_assume!(origin.iter().all(|value| value.is_finite()));
            let mut scene = read(SCENE);
            scene.camera.as_mut().expect("a camera").origin = origin;
            let read = read(&text(&scene).expect("a scene")).camera.expect("a camera").origin;
            proptest::prop_assert_eq!(read.map(f32::to_bits), origin.map(f32::to_bits));
        }
    }
}
