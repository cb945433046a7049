//! Links in the book and in the files beside it lead somewhere, and the reference of scene files leaves nothing out.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All pages of the book, and the texts beside it.
fn pages() -> Vec<PathBuf> {
    let mut pages = Vec::new();
    for folder in ["", "docs", "docs/tutorial"] {
        for entry in fs::read_dir(repository().join(folder)).expect("a folder") {
            pages.extend(
                Some(entry.expect("an entry").path()).filter(|path| path.extension().is_some_and(|e| e == "md")),
            );
        }
    }
    pages
}

/// The text without blocks and pieces of code, in which brackets are no links.
fn prose(text: &str) -> String {
    let blocks = text.split("```").step_by(2);
    blocks.flat_map(|block| block.split('`').step_by(2)).collect()
}

/// Where the links and pictures of a page lead.
fn targets(text: &str) -> Vec<String> {
    let ends = |after: &str| after.split_once(')').map(|(target, _)| target.to_string());
    prose(text).split("](").skip(1).filter_map(ends).collect()
}

/// The names by which headings can be linked to, as mdBook and GitHub make them.
fn anchors(text: &str) -> BTreeSet<String> {
    let blocks: String = text.split("```").step_by(2).collect();
    let headings = blocks.lines().filter_map(|line| line.strip_prefix('#'));
    let name = |heading: &str| {
        let heading = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = heading.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(name).collect()
}

#[test]
fn every_link_leads_somewhere() {
    let mut count = 0;
    for page in pages() {
        for target in targets(&read(&page)) {
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            let (file, anchor) = target.split_once('#').unwrap_or((&target, ""));
            let path = if file.is_empty() { page.clone() } else { page.with_file_name(file) };
            assert!(path.exists(), "{}: there is no {target}", page.display());
            let found = anchor.is_empty() || anchors(&read(&path)).contains(anchor);
            assert!(found, "{}: there is no heading {target}", page.display());
            count += 1;
        }
    }
    assert!(count > 50, "only {count} links: the search finds nothing");
}

#[test]
fn every_page_and_picture_of_the_book_is_shown() {
    let linked: BTreeSet<PathBuf> = pages()
        .iter()
        .flat_map(|page| targets(&read(page)).into_iter().map(|target| page.with_file_name(target)))
        .filter_map(|path| path.canonicalize().ok())
        .collect();
    let docs = repository().join("docs");
    for folder in [docs.clone(), docs.join("tutorial"), docs.join("images"), docs.join("images/gallery")] {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path().canonicalize().expect("it is there");
            let is_shown = path.extension().is_some_and(|ending| ["md", "png", "jpg"].iter().any(|e| ending == *e));
            let is_summary = path.ends_with("SUMMARY.md");
            assert!(!is_shown || is_summary || linked.contains(&path), "nothing links to {}", path.display());
        }
    }
}

/// Adds the names of keys, types and words in a schema.
fn names(schema: &Value, found: &mut BTreeSet<String>) {
    match schema {
        Value::Object(keys) => {
            if let Some(Value::Object(properties)) = keys.get("properties") {
                found.extend(properties.keys().cloned());
            }
            found.extend(keys.get("const").and_then(Value::as_str).map(str::to_string));
            keys.values().for_each(|value| names(value, found));
        }
        Value::Array(items) => items.iter().for_each(|item| names(item, found)),
        _ => {}
    }
}

#[test]
fn the_reference_names_every_key_type_and_word_of_a_scene_file() {
    let docs = repository().join("docs");
    let schema: Value = serde_json::from_str(&read(&docs.join("scene.schema.json"))).expect("a schema");
    let mut wanted = BTreeSet::new();
    names(&schema, &mut wanted);
    assert!(wanted.len() > 100, "only {} names: the search finds nothing", wanted.len());
    let page = read(&docs.join("scene-file.md"));
    // Every second piece between backticks is code; of a line such as `{ scale = s }` each word counts.
    let code = page.split('`').skip(1).step_by(2);
    let said: BTreeSet<&str> =
        code.flat_map(|code| code.split(|c: char| !c.is_alphanumeric() && c != '-' && c != '_')).collect();
    let missing: Vec<&String> = wanted.iter().filter(|name| !said.contains(name.as_str())).collect();
    assert!(missing.is_empty(), "docs/scene-file.md says nothing of {missing:?}");
}
