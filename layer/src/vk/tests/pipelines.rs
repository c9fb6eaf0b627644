//! Pipelines, shaders and modules: refusals of a driver with rate attachments, and kept facts of code.

use super::fake::{pipelines, rates};
use super::*;
use crate::vk::newer;
use crate::vk::shaders::effects::tests::{plain_shader, storing_shader};

/// The outcome of two pipelines, the calls that reached the driver, and whether dynamic rendering still gets attachments.
fn created(amended: vk::Result, plain: vk::Result) -> (vk::Result, [u64; 2], Vec<String>, bool) {
    with_device(|device| {
        pipelines::answer(amended, plain);
        let (result, made) = create(device, [vk::GraphicsPipelineCreateInfo::default(); 2]);
        (result, made, pipelines::seen(), attaches(device))
    })
}

/// The result for pipelines, and their handles.
pub(super) fn create<const N: usize>(
    device: vk::Device,
    infos: [vk::GraphicsPipelineCreateInfo<'_>; N],
) -> (vk::Result, [u64; N]) {
    // As a driver leaves it to the application.
    let mut made = [vk::Pipeline::from_raw(0xbad); N];
    let function = device_function(device, c"vkCreateGraphicsPipelines");
    // SAFETY: the name gives the type; the structures are valid as far as layer and stand-in look at them.
    let result = unsafe {
        transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkCreateGraphicsPipelines>(function)(
            device,
            vk::PipelineCache::null(),
            N as u32,
            infos.as_ptr(),
            null(),
            made.as_mut_ptr(),
        )
    };
    (result, made.map(Handle::as_raw))
}

pub(super) fn with_device<T>(act: impl FnOnce(vk::Device) -> T) -> T {
    rates::capabilities(true, false);
    let instance = new_instance(Some(vk::API_VERSION_1_1));
    let device = new_device(instance);
    pipelines::seen();
    let done = act(device);
    destroy_device(device);
    destroy_instance(instance);
    rates::capabilities(false, false);
    done
}

fn attaches(device: vk::Device) -> bool {
    // SAFETY: the device is live.
    unsafe { device::of(device) }.unwrap().rate_attachments().unwrap().attaches_to_rendering()
}

const SUCCESS: vk::Result = vk::Result::SUCCESS;

#[test]
fn pipelines_that_are_taken_are_made_once() {
    let (result, made, seen, attaches) = created(SUCCESS, SUCCESS);
    assert_eq!((result, made, attaches), (SUCCESS, [1, 2], true));
    assert_eq!(seen, ["amended 2"]);
}

#[test]
fn pipelines_that_are_refused_are_made_as_the_application_asks() {
    let (result, made, seen, attaches) = created(vk::Result::ERROR_UNKNOWN, SUCCESS);
    assert_eq!((result, made), (SUCCESS, [1, 2]));
    assert_eq!(seen, ["amended 2", "destroy 1", "plain 2"], "nothing is leaked");
    assert!(!attaches, "such pipelines may not be used with an attachment");
    let line = "dynamic rendering: shaded at 1x1 until a restart of the application, as the driver creates pipelines only \
                without shading rates: ERROR_UNKNOWN";
    assert!(crate::status::all_decisions().iter().any(|decision| decision.line == line));
}

/// Data of an amended pipeline would become part of pipelines without the layer, and the other way round.
#[test]
fn pipelines_from_and_for_binaries_are_made_as_the_application_asks() {
    let none = vk::GraphicsPipelineCreateInfo::default();
    let binaries = |count| newer::PipelineBinaryInfo {
        s_type: <newer::PipelineBinaryInfo as vk::TaggedStructure>::STRUCTURE_TYPE,
        p_next: null(),
        count,
        binaries: &7,
    };
    let (from, from_none) = (binaries(1), binaries(0));
    let chained = |binaries: &newer::PipelineBinaryInfo| vk::GraphicsPipelineCreateInfo {
        p_next: std::ptr::from_ref(binaries).cast(),
        ..none
    };
    let mut captured =
        vk::PipelineCreateFlags2CreateInfoKHR::default().flags(newer::PIPELINE_CREATE_2_CAPTURE_DATA_KHR);
    let captured = none.push_next(&mut captured);
    let of_pass =
        vk::GraphicsPipelineCreateInfo { render_pass: vk::RenderPass::from_raw(5), ..chained(&from) };
    for (info, is_plain, attaches_after) in [
        (chained(&from), true, false),
        (captured, true, false),
        (of_pass, true, true),
        (chained(&from_none), false, true),
    ] {
        with_device(|device| {
            pipelines::answer(SUCCESS, SUCCESS);
            assert_eq!(create(device, [info]), (SUCCESS, [1]));
            assert_eq!(pipelines::seen(), [if is_plain { "plain 1" } else { "amended 1" }]);
            assert_eq!(attaches(device), attaches_after);
        });
    }
}

/// The flags of a chain behind an unknown structure are amended in place, for each pipeline of the chain.
#[test]
fn pipelines_that_share_a_chain_get_the_same_rates() {
    with_device(|device| {
        pipelines::answer(SUCCESS, SUCCESS);
        let mut flags = vk::PipelineCreateFlags2CreateInfoKHR::default();
        let unknown = vk::BaseInStructure {
            s_type: vk::StructureType::from_raw(1_999_999_999),
            p_next: (&raw mut flags).cast(),
            ..Default::default()
        };
        let p_next = std::ptr::from_ref(&unknown).cast();
        let info = vk::GraphicsPipelineCreateInfo { p_next, ..Default::default() };
        assert_eq!(create(device, [info; 2]), (SUCCESS, [1, 2]));
        let combiners = pipelines::combiners();
        assert!(combiners[0].is_some() && combiners[0] == combiners[1], "{combiners:?}");
    });
}

/// A passing want of memory leaves no trace; one that lasts with the additions alone counts as a refusal.
#[test]
fn a_creation_without_memory_is_repeated_with_rates() {
    for lack in [vk::Result::ERROR_OUT_OF_HOST_MEMORY, vk::Result::ERROR_OUT_OF_DEVICE_MEMORY] {
        pipelines::answer_first(lack);
        let (result, made, seen, attaches) = created(SUCCESS, SUCCESS);
        assert_eq!((result, made, attaches), (SUCCESS, [1, 2], true), "{lack:?}");
        assert_eq!(seen, ["amended 2", "destroy 1", "amended 2"], "{lack:?}");
        pipelines::answer_first(lack);
        let (result, made, _, attaches) = created(vk::Result::PIPELINE_COMPILE_REQUIRED_EXT, SUCCESS);
        let expected = (vk::Result::PIPELINE_COMPILE_REQUIRED_EXT, [1, 0], true);
        assert_eq!((result, made, attaches), expected, "{lack:?}");
        let (result, made, seen, attaches) = created(lack, SUCCESS);
        assert_eq!((result, made, attaches), (SUCCESS, [1, 2], false), "{lack:?}");
        assert_eq!(seen, ["amended 2", "destroy 1", "amended 2", "destroy 1", "plain 2"], "{lack:?}");
    }
}

/// The driver has no memory for such pipelines in any way.
#[test]
fn pipelines_that_fail_without_rates_too_change_nothing() {
    let lack = vk::Result::ERROR_OUT_OF_DEVICE_MEMORY;
    with_device(|device| {
        pipelines::answer(lack, lack);
        let (result, made) = create(device, [vk::GraphicsPipelineCreateInfo::default()]);
        assert_eq!((result, made, attaches(device)), (lack, [0], true));
        assert_eq!(pipelines::seen(), ["amended 1", "amended 1", "plain 1"]);
    });
}

/// The flag is for fragment shaders alone: others fail for reasons of their own.
#[test]
fn shaders_without_the_flag_are_made_once() {
    with_device(|device| {
        let lack = vk::Result::ERROR_OUT_OF_DEVICE_MEMORY;
        pipelines::answer(SUCCESS, lack);
        let info = vk::ShaderCreateInfoEXT::default().stage(vk::ShaderStageFlags::VERTEX);
        let mut made = [vk::ShaderEXT::null(); 2];
        let function = device_function(device, c"vkCreateShadersEXT");
        // SAFETY: the name gives the type, and the stand-in looks at the flags alone.
        let result = unsafe {
            transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkCreateShadersEXT>(function)(
                device,
                2,
                [info; 2].as_ptr(),
                null(),
                made.as_mut_ptr(),
            )
        };
        assert_eq!((result, made.map(Handle::as_raw), attaches(device)), (lack, [1, 0], true));
        assert_eq!(pipelines::seen(), ["plain 2"]);
    });
}

#[test]
fn the_driver_has_the_last_word() {
    let error = vk::Result::ERROR_OUT_OF_HOST_MEMORY;
    let (result, made, seen, _) = created(vk::Result::ERROR_UNKNOWN, error);
    assert_eq!((result, made), (error, [1, 0]));
    assert_eq!(seen, ["amended 2", "destroy 1", "plain 2"]);
}

#[test]
fn positive_results_are_not_retried() {
    for answer in [vk::Result::PIPELINE_COMPILE_REQUIRED_EXT, vk::Result::ERROR_DEVICE_LOST] {
        let (result, made, seen, attaches) = created(answer, SUCCESS);
        assert_eq!((result, made, attaches), (answer, [1, 0], true));
        assert_eq!(seen, ["amended 2"]);
    }
}

/// `parafovea status` and the log name the cause of draws at full rate.
#[test]
fn causes_of_full_rate_are_decisions() {
    with_device(|device| {
        pipelines::answer(SUCCESS, SUCCESS);
        let stages = [vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::FRAGMENT)
            .name(c"main")];
        let samples = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(vk::SampleCountFlags::TYPE_1)
            .sample_shading_enable(true);
        let info = vk::GraphicsPipelineCreateInfo::default().stages(&stages).multisample_state(&samples);
        // A render pass without rates, where nothing stays finer than elsewhere.
        let many = samples.rasterization_samples(vk::SampleCountFlags::TYPE_16);
        let other = info.multisample_state(&many).render_pass(vk::RenderPass::from_raw(99));
        let (result, made) = create(device, [info, other]);
        assert_eq!((result, made), (SUCCESS, [1, 2]));
    });
    let decisions = crate::status::all_decisions();
    assert!(decisions.iter().all(|decision| !decision.line.contains("many samples")), "{decisions:#?}");
    for draws in ["fragment shaders of unknown code", "shading per sample"] {
        let line = format!("draws with {draws}: shaded at 1x1, as ");
        let found = decisions.iter().find(|decision| decision.line.starts_with(&line));
        assert_eq!(found.map(|found| found.topic.reason()), Some(draws));
    }
}

