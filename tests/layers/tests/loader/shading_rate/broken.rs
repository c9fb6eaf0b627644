//! One rule is broken at a time, and found. Others may be found too, if breaking one breaks them.

use super::{lines, program};
use parafovea_test_layers::ShadingRateProfile;

const LAYERED: ShadingRateProfile = ShadingRateProfile::NvkTuring;
const RDNA: ShadingRateProfile = ShadingRateProfile::Navi21;
const UNLAYERED: ShadingRateProfile = ShadingRateProfile::Unlayered;

/// A violation, and its rule. With nothing broken, the form has no finding of that rule.
type Case = (&'static str, &'static str);

fn are_found(profile: ShadingRateProfile, form: &str, cases: &[Case]) {
    let rules = |broken: &str| {
        let ended = program(profile, form, broken).run_to_the_end_or_not();
        let (findings, _) = lines(&ended);
        findings.into_iter().map(|finding| finding.rule).collect::<Vec<_>>()
    };
    let right = rules("");
    for (broken, rule) in cases {
        let what = format!("{form}, broken: {broken}, on {}", profile.name());
        assert!(!right.iter().any(|found| found == rule), "{what}: {right:?} with nothing broken");
        let found = rules(broken);
        assert!(found.iter().any(|found| found == rule), "{what}: {rule} is not in {found:?}");
    }
}

#[test]
fn of_devices() {
    are_found(
        LAYERED,
        "device",
        &[
            ("no create_renderpass2", "VUID-vkCreateDevice-ppEnabledExtensionNames-01387"),
            ("no properties2", "VK_KHR_get_physical_device_properties2"),
            ("features twice", "VUID-VkDeviceCreateInfo-sType-unique"),
        ],
    );
    are_found(
        LAYERED,
        "device without_extension",
        &[("features without extension", "VUID-VkDeviceCreateInfo-pNext-pNext")],
    );
}

/// A device that has neither fails to be made, behind the check.
#[test]
fn of_features_that_exclude_it() {
    for (broken, name, ids) in [
        ("density map", "fragmentDensityMap", ["04481", "04482", "04483"]),
        ("shading rate image", "shadingRateImage", ["04478", "04479", "04480"]),
    ] {
        for id in ids {
            let rule: &'static str = format!("VUID-VkDeviceCreateInfo-{name}-{id}").leak();
            are_found(LAYERED, "device", &[(broken, rule)]);
        }
    }
}

#[test]
fn of_images() {
    are_found(
        LAYERED,
        "objects",
        &[
            ("3D image", "VUID-VkImageCreateInfo-imageType-02082"),
            ("samples", "VUID-VkImageCreateInfo-samples-02083"),
            ("image format", "VUID-VkImageCreateInfo-imageCreateMaxMipLevels-02251"),
            ("tiling", "VUID-VkImageCreateInfo-imageCreateMaxMipLevels-02251"),
            ("cube view", "VUID-VkImageViewCreateInfo-image-02086"),
            ("view format", "VUID-VkImageViewCreateInfo-usage-04550"),
        ],
    );
    for profile in [RDNA, UNLAYERED] {
        are_found(profile, "objects", &[("layered view", "VUID-VkImageViewCreateInfo-usage-04551")]);
        for form in ["objects framebuffer", "recorded dynamic"] {
            are_found(profile, form, &[("layered view", "layeredShadingRateAttachments")]);
        }
    }
}

/// Of both kinds of passes, on both texel sizes.
const TEXELS: [(&str, [&str; 2]); 8] = [
    ("texel width odd", ["04525", "06149"]),
    ("texel too wide", ["04526", "06150"]),
    ("texel too narrow", ["04527", "06151"]),
    ("texel height odd", ["04528", "06152"]),
    ("texel too high", ["04529", "06153"]),
    ("texel too low", ["04530", "06154"]),
    ("texel too wide", ["04531", "06155"]),
    ("texel too high", ["04532", "06156"]),
];

