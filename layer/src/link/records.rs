//! Messages between the halves, as C structures. Pointers in them are valid during the call only.

use ash::vk;
use parafovea_core::kernels::decide::DecideParams;
use std::ffi::c_void;

/// [`CapabilitiesRecord::backend`]: nothing can be made coarser on this device; the log has the reason.
pub const BACKEND_NONE: u32 = 0;
/// [`CapabilitiesRecord::backend`]: a rate attachment (`VK_KHR_fragment_shading_rate`).
pub const BACKEND_RATE_ATTACHMENT: u32 = 1;
/// [`CapabilitiesRecord::backend`]: a mask of skipped blocks.
pub const BACKEND_MASK: u32 = 2;
/// [`SettingsRecord::backend`]: the best of them.
pub const BACKEND_ANY: u32 = 3;

/// Abilities of the device's backend; the plan is made for them.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CapabilitiesRecord {
    /// `BACKEND_*`.
    pub backend: u32,
    /// Size of a tile, pixels.
    pub texel: [u32; 2],
    /// Number of valid entries in `rates`.
    pub rate_count: u32,
    /// Rates that the device has, as texels of a rate image (`ShadingRate::texel`), in any order.
    pub rates: [u8; 16],
    /// 1 where the device is a CPU (`VK_PHYSICAL_DEVICE_TYPE_CPU`).
    pub is_cpu: u32,
}

/// The images of a swapchain, as the application has them: the runtime's, or ours if it is substituted. Sent after they are first known, and
/// again with no images when the swapchain is about to be destroyed.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct SwapchainRecord {
    /// The XrSwapchain.
    pub swapchain: u64,
    /// `image_count` images, by their index.
    pub images: *const vk::Image,
    /// Number of images; 0: the swapchain is about to be destroyed.
    pub image_count: u32,
    /// Size, pixels.
    pub extent: [u32; 2],
    /// Array layers.
    pub layers: u32,
    /// Its format.
    pub format: vk::Format,
    /// Samples of a pixel.
    pub samples: u32,
    /// Usage of the images that the application asked for.
    pub usage: vk::ImageUsageFlags,
    /// Usage that they have, which may be more.
    pub granted: vk::ImageUsageFlags,
    /// 1 if they are the layer's own, in place of the runtime's; else 0.
    pub is_virtual: u32,
    /// 1 if the layer may read them, so that the layouts are followed in which the application's submits leave them; else 0.
    pub is_read: u32,
}

/// The newest plan.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PlanRecord {
    /// Counts up from 1 with every plan of the device; a plan with an older number is ignored.
    pub serial: u64,
    /// Of the left and of the right eye.
    pub eyes: [EyeMapRecord; 2],
}

/// Map of the tiles of one eye buffer: their rates, or the parameters of a decision on the GPU.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EyeMapRecord {
    /// Size of the picture that it is made for, pixels. It is scaled to pictures of other sizes.
    pub extent: [u32; 2],
    /// Size of a tile, pixels; the first tile begins at pixel 0, 0.
    pub texel: [u32; 2],
    /// Number of tiles that cover `extent`, columns and rows.
    pub tiles: [u32; 2],
    /// A byte for each tile, row by row, top row first: a texel of a rate image (`ShadingRate::texel`), and the bit `STALE`
    /// where the tile need not be rendered at all. Where the rates are to be decided on the GPU and cannot be, these hold.
    pub rates: *const u8,
    /// 1 where the rates of the tiles are to be decided on the GPU, by the fields below; else 0.
    pub is_decided: u32,
    /// 1 where contrast counts, and the eye buffers of this eye are to be analysed; else 0.
    pub is_judged: u32,
    /// Parameters of the decision as long as no contrast is known, or none counts.
    pub fixed: DecideParams,
    /// Parameters of the decision where contrast counts.
    pub judged: DecideParams,
    /// Orientation of the view in a space that rests in the world: x, y, z, w.
    pub orientation: [f32; 4],
}

