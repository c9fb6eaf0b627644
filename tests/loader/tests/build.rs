//! The loader is built, and is the one that was asked for.

use std::path::Path;

#[test]
fn it_builds_and_is_a_1_1_loader() {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
    let file = parafovea_openxr_loader::build(target).unwrap().join(parafovea_openxr_loader::FILE_NAME);
    // SAFETY: the loader's initialisers do nothing that could disturb this process.
    let library = unsafe { libloading::Library::new(&file) }.unwrap();
    // SAFETY: the symbol is looked up, not called.
    unsafe { library.get::<*const ()>(b"xrGetInstanceProcAddr\0") }.unwrap();
    let version = std::fs::canonicalize(&file).unwrap();
    let version = version.file_name().unwrap().to_string_lossy();
    assert!(version.starts_with("libopenxr_loader.so.1.1."), "{version}");
}
