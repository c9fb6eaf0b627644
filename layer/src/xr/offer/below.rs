//! The functions that only instances with an offered gaze call below or hook.

use super::{hooks, sources, spaces};
use crate::xr::functions::functions;

functions! {
    /// Functions of the layer (or runtime) below for an offered gaze, beside the functions of `Next`.
    OfferNext;

    c"xrGetActionStatePose" get_action_state_pose: GetActionStatePose => hooks::get_action_state_pose;
    c"xrEnumerateBoundSourcesForAction" enumerate_bound_sources:
        EnumerateBoundSourcesForAction => sources::enumerate_bound_sources;
    c"xrGetInputSourceLocalizedName" get_localized_name:
        GetInputSourceLocalizedName => sources::get_localized_name;
    c"xrCreateActionSpace" create_action_space: CreateActionSpace => spaces::create_action_space;
    c"xrLocateSpace" locate_space: LocateSpace => spaces::locate;

    optional:
    c"xrLocateSpaces" | c"xrLocateSpacesKHR" locate_spaces: LocateSpaces => spaces::locate_many;
}
