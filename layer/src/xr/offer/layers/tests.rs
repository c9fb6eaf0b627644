use super::*;
use crate::inputs::gaze::direction;
use glam::{Quat, Vec3};
use std::mem::zeroed;
use std::ptr;
use xr::Handle;

const SPACE_OF_GAZE: u64 = 1;
const SPACE_OF_HEAD: u64 = 2;

/// A pose with these angles to the left and upwards, degrees, and that position, metres.
fn pose([left, up]: [f32; 2], position: Vec3) -> xr::Posef {
    let turn = Quat::from_euler(glam::EulerRot::YXZ, left.to_radians(), up.to_radians(), 0.0);
    let [x, y, z, w] = turn.to_array();
    xr::Posef {
        orientation: xr::Quaternionf { x, y, z, w },
        position: xr::Vector3f { x: position.x, y: position.y, z: position.z },
    }
}

/// Pose of the layer in the space of the gaze: beside its ray, turned against it.
fn in_gaze() -> xr::Posef {
    pose([10.0, 3.0], Vec3::new(0.2, -0.1, -2.0))
}

/// The gaze in the space of the head.
fn gaze() -> Pose {
    Pose::of_gaze(direction([25.0, -8.0]))
}

/// The same layer, of all types with a pose of their own, as the runtime gets it.
fn placed<T: Copy>(layer: T, change: impl Fn(&mut T)) -> T {
    let mut layer = layer;
    change(&mut layer);
    // SAFETY: each caller passes a composition layer, which begins with the header, with views that outlive the call.
    unsafe {
        let header = &*ptr::from_ref(&layer).cast::<xr::CompositionLayerBaseHeader>();
        let mut copy = moved(header, xr::Space::from_raw(SPACE_OF_HEAD), gaze()).unwrap();
        *copy.header().cast::<T>()
    }
}

/// The pose is the layer's in the gaze, whose pose in the head is known.
fn assert_in_head(found: xr::Posef, space: xr::Space) {
    assert_eq!(space.into_raw(), SPACE_OF_HEAD);
    let looking = Quat::from_euler(glam::EulerRot::YXZ, 25f32.to_radians(), -8f32.to_radians(), 0.0);
    let (seen, layer) = (Pose::read(&found).unwrap(), Pose::read(&in_gaze()).unwrap());
    let at = |pose: Pose, point: Vec3| {
        let xr::Posef { orientation, position } = pose.written();
        let turn = Quat::from_xyzw(orientation.x, orientation.y, orientation.z, orientation.w);
        turn * point + Vec3::new(position.x, position.y, position.z)
    };
    for point in [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(-1.0, 2.0, 0.5)] {
        let expected = looking * at(layer, point);
        assert!(
            at(seen, point).abs_diff_eq(expected, 1e-5),
            "{point}: {} instead of {expected}",
            at(seen, point)
        );
    }
}

macro_rules! layer {
    ($structure:ident) => {{
        // SAFETY: the structure is plain data, for which all zero is a valid value.
        let mut layer: xr::$structure = unsafe { zeroed() };
        layer.ty = xr::$structure::TYPE;
        layer.layer_flags = xr::CompositionLayerFlags::BLEND_TEXTURE_SOURCE_ALPHA;
        layer.space = xr::Space::from_raw(SPACE_OF_GAZE);
        layer
    }};
}

macro_rules! is_placed_with_its_pose {
    ($($name:ident: $structure:ident { $($member:ident = $value:expr),* };)*) => {$(
        #[test]
        fn $name() {
            let copy = placed(layer!($structure), |layer| {
                layer.pose = in_gaze();
                layer.sub_image.image_array_index = 3;
                layer.eye_visibility = xr::EyeVisibility::RIGHT;
                $(layer.$member = $value;)*
            });
            assert_in_head(copy.pose, copy.space);
            assert_eq!(copy.sub_image.image_array_index, 3);
            assert_eq!(copy.eye_visibility, xr::EyeVisibility::RIGHT);
            assert_eq!(copy.layer_flags, xr::CompositionLayerFlags::BLEND_TEXTURE_SOURCE_ALPHA);
            $(assert_eq!(copy.$member, $value);)*
        }
    )*};
}

