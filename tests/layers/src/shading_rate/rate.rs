//! Rules that several structures share: the texel size of an attachment, the rate of a pipeline or a draw.

use super::Emulator;
use super::findings::Findings;
use ash::vk;

/// The rules of an attachment's texel size, by the prefix of their IDs: width and height are each a power of two,
/// at most and at least the device's, and neither is a too high multiple of the other.
pub(super) struct TexelRules {
    pub kind: &'static str,
    pub prefix: &'static str,
    /// Of the width, then of the height: power of two, most, least; then of the two quotients.
    pub ids: [&'static str; 8],
}

/// Of `VkFragmentShadingRateAttachmentInfoKHR`.
pub(super) const SUBPASS_TEXEL: TexelRules = TexelRules {
    kind: "render_pass",
    prefix: "VUID-VkFragmentShadingRateAttachmentInfoKHR-pFragmentShadingRateAttachment",
    ids: ["04525", "04526", "04527", "04528", "04529", "04530", "04531", "04532"],
};

/// Of `VkRenderingFragmentShadingRateAttachmentInfoKHR`.
pub(super) const RENDERING_TEXEL: TexelRules = TexelRules {
    kind: "command",
    prefix: "VUID-VkRenderingFragmentShadingRateAttachmentInfoKHR-imageView",
    ids: ["06149", "06150", "06151", "06152", "06153", "06154", "06155", "06156"],
};

impl TexelRules {
    pub fn check(
        &self,
        emulator: &Emulator,
        findings: &mut Findings,
        texel: vk::Extent2D,
        object: impl vk::Handle + Copy,
    ) {
        let only = emulator.profile.texel();
        let side = |length: u32| [length.is_power_of_two(), length <= only, length >= only];
        let [width, height] = [texel.width, texel.height];
        let quotients = [width <= height, height <= width];
        let holds = side(width).into_iter().chain(side(height)).chain(quotients);
        for (holds, id) in holds.zip(self.ids) {
            let rule = format!("{}-{id}", self.prefix);
            findings.require(holds, self.kind, &rule, object, || {
                format!("texels of {width}x{height}, and the device has {only}x{only}")
            });
        }
    }
}

/// The rate of a pipeline, or the one set by a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Rate {
    pub size: vk::Extent2D,
    pub combiners: [vk::FragmentShadingRateCombinerOpKHR; 2],
}

impl Default for Rate {
    /// Rate of a pipeline without a rate state.
    fn default() -> Self {
        let size = vk::Extent2D { width: 1, height: 1 };
        Self { size, combiners: [vk::FragmentShadingRateCombinerOpKHR::KEEP; 2] }
    }
}

/// The rules of a [`Rate`], by their IDs without `VUID-`.
pub(super) struct RateRules {
    pub kind: &'static str,
    /// Of the width, then of the height: at least 1, power of two, at most 4, and 1 without the feature.
    pub size: [&'static str; 8],
    /// KEEP without the feature, of the first and the second.
    pub without_feature: [&'static str; 2],
    pub non_trivial: &'static str,
    /// A value of the enumeration, of the first and the second.
    pub valid: [&'static str; 2],
}

/// Of `VkPipelineFragmentShadingRateStateCreateInfoKHR`.
pub(super) const PIPELINE_RATE: RateRules = RateRules {
    kind: "pipeline",
    size: [
        "VkGraphicsPipelineCreateInfo-pDynamicState-04494",
        "VkGraphicsPipelineCreateInfo-pDynamicState-04496",
        "VkGraphicsPipelineCreateInfo-pDynamicState-04498",
        "VkGraphicsPipelineCreateInfo-pDynamicState-04500",
        "VkGraphicsPipelineCreateInfo-pDynamicState-04495",
        "VkGraphicsPipelineCreateInfo-pDynamicState-04497",
        "VkGraphicsPipelineCreateInfo-pDynamicState-04499",
        "VkGraphicsPipelineCreateInfo-pDynamicState-04500",
    ],
    without_feature: [
        "VkGraphicsPipelineCreateInfo-pDynamicState-04501",
        "VkGraphicsPipelineCreateInfo-pDynamicState-04502",
    ],
    non_trivial: "VkGraphicsPipelineCreateInfo-fragmentShadingRateNonTrivialCombinerOps-04506",
    valid: [
        "VkGraphicsPipelineCreateInfo-pDynamicState-06567",
        "VkGraphicsPipelineCreateInfo-pDynamicState-06568",
    ],
};

/// Of `vkCmdSetFragmentShadingRateKHR`.
pub(super) const COMMAND_RATE: RateRules = RateRules {
    kind: "command",
    size: [
        "vkCmdSetFragmentShadingRateKHR-pFragmentSize-04513",
        "vkCmdSetFragmentShadingRateKHR-pFragmentSize-04515",
        "vkCmdSetFragmentShadingRateKHR-pFragmentSize-04517",
        "vkCmdSetFragmentShadingRateKHR-pipelineFragmentShadingRate-04507",
        "vkCmdSetFragmentShadingRateKHR-pFragmentSize-04514",
        "vkCmdSetFragmentShadingRateKHR-pFragmentSize-04516",
        "vkCmdSetFragmentShadingRateKHR-pFragmentSize-04518",
        "vkCmdSetFragmentShadingRateKHR-pipelineFragmentShadingRate-04508",
    ],
    without_feature: [
        "vkCmdSetFragmentShadingRateKHR-primitiveFragmentShadingRate-04510",
        "vkCmdSetFragmentShadingRateKHR-attachmentFragmentShadingRate-04511",
    ],
    non_trivial: "vkCmdSetFragmentShadingRateKHR-fragmentSizeNonTrivialCombinerOps-04512",
    valid: [
        "vkCmdSetFragmentShadingRateKHR-combinerOps-parameter",
        "vkCmdSetFragmentShadingRateKHR-combinerOps-parameter",
    ],
};

impl RateRules {
    pub fn check(
        &self,
        emulator: &Emulator,
        findings: &mut Findings,
        rate: Rate,
        object: impl vk::Handle + Copy,
    ) {
        use vk::FragmentShadingRateCombinerOpKHR as Combiner;
        let mut require = |holds: bool, id: &str| {
            findings.require(holds, self.kind, &format!("VUID-{id}"), object, || {
                let [first, second] = rate.combiners;
                format!("{}x{} {first:?} {second:?}", rate.size.width, rate.size.height)
            });
        };
        let side = |length: u32| {
            [length >= 1, length.is_power_of_two(), length <= 4, length == 1 || emulator.enabled.pipeline]
        };
        let sides = side(rate.size.width).into_iter().chain(side(rate.size.height));
        for (holds, id) in sides.zip(self.size) {
            require(holds, id);
        }
        let enabled = [emulator.enabled.primitive, emulator.enabled.attachment];
        for (index, combiner) in rate.combiners.into_iter().enumerate() {
            let keep = combiner == Combiner::KEEP;
            require(keep || enabled[index], self.without_feature[index]);
            let trivial = keep || combiner == Combiner::REPLACE;
            require(trivial || emulator.profile.non_trivial_combiners(), self.non_trivial);
            let valid = (Combiner::KEEP.as_raw()..=Combiner::MUL.as_raw()).contains(&combiner.as_raw());
            require(valid, self.valid[index]);
        }
    }
}
