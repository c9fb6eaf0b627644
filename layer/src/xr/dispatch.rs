//! Every OpenXR function that this layer calls below, and every one that it hooks: one list. All are OpenXR 1.0 core.

use super::functions::functions;
use super::{actions, frame, instance, offer, plan, session, spaces, swapchain};

functions! {
    /// The functions of the layer (or runtime) below, for one instance.
    Next;

    c"xrDestroyInstance" destroy_instance: DestroyInstance => instance::destroy;
    c"xrPollEvent" poll_event: PollEvent => actions::poll_event;
    c"xrGetSystemProperties" get_system_properties:
        GetSystemProperties => offer::get_system_properties;
    c"xrEnumerateViewConfigurationViews" enumerate_view_configuration_views: EnumerateViewConfigurationViews;
    c"xrStringToPath" string_to_path: StringToPath => actions::string_to_path;
    c"xrPathToString" path_to_string: PathToString;

    c"xrCreateSession" create_session: CreateSession => session::create;
    c"xrDestroySession" destroy_session: DestroySession => session::destroy;
    c"xrBeginSession" begin_session: BeginSession => session::begin_session;
    c"xrEndSession" end_session: EndSession => session::end_session;

    c"xrCreateSwapchain" create_swapchain: CreateSwapchain => swapchain::create;
    c"xrDestroySwapchain" destroy_swapchain: DestroySwapchain => swapchain::destroy;
    c"xrEnumerateSwapchainImages" enumerate_swapchain_images:
        EnumerateSwapchainImages => swapchain::enumerate_images;
    c"xrAcquireSwapchainImage" acquire_swapchain_image:
        AcquireSwapchainImage => swapchain::acquire_image;
    c"xrWaitSwapchainImage" wait_swapchain_image: WaitSwapchainImage => swapchain::wait_image;
    c"xrReleaseSwapchainImage" release_swapchain_image:
        ReleaseSwapchainImage => swapchain::release_image;

    c"xrWaitFrame" wait_frame: WaitFrame => frame::wait;
    c"xrBeginFrame" begin_frame: BeginFrame => frame::begin;
    c"xrEndFrame" end_frame: EndFrame => frame::end;
    c"xrLocateViews" locate_views: LocateViews => plan::locate_views;

    c"xrCreateActionSet" create_action_set: CreateActionSet => actions::create_action_set;
    c"xrDestroyActionSet" destroy_action_set:
        DestroyActionSet => actions::destroy_action_set;
    c"xrCreateAction" create_action: CreateAction => actions::create_action;
    c"xrDestroyAction" destroy_action: DestroyAction => actions::destroy_action;
    c"xrSuggestInteractionProfileBindings" suggest_interaction_profile_bindings:
        SuggestInteractionProfileBindings => actions::suggest_bindings;
    c"xrAttachSessionActionSets" attach_session_action_sets:
        AttachSessionActionSets => actions::attach;
    c"xrSyncActions" sync_actions: SyncActions => actions::sync;
    c"xrGetActionStatePose" get_action_state_pose: GetActionStatePose;
    c"xrGetCurrentInteractionProfile" get_current_interaction_profile:
        GetCurrentInteractionProfile => actions::get_current_profile;
    c"xrCreateActionSpace" create_action_space: CreateActionSpace;
    c"xrCreateReferenceSpace" create_reference_space:
        CreateReferenceSpace => spaces::create_reference;
    c"xrDestroySpace" destroy_space: DestroySpace => spaces::destroy;
    c"xrLocateSpace" locate_space: LocateSpace;
}
