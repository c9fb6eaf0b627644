//! Applications that look at the gaze themselves.

use super::{Outcome, PLAYED, show};
use crate::app::App;
use crate::cases::stereo::Stereo;
use crate::controls::{Controls, GAZE, GAZE_POSE, LEFT_SELECT, SIMPLE, sync};
use crate::failure::{Failure, succeeded};
use crate::session::{IDENTITY, Layer, Session};
use crate::swapchain::{Shape, Swapchain};
use openxr_sys as xr;
use openxr_sys::Handle;
use parafovea_zoo::cases::pattern::Figure;
use std::ptr::{null, null_mut};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// In a set of the lowest priority.
pub fn looks_at_the_gaze_itself(app: &App) -> Outcome {
    looks(app, &[0])
}

/// In a set that takes the gaze from every set below.
pub fn looks_at_the_gaze_with_priority(app: &App) -> Outcome {
    looks(app, &[6])
}

/// In two sets, of which the upper one takes it from the lower one while it is active.
pub fn looks_at_the_gaze_in_two_sets(app: &App) -> Outcome {
    looks(app, &[2, 9])
}

fn looks(app: &App, priorities: &[u32]) -> Outcome {
    let controls = Controls::new(app);
    let (mut sets, mut gazes) = (Vec::new(), Vec::new());
    for priority in priorities {
        let set = controls.set(*priority)?;
        sets.push(set);
        gazes.push(controls.action(set, xr::ActionType::POSE_INPUT, &[])?);
    }
    let bindings: Vec<_> = gazes.iter().map(|gaze| (*gaze, GAZE_POSE)).collect();
    controls.suggest(GAZE, &bindings)?;
    let session = Session::start(app)?;
    controls.attach(&session, &sets);
    let mut spaces = Vec::new();
    for gaze in &gazes {
        spaces.push(controls.space(&session, *gaze)?);
    }
    show(&session, PLAYED, |frame| {
        controls.sync(&session, if frame.index % 4 == 3 { &sets[..1] } else { &sets });
        controls.profile(&session, "/user/eyes_ext")?;
        for (gaze, space) in gazes.iter().zip(&spaces) {
            if let Some(space) = space {
                controls.pose(&session, *gaze, *space, frame);
            }
        }
        Ok(())
    })?;
    session.finish()
}

/// The gaze as space and as base, in the spaces of the head and of the world, and the views in it; with all data of the extension.
pub fn finds_the_gaze_in_every_space(app: &App) -> Outcome {
    let controls = Controls::new(app);
    controls.trace(format!("the system has eye gaze: {}", has_eye_gaze(app)?));
    let set = controls.set(0)?;
    let gaze = controls.action(set, xr::ActionType::POSE_INPUT, &[])?;
    controls.suggest(GAZE, &[(gaze, GAZE_POSE)])?;
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    let Some(space) = controls.space(&session, gaze)? else { return session.finish() };
    let head = reference(&session, xr::ReferenceSpaceType::VIEW)?;
    show(&session, PLAYED, |frame| {
        controls.sync(&session, &[set]);
        controls.pose(&session, gaze, space, frame);
        controls.sources(&session, gaze)?;
        controls.name_of_gaze(&session)?;
        for (name, space, base) in [
            ("gaze in VIEW", space, head),
            ("gaze in LOCAL", space, session.space),
            ("VIEW in gaze", head, space),
            ("LOCAL in gaze", session.space, space),
            ("gaze in gaze", space, space),
        ] {
            controls.location(name, space, base, frame);
        }
        controls.views(&session, space, frame);
        Ok(())
    })?;
    // SAFETY: the space is live, and used no more.
    let result = unsafe { (app.xr.functions.destroy_space)(space) };
    controls.trace(format!("destroy the space: {result:?}"));
    session.finish()
}

