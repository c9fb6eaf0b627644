//! The frame loop: wait, begin, end.

use crate::abi::pointers::{In, Out};
use crate::clock;
use crate::compositor;
use crate::fault::{Fault, section};
use crate::layers;
use crate::record;
use crate::runtime::{self, Runtime, call};
use crate::scenario::Answer;
use crate::script;
use glam::Vec3;
use openxr_sys as xr;
use openxr_sys::{Handle, SessionState};
use std::time::{Duration, Instant};

/// State of a session's frame loop.
#[derive(Debug, Default)]
pub(crate) struct FrameLoop {
    /// Successful `xrWaitFrame` calls.
    waits: u64,
    /// `xrEndFrame` calls of this session.
    ended: u64,
    /// Waited for, not begun.
    waited: Option<Frame>,
    /// Begun, not ended.
    begun: Option<Frame>,
    /// Display time for which views were located last.
    pub views_located: Option<i64>,
    /// Number of times that the gaze was located since the end of the newest frame.
    pub gaze_reads: u32,
}

impl FrameLoop {
    /// Whether a frame was waited for, or begun, and has not ended.
    pub fn is_in_frame(&self) -> bool {
        self.waited.is_some() || self.begun.is_some()
    }
}

/// A frame in progress.
#[derive(Clone, Copy, Debug)]
struct Frame {
    display_time: i64,
    should_render: bool,
}

/// `xrWaitFrame` blocks while the frame before has not begun. An application with one thread would wait for
/// itself; it gets an error after this long.
const DEADLOCK: Duration = Duration::from_secs(2);

/// Interval between checks of that.
const POLL: Duration = Duration::from_micros(100);

/// `xrWaitFrame`.
pub(crate) extern "system" fn wait(
    session: xr::Session,
    info: In<xr::FrameWaitInfo>,
    mut state: Out<xr::FrameState>,
) -> xr::Result {
    let start = Instant::now();
    if let Some(turns) = runtime::turns() {
        // A turn is for a whole frame: the one before ends first, though applications may wait earlier.
        while runtime::is_in_frame(session) && start.elapsed() < DEADLOCK {
            std::thread::sleep(POLL);
        }
        turns.next();
    }
    loop {
        let mut next = Next::Return;
        let result = call("xrWaitFrame", |runtime| {
            runtime.read_optional(&info)?;
            let frames = &runtime.sessions.get(session)?.frames;
            if frames.waited.is_some() && start.elapsed() < DEADLOCK {
                next = Next::TryAgain;
                return Ok(xr::Result::SUCCESS);
            }
            let state = state.get()?;
            let (frame, wait) = next_frame(runtime, session)?;
            state.predicted_display_time = xr::Time::from_nanos(frame.display_time);
            state.predicted_display_period = xr::Duration::from_nanos(runtime.clock.period_ns());
            state.should_render = frame.should_render.into();
            runtime.sessions.get_mut(session)?.frames.waited = Some(frame);
            next = Next::ReturnAfter(wait);
            Ok(xr::Result::SUCCESS)
        });
        match next {
            Next::Return => return result,
            Next::ReturnAfter(wait) => {
                std::thread::sleep(wait);
                return result;
            }
            Next::TryAgain => std::thread::sleep(POLL),
        }
    }
}

/// Next step of `xrWaitFrame`, without the lock.
enum Next {
    Return,
    ReturnAfter(Duration),
    TryAgain,
}

/// The next frame of a session, which may become visible or focused with it, and the time until it.
fn next_frame(runtime: &mut Runtime, session: xr::Session) -> Result<(Frame, Duration), Fault> {
    let waiting = runtime.sessions.get_mut(session)?;
    waiting.check_running()?;
    if waiting.frames.waited.is_some() {
        let message = "the frame waited for before was not begun meanwhile; this call would block for ever";
        return Err(Fault::new(xr::Result::ERROR_RUNTIME_FAILURE, section::FRAMES, message));
    }
    let number = waiting.frames.waits;
    waiting.frames.waits += 1;
    let mut slot = runtime.clock.next(clock::monotonic_ns());
    if runtime.answer == Answer::Backwards {
        slot.display_time = (slot.display_time - 1_000_000_000).max(1);
    }
    let script = runtime.scenario.session.clone();
    let steps = [
        (SessionState::READY, SessionState::SYNCHRONIZED, 0),
        (SessionState::SYNCHRONIZED, SessionState::VISIBLE, script.visible_from),
        (SessionState::VISIBLE, SessionState::FOCUSED, script.focused_from),
    ];
    // A session that is being stopped may be in one of these states only within `stop`.
    for (from, to, since) in steps {
        if runtime.sessions.get(session)?.state == from && number >= since {
            runtime.enter(session, to)?;
        }
    }
    let visible = runtime.sessions.get(session)?.is_visible();
    let should_render = visible && !script.should_render_off.contains(&number);
    Ok((Frame { display_time: slot.display_time, should_render }, slot.wait))
}

