//! Facts of fragment shaders: of live modules, and of modules that only an identifier from an earlier launch names.

pub mod effects;
mod flow;
mod known;
mod modules;
pub mod parts;
mod specialization;
pub mod spirv;

pub use effects::{Effects, FragmentShaders};
pub use known::KnownShaders;
pub use modules::{ShaderModules, effects_of_object, lacks_code, read};
