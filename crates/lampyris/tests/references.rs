//! What the code and the book cite exists: works in `docs/references.bib`, sections in `docs/theory.md`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// A work by its authors' surnames, as far as they are named, and its year.
#[derive(Debug, PartialEq)]
struct Citation {
    surnames: Vec<String>,
    year: String,
}

/// A file of the repository with what it says to people: its comments, or for the book all of it.
struct Prose {
    file: PathBuf,
    text: String,
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn files_below(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of the repository") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files.extend(files_below(&path, ending));
        } else if path.extension().is_some_and(|found| found == ending) {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// Of a source file the comments, on one line each so that none is cut in two.
fn comments(source: &str) -> String {
    let comment = |line: &str| {
        let (_, comment) = line.split_once("//")?;
        Some(comment.trim_start_matches(['/', '!']).trim().to_string() + " ")
    };
    source.lines().map(|line| comment(line).unwrap_or_else(|| "\n".to_string())).collect()
}

fn prose() -> Vec<Prose> {
    let read = |file: PathBuf, prepare: fn(&str) -> String| {
        let text = prepare(&fs::read_to_string(&file).expect("a text file"));
        Prose { file, text }
    };
    let this_file = Path::new(file!()).file_name();
    let sources = files_below(&repository().join("crates"), "rs");
    let sources = sources.into_iter().filter(|file| file.file_name() != this_file);
    let book = files_below(&repository().join("docs"), "md");
    let mut prose: Vec<Prose> = sources.map(|file| read(file, comments)).collect();
    prose.extend(book.into_iter().map(|file| read(file, |text| text.replace('\n', " "))));
    prose
}

/// The citations in `text`: brackets that begin with surnames and a year, such as `[Knaus & Zwicker 2011, eq. 20]`.
fn citations(text: &str) -> Vec<Citation> {
    text.split('[').skip(1).filter_map(|after| citation(after.split(']').next()?)).collect()
}

fn citation(bracket: &str) -> Option<Citation> {
    let mut surnames = Vec::new();
    for word in bracket.split_whitespace() {
        let word = word.trim_end_matches([',', ';', ':']);
        if word.len() == 4 && word.chars().all(|c| c.is_ascii_digit()) {
            return (!surnames.is_empty()).then(|| Citation { surnames, year: word.to_string() });
        }
        match word {
            "&" | "and" | "et" | "al." => {}
            name if name.chars().next()?.is_uppercase() => surnames.push(name.to_string()),
            _ => return None,
        }
    }
    None
}

/// An entry of the bibliography.
struct Work {
    authors: String,
    year: String,
}

impl Work {
    fn is_meant_by(&self, citation: &Citation) -> bool {
        let surname = |name: &String| self.authors.split(" and ").any(|author| author.split(',').next() == Some(name));
        self.year == citation.year && citation.surnames.iter().all(surname)
    }
}

fn bibliography() -> Vec<Work> {
    let text = fs::read_to_string(repository().join("docs/references.bib")).expect("the bibliography");
    let field = |entry: &str, name: &str| {
        let line = entry.lines().find(|line| line.trim_start().starts_with(name))?;
        Some(line.split_once('{')?.1.trim_end_matches([',', '}']).to_string())
    };
    let entries = text.split("\n@").skip(1);
    entries
        .map(|entry| Work {
            authors: field(entry, "author").expect("an author in every entry"),
            year: field(entry, "year").expect("a year in every entry"),
        })
        .collect()
}

/// The numbers of the sections that `text` names as `theory §5.2`.
fn sections_named(text: &str) -> Vec<String> {
    let number = |after: &str| {
        let end = after.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(after.len());
        after[..end].trim_end_matches('.').to_string()
    };
    text.split("theory §").skip(1).map(number).collect()
}

fn sections_of_the_theory() -> BTreeSet<String> {
    let text = fs::read_to_string(repository().join("docs/theory.md")).expect("the theory");
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings
        .filter_map(|heading| Some(heading.trim_start_matches('#').split_whitespace().next()?.to_string()))
        .collect()
}

#[test]
fn every_citation_is_in_the_bibliography() {
    let works = bibliography();
    for Prose { file, text } in prose() {
        for citation in citations(&text) {
            let found = works.iter().filter(|work| work.is_meant_by(&citation)).count();
            assert_eq!(found, 1, "{}: {citation:?} must mean one entry of docs/references.bib", file.display());
        }
    }
}

#[test]
fn every_work_in_the_bibliography_is_cited() {
    let citations: Vec<Citation> = prose().iter().flat_map(|prose| citations(&prose.text)).collect();
    for work in bibliography() {
        let cited = citations.iter().any(|citation| work.is_meant_by(citation));
        assert!(cited, "nobody cites {} {}", work.authors, work.year);
    }
}

#[test]
fn every_section_of_the_theory_that_the_code_names_exists() {
    let sections = sections_of_the_theory();
    let mut count = 0;
    for Prose { file, text } in prose() {
        for section in sections_named(&text) {
            assert!(sections.contains(&section), "{}: there is no theory §{section}", file.display());
            count += 1;
        }
    }
    assert!(count > 10, "only {count} sections are named: the search finds nothing");
}

#[test]
fn a_citation_is_told_from_other_brackets() {
    let text = "[Knaus & Zwicker 2011, eq. 20] [Duff et al. 2017] [eq. 3] [Malley's method] [`Film`] [0, 1] [2011]";
    let expected = [("Knaus Zwicker", "2011"), ("Duff", "2017")].map(|(surnames, year)| Citation {
        surnames: surnames.split(' ').map(str::to_string).collect(),
        year: year.to_string(),
    });
    assert_eq!(citations(text), expected);
}

#[test]
fn a_citation_may_run_over_two_lines_of_a_comment() {
    let source = "/// As in [Reinhard\n/// 2002, eq. 1].\nlet x = values[1];";
    assert_eq!(citations(&comments(source)).len(), 1);
}
