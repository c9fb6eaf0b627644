//! `XR_KHR_visibility_mask`: the corners of each view are hidden, as lenses hide them.

use crate::abi::pointers::{Out, mask_lists};
use crate::fault::{Fault, section};
use crate::runtime::call;
use crate::{scenario, system, views};
use openxr_sys as xr;
use openxr_sys::VisibilityMaskTypeKHR;

/// Length of a hidden corner along each edge, as a share of the edge.
const CORNER: f32 = 0.15;

/// Vertices on the plane one metre in front of the view, and indices.
#[derive(Debug, PartialEq)]
struct Mesh {
    vertices: Vec<xr::Vector2f>,
    indices: Vec<u32>,
}

/// The mesh of a mask, counter-clockwise as the extension demands.
fn mesh(view: &scenario::View, ty: VisibilityMaskTypeKHR) -> Option<Mesh> {
    let fov = views::fov(view);
    let (left, right) = (fov.angle_left.tan(), fov.angle_right.tan());
    let (down, up) = (fov.angle_down.tan(), fov.angle_up.tan());
    let at = |x: f32, y: f32| xr::Vector2f { x: left + (right - left) * x, y: down + (up - down) * y };
    let (near, far) = (CORNER, 1.0 - CORNER);
    // The octagon that is visible, from the lower left, counter-clockwise.
    let octagon = [
        at(near, 0.0),
        at(far, 0.0),
        at(1.0, near),
        at(1.0, far),
        at(far, 1.0),
        at(near, 1.0),
        at(0.0, far),
        at(0.0, near),
    ];
    // The corners, from the lower right, counter-clockwise: 8 to 11.
    let corners = [at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0), at(0.0, 0.0)];
    let (vertices, indices) = match ty {
        VisibilityMaskTypeKHR::HIDDEN_TRIANGLE_MESH => {
            let vertices = octagon.into_iter().chain(corners).collect();
            (vertices, vec![1, 8, 2, 3, 9, 4, 5, 10, 6, 7, 11, 0])
        }
        VisibilityMaskTypeKHR::VISIBLE_TRIANGLE_MESH => {
            (octagon.to_vec(), (1..7).flat_map(|index| [0, index, index + 1]).collect())
        }
        VisibilityMaskTypeKHR::LINE_LOOP => (octagon.to_vec(), (0..8).collect()),
        _ => return None,
    };
    Some(Mesh { vertices, indices })
}

/// `xrGetVisibilityMaskKHR`.
pub(crate) extern "system" fn get(
    session: xr::Session,
    configuration: xr::ViewConfigurationType,
    view: u32,
    ty: VisibilityMaskTypeKHR,
    mut mask: Out<xr::VisibilityMaskKHR>,
) -> xr::Result {
    call("xrGetVisibilityMaskKHR", |runtime| {
        runtime.sessions.get(session)?;
        system::check_view_configuration(configuration)?;
        let found = runtime.scenario.views.get(view as usize).and_then(|view| mesh(view, ty));
        let mesh = found.ok_or_else(|| {
            let message = format!("viewIndex is {view}, visibilityMaskType {ty:?}: there is no such mask");
            Fault::validation(section::VISIBILITY_MASK, message)
        })?;
        let (vertices, indices) = mask_lists(mask.get()?);
        vertices.fill("vertices", &mesh.vertices)?;
        indices.fill("indices", &mesh.indices)?;
        Ok(xr::Result::SUCCESS)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn areas(mesh: &Mesh) -> Vec<f32> {
        let area = |triangle: &[u32]| {
            let [a, b, c] = [0, 1, 2].map(|corner| mesh.vertices[triangle[corner] as usize]);
            ((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)) / 2.0
        };
        mesh.indices.chunks_exact(3).map(area).collect()
    }

    #[test]
    fn the_hidden_and_the_visible_part_make_up_the_view_and_wind_counter_clockwise() {
        let view = scenario::View::default();
        let hidden = areas(&mesh(&view, VisibilityMaskTypeKHR::HIDDEN_TRIANGLE_MESH).unwrap());
        let visible = areas(&mesh(&view, VisibilityMaskTypeKHR::VISIBLE_TRIANGLE_MESH).unwrap());
        assert!(hidden.iter().chain(&visible).all(|area| *area > 0.0));
        let total: f32 = hidden.iter().chain(&visible).sum();
        assert!((total - 4.0).abs() < 1e-4, "{total}");
    }
}
