//! Images and their views.

use super::chain::find;
use super::lower::{self, RATE_USAGE};
use super::physical_device::FORMAT;
use super::replay::Subresource;
use super::{Emulator, emulator};
use ash::vk;

pub(super) struct Image {
    pub usage: vk::ImageUsageFlags,
    pub extent: vk::Extent3D,
    pub layers: u32,
    pub levels: u32,
    /// Of each level and, within it, each layer, as the submits so far left them; only for rate images.
    pub subresources: Vec<Subresource>,
}

impl Image {
    pub fn is_rate(&self) -> bool {
        self.usage.contains(RATE_USAGE)
    }
}

/// A view; without facts for a view of an image of the swapchain.
#[derive(Clone, Copy)]
pub(super) struct View {
    pub image: vk::Image,
    pub format: vk::Format,
    /// Usage of the image, or the view's own subset of it; None if the image is unknown.
    pub usage: Option<vk::ImageUsageFlags>,
    pub range: Range,
    /// Of its level.
    pub extent: vk::Extent2D,
}

/// Some levels and layers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Range {
    pub level: u32,
    pub levels: u32,
    pub layer: u32,
    pub layers: u32,
}

impl Range {
    pub fn of(range: &vk::ImageSubresourceRange, image: &Image) -> Self {
        let or_rest =
            |count, rest, all: u32, first| if count == rest { all.saturating_sub(first) } else { count };
        let (level, layer) = (range.base_mip_level, range.base_array_layer);
        Self {
            level,
            levels: or_rest(range.level_count, vk::REMAINING_MIP_LEVELS, image.levels, level),
            layer,
            layers: or_rest(range.layer_count, vk::REMAINING_ARRAY_LAYERS, image.layers, layer),
        }
    }

    pub fn of_layers(layers: &vk::ImageSubresourceLayers) -> Self {
        let (layer, count) = (layers.base_array_layer, layers.layer_count);
        Self { level: layers.mip_level, levels: 1, layer, layers: count }
    }
}

const KIND: &str = "image";

fn check(emulator: &Emulator, info: &vk::ImageCreateInfo<'_>, image: vk::Image) {
    if !info.usage.contains(RATE_USAGE) {
        return;
    }
    let findings = &mut emulator.state().findings;
    let mut require = |holds, rule: &str, message: String| {
        findings.require(holds, KIND, rule, image, || message);
    };
    let two = info.image_type == vk::ImageType::TYPE_2D;
    require(two, "VUID-VkImageCreateInfo-imageType-02082", format!("{:?}", info.image_type));
    let single = info.samples == vk::SampleCountFlags::TYPE_1;
    require(single, "VUID-VkImageCreateInfo-samples-02083", format!("{:?}", info.samples));
    let supported = info.format == FORMAT && info.tiling == vk::ImageTiling::OPTIMAL;
    let rule = "VUID-VkImageCreateInfo-imageCreateMaxMipLevels-02251";
    require(supported, rule, format!("{:?} in {:?}", info.format, info.tiling));
    require(emulator.enabled.attachment, "attachmentFragmentShadingRate", "image with the usage".to_owned());
}

/// # Safety
/// As `vkCreateImage`.
pub(super) unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::ImageCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    image: *mut vk::Image,
) -> vk::Result {
    // SAFETY: the application's valid arguments, with another usage.
    unsafe {
        let emulator = emulator(device);
        let info = *info;
        let lowered = vk::ImageCreateInfo { usage: lower::usage(info.usage), ..info };
        let result = (emulator.v1_0().create_image)(device, &lowered, allocator, image);
        let created = result == vk::Result::SUCCESS;
        check(&emulator, &info, if created { *image } else { vk::Image::null() });
        if created {
            let subresource = Subresource::new(info.initial_layout);
            let rate = info.usage.contains(RATE_USAGE);
            let count = if rate { info.mip_levels * info.array_layers } else { 0 };
            let known = Image {
                usage: info.usage,
                extent: info.extent,
                layers: info.array_layers,
                levels: info.mip_levels,
                subresources: vec![subresource; count as usize],
            };
            emulator.state().images.insert(*image, known);
        }
        result
    }
}

