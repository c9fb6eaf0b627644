//! The finished eye buffers of a frame: the Vulkan half measures their contrast.
//!
//! Pictures of virtual swapchains are analysed at the end of the frame, once they are written. Pictures of other swapchains are analysed in
//! the call that returns their image, because the image is the runtime's after it: their places are known from the frames before. In an
//! application that submits late, that call is held until the frame ends.

use super::FrameEnd;
use super::regions::{Images, rect_within};
use super::work::Work;
use crate::config::{Config, RatesMode, wants_contrast};
use crate::link::{EyeBufferRecord, EyeViewRecord};
use crate::xr::session::{Active, Health};
use crate::xr::submission::Projection;
use crate::xr::swapchain::Swapchain;
use ash::vk;
use glam::Quat;
use openxr_sys as xr;
use openxr_sys::Handle;
use parafovea_core::geometry::Fov;
use smallvec::SmallVec;

/// The eye buffers of the last frames by swapchain: an application may draw to several in turn.
#[derive(Default)]
pub struct ShownEyes {
    frame: u64,
    swapchains: SmallVec<[Shown; 4]>,
}

/// The eye buffers of a swapchain, and the last frame that showed them.
struct Shown {
    swapchain: xr::Swapchain,
    frame: u64,
    eyes: [Option<ShownEye>; 2],
}

/// Frames after which a swapchain that they do not show is forgotten.
const LONGEST_UNSHOWN: u64 = 8;

/// Place of an eye buffer, and its field of view.
#[derive(Clone, Copy)]
pub struct ShownEye {
    /// Swapchain, rectangle and array layer.
    pub sub_image: xr::SwapchainSubImage,
    /// Field of view.
    pub fov: Fov,
    /// Whether its contrast counted: its view was sent.
    pub has_view: bool,
}

impl ShownEyes {
    /// A frame ended with this layer, or without one.
    pub fn note(&mut self, scene: Option<&Projection<'_>>) {
        self.frame += 1;
        let frame = self.frame;
        for (index, eye) in scene.map(eyes_of).into_iter().flatten().enumerate() {
            let Some(eye) = eye else { continue };
            let swapchain = eye.sub_image.swapchain;
            match self.swapchains.iter_mut().find(|shown| shown.swapchain == swapchain) {
                Some(shown) => {
                    if shown.frame != frame {
                        (shown.frame, shown.eyes) = (frame, [None; 2]);
                    }
                    shown.eyes[index] = Some(eye);
                }
                None => {
                    let mut eyes = [None; 2];
                    eyes[index] = Some(eye);
                    self.swapchains.push(Shown { swapchain, frame, eyes });
                }
            }
        }
        self.swapchains.retain(|shown| shown.frame + LONGEST_UNSHOWN > frame);
    }

    /// The view of an eye was sent, which the frame shows in this swapchain.
    fn sent_view(&mut self, eye: usize, swapchain: xr::Swapchain) {
        let frame = self.frame;
        let mut shown = self.swapchains.iter_mut().filter(|shown| shown.frame == frame);
        let eyes = shown.find(|shown| shown.swapchain == swapchain).map(|shown| &mut shown.eyes);
        if let Some(Some(eye)) = eyes.and_then(|eyes| eyes.get_mut(eye)) {
            eye.has_view = true;
        }
    }

    /// The eye buffers that a swapchain had in the newest of these frames that showed it.
    pub fn of(&self, swapchain: xr::Swapchain) -> [Option<ShownEye>; 2] {
        let shown = self.swapchains.iter().find(|shown| shown.swapchain == swapchain);
        shown.map_or([None; 2], |shown| shown.eyes)
    }
}

/// The eye buffers of a projection layer.
pub fn eyes_of(scene: &Projection<'_>) -> [Option<ShownEye>; 2] {
    [0, 1].map(|eye| {
        let view = scene.views.get(eye)?;
        Some(ShownEye { sub_image: view.sub_image, fov: view.fov, has_view: false })
    })
}

/// Whether the contrast of pictures counts: the configuration asks for it, and passes get rates.
fn counts(active: &Active, config: &Config) -> bool {
    wants_contrast(config, active.device.is_cpu())
        && active.plan.has_rates()
        && active.health() == Health::Works
}

