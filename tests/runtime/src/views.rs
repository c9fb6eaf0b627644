//! Poses and fields of view of the views.

use crate::abi::pointers::{In, List, Out};
use crate::fault::{Fault, section};
use crate::pose::Pose;
use crate::runtime::{Runtime, call};
use crate::scenario::Answer;
use crate::{scenario, script, spaces, system};
use glam::{Quat, Vec3};
use openxr_sys as xr;

/// The views' poses in the VIEW space.
pub(crate) fn pose(view: &scenario::View) -> Pose {
    Pose { orientation: Quat::from_array(view.orientation).normalize(), position: Vec3::from(view.position) }
}

/// A view's field of view, unless it is zoomed.
pub(crate) fn fov(view: &scenario::View) -> xr::Fovf {
    zoomed(view, 1.0)
}

fn zoomed(view: &scenario::View, scale: f32) -> xr::Fovf {
    let scenario::FovDegrees { left, right, up, down } = view.fov_deg;
    let angle = |degrees: f32| (degrees * scale).to_radians();
    xr::Fovf {
        angle_left: angle(left),
        angle_right: angle(right),
        angle_up: angle(up),
        angle_down: angle(down),
    }
}

/// `xrLocateViews`.
pub(crate) extern "system" fn locate(
    session: xr::Session,
    info: In<xr::ViewLocateInfo>,
    mut state: Out<xr::ViewState>,
    capacity: u32,
    count: Out<u32>,
    items: Out<xr::View>,
) -> xr::Result {
    call("xrLocateViews", |runtime| {
        let info = runtime.read(&info)?;
        let (mut views, flags) = located(runtime, session, &info)?;
        let flags = change(&mut views, flags, runtime.answer);
        runtime.sessions.get_mut(session)?.frames.views_located = Some(info.display_time.as_nanos());
        state.get()?.view_state_flags = flags;
        List { capacity, count, items }.fill_structures(
            "views",
            &views,
            |filled: &mut xr::View, (pose, fov)| {
                filled.pose = pose.to_xr();
                filled.fov = *fov;
            },
        )?;
        Ok(xr::Result::SUCCESS)
    })
}

/// Applies a fault of the scenario to views.
fn change(views: &mut [(Pose, xr::Fovf)], flags: xr::ViewStateFlags, answer: Answer) -> xr::ViewStateFlags {
    let all =
        |angle: f32| xr::Fovf { angle_left: -angle, angle_right: angle, angle_up: angle, angle_down: -angle };
    for (pose, fov) in views {
        match answer {
            Answer::Nan => {
                *pose = Pose { orientation: Quat::from_array([f32::NAN; 4]), position: Vec3::NAN };
            }
            Answer::ZeroFov => *fov = all(0.0),
            Answer::HugeFov => *fov = all(1.57),
            _ => {}
        }
    }
    if answer == Answer::Untracked { xr::ViewStateFlags::EMPTY } else { flags }
}

type Located = (Vec<(Pose, xr::Fovf)>, xr::ViewStateFlags);

fn located(runtime: &Runtime, session: xr::Session, info: &xr::ViewLocateInfo) -> Result<Located, Fault> {
    runtime.sessions.get(session)?;
    system::check_view_configuration(info.view_configuration_type)?;
    let time = spaces::check_time(info.display_time, section::VIEWS)?;
    if runtime.spaces.get(info.space)?.session != session {
        return Err(Fault::validation(section::VIEWS, "the space belongs to another session"));
    }
    let head = spaces::head(runtime, time);
    let base = spaces::in_local(runtime, info.space, time)?;
    let (base, flags) = match base {
        Some(base) => (
            base,
            xr::ViewStateFlags::ORIENTATION_VALID
                | xr::ViewStateFlags::POSITION_VALID
                | xr::ViewStateFlags::ORIENTATION_TRACKED
                | xr::ViewStateFlags::POSITION_TRACKED,
        ),
        None => (head, xr::ViewStateFlags::EMPTY),
    };
    let zoom = script::zoom_at(&runtime.scenario.zoom, runtime.clock.scenario_seconds(time));
    let place = |view: &scenario::View| (base.inverse().then(head).then(pose(view)), zoomed(view, zoom));
    Ok((runtime.scenario.views.iter().map(place).collect(), flags))
}
