//! The first calls of the OpenXR loader.
//!
//! Source: "OpenXR API Layers" and "Loader/Layer Negotiation" of the OpenXR loader specification
//! (loader.html), whose structures openxr-sys has.

use super::{instance, proc_addr};
use crate::abi::guard;
use openxr_sys as xr;
use std::ffi::c_char;

/// The version of OpenXR that this layer was written against. A runtime's or an application's may be older or
/// newer: nothing but core functions of 1.0 is used.
const API_VERSION: xr::Version = xr::Version::new(1, 1, 0);

/// The version of the interface between loader and layer.
const INTERFACE_VERSION: u32 = xr::CURRENT_LOADER_API_LAYER_VERSION as u32;

/// `xrNegotiateLoaderApiLayerInterface`: agrees on interface version 1 and hands out our functions. The manifest's
/// `functions` maps the loader's name to this one, which collides with no other.
///
/// Fails with `ERROR_INITIALIZATION_FAILED` for invalid structures, and for a loader that does not speak interface
/// version 1 or OpenXR 1.
///
/// # Safety
///
/// Each pointer is null or points to a valid structure; `request` is the loader's to be written.
#[unsafe(export_name = "parafovea_xrNegotiateLoaderApiLayerInterface")]
pub unsafe extern "system" fn negotiate(
    loader_info: *const xr::NegotiateLoaderInfo,
    _layer_name: *const c_char,
    request: *mut xr::NegotiateApiLayerRequest,
) -> xr::Result {
    const FAILED: xr::Result = xr::Result::ERROR_INITIALIZATION_FAILED;
    guard(
        "xrNegotiateLoaderApiLayerInterface",
        || FAILED,
        |_| {
            crate::log::start();
            // SAFETY: each pointer is null or valid, as `# Safety` demands, and no other code uses it during the call.
            match unsafe { (loader_info.as_ref(), request.as_mut()) } {
                (Some(loader), Some(request)) if is_understood(loader, request) => {
                    request.layer_interface_version = INTERFACE_VERSION;
                    request.layer_api_version =
                        API_VERSION.clamp(loader.min_api_version, loader.max_api_version);
                    request.get_instance_proc_addr = Some(proc_addr::get);
                    request.create_api_layer_instance = Some(instance::create);
                    xr::Result::SUCCESS
                }
                _ => FAILED,
            }
        },
    )
}

fn is_understood(loader: &xr::NegotiateLoaderInfo, request: &xr::NegotiateApiLayerRequest) -> bool {
    loader.struct_type == xr::NegotiateLoaderInfo::TYPE
        && loader.struct_version == xr::NegotiateLoaderInfo::VERSION
        && loader.struct_size == size_of::<xr::NegotiateLoaderInfo>()
        && request.struct_type == xr::NegotiateApiLayerRequest::TYPE
        && request.struct_version == xr::NegotiateApiLayerRequest::VERSION
        && request.struct_size == size_of::<xr::NegotiateApiLayerRequest>()
        && (loader.min_interface_version..=loader.max_interface_version).contains(&INTERFACE_VERSION)
        && (loader.min_api_version.major()..=loader.max_api_version.major()).contains(&API_VERSION.major())
        && loader.min_api_version <= loader.max_api_version
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loader(max_minor: u16) -> xr::NegotiateLoaderInfo {
        xr::NegotiateLoaderInfo {
            struct_type: xr::NegotiateLoaderInfo::TYPE,
            struct_version: 1,
            struct_size: size_of::<xr::NegotiateLoaderInfo>(),
            min_interface_version: 1,
            max_interface_version: 1,
            min_api_version: xr::Version::new(1, 0, 0),
            max_api_version: xr::Version::new(1, max_minor, 0xfff),
        }
    }

    fn request() -> xr::NegotiateApiLayerRequest {
        xr::NegotiateApiLayerRequest {
            struct_type: xr::NegotiateApiLayerRequest::TYPE,
            struct_version: 1,
            struct_size: size_of::<xr::NegotiateApiLayerRequest>(),
            layer_interface_version: 0,
            layer_api_version: xr::Version::default(),
            get_instance_proc_addr: None,
            create_api_layer_instance: None,
        }
    }

    #[test]
    fn loaders_of_both_generations_get_a_version_within_their_range() {
        for (max_minor, minor) in [(0, 0), (0x3ff, 1)] {
            let mut request = request();
            // SAFETY: both structures are valid.
            let result = unsafe { negotiate(&loader(max_minor), std::ptr::null(), &mut request) };
            assert_eq!(result, xr::Result::SUCCESS);
            assert_eq!(request.layer_interface_version, 1);
            assert_eq!(request.layer_api_version.minor(), minor);
            assert!(request.get_instance_proc_addr.is_some() && request.create_api_layer_instance.is_some());
        }
    }

    #[test]
    fn invalid_structures_are_refused() {
        let refused = |change: fn(&mut xr::NegotiateLoaderInfo, &mut xr::NegotiateApiLayerRequest)| {
            let (mut loader, mut request) = (loader(1), request());
            change(&mut loader, &mut request);
            // SAFETY: both structures are valid.
            unsafe {
                negotiate(&loader, std::ptr::null(), &mut request) == xr::Result::ERROR_INITIALIZATION_FAILED
            }
        };
        assert!(refused(|loader, _| loader.min_interface_version = 2));
        assert!(refused(|loader, _| loader.struct_size += 1));
        assert!(refused(|loader, _| loader.max_api_version = xr::Version::new(0, 9, 0)));
        assert!(refused(|_, request| request.struct_version = 2));
        // SAFETY: null is allowed.
        let null = unsafe { negotiate(std::ptr::null(), std::ptr::null(), std::ptr::null_mut()) };
        assert_eq!(null, xr::Result::ERROR_INITIALIZATION_FAILED);
    }
}
