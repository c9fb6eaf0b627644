//! Qt Quick 3D XR, which Debian sid has: a real engine without a window.

use super::Folder;
use crate::HarnessError;
use crate::run::{Application, Run};
use crate::scenario::Scenario;
use std::path::Path;

/// A way of drawing.
#[derive(Clone, Copy)]
pub struct Look {
    /// Its name in tables.
    pub name: &'static str,
    /// Samples of a pixel; 0 for one.
    samples: u32,
    /// Whether a pass draws both eyes, by multiview.
    is_multiview: bool,
    /// Whether passes map tones behind the scene.
    has_effects: bool,
}

/// All of them.
pub const LOOKS: [Look; 4] = [
    Look { name: "multiview", samples: 0, is_multiview: true, has_effects: false },
    Look { name: "multisampled", samples: 4, is_multiview: true, has_effects: false },
    Look { name: "by-eye", samples: 0, is_multiview: false, has_effects: false },
    Look { name: "effects", samples: 4, is_multiview: true, has_effects: true },
];

/// A run of one until the session ends, without the layer.
///
/// # Errors
/// [`HarnessError::NoDriver`] where sid is not unpacked.
pub fn run(look: Look, scenario: &Scenario) -> Result<Run, HarnessError> {
    let system = Folder::Sid.path()?;
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("engines/qt/main.qml");
    let arguments = [
        scene.to_string_lossy().into_owned(),
        "--".to_owned(),
        format!("msaa={}", look.samples),
        format!("effects={}", if look.has_effects { "on" } else { "off" }),
        // Until the session ends.
        "rounds=0".to_owned(),
    ];
    let application = Application::at(&system.join("usr/lib/qt6/bin/qml"), &arguments);
    let libraries = Folder::Sid.libraries()?.join("qt6");
    let run = Run::new(&application, scenario)
        .env("QT_PLUGIN_PATH", libraries.join("plugins"))
        .env("QML_IMPORT_PATH", libraries.join("qml"))
        // The one platform with Vulkan that takes no display.
        .env("QT_QPA_PLATFORM", "vkkhrdisplay")
        .env("QSG_RHI_BACKEND", "vulkan")
        .env("LC_ALL", "C.UTF-8");
    Ok(if look.is_multiview { run } else { run.env("QT_QUICK3D_XR_DISABLE_MULTIVIEW", "1") })
}