/// As in materials with virtual textures.
#[test]
fn shaders_that_store_are_coarse_if_the_configuration_allows_it() {
    let rated = |code: &[u32], coarse_stores: bool| {
        COARSE_STORES.set(coarse_stores);
        with_device(|device| {
            pipelines::answer(SUCCESS, SUCCESS);
            let mut code = vk::ShaderModuleCreateInfo::default().code(code);
            let stages = [vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::FRAGMENT)
                .name(c"main")
                .push_next(&mut code)];
            let (result, _) = create(device, [vk::GraphicsPipelineCreateInfo::default().stages(&stages)]);
            assert_eq!(result, SUCCESS);
            COARSE_STORES.set(false);
            pipelines::combiners()[0]
        })
    };
    use vk::FragmentShadingRateCombinerOpKHR as Combiner;
    let coarse = Some([Combiner::KEEP, Combiner::REPLACE]);
    let [stores, stores_and_discards] = [false, true].map(storing_shader);
    assert_eq!([false, true].map(|allows| rated(&stores, allows)), [None, coarse]);
    assert_eq!([false, true].map(|allows| rated(&stores_and_discards, allows)), [None; 2], "other obstacles");
    assert_eq!([false, true].map(|allows| rated(&plain_shader(), allows)), [coarse; 2]);
    assert_eq!([false, true].map(|allows| rated(&[0; 8], allows)), [None; 2], "unknown code");
}

