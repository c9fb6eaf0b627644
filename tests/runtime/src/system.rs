//! The one system: a head-mounted display with two views.

use crate::abi::pointers::{In, List, Out};
use crate::abi::text;
use crate::fault::{Fault, section};
use crate::layers::MAX_LAYERS;
use crate::runtime::{Runtime, call};
use openxr_sys as xr;

/// `XrSystemId` of the headset.
const SYSTEM: u64 = 1;

/// Number of views of the system.
pub(crate) const VIEWS: usize = 2;

/// Checks an instance and a system of it.
pub(crate) fn check(runtime: &Runtime, instance: xr::Instance, system: xr::SystemId) -> Result<(), Fault> {
    runtime.instances.get(instance)?;
    if system.into_raw() == SYSTEM {
        return Ok(());
    }
    let message = format!("systemId is {}; xrGetSystem gives {SYSTEM}", system.into_raw());
    Err(Fault::new(xr::Result::ERROR_SYSTEM_INVALID, section::SYSTEM, message))
}

/// Checks a view configuration type.
pub(crate) fn check_view_configuration(ty: xr::ViewConfigurationType) -> Result<(), Fault> {
    if ty == xr::ViewConfigurationType::PRIMARY_STEREO {
        return Ok(());
    }
    let (result, section) =
        (xr::Result::ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED, section::VIEW_CONFIGURATIONS);
    Err(Fault::new(result, section, format!("{ty:?} is not supported; PRIMARY_STEREO is")))
}

/// `xrGetSystem`.
pub(crate) extern "system" fn get(
    instance: xr::Instance,
    info: In<xr::SystemGetInfo>,
    system: Out<xr::SystemId>,
) -> xr::Result {
    call("xrGetSystem", |runtime| {
        runtime.instances.get(instance)?;
        let form_factor = runtime.read(&info)?.form_factor;
        if form_factor != xr::FormFactor::HEAD_MOUNTED_DISPLAY {
            let message = format!("{form_factor:?} is not supported; HEAD_MOUNTED_DISPLAY is");
            return Err(Fault::new(xr::Result::ERROR_FORM_FACTOR_UNSUPPORTED, section::FORM_FACTOR, message));
        }
        system.set("systemId", xr::SystemId::from_raw(SYSTEM))?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrGetSystemProperties`.
pub(crate) extern "system" fn get_properties(
    instance: xr::Instance,
    system: xr::SystemId,
    mut properties: Out<xr::SystemProperties>,
) -> xr::Result {
    call("xrGetSystemProperties", |runtime| {
        check(runtime, instance, system)?;
        let settings = &runtime.scenario.system;
        let filled = properties.get()?;
        filled.system_id = system;
        // No hardware vendor: USB vendor IDs are not below 1.
        filled.vendor_id = 0;
        text::fill(&mut filled.system_name, &settings.name);
        filled.graphics_properties = xr::SystemGraphicsProperties {
            max_swapchain_image_height: settings.max_size,
            max_swapchain_image_width: settings.max_size,
            max_layer_count: MAX_LAYERS,
        };
        filled.tracking_properties =
            xr::SystemTrackingProperties { orientation_tracking: xr::TRUE, position_tracking: xr::TRUE };
        if runtime.instances.get(instance)?.has("XR_EXT_eye_gaze_interaction")
            && let Some(gaze) = properties.extension::<xr::SystemEyeGazeInteractionPropertiesEXT>()
        {
            gaze.supports_eye_gaze_interaction =
                (settings.eye_gaze && runtime.scenario.tracker.reported).into();
        }
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrEnumerateEnvironmentBlendModes`.
pub(crate) extern "system" fn enumerate_blend_modes(
    instance: xr::Instance,
    system: xr::SystemId,
    ty: xr::ViewConfigurationType,
    capacity: u32,
    count: Out<u32>,
    items: Out<xr::EnvironmentBlendMode>,
) -> xr::Result {
    call("xrEnumerateEnvironmentBlendModes", |runtime| {
        check(runtime, instance, system)?;
        check_view_configuration(ty)?;
        List { capacity, count, items }.fill("environmentBlendModes", &[xr::EnvironmentBlendMode::OPAQUE])?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrEnumerateViewConfigurations`.
pub(crate) extern "system" fn enumerate_view_configurations(
    instance: xr::Instance,
    system: xr::SystemId,
    capacity: u32,
    count: Out<u32>,
    items: Out<xr::ViewConfigurationType>,
) -> xr::Result {
    call("xrEnumerateViewConfigurations", |runtime| {
        check(runtime, instance, system)?;
        let types = [xr::ViewConfigurationType::PRIMARY_STEREO];
        List { capacity, count, items }.fill("viewConfigurationTypes", &types)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrGetViewConfigurationProperties`.
pub(crate) extern "system" fn get_view_configuration_properties(
    instance: xr::Instance,
    system: xr::SystemId,
    ty: xr::ViewConfigurationType,
    mut properties: Out<xr::ViewConfigurationProperties>,
) -> xr::Result {
    call("xrGetViewConfigurationProperties", |runtime| {
        check(runtime, instance, system)?;
        check_view_configuration(ty)?;
        let properties = properties.get()?;
        properties.view_configuration_type = ty;
        properties.fov_mutable = xr::FALSE;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrEnumerateViewConfigurationViews`.
pub(crate) extern "system" fn enumerate_view_configuration_views(
    instance: xr::Instance,
    system: xr::SystemId,
    ty: xr::ViewConfigurationType,
    capacity: u32,
    count: Out<u32>,
    items: Out<xr::ViewConfigurationView>,
) -> xr::Result {
    call("xrEnumerateViewConfigurationViews", |runtime| {
        check(runtime, instance, system)?;
        check_view_configuration(ty)?;
        let settings = &runtime.scenario.system;
        List { capacity, count, items }.fill_structures(
            "views",
            &runtime.scenario.views,
            |filled, view| {
                filled.recommended_image_rect_width = view.width;
                filled.max_image_rect_width = settings.max_size;
                filled.recommended_image_rect_height = view.height;
                filled.max_image_rect_height = settings.max_size;
                filled.recommended_swapchain_sample_count = 1;
                filled.max_swapchain_sample_count = settings.max_samples;
            },
        )?;
        Ok(xr::Result::SUCCESS)
    })
}
