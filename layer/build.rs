//! Compiles `shaders/<stem>.wgsl` to SPIR-V for Vulkan 1.0, and fails where a kernel is incomplete.
//!
//! A kernel is three files of one stem: shader, CPU reference and pass. Its parameters are declared twice,
//! in Rust and in WGSL; both declarations must lay them out alike.

use naga::back::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use parafovea_core::kernels::analyze::AnalyzeParams;
use parafovea_core::kernels::change::ChangeParams;
use parafovea_core::kernels::compose::{ComposeParams, ReuseParams};
use parafovea_core::kernels::debug_view::DebugViewParams;
use parafovea_core::kernels::decide::DecideParams;
use parafovea_core::kernels::mask::MaskParams;
use parafovea_core::kernels::nearest::NearestParams;
use parafovea_core::kernels::resolve::ResolveParams;
use parafovea_core::kernels::samples::SampleParams;
use parafovea_core::kernels::template::TemplateParams;
use parafovea_core::layout::{Field, Uniform};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::{env, fs, process};

/// A parameter struct on the Rust side.
struct Declared {
    name: &'static str,
    size: usize,
    fields: &'static [Field],
}

fn declared<T: Uniform>() -> Declared {
    Declared { name: T::NAME, size: size_of::<T>(), fields: T::FIELDS }
}

fn main() {
    // Never unloaded: both loaders may close the library while threads, and callbacks of the other half, are in it.
    println!("cargo::rustc-link-arg-cdylib=-Wl,-z,nodelete");
    let uniforms = [
        declared::<AnalyzeParams>(),
        declared::<ChangeParams>(),
        declared::<DecideParams>(),
        declared::<ResolveParams>(),
        declared::<MaskParams>(),
        declared::<SampleParams>(),
        declared::<TemplateParams>(),
        declared::<NearestParams>(),
        declared::<ComposeParams>(),
        declared::<ReuseParams>(),
        declared::<DebugViewParams>(),
    ];
    if let Err(message) = build(&uniforms) {
        eprintln!("error: {message}");
        process::exit(1);
    }
}

fn build(uniforms: &[Declared]) -> Result<(), String> {
    let layer = PathBuf::from(env::var("CARGO_MANIFEST_DIR").map_err(|error| error.to_string())?);
    let out = PathBuf::from(env::var("OUT_DIR").map_err(|error| error.to_string())?);
    let repository = layer.parent().ok_or("the package has no parent folder")?;
    let mut checksum = FNV_BASIS;
    for stem in complete_kernels(repository)? {
        let path = layer.join("shaders").join(format!("{stem}.wgsl"));
        let source = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let mut shaders = vec![(stem.clone(), source.clone())];
        for (_, suffix, constant) in VARIANTS.iter().filter(|(of, ..)| *of == stem) {
            let [is, becomes] = ["false", "true"].map(|value| format!("const {constant}: bool = {value};"));
            if !source.contains(&is) {
                return Err(format!("{}: no `{is}`", path.display()));
            }
            shaders.push((format!("{stem}_{suffix}"), source.replace(&is, &becomes)));
        }
        for (name, source) in shaders {
            let words = compile(&source, uniforms).map_err(|error| format!("{}: {error}", path.display()))?;
            let bytes: Vec<u8> =
                without_storage_class(&words).into_iter().flat_map(u32::to_ne_bytes).collect();
            checksum =
                bytes.iter().fold(checksum, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(FNV_PRIME));
            let target = out.join(format!("{name}.spv"));
            fs::write(&target, bytes).map_err(|error| format!("{}: {error}", target.display()))?;
        }
    }
    // Of the pipelines that are kept on disk.
    println!("cargo::rustc-env=SHADERS_CHECKSUM={checksum:016x}");
    Ok(())
}

/// Shaders that are compiled once more: the stem, the ending of the second name, and the constant that is true there.
const VARIANTS: [(&str, &str, &str); 1] = [("compose", "gpu", "PIXELS_READ_PARAMETERS")];

/// FNV-1a, 64 bits.
const FNV_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const FNV_PRIME: u64 = 0x0000_0100_0000_01b3;

/// Folders of a kernel's three files, and their extensions.
const PLACES: [(&str, &str); 3] =
    [("layer/shaders", "wgsl"), ("core/src/kernels", "rs"), ("layer/src/kernels", "rs")];

/// Stems of all kernels; each must exist in all [`PLACES`].
fn complete_kernels(repository: &Path) -> Result<BTreeSet<String>, String> {
    let mut found = Vec::new();
    for (folder, extension) in PLACES {
        let path = repository.join(folder);
        println!("cargo::rerun-if-changed={}", path.display());
        found.push(stems(&path, extension)?);
    }
    let all: BTreeSet<String> = found.iter().flatten().cloned().collect();
    for ((folder, extension), stems) in PLACES.iter().zip(&found) {
        if let Some(stem) = all.difference(stems).next() {
            return Err(format!("kernel `{stem}` is incomplete: {folder}/{stem}.{extension} is missing"));
        }
    }
    Ok(all)
}

