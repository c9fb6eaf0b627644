//! Requirements of a style, and whether a device meets them.

use crate::gpu::HeapFeatures;
use anyhow::Result;
use ash::vk;
use std::ffi::{CStr, CString};

/// A feature of a Vulkan device.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs, reason = "the names are the specification's")]
pub enum Feature {
    Multiview,
    DynamicRendering,
    ImagelessFramebuffer,
    GraphicsPipelineLibrary,
    ConditionalRendering,
    PipelineFragmentShadingRate,
    AttachmentFragmentShadingRate,
    Maintenance5,
    ShaderObject,
    DescriptorBuffer,
    DescriptorHeap,
    BufferDeviceAddress,
    FragmentStoresAndAtomics,
    MultiViewport,
    MultiDrawIndirect,
    DrawIndirectFirstInstance,
}

/// Requirements of a style.
#[derive(Clone, Copy, Debug)]
pub struct Needs {
    /// The Vulkan version that it asks for, as Vulkan encodes it.
    pub vulkan: u32,
    /// Vulkan device extensions.
    pub extensions: &'static [&'static CStr],
    /// Features of the device.
    pub features: &'static [Feature],
    /// Queues of the graphics family.
    pub queues: Queues,
    /// Extra OpenXR swapchains and extensions.
    pub openxr: OpenXr,
}

/// Queues that a style uses.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Queues {
    /// One for everything.
    One,
    /// A second one where there is one.
    SecondIfThere,
    /// Two of a family.
    Two,
    /// Two of different families, which both draw.
    TwoFamilies,
}

impl Queues {
    /// Whether a device with one queue lacks them.
    pub fn are_two(self) -> bool {
        matches!(self, Self::Two | Self::TwoFamilies)
    }
}

/// A style's requests to OpenXR beyond colour for each eye.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct OpenXr {
    /// Colour swapchains that are written by copies and blits.
    pub copied: bool,
    /// Depth swapchains, submitted with XR_KHR_composition_layer_depth.
    pub depth: bool,
    /// A quad layer with a swapchain of its own.
    pub quad: bool,
    /// The hidden part of each view, by XR_KHR_visibility_mask.
    pub hidden_area: bool,
}

impl OpenXr {
    /// Colour for each eye alone.
    pub const NOTHING: Self = Self { copied: false, depth: false, quad: false, hidden_area: false };
}

impl Needs {
    /// Vulkan 1.1 and nothing else.
    pub const NOTHING: Self = Self {
        vulkan: vk::API_VERSION_1_1,
        extensions: &[],
        features: &[],
        queues: Queues::One,
        openxr: OpenXr::NOTHING,
    };

    /// Vulkan 1.3 with dynamic rendering.
    pub const DYNAMIC: Self =
        Self { vulkan: vk::API_VERSION_1_3, features: &[Feature::DynamicRendering], ..Self::NOTHING };

    /// The same for a device and an instance, with the requirements of rate attachments if they are wanted too.
    pub(crate) fn demands(&self, with_rates: bool) -> Demands {
        let mut demands = Demands {
            vulkan: self.vulkan,
            extensions: self.extensions.to_vec(),
            features: self.features.to_vec(),
            queues: self.queues,
        };
        if with_rates {
            // vkCreateRenderPass2 is in 1.2.
            demands.vulkan = demands.vulkan.max(vk::API_VERSION_1_2);
            demands.extensions.push(c"VK_KHR_fragment_shading_rate");
            demands.features.push(Feature::AttachmentFragmentShadingRate);
        }
        demands
    }
}

/// Requirements on Vulkan.
pub(crate) struct Demands {
    /// As [`Needs::vulkan`].
    pub vulkan: u32,
    /// As [`Needs::extensions`].
    pub extensions: Vec<&'static CStr>,
    /// As [`Needs::features`].
    pub features: Vec<Feature>,
    /// As [`Needs::queues`].
    pub queues: Queues,
}

impl Demands {
    /// Missing requirements of the device; empty if it meets all.
    ///
    /// # Errors
    /// Errors of Vulkan's queries.
    pub(crate) fn lacking(
        &self,
        instance: &ash::Instance,
        device: vk::PhysicalDevice,
    ) -> Result<Option<String>> {
        // SAFETY: the physical device is of this instance.
        let properties = unsafe { instance.get_physical_device_properties(device) };
        if properties.api_version < self.vulkan {
            let version = (vk::api_version_major(self.vulkan), vk::api_version_minor(self.vulkan));
            return Ok(Some(format!("Vulkan {}.{}", version.0, version.1)));
        }
        // SAFETY: as above.
        let extensions = unsafe { instance.enumerate_device_extension_properties(device) }?;
        let has =
            |name: &CStr| extensions.iter().any(|has| has.extension_name_as_c_str().is_ok_and(|n| n == name));
        if let Some(name) = self.extensions.iter().find(|name| !has(name)) {
            return Ok(Some(name.to_string_lossy().into_owned()));
        }
        // SAFETY: as above.
        let families = unsafe { instance.get_physical_device_queue_family_properties(device) };
        let graphics = families.iter().find(|family| family.queue_flags.contains(vk::QueueFlags::GRAPHICS));
        if self.queues == Queues::Two && graphics.is_none_or(|family| family.queue_count < 2) {
            return Ok(Some("a second graphics queue".to_owned()));
        }
        let drawing = families.iter().filter(|family| family.queue_flags.contains(vk::QueueFlags::GRAPHICS));
        if self.queues == Queues::TwoFamilies && drawing.count() < 2 {
            return Ok(Some("a second family of graphics queues".to_owned()));
        }
        let mut features = Features::default();
        // SAFETY: as above; the chain holds structures of extensions that the device has.
        features
            .chained(&self.features, |all| unsafe { instance.get_physical_device_features2(device, all) });
        Ok(self.features.iter().find(|one| *features.flag(**one) == vk::FALSE).map(|one| format!("{one:?}")))
    }