#[test]
fn effects_are_kept_by_module_identifier() {
    with_device(|device| {
        let code = plain_shader();
        let info = vk::ShaderModuleCreateInfo::default().code(&code);
        let mut identifier = vk::ShaderModuleIdentifierEXT::default();
        let function = device_function(device, c"vkGetShaderModuleCreateInfoIdentifierEXT");
        // SAFETY: the name gives the type; the arguments are valid.
        unsafe {
            transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkGetShaderModuleCreateInfoIdentifierEXT>(function)(
                device,
                &info,
                &mut identifier,
            );
        }
        assert_eq!(identifier.identifier_size as usize, pipelines::IDENTIFIER.len());
        let known = crate::vk::shaders::KnownShaders::of_process().get(pipelines::IDENTIFIER);
        assert!(!known.unwrap().effects("main").stores);
    });
}

#[test]
fn shaders_that_are_refused_are_made_as_the_application_asks() {
    with_device(|device| {
        pipelines::answer(vk::Result::ERROR_INITIALIZATION_FAILED, SUCCESS);
        let info = vk::ShaderCreateInfoEXT::default()
            .stage(vk::ShaderStageFlags::FRAGMENT)
            .code_type(vk::ShaderCodeTypeEXT::BINARY);
        let infos = [info; 2];
        let mut made = [vk::ShaderEXT::null(); 2];
        let function = device_function(device, c"vkCreateShadersEXT");
        // SAFETY: the name gives the type, and the stand-in looks at the flags alone.
        let result = unsafe {
            transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkCreateShadersEXT>(function)(
                device,
                2,
                infos.as_ptr(),
                null(),
                made.as_mut_ptr(),
            )
        };
        assert_eq!((result, made.map(Handle::as_raw)), (SUCCESS, [1, 2]));
        assert_eq!(pipelines::seen(), ["amended 2", "destroy 1", "plain 2"]);
        assert!(!attaches(device));
    });
}
