//! What a frame shows: its composition layers, as far as they name swapchains.

use crate::abi::pnext::Structure;
use openxr_sys as xr;

/// A composition layer.
pub enum Shown<'a> {
    /// The views of the eyes.
    Projection(Projection<'a>),
    /// A rectangle of a swapchain, on a surface of its own.
    Flat(&'a xr::SwapchainSubImage),
    /// A swapchain whose images are cubes.
    Cube(xr::Swapchain),
}

impl Shown<'_> {
    /// The swapchains that it names.
    pub fn swapchains(&self) -> impl Iterator<Item = xr::Swapchain> {
        let views = match self {
            Shown::Projection(layer) => layer.views,
            Shown::Flat(_) | Shown::Cube(_) => &[],
        };
        let other = match self {
            Shown::Projection(_) => None,
            Shown::Flat(image) => Some(image.swapchain),
            Shown::Cube(swapchain) => Some(*swapchain),
        };
        views.iter().map(|view| view.sub_image.swapchain).chain(other)
    }
}

/// A projection layer.
pub struct Projection<'a> {
    /// The space of the views' poses.
    pub space: xr::Space,
    /// The views.
    pub views: &'a [xr::CompositionLayerProjectionView],
}

impl Projection<'_> {
    /// Whether a view shows that swapchain.
    pub fn shows(&self, swapchain: xr::Swapchain) -> bool {
        self.views.iter().any(|view| view.sub_image.swapchain == swapchain)
    }
}

/// The layers of a frame. Those that show no swapchain, or are of a type that is not known here, are left out;
/// so are malformed ones, which the runtime refuses.
///
/// # Safety
///
/// `info` and what it points to are valid, as `xrEndFrame` demands.
pub unsafe fn of(info: &xr::FrameEndInfo) -> impl Iterator<Item = Shown<'_>> {
    let count = if info.layers.is_null() { 0 } else { info.layer_count as usize };
    // SAFETY: the caller vouches for the array and for each pointer in it.
    (0..count).filter_map(move |at| unsafe { shown((*info.layers.add(at)).as_ref()?) })
}

/// One layer.
///
/// # Safety
///
/// The layer is valid, and of the type that it says.
unsafe fn shown(layer: &xr::CompositionLayerBaseHeader) -> Option<Shown<'_>> {
    // SAFETY: the caller vouches for the layer; a projection layer has as many views as it says.
    unsafe {
        if let Some(layer) = cast::<xr::CompositionLayerProjection>(layer) {
            let views = std::ptr::NonNull::new(layer.views.cast_mut())?;
            let views = std::slice::from_raw_parts(views.as_ptr(), layer.view_count as usize);
            return Some(Shown::Projection(Projection { space: layer.space, views }));
        }
        let quad = || cast::<xr::CompositionLayerQuad>(layer).map(|layer| &layer.sub_image);
        let cylinder = || cast::<xr::CompositionLayerCylinderKHR>(layer).map(|layer| &layer.sub_image);
        let equirect = || cast::<xr::CompositionLayerEquirectKHR>(layer).map(|layer| &layer.sub_image);
        let equirect2 = || cast::<xr::CompositionLayerEquirect2KHR>(layer).map(|layer| &layer.sub_image);
        if let Some(layer) = cast::<xr::CompositionLayerCubeKHR>(layer) {
            return Some(Shown::Cube(layer.swapchain));
        }
        quad().or_else(cylinder).or_else(equirect).or_else(equirect2).map(Shown::Flat)
    }
}

/// The layer as a `T`, if it says that it is one.
///
/// # Safety
///
/// The layer is valid, and of the type that it says.
unsafe fn cast<T: Structure>(layer: &xr::CompositionLayerBaseHeader) -> Option<&T> {
    // SAFETY: the caller vouches for it, and `Structure` for the type behind the number.
    (layer.ty.into_raw() == T::number()).then(|| unsafe { &*std::ptr::from_ref(layer).cast::<T>() })
}
