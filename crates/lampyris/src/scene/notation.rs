//! How people write a description: a tree of TOML values, checked against the [`Form`]s of the schema so that
//! every fault is told in the user's words at its own place, then turned into what serde reads.
//!
//! The turn: where a description has an enum, people write `{ type = "x", ... }` and serde reads
//! `{ x = { ... } }`, and the keys of a shape's geometry move into a table of their own.

mod words;
mod write;

use std::ops::Range;

use serde::Deserialize;
use serde::de::IntoDeserializer;
use toml::Spanned;
use toml::de::{DeArray, DeString, DeTable, DeValue};

use super::schema::{Fields, Form, Node, Tagged};
use crate::error::{Error, did_you_mean};
use words::{article, expected, found, listed, quoted};
pub(crate) use write::text;

/// What is wrong with a text, and which bytes of it.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) error: Error,
    pub(crate) span: Range<usize>,
}

impl Fault {
    fn new(span: Range<usize>, message: impl Into<String>) -> Fault {
        Fault { error: Error::new(message), span }
    }

    fn hint(self, hint: impl Into<String>) -> Fault {
        Fault { error: self.error.with_hint(hint), ..self }
    }
}

/// Reads `value`, which stands at the key path `path` of a scene and must have the form of `node`.
/// `note` is told where each table, list and value stands, by key path.
pub(crate) fn read<'i, T: Deserialize<'i>>(
    node: Node<'_>,
    path: &str,
    value: Spanned<DeValue<'i>>,
    note: &mut dyn FnMut(&str, Range<usize>),
) -> Result<T, Fault> {
    let whole = value.span();
    let value = Reader { note }.value(node, path, value)?;
    T::deserialize(value.into_deserializer())
        .map_err(|error| Fault::new(error.span().unwrap_or(whole), error.message().trim()))
}

struct Reader<'n> {
    note: &'n mut dyn FnMut(&str, Range<usize>),
}

type Entries<'i> = Vec<(Spanned<DeString<'i>>, Spanned<DeValue<'i>>)>;

/// The entries of a table as they stand in the file, so that the first fault is the first to be told.
fn in_order<'i>(table: DeTable<'i>) -> Entries<'i> {
    let mut entries: Entries = table.into_iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    entries
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_string() } else { format!("{path}.{key}") }
}

/// What messages call the thing at `path`.
fn name(path: &str) -> &str {
    if path.is_empty() { "the scene" } else { path.rsplit('.').next().unwrap_or(path) }
}

