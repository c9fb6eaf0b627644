//! The two ways to the runtime: by the OpenXR loader, and as a loader.

use openxr_sys as xr;
use parafovea_mock_runtime::xrNegotiateLoaderRuntimeInterface;
use std::sync::OnceLock;

/// `xrGetInstanceProcAddr` of the OpenXR loader.
pub fn loader() -> xr::pfn::GetInstanceProcAddr {
    static LOADER: OnceLock<libloading::Library> = OnceLock::new();
    // SAFETY: the OpenXR loader may be loaded by anybody; it stays loaded.
    unsafe {
        let library = LOADER.get_or_init(|| libloading::Library::new("libopenxr_loader.so.1").unwrap());
        *library.get::<xr::pfn::GetInstanceProcAddr>(c"xrGetInstanceProcAddr").unwrap()
    }
}

/// `xrGetInstanceProcAddr` of the runtime itself, negotiated as a loader for OpenXR 1.1 does it. The loader of Debian
/// bookworm is for OpenXR 1.0, and answers some mistakes before the runtime sees them.
pub fn negotiated() -> xr::pfn::GetInstanceProcAddr {
    let info = xr::NegotiateLoaderInfo {
        struct_type: xr::NegotiateLoaderInfo::TYPE,
        struct_version: xr::NegotiateLoaderInfo::VERSION,
        struct_size: size_of::<xr::NegotiateLoaderInfo>(),
        min_interface_version: 1,
        max_interface_version: 1,
        min_api_version: xr::Version::new(1, 0, 0),
        max_api_version: xr::Version::new(1, 0x3ff, 0xfff),
    };
    let mut request = xr::NegotiateRuntimeRequest {
        struct_type: xr::NegotiateRuntimeRequest::TYPE,
        struct_version: xr::NegotiateRuntimeRequest::VERSION,
        struct_size: size_of::<xr::NegotiateRuntimeRequest>(),
        runtime_interface_version: 0,
        runtime_api_version: xr::Version::new(0, 0, 0),
        get_instance_proc_addr: None,
    };
    // SAFETY: valid pointers.
    let result = unsafe { xrNegotiateLoaderRuntimeInterface(&info, &mut request) };
    assert_eq!(result, xr::Result::SUCCESS);
    request.get_instance_proc_addr.unwrap()
}
