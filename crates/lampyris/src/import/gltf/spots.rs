//! Where the parts of a JSON text stand.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::error::{Error, Place};

/// The places of the keys of a JSON object and of the elements of its lists: `meshes`, `meshes[2]`. All is found in
/// one reading, however many are asked for.
pub(super) struct Spots {
    file: PathBuf,
    spots: HashMap<String, Place>,
}

impl Spots {
    /// Of no text: errors name the file alone.
    pub(super) fn none(file: &Path) -> Spots {
        Spots { file: file.to_path_buf(), spots: HashMap::new() }
    }

    /// Of `text`, which must be a JSON object.
    pub(super) fn of(file: &Path, text: &str) -> Spots {
        let mut spots = Spots::none(file);
        spots.scan(text);
        spots
    }

    /// The place of `path`, such as `meshes[2].primitives[0]`, or rather of its beginning.
    pub(super) fn find(&self, path: &str) -> Option<Place> {
        let end = path.find('.').unwrap_or(path.len());
        let key = &path[..path.find('[').unwrap_or(end).min(end)];
        self.spots.get(&path[..end]).or_else(|| self.spots.get(key)).cloned()
    }

    /// An error about what stands at `path`.
    pub(super) fn fault(&self, path: &str, message: impl AsRef<str>) -> Error {
        let error = Error::new(format!("{path}: {}", message.as_ref()));
        self.placed(path, error)
    }

    /// The error with the place of `path`.
    pub(super) fn placed(&self, path: &str, error: Error) -> Error {
        match self.find(path) {
            Some(place) => error.with_place(place),
            None => error.with_file(&self.file),
        }
    }

    fn scan(&mut self, text: &str) {
        let bytes = text.as_bytes();
        let (mut line, mut column) = (1, 1);
        let mut depth = 0_usize;
        // The key of the object that we are in, the number of the element of its list, and whether we wait for them.
        let (mut key, mut awaits_key) = ("", true);
        let (mut element, mut awaits_element) = (None, false);
        let mut at = 0;
        while at < bytes.len() {
            let start = at;
            at = if bytes[at] == b'"' { after_string(bytes, at) } else { at + 1 };
            let is_value = !matches!(bytes[start], b' ' | b'\t' | b'\r' | b'\n' | b',' | b':' | b']' | b'}');
            let place = || Place { file: self.file.clone(), line, column, span: start..at };
            if depth == 1 && awaits_key && bytes[start] == b'"' {
                key = text[start..at].trim_matches('"');
                awaits_key = false;
                self.spots.insert(key.to_string(), place());
            } else if let (2, true, Some(number)) = (depth, awaits_element && is_value, element) {
                awaits_element = false;
                self.spots.insert(format!("{key}[{number}]"), place());
            }
            match bytes[start] {
                b'[' if depth == 1 => (element, awaits_element, depth) = (Some(0), true, 2),
                b'{' | b'[' => depth += 1,
                b'}' | b']' => {
                    depth = depth.saturating_sub(1);
                    element = element.filter(|_| depth > 1);
                }
                b',' if depth == 1 => awaits_key = true,
                b',' if depth == 2 => {
                    element = element.map(|number: usize| number + 1);
                    awaits_element = true;
                }
                _ => {}
            }
            if bytes[start] == b'\n' {
                (line, column) = (line + 1, 1);
            } else {
                // Bytes that begin a character.
                column += bytes[start..at].iter().filter(|&&byte| byte & 0xc0 != 0x80).count();
            }
        }
    }
}

/// Where the string that begins at `start` is over.
fn after_string(bytes: &[u8], start: usize) -> usize {
    let mut at = start + 1;
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'"' => return at + 1,
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
    bytes.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(text: &str, path: &str) -> Option<(usize, usize)> {
        Spots::of(Path::new("a.gltf"), text).find(path).map(|place| (place.line, place.column))
    }

    #[test]
    fn keys_and_elements_have_their_lines_and_columns() {
        let text = "{\"ä\": [1, 2],\n \"meshes\": [{\"x\": [[1], 2]},\n  {}, \"s\"], \"scene\": 0}";
        assert_eq!(place(text, "ä[1]"), Some((1, 11)));
        assert_eq!(place(text, "meshes[0].x[1]"), Some((2, 13)));
        assert_eq!(place(text, "meshes[1]"), Some((3, 3)));
        assert_eq!(place(text, "meshes[2]"), Some((3, 7)));
        assert_eq!(place(text, "meshes[7].y"), Some((2, 2)));
        assert_eq!(place(text, "scene"), Some((3, 13)));
        assert_eq!(place(text, "x"), None);
    }
}
