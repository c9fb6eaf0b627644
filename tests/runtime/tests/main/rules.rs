//! Every rule that the runtime is strict about, broken once.

#[path = "rules/steps.rs"]
mod steps;

use crate::application::{
    Application, ENABLE, IDENTITY, V1_0, call, fov, header, name, projection, structure, swapchain_info,
    views, whole,
};
use crate::case::{Case, Mistake, Run};
use ash::vk;
use openxr_sys as xr;
use std::ffi::c_void;
use steps::{
    end_with, end_with_depth, end_with_quad, end_with_views, first_time, in_frame_with_depth, locate_views,
    other_session, set_and_action, swapchain_with,
};

type Start = fn() -> Application;
type Make = fn(&mut Application) -> xr::Result;

const SUCCESS: xr::Result = xr::Result::SUCCESS;
const SIMPLE: &str = "/interaction_profiles/khr/simple_controller";
const SELECT: &str = "/user/hand/left/input/select/click";

/// The rules: a name, the application's state, the mistake, the failing call, its result, and the section of the rule.
#[rustfmt::skip]
const RULES: &[(&str, Start, Make, &str, xr::Result, &str)] = &[
    // Instances.
    ("instance_of_the_future", Application::without_loader, |app| app.create_instance(xr::Version::new(1, 2, 0), &[]),
        "xrCreateInstance", xr::Result::ERROR_API_VERSION_UNSUPPORTED, "API Version Numbers and Semantics"),
    ("instance_without_a_name", Application::without_loader, |app| {
        let mut info = structure!(InstanceCreateInfo {});
        info.application_info.api_version = V1_0;
        call!(app, CreateInstance(&info, &mut app.instance))
    }, "xrCreateInstance", xr::Result::ERROR_NAME_INVALID, "Instance Lifecycle"),
    ("function_without_an_instance", Application::without_loader,
        |app| app.get("xrDestroyInstance").unwrap_err(),
        "xrGetInstanceProcAddr", xr::Result::ERROR_HANDLE_INVALID, "Command Function Pointers"),
    // Structures.
    ("structure_of_another_type", Application::started, |app| {
        let mut info = structure!(SystemGetInfo { form_factor: xr::FormFactor::HEAD_MOUNTED_DISPLAY });
        info.ty = xr::StructureType::SESSION_BEGIN_INFO;
        call!(app, GetSystem(app.instance, &info, &mut app.system))
    }, "xrGetSystem", xr::Result::ERROR_VALIDATION_FAILURE, "Structure Types"),
    ("structure_to_fill_of_another_type", Application::started, |app| {
        let mut properties = structure!(SystemProperties {});
        properties.ty = xr::StructureType::UNKNOWN;
        call!(app, GetSystemProperties(app.instance, app.system, &mut properties))
    }, "xrGetSystemProperties", xr::Result::ERROR_VALIDATION_FAILURE, "Structure Types"),
    ("null_structure", Application::running, |app| call!(app, EndFrame(app.session, std::ptr::null())),
        "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "Valid Usage"),
    ("structure_twice_in_a_chain", Application::started, |app| {
        let second = structure!(GraphicsBindingVulkanKHR {});
        let first = structure!(GraphicsBindingVulkanKHR { next: std::ptr::from_ref(&second).cast() });
        let info = structure!(SessionCreateInfo { next: std::ptr::from_ref(&first).cast::<c_void>() });
        call!(app, CreateSession(app.instance, &info, &mut app.session))
    }, "xrCreateSession", xr::Result::ERROR_VALIDATION_FAILURE, "Next Pointer Chains"),
    ("misaligned_structure_in_a_chain", Application::started, |app| {
        let next = std::ptr::without_provenance::<c_void>(0x7265_746e_6920_656d);
        let info = structure!(SessionCreateInfo { next: next });
        call!(app, CreateSession(app.instance, &info, &mut app.session))
    }, "xrCreateSession", xr::Result::ERROR_VALIDATION_FAILURE, "Next Pointer Chains"),
    ("too_small_an_array", Application::ready, |app| {
        let (mut count, mut formats) = (0, [0_i64; 1]);
        call!(app, EnumerateSwapchainFormats(app.session, 1, &mut count, formats.as_mut_ptr()))
    }, "xrEnumerateSwapchainFormats", xr::Result::ERROR_SIZE_INSUFFICIENT, "Buffer Size Parameters"),
    // Handles.
    ("null_handle", Application::ready, |app| call!(app, BeginFrame(xr::Session::default(), std::ptr::null())),
        "xrBeginFrame", xr::Result::ERROR_HANDLE_INVALID, "Object Handle Types"),
    ("destroyed_handle", Application::ready, |app| {
        let space = app.space(xr::ReferenceSpaceType::LOCAL);
        assert_eq!(call!(app, DestroySpace(space)), SUCCESS);
        call!(app, DestroySpace(space))
    }, "xrDestroySpace", xr::Result::ERROR_HANDLE_INVALID, "Object Handle Types"),
    ("child_of_a_destroyed_session", Application::ready, |app| {
        let swapchain = app.swapchain();
        assert_eq!(call!(app, DestroySession(app.session)), SUCCESS);
        app.acquire(swapchain).unwrap_err()
    }, "xrAcquireSwapchainImage", xr::Result::ERROR_HANDLE_INVALID, "Object Handle Types"),
    ("handle_of_another_kind", Application::ready, |app| {
        use xr::Handle;
        let space = app.space(xr::ReferenceSpaceType::LOCAL);
        call!(app, DestroySwapchain(xr::Swapchain::from_raw(space.into_raw())))
    }, "xrDestroySwapchain", xr::Result::ERROR_HANDLE_INVALID, "Object Handle Types"),
    // System.
    ("handheld_system", Application::started, |app| {
        let info = structure!(SystemGetInfo { form_factor: xr::FormFactor::HANDHELD_DISPLAY });
        call!(app, GetSystem(app.instance, &info, &mut app.system))
    }, "xrGetSystem", xr::Result::ERROR_FORM_FACTOR_UNSUPPORTED, "Form Factors"),
    ("unknown_system", Application::started, |app| {
        let mut properties = structure!(SystemProperties {});
        call!(app, GetSystemProperties(app.instance, xr::SystemId::from_raw(77), &mut properties))
    }, "xrGetSystemProperties", xr::Result::ERROR_SYSTEM_INVALID, "System"),
    ("mono_view_configuration", Application::ready, |app| {
        let ty = xr::ViewConfigurationType::PRIMARY_MONO;
        let info = structure!(SessionBeginInfo { primary_view_configuration_type: ty });
        call!(app, BeginSession(app.session, &info))
    }, "xrBeginSession", xr::Result::ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED, "View Configurations"),
    // Sessions.
    ("session_before_graphics_requirements", Application::started, |app| {
        app.gpu = Some(crate::gpu::Gpu::new());
        app.create_session()
    }, "xrCreateSession", xr::Result::ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING, "Session Creation"),
    ("session_without_graphics", Application::started, |app| {
        app.read_requirements();
        let info = structure!(SessionCreateInfo { system_id: app.system });
        call!(app, CreateSession(app.instance, &info, &mut app.session))
    }, "xrCreateSession", xr::Result::ERROR_GRAPHICS_DEVICE_INVALID, "Session Creation"),
    ("session_on_no_device", Application::started, |app| {
        app.read_requirements();
        app.create_session_with(&structure!(GraphicsBindingVulkanKHR {}))
    }, "xrCreateSession", xr::Result::ERROR_GRAPHICS_DEVICE_INVALID, "Session Creation"),
    ("session_on_a_queue_that_is_not_there", Application::started, |app| {
        app.read_requirements();
        let gpu = app.gpu.insert(crate::gpu::Gpu::new());
        let binding = xr::GraphicsBindingVulkanKHR { queue_index: 999, ..gpu.binding() };
        app.create_session_with(&binding)
    }, "xrCreateSession", xr::Result::ERROR_GRAPHICS_DEVICE_INVALID, "Session Creation"),
    ("session_begun_twice", Application::running, |app| app.begin_session(),
        "xrBeginSession", xr::Result::ERROR_SESSION_RUNNING, "Session Control"),
    ("session_begun_after_its_end", Application::running, |app| {
        assert_eq!(call!(app, RequestExitSession(app.session)), SUCCESS);
        assert_eq!(call!(app, EndSession(app.session)), SUCCESS);
        app.begin_session()
    }, "xrBeginSession", xr::Result::ERROR_SESSION_NOT_READY, "Session Control"),
    ("session_ended_before_it_stops", Application::running, |app| call!(app, EndSession(app.session)),
        "xrEndSession", xr::Result::ERROR_SESSION_NOT_STOPPING, "Session Control"),
    ("session_ended_before_it_begins", Application::ready, |app| call!(app, EndSession(app.session)),
        "xrEndSession", xr::Result::ERROR_SESSION_NOT_RUNNING, "Session Control"),
    ("exit_of_a_session_that_does_not_run", Application::ready, |app| call!(app, RequestExitSession(app.session)),
        "xrRequestExitSession", xr::Result::ERROR_SESSION_NOT_RUNNING, "Session Control"),
    // Frames.
    ("frame_of_a_session_that_does_not_run", Application::ready, |app| {
        let mut state = structure!(FrameState {});
        call!(app, WaitFrame(app.session, std::ptr::null(), &mut state))
    }, "xrWaitFrame", xr::Result::ERROR_SESSION_NOT_RUNNING, "Session Control"),
    ("frame_waited_for_twice_by_one_thread", Application::running, |app| {
        app.wait_frame();
        let mut state = structure!(FrameState {});
        call!(app, WaitFrame(app.session, std::ptr::null(), &mut state))
    }, "xrWaitFrame", xr::Result::ERROR_RUNTIME_FAILURE, "Frame Synchronization"),
    ("frame_begun_without_a_wait", Application::running, |app| call!(app, BeginFrame(app.session, std::ptr::null())),
        "xrBeginFrame", xr::Result::ERROR_CALL_ORDER_INVALID, "Frame Synchronization"),
    ("frame_ended_without_a_begin", Application::running, |app| {
        let time = app.wait_frame().predicted_display_time;
        app.end_frame(time, &[])
    }, "xrEndFrame", xr::Result::ERROR_CALL_ORDER_INVALID, "Frame Submission"),
    ("frame_ended_twice", Application::in_frame, |app| {
        assert_eq!(app.end_frame(first_time(), &[]), SUCCESS);
        app.end_frame(first_time(), &[])
    }, "xrEndFrame", xr::Result::ERROR_CALL_ORDER_INVALID, "Frame Submission"),
    ("frame_for_another_time", Application::in_frame, |app| app.end_frame(xr::Time::from_nanos(5), &[]),
        "xrEndFrame", xr::Result::ERROR_TIME_INVALID, "Frame Submission"),
    ("blend_mode_of_glasses", Application::in_frame, |app| {
        let mode = xr::EnvironmentBlendMode::ADDITIVE;
        let info = structure!(FrameEndInfo { display_time: first_time(), environment_blend_mode: mode });
        call!(app, EndFrame(app.session, &info))
    }, "xrEndFrame", xr::Result::ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED, "Frame Submission"),
    // Layers.
    ("too_many_layers", Application::in_frame, |app| {
        let swapchain = app.swapchain();
        app.show(swapchain, 0, &[]);
        let views = views(swapchain);
        let layer = projection(app.space(xr::ReferenceSpaceType::LOCAL), &views);
        app.end_frame(first_time(), &[header(&layer); 17])
    }, "xrEndFrame", xr::Result::ERROR_LAYER_LIMIT_EXCEEDED, "Frame Submission"),
    ("null_layer", Application::in_frame, |app| {
        let layers = [std::ptr::null()];
        let info = structure!(FrameEndInfo {
            display_time: first_time(),
            environment_blend_mode: xr::EnvironmentBlendMode::OPAQUE,
            layer_count: 1,
            layers: layers.as_ptr(),
        });
        call!(app, EndFrame(app.session, &info))
    }, "xrEndFrame", xr::Result::ERROR_LAYER_INVALID, "Frame Submission"),
    ("layer_of_an_extension_that_is_not_enabled", Application::in_frame, |app| {
        let layer = structure!(CompositionLayerCubeKHR {});
        app.end_frame(first_time(), &[header(&layer)])
    }, "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "Composition Layer Types"),
    ("one_view", Application::in_frame, |app| {
        let swapchain = app.swapchain();
        app.show(swapchain, 0, &[]);
        let views = views(swapchain);
        let layer = projection(app.space(xr::ReferenceSpaceType::LOCAL), &views[..1]);
        app.end_frame(first_time(), &[header(&layer)])
    }, "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "Composition Layer Types"),
    ("view_of_another_type", Application::in_frame,
        |app| end_with(app, |views| views[1].ty = xr::StructureType::VIEW),
        "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "Structure Types"),
    ("swapchain_never_released", Application::in_frame, |app| {
        let swapchain = app.swapchain();
        app.acquire(swapchain).unwrap();
        end_with_views(app, &mut views(swapchain), |_| {})
    }, "xrEndFrame", xr::Result::ERROR_LAYER_INVALID, "Frame Submission"),
    ("rectangle_beyond_the_image", Application::in_frame,
        |app| end_with(app, |views| views[0].sub_image.image_rect.offset.x = 1),
        "xrEndFrame", xr::Result::ERROR_SWAPCHAIN_RECT_INVALID, "Frame Submission"),
    ("empty_rectangle", Application::in_frame,
        |app| end_with(app, |views| views[0].sub_image.image_rect.extent.height = 0),
        "xrEndFrame", xr::Result::ERROR_SWAPCHAIN_RECT_INVALID, "Frame Submission"),
    ("layer_beyond_the_array", Application::in_frame,
        |app| end_with(app, |views| views[1].sub_image.image_array_index = 1),
        "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "Composition Layer Types"),
    ("orientation_of_length_two", Application::in_frame,
        |app| end_with(app, |views| views[0].pose.orientation.w = 2.0),
        "xrEndFrame", xr::Result::ERROR_POSE_INVALID, "Common Object Types and Conventions: Poses"),
    ("position_that_is_no_number", Application::in_frame,
        |app| end_with(app, |views| views[0].pose.position.y = f32::NAN),
        "xrEndFrame", xr::Result::ERROR_POSE_INVALID, "Common Object Types and Conventions: Poses"),
    ("field_of_view_of_nothing", Application::in_frame,
        |app| end_with(app, |views| views[0].fov = xr::Fovf { angle_left: fov().angle_right, ..fov() }),
        "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "View and Projection State"),
    ("field_of_view_behind_the_head", Application::in_frame,
        |app| end_with(app, |views| views[0].fov.angle_up = 1.6),
        "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "View and Projection State"),
    ("swapchain_of_another_session", Application::in_frame, |app| {
        let other = other_session(app);
        let first = std::mem::replace(&mut app.session, other);
        let swapchain = app.swapchain();
        app.show(swapchain, 0, &[]);
        app.session = first;
        end_with_views(app, &mut views(swapchain), |_| {})
    }, "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "Composition Layer Types"),
    ("layer_in_a_space_of_another_session", Application::in_frame, |app| {
        let other = other_session(app);
        let first = std::mem::replace(&mut app.session, other);
        let space = app.space(xr::ReferenceSpaceType::LOCAL);
        app.session = first;
        end_with_quad(app, |quad| quad.space = space)
    }, "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "Composition Layer Types"),
    ("quad_of_no_size", Application::in_frame, |app| end_with_quad(app, |quad| quad.size.width = 0.0),
        "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "Composition Layer Types"),
    ("quad_for_a_third_eye", Application::in_frame,
        |app| end_with_quad(app, |quad| quad.eye_visibility = xr::EyeVisibility::from_raw(3)),
        "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "Composition Layer Types"),
    ("depth_range_beyond_one", in_frame_with_depth, |app| end_with_depth(app, |depth| depth.max_depth = 1.5),
        "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "XR_KHR_composition_layer_depth"),
    ("near_is_far", in_frame_with_depth, |app| end_with_depth(app, |depth| depth.near_z = depth.far_z),
        "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "XR_KHR_composition_layer_depth"),
    ("depth_beyond_the_image", in_frame_with_depth,
        |app| end_with_depth(app, |depth| depth.sub_image.image_rect.extent.width += 1),
        "xrEndFrame", xr::Result::ERROR_SWAPCHAIN_RECT_INVALID, "Frame Submission"),
    ("colour_as_depth", in_frame_with_depth, |app| {
        let colour = app.swapchain();
        app.show(colour, 0, &[]);
        end_with_depth(app, |depth| depth.sub_image = whole(colour))
    }, "xrEndFrame", xr::Result::ERROR_VALIDATION_FAILURE, "Composition Layer Types"),
    // Swapchains.
    ("unknown_format", Application::ready, |app| swapchain_with(app, |info| info.format = 1),
        "xrCreateSwapchain", xr::Result::ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED, "Swapchain Image Management"),
    ("swapchain_of_no_width", Application::ready, |app| swapchain_with(app, |info| info.width = 0),
        "xrCreateSwapchain", xr::Result::ERROR_VALIDATION_FAILURE, "Swapchain Image Management"),
    ("swapchain_larger_than_the_system_allows", Application::ready,
        |app| swapchain_with(app, |info| info.height = 8193),
        "xrCreateSwapchain", xr::Result::ERROR_VALIDATION_FAILURE, "Swapchain Image Management"),
    ("three_samples", Application::ready, |app| swapchain_with(app, |info| info.sample_count = 3),
        "xrCreateSwapchain", xr::Result::ERROR_VALIDATION_FAILURE, "Swapchain Image Management"),
    ("two_faces", Application::ready, |app| swapchain_with(app, |info| info.face_count = 2),
        "xrCreateSwapchain", xr::Result::ERROR_VALIDATION_FAILURE, "Swapchain Image Management"),
    ("mips_beyond_one_texel", Application::ready, |app| swapchain_with(app, |info| info.mip_count = 8),
        "xrCreateSwapchain", xr::Result::ERROR_VALIDATION_FAILURE, "Swapchain Image Management"),
    ("protected_swapchain", Application::ready,
        |app| swapchain_with(app, |info| info.create_flags = xr::SwapchainCreateFlags::PROTECTED_CONTENT),
        "xrCreateSwapchain", xr::Result::ERROR_FEATURE_UNSUPPORTED, "Swapchain Image Management"),
    ("depth_usage_of_a_colour_format", Application::ready,
        |app| swapchain_with(app, |info| info.usage_flags = xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT),
        "xrCreateSwapchain", xr::Result::ERROR_FEATURE_UNSUPPORTED, "Swapchain Image Management"),
    ("view_formats_without_mutable_usage",
        || Application::ready_with(V1_0, &[ENABLE, "XR_KHR_vulkan_swapchain_format_list"]), |app| {
        let formats = [vk::Format::R8G8B8A8_SRGB, vk::Format::R8G8B8A8_UNORM].map(|format| format.as_raw() as u32);
        let list = structure!(VulkanSwapchainFormatListCreateInfoKHR {
            view_format_count: 2,
            view_formats: formats.as_ptr(),
        });
        swapchain_with(app, |info| info.next = std::ptr::from_ref(&list).cast())
    }, "xrCreateSwapchain", xr::Result::ERROR_VALIDATION_FAILURE, "XR_KHR_vulkan_swapchain_format_list"),
    ("image_beyond_the_count", Application::ready, |app| {
        let swapchain = app.swapchain();
        (0..3).for_each(|index| assert_eq!(app.acquire(swapchain), Ok(index)));
        app.acquire(swapchain).unwrap_err()
    }, "xrAcquireSwapchainImage", xr::Result::ERROR_CALL_ORDER_INVALID, "Swapchain Image Management"),
    ("static_image_twice", Application::ready, |app| {
        let flags = xr::SwapchainCreateFlags::STATIC_IMAGE;
        let info = xr::SwapchainCreateInfo { create_flags: flags, ..swapchain_info() };
        let swapchain = app.create_swapchain(&info).unwrap();
        assert_eq!(app.images(swapchain).len(), 1);
        app.show(swapchain, 0, &[]);
        app.acquire(swapchain).unwrap_err()
    }, "xrAcquireSwapchainImage", xr::Result::ERROR_CALL_ORDER_INVALID, "Swapchain Image Management"),
    ("wait_for_an_image_that_is_not_acquired", Application::ready, |app| app.wait(app.swapchain()),
        "xrWaitSwapchainImage", xr::Result::ERROR_CALL_ORDER_INVALID, "Swapchain Image Management"),
    ("wait_for_two_images", Application::ready, |app| {
        let swapchain = app.swapchain();
        app.acquire(swapchain).unwrap();
        app.acquire(swapchain).unwrap();
        assert_eq!(app.wait(swapchain), SUCCESS);
        app.wait(swapchain)
    }, "xrWaitSwapchainImage", xr::Result::ERROR_CALL_ORDER_INVALID, "Swapchain Image Management"),
    ("release_without_a_wait", Application::ready, |app| {
        let swapchain = app.swapchain();
        app.acquire(swapchain).unwrap();
        app.release(swapchain)
    }, "xrReleaseSwapchainImage", xr::Result::ERROR_CALL_ORDER_INVALID, "Swapchain Image Management"),
    // Paths, spaces and views.
    ("path_with_a_capital", Application::started, |app| {
        let mut path = xr::Path::NULL;
        call!(app, StringToPath(app.instance, c"/User".as_ptr(), &mut path))
    }, "xrStringToPath", xr::Result::ERROR_PATH_FORMAT_INVALID, "Semantic Paths"),
    ("path_that_is_none", Application::started, |app| {
        let mut count = 0;
        call!(app, PathToString(app.instance, xr::Path::from_raw(99), 0, &mut count, std::ptr::null_mut()))
    }, "xrPathToString", xr::Result::ERROR_PATH_INVALID, "Semantic Paths"),
    ("floor_of_openxr_1_1", Application::ready, |app| {
        let ty = xr::ReferenceSpaceType::LOCAL_FLOOR;
        let info = structure!(ReferenceSpaceCreateInfo { reference_space_type: ty, pose_in_reference_space: IDENTITY });
        call!(app, CreateReferenceSpace(app.session, &info, &mut xr::Space::default()))
    }, "xrCreateReferenceSpace", xr::Result::ERROR_REFERENCE_SPACE_UNSUPPORTED, "Reference Spaces"),
    ("space_of_a_pose_of_zeros", Application::ready, |app| {
        let info = structure!(ReferenceSpaceCreateInfo { reference_space_type: xr::ReferenceSpaceType::VIEW });
        call!(app, CreateReferenceSpace(app.session, &info, &mut xr::Space::default()))
    }, "xrCreateReferenceSpace", xr::Result::ERROR_POSE_INVALID, "Common Object Types and Conventions: Poses"),
    ("space_at_no_time", Application::ready, |app| {
        let (space, mut location) = (app.space(xr::ReferenceSpaceType::VIEW), structure!(SpaceLocation {}));
        call!(app, LocateSpace(space, space, xr::Time::from_nanos(0), &mut location))
    }, "xrLocateSpace", xr::Result::ERROR_TIME_INVALID, "Locating Spaces"),
    ("views_at_no_time", Application::ready,
        |app| locate_views(app, |info| info.display_time = xr::Time::from_nanos(-1), 2),
        "xrLocateViews", xr::Result::ERROR_TIME_INVALID, "View and Projection State"),
    ("room_for_one_view", Application::ready, |app| locate_views(app, |_| {}, 1),
        "xrLocateViews", xr::Result::ERROR_SIZE_INSUFFICIENT, "Buffer Size Parameters"),
    // Actions.
    ("action_set_without_a_name", Application::started, |app| {
        let info = structure!(ActionSetCreateInfo { localized_action_set_name: name("x") });
        call!(app, CreateActionSet(app.instance, &info, &mut xr::ActionSet::default()))
    }, "xrCreateActionSet", xr::Result::ERROR_NAME_INVALID, "Creating Actions"),
    ("action_with_a_space_in_its_name", Application::started, |app| {
        let set = app.action_set("play");
        app.try_action(set, "two words", xr::ActionType::BOOLEAN_INPUT, &[]).unwrap_err()
    }, "xrCreateAction", xr::Result::ERROR_PATH_FORMAT_INVALID, "Creating Actions"),
    ("action_of_the_same_name", Application::started, |app| {
        let (set, _) = set_and_action(app);
        app.try_action(set, "press", xr::ActionType::BOOLEAN_INPUT, &[]).unwrap_err()
    }, "xrCreateAction", xr::Result::ERROR_NAME_DUPLICATED, "Creating Actions"),
    ("action_of_a_third_hand", Application::started, |app| {
        let (set, path) = (app.action_set("play"), app.path("/user/hand/third"));
        app.try_action(set, "press", xr::ActionType::BOOLEAN_INPUT, &[path]).unwrap_err()
    }, "xrCreateAction", xr::Result::ERROR_PATH_UNSUPPORTED, "Creating Actions"),
    ("action_for_an_attached_set", Application::ready, |app| {
        let (set, _) = set_and_action(app);
        assert_eq!(app.attach(&[set]), SUCCESS);
        app.try_action(set, "late", xr::ActionType::BOOLEAN_INPUT, &[]).unwrap_err()
    }, "xrCreateAction", xr::Result::ERROR_ACTIONSETS_ALREADY_ATTACHED, "Creating Actions"),
    ("unknown_interaction_profile", Application::started, |app| {
        let (_, action) = set_and_action(app);
        app.suggest("/interaction_profiles/acme/glove", &[(action, SELECT)])
    }, "xrSuggestInteractionProfileBindings", xr::Result::ERROR_PATH_UNSUPPORTED, "Suggested Bindings"),
    ("gaze_profile_without_its_extension", Application::started, |app| {
        let set = app.action_set("play");
        let action = app.action(set, "gaze", xr::ActionType::POSE_INPUT);
        let (profile, source) = ("/interaction_profiles/ext/eye_gaze_interaction", "/user/eyes_ext/input/gaze_ext/pose");
        app.suggest(profile, &[(action, source)])
    }, "xrSuggestInteractionProfileBindings", xr::Result::ERROR_PATH_UNSUPPORTED, "Suggested Bindings"),
    ("binding_that_the_profile_lacks", Application::started, |app| {
        let (_, action) = set_and_action(app);
        app.suggest(SIMPLE, &[(action, "/user/hand/left/input/thumbstick")])
    }, "xrSuggestInteractionProfileBindings", xr::Result::ERROR_PATH_UNSUPPORTED, "Suggested Bindings"),
    ("bindings_for_an_attached_set", Application::ready, |app| {
        let (set, action) = set_and_action(app);
        assert_eq!(app.attach(&[set]), SUCCESS);
        app.suggest(SIMPLE, &[(action, SELECT)])
    }, "xrSuggestInteractionProfileBindings", xr::Result::ERROR_ACTIONSETS_ALREADY_ATTACHED, "Suggested Bindings"),
    ("second_attach", Application::ready, |app| {
        assert_eq!(app.attach(&[app.action_set("play")]), SUCCESS);
        app.attach(&[app.action_set("menu")])
    }, "xrAttachSessionActionSets", xr::Result::ERROR_ACTIONSETS_ALREADY_ATTACHED, "Action Sets"),
    ("attach_of_nothing", Application::ready, |app| app.attach(&[]),
        "xrAttachSessionActionSets", xr::Result::ERROR_VALIDATION_FAILURE, "Action Sets"),
    ("sync_without_attach", Application::running, |app| app.sync(&[app.action_set("play")]),
        "xrSyncActions", xr::Result::ERROR_ACTIONSET_NOT_ATTACHED, "Input Action State Synchronization"),
    ("sync_of_a_set_that_is_not_attached", Application::running, |app| {
        assert_eq!(app.attach(&[app.action_set("play")]), SUCCESS);
        app.sync(&[app.action_set("menu")])
    }, "xrSyncActions", xr::Result::ERROR_ACTIONSET_NOT_ATTACHED, "Input Action State Synchronization"),
    ("state_of_an_action_that_is_not_attached", Application::running, |app| {
        let (_, action) = set_and_action(app);
        app.boolean(action).err().unwrap()
    }, "xrGetActionStateBoolean", xr::Result::ERROR_ACTIONSET_NOT_ATTACHED, "Action Sets"),
    ("state_of_another_type", Application::running, |app| {
        let set = app.action_set("play");
        let action = app.action(set, "pull", xr::ActionType::FLOAT_INPUT);
        assert_eq!(app.attach(&[set]), SUCCESS);
        app.boolean(action).err().unwrap()
    }, "xrGetActionStateBoolean", xr::Result::ERROR_ACTION_TYPE_MISMATCH, "Reading Input Action State"),
    ("state_of_a_subaction_that_is_not_declared", Application::running, |app| {
        let (set, action) = set_and_action(app);
        assert_eq!(app.attach(&[set]), SUCCESS);
        let path = app.path("/user/hand/left");
        let info = structure!(ActionStateGetInfo { action: action, subaction_path: path });
        let mut state = structure!(ActionStateBoolean {});
        call!(app, GetActionStateBoolean(app.session, &info, &mut state))
    }, "xrGetActionStateBoolean", xr::Result::ERROR_PATH_UNSUPPORTED, "Creating Actions"),
    ("space_of_an_action_without_a_pose", Application::ready, |app| {
        let (_, action) = set_and_action(app);
        let info = structure!(ActionSpaceCreateInfo { action: action, pose_in_action_space: IDENTITY });
        call!(app, CreateActionSpace(app.session, &info, &mut xr::Space::default()))
    }, "xrCreateActionSpace", xr::Result::ERROR_ACTION_TYPE_MISMATCH, "Action Spaces"),
    ("profile_without_attach", Application::ready, |app| {
        let path = app.path("/user/hand/left");
        let mut state = structure!(InteractionProfileState {});
        call!(app, GetCurrentInteractionProfile(app.session, path, &mut state))
    }, "xrGetCurrentInteractionProfile", xr::Result::ERROR_ACTIONSET_NOT_ATTACHED, "Current Interaction Profile"),
    // Extensions.
    ("mask_of_a_third_view", || Application::ready_with(V1_0, &[ENABLE, "XR_KHR_visibility_mask"]), |app| {
        let (stereo, ty) = (xr::ViewConfigurationType::PRIMARY_STEREO, xr::VisibilityMaskTypeKHR::LINE_LOOP);
        let mut mask = structure!(VisibilityMaskKHR {});
        call!(app, GetVisibilityMaskKHR(app.session, stereo, 2, ty, &mut mask))
    }, "xrGetVisibilityMaskKHR", xr::Result::ERROR_VALIDATION_FAILURE, "XR_KHR_visibility_mask"),
    ("messenger_without_a_function", || Application::with_instance(V1_0, &["XR_EXT_debug_utils"]), |app| {
        let info = structure!(DebugUtilsMessengerCreateInfoEXT {});
        call!(app, CreateDebugUtilsMessengerEXT(app.instance, &info, &mut xr::DebugUtilsMessengerEXT::default()))
    }, "xrCreateDebugUtilsMessengerEXT", xr::Result::ERROR_VALIDATION_FAILURE, "XR_EXT_debug_utils"),
    ("time_before_time", || Application::with_instance(V1_0, &["XR_KHR_convert_timespec_time"]), |app| {
        let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
        call!(app, ConvertTimeToTimespecTimeKHR(app.instance, xr::Time::from_nanos(0), &mut time))
    }, "xrConvertTimeToTimespecTimeKHR", xr::Result::ERROR_TIME_INVALID, "XR_KHR_convert_timespec_time"),
];

/// A case for each rule.
pub fn cases() -> Vec<Case> {
    let case =
        |&(name, start, make, call, result, section): &(&str, Start, Make, &'static str, _, &'static str)| {
            Case {
                name: format!("rule::{name}"),
                scenario: "[output]\ncomposite=false\n".to_owned(),
                run: Run::Mistake(Mistake { start, make, call, result, section }),
            }
        };
    RULES.iter().map(case).collect()
}
