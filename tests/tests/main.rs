//! End-to-end tests: real applications, the real loaders, lavapipe.

mod canaries;
mod configuration;
mod enabling;
mod hello_xr;
mod overhead;
mod pictures;
mod readme;
mod swapchain_cases;
