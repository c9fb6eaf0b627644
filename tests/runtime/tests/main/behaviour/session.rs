//! Sessions and frames.

use super::{SUCCESS, empty_frame};
use crate::application::{Application, call};
use crate::case::Output;
use openxr_sys as xr;
use openxr_sys::SessionState as State;
use parafovea_mock_runtime::SCENARIO_VARIABLE;
use parafovea_mock_runtime::record::Line;
use std::io::{Read, Write};
use std::os::unix::net::UnixListener;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

pub fn two_sessions() {
    let mut app = Application::ready();
    for round in 0..2 {
        if round == 1 {
            assert_eq!(app.create_session(), SUCCESS);
        }
        assert_eq!(app.states(), [State::IDLE, State::READY]);
        assert_eq!(app.begin_session(), SUCCESS);
        empty_frame(&app);
        assert_eq!(app.states(), [State::SYNCHRONIZED, State::VISIBLE, State::FOCUSED]);
        // The first session ends with the scenario's number of frames, the second by request.
        if round == 0 {
            empty_frame(&app);
        } else {
            assert_eq!(call!(app, RequestExitSession(app.session)), SUCCESS);
        }
        assert_eq!(app.states(), [State::VISIBLE, State::SYNCHRONIZED, State::STOPPING]);
        assert_eq!(call!(app, EndSession(app.session)), SUCCESS);
        assert_eq!(app.states(), [State::IDLE, State::EXITING]);
        assert_eq!(call!(app, DestroySession(app.session)), SUCCESS);
    }
}

pub fn two_sessions_recorded(output: &Output) {
    let frames = output.frames();
    let times: Vec<_> = frames.iter().map(|frame| (frame.index, frame.display_time_ns)).collect();
    assert_eq!(times, [(0, 1_000_000_000), (1, 1_011_111_111), (2, 1_022_222_222)]);
    assert!(frames.windows(2).all(|pair| pair[0].process_cpu_ns <= pair[1].process_cpu_ns));
    let Some(Line::End { frames: 3, errors: 0, .. }) = output.record.last() else {
        panic!("{:?}", output.record.last());
    };
}

pub fn late_focus() {
    let app = Application::running();
    app.states();
    let seen: Vec<_> = (0..3).map(|_| (bool::from(empty_frame(&app).should_render), app.states())).collect();
    let expected =
        [(false, vec![State::SYNCHRONIZED]), (true, vec![State::VISIBLE]), (true, vec![State::FOCUSED])];
    assert_eq!(seen, expected);
}

pub fn should_render() {
    let app = Application::running();
    let seen = [(); 3].map(|()| bool::from(empty_frame(&app).should_render));
    assert_eq!(seen, [true, false, true]);
}

/// Two frames wait for a byte each; then the other end of the socket is closed, and no frame waits.
pub fn turns() {
    let scenario = PathBuf::from(std::env::var_os(SCENARIO_VARIABLE).unwrap());
    let listener = UnixListener::bind(scenario.with_file_name("turns")).unwrap();
    let given = Arc::new(AtomicU32::new(0));
    let giver = std::thread::spawn({
        let given = Arc::clone(&given);
        move || {
            let (mut stream, _) = listener.accept().unwrap();
            for turn in 1..=2 {
                stream.read_exact(&mut [0]).unwrap();
                std::thread::sleep(Duration::from_millis(20));
                given.store(turn, Ordering::SeqCst);
                stream.write_all(&[0]).unwrap();
            }
        }
    });
    let app = Application::running();
    for turn in 1..=2 {
        empty_frame(&app);
        assert_eq!(given.load(Ordering::SeqCst), turn, "the frame did not wait, or was not the only one");
    }
    giver.join().unwrap();
    empty_frame(&app);
}

pub fn discarded_frame() {
    let app = Application::running();
    app.begin_frame();
    let second = app.wait_frame();
    assert_eq!(call!(app, BeginFrame(app.session, std::ptr::null())), xr::Result::FRAME_DISCARDED);
    assert_eq!(app.end_frame(second.predicted_display_time, &[]), SUCCESS);
}

pub fn real_time() {
    let app = Application::running();
    let start = std::time::Instant::now();
    let times = [(); 4].map(|()| empty_frame(&app).predicted_display_time.as_nanos());
    assert!(start.elapsed() >= Duration::from_millis(59), "{:?}", start.elapsed());
    assert!(
        times.windows(2).all(|pair| (pair[1] - pair[0]) % 20_000_000 == 0 && pair[1] > pair[0]),
        "{times:?}"
    );
}
