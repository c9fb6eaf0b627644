//! Common parts of all cases: the two APIs, the brush, and the report.

use crate::failure::{Failure, name};
use crate::options::Options;
use crate::paint::Painter;
use crate::vulkan::{self, Vulkan};
use crate::xr::Xr;
use openxr_sys as xr;
use parafovea_zoo::cases::report::Report;
use std::cell::{RefCell, RefMut};
use std::ffi::CStr;

/// The application, from its start to its end.
pub struct App {
    pub painter: RefCell<Painter>,
    pub vulkan: Vulkan,
    pub xr: Xr,
    /// Recommended size of each view's image: width, height.
    pub view_sizes: [[u32; 2]; 2],
    /// The structure that images are enumerated into.
    pub blank_image: xr::SwapchainImageVulkanKHR,
    /// Length of the array for a swapchain's images; `None` to ask for their number.
    pub image_capacity: Option<u32>,
    report: RefCell<Report>,
}

impl App {
    /// Starts OpenXR, with `extensions` beside the graphics extension, and Vulkan.
    pub fn start(options: &Options, extensions: &[&CStr]) -> Result<Self, Failure> {
        let (xr, vulkan) = vulkan::create(options, extensions)?;
        Ok(Self {
            painter: RefCell::new(Painter::create(&vulkan, options.submit_lock.as_deref())?),
            view_sizes: xr.view_sizes()?,
            blank_image: blank_image(options.untyped_images),
            image_capacity: options.image_capacity,
            vulkan,
            xr,
            report: RefCell::default(),
        })
    }

    /// The report so far.
    pub fn report(&self) -> RefMut<'_, Report> {
        self.report.borrow_mut()
    }

    /// Ends the application, and returns its observations.
    pub fn into_report(self) -> Report {
        self.report.into_inner()
    }

    /// Reports the result of a call that the case is about, and which one the specification demands.
    pub fn expect(&self, what: &str, result: xr::Result, expected: xr::Result) {
        self.expect_any(what, result, &[expected]);
    }

    /// As [`App::expect`], where the specification leaves a choice.
    pub fn expect_any(&self, what: &str, result: xr::Result, expected: &[xr::Result]) {
        let expected: Vec<String> = expected.iter().map(|result| name(*result)).collect();
        let expected: Vec<&str> = expected.iter().map(String::as_str).collect();
        self.report().call(what, &name(result), &expected);
    }
}

/// An image to be enumerated; without a type, its pointer is an address that nothing may read.
fn blank_image(is_untyped: bool) -> xr::SwapchainImageVulkanKHR {
    let (ty, next) = match is_untyped {
        true => (xr::StructureType::UNKNOWN, std::ptr::without_provenance_mut(usize::MAX)),
        false => (xr::SwapchainImageVulkanKHR::TYPE, std::ptr::null_mut()),
    };
    xr::SwapchainImageVulkanKHR { ty, next, image: 0 }
}
