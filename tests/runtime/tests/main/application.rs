//! An OpenXR application for tests, as raw as the C interface: mistakes must be possible.

#[path = "application/entry.rs"]
mod entry;
#[path = "application/input.rs"]
mod input;
#[path = "application/layers.rs"]
mod layers;

pub use layers::{SIZE, fov, header, projection, swapchain_info, views, whole};

use crate::gpu::Gpu;
use ash::vk;
use ash::vk::Handle as _;
use openxr_sys as xr;
use std::ffi::{CString, c_char, c_void};

pub const ENABLE: &str = "XR_KHR_vulkan_enable";
pub const V1_0: xr::Version = xr::Version::new(1, 0, 20);
pub const V1_1: xr::Version = xr::Version::new(1, 1, 0);

/// A structure with its type, and zero in all members but those given.
macro_rules! structure {
    ($name:ident { $($member:ident: $value:expr),* $(,)? }) => {{
        // SAFETY: structures of OpenXR are numbers, enums without niches and pointers: zero is a value of each.
        let mut structure: openxr_sys::$name = unsafe { std::mem::zeroed() };
        structure.ty = openxr_sys::$name::TYPE;
        $(structure.$member = $value;)*
        structure
    }};
}

/// Calls a function by its name without `xr`, and returns its result.
macro_rules! call {
    ($application:expr, $name:ident($($argument:expr),* $(,)?)) => {{
        let function = $application.function(concat!("xr", stringify!($name)));
        // SAFETY: the function of this name has this type; arguments live for the call, and where they are wrong on
        // purpose, they are wrong in ways that the runtime promises to find.
        unsafe {
            let function: openxr_sys::pfn::$name = std::mem::transmute::<openxr_sys::pfn::VoidFunction, _>(function);
            function($($argument),*)
        }
    }};
}

pub(crate) use {call, structure};

/// State of an application, with its objects.
pub struct Application {
    get_instance_proc_addr: xr::pfn::GetInstanceProcAddr,
    pub instance: xr::Instance,
    pub system: xr::SystemId,
    pub session: xr::Session,
    pub gpu: Option<Gpu>,
}

/// Fills an array of names.
pub fn name<const N: usize>(text: &str) -> [c_char; N] {
    let mut array = [0; N];
    array.iter_mut().zip(text.bytes()).for_each(|(place, byte)| *place = byte as c_char);
    array
}

pub const IDENTITY: xr::Posef = xr::Posef::IDENTITY;

impl Application {
    /// Without anything but the OpenXR loader.
    pub fn nothing() -> Self {
        Self::by(entry::loader())
    }

    /// Without anything, not even a loader.
    pub fn without_loader() -> Self {
        Self::by(entry::negotiated())
    }

    fn by(get_instance_proc_addr: xr::pfn::GetInstanceProcAddr) -> Self {
        Self {
            get_instance_proc_addr,
            instance: xr::Instance::default(),
            system: xr::SystemId::NULL,
            session: xr::Session::default(),
            gpu: None,
        }
    }

    pub fn function(&self, name: &str) -> xr::pfn::VoidFunction {
        self.find(name).unwrap_or_else(|| panic!("there is no {name}"))
    }

    pub fn find(&self, name: &str) -> Option<xr::pfn::VoidFunction> {
        self.get(name).ok()
    }

    /// Asks for a function.
    pub fn get(&self, name: &str) -> Result<xr::pfn::VoidFunction, xr::Result> {
        let name = CString::new(name).unwrap();
        let mut function = None;
        // SAFETY: valid pointers.
        let result = unsafe { (self.get_instance_proc_addr)(self.instance, name.as_ptr(), &mut function) };
        if result == xr::Result::SUCCESS { Ok(function.unwrap()) } else { Err(result) }
    }

    /// Tries to make an instance.
    pub fn create_instance(&mut self, api: xr::Version, extensions: &[&str]) -> xr::Result {
        let extensions: Vec<_> = extensions.iter().map(|&name| CString::new(name).unwrap()).collect();
        let extensions: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
        let mut info = structure!(InstanceCreateInfo {
            enabled_extension_count: extensions.len() as u32,
            enabled_extension_names: extensions.as_ptr(),
        });
        info.application_info.application_name = name("test");
        info.application_info.api_version = api;
        call!(self, CreateInstance(&info, &mut self.instance))
    }

