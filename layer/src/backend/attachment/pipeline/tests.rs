use super::*;
use crate::abi::copies::room;
use crate::backend::attachment::capabilities::tests::offered;
use crate::backend::attachment::full_rate::causes;
use crate::vk::shaders::Effects;
use ash::vk::Handle;
use vk::FragmentShadingRateCombinerOpKHR as Combiner;

type Rate<'a> = vk::PipelineFragmentShadingRateStateCreateInfoKHR<'a>;
type Flags2<'a> = vk::PipelineCreateFlags2CreateInfoKHR<'a>;

/// A render pass with a rate attachment of the application's own.
const OWN: u64 = 7;

fn is_own(pass: vk::RenderPass) -> bool {
    pass.as_raw() == OWN
}

/// The outcome of a pipeline's creation.
#[derive(Debug, PartialEq, Eq)]
struct Outcome {
    flagged: bool,
    /// The rate state in the chain: its size and combiners.
    state: Option<([u32; 2], [Combiner; 2])>,
    dynamic: Vec<vk::DynamicState>,
    rate: PipelineRate,
}

fn outcome(info: &vk::GraphicsPipelineCreateInfo<'_>, effects: Effects) -> Outcome {
    linked(info, effects, |_| None)
}

fn linked(
    info: &vk::GraphicsPipelineCreateInfo<'_>,
    effects: Effects,
    libraries: impl Fn(vk::Pipeline) -> Option<PipelineRate>,
) -> Outcome {
    let mut room = room::<64>();
    let mut copies = Copies::new(&mut room);
    // SAFETY: valid structures that outlive the copies.
    unsafe {
        let capabilities = offered([16, 16]);
        let every_pixel = causes(info, &capabilities.limits, |_| effects).are_any();
        let of_pipeline = (every_pixel, has_flag(info));
        let (more, rate) = with_rates(info, &capabilities, of_pipeline, libraries, is_own, &mut copies);
        let flags2 = find::<Flags2<'_>>(more.p_next);
        Outcome {
            flagged: flags2.map_or(more.flags.contains(FLAG), |flags| {
                flags.flags.as_raw() & u64::from(FLAG.as_raw()) != 0
            }),
            state: find::<Rate<'_>>(more.p_next).map(|rate| {
                assert!(find::<Rate<'_>>(rate.p_next).is_none(), "doubled");
                ([rate.fragment_size.width, rate.fragment_size.height], rate.combiner_ops)
            }),
            dynamic: dynamic_states(&more).to_vec(),
            rate,
        }
    }
}

fn fragment_stage() -> [vk::PipelineShaderStageCreateInfo<'static>; 1] {
    [vk::PipelineShaderStageCreateInfo::default().stage(vk::ShaderStageFlags::FRAGMENT)]
}

const OBEYS: Option<([u32; 2], [Combiner; 2])> = Some(([1, 1], [Combiner::KEEP, Combiner::MAX]));

#[test]
fn a_pipeline_gets_flag_and_combiner() {
    let stages = fragment_stage();
    let plain = vk::GraphicsPipelineCreateInfo::default().stages(&stages);
    let expected = Outcome { flagged: true, state: OBEYS, dynamic: Vec::new(), rate: PipelineRate::Fixed };
    assert_eq!(outcome(&plain, Effects::default()), expected);
    let mut own =
        Rate::default().fragment_size(vk::Extent2D { width: 1, height: 1 }).combiner_ops([Combiner::KEEP; 2]);
    let says_so = plain.push_next(&mut own);
    assert_eq!(outcome(&says_so, Effects::default()), expected, "the default, said aloud");
}

