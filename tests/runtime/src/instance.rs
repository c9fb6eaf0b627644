//! Instances: version, extensions and objects of an instance.

use crate::abi::pointers::{In, List, Out};
use crate::abi::text;
use crate::actions::bindings::Suggestions;
use crate::events::Event;
use crate::fault::{Fault, result_name, section, structure_name};
use crate::paths::Paths;
use crate::record::{InstanceCreated, Line};
use crate::runtime::{Runtime, call};
use crate::session;
use crate::vulkan::enable::VulkanSetup;
use openxr_sys as xr;
use openxr_sys::Handle;
use std::collections::VecDeque;
use std::ffi::c_char;

/// The newest OpenXR version that the runtime implements.
pub(crate) const NEWEST_API: xr::Version = xr::Version::new(1, 1, 0xfff);

/// An extension that the runtime implements.
#[derive(Clone, Copy)]
pub(crate) struct Extension {
    pub name: &'static str,
    version: u32,
}

/// Every extension, with the version that is implemented.
pub(crate) const EXTENSIONS: [Extension; 8] = [
    Extension { name: "XR_KHR_vulkan_enable", version: 8 },
    Extension { name: "XR_KHR_vulkan_enable2", version: 2 },
    Extension { name: "XR_KHR_vulkan_swapchain_format_list", version: 4 },
    Extension { name: "XR_KHR_composition_layer_depth", version: 6 },
    Extension { name: "XR_KHR_visibility_mask", version: 2 },
    Extension { name: "XR_KHR_convert_timespec_time", version: 1 },
    Extension { name: "XR_EXT_eye_gaze_interaction", version: 2 },
    Extension { name: "XR_EXT_debug_utils", version: 4 },
];

/// An `XrInstance`.
pub(crate) struct Instance {
    pub api: xr::Version,
    extensions: Vec<&'static str>,
    pub events: VecDeque<Event>,
    pub paths: Paths,
    pub suggestions: Suggestions,
    pub vulkan: VulkanSetup,
}

impl Instance {
    /// Whether an extension is enabled.
    pub fn has(&self, extension: &str) -> bool {
        self.extensions.contains(&extension)
    }

    pub fn is_1_1(&self) -> bool {
        self.api.minor() >= 1
    }
}

fn offered(runtime: &Runtime) -> Result<Vec<Extension>, Fault> {
    let off = &runtime.usable_scenario()?.system.extensions_off;
    Ok(EXTENSIONS.into_iter().filter(|extension| !off.iter().any(|off| off == extension.name)).collect())
}

fn listed(runtime: &Runtime) -> Result<Vec<Extension>, Fault> {
    let unlisted = &runtime.scenario.quirks.unlisted_extensions;
    let is_listed = |extension: &Extension| !unlisted.iter().any(|name| name == extension.name);
    Ok(offered(runtime)?.into_iter().filter(is_listed).collect())
}