/// The gaze and other spaces at once, in the spaces of the head, of the world and of the gaze: OpenXR 1.1.
pub fn finds_the_gaze_among_many_spaces(app: &App) -> Outcome {
    let looking = Looking::start(app)?;
    let Looking { controls, session, space, .. } = &looking;
    let head = reference(session, xr::ReferenceSpaceType::VIEW)?;
    show(session, PLAYED, |frame| {
        looking.sync();
        for base in [head, session.space, *space] {
            controls.locations(session, &[*space, head, session.space], base, frame)?;
        }
        Ok(())
    })?;
    looking.session.finish()
}

/// By turns a quad and the picture of the eyes where the eyes look.
pub fn shows_layers_in_the_gaze(app: &App) -> Outcome {
    let looking = Looking::start(app)?;
    let Looking { session, space, .. } = &looking;
    let (stereo, panel) = (Stereo::create(session)?, Swapchain::create(session, &Shape::srgb([64, 48]))?);
    session.frames(PLAYED, |frame| {
        looking.sync();
        if frame.index == 0 {
            stereo.paint(0)?;
            panel.paint(&[Figure::new(0, 2, panel.whole())])?;
        }
        let image = panel.sub_image(panel.whole());
        match frame.index % 2 {
            0 => session.submit(frame, &[Layer::Projection(stereo.images()), Layer::QuadIn(*space, image)]),
            _ => session.submit(frame, &[Layer::ProjectionIn(*space, stereo.images()), Layer::Quad(image)]),
        }
    })?;
    drop((stereo, panel));
    looking.session.finish()
}

/// Waits until the gaze is active, and then until it is not; notes its pose in the space of the head at both times.
pub fn sees_the_gaze_come_and_go(app: &App) -> Outcome {
    let looking = Looking::start(app)?;
    let Looking { controls, session, gaze, space, .. } = &looking;
    let head = reference(session, xr::ReferenceSpaceType::VIEW)?;
    let stereo = Stereo::create(session)?;
    stereo.paint(0)?;
    let begun = Instant::now();
    let (mut was_there, mut changes) = (false, 0);
    while changes < 2 && begun.elapsed() < LONGEST_WAIT {
        session.frames(1, |frame| {
            looking.sync();
            let is_there = controls.is_active(session, *gaze);
            if is_there != was_there {
                controls.location(if is_there { "come" } else { "gone" }, *space, head, frame);
                (was_there, changes) = (is_there, changes + 1);
            }
            session.submit(frame, &[Layer::Projection(stereo.images())])
        })?;
        sleep(Duration::from_millis(2));
    }
    drop(stereo);
    looking.session.finish()
}

/// For a user on a machine that does much else.
const LONGEST_WAIT: Duration = Duration::from_secs(100);

/// An application with one action, which has the gaze.
struct Looking<'a> {
    controls: Controls<'a>,
    session: Session<'a>,
    set: xr::ActionSet,
    gaze: xr::Action,
    space: xr::Space,
}

impl<'a> Looking<'a> {
    fn start(app: &'a App) -> Result<Self, Failure> {
        let controls = Controls::new(app);
        let set = controls.set(0)?;
        let gaze = controls.action(set, xr::ActionType::POSE_INPUT, &[])?;
        controls.suggest(GAZE, &[(gaze, GAZE_POSE)])?;
        let session = Session::start(app)?;
        controls.attach(&session, &[set]);
        let space = controls.space(&session, gaze)?;
        let space = space.ok_or_else(|| Failure::Unsupported("the gaze has no space".to_owned()))?;
        Ok(Self { controls, session, set, gaze, space })
    }

    fn sync(&self) {
        let active = xr::ActiveActionSet { action_set: self.set, subaction_path: xr::Path::NULL };
        sync(self.session.app, self.session.handle, &[active]);
    }
}