/// A default rate ignores the application's own attachment; with our combiner it would obey it.
#[test]
fn a_default_rate_beside_an_attachment_of_the_applications_stays() {
    let stages = fragment_stage();
    let plain = vk::GraphicsPipelineCreateInfo::default().stages(&stages);
    let expected = Outcome { flagged: true, state: None, dynamic: Vec::new(), rate: PipelineRate::Fixed };
    assert_eq!(outcome(&plain.render_pass(vk::RenderPass::from_raw(OWN)), Effects::default()), expected);
    assert_eq!(outcome(&plain.flags(FLAG), Effects::default()), expected);
    let mut flags = Flags2::default().flags(FLAG2);
    assert_eq!(outcome(&plain.push_next(&mut flags), Effects::default()), expected);
    let mut part = vk::GraphicsPipelineLibraryCreateInfoEXT::default().flags(
        vk::GraphicsPipelineLibraryFlagsEXT::FRAGMENT_SHADER
            | vk::GraphicsPipelineLibraryFlagsEXT::PRE_RASTERIZATION_SHADERS,
    );
    let library = plain.flags(vk::PipelineCreateFlags::LIBRARY_KHR).push_next(&mut part);
    assert_eq!(outcome(&library.render_pass(vk::RenderPass::from_raw(OWN)), Effects::default()), expected);
}

#[test]
fn the_second_kind_of_flags_counts() {
    let stages = fragment_stage();
    let mut flags = Flags2::default().flags(vk::PipelineCreateFlags2KHR::DISABLE_OPTIMIZATION);
    let info = vk::GraphicsPipelineCreateInfo::default().stages(&stages).push_next(&mut flags);
    assert!(outcome(&info, Effects::default()).flagged);
}

#[test]
fn per_pixel_effects_keep_1x1() {
    let stages = fragment_stage();
    let info = vk::GraphicsPipelineCreateInfo::default().stages(&stages);
    let none = Effects::default();
    for effects in [
        Effects { stores: true, ..none },
        Effects { interlocks: true, ..none },
        Effects { per_sample: true, ..none },
        Effects { writes_integers: true, ..none },
        Effects { writes_depth_stencil: true, ..none },
        Effects { uses_sample_mask: true, ..none },
        Effects { discards: true, ..none },
    ] {
        let outcome = outcome(&info, effects);
        assert!(outcome.flagged && outcome.state.is_none(), "{effects:?}");
    }
    // Without a fragment shader, its effects do not matter.
    let depth_only = vk::GraphicsPipelineCreateInfo::default();
    assert_eq!(outcome(&depth_only, Effects::UNKNOWN).state, OBEYS);
}

#[test]
fn samples_that_are_shaded_or_too_many_keep_their_rate() {
    let stages = fragment_stage();
    let state = |state: vk::PipelineMultisampleStateCreateInfo<'_>| {
        let info = vk::GraphicsPipelineCreateInfo::default().stages(&stages).multisample_state(&state);
        outcome(&info, Effects::default()).state
    };
    let plain = vk::PipelineMultisampleStateCreateInfo::default();
    let one = plain.rasterization_samples(vk::SampleCountFlags::TYPE_1);
    assert_eq!(state(one), OBEYS);
    assert_eq!(state(one.sample_shading_enable(true)), None);
    assert_eq!(state(one.alpha_to_coverage_enable(true)), None);
    let states = [vk::DynamicState::ALPHA_TO_COVERAGE_ENABLE_EXT];
    let by_command = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&states);
    let info = vk::GraphicsPipelineCreateInfo::default().stages(&stages).dynamic_state(&by_command);
    assert_eq!(outcome(&info, Effects::default()).state, None, "commands may turn it on");
    assert_eq!(
        state(plain.rasterization_samples(vk::SampleCountFlags::TYPE_8)),
        None,
        "the device has up to 4"
    );
    let four = plain.rasterization_samples(vk::SampleCountFlags::TYPE_4);
    assert_eq!(state(four.sample_mask(&[0xffff_fff7])), None, "a bit that matters");
    assert_eq!(state(four.sample_mask(&[0xf])), OBEYS, "all bits that matter");
}

#[test]
fn state_is_ignored_without_rasterisation() {
    let stages = fragment_stage();
    let discards = vk::PipelineRasterizationStateCreateInfo::default().rasterizer_discard_enable(true);
    let mut info = vk::GraphicsPipelineCreateInfo::default().stages(&stages).rasterization_state(&discards);
    info.p_multisample_state = std::ptr::dangling();
    let outcome = outcome(&info, Effects::UNKNOWN);
    assert!(outcome.flagged && outcome.state.is_none());
}

