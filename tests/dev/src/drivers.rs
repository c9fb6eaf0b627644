//! Mesa's real drivers with no-op kernel shims, unpacked below the target folder.

use crate::setup::{Voice, setup};
use crate::steps::{Steps, profile_folder};
use crate::tasks;
use crate::unpack::{Set, unpack};
use std::fs;
use std::process::Command;

/// Unpacks the drivers of this Debian release, or of its backports where those are the first with the shims, to
/// `target/drivers/release`. Elsewhere it prints the reason, which is not an error: tasks go on without.
pub fn unpack_release() {
    let text = fs::read_to_string("/etc/os-release").unwrap_or_default();
    let Some(suite) = suite_with_shims(&text) else {
        eprintln!(
            "cargo dev: Mesa's hardware drivers are not available: this is neither Debian bookworm nor trixie"
        );
        return;
    };
    let packages = &["libdrm-amdgpu1", "libdrm2", "mesa-drm-shim", "mesa-vulkan-drivers"];
    let set = Set { folder: "drivers/release", suite, packages, with_dependencies: false };
    if let Err(reason) = unpack(&set) {
        eprintln!("cargo dev: Mesa's hardware drivers are not available: {reason}");
    }
}

/// Unpacks sid's drivers to `target/drivers/sid`, with its loaders, validation and C library: the newest Mesa, and drivers that releases
/// leave out. Beside them DXVK for Linux programs, with its window library and a compiler of shaders, and Qt
/// Quick 3D XR. libvulkan-dev is there for vulkaninfo, which loads `libvulkan.so` and would find the machine's
/// own. A failure is printed, and is not an error.
fn unpack_sid() {
    let packages = &[
        "libdxvk-d3d11-0",
        "libopenxr-loader1",
        "libsdl3-0",
        "libvkd3d-utils1",
        "libvulkan-dev",
        "libvulkan1",
        "mesa-drm-shim",
        "mesa-vulkan-drivers",
        "openxr-layer-corevalidation",
        "qml-qt6",
        "qml6-module-qtqml-models",
        "qml6-module-qtquick",
        "qml6-module-qtquick3d",
        "qml6-module-qtquick3d-helpers",
        "qml6-module-qtquick3d-xr",
        "vulkan-validationlayers",
    ];
    if let Err(reason) =
        unpack(&Set { folder: "drivers/sid", suite: "sid", packages, with_dependencies: true })
    {
        println!("skipped: drivers of Debian sid: {reason}");
    }
}

/// The layer on all of Mesa's drivers.
pub fn drivers(arguments: &[String]) -> Result<(), String> {
    setup(Voice::Implied)?;
    unpack_release();
    unpack_sid();
    let mut steps = Steps::default();
    tasks::build(&mut steps)?;
    steps.run("drivers", Command::new(profile_folder()?.join("parafovea-drivers")).args(arguments))
}

/// The suite with mesa-drm-shim for a release, by the text of `/etc/os-release`.
fn suite_with_shims(os_release: &str) -> Option<&'static str> {
    let value = |name: &str| {
        let line = os_release.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix('='));
        line.unwrap_or_default().trim_matches('"')
    };
    match (value("ID"), value("VERSION_CODENAME")) {
        ("debian", "bookworm") => Some("bookworm-backports"),
        ("debian", "trixie") => Some("trixie"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn releases_have_their_suites() {
        let bookworm =
            "PRETTY_NAME=\"Debian GNU/Linux 12 (bookworm)\"\nVERSION_CODENAME=bookworm\nID=debian\n";
        assert_eq!(suite_with_shims(bookworm), Some("bookworm-backports"));
        assert_eq!(suite_with_shims("ID=\"debian\"\nVERSION_CODENAME=\"trixie\"\n"), Some("trixie"));
        assert_eq!(suite_with_shims("ID=ubuntu\nVERSION_CODENAME=noble\n"), None);
        assert_eq!(suite_with_shims(""), None);
    }
}
