//! How much memory a film may take, and where it is kept if it takes more.

use std::path::Path;

use lampyris::film::Storage;

/// Of memory that nobody uses, a film takes no more than this share: passes need the rest, and so does the system for files.
const SHARE: u64 = 2;

/// What a film may take where the system does not say how much memory there is, in bytes.
const OTHERWISE: u64 = 4 << 30;

/// Where time bins of so many bytes are kept: in memory if they fit this budget, else in a file beside this one.
pub fn storage(bytes: u64, budget: u64, beside: &Path) -> Storage {
    if bytes <= budget {
        return Storage::Memory;
    }
    match beside.parent() {
        Some(folder) if folder != Path::new("") => Storage::File(folder.into()),
        _ => Storage::File(".".into()),
    }
}

/// What a film may take unless the user says otherwise, in bytes.
pub fn free() -> u64 {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let system = read("/proc/meminfo").and_then(|text| available_in(&text));
    // Of a container, which may have less than the machine.
    let limits = ["/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"];
    let container = limits.into_iter().filter_map(|path| read(path)?.trim().parse().ok()).min();
    system.into_iter().chain(container).min().map_or(OTHERWISE, |bytes: u64| bytes / SHARE)
}

fn available_in(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_available_is_read_in_bytes() {
        assert_eq!(available_in("MemTotal: 9 kB\nMemAvailable:       2048 kB\n"), Some(2 << 20));
        assert_eq!(available_in("MemTotal: 9 kB\n"), None);
    }

    #[test]
    fn what_does_not_fit_is_kept_beside_the_file() {
        let storage = |bytes, path: &str| storage(bytes, 100, path.as_ref());
        assert_eq!(storage(100, "a/b.npy"), Storage::Memory);
        assert_eq!(storage(101, "a/b.npy"), Storage::File("a".into()));
        assert_eq!(storage(101, "b.npy"), Storage::File(".".into()));
    }
}
