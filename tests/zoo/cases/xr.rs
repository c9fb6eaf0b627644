//! The XrInstance and its system, through the Khronos loader.

use crate::failure::{Failure, succeeded};
use crate::functions::{Functions, characters, look_up};
use crate::options::{Enable, OpenXrVersion, Options};
use libloading::Library;
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ffi::{CStr, c_char};
use std::ptr::null;

/// An instance, and the head-mounted display it found.
pub struct Xr {
    pub get_instance_proc_addr: xr::pfn::GetInstanceProcAddr,
    pub instance: xr::Instance,
    pub functions: Functions,
    pub system: xr::SystemId,
    _library: Library,
}

impl Xr {
    /// Creates the instance with the graphics extension that the options name, and `extensions`.
    pub fn create(options: &Options, extensions: &[&CStr]) -> Result<Self, Failure> {
        // SAFETY: the loader's initialisers are meant to run in any process that asks for it.
        let library = unsafe { Library::new("libopenxr_loader.so.1") }?;
        // SAFETY: the loader exports the function of this name with this signature.
        let get: xr::pfn::GetInstanceProcAddr = unsafe { *library.get(b"xrGetInstanceProcAddr\0")? };
        let create = look_up(get, xr::Instance::NULL, "xrCreateInstance")?;
        // SAFETY: as above, xrCreateInstance has this signature.
        let create: xr::pfn::CreateInstance = unsafe { std::mem::transmute(create) };
        let graphics = match options.enable {
            Enable::One => c"XR_KHR_vulkan_enable",
            Enable::Two => c"XR_KHR_vulkan_enable2",
        };
        let names: Vec<*const c_char> =
            std::iter::once(&graphics).chain(extensions).map(|name| name.as_ptr()).collect();
        let info = xr::InstanceCreateInfo {
            ty: xr::InstanceCreateInfo::TYPE,
            next: null(),
            create_flags: xr::InstanceCreateFlags::EMPTY,
            application_info: xr::ApplicationInfo {
                application_name: characters(&options.name),
                application_version: 1,
                engine_name: characters(c"none"),
                engine_version: 1,
                api_version: match options.openxr {
                    OpenXrVersion::V1_0 => xr::Version::new(1, 0, 0),
                    OpenXrVersion::V1_1 => xr::Version::new(1, 1, 0),
                },
            },
            enabled_api_layer_count: 0,
            enabled_api_layer_names: null(),
            enabled_extension_count: names.len() as u32,
            enabled_extension_names: names.as_ptr(),
        };
        let mut instance = xr::Instance::NULL;
        // SAFETY: the structure and the data that it points to outlive the call.
        succeeded("xrCreateInstance", unsafe { create(&info, &mut instance) })?;
        let functions = Functions::load(get, instance)?;
        let info = xr::SystemGetInfo {
            ty: xr::SystemGetInfo::TYPE,
            next: null(),
            form_factor: xr::FormFactor::HEAD_MOUNTED_DISPLAY,
        };
        let mut system = xr::SystemId::NULL;
        // SAFETY: the instance is live and the structures outlive the call.
        let result = unsafe { (functions.get_system)(instance, &info, &mut system) };
        succeeded("xrGetSystem", result)?;
        Ok(Self { get_instance_proc_addr: get, instance, functions, system, _library: library })
    }

    /// Recommended width and height of the images of the two views of a stereo display.
    pub fn view_sizes(&self) -> Result<[[u32; 2]; 2], Failure> {
        let blank = xr::ViewConfigurationView {
            ty: xr::ViewConfigurationView::TYPE,
            next: std::ptr::null_mut(),
            recommended_image_rect_width: 0,
            max_image_rect_width: 0,
            recommended_image_rect_height: 0,
            max_image_rect_height: 0,
            recommended_swapchain_sample_count: 0,
            max_swapchain_sample_count: 0,
        };
        let mut views = [blank; 2];
        let mut count = 0;
        // SAFETY: the array has the capacity that is passed, and outlives the call.
        let result = unsafe {
            (self.functions.enumerate_views)(
                self.instance,
                self.system,
                xr::ViewConfigurationType::PRIMARY_STEREO,
                2,
                &mut count,
                views.as_mut_ptr(),
            )
        };
        succeeded("xrEnumerateViewConfigurationViews", result)?;
        Ok(views.map(|view| [view.recommended_image_rect_width, view.recommended_image_rect_height]))
    }

    /// The atom of a path such as `/user/hand/left`.
    pub fn path(&self, path: &CStr) -> Result<xr::Path, Failure> {
        let mut atom = xr::Path::NULL;
        // SAFETY: the instance is live, the string ends with a zero, the output outlives the call.
        let result = unsafe { (self.functions.string_to_path)(self.instance, path.as_ptr(), &mut atom) };
        succeeded("xrStringToPath", result)?;
        Ok(atom)
    }
}

impl Drop for Xr {
    fn drop(&mut self) {
        // SAFETY: sessions borrow the application that holds this, so none is alive any more.
        unsafe { (self.functions.destroy_instance)(self.instance) };
    }
}
