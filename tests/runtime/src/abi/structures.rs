//! Structures that the runtime reads and fills: their types, their extensions, and the arrays they point to.

use super::pointers::Valid;
use crate::fault::{Fault, section};
use openxr_sys as xr;
use std::ffi::CStr;

/// A structure that begins with `type` and `next`.
///
/// # Safety
/// The layout is that of the structure that [`Self::TYPE`] denotes in the specification.
pub(crate) unsafe trait Structure {
    /// Value of its `type` member.
    const TYPE: xr::StructureType;
    /// Types of the structures that the runtime knows as extensions of this one.
    const EXTENDED_BY: &'static [xr::StructureType];
}

macro_rules! structures {
    ($($name:ident $(extended by $($extension:ident),+)?;)+) => {$(
        // SAFETY: `openxr-sys` declares the structure, and the type that belongs to it, from the registry.
        unsafe impl Structure for xr::$name {
            const TYPE: xr::StructureType = xr::$name::TYPE;
            const EXTENDED_BY: &'static [xr::StructureType] = &[$($(xr::$extension::TYPE),+)?];
        }
    )+};
}

structures! {
    ActionCreateInfo;
    ActionSetCreateInfo;
    ActionSpaceCreateInfo;
    ActionStateBoolean;
    ActionStateFloat;
    ActionStateGetInfo;
    ActionStatePose;
    ActionStateVector2f;
    ActionsSyncInfo;
    BoundSourcesForActionEnumerateInfo;
    CompositionLayerDepthInfoKHR;
    CompositionLayerProjection;
    CompositionLayerProjectionView extended by CompositionLayerDepthInfoKHR;
    CompositionLayerQuad;
    DebugUtilsLabelEXT;
    DebugUtilsMessengerCallbackDataEXT;
    DebugUtilsMessengerCreateInfoEXT;
    DebugUtilsObjectNameInfoEXT;
    EventDataBuffer;
    EventDataInstanceLossPending;
    EventDataInteractionProfileChanged;
    EventDataSessionStateChanged;
    ExtensionProperties;
    EyeGazeSampleTimeEXT;
    FrameBeginInfo;
    FrameEndInfo;
    FrameState;
    FrameWaitInfo;
    GraphicsBindingVulkanKHR;
    GraphicsRequirementsVulkanKHR;
    HapticActionInfo;
    HapticVibration;
    InputSourceLocalizedNameGetInfo;
    InstanceCreateInfo extended by DebugUtilsMessengerCreateInfoEXT;
    InstanceProperties;
    InteractionProfileState;
    InteractionProfileSuggestedBinding;
    ReferenceSpaceCreateInfo;
    SessionActionSetsAttachInfo;
    SessionBeginInfo;
    SessionCreateInfo extended by GraphicsBindingVulkanKHR;
    SpaceLocation extended by EyeGazeSampleTimeEXT, SpaceVelocity;
    SpaceLocations extended by SpaceVelocities;
    SpacesLocateInfo;
    SpaceVelocities;
    SpaceVelocity;
    SwapchainCreateInfo extended by VulkanSwapchainFormatListCreateInfoKHR;
    SwapchainImageAcquireInfo;
    SwapchainImageReleaseInfo;
    SwapchainImageVulkanKHR;
    SwapchainImageWaitInfo;
    SystemEyeGazeInteractionPropertiesEXT;
    SystemGetInfo;
    SystemProperties extended by SystemEyeGazeInteractionPropertiesEXT;
    View;
    ViewConfigurationProperties;
    ViewConfigurationView;
    ViewLocateInfo;
    ViewState;
    VisibilityMaskKHR;
    VulkanDeviceCreateInfoKHR;
    VulkanGraphicsDeviceGetInfoKHR;
    VulkanInstanceCreateInfoKHR;
    VulkanSwapchainFormatListCreateInfoKHR;
}

macro_rules! arrays {
    ($($structure:ident: $member:ident: [$item:ty; $count:ident];)+) => {$(
        impl<'a> Valid<'a, xr::$structure> {
            /// The array that the member of this name points to.
            pub fn $member(&self) -> Result<&'a [$item], Fault> {
                self.array(stringify!($member), self.$count, self.$member)
            }
        }
    )+};
}

arrays! {
    ActionCreateInfo: subaction_paths: [xr::Path; count_subaction_paths];
    ActionsSyncInfo: active_action_sets: [xr::ActiveActionSet; count_active_action_sets];
    CompositionLayerProjection: views: [xr::CompositionLayerProjectionView; view_count];
    InteractionProfileSuggestedBinding: suggested_bindings: [xr::ActionSuggestedBinding; count_suggested_bindings];
    SessionActionSetsAttachInfo: action_sets: [xr::ActionSet; count_action_sets];
    SpacesLocateInfo: spaces: [xr::Space; space_count];
    VulkanSwapchainFormatListCreateInfoKHR: view_formats: [xr::platform::VkFormat; view_format_count];
}

impl<'a> Valid<'a, xr::InstanceCreateInfo> {
    /// Names of the extensions to enable.
    pub fn extension_names(&self) -> Result<Vec<&'a CStr>, Fault> {
        let names =
            self.array("enabledExtensionNames", self.enabled_extension_count, self.enabled_extension_names)?;
        names.iter().map(|name| super::text::member("enabledExtensionNames", *name)).collect()
    }
}

/// A composition layer by its type.
pub(crate) enum LayerStructure<'a> {
    Projection(Valid<'a, xr::CompositionLayerProjection>),
    Quad(Valid<'a, xr::CompositionLayerQuad>),
}

impl<'a> Valid<'a, xr::FrameEndInfo> {
    /// The composition layers.
    pub fn layers(&self) -> Result<Vec<LayerStructure<'a>>, Fault> {
        let layers = self.array("layers", self.layer_count, self.layers)?;
        layers.iter().enumerate().map(|(index, layer)| self.layer(index, layer.cast())).collect()
    }

    fn layer(&self, index: usize, layer: *const xr::BaseInStructure) -> Result<LayerStructure<'a>, Fault> {
        if layer.is_null() {
            let message = format!("layers[{index}] is NULL");
            return Err(Fault::new(xr::Result::ERROR_LAYER_INVALID, section::SUBMISSION, message));
        }
        if let Some(projection) = self.base(layer) {
            return projection.map(LayerStructure::Projection);
        }
        if let Some(quad) = self.base(layer) {
            return quad.map(LayerStructure::Quad);
        }
        let message = format!("layers[{index}] is of no layer type that is enabled: projection and quad are");
        Err(Fault::validation(section::COMPOSITION, message))
    }
}

impl<'a> Valid<'a, xr::CompositionLayerProjection> {
    /// The views, each checked like a parameter.
    pub fn checked_views(&self) -> Result<Vec<Valid<'a, xr::CompositionLayerProjectionView>>, Fault> {
        self.views()?.iter().map(|view| self.element(view)).collect()
    }
}
