//! Faults of the runtime.

use super::runs::{Below, Cell};
use super::technique::Technique;
use parafovea_tests::scenario::{Answer, Fault};

fn fault(call: &str) -> Fault {
    Fault {
        call: call.to_owned(),
        result: String::new(),
        answer: Answer::Usual,
        late_ms: 0,
        from_frame: 0,
        skip: 0,
        count: 0,
    }
}

/// Calls of every application that fail from a frame on, with their results.
const IN_FRAMES: [(&str, &[&str]); 6] = [
    ("xrWaitFrame", &["XR_ERROR_SESSION_LOST", "XR_ERROR_INSTANCE_LOST", "XR_ERROR_RUNTIME_FAILURE"]),
    ("xrBeginFrame", &["XR_ERROR_SESSION_LOST", "XR_ERROR_INSTANCE_LOST", "XR_ERROR_RUNTIME_FAILURE"]),
    ("xrEndFrame", &["XR_ERROR_SESSION_LOST", "XR_ERROR_INSTANCE_LOST", "XR_ERROR_RUNTIME_FAILURE"]),
    ("xrLocateViews", &["XR_ERROR_SESSION_LOST", "XR_ERROR_INSTANCE_LOST", "XR_ERROR_RUNTIME_FAILURE"]),
    ("xrPollEvent", &["XR_ERROR_INSTANCE_LOST"]),
    // Returned by calls that do succeed.
    ("xrBeginFrame", &["XR_SESSION_LOSS_PENDING"]),
];

/// Calls that fail from the beginning.
const AT_THE_START: [(&str, &str); 9] = [
    ("xrCreateInstance", "XR_ERROR_RUNTIME_FAILURE"),
    ("xrCreateSession", "XR_ERROR_OUT_OF_MEMORY"),
    ("xrCreateSession", "XR_ERROR_GRAPHICS_DEVICE_INVALID"),
    ("xrCreateSwapchain", "XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED"),
    ("xrCreateSwapchain", "XR_ERROR_OUT_OF_MEMORY"),
    ("xrEnumerateSwapchainImages", "XR_ERROR_RUNTIME_FAILURE"),
    ("xrCreateReferenceSpace", "XR_ERROR_OUT_OF_MEMORY"),
    ("xrGetSystem", "XR_ERROR_FORM_FACTOR_UNAVAILABLE"),
    ("xrBeginSession", "XR_ERROR_SESSION_LOST"),
];

/// Answers that make no sense, or that no headset gives.
const ANSWERS: [(&str, Answer); 8] = [
    ("xrLocateViews", Answer::Nan),
    ("xrLocateViews", Answer::ZeroFov),
    ("xrLocateViews", Answer::HugeFov),
    ("xrLocateViews", Answer::Untracked),
    ("xrWaitFrame", Answer::Backwards),
    ("xrPollEvent", Answer::InstanceLossPending),
    ("xrPollEvent", Answer::SessionLossPending),
    ("xrEnumerateSwapchainImages", Answer::NoImages),
];

/// The layer's own calls in an application with actions: the failing function, its result, and the number of the application's calls before it.
const FOR_GAZE: [(&str, &str, u64); 7] = [
    ("xrCreateActionSet", "XR_ERROR_OUT_OF_MEMORY", 1),
    ("xrCreateAction", "XR_ERROR_OUT_OF_MEMORY", 4),
    ("xrCreateActionSpace", "XR_ERROR_OUT_OF_MEMORY", 2),
    ("xrAttachSessionActionSets", "XR_ERROR_RUNTIME_FAILURE", 0),
    ("xrSyncActions", "XR_SESSION_NOT_FOCUSED", 0),
    ("xrSyncActions", "XR_ERROR_SESSION_LOST", 6),
    ("xrSuggestInteractionProfileBindings", "XR_ERROR_RUNTIME_FAILURE", 0),
];

/// The cells of a technique.
pub fn cells(technique: &'static Technique) -> Vec<Cell> {
    const FRAME: u64 = 6;
    let mut faults: Vec<Vec<Fault>> = Vec::new();
    for (call, results) in IN_FRAMES {
        for result in results {
            faults.push(vec![Fault { result: (*result).to_owned(), from_frame: FRAME, ..fault(call) }]);
        }
    }
    for (call, result) in AT_THE_START {
        faults.push(vec![Fault { result: result.to_owned(), ..fault(call) }]);
    }
    for (call, answer) in ANSWERS {
        // hello_xr starts again, and waits for ever, also without the layer.
        if technique.has_actions && call == "xrPollEvent" {
            continue;
        }
        let from_frame = if call == "xrEnumerateSwapchainImages" { 0 } else { FRAME };
        let count = if call == "xrPollEvent" { 1 } else { 0 };
        faults.push(vec![Fault { answer, from_frame, count, ..fault(call) }]);
    }
    faults.push(vec![Fault { late_ms: 40, from_frame: FRAME, count: 2, ..fault("xrWaitFrame") }]);
    faults.push(vec![Fault { late_ms: 40, from_frame: FRAME, count: 2, ..fault("xrEndFrame") }]);
    // All that a lost session refuses, and one call alone.
    let swapchain = ["xrAcquireSwapchainImage", "xrWaitSwapchainImage", "xrReleaseSwapchainImage"];
    let lost = "XR_ERROR_SESSION_LOST".to_owned();
    let of_session =
        swapchain.into_iter().chain(["xrEndFrame", "xrBeginFrame", "xrWaitFrame", "xrLocateViews"]);
    faults.push(
        of_session.map(|call| Fault { result: lost.clone(), from_frame: FRAME, ..fault(call) }).collect(),
    );
    for call in swapchain {
        faults.push(vec![Fault { result: lost.clone(), from_frame: FRAME, count: 1, ..fault(call) }]);
    }
    if technique.has_actions {
        for (call, result, skip) in FOR_GAZE {
            faults.push(vec![Fault { result: result.to_owned(), skip, ..fault(call) }]);
        }
        for answer in [Answer::Nan, Answer::Untracked] {
            faults.push(vec![Fault { answer, from_frame: FRAME, ..fault("xrLocateSpace") }]);
        }
        faults.push(vec![Fault { late_ms: 40, from_frame: FRAME, count: 1, ..fault("xrLocateSpace") }]);
    }
    let gone = ["XR_EXT_eye_gaze_interaction", "XR_KHR_vulkan_enable2"].map(|name| vec![name.to_owned()]);
    faults
        .into_iter()
        .map(Below::OpenXr)
        .chain(gone.into_iter().map(Below::ExtensionsOff))
        .map(|below| Cell { technique, below })
        .collect()
}
