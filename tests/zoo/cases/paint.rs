//! Draws figures into swapchain images: a render pass that clears, and a clear for every cell.

use crate::failure::Failure;
use crate::vulkan::Vulkan;
use ash::vk;
use parafovea_zoo::cases::pattern::{Cell, Figure};
use std::fs::File;
use std::path::Path;
use std::time::Duration;

/// Frames of work that may be on the queue before recording waits.
const RING: usize = 4;

/// Time for which the lock is held before a submit: enough for another thread to reach it.
const HELD: Duration = Duration::from_millis(2);

/// Code value of the texels that no figure covers.
const BACKGROUND: [u8; 4] = [24, 24, 24, 255];

/// Records and submits on the application's queue.
pub struct Painter {
    device: ash::Device,
    queue: vk::Queue,
    pool: vk::CommandPool,
    ring: Vec<(vk::CommandBuffer, vk::Fence)>,
    next: usize,
    /// Locked around each submit.
    lock: Option<File>,
}

/// Target of one render pass.
#[derive(Clone, Copy)]
pub struct Target {
    pub render_pass: vk::RenderPass,
    pub framebuffer: vk::Framebuffer,
    pub extent: vk::Extent2D,
    pub texels: Texels,
}

/// Encoding of a clear value in the attachment.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Texels {
    /// Linear code values, 8 bits a channel.
    Unorm,
    /// Code values that the hardware encodes with the sRGB curve.
    Srgb,
    /// Depth.
    Depth,
}

impl Painter {
    /// With a file whose lock is held around each submit, as an engine holds the lock of its queue.
    pub fn create(vulkan: &Vulkan, lock: Option<&Path>) -> Result<Self, Failure> {
        let device = vulkan.device.clone();
        let info = vk::CommandPoolCreateInfo::default()
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER)
            .queue_family_index(vulkan.queue_family);
        // SAFETY: the device is live until the application drops this painter.
        let pool = unsafe { device.create_command_pool(&info, None) }?;
        let info =
            vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(RING as u32);
        let signaled = vk::FenceCreateInfo::default().flags(vk::FenceCreateFlags::SIGNALED);
        // SAFETY: as above.
        let ring = unsafe { device.allocate_command_buffers(&info) }?
            .into_iter()
            .map(|buffer| {
                // SAFETY: as above.
                Ok((buffer, unsafe { device.create_fence(&signaled, None) }?))
            })
            .collect::<Result<_, Failure>>()?;
        let lock = lock.map(File::open).transpose()?;
        Ok(Self { device, queue: vulkan.queue, pool, ring, next: 0, lock })
    }

    /// Draws into each target its figures, all in one submit.
    pub fn draw(&mut self, targets: &[(Target, Vec<Figure>)]) -> Result<(), Failure> {
        let (commands, fence) = self.ring[self.next];
        self.next = (self.next + 1) % RING;
        let once = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the signalled fence proves that the command buffer is not in use; targets outlive their work
        // because a swapchain waits for the queue before it destroys them.
        unsafe {
            self.device.wait_for_fences(&[fence], true, u64::MAX)?;
            self.device.reset_fences(&[fence])?;
            self.device.begin_command_buffer(commands, &once)?;
            for (target, figures) in targets {
                self.record(commands, target, figures);
            }
            self.device.end_command_buffer(commands)?;
            let buffers = [commands];
            let submit = vk::SubmitInfo::default().command_buffers(&buffers);
            if let Some(lock) = &self.lock {
                lock.lock()?;
                std::thread::sleep(HELD);
            }
            self.device.queue_submit(self.queue, &[submit], fence)?;
            if let Some(lock) = &self.lock {
                lock.unlock()?;
            }
        }
        Ok(())
    }

    /// # Safety
    /// `commands` is being recorded, and `target` is live.
    unsafe fn record(&self, commands: vk::CommandBuffer, target: &Target, figures: &[Figure]) {
        let clear = [clear_value(BACKGROUND, target.texels)];
        let begin = vk::RenderPassBeginInfo::default()
            .render_pass(target.render_pass)
            .framebuffer(target.framebuffer)
            .render_area(target.extent.into())
            .clear_values(&clear);
        // SAFETY: guaranteed by this function's contract.
        unsafe {
            self.device.cmd_begin_render_pass(commands, &begin, vk::SubpassContents::INLINE);
            for cell in figures.iter().flat_map(Figure::cells) {
                self.clear(commands, target.texels, &cell);
            }
            self.device.cmd_end_render_pass(commands);
        }
    }

    /// # Safety
    /// `commands` is inside a render pass.
    unsafe fn clear(&self, commands: vk::CommandBuffer, texels: Texels, cell: &Cell) {
        let attachment = vk::ClearAttachment::default()
            .aspect_mask(texels.aspect())
            .clear_value(clear_value(cell.rgba, texels));
        let offset = vk::Offset2D { x: cell.rect.x as i32, y: cell.rect.y as i32 };
        let extent = vk::Extent2D { width: cell.rect.width, height: cell.rect.height };
        let rect = vk::ClearRect { rect: vk::Rect2D { offset, extent }, base_array_layer: 0, layer_count: 1 };
        // SAFETY: guaranteed by this function's contract; cells lie within the framebuffer.
        unsafe {
            self.device.cmd_clear_attachments(commands, &[attachment], &[rect]);
        }
    }
}

impl Drop for Painter {
    fn drop(&mut self) {
        // SAFETY: the queue is idle before its command buffers and fences go.
        unsafe {
            let _ = self.device.queue_wait_idle(self.queue);
            for (_, fence) in &self.ring {
                self.device.destroy_fence(*fence, None);
            }
            self.device.destroy_command_pool(self.pool, None);
        }
    }
}

impl Texels {
    /// The aspect of an attachment of such texels.
    pub fn aspect(self) -> vk::ImageAspectFlags {
        match self {
            Self::Depth => vk::ImageAspectFlags::DEPTH,
            Self::Unorm | Self::Srgb => vk::ImageAspectFlags::COLOR,
        }
    }
}

/// The value that makes the attachment store these code values; depth takes its value from the red channel.
fn clear_value(rgba: [u8; 4], texels: Texels) -> vk::ClearValue {
    let [red, green, blue, alpha] = rgba.map(|code| f32::from(code) / 255.0);
    match texels {
        Texels::Depth => {
            vk::ClearValue { depth_stencil: vk::ClearDepthStencilValue { depth: red, stencil: 0 } }
        }
        Texels::Unorm => color([red, green, blue, alpha]),
        Texels::Srgb => color([srgb_to_linear(red), srgb_to_linear(green), srgb_to_linear(blue), alpha]),
    }
}

fn color(float32: [f32; 4]) -> vk::ClearValue {
    vk::ClearValue { color: vk::ClearColorValue { float32 } }
}

/// IEC 61966-2-1, as the Khronos Data Format Specification 13.3.2 gives it.
fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}
