//! What applications that make no mistake see, under various scenarios.

use crate::application::{
    Application, ENABLE, V1_0, V1_1, call, header, projection, structure, swapchain_info, views,
};
use crate::case::{Case, Mistake, Output, Run};
use crate::gpu::{Gpu, vulkan_loader};
use ash::vk;
use ash::vk::Handle as _;
use openxr_sys as xr;
use openxr_sys::SessionState as State;
use parafovea_mock_runtime::record::Line;
use std::ffi::c_void;
use std::sync::atomic::{AtomicU32, Ordering};

const SUCCESS: xr::Result = xr::Result::SUCCESS;
const GAZE: &str = "XR_EXT_eye_gaze_interaction";
const SIMPLE: &str = "/interaction_profiles/khr/simple_controller";
const SELECT: &str = "/user/hand/right/input/select/click";

pub fn cases() -> Vec<Case> {
    let good = |name: &str, scenario: &str, run: fn(), check: fn(&Output)| Case {
        name: format!("behaviour::{name}"),
        scenario: format!("{scenario}\n[output]\ncomposite=false\n"),
        run: Run::Good { run, check },
    };
    let refused =
        |name: &str, scenario: &str, make: fn(&mut Application) -> xr::Result, result, section| Case {
            name: format!("behaviour::{name}"),
            scenario: format!("{scenario}\n"),
            run: Run::Mistake(Mistake {
                start: Application::without_loader,
                make,
                call: "xrCreateInstance",
                result,
                section,
            }),
        };
    let gaps = "[[gaze]]\nyaw_deg=30\n[[gaze]]\nt=0.015\ntracked=false\n[[gaze]]\nt=0.025\nyaw_deg=-30";
    vec![
        good("two_sessions_one_after_the_other", "[session]\nframes=2", two_sessions, two_sessions_recorded),
        good("visible_and_focused_later", "[session]\nvisible_from=1\nfocused_from=2", late_focus, |_| {}),
        good("frames_that_need_no_rendering", "[session]\nshould_render_off=[1]", should_render, |_| {}),
        good("discarded_frame", "", discarded_frame, |_| {}),
        good("real_time", "[clock]\nmode='real'\nrefresh_hz=50", real_time, |_| {}),
        good("gaze_with_a_gap", &format!("[clock]\nrefresh_hz=100\n{gaps}"), gaze, |_| {}),
        good("no_eye_tracker", "[system]\neye_gaze=false", no_eye_tracker, |_| {}),
        good(
            "head_moves",
            "[clock]\nrefresh_hz=1\n[[head]]\n[[head]]\nt=2\nposition=[0,0,-2]\nyaw_deg=90",
            head,
            |_| {},
        ),
        good(
            "select_is_pressed",
            "[clock]\nrefresh_hz=100\n[[input]]\nt=0.01\npath='/user/hand/right/input/select/click'\nvalue=true",
            select,
            |_| {},
        ),
        good(
            "higher_priority_takes_the_source",
            "[[input]]\npath='/user/hand/right/input/select/click'\nvalue=true",
            priority,
            |_| {},
        ),
        good(
            "wait_times_out_and_succeeds",
            "[swapchain]\nwait_timeouts=[1]\nimages=2",
            wait_timeouts,
            |_| {},
        ),
        good("kinds_of_swapchains", "", swapchains, swapchains_recorded),
        good("openxr_1_1", "", openxr_1_1, |_| {}),
        good("vulkan_enable2", "", enable2, |_| {}),
        good("functions_of_extensions", "", functions, |_| {}),
        good("visibility_mask", "", visibility_mask, |_| {}),
        good("timespec", "", timespec, |_| {}),
        good("unknown_structure_in_a_chain", "", unknown_structure, unknown_structure_recorded),
        refused(
            "extension_off",
            "[system]\nextensions_off=['XR_EXT_eye_gaze_interaction']",
            |app| app.create_instance(V1_0, &[GAZE]),
            xr::Result::ERROR_EXTENSION_NOT_PRESENT,
            "Instance Lifecycle",
        ),
        refused(
            "only_openxr_1_0",
            "[system]\nmax_api='1.0'",
            |app| app.create_instance(V1_1, &[]),
            xr::Result::ERROR_API_VERSION_UNSUPPORTED,
            "API Version Numbers and Semantics",
        ),
        Case {
            name: "behaviour::messenger_hears_of_mistakes".to_owned(),
            scenario: "\n".to_owned(),
            run: Run::Mistake(Mistake {
                start: || Application::with_instance(V1_0, &["XR_EXT_debug_utils"]),
                make: messenger,
                call: "xrPathToString",
                result: xr::Result::ERROR_PATH_INVALID,
                section: "Semantic Paths",
            }),
        },
        Case {
            name: "behaviour::broken_scenario".to_owned(),
            scenario: "[output]\nspeed=1\n".to_owned(),
            run: Run::Good {
                run: || {
                    assert_eq!(
                        Application::nothing().create_instance(V1_0, &[]),
                        xr::Result::ERROR_RUNTIME_FAILURE
                    )
                },
                check: |_| {},
            },
        },
    ]
}

