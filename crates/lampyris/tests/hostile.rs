//! Files that want to do harm, and those that the fuzzer starts from: whatever a file says, a reader answers with a scene
//! or a sentence.

#[path = "common/readers.rs"]
mod readers;

use std::fs;
use std::path::{Path, PathBuf};

use self::readers::{READERS, Workbench};

#[test]
fn no_file_of_the_fuzzers_corpus_does_harm() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    if !corpus.is_dir() {
        eprintln!("left out: there is no folder {}", corpus.display());
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let bench = Workbench::new(folder.path()).expect("a folder to write to");
    for reader in READERS {
        for file in files(&corpus.join(reader)) {
            let answer = bench.feed(reader, &fs::read(&file).expect("a file"));
            println!("{}: {}", file.display(), answer.err().map_or("good".to_string(), |error| error.to_string()));
        }
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    entries.map(|entry| entry.expect("an entry").path()).collect()
}
