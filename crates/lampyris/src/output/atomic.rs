//! Files that appear whole or not at all.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// Writes `bytes` to `path` so that whoever looks finds the old file or the new one, never a part: they go to a
/// file beside it, which takes the name once it is on the disk, and is removed if anything goes wrong. A file that
/// was there keeps its permissions; a symbolic link stays and its target is replaced. What is no regular file
/// (a pipe, a terminal, `/dev/null`) is written to directly.
///
/// # Errors
/// What the operating system says, as a sentence: no such folder, permission denied, the disk is full.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    write_whole_by(path, |file| file.write_all(bytes))
}

/// [`write_whole`] of bytes that need not be in memory at once: `write` is given the file.
///
/// # Errors
/// As [`write_whole`], and those of `write`.
pub fn write_whole_by(path: &Path, write: impl FnOnce(&mut File) -> io::Result<()>) -> Result<()> {
    check_place(path)?;
    let existing = std::fs::metadata(path).ok();
    let written = match &existing {
        Some(there) if !there.is_file() || is_device_name(path) => write_directly(path, write),
        _ => replace(path, existing.as_ref(), write),
    };
    written.map_err(|error| Error::io(path, "write", &error))
}

/// Finds what would stop [`write_whole`] from writing to `path`: it makes the empty file that would take the name in the
/// end, and removes it again. What is no regular file is not tried.
///
/// # Errors
/// As [`write_whole`], except that a disk may still fill up.
pub fn check_writable(path: &Path) -> Result<()> {
    check_place(path)?;
    if is_device_name(path) && path.exists() || std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        return Ok(());
    }
    let target = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let tried = create_beside(&target).and_then(|(temporary, _)| std::fs::remove_file(temporary));
    tried.map_err(|error| match error.kind() {
        // The folder was there a moment ago; it is one in which nobody can make files, such as /proc.
        ErrorKind::NotFound => {
            let folder = folder_of(&target);
            Error::new(format!("cannot write '{}': no file can be made in '{}'", path.display(), folder.display()))
        }
        _ => Error::io(path, "write", &error),
    })
}

/// What would stop a file from being written to `path`, as far as can be seen without writing.
fn check_place(path: &Path) -> Result<()> {
    let fail = |kind: ErrorKind| Err(Error::io(path, "write", &kind.into()));
    match std::fs::metadata(path) {
        Ok(there) if there.is_dir() => return fail(ErrorKind::IsADirectory),
        Ok(there) if there.permissions().readonly() => return fail(ErrorKind::PermissionDenied),
        Ok(_) => return Ok(()),
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(Error::io(path, "write", &error)),
        Err(_) => {}
    }
    let folder = folder_of(path);
    match std::fs::metadata(&folder) {
        Ok(there) if there.is_dir() => Ok(()),
        Ok(_) => Err(Error::new(format!("cannot write '{}': '{}' is not a folder", path.display(), folder.display()))),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            Err(Error::new(format!("cannot write '{}': there is no folder '{}'", path.display(), folder.display()))
                .with_hint("create it first"))
        }
        Err(error) => Err(Error::io(path, "write", &error)),
    }
}

/// Names such as `/dev/stdout`, which may stand for a regular file that someone else holds open.
fn is_device_name(path: &Path) -> bool {
    path.starts_with("/dev") || path.starts_with("/proc")
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

fn write_directly(path: &Path, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).open(path)?;
    write(&mut file)?;
    file.flush()
}