is_placed_with_its_pose! {
    a_quad_is_placed_by_the_gaze: CompositionLayerQuad { };
    a_cylinder_is_placed_by_the_gaze:
        CompositionLayerCylinderKHR { radius = 2.5, central_angle = 1.0, aspect_ratio = 1.5 };
    an_equirect_is_placed_by_the_gaze: CompositionLayerEquirectKHR { radius = 4.0 };
    an_equirect2_is_placed_by_the_gaze: CompositionLayerEquirect2KHR {
        radius = 0.0,
        central_horizontal_angle = 3.0,
        upper_vertical_angle = 1.2,
        lower_vertical_angle = -1.1
    };
}

/// Its faces are infinitely far away: it has no position.
#[test]
fn a_cube_is_turned_by_the_gaze() {
    let copy = placed(layer!(CompositionLayerCubeKHR), |layer| {
        layer.orientation = in_gaze().orientation;
        layer.image_array_index = 2;
        layer.eye_visibility = xr::EyeVisibility::LEFT;
    });
    let turned = pose([25.0, -8.0], Vec3::ZERO);
    let both = Pose::read(&turned).unwrap().then(Pose::read(&in_gaze()).unwrap()).written().orientation;
    let apart = [
        copy.orientation.x - both.x,
        copy.orientation.y - both.y,
        copy.orientation.z - both.z,
        copy.orientation.w - both.w,
    ];
    assert!(apart.iter().all(|by| by.abs() < 1e-6), "{apart:?}");
    assert_eq!((copy.space.into_raw(), copy.image_array_index), (SPACE_OF_HEAD, 2));
    assert_eq!(copy.eye_visibility, xr::EyeVisibility::LEFT);
}

#[test]
fn each_view_of_a_projection_is_placed_by_the_gaze() {
    // SAFETY: the structure is plain data, for which all zero is a valid value.
    let mut view: xr::CompositionLayerProjectionView = unsafe { zeroed() };
    view.ty = xr::CompositionLayerProjectionView::TYPE;
    let views = [in_gaze(), pose([0.0; 2], Vec3::ZERO)]
        .map(|pose| xr::CompositionLayerProjectionView { pose, ..view });
    let mut layer = layer!(CompositionLayerProjection);
    (layer.view_count, layer.views) = (2, views.as_ptr());
    // SAFETY: the layer is valid with its views, which outlive the copy.
    unsafe {
        let header = &*ptr::from_ref(&layer).cast::<xr::CompositionLayerBaseHeader>();
        let mut copy = moved(header, xr::Space::from_raw(SPACE_OF_HEAD), gaze()).unwrap();
        let copy = *copy.header().cast::<xr::CompositionLayerProjection>();
        assert_ne!(copy.views, views.as_ptr(), "the application's own stay as they are");
        assert_in_head((*copy.views).pose, copy.space);
        let second = (*copy.views.add(1)).pose;
        assert_eq!(second.orientation, gaze().written().orientation);
    }
}

#[test]
fn a_layer_of_an_unknown_type_stays_as_it_is() {
    let mut layer = layer!(CompositionLayerQuad);
    layer.ty = xr::StructureType::from_raw(1_000_999_000);
    // SAFETY: the structure begins with the header, and nothing else of it is read.
    let copy = unsafe {
        let header = &*ptr::from_ref(&layer).cast::<xr::CompositionLayerBaseHeader>();
        moved(header, xr::Space::from_raw(SPACE_OF_HEAD), gaze())
    };
    assert!(copy.is_none());
}

/// The runtime is to return its own error for it.
#[test]
fn a_pose_that_is_none_stays_so() {
    let none = xr::Posef { orientation: xr::Quaternionf { x: 0.0, y: 0.0, z: 0.0, w: 0.0 }, ..in_gaze() };
    let copy = placed(layer!(CompositionLayerCylinderKHR), |layer| layer.pose = none);
    assert_eq!((copy.pose.orientation.w, copy.pose.position.z), (0.0, -2.0));
}