/// Has the eye buffers analysed that our work of this frame has written on the session's queue, before their image is the runtime's again.
///
/// # Safety
///
/// This thread may use the session's queue.
pub unsafe fn analyze_written(frame: &FrameEnd, works: &[Work]) {
    let FrameEnd { active, submission, ref config, .. } = *frame;
    let Some(scene) = submission.only_projection().filter(|_| counts(active, config)) else { return };
    let mut records = Records::new();
    for (eye, view) in (0..2).zip(scene.views) {
        let work = works.iter().find(|work| work.swapchain.handle == view.sub_image.swapchain);
        if let Some(picture) = work.and_then(|work| work.finished(view)) {
            records.push(record((active, config), eye, &view.sub_image, picture));
        }
    }
    // SAFETY: the images live until their swapchain ends, which is said; they were just written, and are in that layout.
    unsafe { active.device.analyze_eye_buffers(&records) };
}

/// The eye buffers that are analysed in one go.
type Records = SmallVec<[EyeBufferRecord; 4]>;

/// The eye buffers of a swapchain whose contrast counts. Without a view, as of a flat layer or beside a second projection layer, none does.
fn analyzed(swapchain: &Swapchain, active: &Active, config: &Config) -> [Option<ShownEye>; 2] {
    match counts(active, config) {
        true => active.shown_eyes().of(swapchain.handle).map(|eye| eye.filter(|eye| eye.has_view)),
        false => [None; 2],
    }
}

/// Whether released images of a swapchain are analysed.
pub fn analyzes_released(swapchain: &Swapchain) -> bool {
    let Some(active) = &swapchain.session().active else { return false };
    analyzed(swapchain, active, &active.plan.config()).iter().any(Option::is_some)
}

/// Has the eye buffers analysed that are in images of one session, by their numbers, which are about to be returned to the runtime.
///
/// # Safety
///
/// This thread may use the session's queue; the application's draws to the images are submitted.
pub unsafe fn analyze_released(images: &[(&Swapchain, u32)]) {
    let Some(active) = images.first().and_then(|(swapchain, _)| swapchain.session().active.as_ref()) else {
        return;
    };
    let config = active.plan.config();
    let _degrade = super::DegradeOnPanic(active);
    let mut records = Records::new();
    for (swapchain, index) in images {
        let shown = analyzed(swapchain, active, &config);
        let is_any = shown.iter().any(Option::is_some);
        let Some((image, format)) = swapchain.readable_image(*index).filter(|_| is_any) else { continue };
        let (extent, array_layers) = swapchain.extent_and_layers();
        for (eye, shown) in (0..2).zip(shown) {
            let Some(ShownEye { sub_image, .. }) = shown else { continue };
            let rect = rect_within(&sub_image, &Images { extent, array_layers, is_unit_range: true });
            records
                .extend(rect.map(|rect| record((active, &config), eye, &sub_image, (image, format, rect))));
        }
    }
    // SAFETY: the images live until their swapchain ends, which is said; this thread may use the queue, to which the draws to the
    // images were submitted, as `# Safety` demands.
    unsafe { active.device.analyze_eye_buffers(&records) };
}

/// The record of an eye's picture.
fn record(
    (active, config): (&Active, &Config),
    eye: u32,
    sub_image: &xr::SwapchainSubImage,
    (image, format, rect): (vk::Image, vk::Format, vk::Rect2D),
) -> EyeBufferRecord {
    let (family, index) = active.device.queue;
    EyeBufferRecord {
        eye,
        queue: [family, index],
        swapchain: sub_image.swapchain.into_raw(),
        image,
        format,
        layer: sub_image.image_array_index,
        rect: pixels(rect),
        white_cd_m2: config.rates.white_cd_m2,
        is_mean: u32::from(config.rates.mode == RatesMode::Paper),
    }
}

/// Sends the views in which this frame shows eye buffers: the contrast of their pictures counts from now on.
pub fn notify_views(frame: &FrameEnd) {
    let FrameEnd { active, submission, ref config, .. } = *frame;
    let Some(scene) = submission.only_projection().filter(|_| counts(active, config)) else { return };
    let Some(to_world) = to_world(frame, &scene) else { return };
    for (eye, view) in (0..2).zip(scene.views) {
        let tangents = view.fov.tangents();
        let xr::Rect2Di { offset, extent } = view.sub_image.image_rect;
        let rect = [offset.x, offset.y, extent.width, extent.height].map(u32::try_from);
        let ([Ok(x), Ok(y), Ok(width), Ok(height)], Some(orientation)) = (rect, view.orientation) else {
            continue;
        };
        // The plan's first row is the top.
        if tangents.up < tangents.down {
            continue;
        }
        let plane = tangents.plane([width, height]);
        active.device.notify_eye_view(&EyeViewRecord {
            eye,
            swapchain: view.sub_image.swapchain.into_raw(),
            layer: view.sub_image.image_array_index,
            rect: [x, y, width, height],
            plane: [plane.origin.into(), plane.step.into()],
            orientation: (to_world * orientation).into(),
        });
        active.shown_eyes().sent_view(eye as usize, view.sub_image.swapchain);
    }
}

