//! The swapchains of the projection layer, in each of the arrangements.

use std::ffi::c_void;

use anyhow::{Context, Result};
use glam::Vec3;
use openxr as xr;

use super::swapchain::Swapchain;
use crate::camera::{Camera, FAR, NEAR};
use crate::options::{Arrangement, Options};
use crate::renderer::{DEPTH_FORMAT, FoveatedImage, Foveator, Pass, Rect, Renderer, depth_buffer};

const EYES: usize = 2;

/// Position of an eye buffer in the swapchains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Slot {
    swapchain: usize,
    layer: u32,
    rect: Rect,
}

impl Arrangement {
    fn slots(self, [width, height]: [u32; 2]) -> [Slot; EYES] {
        [0, 1].map(|eye| {
            let (swapchain, layer, x) = match self {
                Self::Separate => (eye as usize, 0, 0),
                Self::Array => (0, eye, 0),
                Self::DoubleWide => (0, 0, eye * width),
            };
            Slot { swapchain, layer, rect: Rect { x, y: 0, width, height } }
        })
    }

    /// Number of swapchains, their array layers, and their width in eyes.
    fn shape(self) -> (usize, u32, u32) {
        match self {
            Self::Separate => (2, 1, 1),
            Self::Array => (1, 2, 1),
            Self::DoubleWide => (1, 1, 2),
        }
    }
}

/// Depth buffers.
enum Depth {
    /// Buffers of our own by swapchain and layer.
    Kept(Vec<Vec<wgpu::TextureView>>),
    /// Swapchains beside the colour ones.
    Submitted(Vec<Swapchain>),
}

/// Resources of fixed foveation, by swapchain and layer.
struct Foveated {
    foveator: Foveator,
    images: Vec<Vec<FoveatedImage>>,
}

/// The images of the projection layer.
pub struct Projection {
    slots: [Slot; EYES],
    layers: u32,
    colour: Vec<Swapchain>,
    depth: Depth,
    foveated: Option<Foveated>,
}

impl Projection {
    /// Makes the swapchains for eyes of `size` texels, and swapchains for depth if the options require them.
    ///
    /// # Errors
    /// Errors of xrCreateSwapchain.
    pub fn new(
        session: &xr::Session<xr::Vulkan>,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        options: &Options,
        format: wgpu::TextureFormat,
        size: [u32; 2],
    ) -> Result<Self> {
        let (arrangement, is_copied) = (options.swapchain, options.foveation.is_some());
        let (count, layers, eyes_wide) = arrangement.shape();
        let [width, height] = [size[0] * eyes_wide, size[1]];
        let swapchains = |format| {
            (0..count)
                .map(|_| Swapchain::new(session, device, format, [width, height], layers, is_copied))
                .collect::<Result<_>>()
        };
        let depth = if options.depth_layer {
            Depth::Submitted(swapchains(DEPTH_FORMAT).context("a depth swapchain")?)
        } else {
            let buffers = || (0..layers).map(|_| depth_buffer(device, width, height)).collect();
            Depth::Kept((0..count).map(|_| buffers()).collect())
        };
        let colour = swapchains(format).context("a colour swapchain")?;
        let foveated = options.foveation().map(|foveation| {
            let foveator = Foveator::new(device, queue, format, foveation);
            let image = |_| foveator.image(device, [width, height], format);
            let images = (0..count).map(|_| (0..layers).map(image).collect()).collect();
            Foveated { foveator, images }
        });
        Ok(Self { slots: arrangement.slots(size), layers, colour, depth, foveated })
    }

    fn swapchains(&mut self) -> impl Iterator<Item = &mut Swapchain> {
        let depth: &mut [Swapchain] = match &mut self.depth {
            Depth::Submitted(swapchains) => swapchains,
            Depth::Kept(_) => &mut [],
        };
        self.colour.iter_mut().chain(depth)
    }

    /// Takes the next image of each swapchain.
    ///
    /// # Errors
    /// Errors of [`Swapchain::acquire`].
    pub fn acquire(&mut self) -> Result<()> {
        self.swapchains().try_for_each(Swapchain::acquire)
    }

    /// Gives the images back.
    ///
    /// # Errors
    /// Errors of [`Swapchain::release`].
    pub fn release(&mut self) -> Result<()> {
        self.swapchains().try_for_each(Swapchain::release)
    }

