//! GPUs that estimates are for.

use crate::drivers::ShimDevice;

/// Data sheet of a GPU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gpu {
    /// As it is sold.
    pub name: &'static str,
    /// The device whose compiler makes the same code, or code for the next chip of the same generation; `None` if there is no shim of it.
    pub compiler: Option<ShimDevice>,
    /// Lanes of 32 bits: stream processors, CUDA cores, eight for each Xe vector engine.
    pub lanes: f64,
    /// Clock under load, GHz.
    pub clock_ghz: f64,
    /// Bandwidth of its memory, GB/s; caches left out.
    pub bandwidth_gb_s: f64,
    /// Side of a tile of the rate image on its driver, pixels.
    pub tile: u32,
    /// The data sheet.
    pub source: &'static str,
}

/// Each generation with shading rates, as most people have it.
pub const GPUS: [Gpu; 4] = [
    Gpu {
        name: "RX 6700 XT",
        compiler: Some(ShimDevice::Navi21),
        lanes: 2560.0,
        clock_ghz: 2.424,
        bandwidth_gb_s: 384.0,
        tile: 8,
        source: "AMD, Radeon RX 6700 XT: 40 compute units, game frequency 2424 MHz, 192 bits at 16 Gbps",
    },
    Gpu {
        name: "RX 7900 XTX",
        compiler: Some(ShimDevice::Navi31),
        lanes: 6144.0,
        clock_ghz: 2.3,
        bandwidth_gb_s: 960.0,
        tile: 8,
        source: "AMD, Radeon RX 7900 XTX: 96 compute units, game frequency 2300 MHz, 384 bits at 20 Gbps; dual issue left out",
    },
    Gpu {
        name: "Arc A770",
        compiler: None,
        lanes: 4096.0,
        clock_ghz: 2.1,
        bandwidth_gb_s: 560.0,
        tile: 8,
        source: "Intel, Arc A770 16 GB: 512 Xe vector engines, graphics clock 2100 MHz, 256 bits at 17.5 Gbps",
    },
    Gpu {
        name: "RTX 3060",
        compiler: Some(ShimDevice::NvkAmpere),
        lanes: 3584.0,
        clock_ghz: 1.78,
        bandwidth_gb_s: 360.0,
        tile: 16,
        source: "NVIDIA, GeForce RTX 3060 12 GB: 3584 CUDA cores, boost clock 1.78 GHz, 192 bits at 15 Gbps",
    },
];
