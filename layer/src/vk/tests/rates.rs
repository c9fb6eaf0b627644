//! The creation of instances and devices with rate attachments.

use super::fake::{self, rates};
use super::*;
use crate::backend::attachment::commands::SetRate;
use crate::link::BACKEND_RATE_ATTACHMENT;
use crate::vk::dispatch::armed_hook;
use crate::vk::recording;
use ash::vk::FragmentShadingRateCombinerOpKHR as Combiner;

/// The enabled extensions of a device, and its rate features.
struct Created {
    extensions: Vec<String>,
    features: [u32; 3],
    offers: bool,
}

fn created(version: u32, chain: *const c_void, refused: bool) -> Created {
    rates::capabilities(true, refused);
    let instance = new_instance(Some(version));
    let device = create_device(instance, fake::device_chain(chain, true).0, 1).unwrap();
    // SAFETY: the device is live.
    let armed = unsafe { device::of(device) }.and_then(|device| device.armed.clone()).unwrap();
    let offers = armed.capabilities().backend == BACKEND_RATE_ATTACHMENT;
    let created = Created { extensions: rates::enabled(), features: rates::features(), offers };
    destroy_device(device);
    destroy_instance(instance);
    rates::capabilities(false, false);
    created
}

#[test]
fn the_extension_its_dependencies_and_its_features_are_added() {
    let needed = [
        "VK_KHR_fragment_shading_rate",
        "VK_KHR_create_renderpass2",
        "VK_KHR_multiview",
        "VK_KHR_maintenance2",
    ];
    for (version, count) in [(vk::API_VERSION_1_0, 4), (vk::API_VERSION_1_1, 2), (vk::API_VERSION_1_2, 1)] {
        let created = created(version, null(), false);
        assert_eq!(created.extensions, needed[..count]);
        assert_eq!(created.features, [1, 0, 1]);
        assert!(created.offers);
    }
}

#[test]
fn an_instance_of_1_0_gets_the_questions_that_later_versions_have() {
    let enabled = |version| {
        destroy_instance(new_instance(version));
        rates::enabled()
    };
    assert_eq!(enabled(None), ["VK_KHR_get_physical_device_properties2"]);
    assert_eq!(enabled(Some(vk::API_VERSION_1_0)), ["VK_KHR_get_physical_device_properties2"]);
    assert_eq!(enabled(Some(vk::API_VERSION_1_1)), [""; 0]);
}

#[test]
fn an_applications_own_features_are_amended_and_stay_its_own() {
    let mut own =
        vk::PhysicalDeviceFragmentShadingRateFeaturesKHR::default().primitive_fragment_shading_rate(true);
    let own = &raw mut own;
    // Behind structures that this layer does not know, which are the usual case at the creation of a device.
    let created = created(vk::API_VERSION_1_2, unknown(1_000_000_000, own.cast()), false);
    assert_eq!(created.features, [1, 1, 1]);
    // SAFETY: it lives, and no other code uses it.
    let own = unsafe { *own };
    assert_eq!((own.pipeline_fragment_shading_rate, own.attachment_fragment_shading_rate), (0, 0));
}

/// The rate that is set when a fragment shader without a pipeline is bound, in an application that enables the extension by name, and chains
/// these features.
fn rate_of_shader_object(
    own: Option<vk::PhysicalDeviceFragmentShadingRateFeaturesKHR<'_>>,
) -> Option<SetRate> {
    rates::capabilities(true, false);
    let instance = new_instance(Some(vk::API_VERSION_1_2));
    let chain = own.as_ref().map_or(null(), |own| (&raw const *own).cast());
    let names = [vk::KHR_FRAGMENT_SHADING_RATE_NAME];
    let device = create_device_with(instance, fake::device_chain(chain, true).0, 1, &names).unwrap();
    // SAFETY: the device is live.
    let known = unsafe { device::of(device) }.unwrap();
    let attachments = known.rate_attachments().unwrap();
    assert!(attachments.sets_rates_at_bind, "the rates of pipelines may be set by commands");
    let rate = attachments.set_rates.bound_shader(fake::command_buffer_of(device), false);
    destroy_device(device);
    destroy_instance(instance);
    rates::capabilities(false, false);
    rate
}

/// An extension may be enabled without its features.
#[test]
fn an_application_sets_rates_if_it_enables_the_feature_of_the_extension() {
    let features = vk::PhysicalDeviceFragmentShadingRateFeaturesKHR::default;
    assert_eq!(rate_of_shader_object(Some(features().pipeline_fragment_shading_rate(true))), None);
    for own in [None, Some(features()), Some(features().primitive_fragment_shading_rate(true))] {
        assert!(rate_of_shader_object(own).is_some(), "{own:?}");
    }
}

