//! Memory that ends where a small file has no business. The operating system would give what nobody has written to yet,
//! so that a reader that believes a file's "10⁹ vertices" looks harmless to it.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's memory up to so many bytes at a time; whoever asks for more ends the process.
pub struct Ceiling {
    most: usize,
    used: AtomicUsize,
}

impl Ceiling {
    /// At most `most` bytes.
    pub const fn new(most: usize) -> Ceiling {
        Ceiling { most, used: AtomicUsize::new(0) }
    }

    fn take(&self, size: usize) {
        if self.used.fetch_add(size, Ordering::Relaxed).saturating_add(size) > self.most {
            // libFuzzer takes this for a crash and keeps the input.
            std::process::abort();
        }
    }
}

// SAFETY: all is done by the system's allocator; only the sizes are added up beside it.
unsafe impl GlobalAlloc for Ceiling {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        self.take(layout.size());
        // SAFETY: what the caller promises of `layout` is what the system asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        self.take(layout.size());
        // SAFETY: as in `alloc`.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        self.used.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promises again; `memory` came from the system.
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        self.take(new_size);
        self.used.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as in `dealloc`.
        unsafe { System.realloc(memory, layout, new_size) }
    }
}
