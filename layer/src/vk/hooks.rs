//! Hooks of calls that create, destroy and describe objects: each calls the next layer, and tracks the outcome.

mod by_identifier;
pub mod descriptors;
pub mod device;
pub mod framebuffers;
pub mod images;
pub mod instance;
pub mod layouts;
pub mod pipelines;
pub mod queues;
pub mod render_passes;
pub mod shader_modules;
pub mod shader_objects;
pub mod views;
