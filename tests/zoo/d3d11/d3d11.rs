//! The part of Direct3D 11 that the scene needs, from DXVK's library.

use crate::com::{Guid, HResult, Object, call, check};
use anyhow::{Context as _, Result};
use std::ffi::c_void;
use std::ptr;

type Raw = *mut c_void;

/// Formats (`DXGI_FORMAT`).
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Format {
    Rgba16Float = 10,
    R11G11B10Float = 26,
    Rgba8Srgb = 29,
    Depth32 = 40,
    Depth24Stencil8 = 45,
    Rgb32Float = 6,
}

/// Uses of a resource (`D3D11_BIND_FLAG`).
pub mod bind {
    pub const VERTICES: u32 = 1;
    pub const CONSTANTS: u32 = 4;
    pub const SHADER: u32 = 8;
    pub const TARGET: u32 = 0x20;
    pub const DEPTH: u32 = 0x40;
}

/// `D3D11_TEXTURE2D_DESC1`, which begins with `D3D11_TEXTURE2D_DESC`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct TextureDescription {
    pub width: u32,
    pub height: u32,
    pub levels: u32,
    pub layers: u32,
    pub format: Format,
    pub samples: u32,
    pub quality: u32,
    pub usage: u32,
    pub bind: u32,
    pub cpu_access: u32,
    pub misc: u32,
    pub layout: u32,
}

impl TextureDescription {
    /// One level of a texture.
    pub fn new([width, height]: [u32; 2], layers: u32, format: Format, bind: u32) -> Self {
        let (samples, quality) = (1, 0);
        let (levels, usage, cpu_access, misc, layout) = (1, 0, 0, 0, 0);
        Self {
            width,
            height,
            levels,
            layers,
            format,
            samples,
            quality,
            usage,
            bind,
            cpu_access,
            misc,
            layout,
        }
    }
}

#[repr(C)]
struct BufferDescription {
    size: u32,
    usage: u32,
    bind: u32,
    cpu_access: u32,
    misc: u32,
    stride: u32,
}

/// `D3D11_SUBRESOURCE_DATA`, and `D3D11_MAPPED_SUBRESOURCE`.
#[repr(C)]
struct Data {
    address: *const c_void,
    row: u32,
    slice: u32,
}

#[repr(C)]
struct InputElement {
    semantic: *const std::ffi::c_char,
    index: u32,
    format: Format,
    slot: u32,
    offset: u32,
    class: u32,
    step: u32,
}

#[repr(C)]
struct DepthState {
    test: i32,
    write: u32,
    compare: u32,
    stencil: i32,
    masks: [u8; 2],
    faces: [[u32; 4]; 2],
}

#[repr(C)]
struct RasterizerState {
    fill: u32,
    cull: u32,
    counter_clockwise: i32,
    bias: i32,
    bias_clamp: f32,
    slope_bias: f32,
    clip: i32,
    scissor: i32,
    multisample: i32,
    lines: i32,
}

#[repr(C)]
struct Viewport {
    left: f32,
    top: f32,
    width: f32,
    height: f32,
    depth: [f32; 2],
}

/// The device.
pub struct Device {
    object: Object,
    _library: libloading::Library,
}

type D3D11CreateDevice =
    unsafe extern "C" fn(Raw, u32, Raw, u32, *const u32, u32, u32, *mut Raw, *mut u32, *mut Raw) -> HResult;

const HARDWARE: u32 = 1;
const LEVEL_11_0: u32 = 0xb000;
const SDK_VERSION: u32 = 7;