#[test]
fn an_applications_own_rate_is_kept() {
    let stages = fragment_stage();
    for (width, combiners) in [
        (2, [Combiner::KEEP; 2]),
        (1, [Combiner::REPLACE, Combiner::KEEP]),
        (1, [Combiner::KEEP, Combiner::MIN]),
    ] {
        let mut own =
            Rate::default().fragment_size(vk::Extent2D { width, height: 1 }).combiner_ops(combiners);
        let info = vk::GraphicsPipelineCreateInfo::default().stages(&stages).push_next(&mut own);
        let outcome = outcome(&info, Effects::default());
        assert_eq!((outcome.flagged, outcome.state), (true, Some(([width, 1], combiners))));
    }
    let states = [vk::DynamicState::VIEWPORT, vk::DynamicState::FRAGMENT_SHADING_RATE_KHR];
    let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&states);
    let info = vk::GraphicsPipelineCreateInfo::default().stages(&stages).dynamic_state(&dynamic);
    for every_pixel in [false, true] {
        let outcome = outcome(&info, Effects { stores: every_pixel, ..Effects::default() });
        assert_eq!((outcome.state, &outcome.dynamic[..]), (None, &states[..]));
        assert_eq!(outcome.rate, PipelineRate::Application { every_pixel });
    }
}

/// A shader that discards is kept at 1x1 under an attachment of the layer, but not under one of the application's own.
#[test]
fn an_applications_own_attachment_counts_for_shaders_that_discard() {
    let stages = fragment_stage();
    let effects = Effects { discards: true, ..Effects::default() };
    for (pass, combiner) in [(0, Combiner::KEEP), (1, Combiner::KEEP), (OWN, Combiner::REPLACE)] {
        let mut own = Rate::default()
            .fragment_size(vk::Extent2D { width: 1, height: 1 })
            .combiner_ops([Combiner::KEEP, Combiner::REPLACE]);
        let info = vk::GraphicsPipelineCreateInfo::default().stages(&stages).push_next(&mut own);
        let info = info.render_pass(vk::RenderPass::from_raw(pass));
        assert_eq!(outcome(&info, effects).state, Some(([1, 1], [Combiner::KEEP, combiner])), "pass {pass}");
    }
}

/// Parts of a library that shade get a dynamic rate, and the rate of the whole pipeline is set when it is bound.
#[test]
fn libraries_agree_on_a_rate_that_is_set_when_bound() {
    let stages = fragment_stage();
    let viewport = [vk::DynamicState::VIEWPORT];
    let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&viewport);
    let part = |parts: Parts, effects: Effects| {
        let mut library = vk::GraphicsPipelineLibraryCreateInfoEXT::default().flags(parts);
        let info = vk::GraphicsPipelineCreateInfo::default().dynamic_state(&dynamic).push_next(&mut library);
        outcome(&if parts.contains(Parts::FRAGMENT_SHADER) { info.stages(&stages) } else { info }, effects)
    };
    let stores = Effects { stores: true, ..Effects::default() };
    let with_rate = [vk::DynamicState::VIEWPORT, vk::DynamicState::FRAGMENT_SHADING_RATE_KHR];
    for (parts, effects, dynamic, rate) in [
        (Parts::VERTEX_INPUT_INTERFACE, stores, &viewport[..], PipelineRate::Fixed),
        (Parts::FRAGMENT_OUTPUT_INTERFACE, stores, &viewport, PipelineRate::Fixed),
        (Parts::PRE_RASTERIZATION_SHADERS, stores, &with_rate, PipelineRate::AtBind(Combiner::MAX)),
        (Parts::FRAGMENT_SHADER, Effects::default(), &with_rate, PipelineRate::AtBind(Combiner::MAX)),
        (Parts::FRAGMENT_SHADER, stores, &with_rate, PipelineRate::AtBind(Combiner::KEEP)),
    ] {
        let outcome = part(parts, effects);
        assert!(outcome.flagged, "{parts:?}");
        assert_eq!((outcome.state, &outcome.dynamic[..], outcome.rate), (None, dynamic, rate), "{parts:?}");
    }
    let all = SHADING | Parts::FRAGMENT_OUTPUT_INTERFACE;
    assert_eq!(part(all, Effects::default()).state, OBEYS, "all in one agree by themselves");
}