/// One action that the left hand and the eyes drive, distinguished by subaction paths.
pub fn tells_eyes_from_hands(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let users = [controls.path("/user/hand/left")?, controls.path("/user/eyes_ext")?];
    let set = controls.set(0)?;
    let aim = controls.action(set, xr::ActionType::POSE_INPUT, &users)?;
    controls.suggest(SIMPLE, &[(aim, "/user/hand/left/input/aim/pose")])?;
    controls.suggest(GAZE, &[(aim, GAZE_POSE)])?;
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    let spaces = users.map(|user| controls.space_of(&session, aim, user));
    show(&session, PLAYED, |frame| {
        // Now the one, then the other, then both.
        let active: &[xr::Path] = match frame.index % 3 {
            0 => &users[..1],
            1 => &users[1..],
            _ => &users,
        };
        controls.sync_paths(&session, set, active);
        for (user, space) in users.iter().zip(&spaces) {
            if let Ok(Some(space)) = space {
                controls.pose_of(&session, (aim, *user), *space, frame);
            }
        }
        Ok(())
    })?;
    session.finish()
}

/// Whether the system supports eye gaze, by its properties.
fn has_eye_gaze(app: &App) -> Result<bool, Failure> {
    let mut gaze = xr::SystemEyeGazeInteractionPropertiesEXT::out(null_mut());
    let mut properties = xr::SystemProperties::out(gaze.as_mut_ptr().cast());
    let xr = &app.xr;
    // SAFETY: the instance is live; the structures outlive the call.
    unsafe {
        (*gaze.as_mut_ptr()).supports_eye_gaze_interaction = xr::FALSE;
        let get = xr.functions.get_system_properties;
        succeeded("xrGetSystemProperties", get(xr.instance, xr.system, properties.as_mut_ptr()))?;
        Ok(gaze.assume_init().supports_eye_gaze_interaction.into())
    }
}

fn reference(session: &Session, kind: xr::ReferenceSpaceType) -> Result<xr::Space, Failure> {
    let info = xr::ReferenceSpaceCreateInfo {
        ty: xr::ReferenceSpaceCreateInfo::TYPE,
        next: null(),
        reference_space_type: kind,
        pose_in_reference_space: IDENTITY,
    };
    let mut space = xr::Space::NULL;
    let create = session.app.xr.functions.create_reference_space;
    // SAFETY: the session is live; the structures outlive the call.
    succeeded("xrCreateReferenceSpace", unsafe { create(session.handle, &info, &mut space) })?;
    Ok(space)
}

/// The profile of eye gaze without its extension: the suggestion is refused.
pub fn suggests_gaze_without_its_extension(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let set = controls.set(0)?;
    let gaze = controls.action(set, xr::ActionType::POSE_INPUT, &[])?;
    let button = controls.action(set, xr::ActionType::BOOLEAN_INPUT, &[])?;
    controls.suggest(GAZE, &[(gaze, GAZE_POSE)])?;
    controls.suggest(SIMPLE, &[(button, LEFT_SELECT)])?;
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    let space = controls.space(&session, gaze)?;
    show(&session, PLAYED, |frame| {
        controls.sync(&session, &[set]);
        controls.look(&session, button, xr::Path::NULL);
        if let Some(space) = space {
            controls.pose(&session, gaze, space, frame);
        }
        Ok(())
    })?;
    session.finish()
}

/// New bindings for eye gaze in each session, each of which replaces those before.
pub fn suggests_gaze_in_each_session(app: &App) -> Outcome {
    let controls = Controls::new(app);
    for _ in 0..3 {
        let set = controls.set(3)?;
        let gaze = controls.action(set, xr::ActionType::POSE_INPUT, &[])?;
        controls.suggest(GAZE, &[(gaze, GAZE_POSE)])?;
        let session = Session::start(app)?;
        controls.attach(&session, &[set]);
        let space = controls.space(&session, gaze)?;
        show(&session, PLAYED, |frame| {
            controls.sync(&session, &[set]);
            if let Some(space) = space {
                controls.pose(&session, gaze, space, frame);
            }
            Ok(())
        })?;
        session.finish()?;
    }
    Ok(())
}
