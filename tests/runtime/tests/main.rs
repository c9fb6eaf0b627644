//! The runtime as applications meet it: through the OpenXR loader, on a real Vulkan device. Each case runs in a
//! process of its own (this program, started again), since a scenario belongs to a process.

#![expect(clippy::unwrap_used, reason = "tests")]

#[path = "main/application.rs"]
mod application;
#[path = "main/behaviour.rs"]
mod behaviour;
#[path = "main/case.rs"]
mod case;
#[path = "main/gpu.rs"]
mod gpu;
#[path = "main/hello_xr.rs"]
mod hello_xr;
#[path = "main/pictures.rs"]
mod pictures;
#[path = "main/rules.rs"]
mod rules;
#[path = "main/validation.rs"]
mod validation;

use case::Case;
use libtest_mimic::{Arguments, Trial};

fn main() {
    let cases: Vec<Case> =
        rules::cases().into_iter().chain(behaviour::cases()).chain(pictures::cases()).collect();
    if let Some(name) = std::env::var_os(case::CHILD_VARIABLE) {
        if name == validation::MISTAKE {
            return validation::make_mistake();
        }
        let case = cases.iter().find(|case| case.name.as_str() == name).unwrap();
        return case.run_here();
    }
    let trials = cases.into_iter().map(|case| Trial::test(case.name.clone(), move || case.run_in_child()));
    let trials = trials.chain(hello_xr::trials()).chain([validation::trial()]).collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}
