//! Memory for what rays read all over the place: in pages as large as the system has, so that the processor knows where
//! they are without looking it up.

use std::fmt;
use std::ops::Deref;

use bytemuck::Pod;
use memmap2::{Advice, MmapMut};
use rayon::prelude::*;

/// As many `T` as were put in; they do not change.
pub(in super::super) struct Pages<T> {
    /// None for few: they are on the heap.
    map: Option<MmapMut>,
    heap: Vec<T>,
    len: usize,
}

/// Bytes from which on pages of their own are worth while: a few large ones.
const WORTHWHILE: usize = 1 << 22;

impl<T: Pod + Send + Sync> Pages<T> {
    /// Holds what `make` gives for each of `sources`.
    pub(in super::super) fn from_each<S: Sync>(sources: &[S], make: impl Fn(&S) -> T + Sync) -> Pages<T> {
        let (len, bytes) = (sources.len(), sources.len() * size_of::<T>());
        let map = if bytes >= WORTHWHILE { MmapMut::map_anon(bytes).ok() } else { None };
        let Some(mut map) = map else {
            return Pages { map: None, heap: sources.par_iter().map(&make).collect(), len };
        };
        // Where the system has no such pages, or none left, its usual ones do.
        #[cfg(target_os = "linux")]
        let _ = map.advise(Advice::HugePage);
        let items: &mut [T] = bytemuck::cast_slice_mut(&mut map);
        items.par_iter_mut().zip(sources).for_each(|(item, source)| *item = make(source));
        Pages { map: Some(map), heap: Vec::new(), len }
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
