//! The table.

use super::{Effect, Quirk};

/// `VK_DRIVER_ID_MESA_RADV`.
const RADV: u32 = 3;

/// GFX10.3, as RADV 25.0.7 names its devices.
const RDNA2: &[&str] = &["NAVI21", "NAVI22", "NAVI23", "NAVI24", "VANGOGH", "REMBRANDT", "RAPHAEL_MENDOCINO"];

/// GFX10.3 and later, as RADV 25.0.7 names its devices.
const RDNA2_AND_LATER: &[&str] = &[
    "NAVI21",
    "NAVI22",
    "NAVI23",
    "NAVI24",
    "VANGOGH",
    "REMBRANDT",
    "RAPHAEL_MENDOCINO",
    "NAVI31",
    "NAVI32",
    "NAVI33",
    "PHOENIX",
    "PHOENIX2",
    "GFX1150",
    "GFX1151",
    "GFX1152",
    "GFX1153",
    "GFX1200",
    "GFX1201",
];

/// All quirks that are known.
pub const QUIRKS: [Quirk; 4] = [
    Quirk {
        name: "attach-only-matched",
        doc: "rate attachments in dynamic rendering for recognised render passes only, and in subpasses with depth only, \
              because each use costs a dispatch and two flushes",
        driver: RADV,
        devices: RDNA2,
        fixed_in: None,
        effect: Effect::AttachOnlyMatched,
        source: "Mesa 25.0.7, radv_cmd_buffer.c and radv_meta_copy_vrs_htile.c",
    },
    Quirk {
        name: "first-layer-only",
        doc: "rate attachments with one layer, and the finer rates of both eyes in multiview, because the driver uses \
              only array slice 0",
        driver: RADV,
        devices: RDNA2,
        fixed_in: None,
        effect: Effect::FirstLayerOnly,
        source: "Mesa 25.0.7, radv_meta_copy_vrs_htile.c",
    },
    Quirk {
        name: "four-samples",
        doc: "shading rates with up to 4 samples per pixel, because later drivers no longer offer 8",
        driver: RADV,
        devices: RDNA2_AND_LATER,
        // The first version that was seen without it; which one between 25.0.7 and this changed it is not known.
        fixed_in: Some([26, 2, 6]),
        effect: Effect::MaxSamples(4),
        source: "maxFragmentShadingRateRasterizationSamples: 8 in Mesa 25.0.7, 4 in 26.2.6",
    },
    Quirk {
        name: "vkd3d-flicker",
        doc: "a warning in the log for vkd3d-proton, because Direct3D 12 games may flicker",
        driver: RADV,
        devices: RDNA2_AND_LATER,
        fixed_in: None,
        effect: Effect::WarnVkd3d,
        source: "vkd3d-proton #3088, #2825 and #2842",
    },
];
