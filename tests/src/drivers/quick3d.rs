//! Qt Quick 3D XR, which Debian sid has: a real engine without a window.

use super::Folder;
use crate::HarnessError;
use crate::run::{Application, Run};
use crate::scenario::Scenario;
use std::path::Path;

/// Ways of drawing: a name, the samples of a pixel, whether a pass draws both eyes by multiview, and whether passes map tones behind the scene.
type Look = (&'static str, u32, bool, bool);

/// All of them.
const LOOKS: [Look; 4] = [
    ("multiview", 0, true, false),
    ("multisampled", 4, true, false),
    ("by-eye", 0, false, false),
    ("effects", 4, true, true),
];

/// Their names.
pub fn looks() -> impl Iterator<Item = &'static str> {
    LOOKS.into_iter().map(|(name, ..)| name)
}

/// A run of one until the session ends, without the layer.
///
/// # Errors
/// [`HarnessError::NoDriver`] where sid is not unpacked.
pub fn run(look: &str, scenario: &Scenario) -> Result<Run, HarnessError> {
    let system = Folder::Sid.path()?;
    let (_, samples, is_multiview, has_effects) =
        LOOKS.into_iter().find(|(name, ..)| *name == look).unwrap_or(LOOKS[0]);
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("engines/qt/main.qml");
    let arguments = [
        scene.to_string_lossy().into_owned(),
        "--".to_owned(),
        format!("msaa={samples}"),
        format!("effects={}", if has_effects { "on" } else { "off" }),
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
    Ok(if is_multiview { run } else { run.env("QT_QUICK3D_XR_DISABLE_MULTIVIEW", "1") })
}
