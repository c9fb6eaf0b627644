//! The gaze in use: focus, state, profile, sources, names and poses.

use super::{Calls, EYES, NOBODYS, Outcome, beside, is_same, moved};
use crate::app::App;
use crate::cases::stereo::Stereo;
use crate::controls::{GAZE, GAZE_POSE, LEFT_SELECT, SIMPLE};
use crate::failure::Failure;
use crate::session::{Frame, IDENTITY, Layer, Session};
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ffi::c_void;
use std::ptr::null_mut;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Frames until a session has the focus, and more.
const UNTIL_FOCUS: u32 = 30;

/// An answer of xrLocateSpace.
struct Located {
    result: xr::Result,
    flags: xr::SpaceLocationFlags,
    pose: xr::Posef,
    sampled_ns: i64,
}

impl Located {
    fn is_valid(&self) -> bool {
        let valid = xr::SpaceLocationFlags::ORIENTATION_VALID | xr::SpaceLocationFlags::POSITION_VALID;
        self.flags.contains(valid)
    }
}

/// xrLocateSpace with the time of the sample and velocities in the chain, in one order or the other.
fn locate(app: &App, space: xr::Space, base: xr::Space, time: xr::Time, is_time_first: bool) -> Located {
    let mut sample = xr::EyeGazeSampleTimeEXT {
        ty: xr::EyeGazeSampleTimeEXT::TYPE,
        next: null_mut(),
        time: xr::Time::from_nanos(-1),
    };
    let mut velocity = xr::SpaceVelocity {
        ty: xr::SpaceVelocity::TYPE,
        next: null_mut(),
        velocity_flags: xr::SpaceVelocityFlags::EMPTY,
        linear_velocity: xr::Vector3f::default(),
        angular_velocity: xr::Vector3f::default(),
    };
    let first: *mut c_void = if is_time_first {
        sample.next = (&raw mut velocity).cast();
        (&raw mut sample).cast()
    } else {
        velocity.next = (&raw mut sample).cast();
        (&raw mut velocity).cast()
    };
    let mut location = xr::SpaceLocation {
        ty: xr::SpaceLocation::TYPE,
        next: first,
        location_flags: xr::SpaceLocationFlags::EMPTY,
        pose: IDENTITY,
    };
    // SAFETY: the spaces are live; the structures outlive the call.
    let result = unsafe { (app.xr.functions.locate_space)(space, base, time, &mut location) };
    Located {
        result,
        flags: location.location_flags,
        pose: location.pose,
        sampled_ns: sample.time.as_nanos(),
    }
}

