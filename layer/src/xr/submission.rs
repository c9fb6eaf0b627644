//! The submission of a frame: the composition layers of an `XrFrameEndInfo`, as far as they name swapchains, read once at xrEndFrame. It is
//! plain data, used without unsafe code.

use super::structures::extending;
use crate::abi::pnext::Structure;
use crate::inputs::gaze::rotation;
use crate::planner::View;
use glam::{Quat, Vec3};
use openxr_sys as xr;
use openxr_sys::CompositionLayerImageLayoutFlagsFB as FlipFlags;
use parafovea_core::geometry::{DepthRange, Fov};
use smallvec::SmallVec;
use std::ops::Range;
use std::slice;

/// Most views of a projection layer. No view configuration of OpenXR 1.1 has more than 4, and a runtime refuses a layer with another
/// number of views than the configuration's (XrCompositionLayerProjection).
const MOST_VIEWS: u32 = 16;

/// The submission of a frame. Allocates nothing for up to 16 layers with 8 projection views together; a runtime accepts 16 layers or more
/// (`XR_MIN_COMPOSITION_LAYERS_SUPPORTED`).
#[derive(Debug)]
pub struct Submission {
    /// Display time of the frame.
    pub time: xr::Time,
    /// Without layers of unknown types, or without swapchains; without malformed ones, which the runtime refuses.
    known: SmallVec<[Known; 16]>,
    views: SmallVec<[ProjectionView; 8]>,
    /// Number of layers, unknown ones too.
    layer_count: u32,
}

/// A layer as it is kept.
#[derive(Debug)]
enum Known {
    /// With the indices of its views.
    Projection(xr::Space, Range<usize>),
    Flat(xr::SwapchainSubImage),
    Cube(xr::Swapchain),
}

/// A composition layer.
#[derive(Clone, Copy, Debug)]
pub enum Layer<'a> {
    /// The views of the eyes.
    Projection(Projection<'a>),
    /// A rectangle of a swapchain, on a surface of its own: quad, cylinder, equirect.
    Flat(xr::SwapchainSubImage),
    /// A swapchain of cube images.
    Cube(xr::Swapchain),
}

/// A projection layer.
#[derive(Clone, Copy, Debug)]
pub struct Projection<'a> {
    /// The space of the views' poses.
    pub space: xr::Space,
    /// The views: left eye, right eye, and insets in both with quad views.
    pub views: &'a [ProjectionView],
}

/// A view of a projection layer.
#[derive(Clone, Copy, Debug)]
pub struct ProjectionView {
    /// From the view's space to that of the layer; `None` for an invalid quaternion.
    pub orientation: Option<Quat>,
    /// Position in the space of the layer, metres.
    pub position_m: Vec3,
    /// Field of view.
    pub fov: Fov,
    /// Swapchain, rectangle and array layer of its image.
    pub sub_image: xr::SwapchainSubImage,
    /// Its depth, if that is submitted (XR_KHR_composition_layer_depth).
    pub depth: Option<SubmittedDepth>,
}

/// The depth of a view.
#[derive(Clone, Copy, Debug)]
pub struct SubmittedDepth {
    /// Swapchain, rectangle and array layer of the depth image.
    pub sub_image: xr::SwapchainSubImage,
    /// Distances of its values.
    pub range: DepthRange,
}

impl Submission {
    /// Reads a submission.
    ///
    /// # Safety
    ///
    /// `info`, its layers, their views and all of their chains are valid, as `xrEndFrame` demands.
    pub unsafe fn read(info: &xr::FrameEndInfo) -> Self {
        let count = if info.layers.is_null() { 0 } else { info.layer_count };
        let mut submission = Self {
            time: info.display_time,
            known: SmallVec::new(),
            views: SmallVec::new(),
            layer_count: info.layer_count,
        };
        for index in 0..count as usize {
            // SAFETY: `xrEndFrame` demands so many pointers, each null here or to a valid layer.
            if let Some(layer) = unsafe { (*info.layers.add(index)).as_ref() } {
                // SAFETY: as above.
                unsafe { submission.read_layer(layer) };
            }
        }
        submission
    }