/// A frame without layers.
fn empty_frame(app: &Application) -> xr::FrameState {
    let state = app.begin_frame();
    assert_eq!(app.end_frame(state.predicted_display_time, &[]), SUCCESS);
    state
}

fn two_sessions() {
    let mut app = Application::ready();
    for round in 0..2 {
        if round == 1 {
            assert_eq!(app.create_session(), SUCCESS);
        }
        assert_eq!(app.states(), [State::IDLE, State::READY]);
        assert_eq!(app.begin_session(), SUCCESS);
        empty_frame(&app);
        assert_eq!(app.states(), [State::SYNCHRONIZED, State::VISIBLE, State::FOCUSED]);
        // The first session ends with the scenario's number of frames, the second by request.
        if round == 0 {
            empty_frame(&app);
        } else {
            assert_eq!(call!(app, RequestExitSession(app.session)), SUCCESS);
        }
        assert_eq!(app.states(), [State::VISIBLE, State::SYNCHRONIZED, State::STOPPING]);
        assert_eq!(call!(app, EndSession(app.session)), SUCCESS);
        assert_eq!(app.states(), [State::IDLE, State::EXITING]);
        assert_eq!(call!(app, DestroySession(app.session)), SUCCESS);
    }
}

fn two_sessions_recorded(output: &Output) {
    let frames = output.frames();
    let times: Vec<_> = frames.iter().map(|frame| (frame.index, frame.display_time_ns)).collect();
    assert_eq!(times, [(0, 1_000_000_000), (1, 1_011_111_111), (2, 1_022_222_222)]);
    assert!(frames.windows(2).all(|pair| pair[0].process_cpu_ns <= pair[1].process_cpu_ns));
    let Some(Line::End { frames: 3, errors: 0, .. }) = output.record.last() else {
        panic!("{:?}", output.record.last());
    };
}

fn late_focus() {
    let app = Application::running();
    app.states();
    let seen: Vec<_> = (0..3).map(|_| (bool::from(empty_frame(&app).should_render), app.states())).collect();
    let expected =
        [(false, vec![State::SYNCHRONIZED]), (true, vec![State::VISIBLE]), (true, vec![State::FOCUSED])];
    assert_eq!(seen, expected);
}

fn should_render() {
    let app = Application::running();
    let seen = [(); 3].map(|()| bool::from(empty_frame(&app).should_render));
    assert_eq!(seen, [true, false, true]);
}

fn discarded_frame() {
    let app = Application::running();
    app.begin_frame();
    let second = app.wait_frame();
    assert_eq!(call!(app, BeginFrame(app.session, std::ptr::null())), xr::Result::FRAME_DISCARDED);
    assert_eq!(app.end_frame(second.predicted_display_time, &[]), SUCCESS);
}

