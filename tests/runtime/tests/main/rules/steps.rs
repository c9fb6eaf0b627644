//! Steps towards a mistake.

use crate::application::{
    Application, ENABLE, IDENTITY, SIZE, V1_0, call, header, projection, structure, swapchain_info, views,
    whole,
};
use ash::vk;
use openxr_sys as xr;

const SUCCESS: xr::Result = xr::Result::SUCCESS;

/// An action set with a boolean action.
pub fn set_and_action(app: &Application) -> (xr::ActionSet, xr::Action) {
    let set = app.action_set("play");
    (set, app.action(set, "press", xr::ActionType::BOOLEAN_INPUT))
}

/// Ends a frame with a projection layer of a shown swapchain, after a change to its views.
pub fn end_with(
    app: &Application,
    change: impl FnOnce(&mut [xr::CompositionLayerProjectionView; 2]),
) -> xr::Result {
    let swapchain = app.swapchain();
    app.show(swapchain, 0, &[]);
    end_with_views(app, &mut views(swapchain), change)
}

pub fn end_with_views(
    app: &Application,
    views: &mut [xr::CompositionLayerProjectionView; 2],
    change: impl FnOnce(&mut [xr::CompositionLayerProjectionView; 2]),
) -> xr::Result {
    change(views);
    let layer = projection(app.space(xr::ReferenceSpaceType::LOCAL), views);
    app.end_frame(first_time(), &[header(&layer)])
}

/// Display time of the first frame of a simulated clock.
pub fn first_time() -> xr::Time {
    xr::Time::from_nanos(1_000_000_000)
}

pub fn swapchain_with(app: &Application, change: impl FnOnce(&mut xr::SwapchainCreateInfo)) -> xr::Result {
    let mut info = swapchain_info();
    change(&mut info);
    app.create_swapchain(&info).err().unwrap_or(SUCCESS)
}

/// A second session, on the same device.
pub fn other_session(app: &mut Application) -> xr::Session {
    let first = app.session;
    assert_eq!(app.create_session(), SUCCESS);
    std::mem::replace(&mut app.session, first)
}

pub fn end_with_quad(app: &Application, change: impl FnOnce(&mut xr::CompositionLayerQuad)) -> xr::Result {
    let swapchain = app.swapchain();
    app.show(swapchain, 0, &[]);
    let mut quad = structure!(CompositionLayerQuad {
        space: app.space(xr::ReferenceSpaceType::LOCAL),
        sub_image: whole(swapchain),
        pose: IDENTITY,
        size: xr::Extent2Df { width: 1.0, height: 1.0 },
    });
    change(&mut quad);
    app.end_frame(first_time(), &[header(&quad)])
}

/// In a frame, with depth enabled, a view with depth information after a change to it.
pub fn end_with_depth(
    app: &Application,
    change: impl FnOnce(&mut xr::CompositionLayerDepthInfoKHR),
) -> xr::Result {
    let depth = app.create_swapchain(&structure!(SwapchainCreateInfo {
        usage_flags: xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT,
        format: i64::from(vk::Format::D32_SFLOAT.as_raw()),
        sample_count: 1,
        width: SIZE,
        height: SIZE,
        face_count: 1,
        array_size: 1,
        mip_count: 1,
    }));
    let depth = depth.unwrap();
    app.show(depth, 0, &[]);
    let mut info = structure!(CompositionLayerDepthInfoKHR {
        sub_image: whole(depth),
        max_depth: 1.0,
        near_z: 0.1,
        far_z: 100.0,
    });
    change(&mut info);
    end_with(app, |views| views[1].next = std::ptr::from_ref(&info).cast())
}

pub fn in_frame_with_depth() -> Application {
    let app = Application::ready_with(V1_0, &[ENABLE, "XR_KHR_composition_layer_depth"]);
    assert_eq!(app.begin_session(), SUCCESS);
    app.begin_frame();
    app
}

pub fn locate_views(
    app: &Application,
    change: impl FnOnce(&mut xr::ViewLocateInfo),
    capacity: u32,
) -> xr::Result {
    let mut info = structure!(ViewLocateInfo {
        view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
        display_time: first_time(),
        space: app.space(xr::ReferenceSpaceType::LOCAL),
    });
    change(&mut info);
    let (mut state, mut count) = (structure!(ViewState {}), 0);
    let mut views = [structure!(View {}); 2];
    call!(app, LocateViews(app.session, &info, &mut state, capacity, &mut count, views.as_mut_ptr()))
}
