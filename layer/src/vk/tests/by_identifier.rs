//! Pipelines by shader identifiers of an earlier launch, whose fragment shaders no launch with the layer has seen.

use super::fake::pipelines;
use super::pipelines::{create, with_device};
use super::*;
use crate::vk::shaders::KnownShaders;
use crate::vk::shaders::effects::tests::plain_shader;

type Flags2<'a> = vk::PipelineCreateFlags2CreateInfoKHR<'a>;
type Info<'a> = vk::GraphicsPipelineCreateInfo<'a>;

const REQUIRED: vk::Result = vk::Result::PIPELINE_COMPILE_REQUIRED_EXT;
const MADE: (vk::Result, [u64; 1]) = (vk::Result::SUCCESS, [1]);
const MAY_FAIL: vk::PipelineCreateFlags = vk::PipelineCreateFlags::FAIL_ON_PIPELINE_COMPILE_REQUIRED;
const RETURNS_EARLY: vk::PipelineCreateFlags = vk::PipelineCreateFlags::EARLY_RETURN_ON_FAILURE;

fn is_known(identifier: &[u8]) -> bool {
    KnownShaders::of_process().get(identifier).is_some()
}

/// The outcome of a call for pipelines with these fragment shaders, by identifier or of unknown code, and the calls that reach the driver.
fn created<const N: usize>(
    asked: [(&[u8], vk::PipelineCreateFlags); N],
) -> (vk::Result, [u64; N], Vec<String>) {
    let mut by = asked.map(|(identifier, _)| {
        vk::PipelineShaderStageModuleIdentifierCreateInfoEXT::default().identifier(identifier)
    });
    let mut by = by.each_mut().into_iter();
    let stages = asked.map(|_| {
        let stage = vk::PipelineShaderStageCreateInfo::default().stage(vk::ShaderStageFlags::FRAGMENT);
        [stage.name(c"main").push_next(by.next().unwrap())]
    });
    let mut flags = asked.into_iter().map(|(_, flags)| flags);
    let infos = stages.each_ref().map(|stages| Info::default().stages(stages).flags(flags.next().unwrap()));
    pipelines::answer(vk::Result::SUCCESS, vk::Result::SUCCESS);
    with_device(|device| {
        let (result, made) = create(device, infos);
        (result, made, pipelines::seen())
    })
}

#[test]
fn unknown_fragment_shaders_are_asked_for() {
    assert_eq!(created([(b"never seen", MAY_FAIL)]), (REQUIRED, [0], vec![]), "nothing reaches the driver");
    let (result, made, _) = created([(b"never seen", vk::PipelineCreateFlags::empty())]);
    assert_eq!((result, made), (vk::Result::SUCCESS, [1]), "the answer is not allowed");
    let shaders = crate::vk::shaders::FragmentShaders::read(&plain_shader()).unwrap();
    KnownShaders::of_process().note(b"seen by a launch", &shaders.into());
    let (result, made, seen) = created([(b"seen by a launch", MAY_FAIL)]);
    assert_eq!((result, made), (vk::Result::SUCCESS, [1]));
    assert_eq!(seen, ["amended 1"]);
}

/// Facts decide about masks, too; without passes to change, nothing is asked for.
#[test]
fn code_is_asked_for_where_passes_may_change() {
    ARMING.set(Arming::Masks);
    assert_eq!(created([(b"never seen", MAY_FAIL)]), (REQUIRED, [0], vec![]));
    ARMING.set(Arming::Pictures);
    assert_eq!(created([(b"never seen", MAY_FAIL)]), (MADE.0, MADE.1, vec!["plain 1".to_owned()]));
    ARMING.set(Arming::Rates);
}

#[test]
fn other_pipelines_of_the_call_are_created() {
    let (other, unknown): (&[u8], &[u8]) = (b"", b"never seen");
    let none = vk::PipelineCreateFlags::empty();
    let mixed = [(other, none), (unknown, MAY_FAIL), (other, none), (unknown, MAY_FAIL), (other, none)];
    assert_eq!(created(mixed), (REQUIRED, [1, 0, 2, 0, 3], vec!["amended 3".to_owned()]));
    let returns = MAY_FAIL | RETURNS_EARLY;
    let early = [(other, none), (unknown, MAY_FAIL), (other, none), (unknown, returns), (other, none)];
    assert_eq!(created(early), (REQUIRED, [1, 0, 2, 0, 0], vec!["amended 2".to_owned()]));
    let first = [(unknown, returns), (other, none)];
    assert_eq!(created(first), (REQUIRED, [0, 0], vec![]));
    // A derived pipeline names its base by its place in the call.
    let derived = [(unknown, MAY_FAIL), (other, vk::PipelineCreateFlags::DERIVATIVE)];
    assert_eq!(created(derived), (vk::Result::SUCCESS, [1, 2], vec!["amended 2".to_owned()]));
}