fn real_time() {
    let app = Application::running();
    let start = std::time::Instant::now();
    let times = [(); 4].map(|()| empty_frame(&app).predicted_display_time.as_nanos());
    assert!(start.elapsed() >= std::time::Duration::from_millis(59), "{:?}", start.elapsed());
    assert!(
        times.windows(2).all(|pair| (pair[1] - pair[0]) % 20_000_000 == 0 && pair[1] > pair[0]),
        "{times:?}"
    );
}

/// Location of a space in the VIEW space, with the time of the gaze sample.
fn in_view(app: &Application, space: xr::Space, time: xr::Time) -> (xr::SpaceLocation, i64) {
    let mut sample = structure!(EyeGazeSampleTimeEXT {});
    let mut location = structure!(SpaceLocation { next: std::ptr::from_mut(&mut sample).cast() });
    let view = app.space(xr::ReferenceSpaceType::VIEW);
    assert_eq!(call!(app, LocateSpace(space, view, time, &mut location)), SUCCESS);
    (location, sample.time.as_nanos())
}

fn gaze() {
    let app = Application::ready_with(V1_0, &[ENABLE, GAZE]);
    assert_eq!(app.begin_session(), SUCCESS);
    let mut eyes = structure!(SystemEyeGazeInteractionPropertiesEXT {});
    let mut system = structure!(SystemProperties { next: std::ptr::from_mut(&mut eyes).cast::<c_void>() });
    assert_eq!(call!(app, GetSystemProperties(app.instance, app.system, &mut system)), SUCCESS);
    assert_eq!(eyes.supports_eye_gaze_interaction, xr::TRUE);

    let set = app.action_set("play");
    let action = app.action(set, "gaze", xr::ActionType::POSE_INPUT);
    let (profile, source) =
        ("/interaction_profiles/ext/eye_gaze_interaction", "/user/eyes_ext/input/gaze_ext/pose");
    assert_eq!(app.suggest(profile, &[(action, source)]), SUCCESS);
    assert_eq!(app.attach(&[set]), SUCCESS);
    let space = app.action_space(action);

    // Before any sync, and while another frame's sync leaves the set out, there is no gaze.
    let first = app.begin_frame().predicted_display_time;
    assert_eq!(in_view(&app, space, first).0.location_flags, xr::SpaceLocationFlags::EMPTY);
    assert_eq!(app.sync(&[]), SUCCESS);
    assert_eq!(in_view(&app, space, first).0.location_flags, xr::SpaceLocationFlags::EMPTY);

    let mut seen = Vec::new();
    let mut time = first;
    for _ in 0..4 {
        assert_eq!(app.sync(&[set]), SUCCESS);
        let info = structure!(ActionStateGetInfo { action: action });
        let mut state = structure!(ActionStatePose {});
        assert_eq!(call!(app, GetActionStatePose(app.session, &info, &mut state)), SUCCESS);
        let (location, sample) = in_view(&app, space, time);
        let tracked = !location.location_flags.is_empty();
        assert_eq!(bool::from(state.is_active), tracked);
        assert_eq!(sample, if tracked { time.as_nanos() } else { 0 });
        // Sine of half the yaw.
        seen.push(tracked.then(|| (location.pose.orientation.y.asin().to_degrees() * 2.0).round()));
        assert_eq!(app.end_frame(time, &[]), SUCCESS);
        time = app.begin_frame().predicted_display_time;
    }
    assert_eq!(seen, [Some(30.0), Some(30.0), None, Some(-30.0)]);
}

fn no_eye_tracker() {
    let app = Application::ready_with(V1_0, &[ENABLE, GAZE]);
    let mut eyes = structure!(SystemEyeGazeInteractionPropertiesEXT {});
    let mut system = structure!(SystemProperties { next: std::ptr::from_mut(&mut eyes).cast::<c_void>() });
    assert_eq!(call!(app, GetSystemProperties(app.instance, app.system, &mut system)), SUCCESS);
    assert_eq!(eyes.supports_eye_gaze_interaction, xr::FALSE);
}

