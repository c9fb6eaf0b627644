//! The sound capture library, beside this one: loaded when sound is asked for, never unloaded.

use super::own_folder::own_folder;
use parafovea_manifest::audio_library::{
    CaptureTable, FeaturesRecord, GET_TABLE_NAME, GetTable, Handle, LIBRARY_NAME, SettingsRecord,
    TABLE_VERSION,
};
use std::ffi::{CStr, CString};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Reason why there is no sound.
#[derive(Debug, Error)]
pub enum NotLoaded {
    /// It is not known where this library is.
    #[error("the folder of this library is unknown")]
    NoFolder,
    /// The system does not load it.
    #[error("{LIBRARY_NAME} could not be loaded: {0}")]
    Refused(String),
    /// It is another library.
    #[error("{} is not Parafovea's capture library", .0.display())]
    Foreign(PathBuf),
    /// It comes from another version of this library.
    #[error("{LIBRARY_NAME} has interface version {0}, this library {TABLE_VERSION}")]
    OtherVersion(u32),
    /// It cannot listen.
    #[error("{LIBRARY_NAME} could not start the capture")]
    NotStarted,
}

/// The longest line of its log, bytes.
const LONGEST_LINE: usize = 1024;

/// A capture in the sound capture library; ends when it is dropped.
pub struct Capture {
    table: CaptureTable,
    handle: Handle,
}

// SAFETY: by the table's contract all its functions may be called from any thread.
unsafe impl Send for Capture {}
// SAFETY: as above; each function synchronises the state that threads share.
unsafe impl Sync for Capture {}

impl Capture {
    /// Loads the library, if it is not there yet, and begins to listen to the system's sound, or to `file`. `record` has
    /// the other settings; its path is set here.
    ///
    /// # Errors
    /// There is no such library beside this one, or it cannot listen.
    pub fn start(record: &SettingsRecord, file: Option<&Path>) -> Result<Self, NotLoaded> {
        let path = own_folder().ok_or(NotLoaded::NoFolder)?.join(LIBRARY_NAME);
        let table = load(&path)?;
        let file = file.map_or(&b""[..], |file| file.as_os_str().as_bytes());
        let record = SettingsRecord { path: file.as_ptr(), path_len: file.len() as u32, ..*record };
        // SAFETY: the record's path is valid during the call, and copied by it.
        let handle = unsafe { (table.start)(&record) };
        if handle.is_null() { Err(NotLoaded::NotStarted) } else { Ok(Self { table, handle }) }
    }

    /// The newest features, if there are any. Neither waits nor allocates.
    pub fn features(&self) -> Option<FeaturesRecord> {
        let mut record = FeaturesRecord::default();
        // SAFETY: a live capture, and a record to write to.
        let is_there = unsafe { (self.table.features)(self.handle, &mut record) };
        (is_there == 1).then_some(record)
    }

    /// The oldest line for the log that was not taken yet.
    pub fn next_line(&self) -> Option<String> {
        let mut text = [0; LONGEST_LINE];
        // SAFETY: a live capture, and a buffer of as many bytes as the passed length.
        let length = unsafe { (self.table.next_line)(self.handle, text.as_mut_ptr(), text.len() as u32) };
        let line = text.get(..length as usize).filter(|line| !line.is_empty())?;
        Some(String::from_utf8_lossy(line).into_owned())
    }
}

impl Drop for Capture {
    fn drop(&mut self) {
        // SAFETY: a live capture, not used after this.
        unsafe { (self.table.stop)(self.handle) };
    }
}

/// The table of the library at `path`.
fn load(path: &Path) -> Result<CaptureTable, NotLoaded> {
    let name =
        CString::new(path.as_os_str().as_bytes()).map_err(|error| NotLoaded::Refused(error.to_string()))?;
    // SAFETY: a library of ours, whose initialisers do nothing that depends on the caller; the reference is kept.
    let library =
        unsafe { libc::dlopen(name.as_ptr(), libc::RTLD_NOW | libc::RTLD_LOCAL | libc::RTLD_NODELETE) };
    if library.is_null() {
        return Err(NotLoaded::Refused(reason()));
    }
    // SAFETY: the library is there; the symbol has the type that the link gives it.
    let get_table = unsafe {
        let get_table = libc::dlsym(library, GET_TABLE_NAME.as_ptr());
        std::mem::transmute::<*mut libc::c_void, Option<GetTable>>(get_table)
    };
    let get_table = get_table.ok_or_else(|| NotLoaded::Foreign(path.to_owned()))?;
    // SAFETY: the table lives as long as the library; the version is the first member in every version of it, and determines the members after it.
    unsafe {
        let table = get_table();
        let version = (&raw const (*table).version).read();
        if version != TABLE_VERSION || (*table).size as usize != size_of::<CaptureTable>() {
            return Err(NotLoaded::OtherVersion(version));
        }
        Ok(*table)
    }
}

/// The reason why the last library could not be loaded.
fn reason() -> String {
    // SAFETY: dlerror returns null or a string that is valid until this thread's next call of it.
    let reason = unsafe {
        let reason = libc::dlerror();
        if reason.is_null() { c"no reason given" } else { CStr::from_ptr(reason) }
    };
    reason.to_string_lossy().into_owned()
}
