//! The manifests through which the Vulkan loader finds the layers.

use serde_json::{Value, json};
use std::path::Path;

/// One of the layers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TestLayer {
    /// Does nothing.
    PassThrough,
    /// Does nothing, above Parafovea.
    Above,
    /// Counts fragment shader invocations.
    Count,
    /// Counts samples that pass depth and stencil tests.
    Samples,
    /// Times command buffers on the GPU.
    Times,
    /// Leaves out chosen barriers.
    DropBarrier,
    /// Offers fragment shading rates where the device has none.
    ShadingRate,
    /// Offers a second queue where there is one.
    TwoQueues,
    /// Marks the application's calls for [`TestLayer::Faults`] and [`TestLayer::Live`].
    Calls,
    /// Makes chosen calls fail.
    Faults,
    /// Plants the GPU time of frames.
    Costs,
    /// Counts live objects and device memory.
    Live,
}

impl TestLayer {
    /// All of them.
    pub const ALL: [TestLayer; 12] = [
        TestLayer::PassThrough,
        TestLayer::Above,
        TestLayer::Count,
        TestLayer::Samples,
        TestLayer::Times,
        TestLayer::DropBarrier,
        TestLayer::ShadingRate,
        TestLayer::TwoQueues,
        TestLayer::Calls,
        TestLayer::Faults,
        TestLayer::Costs,
        TestLayer::Live,
    ];

    /// The last part of its name, which its entry point and its manifest's file have too.
    pub fn stem(self) -> &'static str {
        match self {
            TestLayer::PassThrough => "pass_through",
            TestLayer::Above => "above",
            TestLayer::Count => "count",
            TestLayer::Samples => "samples",
            TestLayer::Times => "times",
            TestLayer::DropBarrier => "drop_barrier",
            TestLayer::ShadingRate => "shading_rate",
            TestLayer::TwoQueues => "two_queues",
            TestLayer::Calls => "calls",
            TestLayer::Faults => "faults",
            TestLayer::Costs => "costs",
            TestLayer::Live => "live",
        }
    }

    /// Its name for the Vulkan loader, as in `VK_INSTANCE_LAYERS`.
    pub fn name(self) -> String {
        format!("VK_LAYER_PARAFOVEA_TEST_{}", self.stem())
    }

    /// Its manifest, for a folder in `VK_LAYER_PATH` or `$XDG_DATA_HOME/vulkan/explicit_layer.d`.
    pub fn manifest(self, library: &Path) -> String {
        self.description(library).to_string()
    }

    /// Its manifest as an implicit layer, for an `implicit_layer.d` folder. It is enabled by setting
    /// [`Self::implicit_variable`] to 1.
    pub fn implicit_manifest(self, library: &Path) -> String {
        let mut manifest = self.description(library);
        let layer = &mut manifest["layer"];
        layer["enable_environment"] = json!({ self.implicit_variable(): "1" });
        layer["disable_environment"] = json!({ format!("DISABLE_{}", self.implicit_variable()): "1" });
        manifest.to_string()
    }

    /// The variable that enables it where it is implicit.
    pub fn implicit_variable(self) -> String {
        format!("PARAFOVEA_TEST_{}", self.stem().to_uppercase())
    }

    /// Writes the manifests of all layers to a folder, one file each.
    ///
    /// # Errors
    ///
    /// Errors of writing a file.
    pub fn write_manifests(library: &Path, folder: &Path) -> std::io::Result<()> {
        std::fs::create_dir_all(folder)?;
        for layer in Self::ALL {
            std::fs::write(folder.join(format!("{}.json", layer.stem())), layer.manifest(library))?;
        }
        Ok(())
    }

    fn description(self, library: &Path) -> Value {
        let mut description = json!({
            "file_format_version": "1.1.2",
            "layer": {
                "name": self.name(),
                "type": "GLOBAL",
                "library_path": library,
                "api_version": "1.3.0",
                "implementation_version": "1",
                "description": "For Parafovea's own tests and benches",
                "functions": {
                    "vkNegotiateLoaderLayerInterfaceVersion":
                        format!("{}_vkNegotiateLoaderLayerInterfaceVersion", self.stem()),
                },
            },
        });
        if self == TestLayer::ShadingRate {
            // From here the Vulkan loader answers which extensions the layer itself brings.
            description["layer"]["device_extensions"] = json!([{
                "name": "VK_KHR_fragment_shading_rate",
                "spec_version": "2",
                "entrypoints": ["vkCmdSetFragmentShadingRateKHR"],
            }]);
        }
        description
    }
}