fn head() {
    let app = Application::running();
    empty_frame(&app);
    let info = structure!(ViewLocateInfo {
        view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
        display_time: empty_frame(&app).predicted_display_time,
        space: app.space(xr::ReferenceSpaceType::LOCAL),
    });
    let (mut state, mut count, mut views) = (structure!(ViewState {}), 0, [structure!(View {}); 2]);
    let result = call!(app, LocateViews(app.session, &info, &mut state, 2, &mut count, views.as_mut_ptr()));
    assert_eq!((result, count), (SUCCESS, 2));
    // After one second of two: a metre ahead, half-way to the left, where the left eye is behind the right one.
    let [left, right] = views.map(|view| view.pose.position);
    let close = |a: f32, b: f32| (a - b).abs() < 1e-5;
    let offset = 0.032 * 45_f32.to_radians().cos();
    assert!(close(left.x, -offset) && close(left.z, -1.0 + offset), "{left:?}");
    assert!(close(right.x, offset) && close(right.z, -1.0 - offset), "{right:?}");
}

fn select() {
    let app = Application::running();
    let set = app.action_set("play");
    let action = app.action(set, "press", xr::ActionType::BOOLEAN_INPUT);
    assert_eq!(app.suggest(SIMPLE, &[(action, SELECT)]), SUCCESS);
    assert_eq!(app.attach(&[set]), SUCCESS);
    // Not focused before the first frame.
    assert_eq!(app.sync(&[set]), xr::Result::SESSION_NOT_FOCUSED);
    let read = || {
        empty_frame(&app);
        assert_eq!(app.sync(&[set]), SUCCESS);
        let state = app.boolean(action).unwrap();
        (
            bool::from(state.is_active),
            bool::from(state.current_state),
            bool::from(state.changed_since_last_sync),
        )
    };
    let (first, second, third) = (read(), read(), read());
    assert_eq!([first, second, third], [(true, false, false), (true, true, true), (true, true, false)]);

    while let Some(event) = app.poll() {
        if event.ty == xr::EventDataInteractionProfileChanged::TYPE {
            let mut state = structure!(InteractionProfileState {});
            let hand = app.path("/user/hand/right");
            assert_eq!(call!(app, GetCurrentInteractionProfile(app.session, hand, &mut state)), SUCCESS);
            assert_eq!(state.interaction_profile, app.path(SIMPLE));
            return;
        }
    }
    panic!("no event tells of the interaction profile");
}

fn priority() {
    let app = Application::running();
    let make = |name: &str, priority| {
        let info = structure!(ActionSetCreateInfo {
            action_set_name: crate::application::name(name),
            localized_action_set_name: crate::application::name(name),
            priority: priority,
        });
        let mut set = xr::ActionSet::default();
        assert_eq!(call!(app, CreateActionSet(app.instance, &info, &mut set)), SUCCESS);
        (set, app.action(set, "press", xr::ActionType::BOOLEAN_INPUT))
    };
    let ((game, play), (menu, choose)) = (make("game", 0), make("menu", 1));
    assert_eq!(app.suggest(SIMPLE, &[(play, SELECT), (choose, SELECT)]), SUCCESS);
    assert_eq!(app.attach(&[game, menu]), SUCCESS);
    empty_frame(&app);
    let active = |sets: &[xr::ActionSet]| {
        assert_eq!(app.sync(sets), SUCCESS);
        [play, choose].map(|action| bool::from(app.boolean(action).unwrap().is_active))
    };
    assert_eq!(
        [active(&[game, menu]), active(&[game]), active(&[])],
        [[false, true], [true, false], [false, false]]
    );
}

fn wait_timeouts() {
    let app = Application::ready();
    let swapchain = app.swapchain();
    app.show(swapchain, 0, &[]);
    assert_eq!(app.acquire(swapchain), Ok(1));
    assert_eq!(app.wait(swapchain), xr::Result::TIMEOUT_EXPIRED);
    assert_eq!(app.wait(swapchain), SUCCESS);
    assert_eq!(app.release(swapchain), SUCCESS);
    assert_eq!(app.acquire(swapchain), Ok(0));
}