impl Device {
    /// Creates a device on the first adapter, and its immediate context.
    pub fn create() -> Result<(Self, Context)> {
        // SAFETY: the library of this name is taken to be DXVK's, whose function is of this type.
        let (library, create) = unsafe {
            let library = libloading::Library::new("libdxvk_d3d11.so.0").context("DXVK")?;
            let create = *library.get::<D3D11CreateDevice>(b"D3D11CreateDevice\0")?;
            (library, create)
        };
        let (mut device, mut context, mut level) = (ptr::null_mut(), ptr::null_mut(), 0);
        let none = ptr::null_mut;
        // SAFETY: all pointers are live for the call.
        let result = unsafe {
            create(
                none(),
                HARDWARE,
                none(),
                0,
                &LEVEL_11_0,
                1,
                SDK_VERSION,
                &mut device,
                &mut level,
                &mut context,
            )
        };
        check(result, "D3D11CreateDevice")?;
        // SAFETY: references that the call has returned.
        unsafe {
            Ok((
                Self { object: Object::from_raw(device, "D3D11CreateDevice")?, _library: library },
                Context(Object::from_raw(context, "D3D11CreateDevice")?),
            ))
        }
    }

    /// Another interface of it.
    pub fn query(&self, id: &Guid, name: &str) -> Result<Object> {
        self.object.query(id, name)
    }

    /// A buffer with bytes that never change.
    pub fn buffer(&self, bytes: &[u8], bind: u32) -> Result<Object> {
        let (immutable, size) = (1, u32::try_from(bytes.len())?);
        let data = Data { address: bytes.as_ptr().cast(), row: 0, slice: 0 };
        self.new_buffer(
            &BufferDescription { size, usage: immutable, bind, cpu_access: 0, misc: 0, stride: 0 },
            Some(&data),
        )
    }

    /// A constant buffer for [`Context::write`].
    pub fn constants(&self, size: usize) -> Result<Object> {
        let (dynamic, writes) = (2, 0x10000);
        let size = u32::try_from(size)?.next_multiple_of(16);
        let bind = bind::CONSTANTS;
        self.new_buffer(
            &BufferDescription { size, usage: dynamic, bind, cpu_access: writes, misc: 0, stride: 0 },
            None,
        )
    }

    fn new_buffer(&self, description: &BufferDescription, data: Option<&Data>) -> Result<Object> {
        let data = data.map_or(ptr::null(), ptr::from_ref);
        made(
            "CreateBuffer",
            |made| call!(&self.object, 3, description => *const BufferDescription, data => *const Data, made => *mut Raw; HResult),
        )
    }

    /// A texture.
    pub fn texture(&self, description: &TextureDescription) -> Result<Object> {
        made(
            "CreateTexture2D",
            |made| call!(&self.object, 5, description => *const TextureDescription, ptr::null() => *const Data, made => *mut Raw; HResult),
        )
    }

    /// A view of a whole texture for shaders.
    pub fn shader_view(&self, texture: &Object) -> Result<Object> {
        self.view("CreateShaderResourceView", 7, texture)
    }

    /// A view of a whole texture as a render target.
    pub fn target_view(&self, texture: &Object) -> Result<Object> {
        self.view("CreateRenderTargetView", 9, texture)
    }

    /// A view of a whole texture as a depth buffer.
    pub fn depth_view(&self, texture: &Object) -> Result<Object> {
        self.view("CreateDepthStencilView", 10, texture)
    }

    fn view(&self, call: &'static str, slot: usize, texture: &Object) -> Result<Object> {
        made(
            call,
            |made| call!(&self.object, slot, texture.raw() => Raw, ptr::null() => *const c_void, made => *mut Raw; HResult),
        )
    }

