//! Where the many numbers of a film live: in memory, or in a file that is read and written as if it were memory.
//!
//! Which of its pages are in memory is then for the operating system to decide, which takes back all that others need.

// A file in memory changes when others write to it, which is why the compiler cannot vouch for it. See `Numbers::in_file`.
#![allow(unsafe_code)]

use std::fmt;
use std::fs::File;
use std::io::{self, Write};
use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};

use bytemuck::Pod;
use memmap2::MmapMut;

use crate::error::{Error, Result};

/// Where a film keeps what it has by time, which may be more than there is memory. What it holds is the same to the last
/// bit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Storage {
    /// In memory, which is taken as light arrives.
    #[default]
    Memory,
    /// In files in this folder, all of whose room is taken at once. They have no names, so that nothing is left of them,
    /// however the program ends.
    File(PathBuf),
}

impl Storage {
    /// So many numbers, all of them 0.
    pub(super) fn zeros<T: Pod>(&self, count: usize) -> Result<Numbers<T>> {
        let bytes = count.saturating_mul(size_of::<T>());
        let made = match self {
            _ if bytes < WORTHWHILE && *self == Storage::Memory || bytes == 0 => return Ok(Numbers::new(count)),
            Storage::Memory => MmapMut::map_anon(bytes).map(|map| Mapped { map, _file: None, of: PhantomData }),
            Storage::File(folder) => Mapped::in_file(bytes, folder),
        };
        made.map(Numbers::Map).map_err(|error| {
            let fault = match self {
                Storage::Memory => Error::new(format!("there is no memory for the film's time bins: {error}")),
                Storage::File(folder) => Error::io(folder, "keep the film's time bins in", &error),
            };
            fault.with_hint("keep fewer bins, layers or pixels, or bins without their variance")
        })
    }
}

/// Bytes from which on the system is asked for memory, which may say that there is none.
const WORTHWHILE: usize = 1 << 22;

/// As many numbers as there were at first.
pub(super) enum Numbers<T> {
    Heap(Vec<T>),
    Map(Mapped<T>),
}

/// Pages of the system's.
pub(super) struct Mapped<T> {
    map: MmapMut,
    /// The file that has them, if one does; it is gone when it is closed.
    _file: Option<File>,
    of: PhantomData<T>,
}

impl<T: Pod> Numbers<T> {
    /// So many zeros in memory.
    pub(super) fn new(count: usize) -> Numbers<T> {
        Numbers::Heap(vec![T::zeroed(); count])
    }
}

impl<T> Mapped<T> {
    /// So many zeros in a file in this folder.
    fn in_file(bytes: usize, folder: &Path) -> io::Result<Mapped<T>> {
        let file = tempfile::tempfile_in(folder)?;
        reserve(&file, bytes as u64)?;
        // SAFETY: The file has no name, or on some systems one that cannot be opened again: nobody else can write to it or
        // cut it. All of its room is taken, so that the disk cannot be too full for a page.
        let map = unsafe { MmapMut::map_mut(&file) }?;
        Ok(Mapped { map, _file: Some(file), of: PhantomData })
    }
}

/// Makes an empty file as long as this, zero all over, with all the room on the disk that it takes.
fn reserve(mut file: &File, bytes: u64) -> io::Result<()> {
    // A disk without so much room says so at once, not when it is full.
    #[cfg(target_os = "linux")]
    {
        use rustix::fs::{FallocateFlags, fallocate};
        use rustix::io::Errno;
        match fallocate(file, FallocateFlags::empty(), 0, bytes) {
            // Not every file system can.
            Ok(()) | Err(Errno::OPNOTSUPP | Errno::NOSYS) => {}
            Err(error) => return Err(error.into()),
        }
    }
    #[cfg(not(target_os = "linux"))]
    file.set_len(bytes)?;
    // Room that was never written to is cut into as many pieces as pages are written here and there, and pieces take long.
    let zeros = vec![0; 1 << 20];
    let mut left = bytes;
    while left > 0 {
        let some = left.min(zeros.len() as u64);
        file.write_all(&zeros[..some as usize])?;
        left -= some;
    }
    Ok(())
}

impl<T: Pod> Deref for Numbers<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        match self {
            Numbers::Heap(numbers) => numbers,
            Numbers::Map(pages) => bytemuck::cast_slice(&pages.map),
        }
    }
}

impl<T: Pod> DerefMut for Numbers<T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [T] {
        match self {
            Numbers::Heap(numbers) => numbers,
            Numbers::Map(pages) => bytemuck::cast_slice_mut(&mut pages.map),
        }
    }
}

/// A copy is in memory.
impl<T: Pod> Clone for Numbers<T> {
    fn clone(&self) -> Numbers<T> {
        Numbers::Heap(self.to_vec())
    }
}

impl<T: Pod + PartialEq> PartialEq for Numbers<T> {
    fn eq(&self, other: &Numbers<T>) -> bool {
        **self == **other
    }
}

impl<T: Pod + fmt::Debug> fmt::Debug for Numbers<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_a_file_are_zeros_at_first_and_then_what_they_are_made() {
        let folder = tempfile::tempdir().expect("a folder");
        let storage = Storage::File(folder.path().into());
        let mut numbers = storage.zeros::<i64>(5000).expect("room");
        assert!(matches!(&numbers, Numbers::Map(Mapped { _file: Some(_), .. })) && *numbers == [0; 5000]);
        numbers[4999] = -3;
        let mut expected = Numbers::new(5000);
        expected[4999] = -3;
        assert_eq!(numbers, expected);
        assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 0, "no file has a name");
        assert!(storage.zeros::<u8>(0).expect("nothing").is_empty());
    }

    #[test]
    fn what_keeps_a_file_from_being_made_is_told() {
        let folder = tempfile::tempdir().expect("a folder");
        let fault = |folder: &Path, count| match Storage::File(folder.into()).zeros::<i64>(count) {
            Err(error) => error.to_string(),
            Ok(_) => panic!("there is no room for {count}"),
        };
        let missing = fault(&folder.path().join("no"), 1);
        assert!(missing.contains("cannot keep the film's time bins in"), "{missing}");
        // More than any disk has: full, or too long for a file.
        for count in [1 << 55, usize::MAX] {
            let absurd = fault(folder.path(), count);
            assert!(absurd.contains("fewer bins"), "{absurd}");
        }
        let error = Storage::Memory.zeros::<i64>(1 << 60).expect_err("more than can be addressed").to_string();
        assert!(error.contains("there is no memory"), "{error}");
    }
}