fn swapchains() {
    let app = Application::ready_with(V1_0, &[ENABLE, "XR_KHR_vulkan_swapchain_format_list"]);
    let mut count = 0;
    let mut formats = [0; 16];
    let result = call!(app, EnumerateSwapchainFormats(app.session, 16, &mut count, formats.as_mut_ptr()));
    assert_eq!(result, SUCCESS);
    for &format in &formats[..count as usize] {
        let depth = [126, 129, 130].contains(&format);
        let usage = match depth {
            true => xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT,
            false => xr::SwapchainUsageFlags::COLOR_ATTACHMENT,
        };
        let info = xr::SwapchainCreateInfo { format, usage_flags: usage, ..swapchain_info() };
        let shapes = [
            info,
            xr::SwapchainCreateInfo { array_size: 2, ..info },
            xr::SwapchainCreateInfo { mip_count: 7, ..info },
            xr::SwapchainCreateInfo { sample_count: 4, ..info },
            xr::SwapchainCreateInfo { face_count: 6, ..info },
            xr::SwapchainCreateInfo { create_flags: xr::SwapchainCreateFlags::STATIC_IMAGE, ..info },
        ];
        for shape in shapes {
            let swapchain = app.create_swapchain(&shape).unwrap();
            assert_eq!(call!(app, DestroySwapchain(swapchain)), SUCCESS);
        }
    }
    let views = [vk::Format::R8G8B8A8_SRGB, vk::Format::R8G8B8A8_UNORM].map(|format| format.as_raw() as u32);
    let list = structure!(VulkanSwapchainFormatListCreateInfoKHR {
        view_format_count: 2,
        view_formats: views.as_ptr()
    });
    let mut info = swapchain_info();
    info.next = std::ptr::from_ref(&list).cast();
    info.usage_flags |= xr::SwapchainUsageFlags::MUTABLE_FORMAT;
    app.create_swapchain(&info).unwrap();
}

fn swapchains_recorded(output: &Output) {
    let created = output.record.iter().filter_map(|line| match line {
        Line::SwapchainCreated(created) => Some(created),
        _ => None,
    });
    let created: Vec<_> = created.collect();
    let names: std::collections::BTreeSet<_> =
        created.iter().map(|created| created.format.as_str()).collect();
    for name in [
        "R8G8B8A8_SRGB",
        "B8G8R8A8_SRGB",
        "R8G8B8A8_UNORM",
        "B8G8R8A8_UNORM",
        "R16G16B16A16_SFLOAT",
        "D32_SFLOAT",
    ] {
        assert!(names.contains(name), "{name}: {names:?}");
    }
    let last = created.last().unwrap();
    assert_eq!(last.view_formats, ["R8G8B8A8_SRGB", "R8G8B8A8_UNORM"]);
    assert_eq!((last.images, last.usage_flags), (3, 0x51));
}

fn openxr_1_1() {
    let app = Application::ready_with(V1_1, &[ENABLE]);
    assert_eq!(app.begin_session(), SUCCESS);
    let time = empty_frame(&app).predicted_display_time;
    let spaces = [xr::ReferenceSpaceType::LOCAL_FLOOR, xr::ReferenceSpaceType::VIEW].map(|ty| app.space(ty));
    let info = structure!(SpacesLocateInfo {
        base_space: app.space(xr::ReferenceSpaceType::LOCAL),
        time: time,
        space_count: 2,
        spaces: spaces.as_ptr(),
    });
    let nowhere =
        xr::SpaceLocationData { location_flags: xr::SpaceLocationFlags::EMPTY, pose: xr::Posef::IDENTITY };
    let mut found = [nowhere; 2];
    let mut locations = structure!(SpaceLocations { location_count: 2, locations: found.as_mut_ptr() });
    assert_eq!(call!(app, LocateSpaces(app.session, &info, &mut locations)), SUCCESS);
    assert_eq!(found.map(|found| found.pose.position.y), [-1.6, 0.0]);
    assert!(
        found.iter().all(|found| found.location_flags.contains(xr::SpaceLocationFlags::POSITION_TRACKED))
    );
}

