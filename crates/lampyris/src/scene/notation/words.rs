//! Values and forms in the words of a user.

use toml::de::{DeInteger, DeValue};

use crate::scene::description::Color;
use crate::scene::schema::Form;

/// Whether a value without parts, or a colour, has the form.
pub(super) fn fits(form: &Form<'_>, value: &DeValue<'_>) -> bool {
    match (form, value) {
        (
            Form::Number | Form::OneOrThree | Form::Color | Form::Paint | Form::Ior(_),
            DeValue::Integer(_) | DeValue::Float(_),
        ) => is_number(value),
        (Form::Whole(most), DeValue::Integer(number)) => whole(number).is_some_and(|number| number <= *most),
        (Form::Boolean, DeValue::Boolean(_)) | (Form::Text | Form::NameOr(_) | Form::Ior(_), DeValue::String(_)) => {
            true
        }
        (Form::Word(words), DeValue::String(word)) => words.contains(&&**word),
        (Form::Paint, DeValue::String(name)) if !name.starts_with('#') => true,
        (Form::Color | Form::Paint, DeValue::String(hex)) => hex.starts_with('#') && Color::from_hex(hex).is_some(),
        (Form::OneOrThree | Form::Color | Form::Paint, DeValue::Array(channels)) => {
            channels.len() == 3 && channels.iter().all(|channel| is_number(channel.get_ref()))
        }
        _ => false,
    }
}

/// Whether it is a number that a scene can hold: finite in 32 bits. Infinity and NaN have no use in a scene and
/// would only come out as black pixels.
fn is_number(value: &DeValue<'_>) -> bool {
    match value {
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix()).is_ok(),
        DeValue::Float(number) => number.as_str().parse::<f64>().is_ok_and(|number| (number as f32).is_finite()),
        _ => false,
    }
}

fn whole(number: &DeInteger<'_>) -> Option<u64> {
    u64::from_str_radix(number.as_str(), number.radix()).ok()
}

/// What the form asks for.
pub(super) fn expected(form: &Form<'_>) -> String {
    match form {
        Form::Table(_) | Form::Named(_) => "a table".into(),
        Form::Tagged(tagged) => match tagged.default {
            Some(_) => "a table".into(),
            None => "a table with a 'type'".into(),
        },
        Form::Step(steps) => {
            let keys: Vec<&str> = steps.iter().map(|(key, _)| *key).collect();
            format!("a table with one of the keys {}", quoted(&keys, "or"))
        }
        Form::NameOr(thing) => match thing.form() {
            Form::Tagged(tagged) => format!("the name of a {0} or a {0} in place", tagged.noun),
            _ => "a name".into(),
        },
        Form::List(item, length) => match (item.form(), length) {
            (Form::Number, Some(length)) => format!("a list of {length} numbers"),
            (Form::Whole(_), Some(length)) => format!("a list of {length} whole numbers"),
            _ => "a list".into(),
        },
        Form::Number => "a number".into(),
        Form::OneOrThree => "a number or three numbers".into(),
        Form::Whole(most) if *most == u64::from(u32::MAX) => format!("a whole number from 0 to {most}"),
        Form::Whole(_) => "a whole number from 0".into(),
        Form::Boolean => "true or false".into(),
        Form::Text => "a text".into(),
        Form::Word(words) => quoted(words, "or"),
        Form::Color => "a number, three numbers, or \"#rrggbb\"".into(),
        Form::Ior(formula) => format!("a number, the name of a substance, or {}", expected(&formula.form())),
        Form::Paint => "a number, three numbers, \"#rrggbb\", or the name of a texture".into(),
    }
}

/// What stands there instead.
pub(super) fn found(form: &Form<'_>, value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => match form {
            Form::Word(_) => format!("'{}'", short(text)),
            _ => format!("the text \"{}\"", short(text)),
        },
        DeValue::Integer(number) => short(&number.to_string()),
        DeValue::Float(number) => short(number.as_str()),
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Datetime(_) => "a date".into(),
        DeValue::Array(items) => match (form, items.len()) {
            (Form::List(..), count) => count.to_string(),
            (Form::OneOrThree | Form::Color | Form::Paint, 3) => "a list with other things in it".into(),
            (_, count) => format!("a list of {count}"),
        },
        DeValue::Table(_) => "a table".into(),
    }
}

/// The text, cut where it would fill the screen.
pub(super) fn short(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_string(),
    }
}

/// The word with "a" or "an" before it.
pub(super) fn article(word: &str) -> String {
    let vowel = word.starts_with(['a', 'e', 'i', 'o', 'u']);
    format!("{} {word}", if vowel { "an" } else { "a" })
}

/// `a, b or c`.
pub(super) fn listed(words: &[&str], before_last: &str) -> String {
    match words {
        [] => "none".into(),
        [only] => (*only).to_string(),
        [rest @ .., last] => format!("{} {before_last} {last}", rest.join(", ")),
    }
}

/// `'a', 'b' or 'c'`.
pub(super) fn quoted(words: &[&str], before_last: &str) -> String {
    let words: Vec<String> = words.iter().map(|word| format!("'{word}'")).collect();
    listed(&words.iter().map(String::as_str).collect::<Vec<_>>(), before_last)
}
