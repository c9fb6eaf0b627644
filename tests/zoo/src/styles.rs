//! The styles, one a file.

mod alpha_to_coverage;
mod async_compute;
mod bloom;
mod compute_upscaled;
mod deferred;
mod descriptor_buffers;
mod descriptor_heaps;
mod distractors;
mod double_wide;
mod dynamic_rendering;
mod dynamic_resolution;
mod flags2;
mod flipped;
mod foliage;
mod frag_depth;
mod hidden_area;
mod imageless;
mod indirect;
mod loaded_depth;
mod msaa_passes;
mod msaa_resolve;
mod msaa_subpass_resolve;
mod multiview;
pub mod new_targets;
mod new_views;
mod occlusion;
mod offscreen_tonemap;
mod oit;
mod own_vrs;
mod prepass_equal;
mod prerecorded;
mod proton;
mod quad_ui;
mod render_pass;
mod render_thread;
mod reversed_z;
mod second_queue;
pub mod secondaries;
mod shader_objects;
mod stereo_viewports;
mod submitted_depth;
mod subpasses;
mod taa;
mod taa_exposure;
mod two_devices;
mod upscaled;
mod viewport_scale;
mod visibility;

use crate::style::Style;

/// All styles, in the order of `--list`.
pub const STYLES: &[&Style] = &[
    &render_pass::STYLE,
    &dynamic_rendering::STYLE,
    &multiview::STYLE,
    &double_wide::STYLE,
    &offscreen_tonemap::STYLE,
    &msaa_resolve::STYLE,
    &msaa_subpass_resolve::STYLE,
    &subpasses::STYLE,
    &prepass_equal::STYLE,
    &deferred::STYLE,
    &proton::STYLE,
    &upscaled::STYLE,
    &compute_upscaled::STYLE,
    &viewport_scale::STYLE,
    &distractors::STYLE,
    &reversed_z::STYLE,
    &indirect::STYLE,
    &new_views::STYLE,
    &imageless::STYLE,
    &own_vrs::STYLE,
    &flipped::STYLE,
    &taa_exposure::STYLE,
    &occlusion::STYLE,
    &oit::STYLE,
    &visibility::STYLE,
    &submitted_depth::STYLE,
    &stereo_viewports::STYLE,
    &hidden_area::STYLE,
    &flags2::STYLE,
    &descriptor_buffers::STYLE,
    &descriptor_heaps::STYLE,
    &shader_objects::STYLE,
    &secondaries::STYLE,
    &second_queue::STYLE,
    &second_queue::OF_ANOTHER_FAMILY,
    &async_compute::STYLE,
    &two_devices::STYLE,
    &prerecorded::STYLE,
    &render_thread::STYLE,
    &quad_ui::STYLE,
    &dynamic_resolution::STYLE,
    &loaded_depth::STYLE,
    &alpha_to_coverage::STYLE,
    &frag_depth::STYLE,
    &msaa_passes::STYLE,
    &msaa_passes::COVERING,
    &foliage::STYLE,
    &taa::STYLE,
    &bloom::STYLE,
];
