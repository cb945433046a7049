//! The other way: a description as people would write it. What says no more than the default is left out.

use serde_json::Value;
use toml::{Table, Value as Written};

use super::super::description::SceneDescription;
use super::super::schema::{Fields, Form, Node, Schema};

/// The text of a scene file in TOML that says what `description` says; none if it holds triangles, which a file holds
/// only by the names of other files, or a number that is not finite.
pub(crate) fn text(description: &SceneDescription) -> Option<String> {
    let schema = Schema::of_scenes();
    let value = serde_json::to_value(description).ok()?;
    let Written::Table(table) = written(schema.scene(), &value)? else { return None };
    toml::to_string_pretty(&table).ok()
}

fn written(node: Node<'_>, value: &Value) -> Option<Written> {
    match (node.form(), value) {
        (Form::Table(fields), Value::Object(keys)) => {
            let mut table = Table::new();
            add(fields, keys, &mut table)?;
            Some(Written::Table(table))
        }
        (Form::Tagged(tagged), Value::Object(keys)) => {
            let mut table = Table::new();
            let inner = match &tagged.shared {
                Some((shared, own)) => {
                    add(*shared, keys, &mut table)?;
                    keys.get(*own)?.as_object()?
                }
                None => keys,
            };
            let (name, own) = inner.iter().next()?;
            let (_, fields) = tagged.variant(name)?;
            table.insert("type".into(), Written::String(name.clone()));
            add(fields, own.as_object()?, &mut table)?;
            Some(Written::Table(table))
        }
        (Form::Named(item), Value::Object(names)) => {
            let items = names.iter().map(|(name, value)| Some((name.clone(), written(item, value)?)));
            items.collect::<Option<Table>>().map(Written::Table)
        }
        (Form::NameOr(thing), Value::Object(_)) => written(thing, value),
        (Form::List(item, _), Value::Array(values)) => {
            values.iter().map(|value| written(item, value)).collect::<Option<Vec<_>>>().map(Written::Array)
        }
        (_, value) => plain(value),
    }
}

/// Adds those of `keys` that the table may have, but for what is absent, empty or the default.
fn add(fields: Fields<'_>, keys: &serde_json::Map<String, Value>, table: &mut Table) -> Option<()> {
    for key in fields.keys() {
        let (Some(node), Some(value)) = (fields.get(key), keys.get(key)) else { continue };
        let empty = match value {
            Value::Null => true,
            Value::Array(items) => items.is_empty(),
            Value::Object(names) => names.is_empty(),
            _ => false,
        };
        if !empty && node.default() != Some(value) {
            table.insert(key.to_string(), written(node, value)?);
        }
    }
    Some(())
}

fn plain(value: &Value) -> Option<Written> {
    match value {
        Value::Bool(flag) => Some(Written::Boolean(*flag)),
        Value::String(text) => Some(Written::String(text.clone())),
        Value::Array(items) => items.iter().map(plain).collect::<Option<Vec<_>>>().map(Written::Array),
        Value::Object(keys) => {
            let items = keys.iter().map(|(key, value)| Some((key.clone(), plain(value)?)));
            items.collect::<Option<Table>>().map(Written::Table)
        }
        Value::Number(number) => match number.as_i64() {
            Some(whole) => Some(Written::Integer(whole)),
            // Numbers of a description have single precision: the shortest text that says so, not all of its digits.
            None => (number.as_f64()? as f32).to_string().parse().ok().map(Written::Float),
        },
        Value::Null => None,
    }
}
