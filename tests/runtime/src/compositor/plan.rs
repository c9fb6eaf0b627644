//! Draws for an eye, and the shader's parameters: geometry, without a GPU.

use crate::fault::Fault;
use crate::layers::{Layer, ProjectionView, Quad, SubImage};
use crate::pose::Pose;
use crate::runtime::Runtime;
use crate::{scenario, spaces, views};
use ash::vk;
use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Quat};
use openxr_sys as xr;

/// One layer, drawn over the layers below.
pub(super) struct Draw<'a> {
    pub image: &'a SubImage,
    pub params: Params,
}

/// `Params` of `shaders/composite.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Params {
    /// Columns, each padded.
    rotation: [[f32; 4]; 3],
    origin: [f32; 3],
    mode: u32,
    target_edges: [f32; 4],
    source_edges: [f32; 4],
    rect: [i32; 4],
    quad_size: [f32; 2],
    target_size: [f32; 2],
    array_layer: i32,
    alpha: u32,
    encode: u32,
    padding: u32,
}

const MODE_EXACT: u32 = 0;
const MODE_PROJECTION: u32 = 1;
const MODE_QUAD: u32 = 2;

const ALPHA_OPAQUE: u32 = 0;
const ALPHA_PREMULTIPLIED: u32 = 1;
const ALPHA_STRAIGHT: u32 = 2;

impl Params {
    /// For the picture of a sub-image: its own codes. Formats that hold linear light are encoded as sRGB again, after
    /// the sampler decoded them or because they have no codes of 8 bits; UNORM values are codes already.
    pub fn picture(image: &SubImage) -> Self {
        let codes = matches!(
            image.format,
            vk::Format::R8G8B8A8_UNORM | vk::Format::B8G8R8A8_UNORM | vk::Format::A2B10G10R10_UNORM_PACK32
        );
        Self { encode: u32::from(!codes), ..Self::of(image) }
    }

    /// For the picture of an eye, which was composited in linear light.
    pub fn eye(extent: vk::Extent2D) -> Self {
        Self { rect: [0, 0, extent.width as i32, extent.height as i32], encode: 1, ..Self::default() }
    }

    fn of(image: &SubImage) -> Self {
        let xr::Rect2Di { offset, extent } = image.rect;
        Self {
            rect: [offset.x, offset.y, extent.width, extent.height],
            array_layer: image.array_layer as i32,
            ..Self::default()
        }
    }
}

/// An eye at the time of display.
struct Eye {
    /// In the LOCAL space.
    pose: Pose,
    fov: xr::Fovf,
    size: [u32; 2],
}

/// The draws of an eye, in order. Layers in a space that is not tracked are not seen.
pub(super) fn draws<'a>(
    runtime: &Runtime,
    eye: usize,
    time: i64,
    layers: &'a [Layer],
) -> Result<Vec<Draw<'a>>, Fault> {
    let view = &runtime.scenario.views[eye];
    let shown = shown_by(view, spaces::head(runtime, time));
    let mut draws = Vec::new();
    for layer in layers {
        let space = match layer {
            Layer::Projection { space, .. } => *space,
            Layer::Quad(quad) => quad.space,
        };
        let Some(space) = spaces::in_local(runtime, space, time)? else { continue };
        match layer {
            Layer::Projection { flags, views, .. } => {
                let params = projection(&shown, space, *flags, &views[eye]);
                draws.push(Draw { image: &views[eye].image, params });
            }
            Layer::Quad(quad) if is_seen_by(quad.eyes, eye) => {
                draws.push(Draw { image: &quad.image, params: quad_params(&shown, space, quad) });
            }
            Layer::Quad(_) => {}
        }
    }
    Ok(draws)
}

fn shown_by(view: &scenario::View, head: Pose) -> Eye {
    Eye { pose: head.then(views::pose(view)), fov: views::fov(view), size: [view.width, view.height] }
}

fn is_seen_by(eyes: xr::EyeVisibility, eye: usize) -> bool {
    match eyes {
        xr::EyeVisibility::LEFT => eye == 0,
        xr::EyeVisibility::RIGHT => eye == 1,
        _ => true,
    }
}

