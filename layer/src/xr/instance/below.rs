//! The layers below, from the loader.

use super::extensions;
use openxr_sys as xr;
use openxr_sys::pfn;

/// The layer below, from the loader's list.
#[derive(Clone, Copy)]
pub struct Below {
    create: pfn::CreateApiLayerInstance,
    /// Its `xrGetInstanceProcAddr`.
    pub get_instance_proc_addr: pfn::GetInstanceProcAddr,
    list: xr::ApiLayerCreateInfo,
}

impl Below {
    /// Takes the next layer's functions, and a copy of the list that begins after us.
    ///
    /// # Safety
    ///
    /// `info` is null or the loader's valid list.
    pub unsafe fn read(info: *const xr::ApiLayerCreateInfo) -> Option<Self> {
        // SAFETY: the list is null or valid, as `# Safety` demands.
        unsafe {
            let info = info.as_ref().filter(|info| info.struct_type == xr::ApiLayerCreateInfo::TYPE)?;
            let next =
                info.next_info.as_ref().filter(|next| next.struct_type == xr::ApiLayerNextInfo::TYPE)?;
            Some(Self {
                create: next.next_create_api_layer_instance?,
                get_instance_proc_addr: next.next_get_instance_proc_addr?,
                list: xr::ApiLayerCreateInfo { next_info: next.next, ..*info },
            })
        }
    }

    /// The extensions of the runtime, where it can be asked: not through other layers, some of which take no question
    /// without an instance.
    pub fn offered(&self) -> Option<Vec<xr::ExtensionProperties>> {
        let is_end = self.list.next_info.is_null();
        // SAFETY: below the last layer is the loader itself.
        is_end.then(|| unsafe { extensions::offered(self.get_instance_proc_addr) }).flatten()
    }

    /// Creates the instance below.
    ///
    /// # Safety
    ///
    /// As for `xrCreateInstance`.
    pub unsafe fn create(
        &self,
        info: *const xr::InstanceCreateInfo,
        instance: *mut xr::Instance,
    ) -> xr::Result {
        // SAFETY: the loader gave the function, and its list is valid during the call.
        unsafe { (self.create)(info, &self.list, instance) }
    }
}