#[test]
fn of_texel_sizes() {
    for profile in [LAYERED, RDNA] {
        for (broken, [first, second]) in TEXELS {
            let prefix = "VUID-VkFragmentShadingRateAttachmentInfoKHR-pFragmentShadingRateAttachment";
            let rule: &'static str = format!("{prefix}-{first}").leak();
            are_found(profile, "objects", &[(broken, rule)]);
            let prefix = "VUID-VkRenderingFragmentShadingRateAttachmentInfoKHR-imageView";
            let rule: &'static str = format!("{prefix}-{second}").leak();
            are_found(profile, "recorded dynamic", &[(broken, rule)]);
        }
    }
}

#[test]
fn of_render_passes() {
    are_found(
        LAYERED,
        "objects",
        &[
            ("layout", "VUID-VkFragmentShadingRateAttachmentInfoKHR-pFragmentShadingRateAttachment-04524"),
            ("used otherwise", "VUID-VkRenderPassCreateInfo2-pAttachments-04585"),
            ("attachment format", "VUID-VkRenderPassCreateInfo2-pAttachments-04586"),
            ("attachment index", "VUID-VkRenderPassCreateInfo2-attachment-03051"),
            ("load", "rate attachment is loaded"),
        ],
    );
    are_found(
        LAYERED,
        "objects without_attachment",
        &[("dependency", "VUID-VkSubpassDependency2-dstStageMask-07318")],
    );
    are_found(LAYERED, "objects without_extension", &[("subpass", "VUID-VkSubpassDescription2-pNext-pNext")]);
}

#[test]
fn of_framebuffers() {
    are_found(
        LAYERED,
        "objects framebuffer",
        &[
            ("narrow", "VUID-VkFramebufferCreateInfo-flags-04539"),
            ("low", "VUID-VkFramebufferCreateInfo-flags-04540"),
            ("usage", "VUID-VkFramebufferCreateInfo-flags-04548"),
        ],
    );
    are_found(
        LAYERED,
        "objects framebuffer imageless",
        &[
            ("narrow", "VUID-VkFramebufferCreateInfo-flags-04543"),
            ("low", "VUID-VkFramebufferCreateInfo-flags-04544"),
            ("usage", "VUID-VkFramebufferCreateInfo-flags-04549"),
            ("layers", "VUID-VkFramebufferCreateInfo-flags-04545"),
        ],
    );
    are_found(
        LAYERED,
        "objects framebuffer multiview",
        &[("view beyond layers", "VUID-VkFramebufferCreateInfo-flags-04537")],
    );
    are_found(
        LAYERED,
        "objects framebuffer multiview imageless",
        &[("view beyond layers", "VUID-VkFramebufferCreateInfo-flags-04587")],
    );
    are_found(
        LAYERED,
        "objects framebuffer",
        &[("layered view and layers", "VUID-VkFramebufferCreateInfo-flags-04538")],
    );
}

