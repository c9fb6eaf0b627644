//! Interface between the layer and the library that captures sound: a versioned C table.
//!
//! Capturing needs ALSA's library, which is not on every machine and which no game should get because of us. So it is a
//! shared library of its own, [`LIBRARY_NAME`], beside the layer's; the layer loads it when sound is asked for, asks it
//! for [`GET_TABLE_NAME`], and goes on without sound where either is missing.

use std::ffi::CStr;

/// File name of the library that captures sound.
pub const LIBRARY_NAME: &str = "libparafovea_audio.so";

/// The symbol that [`LIBRARY_NAME`] exports: a [`GetTable`].
pub const GET_TABLE_NAME: &CStr = c"parafovea_audio_get_table";

/// Version of [`CaptureTable`] and of its records; libraries with different versions do not meet.
pub const TABLE_VERSION: u32 = 1;

/// Signature behind [`GET_TABLE_NAME`]: the table, valid for the life of the process.
pub type GetTable = unsafe extern "C" fn() -> *const CaptureTable;

/// One capture, known to the library that made it.
pub type Handle = *const std::ffi::c_void;

/// Functions of the library that captures sound. No function panics; all may be called from any thread.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CaptureTable {
    /// [`TABLE_VERSION`] of the library that made this table.
    pub version: u32,
    /// `size_of::<CaptureTable>()` of that library.
    pub size: u32,
    /// Starts a capture, on threads of its own; null if that is not possible. Data that the record points to is copied.
    pub start: unsafe extern "C" fn(settings: *const SettingsRecord) -> Handle,
    /// Writes the newest features; returns 1, or 0 where there are none yet. Neither waits nor allocates.
    pub features: unsafe extern "C" fn(capture: Handle, features: *mut FeaturesRecord) -> u32,
    /// Takes the oldest line for the log that was not taken yet: writes at most `capacity` bytes of UTF-8 to `text` and returns their
    /// number; 0 if there is none.
    pub next_line: unsafe extern "C" fn(capture: Handle, text: *mut u8, capacity: u32) -> u32,
    /// Ends a capture, which is not to be used any more. Does not wait for its threads, which end soon.
    pub stop: unsafe extern "C" fn(capture: Handle),
}

/// The system's sound.
pub const SOURCE_SYSTEM: u32 = 1;

/// A WAV file, over and over.
pub const SOURCE_FILE: u32 = 2;

/// The sound to capture, and its summary.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct SettingsRecord {
    /// [`SOURCE_SYSTEM`] or [`SOURCE_FILE`].
    pub source: u32,
    /// Path of the file with [`SOURCE_FILE`], `path_len` bytes.
    pub path: *const u8,
    /// Length of `path`.
    pub path_len: u32,
    /// 1: as paper A has it, else the default (`parafovea_core::audio::Mode`).
    pub is_paper: u32,
    /// T_a, seconds.
    pub window_s: f32,
    /// T_s, seconds.
    pub interval_s: f32,
    /// ITU_min, LUFS.
    pub least_lufs: f32,
    /// ITU_max, LUFS.
    pub greatest_lufs: f32,
}

/// Features of the sound (`parafovea_core::audio::AudioFeatures`), and their reliability.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FeaturesRecord {
    /// Counts sets of features, from 1.
    pub serial: u64,
    /// Time since the last sample that counts was captured, nanoseconds.
    pub age_ns: u64,
    /// LUFS.
    pub loudness_lufs: f32,
    /// gamma_ld, loudness units.
    pub gamma_ld: f32,
    /// gamma_fq, kilo-mel.
    pub gamma_fq_kilomel: f32,
    /// 1: silence.
    pub is_silent: u32,
    /// Share of the last seconds that was captured intact, 0..=1.
    pub confidence: f32,
    /// 0.
    pub reserved: u32,
}
