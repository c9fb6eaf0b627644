use super::*;
use crate::inputs::gaze::direction;
use parafovea_manifest::status::ASSUMED_DELAY_MS;

const MS: i64 = 1_000_000;

/// Gaze of a simulated viewer, degrees: it moves to another place every 300 to 700 milliseconds, without a pattern.
fn eyes_deg(ms: i64) -> [f32; 2] {
    let step = |ms: i64| (ms / 100) as u64;
    let mixed = |step: u64| step.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
    let begin = (0..7).map(|back| step(ms).saturating_sub(back)).find(|step| mixed(*step).is_multiple_of(4));
    let place = mixed(begin.unwrap_or_default().wrapping_add(1 << 20));
    [(place % 41) as f32 - 20.0, (place / 41 % 21) as f32 - 10.0]
}

fn look_at(eye_ms: i64, sampled_ns: i64) -> Look {
    Look::At { direction: direction(eyes_deg(eye_ms)), sampled_ns, uncertainty_ns: 0 }
}

/// Frames of 11 ms from `begin_ms` on: the runtime's tracker is 10 ms late and knows it, packets are `delay_ms` late at display time.
fn play(state: &mut State, begin_ms: i64, delay_ms: i64, sampled: impl Fn(i64) -> i64) {
    for frame in 0..2_000 {
        let shown_ms = begin_ms + 11 * frame;
        let eyes = look_at(shown_ms - 10, sampled((shown_ms - 10) * MS));
        let delay = state.packet_delay();
        state.compare(eyes, look_at(shown_ms - delay_ms, shown_ms * MS - delay.delay_ns), delay);
    }
}

#[test]
fn the_delay_of_packets_is_known_by_the_runtime_s_eye_tracker_until_their_sender_ends() {
    let mut state = State::default();
    play(&mut state, 1_000, 72, |sampled_ns| sampled_ns);
    let known = state.delay.delay_ms();
    assert!(known.is_some_and(|known| (known - 72.0).abs() < 8.0), "{known:?}");
    let delay = state.packet_delay();
    assert!((delay.delay_ns - 72 * MS).abs() < 8 * MS && delay.uncertainty_ns == 10 * MS, "{delay:?}");
    state.compare(Look::NoTracker, look_at(30_000, 30_000 * MS), delay);
    assert_eq!(state.delay.delay_ms(), known);
    state.compare(look_at(30_000, 30_000 * MS), Look::NoTracker, delay);
    assert_eq!(state.packet_delay(), PacketDelay::ASSUMED);
}

#[test]
fn without_the_times_of_the_runtime_s_samples_no_delay_is_known() {
    let mut state = State::default();
    play(&mut state, 1_000, 72, |_| 0);
    assert_eq!(state.delay.delay_ms(), None);
}

#[test]
fn the_status_names_the_delay_that_is_assumed() {
    assert_eq!(PacketDelay::ASSUMED.delay_ns, i64::from(ASSUMED_DELAY_MS) * MS);
}