    /// The layout of vertices with a position and a normal.
    pub fn input_layout(&self, vertex_code: &[u8]) -> Result<Object> {
        let element = |semantic: &'static std::ffi::CStr, offset| {
            let (format, slot, class, step) = (Format::Rgb32Float, 0, 0, 0);
            InputElement { semantic: semantic.as_ptr(), index: 0, format, slot, offset, class, step }
        };
        let elements = [element(c"POSITION", 0), element(c"NORMAL", 12)];
        made("CreateInputLayout", |made| {
            call!(&self.object, 11, elements.as_ptr() => *const InputElement, 2 => u32, vertex_code.as_ptr() => *const u8,
                vertex_code.len() => usize, made => *mut Raw; HResult)
        })
    }

    /// A vertex shader.
    pub fn vertex_shader(&self, code: &[u8]) -> Result<Object> {
        self.shader("CreateVertexShader", 12, code)
    }

    /// A pixel shader.
    pub fn pixel_shader(&self, code: &[u8]) -> Result<Object> {
        self.shader("CreatePixelShader", 15, code)
    }

    fn shader(&self, call: &'static str, slot: usize, code: &[u8]) -> Result<Object> {
        made(
            call,
            |made| call!(&self.object, slot, code.as_ptr() => *const u8, code.len() => usize, ptr::null_mut() => Raw, made => *mut Raw; HResult),
        )
    }

    /// Depth test and writes with reversed depth.
    pub fn reversed_depth(&self) -> Result<Object> {
        let (all, greater_equal, keep, always) = (1, 7, 1, 8);
        let faces = [[keep, keep, keep, always]; 2];
        let state =
            DepthState { test: 1, write: all, compare: greater_equal, stencil: 0, masks: [0xff; 2], faces };
        made(
            "CreateDepthStencilState",
            |made| call!(&self.object, 21, &state => *const DepthState, made => *mut Raw; HResult),
        )
    }

    /// Solid triangles with both sides visible.
    pub fn both_sides(&self) -> Result<Object> {
        let (solid, none) = (3, 1);
        let (bias, bias_clamp, slope_bias) = (0, 0.0, 0.0);
        let state = RasterizerState {
            fill: solid,
            cull: none,
            counter_clockwise: 0,
            bias,
            bias_clamp,
            slope_bias,
            clip: 1,
            scissor: 0,
            multisample: 1,
            lines: 0,
        };
        made(
            "CreateRasterizerState",
            |made| call!(&self.object, 22, &state => *const RasterizerState, made => *mut Raw; HResult),
        )
    }

    /// A context that records a list of commands.
    pub fn deferred_context(&self) -> Result<Context> {
        made("CreateDeferredContext", |made| call!(&self.object, 27, 0 => u32, made => *mut Raw; HResult))
            .map(Context)
    }
}

/// The object that a call returns through a pointer.
fn made(call: &'static str, make: impl FnOnce(*mut Raw) -> HResult) -> Result<Object> {
    let mut made = ptr::null_mut();
    check(make(&mut made), call)?;
    // SAFETY: a reference that the call has returned.
    unsafe { Object::from_raw(made, call) }
}

/// A context, immediate or deferred.
pub struct Context(Object);

impl Context {
    /// Replaces the content of a constant buffer.
    pub fn write(&self, buffer: &Object, bytes: &[u8]) -> Result<()> {
        let discard = 4;
        let mut mapped = Data { address: ptr::null(), row: 0, slice: 0 };
        let result = call!(&self.0, 14, buffer.raw() => Raw, 0 => u32, discard => u32, 0 => u32, &mut mapped => *mut Data; HResult);
        check(result, "Map")?;
        // SAFETY: the buffer was made for at least so many bytes, and is mapped for writing.
        unsafe { ptr::copy_nonoverlapping(bytes.as_ptr(), mapped.address.cast_mut().cast(), bytes.len()) };
        call!(&self.0, 15, buffer.raw() => Raw, 0 => u32; ());
        Ok(())
    }

    /// Binds constant buffers from slot 0 for both stages.
    pub fn constants(&self, buffers: &[&Object]) {
        let raw: Vec<Raw> = buffers.iter().map(|buffer| buffer.raw()).collect();
        let count = raw.len() as u32;
        call!(&self.0, 7, 0 => u32, count => u32, raw.as_ptr() => *const Raw; ());
        call!(&self.0, 16, 0 => u32, count => u32, raw.as_ptr() => *const Raw; ());
    }

