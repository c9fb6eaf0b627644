//! Techniques of the layer that are on while a call fails.

use super::runs::FRAMES;
use parafovea_test_layers::ShadingRateProfile;
use parafovea_tests::run::{Application, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

/// A technique, with an application that it works in.
#[derive(Debug)]
pub struct Technique {
    pub name: &'static str,
    /// Whether the device looks as if it had shading rates.
    pub has_rates: bool,
    /// Whether the application is hello_xr, which has actions; otherwise one that has none.
    pub has_actions: bool,
    /// Whether the application, if it is not hello_xr, draws on another queue than the session's.
    pub has_two_queues: bool,
    /// Whether swapchains are virtual, so that errors of theirs come at xrEndFrame, or not at all where a frame can do without.
    pub is_virtual: bool,
    pub config: &'static str,
}

impl Technique {
    pub const ALL: [Technique; 7] = [
        Technique {
            name: "mask",
            has_rates: false,
            has_actions: false,
            has_two_queues: false,
            is_virtual: true,
            config: "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"fixed\"\nbackend = \"mask\"\ngate = \"on\"\n",
        },
        Technique {
            name: "attachment",
            has_rates: true,
            has_actions: false,
            has_two_queues: false,
            is_virtual: false,
            config: "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"fixed\"\ngate = \"on\"\n",
        },
        Technique {
            name: "re-use",
            has_rates: false,
            has_actions: false,
            has_two_queues: false,
            is_virtual: true,
            config: "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nbackend = \"mask\"\ngate = \"on\"\n[reuse]\nmode = \"on\"\n",
        },
        Technique {
            name: "chroma",
            has_rates: false,
            has_actions: false,
            has_two_queues: false,
            is_virtual: true,
            config: "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n",
        },
        Technique {
            name: "gaze",
            has_rates: false,
            has_actions: true,
            has_two_queues: false,
            is_virtual: true,
            config: "preset = \"none\"\n[gaze]\nsource = \"eyes\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n",
        },
        Technique {
            name: "contrast",
            has_rates: true,
            has_actions: false,
            has_two_queues: false,
            is_virtual: true,
            config: "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n",
        },
        Technique {
            name: "re-use, two queues",
            has_rates: false,
            has_actions: false,
            has_two_queues: true,
            is_virtual: true,
            config: "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nbackend = \"mask\"\ngate = \"on\"\n[reuse]\nmode = \"on\"\n",
        },
    ];

    /// Its application with this scenario, without the layer.
    pub fn run(&self, scenario: &Scenario) -> Run {
        let frames = FRAMES.to_string();
        let style = if self.has_two_queues { "second-queue" } else { "render-pass" };
        let zoo = ["--style", style, "--size", "64", "--frames", &frames];
        let application = if self.has_actions {
            Application::hello_xr("Vulkan2")
        } else {
            Application::ours("parafovea-zoo", &zoo)
        };
        let run = Run::new(&application.unwrap(), scenario).two_queues(self.has_two_queues);
        if self.has_rates { run.shading_rates(ShadingRateProfile::NvkTuring) } else { run }
    }

    /// Nothing goes wrong.
    pub fn scenario() -> Scenario {
        Scenario::new(FRAMES).sized(64, 64).gazing(-20.0, 0.0).saving(&super::runs::SAVED)
    }
}
