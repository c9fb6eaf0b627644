//! End-to-end tests: real applications, the real loaders, lavapipe.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod audio_visual;
mod break_even;
mod capture;
mod churn;
mod configuration;
mod conformance;
mod container;
mod counting;
mod debug_view;
mod dist;
mod documents;
mod enabling;
mod faults;
mod frame;
mod frame_graphs;
mod gaze_correction;
mod hello_xr;
mod inert;
mod input;
mod late;
mod layer_readme;
mod loader_1_1;
mod memory;
mod missing_barriers;
mod mock_runtime_readme;
mod native;
mod offer;
mod osc;
mod overhead;
mod panics;
mod pictures;
mod pipelines;
mod planted;
mod published;

mod rates;
mod readme;
mod rest;
mod reuse;
mod schedule;
mod security;
mod sequences;
mod sessions;
mod shading_rate;
mod status;
mod swapchain_cases;
mod unseen;
mod wording;
