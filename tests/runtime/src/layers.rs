//! Composition layers: read and checked, as the rest of the runtime uses them.

mod recorded;

use crate::abi::pointers::Valid;
use crate::abi::structures::LayerStructure;
use crate::fault::{Fault, section};
use crate::pose::Pose;
use crate::runtime::Runtime;
use crate::system::VIEWS;
use ash::vk;
use openxr_sys as xr;
pub(crate) use recorded::recorded_pose;

/// Most layers of a frame: the number that every runtime supports (`XR_MIN_COMPOSITION_LAYERS_SUPPORTED`).
pub(crate) const MAX_LAYERS: u32 = xr::MIN_COMPOSITION_LAYERS_SUPPORTED as u32;

/// A layer to show.
#[derive(Clone, Debug)]
pub(crate) enum Layer {
    Projection { flags: xr::CompositionLayerFlags, space: xr::Space, views: Box<[ProjectionView; VIEWS]> },
    Quad(Quad),
}

/// A quad layer.
#[derive(Clone, Debug)]
pub(crate) struct Quad {
    pub flags: xr::CompositionLayerFlags,
    pub space: xr::Space,
    pub eyes: xr::EyeVisibility,
    pub pose: Pose,
    /// Width and height in metres.
    pub size: [f32; 2],
    pub image: SubImage,
}

/// A view of a projection layer.
#[derive(Clone, Debug)]
pub(crate) struct ProjectionView {
    pub pose: Pose,
    pub fov: xr::Fovf,
    pub image: SubImage,
    pub depth: Option<Depth>,
}

/// Depth of a view.
#[derive(Clone, Debug)]
pub(crate) struct Depth {
    pub image: SubImage,
    pub range: [f32; 2],
    pub near_far: [f32; 2],
}

/// A part of the image of a swapchain that was released last.
#[derive(Clone, Debug)]
pub(crate) struct SubImage {
    pub swapchain: xr::Swapchain,
    pub format: vk::Format,
    pub index: u32,
    pub rect: xr::Rect2Di,
    pub array_layer: u32,
}

/// Checks the layers of a frame.
pub(crate) fn read(
    runtime: &mut Runtime,
    session: xr::Session,
    layers: &[LayerStructure<'_>],
) -> Result<Vec<Layer>, Fault> {
    layers.iter().enumerate().map(|(index, layer)| read_layer(runtime, session, index, layer)).collect()
}

fn read_layer(
    runtime: &Runtime,
    session: xr::Session,
    index: usize,
    layer: &LayerStructure<'_>,
) -> Result<Layer, Fault> {
    match layer {
        LayerStructure::Projection(layer) => {
            check_space(runtime, session, layer.space)?;
            let views = layer.checked_views()?;
            let views: &[_; VIEWS] = views.as_slice().try_into().map_err(|_| {
                let message = format!("layers[{index}]: viewCount is {}, not {VIEWS}", layer.view_count);
                Fault::validation(section::COMPOSITION, message)
            })?;
            let read = |view: usize| {
                read_view(runtime, session, &format!("layers[{index}].views[{view}]"), &views[view])
            };
            Ok(Layer::Projection {
                flags: layer.layer_flags,
                space: layer.space,
                views: Box::new([read(0)?, read(1)?]),
            })
        }
        LayerStructure::Quad(layer) => {
            read_quad(runtime, session, &format!("layers[{index}]"), layer).map(Layer::Quad)
        }
    }
}

fn read_quad(
    runtime: &Runtime,
    session: xr::Session,
    name: &str,
    quad: &Valid<'_, xr::CompositionLayerQuad>,
) -> Result<Quad, Fault> {
    check_space(runtime, session, quad.space)?;
    let xr::Extent2Df { width, height } = quad.size;
    if !(width > 0.0 && height > 0.0 && width.is_finite() && height.is_finite()) {
        return Err(Fault::validation(
            section::COMPOSITION,
            format!("{name}: size is {width} by {height} metres"),
        ));
    }
    if !(0..=2).contains(&quad.eye_visibility.into_raw()) {
        let message = format!("{name}: eyeVisibility is {:?}", quad.eye_visibility);
        return Err(Fault::validation(section::COMPOSITION, message));
    }
    Ok(Quad {
        flags: quad.layer_flags,
        space: quad.space,
        eyes: quad.eye_visibility,
        pose: Pose::checked(&format!("{name}.pose"), &quad.pose)?,
        size: [width, height],
        image: read_sub_image(runtime, session, name, &quad.sub_image, Content::Colour)?,
    })
}

fn read_view(
    runtime: &Runtime,
    session: xr::Session,
    name: &str,
    view: &Valid<'_, xr::CompositionLayerProjectionView>,
) -> Result<ProjectionView, Fault> {
    let (_, instance) = runtime.session_and_instance(session)?;
    let depth = view.extension::<xr::CompositionLayerDepthInfoKHR>();
    let depth = depth.filter(|_| instance.has("XR_KHR_composition_layer_depth"));
    check_fov(name, &view.fov)?;
    Ok(ProjectionView {
        pose: Pose::checked(&format!("{name}.pose"), &view.pose)?,
        fov: view.fov,
        image: read_sub_image(runtime, session, name, &view.sub_image, Content::Colour)?,
        depth: depth
            .map(|depth| read_depth(runtime, session, &format!("{name}.depth"), &depth))
            .transpose()?,
    })
}

fn read_depth(
    runtime: &Runtime,
    session: xr::Session,
    name: &str,
    depth: &xr::CompositionLayerDepthInfoKHR,
) -> Result<Depth, Fault> {
    let range = [depth.min_depth, depth.max_depth];
    if !(0.0 <= range[0] && range[0] < range[1] && range[1] <= 1.0) {
        let message =
            format!("{name}: minDepth {} and maxDepth {} are no range within 0 to 1", range[0], range[1]);
        return Err(Fault::validation(section::DEPTH, message));
    }
    let near_far = [depth.near_z, depth.far_z];
    if near_far.iter().any(|z| !(0.0..=f32::INFINITY).contains(z)) || near_far[0] == near_far[1] {
        let message = format!("{name}: nearZ {} and farZ {} are no distances", near_far[0], near_far[1]);
        return Err(Fault::validation(section::DEPTH, message));
    }
    let image = read_sub_image(runtime, session, name, &depth.sub_image, Content::Depth)?;
    Ok(Depth { image, range, near_far })
}

fn check_space(runtime: &Runtime, session: xr::Session, space: xr::Space) -> Result<(), Fault> {
    if runtime.spaces.get(space)?.session == session {
        return Ok(());
    }
    Err(Fault::validation(section::COMPOSITION, "the layer's space belongs to another session"))
}

/// Fields of view are finite, each angle within a right angle, and not empty.
pub(crate) fn check_fov(name: &str, fov: &xr::Fovf) -> Result<(), Fault> {
    let angles = [fov.angle_left, fov.angle_right, fov.angle_up, fov.angle_down];
    let right = std::f32::consts::FRAC_PI_2;
    if angles.iter().any(|angle| !(-right < *angle && *angle < right))
        || fov.angle_left == fov.angle_right
        || fov.angle_up == fov.angle_down
    {
        let message = format!("{name}: fov is {angles:?} (left, right, up, down), which is no field of view");
        return Err(Fault::validation(section::VIEWS, message));
    }
    Ok(())
}

/// A layer's requirements on a swapchain.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Content {
    Colour,
    Depth,
}