fn stems(folder: &Path, extension: &str) -> Result<BTreeSet<String>, String> {
    let entries = fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let paths = entries.filter_map(|entry| entry.ok().map(|entry| entry.path()));
    Ok(paths
        .filter(|path| path.extension().is_some_and(|found| found == extension))
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect())
}

fn compile(source: &str, uniforms: &[Declared]) -> Result<Vec<u32>, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    // Packing of half floats is an instruction of GLSL.std.450, which needs no feature of the device.
    let info = Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32)
        .validate(&module)
        .map_err(|error| error.emit_to_string(source))?;
    check_parameters(&module, uniforms)?;
    let options = spv::Options {
        lang_version: (1, 0),
        // Without ADJUST_COORDINATE_SPACE: positions are Vulkan's own, y pointing down.
        flags: spv::WriterFlags::empty(),
        // Capabilities of every Vulkan 1.0 device, with no feature enabled.
        capabilities: Some([spv::Capability::Shader].into_iter().collect()),
        ..spv::Options::default()
    };
    spv::write_vec(&module, &info, &options, None).map_err(|error| error.to_string())
}

/// Declares storage buffers as SPIR-V 1.0 has them, as uniforms that are decorated BufferBlock, which every Vulkan device
/// takes: naga uses a storage class of an extension that Vulkan 1.0 does not have.
fn without_storage_class(words: &[u32]) -> Vec<u32> {
    const HEADER: usize = 5;
    const EXTENSION: u32 = 10;
    const TYPE_POINTER: u32 = 32;
    const VARIABLE: u32 = 59;
    const DECORATE: u32 = 71;
    const UNIFORM: u32 = 2;
    const STORAGE_BUFFER: u32 = 12;
    const BLOCK: u32 = 2;
    const BUFFER_BLOCK: u32 = 3;

    let mut rest = &words[HEADER..];
    let instructions: Vec<&[u32]> = std::iter::from_fn(|| {
        let (instruction, others) = rest.split_at_checked((*rest.first()? >> 16) as usize)?;
        rest = others;
        Some(instruction)
    })
    .collect();
    let opcode = |instruction: &[u32]| instruction[0] & 0xffff;
    let is_storage =
        |instruction: &&&[u32]| opcode(instruction) == TYPE_POINTER && instruction[2] == STORAGE_BUFFER;
    let in_storage: Vec<u32> = instructions.iter().filter(is_storage).map(|pointer| pointer[3]).collect();

    let mut out = words[..HEADER].to_vec();
    for instruction in instructions {
        let at = out.len();
        out.extend_from_slice(instruction);
        match opcode(instruction) {
            EXTENSION => {
                let name: Vec<u8> = instruction[1..].iter().flat_map(|word| word.to_le_bytes()).collect();
                if name.starts_with(b"SPV_KHR_storage_buffer_storage_class\0") {
                    out.truncate(at);
                }
            }
            TYPE_POINTER if instruction[2] == STORAGE_BUFFER => out[at + 2] = UNIFORM,
            VARIABLE if instruction[3] == STORAGE_BUFFER => out[at + 3] = UNIFORM,
            DECORATE if instruction[2] == BLOCK && in_storage.contains(&instruction[1]) => {
                out[at + 2] = BUFFER_BLOCK;
            }
            _ => {}
        }
    }
    out
}

/// Compares each buffer of parameters of the shader, uniform or storage, with the Rust struct of the same name.
fn check_parameters(module: &naga::Module, uniforms: &[Declared]) -> Result<(), String> {
    let buffers = module.global_variables.iter().map(|(_, variable)| variable);
    let is_checked = |variable: &&naga::GlobalVariable| {
        variable.space == naga::AddressSpace::Uniform || variable.name.as_deref() == Some("params")
    };
    for buffer in buffers.filter(is_checked) {
        let ty = &module.types[buffer.ty];
        let naga::TypeInner::Struct { members, span } = &ty.inner else {
            return Err("parameters that are not a struct have no counterpart in Rust".to_owned());
        };
        let name = ty.name.as_deref().unwrap_or("(unnamed)");
        let rust = uniforms
            .iter()
            .find(|declared| declared.name == name)
            .ok_or_else(|| format!("no Rust struct was declared for the parameters `{name}`"))?;
        let wgsl: Vec<(&str, usize, usize)> = members
            .iter()
            .map(|member| {
                let size = module.types[member.ty].inner.size(module.to_ctx()) as usize;
                (member.name.as_deref().unwrap_or("(unnamed)"), member.offset as usize, size)
            })
            .collect();
        let expected: Vec<_> =
            rust.fields.iter().map(|field| (field.name, field.offset, field.size)).collect();
        if let Some((ours, theirs)) = expected.iter().zip(&wgsl).find(|(ours, theirs)| ours != theirs) {
            return Err(format!(
                "`{name}` differs: (field, offset, size) is {ours:?} in Rust, {theirs:?} here"
            ));
        }
        if expected.len() != wgsl.len() || rust.size != *span as usize {
            let (fields, size) = (rust.fields.len(), rust.size);
            let theirs = wgsl.len();
            return Err(format!(
                "`{name}` has {fields} fields in {size} bytes in Rust, {theirs} in {span} here"
            ));
        }
    }
    Ok(())
}
