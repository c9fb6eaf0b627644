//! The questions of `parafovea doctor` to Vulkan and OpenXR, in a process of its own, which may hang or crash: `parafovea-probe layers`,
//! `vulkan`, `devices` or `openxr` prints one line with [`ANSWER_PREFIX`] and JSON: a member of `parafovea_manifest::doctor::Probed`.

mod created_devices;
mod openxr_runtime;
mod vulkan_devices;

use parafovea_manifest::doctor::{ANSWER_PREFIX, LoaderLayers};
use serde_json::{Value, json};
use std::process::ExitCode;

fn main() -> ExitCode {
    let answer = answer(&std::env::args().nth(1).unwrap_or_default());
    let is_answered = answer.is_ok();
    // After a line that a driver left without an end, too.
    println!("\n{ANSWER_PREFIX}{}", json!(answer.map_err(|reason| reason.replace('\n', " "))));
    if is_answered { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn answer(question: &str) -> Result<Value, String> {
    Ok(match question {
        "layers" => {
            // A missing loader is reported by another finding.
            let (openxr, vulkan) = (openxr_runtime::layers().ok(), vulkan_devices::layers().ok());
            json!(LoaderLayers { openxr, vulkan })
        }
        "vulkan" => json!(vulkan_devices::answer()?),
        "devices" => json!(created_devices::answer()?),
        "openxr" => json!(openxr_runtime::answer()?),
        _ => return Err("parafovea-probe is asked for `layers`, `vulkan`, `devices` or `openxr`".to_owned()),
    })
}