/// Sections: XR_EXT_eye_gaze_interaction, "Eye gaze input"; Input, "Current Interaction Profile", "Reading Input Action State", "Input Action State
/// Synchronization"; Spaces, "Action Spaces", "Locating Spaces".
pub fn conforms_in_states(app: &App) -> Outcome {
    let calls = Calls::new(app);
    let (set, gaze) = calls.gaze()?;
    let (eyes, pose, no_path) = (calls.path(EYES)?, calls.path(GAZE_POSE)?, xr::Path::NULL);
    // Beside it, an action of the eyes by name, and a hand's button: profiles do not exclude each other.
    let of_eyes = calls.controls.action(set, xr::ActionType::POSE_INPUT, &[eyes])?;
    let button = calls.controls.action(set, xr::ActionType::BOOLEAN_INPUT, &[])?;
    let suggested = calls.suggest(&[(gaze, pose), (of_eyes, pose)])?;
    calls.expect("Eye gaze input", "suggest for two actions", suggested, xr::Result::SUCCESS);
    calls.controls.suggest(SIMPLE, &[(button, LEFT_SELECT)])?;
    let session = Session::start(app)?;
    let handle = session.handle;
    calls.expect("Action Sets", "attach", calls.attach(handle, &[set]), xr::Result::SUCCESS);
    let space = |action, user, at| {
        let (result, space) = calls.create_space(handle, (action, user), at);
        calls.expect("Action Spaces", "a space of the gaze", result, xr::Result::SUCCESS);
        space
    };
    let spaces = [
        space(gaze, no_path, IDENTITY),
        space(of_eyes, no_path, IDENTITY),
        space(of_eyes, eyes, IDENTITY),
        space(gaze, no_path, beside()),
    ];
    let seen = |frame: &Frame, is_time_first| {
        spaces.map(|space| locate(app, space, session.space, frame.display_time, is_time_first))
    };
    let stereo = Stereo::create(&session)?;
    let mut focused = 0;
    session.frames(UNTIL_FOCUS, |frame| {
        if frame.index == 0 {
            stereo.paint(0)?;
        }
        let (_, is_active) = calls.pose(handle, gaze, no_path);
        calls.check(
            "Input Action State Synchronization",
            "active before any",
            focused > 0 || !is_active,
            true,
        );
        if focused == 0 {
            let is_found = seen(frame, true).iter().any(|seen| seen.flags != xr::SpaceLocationFlags::EMPTY);
            calls.check("Action Spaces", "located while not active", is_found, false);
        }
        let synced = calls.sync(handle, &[set]);
        calls.check("Input Action State Synchronization", "succeeds", synced.into_raw() >= 0, true);
        if synced == xr::Result::SUCCESS {
            focused += 1;
            in_focus(&calls, &session, (gaze, of_eyes), frame, &seen)?;
        }
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    calls.check("Session States", "it had the focus", focused > 5, true);
    let events = app.report().events.iter().filter(|event| event.contains("INTERACTION_PROFILE")).count();
    calls.check("Current Interaction Profile", "a change is told", events > 0, true);
    let current = [eyes, calls.path("/user/hand/left")?].map(|user| calls.profile(handle, user).1);
    let is_both = current == [calls.path(GAZE)?, calls.path(SIMPLE)?];
    calls.check("Current Interaction Profile", "of eyes and hand", is_both, true);
    sources(&calls, &session, gaze)?;
    names(&calls, &session)?;

    session.frames(4, |frame| {
        match frame.index {
            // No set is active.
            0 => calls.expect("Action Sets", "without sets", calls.sync(handle, &[]), xr::Result::SUCCESS),
            1 => {
                calls.expect("Action Sets", "with it again", calls.sync(handle, &[set]), xr::Result::SUCCESS)
            }
            2 => {
                // SAFETY: the action is live, and used no more but to see that it is gone.
                let result = unsafe { (app.xr.functions.destroy_action)(gaze) };
                calls.expect("Creating Actions", "destroy the action", result, xr::Result::SUCCESS);
            }
            _ => calls.expect("Action Sets", "without it", calls.sync(handle, &[set]), xr::Result::SUCCESS),
        }
        let (result, is_active) = calls.pose(handle, gaze, no_path);
        if frame.index < 2 {
            calls.expect("Reading Input Action State", "a pose", result, xr::Result::SUCCESS);
            calls.check("Action Sets", &format!("active, {}", frame.index), is_active, frame.index == 1);
        } else {
            calls.expect("Object Handle Types", "destroyed", result, xr::Result::ERROR_HANDLE_INVALID);
        }
        // A space outlives its action.
        for (index, located) in seen(frame, false).iter().enumerate() {
            let what = format!("space {index} in frame {}", frame.index);
            calls.check("Action Spaces", &what, located.is_valid(), frame.index > 0);
        }
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// A frame after an xrSyncActions with focus.
fn in_focus(
    calls: &Calls,
    session: &Session,
    (gaze, of_eyes): (xr::Action, xr::Action),
    frame: &Frame,
    seen: &impl Fn(&Frame, bool) -> [Located; 4],
) -> Outcome {
    let (eyes, no_path) = (calls.path(EYES)?, xr::Path::NULL);
    for (action, user) in [(gaze, no_path), (of_eyes, no_path), (of_eyes, eyes)] {
        let (result, is_active) = calls.pose(session.handle, action, user);
        calls.expect("Reading Input Action State", "a pose", result, xr::Result::SUCCESS);
        calls.check("Eye gaze input", "active with a source", is_active, true);
    }
    let (result, _) = calls.pose(session.handle, gaze, eyes);
    let unsupported = xr::Result::ERROR_PATH_UNSUPPORTED;
    calls.expect("Reading Input Action State", "of a user it is not for", result, unsupported);
    let tracked = xr::SpaceLocationFlags::POSITION_TRACKED | xr::SpaceLocationFlags::ORIENTATION_TRACKED;
    let located = seen(frame, frame.index.is_multiple_of(2));
    for located in &located {
        calls.expect("Locating Spaces", "the gaze", located.result, xr::Result::SUCCESS);
        let bits = located.flags & tracked;
        let is_either = bits == tracked || bits == xr::SpaceLocationFlags::EMPTY;
        calls.check("Eye gaze input", "tracked wholly or not at all", is_either, true);
        calls.check("Eye gaze input", "seen eyes have a pose", located.is_valid(), true);
        calls.check("Eye gaze input", "with the time of its sample", located.sampled_ns > 0, true);
        let now = frame.display_time.as_nanos();
        let is_near = (now - located.sampled_ns).abs() < 1_000_000_000;
        calls.check("Eye gaze input", "which is about now", is_near, true);
    }
    let [plain, any, by_path, beside_it] = located.map(|located| located.pose);
    calls.check(
        "Action Spaces",
        "with and without a path",
        is_same(any, by_path) && is_same(any, plain),
        true,
    );
    calls.check("Action Spaces", "an offset", is_same(beside_it, moved(plain, beside())), true);
    let space = session.space;
    for (what, time) in [("no time", 0), ("a time before all", -5)] {
        let (_, bad) = calls.create_space(session.handle, (gaze, no_path), IDENTITY);
        let located = locate(calls.app, bad, space, xr::Time::from_nanos(time), true);
        calls.expect("Locating Spaces", what, located.result, xr::Result::ERROR_TIME_INVALID);
        // SAFETY: the space is live, and used no more.
        unsafe { (calls.app.xr.functions.destroy_space)(bad) };
    }
    Ok(())
}

/// Sections: Input, "Bound Sources"; Fundamentals, "Buffer Size Parameters".
fn sources(calls: &Calls, session: &Session, gaze: xr::Action) -> Outcome {
    let pose = calls.path(GAZE_POSE)?;
    let (result, count, _) = calls.sources(session.handle, gaze, 0);
    calls.expect("Buffer Size Parameters", "how many sources", result, xr::Result::SUCCESS);
    calls.check("Bound Sources", "there are some", count > 0, true);
    let (result, filled, sources) = calls.sources(session.handle, gaze, count + 1);
    calls.expect("Bound Sources", "the sources", result, xr::Result::SUCCESS);
    calls.check("Buffer Size Parameters", "as many as told", filled, count);
    calls.check("Bound Sources", "the gaze is one", sources[..count as usize].contains(&pose), true);
    for source in &sources[..count as usize] {
        let (result, length, _) = calls.name_of(session.handle, *source, 1, 0);
        calls.expect("Bound Sources", "each has a name", result, xr::Result::SUCCESS);
        calls.check("Bound Sources", "which is not empty", length > 1, true);
    }
    let (result, ..) = calls.sources(session.handle, xr::Action::from_raw(NOBODYS), 0);
    calls.expect("Object Handle Types", "of no action", result, xr::Result::ERROR_HANDLE_INVALID);
    Ok(())
}

/// Sections: Input, "Bound Sources" (xrGetInputSourceLocalizedName); Fundamentals, "Buffer Size Parameters".
fn names(calls: &Calls, session: &Session) -> Outcome {
    let pose = calls.path(GAZE_POSE)?;
    for parts in 1..=7 {
        let (result, length, _) = calls.name_of(session.handle, pose, parts, 0);
        calls.expect("Buffer Size Parameters", "how long a name is", result, xr::Result::SUCCESS);
        let (result, filled, text) = calls.name_of(session.handle, pose, parts, length);
        calls.expect("Bound Sources", "a name", result, xr::Result::SUCCESS);
        let end = text.iter().position(|byte| *byte == 0);
        let is_whole = filled == length && end == Some(length as usize - 1) && length > 1;
        calls.check("Bound Sources", "some text and its end", is_whole, true);
        let (result, needed, _) = calls.name_of(session.handle, pose, parts, length - 1);
        let small = xr::Result::ERROR_SIZE_INSUFFICIENT;
        calls.expect("Buffer Size Parameters", "too little room", result, small);
        calls.check("Buffer Size Parameters", "how much is needed", needed, length);
    }
    for parts in [0, 8] {
        let (result, ..) = calls.name_of(session.handle, pose, parts, 0);
        calls.expect("Bound Sources", "of no part", result, xr::Result::ERROR_VALIDATION_FAILURE);
    }
    for path in [xr::Path::NULL, xr::Path::from_raw(NOBODYS << 32)] {
        let (result, ..) = calls.name_of(session.handle, path, 1, 0);
        calls.expect("Bound Sources", "of a path that is none", result, xr::Result::ERROR_PATH_INVALID);
    }
    Ok(())
}

/// A pose action that a hand can drive and the gaze, without subaction paths. Section: Input, "Reading Input Action State" (several sources of
/// one action): it is active if either is.
pub fn conforms_with_two_profiles(app: &App) -> Outcome {
    let calls = Calls::new(app);
    let set = calls.controls.set(0)?;
    let aim = calls.controls.action(set, xr::ActionType::POSE_INPUT, &[])?;
    calls.controls.suggest(SIMPLE, &[(aim, "/user/hand/left/input/aim/pose")])?;
    let result = calls.suggest(&[(aim, calls.path(GAZE_POSE)?)])?;
    calls.expect("Suggested Bindings", "the action of a hand", result, xr::Result::SUCCESS);
    let session = Session::start(app)?;
    calls.expect("Action Sets", "attach", calls.attach(session.handle, &[set]), xr::Result::SUCCESS);
    let (result, space) = calls.create_space(session.handle, (aim, xr::Path::NULL), IDENTITY);
    calls.expect("Action Spaces", "a space of it", result, xr::Result::SUCCESS);
    let stereo = Stereo::create(&session)?;
    session.frames(UNTIL_FOCUS, |frame| {
        if frame.index == 0 {
            stereo.paint(0)?;
        }
        if calls.sync(session.handle, &[set]) == xr::Result::SUCCESS {
            let (_, is_active) = calls.pose(session.handle, aim, xr::Path::NULL);
            calls.check("Reading Input Action State", "active by either", is_active, true);
            let located = locate(app, space, session.space, frame.display_time, true);
            calls.check("Action Spaces", "it has a pose", located.is_valid(), true);
        }
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// A tracker that ends while the application does not synchronise. Sections: Input, "Input Action State Synchronization"; Spaces, "Action Spaces":
/// states change by xrSyncActions alone, and a space whose source is gone is not tracked.
pub fn keeps_states_until_it_synchronises(app: &App) -> Outcome {
    let calls = Calls::new(app);
    let (set, gaze) = calls.gaze()?;
    let session = Session::start(app)?;
    calls.expect("Action Sets", "attach", calls.attach(session.handle, &[set]), xr::Result::SUCCESS);
    let (_, space) = calls.create_space(session.handle, (gaze, xr::Path::NULL), IDENTITY);
    let stereo = Stereo::create(&session)?;
    stereo.paint(0)?;
    let begun = Instant::now();
    let until = |synchronises: bool, is_so: &dyn Fn(bool, &Located) -> bool| {
        let mut is_done = false;
        while !is_done && begun.elapsed() < LONGEST_WAIT {
            session.frames(1, |frame| {
                if synchronises {
                    calls.sync(session.handle, &[set]);
                }
                let (_, is_active) = calls.pose(session.handle, gaze, xr::Path::NULL);
                let located = locate(app, space, session.space, frame.display_time, true);
                is_done = is_so(is_active, &located);
                session.submit(frame, &[Layer::Projection(stereo.images())])
            })?;
            sleep(Duration::from_millis(2));
        }
        Ok::<_, Failure>(is_done)
    };
    let is_there = until(true, &|is_active, located| is_active && located.is_valid())?;
    calls.check("Eye gaze input", "the gaze comes", is_there, true);
    app.report().trace.push("the gaze is there".to_owned());
    let tracked = xr::SpaceLocationFlags::POSITION_TRACKED | xr::SpaceLocationFlags::ORIENTATION_TRACKED;
    let is_gone = until(false, &|_, located| located.flags & tracked == xr::SpaceLocationFlags::EMPTY)?;
    calls.check("Action Spaces", "a space whose source is gone is not tracked", is_gone, true);
    let (_, is_active) = calls.pose(session.handle, gaze, xr::Path::NULL);
    calls.check("Input Action State Synchronization", "active until then", is_active, true);
    calls.sync(session.handle, &[set]);
    let (_, is_active) = calls.pose(session.handle, gaze, xr::Path::NULL);
    calls.check("Input Action State Synchronization", "and not after", is_active, false);
    drop(stereo);
    session.finish()
}

/// For a machine that does much else.
const LONGEST_WAIT: Duration = Duration::from_secs(90);