    /// Records a pass for each image and layer; the gaze is a direction in the world, which counts only with foveation.
    pub fn draw(
        &self,
        renderer: &Renderer,
        encoder: &mut wgpu::CommandEncoder,
        cameras: &[Camera],
        gaze: Vec3,
    ) {
        for (index, colour) in self.colour.iter().enumerate() {
            for layer in 0..self.layers {
                let views: Vec<_> = (0..EYES)
                    .map(|eye| (eye, self.slots[eye]))
                    .filter(|(_, slot)| (slot.swapchain, slot.layer) == (index, layer))
                    .map(|(eye, slot)| (eye, slot.rect))
                    .collect();
                let foveated =
                    self.foveated.as_ref().map(|all| (&all.foveator, &all.images[index][layer as usize]));
                let (depth, keep_depth) = match (&self.depth, foveated) {
                    (_, Some((_, image))) => (&image.depth, true),
                    (Depth::Kept(buffers), None) => (&buffers[index][layer as usize], false),
                    (Depth::Submitted(swapchains), None) => (swapchains[index].view(layer), true),
                };
                let pass = Pass {
                    colour: colour.view(layer),
                    depth,
                    clear_depth: foveated.is_none(),
                    keep_depth,
                    views: &views,
                };
                let Some((foveator, image)) = foveated else {
                    renderer.draw(encoder, &pass);
                    continue;
                };
                let seen: Vec<_> = views.iter().map(|(eye, rect)| (cameras[*eye], *rect)).collect();
                foveator.begin(encoder, image, gaze, &seen);
                renderer.draw(encoder, &pass);
                foveator.finish(encoder, image, (colour.texture(), layer), colour.view(layer), &seen);
            }
        }
    }

    /// Description of each eye's depth for the runtime, if it is submitted.
    pub fn depth_infos(&self) -> Vec<xr::sys::CompositionLayerDepthInfoKHR> {
        let Depth::Submitted(swapchains) = &self.depth else { return Vec::new() };
        let info = |slot: &Slot| xr::sys::CompositionLayerDepthInfoKHR {
            ty: xr::sys::CompositionLayerDepthInfoKHR::TYPE,
            next: std::ptr::null(),
            sub_image: xr::sys::SwapchainSubImage {
                swapchain: swapchains[slot.swapchain].handle().as_raw(),
                image_rect: image_rect(slot),
                image_array_index: slot.layer,
            },
            min_depth: 0.0,
            max_depth: 1.0,
            near_z: NEAR,
            far_z: FAR,
        };
        self.slots.iter().map(info).collect()
    }

    /// The views of the projection layer, with the eyes' poses at which they were drawn. `depths` is the result of
    /// [`Self::depth_infos`].
    pub fn layer_views<'a>(
        &'a self,
        views: &[xr::View],
        depths: &'a [xr::sys::CompositionLayerDepthInfoKHR],
    ) -> Vec<xr::CompositionLayerProjectionView<'a, xr::Vulkan>> {
        let layer_view = |(eye, (slot, view)): (usize, (&Slot, &xr::View))| {
            let sub_image = xr::SwapchainSubImage::new()
                .swapchain(self.colour[slot.swapchain].handle())
                .image_array_index(slot.layer)
                .image_rect(image_rect(slot));
            let plain =
                xr::CompositionLayerProjectionView::new().pose(view.pose).fov(view.fov).sub_image(sub_image);
            let Some(depth) = depths.get(eye) else { return plain };
            let mut raw = plain.into_raw();
            raw.next = std::ptr::from_ref(depth).cast::<c_void>();
            // SAFETY: the result borrows `self` and `depths`, to which the structure points.
            unsafe { xr::CompositionLayerProjectionView::from_raw(raw) }
        };
        self.slots.iter().zip(views).enumerate().map(layer_view).collect()
    }
}

fn image_rect(slot: &Slot) -> xr::Rect2Di {
    xr::Rect2Di {
        offset: xr::Offset2Di { x: slot.rect.x as i32, y: slot.rect.y as i32 },
        extent: xr::Extent2Di { width: slot.rect.width as i32, height: slot.rect.height as i32 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In each arrangement every eye's rectangle lies inside its image and overlaps no other's.
    #[test]
    fn slots_fit_their_swapchains_and_are_apart() {
        for arrangement in [Arrangement::Separate, Arrangement::Array, Arrangement::DoubleWide] {
            let (count, layers, eyes_wide) = arrangement.shape();
            let [left, right] = arrangement.slots([100, 80]);
            for slot in [left, right] {
                assert!(slot.swapchain < count && slot.layer < layers, "{arrangement:?} {slot:?}");
                assert!(slot.rect.x + slot.rect.width <= 100 * eyes_wide, "{arrangement:?} {slot:?}");
            }
            let same_image = (left.swapchain, left.layer) == (right.swapchain, right.layer);
            assert!(!same_image || left.rect.x + left.rect.width <= right.rect.x, "{arrangement:?}");
        }
    }
}