fn enable2() {
    let mut app = Application::with_instance(V1_0, &["XR_KHR_vulkan_enable2"]);
    let mut requirements = structure!(GraphicsRequirementsVulkanKHR {});
    let result = call!(app, GetVulkanGraphicsRequirements2KHR(app.instance, app.system, &mut requirements));
    assert_eq!(result, SUCCESS);
    // SAFETY: the same function type, which both crates declare for themselves.
    let loader = unsafe {
        std::mem::transmute::<vk::PFN_vkGetInstanceProcAddr, xr::platform::VkGetInstanceProcAddr>(
            vulkan_loader(),
        )
    };
    let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_1);
    let parameters = vk::InstanceCreateInfo::default().application_info(&application);
    let info = structure!(VulkanInstanceCreateInfoKHR {
        system_id: app.system,
        pfn_get_instance_proc_addr: Some(loader),
        vulkan_create_info: std::ptr::from_ref(&parameters).cast(),
    });
    let (mut instance, mut vk_result) = (std::ptr::null(), -1);
    assert_eq!(
        call!(app, CreateVulkanInstanceKHR(app.instance, &info, &mut instance, &mut vk_result)),
        SUCCESS
    );
    assert_eq!(vk_result, 0);
    let info =
        structure!(VulkanGraphicsDeviceGetInfoKHR { system_id: app.system, vulkan_instance: instance });
    let mut physical_device = std::ptr::null();
    assert_eq!(call!(app, GetVulkanGraphicsDevice2KHR(app.instance, &info, &mut physical_device)), SUCCESS);
    let queues = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
    let parameters = vk::DeviceCreateInfo::default().queue_create_infos(&queues);
    let info = structure!(VulkanDeviceCreateInfoKHR {
        system_id: app.system,
        pfn_get_instance_proc_addr: Some(loader),
        vulkan_physical_device: physical_device,
        vulkan_create_info: std::ptr::from_ref(&parameters).cast(),
    });
    let mut device = std::ptr::null();
    assert_eq!(call!(app, CreateVulkanDeviceKHR(app.instance, &info, &mut device, &mut vk_result)), SUCCESS);
    assert_eq!(vk_result, 0);
    // SAFETY: the runtime made instance and device, with this loader.
    app.gpu = Some(unsafe {
        let static_fn = ash::StaticFn { get_instance_proc_addr: vulkan_loader() };
        let entry = ash::Entry::from_static_fn(static_fn.clone());
        let instance = ash::Instance::load(&static_fn, vk::Instance::from_raw(instance as u64));
        let device = ash::Device::load(instance.fp_v1_0(), vk::Device::from_raw(device as u64));
        Gpu::of(entry, instance, vk::PhysicalDevice::from_raw(physical_device as u64), device)
    });
    assert_eq!(app.create_session(), SUCCESS);
    assert_eq!(app.begin_session(), SUCCESS);
    let swapchain = app.swapchain();
    app.show(swapchain, 0, &[]);
    let time = app.begin_frame().predicted_display_time;
    let views = views(swapchain);
    let layer = projection(app.space(xr::ReferenceSpaceType::LOCAL), &views);
    assert_eq!(app.end_frame(time, &[header(&layer)]), SUCCESS);
}

fn functions() {
    let (plain, with_mask) =
        (["xrGetVisibilityMaskKHR", "xrLocateSpaces", "xrNoSuchFunction"], ["XR_KHR_visibility_mask"]);
    let found = |app: Application| plain.map(|name| app.find(name).is_some());
    assert_eq!(found(Application::with_instance(V1_0, &[])), [false; 3]);
    assert_eq!(found(Application::with_instance(V1_0, &with_mask)), [true, false, false]);
    assert_eq!(found(Application::with_instance(V1_1, &[])), [false, true, false]);
}

