//! An OpenXR application for tests, as raw as the C interface: mistakes must be possible.

use crate::gpu::Gpu;
use ash::vk;
use ash::vk::Handle as _;
use openxr_sys as xr;
use parafovea_mock_runtime::xrNegotiateLoaderRuntimeInterface;
use std::ffi::{CString, c_char, c_void};
use std::sync::OnceLock;

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

/// `xrGetInstanceProcAddr` of the OpenXR loader.
fn loader() -> xr::pfn::GetInstanceProcAddr {
    static LOADER: OnceLock<libloading::Library> = OnceLock::new();
    // SAFETY: the OpenXR loader may be loaded by anybody; it stays loaded.
    unsafe {
        let library = LOADER.get_or_init(|| libloading::Library::new("libopenxr_loader.so.1").unwrap());
        *library.get::<xr::pfn::GetInstanceProcAddr>(c"xrGetInstanceProcAddr").unwrap()
    }
}

/// `xrGetInstanceProcAddr` of the runtime itself, negotiated as a loader for OpenXR 1.1 does it. The loader of Debian
/// bookworm is for OpenXR 1.0, and answers some mistakes before the runtime sees them.
fn negotiated() -> xr::pfn::GetInstanceProcAddr {
    let info = xr::NegotiateLoaderInfo {
        struct_type: xr::NegotiateLoaderInfo::TYPE,
        struct_version: xr::NegotiateLoaderInfo::VERSION,
        struct_size: size_of::<xr::NegotiateLoaderInfo>(),
        min_interface_version: 1,
        max_interface_version: 1,
        min_api_version: xr::Version::new(1, 0, 0),
        max_api_version: xr::Version::new(1, 0x3ff, 0xfff),
    };
    let mut request = xr::NegotiateRuntimeRequest {
        struct_type: xr::NegotiateRuntimeRequest::TYPE,
        struct_version: xr::NegotiateRuntimeRequest::VERSION,
        struct_size: size_of::<xr::NegotiateRuntimeRequest>(),
        runtime_interface_version: 0,
        runtime_api_version: xr::Version::new(0, 0, 0),
        get_instance_proc_addr: None,
    };
    // SAFETY: valid pointers.
    let result = unsafe { xrNegotiateLoaderRuntimeInterface(&info, &mut request) };
    assert_eq!(result, xr::Result::SUCCESS);
    request.get_instance_proc_addr.unwrap()
}

/// How far an application has come, and what it has.
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
        Self::by(loader())
    }

    /// Without anything, not even a loader.
    pub fn without_loader() -> Self {
        Self::by(negotiated())
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

    /// The states that events tell of, until there are none.
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

    pub fn action_set(&self, set_name: &str) -> xr::ActionSet {
        let info = structure!(ActionSetCreateInfo {
            action_set_name: name(set_name),
            localized_action_set_name: name(set_name),
        });
        let mut set = xr::ActionSet::default();
        assert_eq!(call!(self, CreateActionSet(self.instance, &info, &mut set)), xr::Result::SUCCESS);
        set
    }

    pub fn action(&self, set: xr::ActionSet, action_name: &str, ty: xr::ActionType) -> xr::Action {
        self.try_action(set, action_name, ty, &[]).unwrap()
    }

    pub fn try_action(
        &self,
        set: xr::ActionSet,
        action_name: &str,
        ty: xr::ActionType,
        subactions: &[xr::Path],
    ) -> Result<xr::Action, xr::Result> {
        let info = structure!(ActionCreateInfo {
            action_name: name(action_name),
            localized_action_name: name(action_name),
            action_type: ty,
            count_subaction_paths: subactions.len() as u32,
            subaction_paths: subactions.as_ptr(),
        });
        let mut action = xr::Action::default();
        match call!(self, CreateAction(set, &info, &mut action)) {
            xr::Result::SUCCESS => Ok(action),
            error => Err(error),
        }
    }

    pub fn suggest(&self, profile: &str, bindings: &[(xr::Action, &str)]) -> xr::Result {
        let bind = |&(action, path): &(xr::Action, &str)| xr::ActionSuggestedBinding {
            action,
            binding: self.path(path),
        };
        let bindings: Vec<_> = bindings.iter().map(bind).collect();
        let info = structure!(InteractionProfileSuggestedBinding {
            interaction_profile: self.path(profile),
            count_suggested_bindings: bindings.len() as u32,
            suggested_bindings: bindings.as_ptr(),
        });
        call!(self, SuggestInteractionProfileBindings(self.instance, &info))
    }

    pub fn attach(&self, sets: &[xr::ActionSet]) -> xr::Result {
        let info = structure!(SessionActionSetsAttachInfo {
            count_action_sets: sets.len() as u32,
            action_sets: sets.as_ptr(),
        });
        call!(self, AttachSessionActionSets(self.session, &info))
    }

    pub fn sync(&self, sets: &[xr::ActionSet]) -> xr::Result {
        let active =
            |&action_set: &xr::ActionSet| xr::ActiveActionSet { action_set, subaction_path: xr::Path::NULL };
        let sets: Vec<_> = sets.iter().map(active).collect();
        let info = structure!(ActionsSyncInfo {
            count_active_action_sets: sets.len() as u32,
            active_action_sets: sets.as_ptr(),
        });
        call!(self, SyncActions(self.session, &info))
    }

    pub fn boolean(&self, action: xr::Action) -> Result<xr::ActionStateBoolean, xr::Result> {
        let info = structure!(ActionStateGetInfo { action: action });
        let mut state = structure!(ActionStateBoolean {});
        match call!(self, GetActionStateBoolean(self.session, &info, &mut state)) {
            xr::Result::SUCCESS => Ok(state),
            error => Err(error),
        }
    }

    pub fn action_space(&self, action: xr::Action) -> xr::Space {
        let info = structure!(ActionSpaceCreateInfo { action: action, pose_in_action_space: IDENTITY });
        let mut space = xr::Space::default();
        assert_eq!(call!(self, CreateActionSpace(self.session, &info, &mut space)), xr::Result::SUCCESS);
        space
    }
}

