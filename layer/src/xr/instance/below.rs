//! The layers below, from the loader.

use super::{extensions, text};
use crate::xr::LAYER_NAME;
use openxr_sys as xr;
use openxr_sys::pfn;

/// More entries of a loader's list are not read.
const MOST_LAYERS: usize = 256;

/// The log's line on a layer that is listed again: the entries up to the last one of it, and the entries after.
fn warn_of_copies(left_out: &[String], after: &[String]) {
    let ours = LAYER_NAME.to_string_lossy();
    let lost = left_out.iter().filter(|name| **name != ours && !after.contains(name));
    let lost: Vec<&str> = lost.map(String::as_str).collect();
    let lost = match lost.is_empty() {
        true => String::new(),
        false => format!("; these layers in between are left out: {}", lost.join(", ")),
    };
    tracing::warn!(
        "the OpenXR loader lists this layer more than once; only the last entry is used. The cause is two installations, or a folder \
         that XDG_DATA_DIRS names twice: `parafovea doctor` names them{lost}"
    );
}

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
    /// OpenXR's loader loads an implicit layer once for each manifest that it finds: twice where `XDG_DATA_DIRS` names a folder twice, or
    /// where the layer is installed for a user and for the system. Two entries of one library would call each other for ever, so the
    /// last entry counts, and the layers between are left out.
    ///
    /// # Safety
    ///
    /// `info` is null or the loader's valid list.
    pub unsafe fn read(info: *const xr::ApiLayerCreateInfo) -> Option<Self> {
        // SAFETY: the list is null or valid, as `# Safety` demands.
        let info =
            unsafe { info.as_ref() }.filter(|info| info.struct_type == xr::ApiLayerCreateInfo::TYPE)?;
        // SAFETY: as above, and so is each entry of it.
        let entry = |entry: *const xr::ApiLayerNextInfo| unsafe { entry.as_ref() };
        let first = entry(info.next_info).filter(|next| next.struct_type == xr::ApiLayerNextInfo::TYPE)?;
        let below = std::iter::successors(entry(first.next), |next| entry(next.next)).take(MOST_LAYERS);
        let names: Vec<String> = below.clone().map(|next| text(&next.layer_name)).collect();
        let ours = LAYER_NAME.to_string_lossy();
        let last = names.iter().rposition(|name| *name == ours);
        let next = last.and_then(|last| below.clone().nth(last)).unwrap_or(first);
        if let Some(last) = last {
            warn_of_copies(&names[..=last], &names[last + 1..]);
        }
        Some(Self {
            create: next.next_create_api_layer_instance?,
            get_instance_proc_addr: next.next_get_instance_proc_addr?,
            list: xr::ApiLayerCreateInfo { next_info: next.next, ..*info },
        })
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