/// From the space of a layer to one that rests in the world: as the head is turned in both. The plan of the frame has located it in the
/// world.
fn to_world(frame: &FrameEnd, scene: &Projection<'_>) -> Option<Quat> {
    let time = frame.submission.time;
    let in_layer = frame.head_in_layer(scene)?;
    let planned = frame.active.plan.planner().head_at(time.as_nanos());
    Some(planned.unwrap_or_else(|| frame.session.head_in_world(time)) * in_layer.inverse())
}

fn pixels(rect: vk::Rect2D) -> [u32; 4] {
    [rect.offset.x as u32, rect.offset.y as u32, rect.extent.width, rect.extent.height]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xr::submission::ProjectionView;
    use glam::Vec3;
    use parafovea_core::geometry::Fov;

    fn view(swapchain: u64, layer: u32) -> ProjectionView {
        let extent = xr::Extent2Di { width: 8, height: 8 };
        let image_rect = xr::Rect2Di { offset: xr::Offset2Di { x: 0, y: 0 }, extent };
        let swapchain = xr::Swapchain::from_raw(swapchain);
        ProjectionView {
            orientation: Some(Quat::IDENTITY),
            position_m: Vec3::ZERO,
            fov: Fov { left: -0.7, right: 0.7, up: 0.7, down: -0.7 },
            sub_image: xr::SwapchainSubImage { swapchain, image_rect, image_array_index: layer },
            depth: None,
        }
    }

    fn layers_of(shown: &ShownEyes, swapchain: u64) -> [Option<u32>; 2] {
        let eyes = shown.of(xr::Swapchain::from_raw(swapchain));
        eyes.map(|eye| Some(eye?.sub_image.image_array_index))
    }

    #[test]
    fn eye_buffers_of_swapchains_in_turn_are_known() {
        let mut shown = ShownEyes::default();
        let mut show = |views: &[ProjectionView]| {
            shown.note(Some(&Projection { space: xr::Space::NULL, views }));
            [1, 2, 3].map(|swapchain| layers_of(&shown, swapchain))
        };
        let nothing = [None; 2];
        assert_eq!(show(&[view(1, 0), view(1, 1)]), [[Some(0), Some(1)], nothing, nothing]);
        assert_eq!(show(&[view(2, 2), view(2, 3)])[..2], [[Some(0), Some(1)], [Some(2), Some(3)]]);
        assert_eq!(show(&[view(3, 4), view(3, 5)])[2], [Some(4), Some(5)]);
        // The newest frame counts.
        assert_eq!(show(&[view(1, 4), view(2, 5)]), [[Some(4), None], [None, Some(5)], [Some(4), Some(5)]]);
    }

    #[test]
    fn swapchains_that_are_not_shown_are_forgotten() {
        let mut shown = ShownEyes::default();
        let views = [view(1, 0), view(1, 1)];
        shown.note(Some(&Projection { space: xr::Space::NULL, views: &views }));
        for _ in 1..LONGEST_UNSHOWN {
            shown.note(None);
            assert_eq!(layers_of(&shown, 1), [Some(0), Some(1)]);
        }
        shown.note(None);
        assert_eq!(layers_of(&shown, 1), [None; 2]);
    }

    #[test]
    fn views_are_sent_for_eyes_of_the_frame() {
        let mut shown = ShownEyes::default();
        let views = [view(1, 0), view(2, 1)];
        let scene = Projection { space: xr::Space::NULL, views: &views };
        let has_view = |shown: &ShownEyes| {
            let of = |swapchain| {
                shown.of(xr::Swapchain::from_raw(swapchain)).map(|eye| eye.map(|eye| eye.has_view))
            };
            [of(1), of(2)]
        };
        shown.note(Some(&scene));
        shown.sent_view(0, xr::Swapchain::from_raw(1));
        assert_eq!(has_view(&shown), [[Some(true), None], [None, Some(false)]]);
        // A frame without views ends that: an overlay has come.
        shown.note(Some(&scene));
        assert_eq!(has_view(&shown), [[Some(false), None], [None, Some(false)]]);
        shown.note(None);
        shown.sent_view(0, xr::Swapchain::from_raw(1));
        assert_eq!(has_view(&shown), [[Some(false), None], [None, Some(false)]], "of an earlier frame");
    }
}
