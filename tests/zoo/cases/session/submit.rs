//! xrEndFrame: composition layers as the cases name them, and as OpenXR wants them.

use super::{Frame, IDENTITY, Session};
use crate::failure::{Failure, succeeded};
use openxr_sys as xr;
use parafovea_zoo::cases::pattern::{Figure, Rect};
use parafovea_zoo::cases::report::Picture;
use std::ptr::{from_ref, null};

/// Distance from the viewer to a quad at the centre of the view, metres.
const QUAD_DISTANCE: f32 = 1.0;

/// A rectangle of one array layer of a swapchain, and the pattern of the last release there.
#[derive(Clone, Copy)]
pub struct SubImage {
    pub swapchain: xr::Swapchain,
    pub rect: Rect,
    pub array_layer: u32,
    pub figure: Option<Figure>,
}

/// A composition layer.
pub enum Layer {
    /// Both views.
    Projection([SubImage; 2]),
    /// Both views, blended by their alpha.
    Blended([SubImage; 2]),
    /// Both views, each with its depth.
    WithDepth([SubImage; 2], [SubImage; 2]),
    /// A quad ahead of the viewer, half a metre high.
    Quad(SubImage),
    /// The same, ahead of the origin of a space.
    QuadIn(xr::Space, SubImage),
    /// Both views, each in its pose in a space.
    ProjectionIn(xr::Space, [SubImage; 2]),
}

impl Session<'_> {
    /// Ends a frame that has to be accepted.
    pub fn submit(&self, frame: &Frame, layers: &[Layer]) -> Result<(), Failure> {
        succeeded("xrEndFrame", self.end_frame(frame, layers)).map(drop)
    }

    /// Ends a frame and returns the runtime's result.
    pub fn end_frame(&self, frame: &Frame, layers: &[Layer]) -> xr::Result {
        let depths: Vec<_> = layers.iter().map(Layer::depth_infos).collect();
        let views: Vec<_> =
            layers.iter().zip(&depths).map(|(layer, depths)| layer.views(frame, depths)).collect();
        let structures: Vec<_> =
            layers.iter().zip(&views).map(|(layer, views)| layer.structure(self.space, views)).collect();
        let pointers: Vec<_> = structures.iter().map(Structure::pointer).collect();
        let info = xr::FrameEndInfo {
            ty: xr::FrameEndInfo::TYPE,
            next: null(),
            display_time: frame.display_time,
            environment_blend_mode: xr::EnvironmentBlendMode::OPAQUE,
            layer_count: pointers.len() as u32,
            layers: pointers.as_ptr(),
        };
        // SAFETY: the session is live; `depths`, `views` and `structures`, which the layers point to, outlive
        // the call. A handle in them may be invalid on purpose: the runtime has to report it.
        let result = unsafe { (self.app.xr.functions.end_frame)(self.handle, &info) };
        if result == xr::Result::SUCCESS {
            self.note_pictures(layers);
        }
        result
    }

    fn note_pictures(&self, layers: &[Layer]) {
        let mut report = self.app.report();
        let frame = report.frames;
        report.frames = frame + 1;
        for (layer_index, layer) in layers.iter().enumerate() {
            for (view_index, image) in layer.images().iter().enumerate() {
                report.pictures.extend(image.figure.map(|figure| Picture {
                    frame,
                    layer: layer_index as u32,
                    view: view_index as u32,
                    figure,
                }));
            }
        }
    }
}

impl SubImage {
    fn raw(&self) -> xr::SwapchainSubImage {
        let Rect { x, y, width, height } = self.rect;
        xr::SwapchainSubImage {
            swapchain: self.swapchain,
            image_rect: xr::Rect2Di {
                offset: xr::Offset2Di { x: x as i32, y: y as i32 },
                extent: xr::Extent2Di { width: width as i32, height: height as i32 },
            },
            image_array_index: self.array_layer,
        }
    }
}

/// The OpenXR structure of a layer.
enum Structure {
    Projection(xr::CompositionLayerProjection),
    Quad(xr::CompositionLayerQuad),
}

impl Structure {
    fn pointer(&self) -> *const xr::CompositionLayerBaseHeader {
        match self {
            Self::Projection(layer) => from_ref(layer).cast(),
            Self::Quad(layer) => from_ref(layer).cast(),
        }
    }
}

impl Layer {
    fn images(&self) -> &[SubImage] {
        match self {
            Self::Projection(views)
            | Self::ProjectionIn(_, views)
            | Self::Blended(views)
            | Self::WithDepth(views, _) => views,
            Self::Quad(image) | Self::QuadIn(_, image) => std::slice::from_ref(image),
        }
    }

    fn depth_infos(&self) -> Vec<xr::CompositionLayerDepthInfoKHR> {
        let Self::WithDepth(_, depths) = self else {
            return Vec::new();
        };
        depths
            .iter()
            .map(|image| xr::CompositionLayerDepthInfoKHR {
                ty: xr::CompositionLayerDepthInfoKHR::TYPE,
                next: null(),
                sub_image: image.raw(),
                min_depth: 0.0,
                max_depth: 1.0,
                near_z: 0.1,
                far_z: 100.0,
            })
            .collect()
    }

    fn views(
        &self,
        frame: &Frame,
        depths: &[xr::CompositionLayerDepthInfoKHR],
    ) -> Vec<xr::CompositionLayerProjectionView> {
        if matches!(self, Self::Quad(_) | Self::QuadIn(..)) {
            return Vec::new();
        }
        self.images()
            .iter()
            .zip(&frame.views)
            .enumerate()
            .map(|(index, (image, view))| xr::CompositionLayerProjectionView {
                ty: xr::CompositionLayerProjectionView::TYPE,
                next: depths.get(index).map_or(null(), |depth| from_ref(depth).cast()),
                pose: view.pose,
                fov: view.fov,
                sub_image: image.raw(),
            })
            .collect()
    }

    fn structure(&self, space: xr::Space, views: &[xr::CompositionLayerProjectionView]) -> Structure {
        let layer_flags = match self {
            Self::Blended(_) => xr::CompositionLayerFlags::BLEND_TEXTURE_SOURCE_ALPHA,
            Self::Projection(_)
            | Self::ProjectionIn(..)
            | Self::WithDepth(..)
            | Self::Quad(_)
            | Self::QuadIn(..) => xr::CompositionLayerFlags::EMPTY,
        };
        let space = match self {
            Self::QuadIn(space, _) | Self::ProjectionIn(space, _) => *space,
            _ => space,
        };
        match self {
            Self::Projection(_) | Self::ProjectionIn(..) | Self::Blended(_) | Self::WithDepth(..) => {
                Structure::Projection(xr::CompositionLayerProjection {
                    ty: xr::CompositionLayerProjection::TYPE,
                    next: null(),
                    layer_flags,
                    space,
                    view_count: views.len() as u32,
                    views: views.as_ptr(),
                })
            }
            Self::Quad(image) | Self::QuadIn(_, image) => Structure::Quad(quad(image, space)),
        }
    }
}

fn quad(image: &SubImage, space: xr::Space) -> xr::CompositionLayerQuad {
    let mut pose = IDENTITY;
    pose.position.z = -QUAD_DISTANCE;
    xr::CompositionLayerQuad {
        ty: xr::CompositionLayerQuad::TYPE,
        next: null(),
        layer_flags: xr::CompositionLayerFlags::EMPTY,
        space,
        eye_visibility: xr::EyeVisibility::BOTH,
        sub_image: image.raw(),
        pose,
        size: xr::Extent2Df { width: 0.5 * image.rect.width as f32 / image.rect.height as f32, height: 0.5 },
    }
}
