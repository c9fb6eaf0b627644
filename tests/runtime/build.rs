//! Compiles `shaders/*.wgsl` to SPIR-V.

use naga::back::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=shaders");
    let out = std::env::var("OUT_DIR")?;
    for entry in std::fs::read_dir("shaders")? {
        let source = entry?.path();
        let words = compile(&std::fs::read_to_string(&source)?)
            .map_err(|error| format!("{}: {error}", source.display()))?;
        let bytes: Vec<u8> = words.into_iter().flat_map(u32::to_le_bytes).collect();
        let stem = source.file_stem().ok_or("a shader without a name")?;
        std::fs::write(Path::new(&out).join(stem).with_extension("spv"), bytes)?;
    }
    Ok(())
}

fn compile(source: &str) -> Result<Vec<u32>, Box<dyn Error>> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module)?;
    // No turning upside-down: the shaders are written for Vulkan's coordinates.
    let options = spv::Options { flags: spv::WriterFlags::empty(), ..spv::Options::default() };
    Ok(spv::write_vec(&module, &info, &options, None)?)
}