    /// The device extensions as owned names.
    pub(crate) fn extension_names(&self) -> Vec<CString> {
        self.extensions.iter().map(|&name| CString::from(name)).collect()
    }
}

/// Vulkan's feature structures; a chain contains the needed ones.
#[derive(Default)]
pub(crate) struct Features {
    core: vk::PhysicalDeviceFeatures,
    multiview: vk::PhysicalDeviceMultiviewFeatures<'static>,
    dynamic_rendering: vk::PhysicalDeviceDynamicRenderingFeatures<'static>,
    imageless: vk::PhysicalDeviceImagelessFramebufferFeatures<'static>,
    pipeline_library: vk::PhysicalDeviceGraphicsPipelineLibraryFeaturesEXT<'static>,
    conditional: vk::PhysicalDeviceConditionalRenderingFeaturesEXT<'static>,
    shading_rate: vk::PhysicalDeviceFragmentShadingRateFeaturesKHR<'static>,
    maintenance5: vk::PhysicalDeviceMaintenance5FeaturesKHR<'static>,
    shader_object: vk::PhysicalDeviceShaderObjectFeaturesEXT<'static>,
    descriptor_buffer: vk::PhysicalDeviceDescriptorBufferFeaturesEXT<'static>,
    descriptor_heap: HeapFeatures,
    buffer_address: vk::PhysicalDeviceBufferDeviceAddressFeatures<'static>,
}

impl Features {
    /// Only these.
    pub(crate) fn of(needed: &[Feature]) -> Self {
        let mut features = Self::default();
        needed.iter().for_each(|feature| *features.flag(*feature) = vk::TRUE);
        features
    }

    fn flag(&mut self, feature: Feature) -> &mut vk::Bool32 {
        match feature {
            Feature::Multiview => &mut self.multiview.multiview,
            Feature::DynamicRendering => &mut self.dynamic_rendering.dynamic_rendering,
            Feature::ImagelessFramebuffer => &mut self.imageless.imageless_framebuffer,
            Feature::GraphicsPipelineLibrary => &mut self.pipeline_library.graphics_pipeline_library,
            Feature::ConditionalRendering => &mut self.conditional.conditional_rendering,
            Feature::PipelineFragmentShadingRate => &mut self.shading_rate.pipeline_fragment_shading_rate,
            Feature::AttachmentFragmentShadingRate => &mut self.shading_rate.attachment_fragment_shading_rate,
            Feature::Maintenance5 => &mut self.maintenance5.maintenance5,
            Feature::ShaderObject => &mut self.shader_object.shader_object,
            Feature::DescriptorBuffer => &mut self.descriptor_buffer.descriptor_buffer,
            Feature::DescriptorHeap => &mut self.descriptor_heap.descriptor_heap,
            Feature::BufferDeviceAddress => &mut self.buffer_address.buffer_device_address,
            Feature::FragmentStoresAndAtomics => &mut self.core.fragment_stores_and_atomics,
            Feature::MultiViewport => &mut self.core.multi_viewport,
            Feature::MultiDrawIndirect => &mut self.core.multi_draw_indirect,
            Feature::DrawIndirectFirstInstance => &mut self.core.draw_indirect_first_instance,
        }
    }

    /// Calls with the structures of these features in one chain.
    pub(crate) fn chained<R>(
        &mut self,
        needed: &[Feature],
        call: impl FnOnce(&mut vk::PhysicalDeviceFeatures2) -> R,
    ) -> R {
        let any = |features: &[Feature]| features.iter().any(|feature| needed.contains(feature));
        let mut all = vk::PhysicalDeviceFeatures2::default().features(self.core);
        if any(&[Feature::Multiview]) {
            all = all.push_next(&mut self.multiview);
        }
        if any(&[Feature::DynamicRendering]) {
            all = all.push_next(&mut self.dynamic_rendering);
        }
        if any(&[Feature::ImagelessFramebuffer]) {
            all = all.push_next(&mut self.imageless);
        }
        if any(&[Feature::GraphicsPipelineLibrary]) {
            all = all.push_next(&mut self.pipeline_library);
        }
        if any(&[Feature::ConditionalRendering]) {
            all = all.push_next(&mut self.conditional);
        }
        if any(&[Feature::PipelineFragmentShadingRate, Feature::AttachmentFragmentShadingRate]) {
            all = all.push_next(&mut self.shading_rate);
        }
        if any(&[Feature::Maintenance5]) {
            all = all.push_next(&mut self.maintenance5);
        }
        if any(&[Feature::ShaderObject]) {
            all = all.push_next(&mut self.shader_object);
        }
        if any(&[Feature::DescriptorBuffer]) {
            all = all.push_next(&mut self.descriptor_buffer);
        }
        if any(&[Feature::DescriptorHeap]) {
            all = all.push_next(&mut self.descriptor_heap);
        }
        if any(&[Feature::BufferDeviceAddress]) {
            all = all.push_next(&mut self.buffer_address);
        }
        let result = call(&mut all);
        self.core = all.features;
        result
    }
}