/// A finished eye buffer that is to be analysed: its contrast decides the rates of later frames, once its view is known.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EyeBufferRecord {
    /// 0: left, 1: right.
    pub eye: u32,
    /// Family and index of the queue on which it was written, and which this thread may use now.
    pub queue: [u32; 2],
    /// The XrSwapchain that it belongs to; that is said to end before its images are destroyed.
    pub swapchain: u64,
    /// Image that contains it, with the usage SAMPLED; in COLOR_ATTACHMENT_OPTIMAL, unless the application's submits left it in another
    /// layout.
    pub image: vk::Image,
    /// Format of the view that it is read through.
    pub format: vk::Format,
    /// Its array layer.
    pub layer: u32,
    /// x, y, width, height, pixels.
    pub rect: [u32; 4],
    /// Luminance of white, cd/m^2.
    pub white_cd_m2: f32,
    /// 1: the mean contrast of a tile counts; 0: the greatest.
    pub is_mean: u32,
}

/// The view that a frame shows an eye buffer in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EyeViewRecord {
    /// As in [`EyeBufferRecord`].
    pub eye: u32,
    /// As in [`EyeBufferRecord`].
    pub swapchain: u64,
    /// As in [`EyeBufferRecord`].
    pub layer: u32,
    /// As in [`EyeBufferRecord`].
    pub rect: [u32; 4],
    /// [`ImagePlane::origin`](parafovea_core::geometry::ImagePlane::origin) of its view, and the step.
    pub plane: [[f32; 2]; 2],
    /// Orientation of its view, as [`EyeMapRecord::orientation`].
    pub orientation: [f32; 4],
}

/// The start of a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FrameStart {
    /// The settings, or null if they stay.
    pub settings: *const SettingsRecord,
    /// The newest plan, or null if the last one stays.
    pub plan: *const PlanRecord,
    /// The pending plan of this frame, or null for none.
    pub awaited: *const AwaitedPlan,
}

/// A plan that is being made, for the first submit that needs it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AwaitedPlan {
    /// Returns when [`LinkTable::begin_frame`](crate::link::LinkTable::begin_frame) was called with the plan, if it is another than the last
    /// one; calls neither Vulkan nor OpenXR. `None` withdraws the last function: it is not called any more when `begin_frame` returns.
    pub finish: Option<unsafe extern "C" fn(context: *const c_void)>,
    /// Its argument.
    pub context: *const c_void,
}

/// Most times of frames in a [`FrameReportRecord`]; more come with the next one.
pub const MOST_FRAME_TIMES: usize = 8;

/// The report on a frame that ended.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FrameReportRecord {
    /// Number of the frame, from 1.
    pub frame: u64,
    /// Number of passes that were recognised and had the plan's rates.
    pub passes_with_rates: u32,
    /// Number that distinguishes the set of passes recognised as an eye buffer, whether rates are on or not, from other sets; 0: there was
    /// none.
    pub eye_passes: u32,
    /// Pixels of the largest picture of these passes; 0: there were none.
    pub eye_pixels: u32,
    /// Whether passes read eye buffers of earlier frames: [`Feedback::number`](crate::pass_detection::Feedback::number).
    pub feedback: u32,
    /// Number of decisions so far ([`LinkTable::decision`](super::LinkTable::decision)).
    pub decisions: u32,
    /// Frames from the next one on whose passes are not followed, whether or not they end with a record.
    pub untracked_frames: u32,
    /// Number of `times`.
    pub time_count: u32,
    /// GPU times of frames that became known, in the order of the frames: a frame or more after each has ended, and of some never.
    pub times: [FrameTimeRecord; MOST_FRAME_TIMES],
    /// Stale tiles of the left and of the right eye buffer. The caller sets `words` and `capacity`.
    pub stale: [StaleRecord; 2],
}

/// The stale tiles of an eye buffer, left out by the maps of all of its passes together, as `StaleTiles` has them.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StaleRecord {
    /// Size of the picture that the plan was made for, pixels.
    pub extent: [u32; 2],
    /// Size of a tile, pixels.
    pub texel: [u32; 2],
    /// Destination of the words, if there is room for all.
    pub words: *mut u32,
    /// Capacity of `words`, in words.
    pub capacity: u32,
    /// Number of words, 0 for a fresh picture; the caller asks again with more room if it exceeds `capacity`.
    pub count: u32,
}