    /// Reads one layer.
    ///
    /// # Safety
    ///
    /// The layer is valid with its views and chains, and of the type in its header.
    unsafe fn read_layer(&mut self, layer: &xr::CompositionLayerBaseHeader) {
        // SAFETY: the layer is valid and of its type, as `# Safety` demands.
        let known = unsafe {
            if let Some(layer) = cast::<xr::CompositionLayerProjection>(layer) {
                return self.read_projection(layer);
            }
            let quad = || cast::<xr::CompositionLayerQuad>(layer).map(|layer| layer.sub_image);
            let cylinder = || cast::<xr::CompositionLayerCylinderKHR>(layer).map(|layer| layer.sub_image);
            let equirect = || cast::<xr::CompositionLayerEquirectKHR>(layer).map(|layer| layer.sub_image);
            let equirect2 = || cast::<xr::CompositionLayerEquirect2KHR>(layer).map(|layer| layer.sub_image);
            let cube =
                || cast::<xr::CompositionLayerCubeKHR>(layer).map(|layer| Known::Cube(layer.swapchain));
            let flat = quad().or_else(cylinder).or_else(equirect).or_else(equirect2);
            flat.map(Known::Flat).or_else(cube)
        };
        self.known.extend(known);
    }

    /// Reads a projection layer.
    ///
    /// # Safety
    ///
    /// The layer is valid, with `view_count` views, whose chains are valid.
    unsafe fn read_projection(&mut self, layer: &xr::CompositionLayerProjection) {
        if layer.views.is_null() || layer.view_count > MOST_VIEWS {
            return;
        }
        let first = self.views.len();
        // SAFETY: the layer has a valid chain and `view_count` valid views, as `# Safety` demands.
        unsafe {
            let is_flipped = is_flipped(layer);
            let views = slice::from_raw_parts(layer.views, layer.view_count as usize);
            self.views.extend(views.iter().map(|view| ProjectionView::read(view, is_flipped)));
        }
        self.known.push(Known::Projection(layer.space, first..self.views.len()));
    }

    /// The layers, from back to front.
    pub fn layers(&self) -> impl Iterator<Item = Layer<'_>> {
        self.known.iter().map(|known| match known {
            Known::Projection(space, views) => {
                Layer::Projection(Projection { space: *space, views: &self.views[views.clone()] })
            }
            Known::Flat(sub_image) => Layer::Flat(*sub_image),
            Known::Cube(swapchain) => Layer::Cube(*swapchain),
        })
    }

    /// The projection layers, from back to front.
    pub fn projections(&self) -> impl Iterator<Item = Projection<'_>> {
        self.layers().filter_map(|layer| match layer {
            Layer::Projection(layer) => Some(layer),
            Layer::Flat(_) | Layer::Cube(_) => None,
        })
    }

    /// The first projection layer, which is the scene; `None` without one.
    pub fn scene(&self) -> Option<Projection<'_>> {
        self.projections().next()
    }

    /// The projection layer; `None` if there are several: then it is not known which passes belong to which layer.
    pub fn only_projection(&self) -> Option<Projection<'_>> {
        let mut projections = self.projections();
        projections.next().filter(|_| projections.next().is_none())
    }

    /// Whether any layer shows a swapchain of `is_one`.
    pub fn shows_any(&self, is_one: impl Fn(xr::Swapchain) -> bool) -> bool {
        self.layers().any(|layer| match layer {
            Layer::Projection(layer) => layer.views.iter().any(|view| is_one(view.sub_image.swapchain)),
            Layer::Flat(sub_image) => is_one(sub_image.swapchain),
            Layer::Cube(swapchain) => is_one(swapchain),
        })
    }

    /// The smallest distance of the submitted depth, metres: nothing is nearer. `None` unless all layers are projections with depth in all
    /// of their views.
    ///
    /// Source: XR_KHR_composition_layer_depth: `nearZ` and `farZ` are the distances of `minDepth` and `maxDepth`, between which all of the
    /// depth is, in either order; either may be infinite.
    pub fn nearest_m(&self) -> Option<f32> {
        if self.projections().count() != self.layer_count as usize {
            return None;
        }
        let nearest_m = self.views.iter().try_fold(f32::INFINITY, |nearest, view| {
            let DepthRange { near_z, far_z, .. } = view.depth?.range;
            (near_z > 0.0 && far_z > 0.0).then(|| nearest.min(near_z).min(far_z))
        })?;
        nearest_m.is_finite().then_some(nearest_m)
    }
}

