//! The questions of `parafovea doctor` to Vulkan and OpenXR, in a process of its own, which may hang or crash: `parafovea-probe layers`,
//! `vulkan`, `devices` or `openxr` prints one line of JSON, a member of `parafovea_manifest::doctor::Probed`, or on standard error one line
//! with the reason why there is none.

mod created_devices;
mod openxr_runtime;
mod vulkan_devices;

use parafovea_manifest::doctor::LoaderLayers;
use std::process::ExitCode;

fn main() -> ExitCode {
    match answer(&std::env::args().nth(1).unwrap_or_default()) {
        Ok(line) => {
            println!("{line}");
            ExitCode::SUCCESS
        }
        Err(reason) => {
            eprintln!("{}", reason.replace('\n', " "));
            ExitCode::FAILURE
        }
    }
}

fn answer(question: &str) -> Result<String, String> {
    let answer = match question {
        "layers" => {
            // A missing loader is reported by another finding.
            let (openxr, vulkan) = (openxr_runtime::layers().ok(), vulkan_devices::layers().ok());
            serde_json::to_string(&LoaderLayers { openxr, vulkan })
        }
        "vulkan" => serde_json::to_string(&vulkan_devices::answer()?),
        "devices" => serde_json::to_string(&created_devices::answer()?),
        "openxr" => serde_json::to_string(&openxr_runtime::answer()?),
        _ => return Err("parafovea-probe is asked for `layers`, `vulkan`, `devices` or `openxr`".to_owned()),
    };
    answer.map_err(|error| error.to_string())
}