/// As vkd3d-proton does: it sets all rates by commands, and begins passes with the attachment of the game and passes without.
#[test]
fn passes_with_an_attachment_of_the_applications_have_its_rates() {
    rates::capabilities(true, false);
    let instance = new_instance(Some(vk::API_VERSION_1_2));
    let features = vk::PhysicalDeviceFragmentShadingRateFeaturesKHR::default()
        .pipeline_fragment_shading_rate(true)
        .attachment_fragment_shading_rate(true);
    let names = [vk::KHR_FRAGMENT_SHADING_RATE_NAME];
    let chain = fake::device_chain((&raw const features).cast(), true).0;
    let device = create_device_with(instance, chain, 1, &names).unwrap();
    let handle = fake::command_buffer_of(device);
    // SAFETY: the device is live.
    let armed = unsafe { device::of(device) }.and_then(|device| device.armed.clone()).unwrap();
    let buffer = recording::keep(&armed, handle);
    let rates = armed.rate_attachments.as_ref();
    assert!(
        rates.is_some_and(|rates| rates.leaves_alone(vk::RenderPass::null())),
        "a secondary command buffer in dynamic rendering may have its attachment"
    );
    drop(armed);
    macro_rules! hook {
        ($name:literal: $pfn:ident) => {
            // SAFETY: the name gives the type.
            unsafe { transmute::<vk::PFN_vkVoidFunction, vk::$pfn>(armed_hook($name)) }
        };
    }
    let set = hook!(c"vkCmdSetFragmentShadingRateKHR": PFN_vkCmdSetFragmentShadingRateKHR);
    let begin = hook!(c"vkCmdBeginRenderingKHR": PFN_vkCmdBeginRendering);
    let end = hook!(c"vkCmdEndRenderingKHR": PFN_vkCmdEndRendering);
    let rate = |combiner| SetRate {
        size: vk::Extent2D { width: 1, height: 1 },
        combiners: [Combiner::KEEP, combiner],
    };
    let (keeps, obeys) = (rate(Combiner::KEEP), rate(Combiner::REPLACE));
    let view = vk::ImageView::from_raw(1);
    let mut own = vk::RenderingFragmentShadingRateAttachmentInfoKHR::default().image_view(view);
    let mut none = vk::RenderingFragmentShadingRateAttachmentInfoKHR::default();
    let with_own = vk::RenderingInfo::default().push_next(&mut own);
    let without = vk::RenderingInfo::default().push_next(&mut none);
    let at_begin: [(_, &[SetRate], _); 4] = [
        (without, &[], obeys),
        (with_own, &[keeps], keeps),
        (with_own, &[], keeps),
        (without, &[obeys], obeys),
    ];
    for (info, changed, expected) in at_begin {
        // SAFETY: the command buffer is live, and the structure valid.
        unsafe { begin(handle, &info) };
        assert_eq!(rates::taken_set(), changed, "as the pass begins");
        // SAFETY: as above, and both are valid.
        unsafe { set(handle, &keeps.size, &keeps.combiners) };
        assert_eq!(rates::taken_set(), [expected], "as the application sets it");
        // SAFETY: as above.
        unsafe { end(handle) };
    }
    drop(buffer);
    destroy_device(device);
    destroy_instance(instance);
    rates::capabilities(false, false);
}

#[test]
fn excluded_techniques_are_not_enabled_together() {
    let density = vk::PhysicalDeviceFragmentDensityMapFeaturesEXT::default().fragment_density_map(true);
    let image = vk::PhysicalDeviceShadingRateImageFeaturesNV::default().shading_rate_image(true);
    for chain in [(&raw const density).cast(), (&raw const image).cast()] {
        let created = created(vk::API_VERSION_1_2, chain, false);
        assert_eq!(created.extensions, [""; 0]);
        assert!(!created.offers);
    }
    let off = vk::PhysicalDeviceFragmentDensityMapFeaturesEXT::default();
    assert!(created(vk::API_VERSION_1_2, (&raw const off).cast(), false).offers, "asked for, not enabled");
}

#[test]
fn a_refused_creation_is_repeated_unchanged() {
    fake::calls();
    let created = created(vk::API_VERSION_1_0, null(), true);
    assert_eq!(created.extensions, [""; 0]);
    assert_eq!(created.features, [0; 3]);
    assert!(!created.offers);
    let calls = fake::calls();
    let links: Vec<&str> = calls.iter().filter_map(|call| call.split("link ").nth(1)).collect();
    assert_eq!(links.len(), 4, "each is tried twice: {calls:?}");
    assert!(
        links[0] == links[1] && links[2] == links[3],
        "with the link that the next layer needs: {calls:?}"
    );
}

#[test]
fn a_device_without_the_extension_is_created_as_the_application_asks() {
    let instance = new_instance(Some(vk::API_VERSION_1_2));
    let device = new_device(instance);
    assert_eq!(rates::enabled(), [""; 0]);
    assert_eq!(rates::features(), [0; 3]);
    destroy_device(device);
    destroy_instance(instance);
}