    /// Binds both shaders.
    pub fn shaders(&self, vertex: &Object, pixel: &Object) {
        call!(&self.0, 11, vertex.raw() => Raw, ptr::null() => *const Raw, 0 => u32; ());
        call!(&self.0, 9, pixel.raw() => Raw, ptr::null() => *const Raw, 0 => u32; ());
    }

    /// Binds a texture at slot 0 of the pixel shader, or none.
    pub fn texture(&self, view: Option<&Object>) {
        let raw = view.map_or(ptr::null_mut(), Object::raw);
        call!(&self.0, 8, 0 => u32, 1 => u32, &raw => *const Raw; ());
    }

    /// Binds vertices of 24 bytes, as triangles.
    pub fn vertices(&self, layout: Option<&Object>, buffer: &Object) {
        let (raw, stride, offset, triangles) = (buffer.raw(), 24, 0, 4);
        call!(&self.0, 17, layout.map_or(ptr::null_mut(), Object::raw) => Raw; ());
        call!(&self.0, 18, 0 => u32, 1 => u32, &raw => *const Raw, &stride => *const u32, &offset => *const u32; ());
        call!(&self.0, 24, triangles => u32; ());
    }

    /// Draws vertices of so many instances.
    pub fn draw(&self, vertices: u32, instances: u32) {
        if instances == 1 {
            call!(&self.0, 13, vertices => u32, 0 => u32; ());
        } else {
            call!(&self.0, 21, vertices => u32, instances => u32, 0 => u32, 0 => u32; ());
        }
    }

    /// Binds targets.
    pub fn targets(&self, color: Option<&Object>, depth: Option<&Object>) {
        let raw: Vec<Raw> = color.iter().map(|view| view.raw()).collect();
        let depth = depth.map_or(ptr::null_mut(), Object::raw);
        call!(&self.0, 33, raw.len() as u32 => u32, raw.as_ptr() => *const Raw, depth => Raw; ());
    }

    /// Binds states of depth and rasterizer.
    pub fn states(&self, depth: Option<&Object>, rasterizer: &Object) {
        call!(&self.0, 36, depth.map_or(ptr::null_mut(), Object::raw) => Raw, 0 => u32; ());
        call!(&self.0, 43, rasterizer.raw() => Raw; ());
    }

    /// Sets the viewport: left edge and size.
    pub fn viewport(&self, left: u32, [width, height]: [u32; 2]) {
        let [left, width, height] = [left, width, height].map(|side| side as f32);
        let viewport = Viewport { left, top: 0.0, width, height, depth: [0.0, 1.0] };
        call!(&self.0, 44, 1 => u32, &viewport => *const Viewport; ());
    }

    /// Clears a render target.
    pub fn clear(&self, view: &Object, color: [f32; 4]) {
        call!(&self.0, 50, view.raw() => Raw, color.as_ptr() => *const f32; ());
    }

    /// Clears a depth buffer, and its stencil.
    pub fn clear_depth(&self, view: &Object, depth: f32) {
        let both = 3;
        call!(&self.0, 53, view.raw() => Raw, both => u32, depth => f32, 0 => u8; ());
    }

    /// Resolves a multisampled texture.
    pub fn resolve(&self, to: &Object, from: &Object, format: Format) {
        call!(&self.0, 57, to.raw() => Raw, 0 => u32, from.raw() => Raw, 0 => u32, format => Format; ());
    }

    /// Copies a texture.
    pub fn copy(&self, to: &Object, from: &Object) {
        call!(&self.0, 47, to.raw() => Raw, from.raw() => Raw; ());
    }

    /// The list of the recorded commands.
    pub fn finish(&self) -> Result<Object> {
        made("FinishCommandList", |made| call!(&self.0, 114, 0 => i32, made => *mut Raw; HResult))
    }

    /// Executes a list, on the immediate context.
    pub fn execute(&self, list: &Object) {
        call!(&self.0, 58, list.raw() => Raw, 0 => i32; ());
    }

    /// Unbinds everything.
    pub fn reset(&self) {
        call!(&self.0, 110; ());
    }
}