#[test]
fn a_linked_pipeline_has_the_more_careful_rate_of_its_parts() {
    let rates = [
        PipelineRate::Fixed,
        PipelineRate::AtBind(Combiner::MAX),
        PipelineRate::AtBind(Combiner::KEEP),
        PipelineRate::Application { every_pixel: true },
    ];
    let whole = |parts: &[u64]| {
        let handles: Vec<_> = parts.iter().map(|&part| vk::Pipeline::from_raw(part)).collect();
        let mut libraries = vk::PipelineLibraryCreateInfoKHR::default().libraries(&handles);
        let info = vk::GraphicsPipelineCreateInfo::default().push_next(&mut libraries);
        let outcome = linked(&info, Effects::UNKNOWN, |part| rates.get(part.as_raw() as usize).copied());
        assert!(outcome.flagged && outcome.state.is_none() && outcome.dynamic.is_empty());
        outcome.rate
    };
    assert_eq!(whole(&[0, 0]), PipelineRate::Fixed);
    assert_eq!(whole(&[0, 1, 1, 0]), rates[1]);
    assert_eq!(whole(&[0, 1, 2, 0]), rates[2]);
    assert_eq!(whole(&[2, 1]), rates[2]);
    assert_eq!(whole(&[1, 3]), rates[3]);
    assert_eq!(whole(&[9]), PipelineRate::Fixed, "not known here");
}

/// Godot chains a rate of 4x4 that the attachment replaces to each pipeline.
#[test]
fn a_rate_that_the_attachment_replaces_is_kept_unless_every_pixel_counts() {
    let stages = fragment_stage();
    let size = vk::Extent2D { width: 4, height: 4 };
    let none = Effects::default();
    for (combiner, careful) in [
        (Combiner::REPLACE, ([1, 1], [Combiner::KEEP; 2])),
        (Combiner::MIN, ([1, 1], [Combiner::KEEP; 2])),
        (Combiner::MAX, ([4, 4], [Combiner::KEEP; 2])),
    ] {
        let mut own = Rate::default().fragment_size(size).combiner_ops([Combiner::KEEP, combiner]);
        let info = vk::GraphicsPipelineCreateInfo::default().stages(&stages).push_next(&mut own);
        assert_eq!(outcome(&info, none).state, Some(([4, 4], [Combiner::KEEP, combiner])));
        let discards = outcome(&info, Effects { discards: true, ..none });
        assert_eq!((discards.state, discards.rate), (Some(careful), PipelineRate::Fixed), "{combiner:?}");
    }
}

/// DXVK has alpha to coverage in libraries of the output interface.
#[test]
fn a_library_of_the_output_may_need_every_pixel() {
    type Kind<'a> = vk::GraphicsPipelineLibraryCreateInfoEXT<'a>;
    use vk::GraphicsPipelineLibraryFlagsEXT as Flags;
    let one =
        vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_4);
    let of = |flags, state: &vk::PipelineMultisampleStateCreateInfo<'_>| {
        let stages = fragment_stage();
        let mut kind = Kind::default().flags(flags);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .flags(vk::PipelineCreateFlags::LIBRARY_KHR)
            .stages(&stages)
            .multisample_state(state)
            .push_next(&mut kind);
        outcome(&info, Effects::default())
    };
    let plain = of(Flags::FRAGMENT_OUTPUT_INTERFACE, &one).rate;
    let coverage = of(Flags::FRAGMENT_OUTPUT_INTERFACE, &one.alpha_to_coverage_enable(true)).rate;
    assert_eq!((plain, coverage), (PipelineRate::Fixed, PipelineRate::NeedsEveryPixel));
    let both = of(Flags::PRE_RASTERIZATION_SHADERS | Flags::FRAGMENT_SHADER, &one);
    assert_eq!(both.rate, PipelineRate::AtBind(Combiner::MAX), "linked with an output interface later");
    for (output, expected) in [(plain, Combiner::MAX), (coverage, Combiner::KEEP)] {
        let parts = [vk::Pipeline::from_raw(1), vk::Pipeline::from_raw(2)];
        let mut library = vk::PipelineLibraryCreateInfoKHR::default().libraries(&parts);
        let info = vk::GraphicsPipelineCreateInfo::default().push_next(&mut library);
        let linked =
            linked(&info, Effects::default(), |part| Some(if part == parts[0] { both.rate } else { output }));
        assert_eq!(linked.rate, PipelineRate::AtBind(expected));
    }
}
