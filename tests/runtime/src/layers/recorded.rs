//! Layers as the record has them.

use super::{Depth, Layer, ProjectionView, SubImage};
use crate::pose::Pose;
use crate::record;
use crate::swapchain::format_name;
use openxr_sys as xr;
use openxr_sys::Handle;

impl Layer {
    /// This layer for the record.
    pub fn recorded(&self) -> record::Layer {
        match self {
            Self::Projection { flags, space, views } => record::Layer::Projection {
                flags: flags.into_raw(),
                space: space.into_raw(),
                views: views.iter().map(recorded_view).collect(),
            },
            Self::Quad(quad) => record::Layer::Quad {
                flags: quad.flags.into_raw(),
                space: quad.space.into_raw(),
                eyes: match quad.eyes {
                    xr::EyeVisibility::LEFT => "left",
                    xr::EyeVisibility::RIGHT => "right",
                    _ => "both",
                }
                .to_owned(),
                pose: recorded_pose(quad.pose),
                size: quad.size,
                image: recorded_image(&quad.image),
            },
        }
    }
}

fn recorded_view(view: &ProjectionView) -> record::ProjectionView {
    let xr::Fovf { angle_left: left, angle_right: right, angle_up: up, angle_down: down } = view.fov;
    record::ProjectionView {
        pose: recorded_pose(view.pose),
        fov: record::Fov { left, right, up, down },
        image: recorded_image(&view.image),
        depth: view.depth.as_ref().map(recorded_depth),
    }
}

fn recorded_depth(depth: &Depth) -> record::Depth {
    let finite = |z: f32| z.is_finite().then_some(z);
    record::Depth {
        image: recorded_image(&depth.image),
        min_depth: depth.range[0],
        max_depth: depth.range[1],
        near_z: finite(depth.near_far[0]),
        far_z: finite(depth.near_far[1]),
    }
}

fn recorded_image(image: &SubImage) -> record::SubImage {
    let xr::Rect2Di { offset, extent } = image.rect;
    record::SubImage {
        swapchain: image.swapchain.into_raw(),
        image: image.index,
        format: format_name(image.format),
        rect: [offset.x, offset.y, extent.width, extent.height],
        array_layer: image.array_layer,
    }
}

/// A pose for the record.
pub(crate) fn recorded_pose(pose: Pose) -> record::Pose {
    record::Pose { position: pose.position.to_array(), orientation: pose.orientation.to_array() }
}
