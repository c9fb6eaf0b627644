//! The table.
//!
//! A RADV device with an unknown name is newer than the table, and counts as RDNA3 or later. It gets the quirks of RDNA2 and later, which
//! only limit samples and warn, and none of RDNA2 alone, whose hardware keeps rates in the metadata of depth.

use super::{Devices, Effect, Quirk};

/// `VK_DRIVER_ID_MESA_RADV`.
const RADV: u32 = 3;

/// Before GFX10.3, in the words of RADV's device names (Mesa's `amd_family.c`): no shading rates.
const BEFORE_RDNA2: &[&str] = &[
    "TAHITI",
    "PITCAIRN",
    "VERDE",
    "OLAND",
    "HAINAN",
    "BONAIRE",
    "KAVERI",
    "KABINI",
    "HAWAII",
    "TONGA",
    "ICELAND",
    "CARRIZO",
    "FIJI",
    "STONEY",
    "POLARIS10",
    "POLARIS11",
    "POLARIS12",
    "VEGAM",
    "VEGA10",
    "VEGA12",
    "VEGA20",
    "RAVEN",
    "RAVEN2",
    "RENOIR",
    "MI100",
    "MI200",
    "GFX940",
    "NAVI10",
    "NAVI12",
    "NAVI14",
    "GFX1013",
];

/// GFX10.3, of which no new ones are made: as RADV names its devices since Mesa 22.2, and before.
const RDNA2: Devices = Devices::Named(&[
    "NAVI21",
    "NAVI22",
    "NAVI23",
    "NAVI24",
    "VANGOGH",
    "REMBRANDT",
    "RAPHAEL_MENDOCINO",
    "SIENNA_CICHLID",
    "NAVY_FLOUNDER",
    "DIMGREY_CAVEFISH",
    "BEIGE_GOBY",
    "YELLOW_CARP",
    "GFX1036",
]);

/// GFX10.3 and later, devices with names that are newer than this table among them.
const RDNA2_AND_LATER: Devices = Devices::Others(BEFORE_RDNA2);

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