fn visibility_mask() {
    let app = Application::ready_with(V1_0, &[ENABLE, "XR_KHR_visibility_mask"]);
    let (stereo, ty) =
        (xr::ViewConfigurationType::PRIMARY_STEREO, xr::VisibilityMaskTypeKHR::HIDDEN_TRIANGLE_MESH);
    let mut mask = structure!(VisibilityMaskKHR {});
    assert_eq!(call!(app, GetVisibilityMaskKHR(app.session, stereo, 0, ty, &mut mask)), SUCCESS);
    assert_eq!((mask.vertex_count_output, mask.index_count_output), (12, 12));
    let (mut vertices, mut indices) = ([xr::Vector2f::default(); 12], [u32::MAX; 12]);
    (mask.vertex_capacity_input, mask.vertices) = (12, vertices.as_mut_ptr());
    (mask.index_capacity_input, mask.indices) = (12, indices.as_mut_ptr());
    assert_eq!(call!(app, GetVisibilityMaskKHR(app.session, stereo, 0, ty, &mut mask)), SUCCESS);
    assert!(indices.iter().all(|&index| index < 12));
}

fn timespec() {
    let app = Application::with_instance(V1_0, &["XR_KHR_convert_timespec_time"]);
    let (mut time, mut back) = (xr::Time::from_nanos(0), libc::timespec { tv_sec: 0, tv_nsec: 0 });
    let timespec = libc::timespec { tv_sec: 3, tv_nsec: 5 };
    assert_eq!(call!(app, ConvertTimespecTimeToTimeKHR(app.instance, &timespec, &mut time)), SUCCESS);
    assert_eq!(time.as_nanos(), 3_000_000_005);
    assert_eq!(call!(app, ConvertTimeToTimespecTimeKHR(app.instance, time, &mut back)), SUCCESS);
    assert_eq!((back.tv_sec, back.tv_nsec), (3, 5));
}

fn unknown_structure() {
    let app = Application::ready();
    let list = structure!(VulkanSwapchainFormatListCreateInfoKHR {});
    let info = structure!(ViewLocateInfo { next: std::ptr::from_ref(&list).cast() });
    let info = structure!(SystemGetInfo {
        next: std::ptr::from_ref(&info).cast(),
        form_factor: xr::FormFactor::HEAD_MOUNTED_DISPLAY,
    });
    assert_eq!(call!(app, GetSystem(app.instance, &info, &mut xr::SystemId::from_raw(0))), SUCCESS);
}

fn unknown_structure_recorded(output: &Output) {
    let warned = output
        .record
        .iter()
        .filter(|line| matches!(line, Line::Warning { call, .. } if call == "xrGetSystem"));
    assert_eq!(warned.count(), 2);
}

static HEARD: AtomicU32 = AtomicU32::new(0);

unsafe extern "system" fn hear(
    _: xr::DebugUtilsMessageSeverityFlagsEXT,
    _: xr::DebugUtilsMessageTypeFlagsEXT,
    data: *const xr::DebugUtilsMessengerCallbackDataEXT,
    user_data: *mut c_void,
) -> xr::Bool32 {
    // SAFETY: the runtime passes valid data, and the pointer that the messenger was made with.
    unsafe {
        assert_eq!(std::ffi::CStr::from_ptr((*data).function_name), c"xrPathToString");
        (*user_data.cast::<AtomicU32>()).fetch_add(1, Ordering::Relaxed);
    }
    xr::FALSE
}

fn messenger(app: &mut Application) -> xr::Result {
    let info = structure!(DebugUtilsMessengerCreateInfoEXT {
        message_severities: xr::DebugUtilsMessageSeverityFlagsEXT::ERROR,
        message_types: xr::DebugUtilsMessageTypeFlagsEXT::VALIDATION,
        user_callback: Some(hear),
        user_data: std::ptr::from_ref(&HEARD).cast_mut().cast(),
    });
    let mut messenger = xr::DebugUtilsMessengerEXT::default();
    assert_eq!(call!(app, CreateDebugUtilsMessengerEXT(app.instance, &info, &mut messenger)), SUCCESS);
    let mut count = 0;
    let result =
        call!(app, PathToString(app.instance, xr::Path::from_raw(99), 0, &mut count, std::ptr::null_mut()));
    assert_eq!(HEARD.load(Ordering::Relaxed), 1);
    result
}
