//! The scene on the device: a room with cubes, drawn for each eye.

use crate::com::Object;
use crate::compiler::Compiler;
use crate::d3d11::{Context, Device, Format, TextureDescription, bind};
use crate::look::Look;
use anyhow::{Context as _, Result};
use glam::{Mat4, Quat, Vec3, Vec4};

const SOURCE: &str = include_str!("scene.hlsl");

/// Vertices of a cube.
const CUBE: u32 = 36;

/// Cubes in the room.
const CUBES: u32 = 48;

/// Constants of a frame, as the shaders declare them.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Frame {
    view_projection: [Mat4; 2],
    eye: [u32; 4],
}

/// Constants of a draw, as the shaders declare them.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Model {
    model: Mat4,
    colour: Vec4,
}

/// The scene's objects.
pub struct Scene {
    look: Look,
    size: [u32; 2],
    vertex: Object,
    pixel: Object,
    layout: Object,
    vertices: Object,
    frame: Object,
    model: Object,
    reversed: Object,
    rasterizer: Object,
    screen: Option<Screen>,
    /// The scene's own target, for all looks with one.
    target: Option<Target>,
    depth: Object,
    deferred: Option<Context>,
}

/// The pass over the whole screen.
struct Screen {
    vertex: Object,
    pixel: Object,
}

/// A target of the scene's own.
struct Target {
    texture: Object,
    view: Object,
    /// Single samples, where it has several.
    resolved: Option<Object>,
    /// Of the texture with single samples.
    read: Object,
}

impl Scene {
    /// Makes everything for eyes of this size.
    pub fn new(device: &Device, look: Look, size: [u32; 2]) -> Result<Self> {
        let compiler = Compiler::load()?;
        let defined: &[_] = if look == Look::Instanced { &[c"INSTANCED"] } else { &[] };
        let code = |entry, profile| compiler.compile(SOURCE, entry, profile, defined);
        let vertex_code = code(c"scene_vertex", c"vs_5_0")?;
        let properties = look.properties();
        let target = properties.target.map(|format| Target::new(device, size, format, properties.samples));
        let is_mapped = matches!(look, Look::ToneMapped | Look::Multisampled | Look::DeferredContext);
        let screen = is_mapped.then(|| -> Result<Screen> {
            Ok(Screen {
                vertex: device.vertex_shader(&code(c"screen_vertex", c"vs_5_0")?)?,
                pixel: device.pixel_shader(&code(c"tone_pixel", c"ps_5_0")?)?,
            })
        });
        let wide = if look == Look::DoubleWide { [2 * size[0], size[1]] } else { size };
        let depth = TextureDescription {
            samples: properties.samples,
            ..TextureDescription::new(wide, properties.layers, properties.depth, bind::DEPTH)
        };
        let depth = device.depth_view(&device.texture(&depth)?)?;
        let deferred = (look == Look::DeferredContext).then(|| device.deferred_context());
        Ok(Self {
            look,
            size,
            vertex: device.vertex_shader(&vertex_code)?,
            pixel: device.pixel_shader(&code(c"scene_pixel", c"ps_5_0")?)?,
            layout: device.input_layout(&vertex_code)?,
            vertices: device.buffer(bytemuck::cast_slice(&cube()), bind::VERTICES)?,
            frame: device.constants(size_of::<Frame>())?,
            model: device.constants(size_of::<Model>())?,
            reversed: device.reversed_depth()?,
            rasterizer: device.both_sides()?,
            screen: screen.transpose()?,
            target: target.transpose()?,
            depth,
            deferred: deferred.transpose()?,
        })
    }

    /// Draws the views of frame `index` into textures of the swapchains: of each eye, or one of both.
    pub fn draw(
        &self,
        context: &Context,
        index: u64,
        views: [Mat4; 2],
        images: &[(&Object, &Object)],
    ) -> Result<()> {
        if self.look == Look::Instanced || self.look == Look::DoubleWide {
            let [(_, view)] = images else { anyhow::bail!("one swapchain for both eyes") };
            context.clear(view, [0.02, 0.03, 0.05, 1.0]);
            context.clear_depth(&self.depth, 0.0);
            context.targets(Some(view), Some(&self.depth));
            if self.look == Look::Instanced {
                context.viewport(0, self.size);
                self.draw_room(context, index, views, 0, 2)?;
            } else {
                for eye in 0..2 {
                    context.viewport(eye * self.size[0], self.size);
                    self.draw_room(context, index, views, eye, 1)?;
                }
            }
        } else {
            for (eye, (texture, view)) in (0..).zip(images) {
                self.draw_eye(context, index, views, eye, (texture, view))?;
            }
        }
        context.reset();
        Ok(())
    }