impl Projection<'_> {
    /// Whether a view shows that swapchain.
    pub fn shows(&self, swapchain: xr::Swapchain) -> bool {
        self.views.iter().any(|view| view.sub_image.swapchain == swapchain)
    }
}

impl ProjectionView {
    /// Reads a view. In a layer that `is_flipped` (XR_FB_composition_layer_image_layout) its last row is the top: the same picture as with up and
    /// down of its field of view exchanged.
    ///
    /// # Safety
    ///
    /// The chain of the view is valid.
    unsafe fn read(view: &xr::CompositionLayerProjectionView, is_flipped: bool) -> Self {
        let xr::Quaternionf { x, y, z, w } = view.pose.orientation;
        let xr::Vector3f { x: right, y: up, z: back } = view.pose.position;
        // SAFETY: the chain is valid, as `# Safety` demands.
        let depth = unsafe { extending(view.next) }.find::<xr::CompositionLayerDepthInfoKHR>();
        Self {
            orientation: rotation(x, y, z, w),
            position_m: Vec3::new(right, up, back),
            fov: if is_flipped { upside_down(fov(&view.fov)) } else { fov(&view.fov) },
            sub_image: view.sub_image,
            depth: depth.map(|info| SubmittedDepth {
                sub_image: info.sub_image,
                range: DepthRange {
                    min_depth: info.min_depth,
                    max_depth: info.max_depth,
                    near_z: info.near_z,
                    far_z: info.far_z,
                },
            }),
        }
    }

    /// Pose and field of view; `None` without an orientation.
    pub fn view(&self) -> Option<View> {
        Some(View { orientation: self.orientation?, position: self.position_m, fov: self.fov })
    }
}

/// A field of view of OpenXR.
pub fn fov(fov: &xr::Fovf) -> Fov {
    Fov { left: fov.angle_left, right: fov.angle_right, up: fov.angle_up, down: fov.angle_down }
}

/// A field of view with up and down exchanged.
pub fn upside_down(fov: Fov) -> Fov {
    Fov { up: fov.down, down: fov.up, ..fov }
}

/// Whether the last row of a layer's images is the top (XR_FB_composition_layer_image_layout).
///
/// # Safety
///
/// The chain of the layer is valid.
pub unsafe fn is_flipped(layer: &xr::CompositionLayerProjection) -> bool {
    // SAFETY: the chain is valid, as `# Safety` demands.
    let layout = unsafe { extending(layer.next) }.find::<xr::CompositionLayerImageLayoutFB>();
    layout.is_some_and(|layout| layout.flags.contains(FlipFlags::VERTICAL_FLIP))
}

/// The layer as a `T`; `None` if its header has another type.
///
/// # Safety
///
/// The layer is valid, and of the type in its header.
pub unsafe fn cast<T: Structure>(layer: &xr::CompositionLayerBaseHeader) -> Option<&T> {
    // SAFETY: the layer is valid and of its type, as `# Safety` demands; `Structure` guarantees that a structure of this number is a T.
    (layer.ty.into_raw() == T::number()).then(|| unsafe { &*std::ptr::from_ref(layer).cast::<T>() })
}

#[cfg(test)]
mod tests;