    /// With an instance and a system.
    pub fn with_instance(api: xr::Version, extensions: &[&str]) -> Self {
        let mut this = if api.minor() == 0 { Self::nothing() } else { Self::without_loader() };
        assert_eq!(this.create_instance(api, extensions), xr::Result::SUCCESS);
        let info = structure!(SystemGetInfo { form_factor: xr::FormFactor::HEAD_MOUNTED_DISPLAY });
        assert_eq!(call!(this, GetSystem(this.instance, &info, &mut this.system)), xr::Result::SUCCESS);
        this
    }

    /// With an instance for Vulkan.
    pub fn started() -> Self {
        Self::with_instance(V1_0, &[ENABLE])
    }

    /// With a session that may begin.
    pub fn ready() -> Self {
        Self::ready_with(V1_0, &[ENABLE])
    }

    pub fn ready_with(api: xr::Version, extensions: &[&str]) -> Self {
        let mut this = Self::with_instance(api, extensions);
        this.read_requirements();
        this.gpu = Some(Gpu::new());
        assert_eq!(this.create_session(), xr::Result::SUCCESS);
        this
    }

    pub fn read_requirements(&self) {
        let mut requirements = structure!(GraphicsRequirementsVulkanKHR {});
        let result =
            call!(self, GetVulkanGraphicsRequirementsKHR(self.instance, self.system, &mut requirements));
        assert_eq!(result, xr::Result::SUCCESS);
    }

    /// Tries to make a session on the device.
    pub fn create_session(&mut self) -> xr::Result {
        let binding = self.gpu.as_ref().unwrap().binding();
        self.create_session_with(&binding)
    }

    pub fn create_session_with(&mut self, binding: &xr::GraphicsBindingVulkanKHR) -> xr::Result {
        let next = std::ptr::from_ref(binding).cast::<c_void>();
        let info = structure!(SessionCreateInfo { next: next, system_id: self.system });
        call!(self, CreateSession(self.instance, &info, &mut self.session))
    }

    pub fn begin_session(&self) -> xr::Result {
        let ty = xr::ViewConfigurationType::PRIMARY_STEREO;
        let info = structure!(SessionBeginInfo { primary_view_configuration_type: ty });
        call!(self, BeginSession(self.session, &info))
    }

    /// With a session that runs.
    pub fn running() -> Self {
        let this = Self::ready();
        assert_eq!(this.begin_session(), xr::Result::SUCCESS);
        this
    }

    /// In its first frame, which makes the session focused.
    pub fn in_frame() -> Self {
        let this = Self::running();
        this.begin_frame();
        this
    }

    pub fn wait_frame(&self) -> xr::FrameState {
        let mut state = structure!(FrameState {});
        assert_eq!(call!(self, WaitFrame(self.session, std::ptr::null(), &mut state)), xr::Result::SUCCESS);
        state
    }

    /// Waits for a frame and begins it.
    pub fn begin_frame(&self) -> xr::FrameState {
        let state = self.wait_frame();
        assert_eq!(call!(self, BeginFrame(self.session, std::ptr::null())), xr::Result::SUCCESS);
        state
    }

    /// Ends a frame with these layers.
    pub fn end_frame(&self, time: xr::Time, layers: &[&xr::CompositionLayerBaseHeader]) -> xr::Result {
        let layers: Vec<*const _> = layers.iter().map(|layer| std::ptr::from_ref(*layer)).collect();
        let info = structure!(FrameEndInfo {
            display_time: time,
            environment_blend_mode: xr::EnvironmentBlendMode::OPAQUE,
            layer_count: layers.len() as u32,
            layers: layers.as_ptr(),
        });
        call!(self, EndFrame(self.session, &info))
    }