/// `xrEnumerateInstanceExtensionProperties`.
pub(crate) extern "system" fn enumerate_extensions(
    layer: In<c_char>,
    capacity: u32,
    count: Out<u32>,
    items: Out<xr::ExtensionProperties>,
) -> xr::Result {
    call("xrEnumerateInstanceExtensionProperties", |runtime| {
        if !layer.raw().is_null() {
            let message = format!("{}: a runtime has no API layers", layer.text("layerName")?);
            return Err(Fault::new(xr::Result::ERROR_API_LAYER_NOT_PRESENT, section::INSTANCE, message));
        }
        let list = List { capacity, count, items };
        list.fill_structures("properties", &listed(runtime)?, |properties, extension| {
            text::fill(&mut properties.extension_name, extension.name);
            properties.extension_version = extension.version;
        })?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrEnumerateApiLayerProperties`: the loader has the layers, the runtime none.
pub(crate) extern "system" fn enumerate_api_layers(
    capacity: u32,
    count: Out<u32>,
    items: Out<u8>,
) -> xr::Result {
    call("xrEnumerateApiLayerProperties", |_| {
        List { capacity, count, items }.fill("properties", &[])?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrCreateInstance`.
pub(crate) extern "system" fn create(
    info: In<xr::InstanceCreateInfo>,
    instance: Out<xr::Instance>,
) -> xr::Result {
    call("xrCreateInstance", |runtime| {
        let info = runtime.read(&info)?;
        let application = text::array("applicationName", &info.application_info.application_name)?;
        if application.is_empty() {
            let message = "applicationName is empty";
            return Err(Fault::new(xr::Result::ERROR_NAME_INVALID, section::INSTANCE_LIFECYCLE, message));
        }
        let api = info.application_info.api_version;
        check_version(runtime, api)?;
        let extensions = enabled(runtime, &info.extension_names()?)?;
        let created = Instance {
            api,
            extensions,
            events: VecDeque::new(),
            paths: Paths::default(),
            suggestions: Suggestions::default(),
            vulkan: VulkanSetup::default(),
        };
        let line = InstanceCreated {
            instance: 0,
            application: application.to_owned(),
            engine: text::array("engineName", &info.application_info.engine_name)?.to_owned(),
            api_version: api.to_string(),
            extensions: created.extensions.iter().map(|&name| name.to_owned()).collect(),
        };
        let handle = runtime.instances.insert(&mut runtime.serial, created);
        instance.set("instance", handle)?;
        runtime
            .recorder
            .line(&Line::InstanceCreated(InstanceCreated { instance: handle.into_raw(), ..line }));
        Ok(xr::Result::SUCCESS)
    })
}

fn check_version(runtime: &Runtime, api: xr::Version) -> Result<(), Fault> {
    let max_minor = if runtime.usable_scenario()?.system.max_api == "1.0" { 0 } else { 1 };
    if api.major() == 1 && api.minor() <= max_minor {
        return Ok(());
    }
    let message = format!("apiVersion is {api}; 1.0 to 1.{max_minor} are supported");
    Err(Fault::new(xr::Result::ERROR_API_VERSION_UNSUPPORTED, section::API_VERSIONS, message))
}

fn enabled(runtime: &Runtime, names: &[&std::ffi::CStr]) -> Result<Vec<&'static str>, Fault> {
    let refused = &runtime.scenario.quirks.refused_extensions;
    let mut offered = offered(runtime)?;
    offered.retain(|extension| !refused.iter().any(|name| name == extension.name));
    let find = |name: &&std::ffi::CStr| {
        let found = offered.iter().find(|extension| extension.name.as_bytes() == name.to_bytes());
        found.map(|extension| extension.name).ok_or_else(|| {
            let message = format!("{name:?} is no extension of this runtime, or the scenario has it off");
            Fault::new(xr::Result::ERROR_EXTENSION_NOT_PRESENT, section::INSTANCE_LIFECYCLE, message)
        })
    };
    names.iter().map(find).collect()
}

/// `xrDestroyInstance`, with all that belongs to it.
pub(crate) extern "system" fn destroy(instance: xr::Instance) -> xr::Result {
    call("xrDestroyInstance", |runtime| {
        runtime.instances.remove(instance)?;
        let sessions: Vec<_> =
            runtime.sessions.iter().filter(|(_, session)| session.instance == instance).collect();
        for session in sessions.into_iter().map(|(handle, _)| handle).collect::<Vec<_>>() {
            session::remove(runtime, session)?;
        }
        let sets: Vec<_> = runtime.action_sets.iter().filter(|(_, set)| set.instance == instance).collect();
        for set in sets.into_iter().map(|(handle, _)| handle).collect::<Vec<_>>() {
            crate::actions::remove_set(runtime, set)?;
        }
        runtime.messengers.retain(|messenger| messenger.instance != instance);
        let end = Line::End {
            instance: instance.into_raw(),
            frames: runtime.frames,
            errors: runtime.recorder.errors,
        };
        runtime.recorder.line(&end);
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrGetInstanceProperties`.
pub(crate) extern "system" fn get_properties(
    instance: xr::Instance,
    mut properties: Out<xr::InstanceProperties>,
) -> xr::Result {
    call("xrGetInstanceProperties", |runtime| {
        runtime.instances.get(instance)?;
        let properties = properties.get()?;
        let part = |text: &str| text.parse::<u32>().unwrap_or_default();
        let (major, minor) = (part(env!("CARGO_PKG_VERSION_MAJOR")), part(env!("CARGO_PKG_VERSION_MINOR")));
        properties.runtime_version =
            xr::Version::new(major as u16, minor as u16, part(env!("CARGO_PKG_VERSION_PATCH")));
        text::fill(&mut properties.runtime_name, "Parafovea mock runtime");
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrResultToString`.
pub(crate) extern "system" fn result_to_string(
    instance: xr::Instance,
    value: xr::Result,
    mut buffer: Out<[c_char; xr::MAX_RESULT_STRING_SIZE]>,
) -> xr::Result {
    call("xrResultToString", |runtime| {
        runtime.instances.get(instance)?;
        buffer.set_text("buffer", &result_name(value))?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrStructureTypeToString`.
pub(crate) extern "system" fn structure_type_to_string(
    instance: xr::Instance,
    value: xr::StructureType,
    mut buffer: Out<[c_char; xr::MAX_STRUCTURE_NAME_SIZE]>,
) -> xr::Result {
    call("xrStructureTypeToString", |runtime| {
        runtime.instances.get(instance)?;
        buffer.set_text("buffer", &structure_name(value))?;
        Ok(xr::Result::SUCCESS)
    })
}
