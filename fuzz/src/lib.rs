//! What all fuzz targets share. See CONTRIBUTING.md for how to run them.

#[path = "../../crates/lampyris/tests/common/readers.rs"]
pub mod readers;

mod ceiling;
mod patience;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

pub use libfuzzer_sys::fuzz_target;

use self::ceiling::Ceiling;
use self::readers::Workbench;

#[global_allocator]
static MEMORY: Ceiling = Ceiling::new(512 << 20);

/// A fuzz target that feeds the reader of this name.
#[macro_export]
macro_rules! target {
    ($reader:literal) => {
        $crate::fuzz_target!(|bytes: &[u8]| $crate::feed($reader, bytes));
    };
}

/// Feeds `bytes` to `reader`, whose answer must be whole sentences.
pub fn feed(reader: &str, bytes: &[u8]) {
    static BENCH: OnceLock<Workbench> = OnceLock::new();
    let bench = BENCH.get_or_init(|| {
        // One thread, so that a run can be repeated and what it covers is seen.
        rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().expect("the first pool");
        patience::watch();
        Workbench::new(&folder()).expect("a folder to write to")
    });
    patience::begin();
    if let Err(error) = bench.feed(reader, bytes) {
        assert!(!error.message.is_empty());
    }
}

/// A folder of this process's own, in memory where there is such a thing.
fn folder() -> PathBuf {
    let memory = Path::new("/dev/shm");
    let parent = if memory.is_dir() { memory.to_path_buf() } else { std::env::temp_dir() };
    let folder = parent.join(format!("lampyris-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder to write to");
    folder
}
