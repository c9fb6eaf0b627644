//! Counts the memory allocations of one library of a process, by the callers of glibc's allocator. `LD_PRELOAD` names this library,
//! `PARAFOVEA_TEST_ALLOCATIONS_OF` the other one by a part of its path, and `PARAFOVEA_TEST_ALLOCATIONS_FILE` the file for the number, written
//! when the process exits. `PARAFOVEA_TEST_ALLOCATIONS_EXCEPT` names a thread whose calls are not counted. Calls before the library is found, and
//! frees, are not counted either.

#![cfg(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu"))]

use libc::{c_char, c_int, c_void, dl_phdr_info, size_t};
use std::arch::naked_asm;
use std::ffi::CStr;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

unsafe extern "C" {
    fn __libc_malloc(size: size_t) -> *mut c_void;
    fn __libc_calloc(count: size_t, size: size_t) -> *mut c_void;
    fn __libc_realloc(memory: *mut c_void, size: size_t) -> *mut c_void;
}

/// Address range of the library's code; 0 until it was found.
static FIRST: AtomicUsize = AtomicUsize::new(0);
static END: AtomicUsize = AtomicUsize::new(0);

/// Calls until then.
static CALLS: AtomicUsize = AtomicUsize::new(0);
static COUNT: AtomicUsize = AtomicUsize::new(0);

/// Number of calls from one search for it to the next: a search visits all loaded libraries.
const CALLS_PER_LOOK: usize = 256;

/// glibc's, and counted.
///
/// # Safety
/// As for C's.
#[unsafe(naked)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn malloc(size: size_t) -> *mut c_void {
    // The return address is the caller.
    naked_asm!("mov rsi, [rsp]", "jmp {}", sym counted_malloc)
}

/// glibc's, and counted.
///
/// # Safety
/// As for C's.
#[unsafe(naked)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn calloc(count: size_t, size: size_t) -> *mut c_void {
    naked_asm!("mov rdx, [rsp]", "jmp {}", sym counted_calloc)
}

/// glibc's, and counted.
///
/// # Safety
/// As for C's.
#[unsafe(naked)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realloc(memory: *mut c_void, size: size_t) -> *mut c_void {
    naked_asm!("mov rdx, [rsp]", "jmp {}", sym counted_realloc)
}

/// # Safety
/// As `malloc`.
unsafe extern "C" fn counted_malloc(size: size_t, caller: usize) -> *mut c_void {
    note(caller);
    // SAFETY: as the caller promises.
    unsafe { __libc_malloc(size) }
}

/// # Safety
/// As `calloc`.
unsafe extern "C" fn counted_calloc(count: size_t, size: size_t, caller: usize) -> *mut c_void {
    note(caller);
    // SAFETY: as the caller promises.
    unsafe { __libc_calloc(count, size) }
}

/// # Safety
/// As `realloc`.
unsafe extern "C" fn counted_realloc(memory: *mut c_void, size: size_t, caller: usize) -> *mut c_void {
    note(caller);
    // SAFETY: as the caller promises.
    unsafe { __libc_realloc(memory, size) }
}

/// Asks for no memory itself.
fn note(caller: usize) {
    if END.load(Relaxed) == 0 {
        if CALLS.fetch_add(1, Relaxed).is_multiple_of(CALLS_PER_LOOK) {
            // SAFETY: the callback has the type that is asked for, and keeps nothing.
            unsafe { libc::dl_iterate_phdr(Some(look), null_mut()) };
        }
    } else if (FIRST.load(Relaxed)..END.load(Relaxed)).contains(&caller) && !on_the_exempt_thread() {
        COUNT.fetch_add(1, Relaxed);
    }
}

/// Whether the calling thread has the name of the thread that is not counted.
fn on_the_exempt_thread() -> bool {
    let Some(exempt) = variable(c"PARAFOVEA_TEST_ALLOCATIONS_EXCEPT") else { return false };
    // The kernel keeps 15 characters of a thread's name, and a null.
    let mut name = [0u8; 16];
    // SAFETY: PR_GET_NAME writes 16 bytes with their null to the given address, and asks for no memory.
    if unsafe { libc::prctl(libc::PR_GET_NAME, name.as_mut_ptr()) } != 0 {
        return false;
    }
    CStr::from_bytes_until_nul(&name).is_ok_and(|name| name == exempt)
}

/// The value of a variable of the environment.
fn variable(name: &CStr) -> Option<&'static CStr> {
    // SAFETY: the name is a C string; no code changes the environment of a process under test.
    let value: *const c_char = unsafe { libc::getenv(name.as_ptr()) };
    // SAFETY: a value that is not null is a C string.
    (!value.is_null()).then(|| unsafe { CStr::from_ptr(value) })
}

/// # Safety
/// As a callback of `dl_iterate_phdr`: `library` points to a structure.
unsafe extern "C" fn look(library: *mut dl_phdr_info, _: size_t, _: *mut c_void) -> c_int {
    // SAFETY: glibc's, valid during the call.
    let library = unsafe { &*library };
    let Some(wanted) = variable(c"PARAFOVEA_TEST_ALLOCATIONS_OF") else { return 0 };
    // SAFETY: name and wanted are C strings.
    if library.dlpi_name.is_null() || unsafe { libc::strstr(library.dlpi_name, wanted.as_ptr()) }.is_null() {
        return 0;
    }
    for index in 0..usize::from(library.dlpi_phnum) {
        // SAFETY: there are so many headers.
        let header = unsafe { &*library.dlpi_phdr.add(index) };
        if header.p_type == libc::PT_LOAD && header.p_flags & libc::PF_X != 0 {
            let first = library.dlpi_addr as usize + header.p_vaddr as usize;
            FIRST.store(first, Relaxed);
            END.store(first + header.p_memsz as usize, Relaxed);
        }
    }
    0
}

#[used]
#[unsafe(link_section = ".fini_array")]
static AT_EXIT: extern "C" fn() = write;

extern "C" fn write() {
    let path = variable(c"PARAFOVEA_TEST_ALLOCATIONS_FILE").and_then(|path| path.to_str().ok());
    if let Some(path) = path {
        // A test that finds no file fails.
        let _ = std::fs::write(path, COUNT.load(Relaxed).to_string());
    }
}