fn read_sub_image(
    runtime: &Runtime,
    session: xr::Session,
    name: &str,
    part: &xr::SwapchainSubImage,
    content: Content,
) -> Result<SubImage, Fault> {
    let swapchain = runtime.swapchains.get(part.swapchain)?;
    let shape = &swapchain.shape;
    if swapchain.session != session {
        return Err(Fault::validation(
            section::COMPOSITION,
            format!("{name}: the swapchain is of another session"),
        ));
    }
    if (content == Content::Depth) != shape.is_depth() {
        let message = format!("{name}: {:?} is no {content:?} format", shape.format);
        return Err(Fault::validation(section::COMPOSITION, message));
    }
    let xr::Rect2Di { offset, extent } = part.image_rect;
    let inside = |offset: i32, extent: i32, size: u32| {
        offset >= 0 && extent > 0 && i64::from(offset) + i64::from(extent) <= i64::from(size)
    };
    let (width, height) = (shape.extent.width, shape.extent.height);
    if !(inside(offset.x, extent.width, width) && inside(offset.y, extent.height, height)) {
        let rect = [offset.x, offset.y, extent.width, extent.height];
        let message = format!("{name}: imageRect {rect:?} is empty or not within {width} by {height}");
        return Err(Fault::new(xr::Result::ERROR_SWAPCHAIN_RECT_INVALID, section::SUBMISSION, message));
    }
    if part.image_array_index >= shape.array_layers {
        let (index, layers) = (part.image_array_index, shape.array_layers);
        let message = format!("{name}: imageArrayIndex is {index}, arraySize {layers}");
        return Err(Fault::validation(section::COMPOSITION, message));
    }
    let index = swapchain.ring.shown().ok_or_else(|| {
        let message = format!("{name}: no image of the swapchain was ever released");
        Fault::new(xr::Result::ERROR_LAYER_INVALID, section::SUBMISSION, message)
    })?;
    let (swapchain, array_layer) = (part.swapchain, part.image_array_index);
    Ok(SubImage { swapchain, format: shape.format, index, rect: part.image_rect, array_layer })
}
