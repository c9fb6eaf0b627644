//! The application that plays along.

use super::*;

pub(super) const FRAME_NS: i64 = 11_111_111;
pub(super) const SIDE: i32 = 512;

/// An application with a session, an action set and a double-wide swapchain.
pub(super) struct Application {
    pub(super) session: xr::Session,
    pub(super) space: xr::Space,
    pub(super) swapchain: xr::Swapchain,
}

/// Gives the layer its device, which stays where it is.
pub(super) fn session_of_tests() -> xr::Session {
    session_of(create_instance(&[]).unwrap())
}

/// The same for an instance.
pub(super) fn session_of(instance: xr::Instance) -> xr::Session {
    let handle = xr::Session::from_raw(fake::new_handle());
    let device = VulkanDevice::of_table(vulkan_half::table(), vulkan_half::record());
    // SAFETY: nothing is done on this device: no swapchain is substituted.
    unsafe {
        session::track(instance::hooked(instance).unwrap(), xr::SystemId::from_raw(1), handle, Ok(device))
    };
    handle
}

impl Application {
    pub(super) fn new() -> Self {
        let session = session_of_tests();
        let swapchain = create_swapchain(session, xr::SwapchainUsageFlags::COLOR_ATTACHMENT, SIDE as u32 * 2);
        let sets = [xr::ActionSet::from_raw(fake::new_handle())];
        let info = xr::SessionActionSetsAttachInfo {
            ty: xr::SessionActionSetsAttachInfo::TYPE,
            next: ptr::null(),
            count_action_sets: 1,
            action_sets: sets.as_ptr(),
        };
        // SAFETY: valid arguments.
        assert_eq!(unsafe { actions::attach(session, &info) }, xr::Result::SUCCESS);
        Self { session, space: xr::Space::from_raw(fake::new_handle()), swapchain }
    }

    pub(super) fn begin(&self) {
        DISPLAY_TIME.set(DISPLAY_TIME.get() + FRAME_NS);
        // SAFETY: valid arguments; the structures are plain data, for which all zero is a valid value.
        unsafe {
            let mut state: xr::FrameState = std::mem::zeroed();
            assert_eq!(frame::wait(self.session, ptr::null(), &mut state), xr::Result::SUCCESS);
            assert_eq!(frame::begin(self.session, ptr::null()), xr::Result::SUCCESS);
        }
    }

    /// Waits for the next frame and locates its views, ends the one under way by `end`, and begins the next.
    pub(super) fn begin_ahead(&self, end: impl FnOnce()) {
        DISPLAY_TIME.set(DISPLAY_TIME.get() + FRAME_NS);
        // SAFETY: as in `begin`.
        unsafe {
            let mut state: xr::FrameState = std::mem::zeroed();
            assert_eq!(frame::wait(self.session, ptr::null(), &mut state), xr::Result::SUCCESS);
        }
        self.locate();
        DISPLAY_TIME.set(DISPLAY_TIME.get() - FRAME_NS);
        end();
        DISPLAY_TIME.set(DISPLAY_TIME.get() + FRAME_NS);
        // SAFETY: as in `begin`.
        assert_eq!(unsafe { frame::begin(self.session, ptr::null()) }, xr::Result::SUCCESS);
    }

    pub(super) fn locate(&self) {
        locate(self.session, self.space);
    }

    pub(super) fn view(&self, eye: i32) -> xr::CompositionLayerProjectionView {
        let offset = xr::Offset2Di { x: eye * SIDE, y: 0 };
        let extent = xr::Extent2Di { width: SIDE, height: SIDE };
        xr::CompositionLayerProjectionView {
            ty: xr::CompositionLayerProjectionView::TYPE,
            next: ptr::null(),
            pose: pose(HEAD.get()),
            fov: fov(),
            sub_image: xr::SwapchainSubImage {
                swapchain: self.swapchain,
                image_rect: xr::Rect2Di { offset, extent },
                image_array_index: 0,
            },
        }
    }

