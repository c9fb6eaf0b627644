//! Pipelines, shaders and modules: refusals of a driver with rate attachments, and kept facts of code.

use super::fake::{pipelines, rates};
use super::*;

/// The outcome of two pipelines, the calls that reached the driver, and whether dynamic rendering still gets attachments.
fn created(amended: vk::Result, plain: vk::Result) -> (vk::Result, [u64; 2], Vec<String>, bool) {
    with_device(|device| {
        pipelines::answer(amended, plain);
        let infos = [vk::GraphicsPipelineCreateInfo::default(); 2];
        let mut made = [vk::Pipeline::null(); 2];
        let function = device_function(device, c"vkCreateGraphicsPipelines");
        // SAFETY: the name gives the type, and the stand-in looks at the flags alone.
        let result = unsafe {
            transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkCreateGraphicsPipelines>(function)(
                device,
                vk::PipelineCache::null(),
                2,
                infos.as_ptr(),
                null(),
                made.as_mut_ptr(),
            )
        };
        (result, made.map(Handle::as_raw), pipelines::seen(), attaches(device))
    })
}

fn with_device<T>(act: impl FnOnce(vk::Device) -> T) -> T {
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
    for refused in [vk::Result::ERROR_UNKNOWN, vk::Result::ERROR_OUT_OF_DEVICE_MEMORY] {
        let (result, made, seen, attaches) = created(refused, SUCCESS);
        assert_eq!((result, made), (SUCCESS, [1, 2]));
        assert_eq!(seen, ["amended 2", "destroy 1", "plain 2"], "nothing is leaked");
        assert!(!attaches, "such pipelines may not be used with an attachment");
    }
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

#[test]
fn effects_are_kept_by_module_identifier() {
    with_device(|device| {
        let code = crate::vk::shaders::effects::tests::plain_shader();
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
