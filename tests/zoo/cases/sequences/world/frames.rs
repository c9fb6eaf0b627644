//! Frames, from xrWaitFrame to submission.

use super::{Session, Swapchain, World};
use crate::session::IDENTITY;
use openxr_sys as xr;
use std::ptr::{from_ref, null, null_mut};

impl World<'_> {
    /// Waits for a frame, or begins the one that was waited for.
    pub(super) fn frame_step(&mut self) {
        let Some(at) = self.session() else { return };
        let Session { is_running, waited, begun, .. } = self.sessions[at];
        let functions = &self.app.xr.functions;
        if let Some(time) = waited {
            if begun.is_some() && !self.numbers.once_in(4) {
                return;
            }
            let handle = self.handle(self.sessions[at].handle);
            // SAFETY: null stands for no info; a handle may be invalid on purpose.
            let result = unsafe { (functions.begin_frame)(handle, null()) };
            if self.told("xrBeginFrame", result) {
                self.sessions[at].waited = None;
                self.sessions[at].begun = Some(time);
            }
        } else if is_running || self.dares() {
            let (_chain, next) = self.chain();
            let info = xr::FrameWaitInfo { ty: xr::FrameWaitInfo::TYPE, next };
            let mut state = xr::FrameState::out(null_mut());
            // SAFETY: the session is live; the structures outlive the call.
            let result =
                unsafe { (functions.wait_frame)(self.sessions[at].handle, &info, state.as_mut_ptr()) };
            if self.told("xrWaitFrame", result) {
                // SAFETY: the call succeeded, so it filled the structure.
                let state = unsafe { state.assume_init() };
                self.trace.push(format!("renders {:?}", state.should_render));
                self.sessions[at].waited = Some(state.predicted_display_time);
            }
        }
    }

    pub(super) fn locate_views(&mut self) {
        let Some(at) = self.session() else { return };
        let Some(time) = self.sessions[at].begun.or(self.sessions[at].waited) else { return };
        let handle = self.handle(self.sessions[at].handle);
        let space = self.handle(self.sessions[at].space);
        let (_chain, next) = self.chain();
        let info = xr::ViewLocateInfo {
            ty: xr::ViewLocateInfo::TYPE,
            next,
            view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
            display_time: if self.dares() { xr::Time::from_nanos(-1) } else { time },
            space,
        };
        let mut state = xr::ViewState::out(null_mut());
        let mut views = [xr::View::out(null_mut()); 2];
        let mut count = 77;
        let capacity = if self.dares() { self.numbers.below(2) as u32 } else { 2 };
        let locate = self.app.xr.functions.locate_views;
        // SAFETY: there is room for as many views as is said; a handle may be invalid on purpose.
        let result = unsafe {
            locate(handle, &info, state.as_mut_ptr(), capacity, &mut count, views.as_mut_ptr().cast())
        };
        self.told(&format!("xrLocateViews {count}"), result);
    }

    pub(super) fn end_frame(&mut self) {
        let Some(at) = self.session() else { return };
        let Session { handle, space, begun, .. } = self.sessions[at];
        if begun.is_none() && !self.dares() {
            return;
        }
        let time = begun.unwrap_or(xr::Time::from_nanos(5));
        let of_session = |swapchain: &&Swapchain| swapchain.session == handle && swapchain.is_color;
        let shown: Vec<usize> = (0..self.swapchains.len())
            .filter(|&index| of_session(&&self.swapchains[index]) && self.swapchains[index].is_released)
            .collect();
        let shown =
            if shown.is_empty() && self.dares() { (0..self.swapchains.len()).collect() } else { shown };
        let eyes: Vec<usize> =
            (0..2).filter_map(|_| shown.get(self.numbers.below(shown.len())).copied()).collect();
        let views: Vec<xr::CompositionLayerProjectionView> =
            eyes.iter().map(|&index| self.view(index)).collect();
        let layer = xr::CompositionLayerProjection {
            ty: xr::CompositionLayerProjection::TYPE,
            next: null(),
            layer_flags: xr::CompositionLayerFlags::EMPTY,
            space: self.handle(space),
            view_count: views.len() as u32,
            views: views.as_ptr(),
        };
        let layers: [*const xr::CompositionLayerBaseHeader; 1] = [from_ref(&layer).cast()];
        let (_chain, next) = self.chain();
        let info = xr::FrameEndInfo {
            ty: xr::FrameEndInfo::TYPE,
            next,
            display_time: time,
            environment_blend_mode: xr::EnvironmentBlendMode::OPAQUE,
            layer_count: u32::from(views.len() == 2),
            layers: layers.as_ptr(),
        };
        let handle = self.handle(handle);
        // SAFETY: the structures outlive the call; handles may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.end_frame)(handle, &info) };
        if self.told(&format!("xrEndFrame {}", info.layer_count), result) {
            self.sessions[at].begun = None;
        }
        self.poll();
    }

    pub(super) fn view(&mut self, index: usize) -> xr::CompositionLayerProjectionView {
        let Swapchain { handle, size, .. } = self.swapchains[index];
        let edge = 0.7;
        let is_odd = self.is_hostile() && self.numbers.once_in(8);
        let width = if is_odd { i32::MAX } else { size[0] as i32 };
        xr::CompositionLayerProjectionView {
            ty: xr::CompositionLayerProjectionView::TYPE,
            next: null(),
            pose: IDENTITY,
            fov: xr::Fovf {
                angle_left: if is_odd { f32::NAN } else { -edge },
                angle_right: edge,
                angle_up: edge,
                angle_down: -edge,
            },
            sub_image: xr::SwapchainSubImage {
                swapchain: self.handle(handle),
                image_rect: xr::Rect2Di {
                    offset: xr::Offset2Di { x: if is_odd { -5 } else { 0 }, y: 0 },
                    extent: xr::Extent2Di { width, height: size[1] as i32 },
                },
                image_array_index: if is_odd { 9 } else { 0 },
            },
        }
    }

    /// The usual calls of a frame, so that sequences reach later states.
    pub(super) fn whole_frame(&mut self) {
        self.begin_session();
        self.frame_step();
        self.frame_step();
        self.acquire();
        self.wait_image();
        self.release();
        self.locate_views();
        self.end_frame();
    }
}