#[test]
fn a_device_that_stays_inert_is_created_as_the_application_asks() {
    rates::capabilities(true, false);
    let instance = new_instance(Some(vk::API_VERSION_1_2));
    let device = create_device(instance, fake::device_chain(null(), false).0, 1).unwrap();
    assert_eq!(rates::enabled(), [""; 0]);
    destroy_device(device);
    destroy_instance(instance);
    rates::capabilities(false, false);
}

/// Layers and samples, as the device offers them.
fn limits(driver: vk::DriverId, name: &'static [u8]) -> (bool, vk::SampleCountFlags) {
    rates::capabilities(true, false);
    rates::drive(driver, name);
    let instance = new_instance(Some(vk::API_VERSION_1_2));
    let device = new_device(instance);
    // SAFETY: the device is live.
    let known = unsafe { device::of(device) }.unwrap();
    let capabilities = known.rate_attachments().unwrap().capabilities.clone();
    destroy_device(device);
    destroy_instance(instance);
    rates::drive(vk::DriverId::default(), b"");
    rates::capabilities(false, false);
    (capabilities.layered, capabilities.limits.samples)
}

#[test]
fn quirks_of_a_device_limit_what_it_offers() {
    let radv = vk::DriverId::MESA_RADV;
    assert_eq!(limits(radv, b"AMD Radeon RX 6800 (RADV NAVI21)"), (false, vk::SampleCountFlags::TYPE_4));
    assert_eq!(limits(radv, b"AMD Radeon (RADV NAVI31)"), (true, vk::SampleCountFlags::TYPE_4));
    for other in [vk::DriverId::MESA_NVK, vk::DriverId::AMD_PROPRIETARY] {
        let found = limits(other, b"AMD Radeon RX 6800 (RADV NAVI21)");
        assert_eq!(found, (true, vk::SampleCountFlags::TYPE_8));
    }
}

#[test]
fn unconfigured_backends_are_not_created() {
    rates::capabilities(true, false);
    for arming in [Arming::Inert, Arming::Pictures, Arming::Masks] {
        ARMING.set(arming);
        let instance = new_instance(Some(vk::API_VERSION_1_0));
        assert_eq!(rates::enabled(), [""; 0], "{arming:?}");
        destroy_instance(instance);
        let instance = new_instance(Some(vk::API_VERSION_1_1));
        let device = new_device(instance);
        assert_eq!(rates::enabled(), [""; 0], "{arming:?}");
        assert_eq!(rates::features(), [0; 3], "{arming:?}");
        // SAFETY: the device is live.
        let known = unsafe { device::of(device) }.unwrap();
        let has = (known.armed.is_some(), known.rate_attachments().is_some(), known.masks().is_some());
        let expected = match arming {
            Arming::Inert => (false, false, false),
            Arming::Pictures => (true, false, false),
            Arming::Masks | Arming::Rates => (true, false, true),
        };
        assert_eq!(has, expected, "{arming:?}");
        destroy_device(device);
        destroy_instance(instance);
    }
    ARMING.set(Arming::Rates);
    rates::capabilities(false, false);
}

/// An inert device's functions are the next layer's, but for creation and destruction, and the OpenXR half learns that
/// the device is inert.
#[test]
fn a_device_without_work_has_no_hooks() {
    rates::capabilities(true, false);
    ARMING.set(Arming::Inert);
    let instance = new_instance(Some(vk::API_VERSION_1_1));
    let device = new_device(instance);
    let names = [
        c"vkCreateRenderPass",
        c"vkCreateGraphicsPipelines",
        c"vkCreateFramebuffer",
        c"vkCreateImage",
        c"vkQueueSubmit",
        c"vkCmdBeginRenderPass",
        c"vkCmdBindPipeline",
        c"vkBeginCommandBuffer",
    ];
    for name in names {
        let address = |function: vk::PFN_vkVoidFunction| function.map(|function| function as usize);
        // SAFETY: a live device and a name.
        let below = address(unsafe { fake::get_device_proc_addr(device, name.as_ptr()) });
        assert!(below.is_some());
        assert_eq!(address(device_function(device, name)), below, "{name:?} is hooked");
    }
    assert!(link(device).is_some() && record(device).is_none());
    destroy_device(device);
    destroy_instance(instance);
    ARMING.set(Arming::Rates);
    rates::capabilities(false, false);
}

#[test]
fn no_device_function_is_looked_up_through_the_instance() {
    rates::capabilities(true, false);
    let instance = new_instance(Some(vk::API_VERSION_1_1));
    fake::instance_names();
    let device = new_device(instance);
    let names = fake::instance_names();
    rates::capabilities(false, false);
    assert!(names.iter().any(|name| name == "vkCreateDevice"), "{names:?}");
    // The loader's last layer would ask all devices, and the newest has no dispatch table before vkCreateDevice returns.
    let of_instance = ["vkCreateDevice", "vkEnumerateDevice", "vkGetPhysicalDevice"];
    let others: Vec<_> =
        names.iter().filter(|name| !of_instance.iter().any(|begin| name.starts_with(begin))).collect();
    assert_eq!(others, [""; 0]);
    destroy_device(device);
    destroy_instance(instance);
}
