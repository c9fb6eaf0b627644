//! Faults of the driver: every call of ours that can fail does, always or only the second time; and the device is lost.

use super::runs::{Below, Cell};
use super::technique::Technique;
use parafovea_test_layers::{VulkanFault, Whose};
use std::collections::BTreeMap;

const OUT_OF_HOST_MEMORY: i32 = -1;
pub const OUT_OF_DEVICE_MEMORY: i32 = -2;
const DEVICE_LOST: i32 = -4;
const MEMORY_MAP_FAILED: i32 = -5;
/// No error: a wait takes longer.
const TIMEOUT: i32 = 2;

/// Submits of the application and of the runtime after which the device is lost: the first of the application in its second frame,
/// and a later one. In the first frame the order is another with virtual swapchains, whose images the runtime prepares last.
fn lost_after(technique: &Technique) -> [u64; 2] {
    // Of each of two swapchains one by the runtime; hello_xr submits once a view, applications with two queues once on each, the others once a
    // frame.
    [if technique.has_actions || technique.has_two_queues { 4 } else { 3 }, 12]
}

/// The cells of a technique, from the calls of a run without faults.
pub fn cells(technique: &'static Technique) -> Vec<Cell> {
    let run = technique.run(&Technique::scenario()).on(technique.config).faulted(None);
    let outcome = run.finish().unwrap().expect_end().unwrap();
    let mut calls: BTreeMap<String, u64> = BTreeMap::new();
    for report in outcome.faults().unwrap() {
        report.own.into_iter().for_each(|(call, count)| *calls.entry(call).or_default() += count);
    }
    assert!(
        calls.contains_key("vkCreateShaderModule") || calls.len() > 5,
        "{}: only {calls:?}",
        technique.name
    );
    let own = calls.into_iter().flat_map(|(call, count)| own_faults(technique, &call, count));
    let lost = lost_after(technique).map(|skip| VulkanFault {
        call: "vkQueueSubmit".to_owned(),
        result: DEVICE_LOST,
        whose: Whose::Application,
        skip,
        count: 1,
    });
    own.chain(lost).map(|fault| Cell { technique, below: Below::Vulkan(fault) }).collect()
}

/// All of so many calls fail, or only the second; waiting also takes too long.
fn own_faults(technique: &Technique, call: &str, count: u64) -> Vec<VulkanFault> {
    let result = match call {
        "vkMapMemory" => MEMORY_MAP_FAILED,
        "vkCreateFramebuffer" | "vkCreateImageView" | "vkBeginCommandBuffer" => OUT_OF_HOST_MEMORY,
        _ => OUT_OF_DEVICE_MEMORY,
    };
    let fault = |skip, count| VulkanFault { call: call.to_owned(), result, whose: Whose::Own, skip, count };
    let mut faults = vec![fault(0, u64::MAX)];
    if count > 1 {
        faults.push(fault(1, 1));
    }
    if call == "vkWaitForFences" {
        faults.push(VulkanFault { result: TIMEOUT, ..fault(0, 1) });
        // No wait ever succeeds: our objects are destroyed with the device. Not with hello_xr, which destroys swapchains at once
        // after their last frame, when it cannot be known whether the GPU is done with them.
        if !technique.has_actions {
            faults.push(VulkanFault { result: TIMEOUT, ..fault(0, u64::MAX) });
        }
    }
    faults
}