fn alpha(flags: xr::CompositionLayerFlags) -> u32 {
    if !flags.contains(xr::CompositionLayerFlags::BLEND_TEXTURE_SOURCE_ALPHA) {
        ALPHA_OPAQUE
    } else if flags.contains(xr::CompositionLayerFlags::UNPREMULTIPLIED_ALPHA) {
        ALPHA_STRAIGHT
    } else {
        ALPHA_PREMULTIPLIED
    }
}

fn edges(fov: &xr::Fovf) -> [f32; 4] {
    [fov.angle_left, fov.angle_right, fov.angle_up, fov.angle_down].map(f32::tan)
}

fn columns(rotation: Quat) -> [[f32; 4]; 3] {
    let Mat3 { x_axis, y_axis, z_axis } = Mat3::from_quat(rotation);
    [x_axis, y_axis, z_axis].map(|column| column.extend(0.0).to_array())
}

/// Tolerance within which views count as equal: less than a hundredth of a texel at 8192 texels.
const SAME: f32 = 1e-6;

fn projection(eye: &Eye, space: Pose, flags: xr::CompositionLayerFlags, view: &ProjectionView) -> Params {
    let source = space.then(view.pose);
    let rotation = source.orientation.conjugate() * eye.pose.orientation;
    let (source_edges, target_edges) = (edges(&view.fov), edges(&eye.fov));
    let params = Params::of(&view.image);
    let same_edges = source_edges.iter().zip(target_edges).all(|(a, b)| (a - b).abs() <= SAME);
    let same_size = params.rect[2..] == eye.size.map(|size| size as i32);
    let exact = same_edges && same_size && rotation.xyz().length() <= SAME;
    Params {
        rotation: columns(rotation),
        mode: if exact { MODE_EXACT } else { MODE_PROJECTION },
        target_edges,
        source_edges,
        target_size: eye.size.map(|size| size as f32),
        alpha: alpha(flags),
        ..params
    }
}

fn quad_params(eye: &Eye, space: Pose, quad: &Quad) -> Params {
    let seen = space.then(quad.pose).inverse().then(eye.pose);
    Params {
        rotation: columns(seen.orientation),
        origin: seen.position.to_array(),
        mode: MODE_QUAD,
        target_edges: edges(&eye.fov),
        quad_size: quad.size,
        target_size: eye.size.map(|size| size as f32),
        alpha: alpha(quad.flags),
        ..Params::of(&quad.image)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn image() -> SubImage {
        SubImage {
            swapchain: xr::Swapchain::default(),
            format: vk::Format::R8G8B8A8_SRGB,
            index: 0,
            rect: xr::Rect2Di {
                offset: xr::Offset2Di { x: 0, y: 0 },
                extent: xr::Extent2Di { width: 64, height: 64 },
            },
            array_layer: 0,
        }
    }

    fn submitted(pose: Pose) -> (Eye, ProjectionView) {
        let view = scenario::View { width: 64, height: 64, ..scenario::View::default() };
        let eye = shown_by(&view, Pose::IDENTITY);
        let fov = eye.fov;
        (eye, ProjectionView { pose, fov, image: image(), depth: None })
    }

    #[test]
    fn the_view_that_is_shown_is_copied_texel_by_texel_and_others_are_turned() {
        let flags = xr::CompositionLayerFlags::EMPTY;
        let mode = |pose| {
            let (eye, view) = submitted(pose);
            projection(&eye, Pose::IDENTITY, flags, &view).mode
        };
        assert_eq!(mode(Pose::IDENTITY), MODE_EXACT);
        let turned = Pose { orientation: Quat::from_rotation_y(0.001), position: Vec3::ZERO };
        assert_eq!(mode(turned), MODE_PROJECTION);
    }

    #[test]
    fn a_quad_two_metres_ahead_sees_the_eye_two_metres_in_front_of_it() {
        let (eye, _) = submitted(Pose::IDENTITY);
        let quad = Quad {
            flags: xr::CompositionLayerFlags::EMPTY,
            space: xr::Space::default(),
            eyes: xr::EyeVisibility::BOTH,
            pose: Pose { orientation: Quat::IDENTITY, position: Vec3::NEG_Z * 2.0 },
            size: [1.0, 1.0],
            image: image(),
        };
        assert_eq!(quad_params(&eye, Pose::IDENTITY, &quad).origin, [0.0, 0.0, 2.0]);
    }
}
