//! The house has floors, and arrows point down: no module may use one above it, nor one beside it but for a reason.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The floor of each module, as ARCHITECTURE.md has them.
const FLOORS: [(&str, u32); 25] = [
    ("math", 0),
    ("error", 0),
    ("image", 0),
    ("observer", 0),
    ("spectrum", 1),
    ("sampler", 1),
    ("transient", 2),
    ("geometry", 2),
    ("texture", 3),
    ("material", 3),
    ("light", 3),
    ("camera", 3),
    ("scene", 4),
    ("transport", 5),
    ("photon", 6),
    ("film", 6),
    ("integrator", 7),
    ("render", 8),
    ("checkpoint", 8),
    ("import", 8),
    ("output", 8),
    ("tonemap", 8),
    ("compare", 8),
    ("denoise", 8),
    ("medium", 3),
];

/// Uses on one floor, each with its reason.
const SIDEWAYS: [(&str, &str, &str); 7] = [
    ("render", "checkpoint", "a render can be kept and gone on with"),
    ("output", "import", "a scene is written with the files that lay inside its source"),
    ("light", "texture", "a projector throws a texture, and the radiance of a lamp can be one"),
    ("material", "texture", "a material looks its textures up"),
    ("import", "output", "textures are pictures, and the readers of pictures stand beside their writers"),
    ("output", "tonemap", "files of 8 bits need a curve"),
    ("compare", "tonemap", "what the eye compares has been through a curve"),
];

fn floor(module: &str) -> u32 {
    let known = FLOORS.iter().find(|(name, _)| *name == module);
    known.unwrap_or_else(|| panic!("the module '{module}' has no floor: add it to tests/floors.rs")).1
}

/// All Rust files under a folder.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The code of a file without comments and tests.
fn code(text: &str) -> String {
    let tests = text.find("#[cfg(test)]\nmod tests {").unwrap_or(text.len());
    let without_comment = |line: &str| line.split("//").next().unwrap_or("").to_string();
    text[..tests].lines().map(without_comment).collect::<Vec<_>>().join("\n")
}

/// The modules that a piece of code names by `crate::`, also in braces.
fn used(code: &str) -> BTreeSet<String> {
    let word = |text: &str| text.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut modules = BTreeSet::new();
    for rest in code.split("crate::").skip(1) {
        match rest.strip_prefix('{') {
            Some(list) => {
                let mut depth = 0;
                for part in list.split_inclusive([',', '{', '}']) {
                    if depth == 0 && !word(part).is_empty() {
                        modules.insert(word(part));
                    }
                    depth += i32::from(part.ends_with('{')) - i32::from(part.ends_with('}'));
                    if depth < 0 {
                        break;
                    }
                }
            }
            None => {
                modules.insert(word(rest));
            }
        }
    }
    modules
}

/// What is wrong with a use of `to` in a file of `from`.
fn fault(from: &str, to: &str) -> Option<String> {
    let (above, below) = (floor(from), floor(to));
    let sideways = SIDEWAYS.iter().any(|&(a, b, _)| (a, b) == (from, to));
    if from == to || below < above || (below == above && sideways) {
        return None;
    }
    Some(format!("{from} [{above}] uses {to} [{below}]"))
}

#[test]
fn no_module_uses_one_above_it() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut all = Vec::new();
    files(&source, &mut all);
    assert!(all.len() > 50, "only {} files found", all.len());
    let mut faults = Vec::new();
    for path in all {
        let inside = path.strip_prefix(&source).expect("inside");
        // Tests in files of their own may use what they like.
        let of_tests =
            |part: &std::ffi::OsStr| ["tests", "tests.rs", "shared_tests.rs"].iter().any(|name| part == *name);
        if inside == Path::new("lib.rs") || inside.iter().any(of_tests) {
            continue;
        }
        let first = inside.iter().next().and_then(|part| part.to_str()).expect("a name");
        let module = first.trim_end_matches(".rs");
        let text = fs::read_to_string(&path).expect("a source file");
        let wrong = used(&code(&text)).into_iter().filter_map(|to| fault(module, &to));
        faults.extend(wrong.map(|fault| format!("{}: {fault}", inside.display())));
    }
    assert!(faults.is_empty(), "arrows must point down:\n{}", faults.join("\n"));
}

#[test]
fn the_library_names_every_module_in_order_of_use_and_each_has_a_floor() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).expect("lib.rs");
    let modules: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
    assert!(modules.len() > 15);
    modules.iter().for_each(|module| _ = floor(module));
}

#[test]
fn an_arrow_that_points_up_is_seen_in_all_its_spellings() {
    let names = |text: &str| used(&code(text)).into_iter().collect::<Vec<_>>();
    assert_eq!(names("use crate::scene::Scene; // crate::film\nlet x = crate::math::Frame::new();"), ["math", "scene"]);
    assert_eq!(names("use crate::{light::{Area, Point}, scene};"), ["light", "scene"]);
    assert_eq!(names("fn a() {}\n#[cfg(test)]\nmod tests {\n use crate::render::Render; }"), [""; 0]);
    assert!(fault("light", "scene").is_some() && fault("light", "camera").is_some());
    assert!(fault("scene", "light").is_none() && fault("material", "texture").is_none());
}