    pub fn space(&self, ty: xr::ReferenceSpaceType) -> xr::Space {
        let info = structure!(ReferenceSpaceCreateInfo {
            reference_space_type: ty,
            pose_in_reference_space: IDENTITY
        });
        let mut space = xr::Space::default();
        assert_eq!(call!(self, CreateReferenceSpace(self.session, &info, &mut space)), xr::Result::SUCCESS);
        space
    }

    pub fn path(&self, text: &str) -> xr::Path {
        let text = CString::new(text).unwrap();
        let mut path = xr::Path::NULL;
        assert_eq!(call!(self, StringToPath(self.instance, text.as_ptr(), &mut path)), xr::Result::SUCCESS);
        path
    }

    pub fn create_swapchain(&self, info: &xr::SwapchainCreateInfo) -> Result<xr::Swapchain, xr::Result> {
        let mut swapchain = xr::Swapchain::default();
        match call!(self, CreateSwapchain(self.session, info, &mut swapchain)) {
            xr::Result::SUCCESS => Ok(swapchain),
            error => Err(error),
        }
    }

    /// A swapchain of 64 by 64 texels.
    pub fn swapchain(&self) -> xr::Swapchain {
        self.create_swapchain(&swapchain_info()).unwrap()
    }

    pub fn images(&self, swapchain: xr::Swapchain) -> Vec<vk::Image> {
        let mut images = vec![structure!(SwapchainImageVulkanKHR {}); 8];
        let mut count = 0;
        let first = images.as_mut_ptr().cast();
        let result = call!(self, EnumerateSwapchainImages(swapchain, 8, &mut count, first));
        assert_eq!(result, xr::Result::SUCCESS);
        images[..count as usize].iter().map(|image| vk::Image::from_raw(image.image)).collect()
    }

    pub fn acquire(&self, swapchain: xr::Swapchain) -> Result<u32, xr::Result> {
        let mut index = u32::MAX;
        match call!(self, AcquireSwapchainImage(swapchain, std::ptr::null(), &mut index)) {
            xr::Result::SUCCESS => Ok(index),
            error => Err(error),
        }
    }

    pub fn wait(&self, swapchain: xr::Swapchain) -> xr::Result {
        let info = structure!(SwapchainImageWaitInfo { timeout: xr::Duration::from_nanos(1_000_000_000) });
        call!(self, WaitSwapchainImage(swapchain, &info))
    }

    pub fn release(&self, swapchain: xr::Swapchain) -> xr::Result {
        call!(self, ReleaseSwapchainImage(swapchain, std::ptr::null()))
    }

    /// Acquires, waits for, paints (unless there is nothing to paint) and releases an image of 64 by 64 texels.
    pub fn show(&self, swapchain: xr::Swapchain, layer: u32, texels: &[u8]) {
        let index = self.acquire(swapchain).unwrap() as usize;
        assert_eq!(self.wait(swapchain), xr::Result::SUCCESS);
        if !texels.is_empty() {
            self.gpu.as_ref().unwrap().paint(self.images(swapchain)[index], layer, SIZE, SIZE, texels);
        }
        assert_eq!(self.release(swapchain), xr::Result::SUCCESS);
    }

    /// The newest event.
    pub fn poll(&self) -> Option<xr::EventDataBuffer> {
        let mut buffer = structure!(EventDataBuffer {});
        let result = call!(self, PollEvent(self.instance, &mut buffer));
        (result == xr::Result::SUCCESS).then_some(buffer)
    }

    /// States of the pending events.
    pub fn states(&self) -> Vec<xr::SessionState> {
        let mut states = Vec::new();
        while let Some(event) = self.poll() {
            if event.ty == xr::EventDataSessionStateChanged::TYPE {
                // SAFETY: an event of this type is this structure, which is smaller than the buffer.
                let event = unsafe { *std::ptr::from_ref(&event).cast::<xr::EventDataSessionStateChanged>() };
                assert_eq!(event.session, self.session);
                states.push(event.state);
            }
        }
        states
    }
}

impl Drop for Application {
    fn drop(&mut self) {
        if self.instance != xr::Instance::default() {
            assert_eq!(call!(self, DestroyInstance(self.instance)), xr::Result::SUCCESS);
        }
    }
}
