//! Composition layers that reach the runtime in an amended copy.

use openxr_sys as xr;
use std::ptr;

/// A submission with copies in place of some of its layers.
pub struct AmendedLayers {
    info: xr::FrameEndInfo,
    /// The layers of `info`, the application's own and our copies.
    _layers: Vec<*const xr::CompositionLayerBaseHeader>,
    _copies: Vec<LayerCopy>,
}

/// A copy of a layer: boxed, so that it stays where it is.
pub enum LayerCopy {
    /// With its views.
    Projection(Box<xr::CompositionLayerProjection>, Vec<xr::CompositionLayerProjectionView>),
    /// A quad.
    Quad(Box<xr::CompositionLayerQuad>),
    /// Part of a cylinder.
    Cylinder(Box<xr::CompositionLayerCylinderKHR>),
    /// Part of a sphere (XR_KHR_composition_layer_equirect).
    Equirect(Box<xr::CompositionLayerEquirectKHR>),
    /// Part of a sphere (XR_KHR_composition_layer_equirect2).
    Equirect2(Box<xr::CompositionLayerEquirect2KHR>),
    /// A cube.
    Cube(Box<xr::CompositionLayerCubeKHR>),
}

impl AmendedLayers {
    /// The submission with the copies that `amend` makes of its layers; `None`, without an allocation, if it makes none. `amend` gets
    /// each layer once, from back to front.
    ///
    /// # Safety
    ///
    /// `info` is null or valid with its layers and their views, which all stay valid while the result is used.
    pub unsafe fn of(
        info: *const xr::FrameEndInfo,
        mut amend: impl FnMut(&xr::CompositionLayerBaseHeader) -> Option<LayerCopy>,
    ) -> Option<Self> {
        // SAFETY: `info` is null or valid, as `# Safety` demands, with an array of that many pointers.
        let (info, given) = unsafe {
            let info = info.as_ref().filter(|info| !info.layers.is_null())?;
            (*info, std::slice::from_raw_parts(info.layers, info.layer_count as usize))
        };
        let mut layers = Vec::new();
        let mut copies = Vec::new();
        for (index, layer) in given.iter().enumerate() {
            // SAFETY: each is null or a valid layer, as `# Safety` demands.
            let Some(mut copy) = (unsafe { layer.as_ref() }).and_then(&mut amend) else { continue };
            if layers.is_empty() {
                layers.extend_from_slice(given);
            }
            layers[index] = copy.header();
            copies.push(copy);
        }
        if copies.is_empty() {
            return None;
        }
        let info = xr::FrameEndInfo { layers: layers.as_ptr(), ..info };
        Some(Self { info, _layers: layers, _copies: copies })
    }

    /// The submission, for as long as `self` lives.
    pub fn info(&self) -> *const xr::FrameEndInfo {
        &raw const self.info
    }
}

impl LayerCopy {
    /// The layer, for as long as `self` lives.
    pub fn header(&mut self) -> *const xr::CompositionLayerBaseHeader {
        match self {
            Self::Projection(layer, views) => {
                layer.views = views.as_ptr();
                ptr::from_ref(&**layer).cast()
            }
            Self::Quad(layer) => ptr::from_ref(&**layer).cast(),
            Self::Cylinder(layer) => ptr::from_ref(&**layer).cast(),
            Self::Equirect(layer) => ptr::from_ref(&**layer).cast(),
            Self::Equirect2(layer) => ptr::from_ref(&**layer).cast(),
            Self::Cube(layer) => ptr::from_ref(&**layer).cast(),
        }
    }
}
