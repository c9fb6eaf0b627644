//! Compiles `shaders/*.wgsl` to SPIR-V 1.0, each with `shaders/scene.wgsl` in front.

#[path = "build/patch.rs"]
mod patch;

use naga::back::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=shaders");
    println!("cargo::rerun-if-changed=build");
    let out = std::env::var("OUT_DIR")?;
    let scene = std::fs::read_to_string("shaders/scene.wgsl")?;
    for entry in std::fs::read_dir("shaders")? {
        let path = entry?.path();
        let source = format!("{scene}{}", std::fs::read_to_string(&path)?);
        if path.ends_with("scene.wgsl") {
            continue;
        }
        let words = compile(&source).map_err(|error| format!("{}: {error}", path.display()))?;
        let stem = path.file_stem().and_then(|stem| stem.to_str()).ok_or("a shader without a name")?;
        let words = match stem {
            "input" | "input_samples" => patch::input_attachment(&words, 7),
            "stereo" => patch::viewport_index(&words, 7),
            _ => words,
        };
        let bytes: Vec<u8> = words.into_iter().flat_map(u32::to_le_bytes).collect();
        std::fs::write(Path::new(&out).join(stem).with_extension("spv"), bytes)?;
    }
    Ok(())
}

fn compile(source: &str) -> Result<Vec<u32>, Box<dyn Error>> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let capabilities = Capabilities::IMMEDIATES | Capabilities::MULTIVIEW;
    let info = Validator::new(ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|error| error.emit_to_string(source))?;
    // No turning upside-down: the shaders are written for Vulkan's coordinates.
    let options =
        spv::Options { lang_version: (1, 0), flags: spv::WriterFlags::empty(), ..spv::Options::default() };
    Ok(spv::write_vec(&module, &info, &options, None)?)
}
