//! Unmodified engines on Monado: Debian sid's Godot and Qt Quick 3D XR, beside MangoHud and vkBasalt, Monado with a simulated headset and
//! nothing to show pictures on, and lavapipe, unpacked below the target folder. Takes root's rights to enter that folder, none to make it.

use crate::setup::{Voice, setup};
use crate::steps::{Steps, profile_folder};
use crate::tasks;
use crate::unpack::{Set, unpack};
use std::process::Command;

const SYSTEM: Set = Set {
    folder: "engines/sid",
    suite: "sid",
    packages: &[
        "base-files",
        "bash",
        "coreutils",
        "dash",
        "godot",
        "libopenxr-loader1",
        "libopenxr1-monado",
        "libvulkan1",
        "libx11-6",
        "libxcursor1",
        "libxi6",
        "libxinerama1",
        "libxrandr2",
        "mangohud",
        "mesa-vulkan-drivers",
        "monado-service",
        "qml-qt6",
        "qml6-module-qtqml-models",
        "qml6-module-qtquick",
        "qml6-module-qtquick3d",
        "qml6-module-qtquick3d-helpers",
        "qml6-module-qtquick3d-xr",
        "vkbasalt",
        "vulkan-validationlayers",
        "xvfb",
    ],
    with_dependencies: true,
};

/// Runs every engine, or the engines named by the arguments (`parafovea-engines` reads them), without and with the layer.
pub fn engines(arguments: &[String]) -> Result<(), String> {
    setup(Voice::Implied)?;
    if !Command::new("id").arg("-u").output().is_ok_and(|id| id.stdout.trim_ascii() == b"0") {
        println!("skipped: needs root");
        return Ok(());
    }
    let root = match unpack(&SYSTEM) {
        Ok(root) => root,
        Err(reason) => {
            println!("skipped: engines of Debian sid: {reason}");
            return Ok(());
        }
    };
    let mut steps = Steps::default();
    let mut build = tasks::workspace("build");
    steps.run(
        "cargo build",
        tasks::in_root(build.args(["--bin", "parafovea", "--bin", "parafovea-engines"])),
    )?;
    let program = profile_folder()?.join("parafovea-engines");
    steps.run("engines", tasks::in_root(Command::new(program).arg(root).args(arguments)))
}
