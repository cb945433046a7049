//! From text to words, strings, brackets.

use super::super::source::{Source, Spot};
use crate::error::{Error, Result};

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A statement, a number, `true` or `false`.
    Word,
    /// Text between quotes, which are not part of the token.
    Text,
    /// `[`
    Open,
    /// `]`
    Close,
}

/// A stretch of the text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token {
    pub kind: Kind,
    pub spot: Spot,
}

/// The token at or after the byte `at` of file number `index`, and where to go on; `None` at the end.
///
/// # Errors
/// A string without its end.
pub(super) fn next(source: &Source, index: usize, at: usize) -> Result<Option<(Token, usize)>> {
    let bytes = source.text.as_bytes();
    let mut start = at;
    loop {
        match bytes.get(start) {
            None => return Ok(None),
            Some(b'#') => start += bytes[start..].iter().take_while(|&&byte| !matches!(byte, b'\n' | b'\r')).count(),
            Some(byte) if is_blank(*byte) => start += 1,
            Some(_) => break,
        }
    }
    let token = |kind, start, end| Token { kind, spot: Spot { source: index, start, end } };
    Ok(Some(match bytes[start] {
        b'[' => (token(Kind::Open, start, start + 1), start + 1),
        b']' => (token(Kind::Close, start, start + 1), start + 1),
        b'"' => {
            let length = text_length(&bytes[start + 1..]).ok_or_else(|| {
                Error::new("the text that begins here has no closing quote on its line")
                    .with_place(source.place(start..start + 1))
            })?;
            (token(Kind::Text, start + 1, start + 1 + length), start + length + 2)
        }
        _ => {
            let ends = |byte: &u8| is_blank(*byte) || matches!(byte, b'"' | b'[' | b']');
            let length = bytes[start..].iter().take_while(|byte| !ends(byte)).count();
            (token(Kind::Word, start, start + length), start + length)
        }
    }))
}

fn is_blank(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

/// Bytes up to the closing quote; none if the line ends before it.
fn text_length(bytes: &[u8]) -> Option<usize> {
    let mut at = 0;
    loop {
        match bytes.get(at)? {
            b'"' => return Some(at),
            b'\n' => return None,
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
}

/// The text of a string, with `\n`, `\"` and the like resolved.
pub(super) fn unescaped(raw: &str) -> String {
    if !raw.contains('\\') {
        return raw.to_string();
    }
    let mut text = String::with_capacity(raw.len());
    let mut characters = raw.chars();
    while let Some(character) = characters.next() {
        let escaped = if character == '\\' { characters.next() } else { None };
        text.push(match escaped {
            Some('n') => '\n',
            Some('t') => '\t',
            Some('r') => '\r',
            Some(other) => other,
            None => character,
        });
    }
    text
}