    pub(super) fn end(&self, views: &[xr::CompositionLayerProjectionView], quad: Option<xr::Swapchain>) {
        let layer = xr::CompositionLayerProjection {
            ty: xr::CompositionLayerProjection::TYPE,
            next: ptr::null(),
            layer_flags: xr::CompositionLayerFlags::EMPTY,
            space: self.space,
            view_count: views.len() as u32,
            views: views.as_ptr(),
        };
        // SAFETY: the structure is plain data, for which all zero is a valid value.
        let mut flat: xr::CompositionLayerQuad = unsafe { std::mem::zeroed() };
        flat.ty = xr::CompositionLayerQuad::TYPE;
        flat.sub_image.swapchain = quad.unwrap_or_default();
        let layers: [*const xr::CompositionLayerBaseHeader; 2] =
            [ptr::from_ref(&layer).cast(), ptr::from_ref(&flat).cast()];
        let info = xr::FrameEndInfo {
            ty: xr::FrameEndInfo::TYPE,
            next: ptr::null(),
            display_time: xr::Time::from_nanos(DISPLAY_TIME.get()),
            environment_blend_mode: xr::EnvironmentBlendMode::OPAQUE,
            layer_count: 1 + u32::from(quad.is_some()),
            layers: layers.as_ptr(),
        };
        // SAFETY: valid arguments. The stand-in answers with an error, which is not ours to judge.
        unsafe { frame::end(self.session, &info) };
    }

    pub(super) fn frame(&self) {
        self.begin();
        self.locate();
        self.end(&[self.view(0), self.view(1)], None);
    }

    /// Frames until the gaze is trusted and nothing becomes coarser any more.
    pub(super) fn settle(&self) {
        for _ in 0..90 {
            self.frame();
        }
        crossings();
    }
}

pub(super) fn locate(session: xr::Session, space: xr::Space) {
    let info = xr::ViewLocateInfo {
        ty: xr::ViewLocateInfo::TYPE,
        next: ptr::null(),
        view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
        display_time: xr::Time::from_nanos(DISPLAY_TIME.get()),
        space,
    };
    // SAFETY: valid arguments; the structures are plain data, for which all zero is a valid value.
    unsafe {
        let mut state: xr::ViewState = std::mem::zeroed();
        let mut views: [xr::View; 2] = std::mem::zeroed();
        let mut count = 0;
        let result = plan::locate_views(session, &info, &mut state, 2, &mut count, views.as_mut_ptr());
        assert_eq!((result, count), (xr::Result::SUCCESS, 2));
        assert_eq!(views[1].fov.angle_right, EDGE, "what the runtime said");
    }
}

pub(super) fn create_swapchain(
    session: xr::Session,
    usage: xr::SwapchainUsageFlags,
    width: u32,
) -> xr::Swapchain {
    let info = xr::SwapchainCreateInfo {
        ty: xr::SwapchainCreateInfo::TYPE,
        next: ptr::null(),
        create_flags: xr::SwapchainCreateFlags::EMPTY,
        usage_flags: usage,
        format: i64::from(vk::Format::R8G8B8A8_SRGB.as_raw()),
        sample_count: 1,
        width,
        height: SIDE as u32,
        face_count: 1,
        array_size: 1,
        mip_count: 1,
    };
    let mut handle = xr::Swapchain::NULL;
    // SAFETY: valid arguments.
    assert_eq!(unsafe { swapchain::create(session, &info, &mut handle) }, xr::Result::SUCCESS);
    handle
}

pub(super) fn look(yaw_deg: f32) {
    EYES.set(Some(Quat::from_rotation_y(yaw_deg.to_radians())));
}

/// The plans since the last call: serial and rates of the left eye.
pub(super) fn plans() -> Vec<(u64, Vec<u8>)> {
    let plan = |received| match received {
        Crossing::Plan { serial, rates: [left, _], .. } => Some((serial, left)),
        _ => None,
    };
    crossings().into_iter().filter_map(plan).collect()
}
