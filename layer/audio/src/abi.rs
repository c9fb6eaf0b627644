//! The C side: the table that the layer asks for. Panics stay within.

use crate::capture::Capture;
use crate::settings::{Settings, Source};
use parafovea_core::audio::{AudioSettings, Mode};
use parafovea_manifest::audio_library::{
    CaptureTable, FeaturesRecord, Handle, SOURCE_FILE, SOURCE_SYSTEM, SettingsRecord, TABLE_VERSION,
};
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::ptr::null;

static TABLE: CaptureTable = CaptureTable {
    version: TABLE_VERSION,
    size: size_of::<CaptureTable>() as u32,
    start,
    features,
    next_line,
    stop,
};

/// The layer's request to this library.
#[unsafe(no_mangle)]
extern "C" fn parafovea_audio_get_table() -> *const CaptureTable {
    &raw const TABLE
}

unsafe extern "C" fn start(settings: *const SettingsRecord) -> Handle {
    guarded(null(), || {
        // SAFETY: the caller's record, valid during this call.
        let Some(record) = (unsafe { settings.as_ref() }) else { return null() };
        let source = match record.source {
            SOURCE_SYSTEM => Source::System,
            SOURCE_FILE if !record.path.is_null() => {
                // SAFETY: the record's text, of that length and valid during this call.
                let path = unsafe { std::slice::from_raw_parts(record.path, record.path_len as usize) };
                Source::File(PathBuf::from(OsStr::from_bytes(path)))
            }
            _ => return null(),
        };
        let features = AudioSettings {
            mode: if record.is_paper == 1 { Mode::Paper } else { Mode::Default },
            window_s: record.window_s,
            least_lufs: record.least_lufs,
            greatest_lufs: record.greatest_lufs,
        };
        match Capture::start(Settings { source, features, interval_s: record.interval_s }) {
            Ok(capture) => Box::into_raw(Box::new(capture)).cast_const().cast(),
            Err(_) => null(),
        }
    })
}

unsafe extern "C" fn features(capture: Handle, features: *mut FeaturesRecord) -> u32 {
    guarded(0, || {
        // SAFETY: a capture that `start` made and that was not stopped.
        let Some(newest) = (unsafe { capture.cast::<Capture>().as_ref() }).and_then(Capture::newest) else {
            return 0;
        };
        let record = FeaturesRecord {
            serial: newest.serial,
            age_ns: newest.age_ns,
            loudness_lufs: newest.features.loudness_lufs,
            gamma_ld: newest.features.gamma_ld,
            gamma_fq_kilomel: newest.features.gamma_fq_kilomel,
            is_silent: u32::from(newest.features.silent),
            confidence: newest.confidence,
            reserved: 0,
        };
        // SAFETY: the caller's record, valid to write to.
        unsafe { features.write(record) };
        1
    })
}

unsafe extern "C" fn next_line(capture: Handle, text: *mut u8, capacity: u32) -> u32 {
    guarded(0, || {
        // SAFETY: a capture that `start` made and that was not stopped.
        let Some(mut line) = (unsafe { capture.cast::<Capture>().as_ref() }).and_then(Capture::next_line)
        else {
            return 0;
        };
        line.truncate(line.floor_char_boundary(capacity as usize));
        // SAFETY: the caller's text, valid for `capacity` bytes, of which the line has no more.
        unsafe { text.copy_from_nonoverlapping(line.as_ptr(), line.len()) };
        line.len() as u32
    })
}

unsafe extern "C" fn stop(capture: Handle) {
    guarded((), || {
        if !capture.is_null() {
            // SAFETY: a box that `start` released; by the table's contract no code uses it any more.
            drop(unsafe { Box::from_raw(capture.cast_mut().cast::<Capture>()) });
        }
    });
}

fn guarded<R>(otherwise: R, call: impl FnOnce() -> R) -> R {
    // Unwind safety: all shared state is atomic or behind a mutex.
    catch_unwind(AssertUnwindSafe(call)).unwrap_or(otherwise)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_settings_are_refused() {
        // SAFETY: the functions take null, and records that are valid.
        unsafe {
            let table = &*parafovea_audio_get_table();
            assert!((table.start)(null()).is_null());
            let record = SettingsRecord {
                source: 7,
                path: null(),
                path_len: 0,
                is_paper: 0,
                window_s: 3.0,
                interval_s: 0.1,
                least_lufs: -35.0,
                greatest_lufs: -10.0,
            };
            assert!((table.start)(&record).is_null());
            assert!((table.start)(&SettingsRecord { source: SOURCE_FILE, ..record }).is_null());
            assert_eq!((table.features)(null(), &mut FeaturesRecord::default()), 0);
            assert_eq!((table.next_line)(null(), std::ptr::null_mut(), 0), 0);
            (table.stop)(null());
        }
    }
}
