//! Files of other people that lie in a folder beside the checkout, for tests. A bare clone has none of them.

use std::path::{Path, PathBuf};

/// A file or folder there; none, said on stderr, where it is not.
#[allow(clippy::print_stderr)]
pub(crate) fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")).join(name);
    if !path.exists() {
        eprintln!("left out: {} is not there", path.display());
        return None;
    }
    Some(path)
}
