//! Surroundings of the layer: its configuration, the two loader manifests, where files are, and the
//! installation. Makes no Vulkan or OpenXR call.

#![forbid(unsafe_code)]

pub mod audio_library;
pub mod config;
pub mod doctor;
pub mod gaze_correction;
pub mod install;
pub mod json;
pub mod loader_filters;
pub mod options;
pub mod paths;
pub mod private_file;
pub mod quirks;
pub mod sound_server;
pub mod status;
