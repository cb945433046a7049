//! Memory for what rays read all over the place: in pages as large as the system has, so that the processor knows where
//! they are without looking it up.

use std::fmt;
use std::ops::{Deref, DerefMut};

use bytemuck::Pod;
use memmap2::{Advice, MmapMut};
use rayon::prelude::*;

/// As many `T` as it was made for.
pub(in super::super) struct Pages<T> {
    /// None for few: they are on the heap.
    map: Option<MmapMut>,
    heap: Vec<T>,
    len: usize,
}

/// Bytes from which on pages of their own are worth while: a few large ones.
const WORTHWHILE: usize = 1 << 22;

impl<T: Pod + Send + Sync> Pages<T> {
    /// So many zeros.
    pub(in super::super) fn zeroed(len: usize) -> Pages<T> {
        let bytes = len * size_of::<T>();
        let map = if bytes >= WORTHWHILE { MmapMut::map_anon(bytes).ok() } else { None };
        let heap = if map.is_some() { Vec::new() } else { vec![T::zeroed(); len] };
        // Where the system has no such pages, or none left, its usual ones do.
        #[cfg(target_os = "linux")]
        if let Some(map) = &map {
            let _ = map.advise(Advice::HugePage);
        }
        Pages { map, heap, len }
    }

    /// Holds what `make` gives for each of `sources`.
    pub(in super::super) fn from_each<S: Sync>(sources: &[S], make: impl Fn(&S) -> T + Sync) -> Pages<T> {
        let mut pages = Pages::zeroed(sources.len());
        pages.par_iter_mut().zip(sources).for_each(|(item, source)| *item = make(source));
        pages
    }
}

impl<T: Pod + fmt::Debug> fmt::Debug for Pages<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self.iter()).finish()
    }
}

impl<T: Pod> Deref for Pages<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        match &self.map {
            Some(map) => bytemuck::cast_slice(&map[..self.len * size_of::<T>()]),
            None => &self.heap,
        }
    }
}

impl<T: Pod> DerefMut for Pages<T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [T] {
        match &mut self.map {
            Some(map) => bytemuck::cast_slice_mut(&mut map[..self.len * size_of::<T>()]),
            None => &mut self.heap,
        }
    }
}