/// The submission of one xrEndFrame.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ShownRecord {
    /// `view_count` views of projection layers.
    pub views: *const ShownViewRecord,
    /// Number of views.
    pub view_count: u32,
    /// `flat_count` swapchains (XrSwapchain) of layers of other kinds.
    pub flat: *const u64,
    /// Number of swapchains in `flat`.
    pub flat_count: u32,
    /// `depth_count` swapchains (XrSwapchain) that are submitted as depth.
    pub depth: *const u64,
    /// Number of swapchains in `depth`.
    pub depth_count: u32,
    /// Frames since the last record, without this one, that ended without one.
    pub skipped_frames: u32,
}

/// [`ShownViewRecord::eye`] of a view that is neither eye's whole picture, such as an inset of quad views.
pub const NO_EYE: u32 = 2;

/// [`ShownViewRecord::image_index`] if the image released last is unknown.
pub const NO_IMAGE: u32 = u32::MAX;

/// One view of a projection layer.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShownViewRecord {
    /// 0: left, 1: right, [`NO_EYE`].
    pub eye: u32,
    /// The XrSwapchain.
    pub swapchain: u64,
    /// Index of the image that was released last, or [`NO_IMAGE`].
    pub image_index: u32,
    /// `imageArrayIndex`.
    pub layer: u32,
    /// `imageRect`: x, y, width, height, pixels.
    pub rect: [u32; 4],
    /// 1 where the field of view is upside-down (angleUp < angleDown), else 0.
    pub is_upside_down: u32,
}

/// Settings of the Vulkan half, from the configuration.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct SettingsRecord {
    /// 1: passes that are recognised get the plan's rates; 0: all stays at 1x1.
    pub is_on: u32,
    /// The only `BACKEND_*` that is allowed, or [`BACKEND_ANY`].
    pub backend: u32,
    /// 1: frames are timed, where the device is no CPU; 0: none is.
    pub times_frames: u32,
    /// `rates.passes`: rules in UTF-8, as `PassRules` of the configuration reads and writes them.
    pub passes: *const u8,
    /// Bytes of `passes`.
    pub passes_len: u32,
}

/// GPU time of a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct FrameTimeRecord {
    /// Number of the frame, as [`FrameReportRecord::frame`].
    pub frame: u64,
    /// GPU time of the frame, from the first to the last command on all queues, this half's commands included, nanoseconds.
    pub ns: u64,
    /// Of that, time for rate images, masks, and the decision on rates, nanoseconds.
    pub maps_ns: u64,
    /// Of that, time for contrast of finished pictures, nanoseconds.
    pub analysis_ns: u64,
}

/// Destination for a copy of the rates that the GPU decided for an eye's tiles.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct RatesCopyRecord {
    /// 0: left, 1: right.
    pub eye: u32,
    /// Family and index of the queue that the copy is submitted to, and which this thread may use now.
    pub queue: [u32; 2],
    /// Columns and rows of the tiles; nothing is copied if they differ.
    pub tiles: [u32; 2],
    /// A buffer that may be copied to, and lives until a later submit to that queue has finished. Fragment shaders may be reading it.
    pub buffer: vk::Buffer,
    /// Offset in `buffer`, bytes, a multiple of 4. A byte is copied for each tile (`ShadingRate::texel`), in rows that begin with whole words.
    pub offset: u64,
}

/// A decision of the Vulkan half on a device or a pass. Its texts are UTF-8, and valid for the life of the process.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct DecisionRecord {
    /// Its subject: [`Topic::number`](crate::status::Topic::number).
    pub topic: u32,
    /// One line, as in the log.
    pub line: *const u8,
    /// Bytes of `line`.
    pub line_len: u32,
    /// [`Topic::reason`](crate::status::Topic::reason) of the subject.
    pub reason: *const u8,
    /// Bytes of `reason`.
    pub reason_len: u32,
}