    fn draw_eye(
        &self,
        context: &Context,
        index: u64,
        views: [Mat4; 2],
        eye: u32,
        (texture, view): (&Object, &Object),
    ) -> Result<()> {
        let recording = self.deferred.as_ref().unwrap_or(context);
        let target = self.target.as_ref().map_or(view, |target| &target.view);
        recording.targets(Some(target), Some(&self.depth));
        recording.clear(target, [0.02, 0.03, 0.05, 1.0]);
        recording.clear_depth(&self.depth, 0.0);
        recording.viewport(0, self.size);
        self.draw_room(recording, index, views, eye, 1)?;
        if self.deferred.is_some() {
            context.execute(&recording.finish()?);
        }
        let Some(target) = &self.target else { return Ok(()) };
        context.targets(None, None);
        if let Some(resolved) = &target.resolved {
            context.resolve(resolved, &target.texture, Format::Rgba16Float);
        }
        let Some(screen) = &self.screen else {
            context.copy(texture, &target.texture);
            return Ok(());
        };
        context.targets(Some(view), None);
        context.viewport(0, self.size);
        context.states(None, &self.rasterizer);
        context.vertices(None, &self.vertices);
        context.shaders(&screen.vertex, &screen.pixel);
        context.texture(Some(&target.read));
        context.draw(3, 1);
        context.texture(None);
        Ok(())
    }

    /// Draws the room and its cubes, a draw each, with constants written before each, as engines do.
    fn draw_room(
        &self,
        context: &Context,
        index: u64,
        view_projection: [Mat4; 2],
        eye: u32,
        instances: u32,
    ) -> Result<()> {
        context.write(&self.frame, bytemuck::bytes_of(&Frame { view_projection, eye: [eye; 4] }))?;
        context.shaders(&self.vertex, &self.pixel);
        context.vertices(Some(&self.layout), &self.vertices);
        context.states(Some(&self.reversed), &self.rasterizer);
        context.constants(&[&self.frame, &self.model]);
        let room = Mat4::from_scale_rotation_translation(Vec3::new(8.0, 4.0, 8.0), Quat::IDENTITY, Vec3::Y);
        let cubes = (0..CUBES).map(|number| cube_of(number, index));
        let models = std::iter::once((room, Vec3::new(0.6, 0.65, 0.7))).chain(cubes);
        for (model, colour) in models {
            let model = Model { model, colour: colour.extend(1.0) };
            context.write(&self.model, bytemuck::bytes_of(&model))?;
            context.draw(CUBE, instances);
        }
        Ok(())
    }
}

impl Target {
    fn new(device: &Device, size: [u32; 2], format: Format, samples: u32) -> Result<Self> {
        let plain = TextureDescription::new(size, 1, format, bind::TARGET | bind::SHADER);
        let texture = device.texture(&TextureDescription { samples, ..plain })?;
        let resolved = (samples > 1).then(|| device.texture(&plain)).transpose()?;
        let read = device.shader_view(resolved.as_ref().unwrap_or(&texture)).context("reading the target")?;
        Ok(Self { view: device.target_view(&texture)?, texture, resolved, read })
    }
}

/// Place and colour of a cube in a frame: on rings around the viewer, each turning slowly.
fn cube_of(number: u32, index: u64) -> (Mat4, Vec3) {
    let along = number as f32;
    let angle = along * 0.8 + index as f32 * 0.01;
    let distance = 1.5 + (number % 5) as f32;
    let place = Vec3::new(angle.cos() * distance, -1.0 + (number % 7) as f32 * 0.55, angle.sin() * distance);
    let turn = Quat::from_euler(glam::EulerRot::YXZ, angle * 1.7, along, 0.0);
    let model = Mat4::from_scale_rotation_translation(Vec3::splat(0.25), turn, place);
    let colour = Vec3::new((along * 1.3).sin(), (along * 2.1).sin(), (along * 0.7).cos()) * 0.4 + 0.6;
    (model, colour)
}

/// Positions and normals of a cube's triangles.
fn cube() -> Vec<[f32; 6]> {
    let sides = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let side = |normal: Vec3| {
        let right = normal.any_orthonormal_vector();
        let up = normal.cross(right);
        corners.map(|[x, y]| {
            let place = normal + right * x + up * y;
            [place.x, place.y, place.z, normal.x, normal.y, normal.z]
        })
    };
    sides.into_iter().flat_map(side).collect()
}