/// # Safety
/// As `vkDestroyImage`.
pub(super) unsafe extern "system" fn destroy(
    device: vk::Device,
    image: vk::Image,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let emulator = emulator(device);
        emulator.state().images.remove(&image);
        (emulator.v1_0().destroy_image)(device, image, allocator);
    }
}

/// # Safety
/// As `vkGetDeviceImageMemoryRequirements`.
pub(super) unsafe extern "system" fn memory_requirements(
    device: vk::Device,
    info: *const vk::DeviceImageMemoryRequirements<'_>,
    requirements: *mut vk::MemoryRequirements2<'_>,
) {
    // SAFETY: the application's valid arguments, with another usage.
    unsafe {
        let Some(next) = emulator(device).functions.image_memory_requirements else { return };
        let mut info = *info;
        let mut image = *info.p_create_info;
        image.usage = lower::usage(image.usage);
        info.p_create_info = &image;
        next(device, &info, requirements);
    }
}

/// # Safety
/// As `vkCreateImageView`.
pub(super) unsafe extern "system" fn create_view(
    device: vk::Device,
    info: *const vk::ImageViewCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    view: *mut vk::ImageView,
) -> vk::Result {
    // SAFETY: the application's valid arguments, with another usage.
    unsafe {
        let emulator = emulator(device);
        let mut lowered = *info;
        let chained = find::<vk::ImageViewUsageCreateInfo<'_>>((*info).p_next);
        let mut usage;
        let mut left_out = super::chain::LeftOut::new();
        if let Some(chained) = chained.filter(|chained| chained.usage.contains(RATE_USAGE)) {
            left_out.leave_out(&mut lowered, vk::StructureType::IMAGE_VIEW_USAGE_CREATE_INFO);
            usage = *chained;
            usage.usage = lower::usage(usage.usage);
            usage.p_next = lowered.p_next;
            lowered.p_next = (&raw const usage).cast();
        }
        let result = (emulator.v1_0().create_image_view)(device, &lowered, allocator, view);
        drop(left_out);
        let created = result == vk::Result::SUCCESS;
        let handle = if created { *view } else { vk::ImageView::null() };
        let known = check_view(&emulator, &*info, chained.map(|chained| chained.usage), handle);
        if created {
            emulator.state().views.insert(handle, known);
        }
        result
    }
}

fn check_view(
    emulator: &Emulator,
    info: &vk::ImageViewCreateInfo<'_>,
    chained: Option<vk::ImageUsageFlags>,
    view: vk::ImageView,
) -> View {
    let mut state = emulator.state();
    let state = &mut *state;
    let Some(image) = state.images.get(&info.image) else {
        let range = Range { level: 0, levels: 0, layer: 0, layers: 0 };
        return View {
            image: info.image,
            format: info.format,
            usage: None,
            range,
            extent: vk::Extent2D::default(),
        };
    };
    let range = Range::of(&info.subresource_range, image);
    let usage = chained.unwrap_or(image.usage);
    if image.is_rate() {
        let flat = [vk::ImageViewType::TYPE_2D, vk::ImageViewType::TYPE_2D_ARRAY].contains(&info.view_type);
        let rule = "VUID-VkImageViewCreateInfo-image-02086";
        state.findings.require(flat, KIND, rule, view, || format!("{:?}", info.view_type));
    }
    if usage.contains(RATE_USAGE) && emulator.enabled.attachment {
        let rule = "VUID-VkImageViewCreateInfo-usage-04550";
        state.findings.require(info.format == FORMAT, KIND, rule, view, || format!("{:?}", info.format));
        let rule = "VUID-VkImageViewCreateInfo-usage-04551";
        let layers = range.layers;
        state.findings.require(emulator.profile.layered() || layers == 1, KIND, rule, view, || {
            format!("{layers} layers, and the device has no layeredShadingRateAttachments")
        });
    }
    let side = |whole: u32| (whole >> range.level).max(1);
    let extent = vk::Extent2D { width: side(image.extent.width), height: side(image.extent.height) };
    View { image: info.image, format: info.format, usage: Some(usage), range, extent }
}

/// # Safety
/// As `vkDestroyImageView`.
pub(super) unsafe extern "system" fn destroy_view(
    device: vk::Device,
    view: vk::ImageView,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let emulator = emulator(device);
        emulator.state().views.remove(&view);
        (emulator.v1_0().destroy_image_view)(device, view, allocator);
    }
}
