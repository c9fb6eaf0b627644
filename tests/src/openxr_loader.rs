//! Builds the Khronos OpenXR loader 1.1 as a shared library, so that unmodified programs can be tested with
//! it beside the distribution's older one: `LD_LIBRARY_PATH=<directory> hello_xr -g Vulkan2`.
//!
//! The sources come with the `openxr-sys` package, so nothing is downloaded. CMake and a C++ compiler are needed;
//! the build takes about ten seconds, once.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use anyhow::{Context, Result, bail};
use serde_json::Value;

/// The loader's file name, as programs ask for it.
pub const FILE_NAME: &str = "libopenxr_loader.so.1";

/// Builds the loader below `target` (cargo's target directory, for example) unless it exists, and returns the
/// directory of [`FILE_NAME`].
///
/// # Errors
/// If cargo, CMake or the C++ compiler is missing or fails; the text contains its output.
pub fn build(target: &Path) -> Result<PathBuf> {
    let source = source()?;
    fs::create_dir_all(target)?;
    let target = fs::canonicalize(target)?.join(format!("openxr-loader-{}", source.version));
    fs::create_dir_all(&target)?;
    // Tests run side by side: the first one builds, the others wait.
    let lock = File::create(target.join("lock"))?;
    lock.lock()?;
    let directory = target.join("src/loader");
    if !directory.join(FILE_NAME).exists() {
        let build = target.as_os_str();
        run(Command::new("cmake").arg("-S").arg(&source.directory).arg("-B").arg(build).args([
            "-DCMAKE_BUILD_TYPE=Release",
            "-DDYNAMIC_LOADER=ON",
            "-DBUILD_API_LAYERS=OFF",
            "-DBUILD_TESTS=OFF",
            "-DBUILD_WITH_SYSTEM_JSONCPP=OFF",
        ]))?;
        run(Command::new("cmake").arg("--build").arg(build).args([
            "--target",
            "openxr_loader",
            "--parallel",
        ]))?;
    }
    Ok(directory)
}

struct Source {
    directory: PathBuf,
    version: String,
}

/// Folder of the OpenXR SDK in cargo's sources of `openxr-sys`, and the version of `openxr-sys`.
fn source() -> Result<Source> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = run(Command::new(cargo)
        .args(["metadata", "--format-version", "1", "--filter-platform", "host-tuple", "--manifest-path"])
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")))?;
    let metadata: Value = serde_json::from_slice(&output.stdout).context("reading `cargo metadata`")?;
    let package = metadata["packages"]
        .as_array()
        .and_then(|packages| packages.iter().find(|package| package["name"] == "openxr-sys"))
        .context("openxr-sys is not among the packages")?;
    let text = |key| package[key].as_str().with_context(|| format!("openxr-sys has no {key}"));
    let directory = Path::new(text("manifest_path")?).with_file_name("OpenXR-SDK");
    Ok(Source { directory, version: text("version")?.to_owned() })
}

fn run(command: &mut Command) -> Result<Output> {
    let program = command.get_program().to_string_lossy().into_owned();
    let output = command.output().with_context(|| format!("{program} cannot be run; is it installed?"))?;
    if !output.status.success() {
        bail!(
            "{program} failed:\n{}{}",
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        );
    }
    Ok(output)
}