/// Flags in the chain replace the others; the feedback of a refused pipeline is invalid; pipelines without rasterisation are not refused.
#[test]
fn state_of_the_chain_counts() {
    let mut by = vk::PipelineShaderStageModuleIdentifierCreateInfoEXT::default().identifier(b"never seen");
    let stages = [vk::PipelineShaderStageCreateInfo::default()
        .stage(vk::ShaderStageFlags::FRAGMENT)
        .name(c"main")
        .push_next(&mut by)];
    with_device(|device| {
        pipelines::answer(vk::Result::SUCCESS, vk::Result::SUCCESS);
        let mut flags =
            Flags2::default().flags(vk::PipelineCreateFlags2KHR::FAIL_ON_PIPELINE_COMPILE_REQUIRED);
        let valid = vk::PipelineCreationFeedback::default().flags(vk::PipelineCreationFeedbackFlags::VALID);
        let (mut whole, mut each) = (valid, [valid; 2]);
        let mut feedback = vk::PipelineCreationFeedbackCreateInfo::default()
            .pipeline_creation_feedback(&mut whole)
            .pipeline_stage_creation_feedbacks(&mut each);
        let info = Info::default().stages(&stages).push_next(&mut feedback).push_next(&mut flags);
        assert_eq!(create(device, [info]), (REQUIRED, [0]));
        assert!([whole, each[0], each[1]].iter().all(|feedback| feedback.flags.is_empty()));
        let mut flags = Flags2::default();
        let without = Info::default().stages(&stages).flags(MAY_FAIL).push_next(&mut flags);
        assert_eq!(create(device, [without]), MADE);
        let discards = vk::PipelineRasterizationStateCreateInfo::default().rasterizer_discard_enable(true);
        let unseen = Info::default().stages(&stages).flags(MAY_FAIL).rasterization_state(&discards);
        assert_eq!(create(device, [unseen]), MADE);
        let mut shadows =
            vk::PipelineRenderingCreateInfo::default().depth_attachment_format(vk::Format::D32_SFLOAT);
        let shadow = Info::default().stages(&stages).flags(MAY_FAIL).push_next(&mut shadows);
        assert_eq!(create(device, [shadow]), MADE, "no colours, so no rates");
        let mut library = vk::GraphicsPipelineLibraryCreateInfoEXT::default()
            .flags(vk::GraphicsPipelineLibraryFlagsEXT::FRAGMENT_SHADER);
        let library = Info::default().stages(&stages).flags(MAY_FAIL).push_next(&mut library);
        assert_eq!(create(device, [library]), (REQUIRED, [0]), "a library of the fragment shader");
    });
}

/// As vkd3d-proton does it: its cache has the identifiers, and it does not ask the driver for them again.
#[test]
fn code_that_comes_instead_is_known_from_then_on() {
    with_device(|device| {
        pipelines::answer(vk::Result::SUCCESS, vk::Result::SUCCESS);
        let by_identifier = |identifier: &[u8]| {
            let mut by =
                vk::PipelineShaderStageModuleIdentifierCreateInfoEXT::default().identifier(identifier);
            let stages = [vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::FRAGMENT)
                .name(c"main")
                .push_next(&mut by)];
            create(device, [Info::default().stages(&stages).flags(MAY_FAIL)])
        };
        let code = plain_shader();
        let mut info = vk::ShaderModuleCreateInfo::default().code(&code);
        let mut module = vk::ShaderModule::null();
        // SAFETY: the name gives the type; the arguments are valid.
        let result = unsafe {
            transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkCreateShaderModule>(device_function(
                device,
                c"vkCreateShaderModule",
            ))(device, &info, null(), &mut module)
        };
        assert_eq!(result, vk::Result::SUCCESS);
        let stage =
            vk::PipelineShaderStageCreateInfo::default().stage(vk::ShaderStageFlags::FRAGMENT).name(c"main");
        let of_module = [stage.module(module)];
        assert_eq!(create(device, [Info::default().stages(&of_module)]), MADE);
        assert!(!is_known(pipelines::OF_MODULE), "identifiers are asked for where the application uses them");
        assert_eq!(by_identifier(pipelines::OF_MODULE), (REQUIRED, [0]));
        assert_eq!(create(device, [Info::default().stages(&of_module)]), MADE);
        assert!(is_known(pipelines::OF_MODULE));
        assert_eq!(by_identifier(pipelines::OF_MODULE), MADE);
        // The same without a module.
        assert_eq!(create(device, [Info::default().stages(&[stage.push_next(&mut info)])]), MADE);
        assert!(is_known(pipelines::IDENTIFIER));
        // Code that is not understood is not asked for in each launch.
        let mut info = vk::ShaderModuleCreateInfo::default().code(&[0; 8]);
        assert_eq!(create(device, [Info::default().stages(&[stage.push_next(&mut info)])]), MADE);
        let unknown = KnownShaders::of_process().get(pipelines::OF_ZEROS).unwrap();
        assert_eq!(unknown.effects("main"), crate::vk::shaders::Effects::UNKNOWN);
    });
}
