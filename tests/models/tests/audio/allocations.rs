//! Counts heap allocations, on each thread for itself.

use parafovea_core::audio::{AudioSettings, FeatureExtractor};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: everything is passed on to the system's allocator; the counter needs no allocation of its own.
unsafe impl GlobalAlloc for Counting {
    /// # Safety
    /// As [`GlobalAlloc::alloc`].
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.set(COUNT.get() + 1);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    /// # Safety
    /// As [`GlobalAlloc::dealloc`].
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn pushing_allocates_nothing() {
    for (rate_hz, channels) in [(8_000, 1), (44_100, 2), (48_000, 6), (192_000, 8)] {
        let samples = vec![0.25; (rate_hz * channels) as usize];
        let before_new = COUNT.get();
        let mut extractor = FeatureExtractor::new(rate_hz, channels, &AudioSettings::default()).unwrap();
        let before_push = COUNT.get();
        assert!(before_push > before_new, "the counter counts");
        let mut sets = 0;
        // Beyond the window of 3 s, in portions that do not divide a hop.
        for _ in 0..4 {
            for portion in samples.chunks(1013) {
                extractor.push(portion, |_| sets += 1);
            }
        }
        assert_eq!(COUNT.get(), before_push, "{rate_hz} Hz, {channels} channels");
        assert_eq!(sets, 40);
    }
}