impl Reader<'_> {
    fn value<'i>(
        &mut self,
        node: Node<'_>,
        path: &str,
        value: Spanned<DeValue<'i>>,
    ) -> Result<Spanned<DeValue<'i>>, Fault> {
        let span = value.span();
        // The elements of a list of numbers have no need of a place each.
        if !path.ends_with(']') || value.get_ref().is_table() {
            (self.note)(path, span.clone());
        }
        let form = node.form();
        let value = match (form, value.into_inner()) {
            (Form::Table(fields), DeValue::Table(table)) => {
                let read = self.fields(&[(fields, "")], name(path), path, in_order(table))?;
                complete(fields, name(path), &read[0], &span)?;
                DeValue::Table(read.into_iter().flatten().collect())
            }
            (Form::Tagged(tagged), DeValue::Table(table)) => self.tagged(&tagged, path, &span, table)?,
            (Form::NameOr(thing) | Form::Ior(thing), table @ DeValue::Table(_)) => {
                return self.value(thing, path, Spanned::new(span, table));
            }
            (Form::Step(steps), DeValue::Table(table)) => self.step(&steps, path, &span, table)?,
            (Form::Named(item), DeValue::Table(table)) => {
                let mut read = DeTable::new();
                for (key, value) in in_order(table) {
                    let value = self.value(item, &join(path, key.get_ref()), value)?;
                    read.insert(key, value);
                }
                DeValue::Table(read)
            }
            (Form::List(item, length), DeValue::Array(items)) if length.is_none_or(|length| length == items.len()) => {
                DeValue::Array(self.items(item, path, items)?)
            }
            (form, value) if words::fits(&form, &value) => value,
            (form, value) => return Err(mismatch(&form, path, &value, span)),
        };
        Ok(Spanned::new(span, value))
    }

    fn items<'i>(&mut self, item: Node<'_>, path: &str, items: DeArray<'i>) -> Result<DeArray<'i>, Fault> {
        items
            .into_iter()
            .enumerate()
            .map(|(index, value)| self.value(item, &format!("{path}[{index}]"), value))
            .collect()
    }

    /// Reads `entries` as the keys of one of the `tables`, each of which comes with what serde knows it under.
    fn fields<'i>(
        &mut self,
        tables: &[(Fields<'_>, &str)],
        owner: &str,
        path: &str,
        entries: Entries<'i>,
    ) -> Result<Vec<DeTable<'i>>, Fault> {
        let mut read = vec![DeTable::new(); tables.len()];
        for (key, value) in entries {
            let home =
                tables.iter().enumerate().find_map(|(index, (fields, _))| Some((index, fields.get(key.get_ref())?)));
            let Some((index, node)) = home else {
                let keys: Vec<&str> = tables.iter().flat_map(|(fields, _)| fields.keys()).collect();
                return Err(unknown("key", &key, &format!(" in {owner}"), &keys));
            };
            let value = self.value(node, &join(path, key.get_ref()), value)?;
            read[index].insert(key, value);
        }
        Ok(read)
    }

    /// Turns `{ type = "x", ... }` into `{ x = { ... } }`.
    fn tagged<'i>(
        &mut self,
        tagged: &Tagged<'_>,
        path: &str,
        span: &Range<usize>,
        mut table: DeTable<'i>,
    ) -> Result<DeValue<'i>, Fault> {
        let types: Vec<&str> = tagged.variants.iter().map(|(name, _)| *name).collect();
        let tag = match (table.remove("type"), tagged.default) {
            (Some(tag), _) => {
                let at = tag.span();
                (self.note)(&join(path, "type"), at.clone());
                match tag.into_inner() {
                    DeValue::String(name) => Spanned::new(at, name),
                    other => return Err(mismatch(&Form::Word(types), &join(path, "type"), &other, at)),
                }
            }
            (None, Some(default)) => Spanned::new(span.clone(), default.to_string().into()),
            (None, None) => {
                let fault = Fault::new(span.clone(), format!("{} without 'type'", article(&tagged.noun)));
                return Err(fault.hint(format!("the types are {}", listed(&types, "and"))));
            }
        };
        let Some((known, own)) = tagged.variant(tag.get_ref()) else {
            return Err(unknown(&format!("{} type", tagged.noun), &tag, "", &types));
        };
        let mut tables = vec![(own, known)];
        tables.extend(tagged.shared);
        let mut read = self.fields(&tables, known, path, in_order(table))?;
        complete(own, known, &read[0], span)?;
        let around = read.get_mut(1).map(std::mem::take);
        let inner = DeTable::from_iter([(tag, Spanned::new(span.clone(), DeValue::Table(read.swap_remove(0))))]);
        Ok(DeValue::Table(match (around, tagged.shared) {
            (Some(mut around), Some((_, home))) => {
                let home = Spanned::new(span.clone(), home.into());
                around.insert(home, Spanned::new(span.clone(), DeValue::Table(inner)));
                around
            }
            _ => inner,
        }))
    }

    fn step<'i>(
        &mut self,
        steps: &[(&str, Node<'_>)],
        path: &str,
        span: &Range<usize>,
        table: DeTable<'i>,
    ) -> Result<DeValue<'i>, Fault> {
        let keys: Vec<&str> = steps.iter().map(|(key, _)| *key).collect();
        let mut read = DeTable::new();
        for (key, value) in in_order(table) {
            let Some((_, node)) = steps.iter().find(|(known, _)| known == key.get_ref()) else {
                return Err(unknown("key", &key, &format!(" in {}", name(path)), &keys));
            };
            let value = self.value(*node, &join(path, key.get_ref()), value)?;
            read.insert(key, value);
        }
        match read.len() {
            1 => Ok(DeValue::Table(read)),
            count => Err(Fault::new(span.clone(), format!("'{}' must have one key, not {count}", name(path)))
                .hint(format!("it is one of {}", listed(&keys, "or")))),
        }
    }
}

/// An unknown `word` where one of `known` belongs.
fn unknown(kind: &str, word: &Spanned<DeString<'_>>, place: &str, known: &[&str]) -> Fault {
    let fault = Fault::new(word.span(), format!("unknown {kind} '{}'{place}", words::short(word.get_ref())));
    match (did_you_mean(word.get_ref(), known.iter().copied()), kind) {
        (Some(near), _) => fault.hint(format!("did you mean '{near}'?")),
        (None, "key") => fault.hint(format!("the keys are {}", listed(known, "and"))),
        (None, _) => fault.hint(format!("the types are {}", listed(known, "and"))),
    }
}

/// A fault if a key of `fields` that must be there is not.
fn complete(fields: Fields<'_>, owner: &str, read: &DeTable<'_>, span: &Range<usize>) -> Result<(), Fault> {
    let needed = || fields.required().filter(|key| *key != "type");
    match needed().find(|key| !read.contains_key(*key)) {
        None => Ok(()),
        Some(missing) => Err(Fault::new(span.clone(), format!("missing key '{missing}' in {owner}")).hint(format!(
            "{} needs {}",
            article(owner),
            quoted(&needed().collect::<Vec<_>>(), "and")
        ))),
    }
}

/// The value has not the form.
fn mismatch(form: &Form<'_>, path: &str, value: &DeValue<'_>, span: Range<usize>) -> Fault {
    let quote = if path.is_empty() { "" } else { "'" };
    let message = format!("{quote}{}{quote} must be {}, not {}", name(path), expected(form), found(form, value));
    let fault = Fault::new(span, message);
    match (form, value) {
        (Form::List(item, None), DeValue::Table(_)) if !matches!(item.form(), Form::Step(_)) => {
            fault.hint(format!("write [[{path}]] with two brackets"))
        }
        (Form::Word(known), DeValue::String(word)) => match did_you_mean(word, known.iter().copied()) {
            Some(near) => fault.hint(format!("did you mean '{near}'?")),
            None => fault,
        },
        (Form::Whole(_), DeValue::Float(number)) => match number.as_str().parse::<f64>() {
            Ok(number) if number.fract() == 0.0 && (0.0..1e15).contains(&number) => {
                fault.hint(format!("write it as {number:.0}"))
            }
            _ => fault,
        },
        _ => fault,
    }
}