#[test]
fn of_pipelines() {
    are_found(
        LAYERED,
        "objects",
        &[
            ("no width", "VUID-VkGraphicsPipelineCreateInfo-pDynamicState-04494"),
            ("no height", "VUID-VkGraphicsPipelineCreateInfo-pDynamicState-04495"),
            ("width odd", "VUID-VkGraphicsPipelineCreateInfo-pDynamicState-04496"),
            ("height odd", "VUID-VkGraphicsPipelineCreateInfo-pDynamicState-04497"),
            ("too wide", "VUID-VkGraphicsPipelineCreateInfo-pDynamicState-04498"),
            ("too high", "VUID-VkGraphicsPipelineCreateInfo-pDynamicState-04499"),
            ("first combiner invalid", "VUID-VkGraphicsPipelineCreateInfo-pDynamicState-06567"),
            ("second combiner invalid", "VUID-VkGraphicsPipelineCreateInfo-pDynamicState-06568"),
        ],
    );
    are_found(
        LAYERED,
        "objects without_pipeline",
        &[("size", "VUID-VkGraphicsPipelineCreateInfo-pDynamicState-04500")],
    );
    are_found(
        LAYERED,
        "objects without_primitive",
        &[("first combiner", "VUID-VkGraphicsPipelineCreateInfo-pDynamicState-04501")],
    );
    are_found(
        LAYERED,
        "objects without_attachment",
        &[("second combiner", "VUID-VkGraphicsPipelineCreateInfo-pDynamicState-04502")],
    );
    are_found(
        UNLAYERED,
        "objects",
        &[(
            "trivial combiner",
            "VUID-VkGraphicsPipelineCreateInfo-fragmentShadingRateNonTrivialCombinerOps-04506",
        )],
    );
    are_found(
        LAYERED,
        "objects without_extension framebuffer",
        &[
            ("pipeline state", "VUID-VkGraphicsPipelineCreateInfo-pNext-pNext"),
            ("flag", "VK_KHR_fragment_shading_rate"),
            ("dynamic state", "VK_KHR_fragment_shading_rate"),
        ],
    );
    are_found(
        LAYERED,
        "objects libraries",
        &[
            ("library rate", "VUID-VkGraphicsPipelineCreateInfo-pLibraries-06639"),
            ("library flag", "libraries have the flag of the pipeline"),
        ],
    );
    are_found(
        LAYERED,
        "objects libraries chained",
        &[("library rate", "VUID-VkGraphicsPipelineCreateInfo-flags-06638")],
    );
}

/// Only recorded: a driver may write anywhere if the layers do not exist.
#[test]
fn of_dynamic_rendering() {
    are_found(
        LAYERED,
        "recorded dynamic",
        &[
            ("layout", "VUID-VkRenderingFragmentShadingRateAttachmentInfoKHR-imageView-06147"),
            ("usage", "VUID-VkRenderingFragmentShadingRateAttachmentInfoKHR-imageView-06148"),
            ("narrow", "VUID-VkRenderingInfo-pNext-06119"),
            ("low", "VUID-VkRenderingInfo-pNext-06121"),
            ("layered view and layers", "VUID-VkRenderingInfo-imageView-06123"),
            ("also drawn to", "VUID-VkRenderingInfo-imageView-06125"),
            ("foreign layout", "VUID-VkRenderingAttachmentInfo-imageView-06143"),
            ("no flag", "VUID-vkCmdDraw-imageView-06183"),
        ],
    );
    are_found(
        LAYERED,
        "recorded dynamic multiview",
        &[("view beyond layers", "VUID-VkRenderingInfo-imageView-06124")],
    );
    are_found(LAYERED, "recorded dynamic secondary", &[("no flag", "VUID-vkCmdDraw-imageView-06183")]);
    are_found(
        LAYERED,
        "recorded dynamic without_extension",
        &[("rendering", "VUID-VkRenderingInfo-pNext-pNext")],
    );
}