fn replace(
    path: &Path,
    existing: Option<&Metadata>,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> io::Result<()> {
    // A link keeps its place: its target is what we replace.
    let target = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let (temporary, mut file) = create_beside(&target)?;
    let written = (|| {
        write(&mut file)?;
        if let Some(existing) = existing {
            file.set_permissions(existing.permissions())?;
        }
        file.sync_all()?;
        drop(file);
        std::fs::rename(&temporary, &target)
    })();
    if written.is_err() {
        // The first error is the one to tell; that the rest could not be cleared away adds nothing.
        let _ = std::fs::remove_file(&temporary);
    }
    written
}

/// A new file in the folder of `path`, under a name that nobody else holds.
fn create_beside(path: &Path) -> io::Result<(PathBuf, File)> {
    const MOST_TRIES: u32 = 10_000;
    let folder = folder_of(path);
    for number in 0..MOST_TRIES {
        let temporary = folder.join(format!(".lampyris-{number}.tmp"));
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Ok(file) => return Ok((temporary, file)),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::other("too many unfinished '.lampyris-*.tmp' files lie in its folder"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).expect("the folder is there");
        let mut names: Vec<_> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_replaced_and_nothing_else_stays_behind() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.bin");
        write_whole(&path, b"old, and longer").expect("first");
        write_whole(&path, b"new").expect("second");
        assert_eq!(std::fs::read(&path).expect("there"), b"new");
        assert_eq!(names_in(folder.path()), ["a.bin"]);
    }

    #[test]
    fn what_another_process_is_writing_is_left_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join(".lampyris-0.tmp"), b"theirs").expect("written");
        write_whole(&folder.path().join("a.bin"), b"ours").expect("written");
        assert_eq!(std::fs::read(folder.path().join(".lampyris-0.tmp")).expect("there"), b"theirs");
        assert_eq!(names_in(folder.path()), [".lampyris-0.tmp", "a.bin"]);
    }

    #[test]
    fn a_missing_folder_and_a_folder_in_the_way_are_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let missing = write_whole(&folder.path().join("no/a.bin"), b"x").expect_err("no folder");
        assert!(missing.message.contains("there is no folder"), "{missing}");
        let in_the_way = write_whole(folder.path(), b"x").expect_err("a folder");
        assert!(in_the_way.message.contains("it is a folder"), "{in_the_way}");
        let file = folder.path().join("f");
        std::fs::write(&file, b"").expect("written");
        let through_a_file = write_whole(&file.join("a.bin"), b"x").expect_err("not a folder");
        assert!(through_a_file.message.contains("cannot write"), "{through_a_file}");
    }

    #[test]
    fn a_check_leaves_nothing_behind() {
        let folder = tempfile::tempdir().expect("a folder");
        check_writable(&folder.path().join("a.bin")).expect("a good place");
        assert!(names_in(folder.path()).is_empty());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_that_takes_no_files_is_found_before_the_work() {
        let error = check_writable(Path::new("/proc/a.bin")).expect_err("nobody makes files there");
        assert!(error.message.contains("no file can be made in '/proc'"), "{error}");
        check_writable(Path::new("/dev/null")).expect("takes anything");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_its_target_is_replaced_with_the_permissions_it_had() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().expect("a folder");
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        std::fs::write(&target, b"old").expect("written");
        std::fs::set_permissions(&target, std::fs::Permissions::from_mode(0o640)).expect("set");
        symlink(&target, &link).expect("linked");
        write_whole(&link, b"new").expect("written");
        assert!(std::fs::symlink_metadata(&link).expect("there").file_type().is_symlink());
        assert_eq!(std::fs::read(&target).expect("there"), b"new");
        assert_eq!(std::fs::metadata(&target).expect("there").permissions().mode() & 0o777, 0o640);
    }

    #[cfg(unix)]
    #[test]
    fn a_read_only_file_is_not_replaced() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.bin");
        std::fs::write(&path, b"old").expect("written");
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o444)).expect("set");
        let error = write_whole(&path, b"new").expect_err("read-only");
        assert!(error.message.contains("permission denied"), "{error}");
        assert_eq!(std::fs::read(&path).expect("there"), b"old");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_called_full_and_devices_are_written_directly() {
        let error = write_whole(Path::new("/dev/full"), b"x").expect_err("always full");
        assert!(error.message.contains("the disk is full"), "{error}");
        write_whole(Path::new("/dev/null"), b"x").expect("takes anything");
    }
}