impl Drop for Application {
    fn drop(&mut self) {
        if self.instance != xr::Instance::default() {
            assert_eq!(call!(self, DestroyInstance(self.instance)), xr::Result::SUCCESS);
        }
    }
}

/// Width and height of the tests' swapchains.
pub const SIZE: u32 = 64;

/// Parameters of a swapchain that can be painted.
pub fn swapchain_info() -> xr::SwapchainCreateInfo {
    structure!(SwapchainCreateInfo {
        usage_flags: xr::SwapchainUsageFlags::COLOR_ATTACHMENT | xr::SwapchainUsageFlags::TRANSFER_DST,
        format: i64::from(vk::Format::R8G8B8A8_SRGB.as_raw()),
        sample_count: 1,
        width: SIZE,
        height: SIZE,
        face_count: 1,
        array_size: 1,
        mip_count: 1,
    })
}

/// All of the first layer of a swapchain.
pub fn whole(swapchain: xr::Swapchain) -> xr::SwapchainSubImage {
    let extent = xr::Extent2Di { width: SIZE as i32, height: SIZE as i32 };
    let image_rect = xr::Rect2Di { offset: xr::Offset2Di { x: 0, y: 0 }, extent };
    xr::SwapchainSubImage { swapchain, image_rect, image_array_index: 0 }
}

/// The field of view of the default views.
pub fn fov() -> xr::Fovf {
    let angle = 45_f32.to_radians();
    xr::Fovf { angle_left: -angle, angle_right: angle, angle_up: angle, angle_down: -angle }
}

/// Both views of a swapchain, from the head, as the default views see.
pub fn views(swapchain: xr::Swapchain) -> [xr::CompositionLayerProjectionView; 2] {
    let view = structure!(CompositionLayerProjectionView {
        pose: IDENTITY,
        fov: fov(),
        sub_image: whole(swapchain),
    });
    [view; 2]
}

/// A projection layer.
pub fn projection(
    space: xr::Space,
    views: &[xr::CompositionLayerProjectionView],
) -> xr::CompositionLayerProjection {
    structure!(CompositionLayerProjection {
        space: space,
        view_count: views.len() as u32,
        views: views.as_ptr(),
    })
}

/// A layer as `xrEndFrame` takes it.
pub fn header<T>(layer: &T) -> &xr::CompositionLayerBaseHeader {
    // SAFETY: every layer begins like the header.
    unsafe { &*std::ptr::from_ref(layer).cast() }
}
