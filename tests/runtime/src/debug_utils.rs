//! `XR_EXT_debug_utils`: messengers receive every broken rule; names and labels are accepted.

use crate::abi::pointers::{In, Out};
use crate::fault::{Fault, section};
use crate::runtime::call;
use openxr_sys as xr;
use std::ffi::{CString, c_void};

/// An `XrDebugUtilsMessengerEXT`.
#[derive(Clone)]
pub(crate) struct Messenger {
    pub instance: xr::Instance,
    severities: xr::DebugUtilsMessageSeverityFlagsEXT,
    types: xr::DebugUtilsMessageTypeFlagsEXT,
    callback: xr::pfn::DebugUtilsMessengerCallbackEXT,
    /// The application's pointer, as a number: it is only handed back.
    user_data: usize,
}

impl Messenger {
    /// Whether the messenger wants broken rules.
    pub fn wants_errors(&self) -> bool {
        self.wants(
            xr::DebugUtilsMessageSeverityFlagsEXT::ERROR,
            xr::DebugUtilsMessageTypeFlagsEXT::VALIDATION,
        )
    }

    fn wants(
        &self,
        severity: xr::DebugUtilsMessageSeverityFlagsEXT,
        ty: xr::DebugUtilsMessageTypeFlagsEXT,
    ) -> bool {
        self.severities.intersects(severity) && self.types.intersects(ty)
    }
}

/// Reports a broken rule to messengers; without the lock, since they may call back.
pub(crate) fn tell(messengers: &[Messenger], call: &str, result: &str, fault: &Fault) {
    if messengers.is_empty() {
        return;
    }
    // None of the texts has a NUL inside: names of functions and results have none, and it is removed from messages.
    let text = |text: String| CString::new(text.replace('\0', "")).unwrap_or_default();
    let (id, function) = (text(result.to_owned()), text(call.to_owned()));
    let message = text(format!("{} (\"{}\")", fault.message, fault.section));
    let data = xr::DebugUtilsMessengerCallbackDataEXT {
        ty: xr::DebugUtilsMessengerCallbackDataEXT::TYPE,
        next: std::ptr::null(),
        message_id: id.as_ptr(),
        function_name: function.as_ptr(),
        message: message.as_ptr(),
        object_count: 0,
        objects: std::ptr::null_mut(),
        session_label_count: 0,
        session_labels: std::ptr::null_mut(),
    };
    for messenger in messengers {
        let severity = xr::DebugUtilsMessageSeverityFlagsEXT::ERROR;
        let ty = xr::DebugUtilsMessageTypeFlagsEXT::VALIDATION;
        // SAFETY: the application gave this function and pointer for this purpose; the data outlives the call.
        unsafe { (messenger.callback)(severity, ty, &data, messenger.user_data as *mut c_void) };
    }
}

/// `xrCreateDebugUtilsMessengerEXT`.
pub(crate) extern "system" fn create_messenger(
    instance: xr::Instance,
    info: In<xr::DebugUtilsMessengerCreateInfoEXT>,
    messenger: Out<xr::DebugUtilsMessengerEXT>,
) -> xr::Result {
    call("xrCreateDebugUtilsMessengerEXT", |runtime| {
        runtime.instances.get(instance)?;
        let info = runtime.read(&info)?;
        let callback = info.user_callback;
        let callback =
            callback.ok_or_else(|| Fault::validation(section::DEBUG_UTILS, "userCallback is NULL"))?;
        if info.message_severities.is_empty() || info.message_types.is_empty() {
            let message = "messageSeverities or messageTypes is 0";
            return Err(Fault::validation(section::DEBUG_UTILS, message));
        }
        let created = Messenger {
            instance,
            severities: info.message_severities,
            types: info.message_types,
            callback,
            user_data: info.user_data as usize,
        };
        messenger.set("messenger", runtime.messengers.insert(&mut runtime.serial, created))?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrDestroyDebugUtilsMessengerEXT`.
pub(crate) extern "system" fn destroy_messenger(messenger: xr::DebugUtilsMessengerEXT) -> xr::Result {
    call("xrDestroyDebugUtilsMessengerEXT", |runtime| {
        runtime.messengers.remove(messenger)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrSubmitDebugUtilsMessageEXT`.
pub(crate) extern "system" fn submit_message(
    instance: xr::Instance,
    severity: xr::DebugUtilsMessageSeverityFlagsEXT,
    ty: xr::DebugUtilsMessageTypeFlagsEXT,
    data: In<xr::DebugUtilsMessengerCallbackDataEXT>,
) -> xr::Result {
    let mut messengers = Vec::new();
    let result = call("xrSubmitDebugUtilsMessageEXT", |runtime| {
        runtime.instances.get(instance)?;
        runtime.read(&data)?;
        let all = runtime.messengers.iter().map(|(_, messenger)| messenger);
        let wanted = all.filter(|messenger| messenger.instance == instance && messenger.wants(severity, ty));
        messengers = wanted.cloned().collect();
        Ok(xr::Result::SUCCESS)
    });
    for messenger in messengers {
        // SAFETY: as in `tell`; the data is the application's own, which it keeps for the call.
        unsafe { (messenger.callback)(severity, ty, data.raw(), messenger.user_data as *mut c_void) };
    }
    result
}

/// `xrSetDebugUtilsObjectNameEXT`.
pub(crate) extern "system" fn set_object_name(
    instance: xr::Instance,
    info: In<xr::DebugUtilsObjectNameInfoEXT>,
) -> xr::Result {
    call("xrSetDebugUtilsObjectNameEXT", |runtime| {
        runtime.instances.get(instance)?;
        if runtime.read(&info)?.object_handle == 0 {
            let message = "objectHandle is XR_NULL_HANDLE";
            return Err(Fault::new(xr::Result::ERROR_HANDLE_INVALID, section::DEBUG_UTILS, message));
        }
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrSessionBeginDebugUtilsLabelRegionEXT`.
pub(crate) extern "system" fn begin_label_region(
    session: xr::Session,
    label: In<xr::DebugUtilsLabelEXT>,
) -> xr::Result {
    call("xrSessionBeginDebugUtilsLabelRegionEXT", |runtime| {
        runtime.sessions.get(session)?;
        runtime.read(&label)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrSessionEndDebugUtilsLabelRegionEXT`.
pub(crate) extern "system" fn end_label_region(session: xr::Session) -> xr::Result {
    call("xrSessionEndDebugUtilsLabelRegionEXT", |runtime| {
        runtime.sessions.get(session)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrSessionInsertDebugUtilsLabelEXT`.
pub(crate) extern "system" fn insert_label(
    session: xr::Session,
    label: In<xr::DebugUtilsLabelEXT>,
) -> xr::Result {
    call("xrSessionInsertDebugUtilsLabelEXT", |runtime| {
        runtime.sessions.get(session)?;
        runtime.read(&label)?;
        Ok(xr::Result::SUCCESS)
    })
}