#[test]
fn of_commands() {
    let size = "VUID-vkCmdSetFragmentShadingRateKHR-pFragmentSize";
    let of = |id: &str| -> &'static str { format!("{size}-{id}").leak() };
    are_found(
        LAYERED,
        "recorded dynamic dynamic_state",
        &[
            ("no width", of("04513")),
            ("no height", of("04514")),
            ("width odd", of("04515")),
            ("height odd", of("04516")),
            ("too wide", of("04517")),
            ("too high", of("04518")),
            ("second combiner invalid", "VUID-vkCmdSetFragmentShadingRateKHR-combinerOps-parameter"),
            ("rate not set", "VUID-vkCmdDraw-pipelineFragmentShadingRate-09238"),
        ],
    );
    are_found(
        LAYERED,
        "recorded dynamic dynamic_state without_pipeline",
        &[
            ("too wide", "VUID-vkCmdSetFragmentShadingRateKHR-pipelineFragmentShadingRate-04507"),
            ("too high", "VUID-vkCmdSetFragmentShadingRateKHR-pipelineFragmentShadingRate-04508"),
        ],
    );
    are_found(
        LAYERED,
        "recorded dynamic dynamic_state without_primitive",
        &[("first combiner", "VUID-vkCmdSetFragmentShadingRateKHR-primitiveFragmentShadingRate-04510")],
    );
    are_found(
        LAYERED,
        "recorded dynamic dynamic_state without_attachment",
        &[("second combiner", "VUID-vkCmdSetFragmentShadingRateKHR-attachmentFragmentShadingRate-04511")],
    );
    are_found(
        UNLAYERED,
        "recorded dynamic dynamic_state",
        &[(
            "trivial combiner",
            "VUID-vkCmdSetFragmentShadingRateKHR-fragmentSizeNonTrivialCombinerOps-04512",
        )],
    );
    are_found(
        LAYERED,
        "recorded framebuffer",
        &[
            ("framebuffer of another", "VUID-VkRenderPassBeginInfo-renderPass-00904"),
            ("pipeline of another", "VUID-vkCmdDraw-renderPass-02684"),
        ],
    );
    are_found(
        LAYERED,
        "recorded framebuffer imageless",
        &[("promised usage", "VUID-VkRenderPassBeginInfo-framebuffer-04627")],
    );
}

#[test]
fn of_barriers_and_execution() {
    are_found(
        LAYERED,
        "framebuffer",
        &[
            ("old layout", "VUID-VkImageMemoryBarrier-oldLayout-01197"),
            ("layout at use", "VUID-vkCmdBeginRenderPass-initialLayout-00900"),
            ("access without stage", "VUID-vkCmdPipelineBarrier-dstAccessMask-02816"),
            ("source access without stage", "VUID-vkCmdPipelineBarrier-srcAccessMask-02815"),
            ("usage", "VUID-VkImageMemoryBarrier-oldLayout-02088"),
            ("stage", "rate attachment is readable"),
            ("access", "rate attachment is readable"),
            ("source", "rate attachment is readable"),
            ("written after", "rate attachment is readable"),
            ("texel value", "every texel is a rate of the device"),
        ],
    );
    are_found(
        LAYERED,
        "dynamic",
        &[
            ("old layout", "VUID-VkImageMemoryBarrier-oldLayout-01197"),
            ("layout at use", "rate attachment is in its layout"),
            ("access without stage", "rate access has its stage"),
            ("foreign layout", "VUID-VkImageMemoryBarrier2-oldLayout-02088"),
            ("stage", "rate attachment is readable"),
        ],
    );
    are_found(LAYERED, "dynamic compute general", &[("no barrier", "rate attachment is readable")]);
    are_found(LAYERED, "framebuffer transition", &[("no dependency", "rate attachment is readable")]);
    are_found(RDNA, "dynamic", &[("coarse texel", "every texel is a rate of the device")]);
}

/// Stages without the feature, of which the form needs some with nothing broken too.
#[test]
fn of_stages() {
    for (form, rules) in [
        (
            "framebuffer without_attachment",
            [
                "VUID-vkCmdPipelineBarrier-srcStageMask-07318",
                "VUID-vkCmdPipelineBarrier-dstStageMask-07318",
                "attachmentFragmentShadingRate",
            ],
        ),
        (
            "dynamic without_attachment",
            [
                "VUID-VkImageMemoryBarrier2-srcStageMask-07316",
                "VUID-VkImageMemoryBarrier2-dstStageMask-07316",
                "attachmentFragmentShadingRate",
            ],
        ),
    ] {
        let (findings, _) = lines(&program(LAYERED, form, "").run());
        for rule in rules {
            assert!(findings.iter().any(|finding| finding.rule == rule), "{form}: {rule}");
        }
    }
    let form = "dynamic dynamic_state without_attachment without_pipeline without_primitive";
    let (findings, _) = lines(&program(LAYERED, form, "").run());
    let rule = "VUID-vkCmdSetFragmentShadingRateKHR-pipelineFragmentShadingRate-04509";
    assert!(findings.iter().any(|finding| finding.rule == rule));
}