/// `xrBeginFrame`.
pub(crate) extern "system" fn begin(session: xr::Session, info: In<xr::FrameBeginInfo>) -> xr::Result {
    call("xrBeginFrame", |runtime| {
        runtime.read_optional(&info)?;
        let session = runtime.sessions.get_mut(session)?;
        session.check_running()?;
        let waited = session.frames.waited.take();
        let waited = waited.ok_or_else(|| Fault::order(section::FRAMES, "no xrWaitFrame came before"))?;
        let discarded = session.frames.begun.replace(waited).is_some();
        Ok(if discarded { xr::Result::FRAME_DISCARDED } else { xr::Result::SUCCESS })
    })
}

/// `xrEndFrame`.
pub(crate) extern "system" fn end(session: xr::Session, info: In<xr::FrameEndInfo>) -> xr::Result {
    let process_cpu_ns = clock::process_cpu_ns();
    let thread_cpu_ns = clock::thread_cpu_ns();
    call("xrEndFrame", |runtime| {
        let info = runtime.read(&info)?;
        let ending = runtime.sessions.get(session)?;
        ending.check_running()?;
        let process_cpu_ns = match runtime.turns {
            Some(_) => ending.gpu.finish().map(|()| clock::process_cpu_ns())?,
            None => process_cpu_ns,
        };
        let begun = ending.frames.begun;
        let begun = begun.ok_or_else(|| Fault::order(section::SUBMISSION, "no xrBeginFrame came before"))?;
        check_end_info(&info, begun)?;
        let layers = layers::read(runtime, session, &info.layers()?)?;
        let frame = describe(runtime, session, begun, &layers, [process_cpu_ns, thread_cpu_ns])?;
        compositor::show(runtime, session, begun.display_time, &layers)?;
        runtime.recorder.line(&record::Line::Frame(frame));
        runtime.frames += 1;
        let limit = runtime.scenario.session.frames;
        let frames = &mut runtime.sessions.get_mut(session)?.frames;
        frames.begun = None;
        frames.gaze_reads = 0;
        frames.ended += 1;
        if frames.ended == limit {
            runtime.stop(session)?;
        }
        Ok(xr::Result::SUCCESS)
    })
}

fn check_end_info(info: &xr::FrameEndInfo, begun: Frame) -> Result<(), Fault> {
    if info.display_time.as_nanos() != begun.display_time {
        let (given, wanted) = (info.display_time.as_nanos(), begun.display_time);
        let message = format!("displayTime is {given}; xrWaitFrame predicted {wanted}");
        return Err(Fault::new(xr::Result::ERROR_TIME_INVALID, section::SUBMISSION, message));
    }
    if info.environment_blend_mode != xr::EnvironmentBlendMode::OPAQUE {
        let message =
            format!("environmentBlendMode is {:?}; OPAQUE is supported", info.environment_blend_mode);
        let result = xr::Result::ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED;
        return Err(Fault::new(result, section::SUBMISSION, message));
    }
    if info.layer_count > layers::MAX_LAYERS {
        let message =
            format!("layerCount is {}; at most {} are supported", info.layer_count, layers::MAX_LAYERS);
        return Err(Fault::new(xr::Result::ERROR_LAYER_LIMIT_EXCEEDED, section::SUBMISSION, message));
    }
    Ok(())
}

fn describe(
    runtime: &Runtime,
    session: xr::Session,
    begun: Frame,
    layers: &[layers::Layer],
    [process_cpu_ns, thread_cpu_ns]: [i64; 2],
) -> Result<record::Frame, Fault> {
    let seconds = runtime.clock.scenario_seconds(begun.display_time);
    let gaze = script::gaze_at(&runtime.scenario.gaze, seconds).filter(|_| runtime.scenario.system.eye_gaze);
    Ok(record::Frame {
        index: runtime.frames,
        session: session.into_raw(),
        display_time_ns: begun.display_time,
        process_cpu_ns,
        thread_cpu_ns,
        held_cpu_ns: runtime.turns.as_ref().map_or(0, |turns| turns.held_cpu_ns()),
        peak_memory_kib: clock::peak_memory_kib(),
        should_render: begun.should_render,
        head: layers::recorded_pose(script::head_at(&runtime.scenario.head, seconds)),
        gaze: gaze.map(|orientation| (orientation * Vec3::NEG_Z).to_array()),
        gaze_reads: runtime.sessions.get(session)?.frames.gaze_reads,
        layers: layers.iter().map(layers::Layer::recorded).collect(),
    })
}
