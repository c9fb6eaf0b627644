use super::*;
use proptest::prelude::*;

mod game;
mod interrupted;
mod resolution;
mod simulation;
mod table;

use simulation::{Eyes, Simulation};

const SECOND: i64 = 1_000_000_000;

/// Toggles seen with open eyes, as times, and all changes of the kept state.
struct Run {
    visible_toggles: Vec<i64>,
    toggles: usize,
    changes: usize,
    on: bool,
}

/// Runs a simulation with a gate for so many seconds.
fn run(simulation: &mut Simulation, gate: &mut Gate, seconds: i64) -> Run {
    let mut run = Run { visible_toggles: Vec::new(), toggles: 0, changes: 0, on: gate.is_on() };
    let mut kept = gate.is_kept();
    let end = simulation.now() + seconds * SECOND;
    while simulation.now() < end {
        let frame = simulation.frame(gate.is_on());
        let on = gate.frame(&frame, true);
        if on != run.on {
            run.toggles += 1;
            if !is_hidden(frame.phase) {
                run.visible_toggles.push(frame.time_ns);
            }
        }
        run.changes += usize::from(gate.is_kept() != kept);
        (run.on, kept) = (on, gate.is_kept());
    }
    run.on = gate.is_kept();
    run
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// 5 % are found at 10 % noise on every frame: within 20 minutes with eyes that move, with three frames in flight.
    #[test]
    fn finds_what_pays(seed: u64, gain in 0.05f64..0.6, costs: bool, latency in 0usize..4) {
        let ratio = if costs { 1.0 + gain } else { 1.0 - gain };
        let mut simulation = Simulation::new(seed).ratio(ratio).noise(0.1).latency(latency);
        let mut gate = Gate::new(GateMode::Auto);
        let run = run(&mut simulation, &mut gate, 20 * 60);
        prop_assert_eq!(run.on, !costs, "{:?}", gate.evidence().ratio());
    }

    /// A plain gain is known after three seconds, without any movement of the eyes, and stays.
    #[test]
    fn clear_savings_and_slowdowns_are_found_at_the_start(seed: u64, gain in 0.25f64..0.6, costs: bool) {
        let ratio = if costs { 1.0 + gain } else { 1.0 - gain };
        let mut simulation = Simulation::new(seed).ratio(ratio).noise(0.1).eyes(Eyes::Rest);
        let mut gate = Gate::new(GateMode::Auto);
        let start = run(&mut simulation, &mut gate, 3);
        prop_assert_eq!(start.on, !costs, "{:?}", gate.evidence().ratio());
        prop_assert_eq!(run(&mut simulation, &mut gate, 20 * 60).changes, 0);
    }

    /// No trial begins within the time that the gate announces, and that is a third of the time at least, also of eyes that never blink.
    #[test]
    fn no_trial_begins_in_an_announced_rest(
        seed: u64,
        ratio in 0.6f64..1.4,
        eyes in prop::sample::select(vec![Eyes::Rest, Eyes::Move, Eyes::Lost]),
    ) {
        let mut simulation = Simulation::new(seed).ratio(ratio).noise(0.1).eyes(eyes);
        let mut gate = Gate::new(GateMode::Auto);
        let (mut rests_until, mut resting, mut frames) = (i64::MIN, 0, 0);
        while simulation.now() < 30 * 60 * SECOND {
            let had_trial = gate.has_trial();
            let frame = simulation.frame(gate.is_on());
            gate.frame(&frame, true);
            let now = frame.time_ns;
            prop_assert!(!gate.has_trial() || had_trial || now >= rests_until);
            let rests_ns = gate.rests_ns(now);
            prop_assert!(rests_ns == 0 || !gate.wants_costs());
            rests_until = rests_until.max(now.saturating_add(rests_ns));
            (resting, frames) = (resting + u32::from(rests_ns > 0), frames + 1);
        }
        prop_assert!(!(0.8..1.2).contains(&ratio) || resting > 0);
        prop_assert!((0.8..1.2).contains(&ratio) || 3 * resting > frames, "{resting} of {frames}");
    }

    /// With open eyes at most four switches in any minute, at any cost of frames; after two full trials, a control and
    /// at most one change of the kept state in ten minutes.
    #[test]
    fn open_eyes_see_little(
        seed: u64,
        ratio in 0.5f64..1.5,
        noise in 0.0f64..0.5,
        latency in 0usize..4,
        eyes in prop::sample::select(vec![Eyes::Rest, Eyes::Move, Eyes::Lost]),
    ) {
        let mut simulation = Simulation::new(seed).ratio(ratio).noise(noise).latency(latency).eyes(eyes);
        let mut gate = Gate::new(GateMode::Auto);
        let start = run(&mut simulation, &mut gate, 150);
        for window in start.visible_toggles.windows(5) {
            prop_assert!(window[4] - window[0] >= TRIAL_REST_NS, "{window:?}");
        }
        let run = run(&mut simulation, &mut gate, 40 * 60);
        for window in run.visible_toggles.windows(4) {
            prop_assert!(window[3] - window[0] >= CONTROL_REST_NS / 2, "{window:?}");
        }
        prop_assert!(run.visible_toggles.len() <= 4 * 3 + 3);
    }

    /// Noise alone does not make it flap: at a true ratio of 1 the kept state changes at most four times in an hour.
    #[test]
    fn noise_does_not_make_it_flap(seed: u64, noise in 0.0f64..0.5, ratio in 0.995f64..1.005) {
        let mut simulation = Simulation::new(seed).ratio(ratio).noise(noise);
        let mut gate = Gate::new(GateMode::Auto);
        let run = run(&mut simulation, &mut gate, 60 * 60);
        prop_assert!(run.changes <= 4, "{}", run.changes);
    }

    /// Any order of anything: it does not panic, and trials begin only where they may.
    #[test]
    fn takes_anything(
        frames in prop::collection::vec(
            (any::<i64>(), any::<Option<u64>>(), any::<bool>(), 0usize..5, any::<Option<u32>>(), any::<[u32; 2]>()),
            0..300,
        ),
    ) {
        let phases =
            [GazePhase::Fixation, GazePhase::Saccade, GazePhase::PostSaccade, GazePhase::Blink, GazePhase::Lost];
        let mut gate = Gate::new(GateMode::Auto);
        for (time_ns, cost_ns, was_on, phase, passes, [pixels, may_begin]) in frames {
            let may_begin = may_begin % 2 == 0;
            let had_trial = gate.has_trial();
            let passes = passes.map(|passes| passes % 4);
            let frame = GateFrame { time_ns, cost_ns, was_on, phase: phases[phase], passes, pixels };
            gate.frame(&frame, may_begin);
            let began = gate.has_trial() && !had_trial;
            prop_assert!(!began || may_begin);
        }
    }
}

/// One outlier in ten frames, of ten times the cost, hides nothing.
#[test]
fn outliers_hide_nothing() {
    for (ratio, on) in [(0.8, true), (1.25, false)] {
        let mut simulation = Simulation::new(2).ratio(ratio).noise(0.05).outliers();
        let mut gate = Gate::new(GateMode::Auto);
        assert_eq!(run(&mut simulation, &mut gate, 10 * 60).on, on, "{:?}", gate.evidence().ratio());
        let verdict = if on { Verdict::Saves } else { Verdict::SavesNothing };
        assert_eq!(gate.evidence().verdict(), verdict);
    }
}

/// Costs that grow are not a difference: 0.05 % a frame, or 4.6 % a second, is not taken for a difference of 1.0.
#[test]
fn drift_is_no_difference() {
    let mut simulation = Simulation::new(3).ratio(1.0).noise(0.02).growing(1.0005);
    let mut gate = Gate::new(GateMode::Auto);
    run(&mut simulation, &mut gate, 30);
    let (ratio, _) = gate.evidence().ratio().unwrap();
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

/// Another scene is judged by itself once the old one is gone; back in the old one, its decision holds at once.
#[test]
fn another_scene_is_judged_anew() {
    let mut gate = Gate::new(GateMode::Auto);
    let mut in_scene = |simulation: &mut Simulation, passes: u32, seconds: i64| {
        let end = simulation.now() + seconds * SECOND;
        let mut switches = 0;
        while simulation.now() < end {
            let was_on = gate.is_on();
            let frame = GateFrame { passes: Some(passes), ..simulation.frame(was_on) };
            switches += usize::from(gate.frame(&frame, true) != was_on);
        }
        (gate.is_kept(), switches)
    };
    let mut simulation = Simulation::new(4).ratio(1.4).noise(0.05).eyes(Eyes::Rest);
    // A trial, and a control a minute later.
    assert_eq!(in_scene(&mut simulation, 1, 100), (false, 5));
    let mut simulation = simulation.ratio(0.6);
    assert_eq!(in_scene(&mut simulation, 2, 12), (true, 3));
    let mut simulation = simulation.ratio(1.4);
    assert_eq!(in_scene(&mut simulation, 1, 12), (false, 1), "as it was decided");
    assert_eq!(in_scene(&mut simulation.ratio(0.6), 2, 12), (true, 1), "as it was decided");
}

/// Costs of an application wander as heads turn, by 15 % within a second: 30 % are found, and a slowdown is. 30 s then hold
/// ten independent costs, and no gain at all is taken for one in a fifth of the runs.
#[test]
fn costs_that_wander_are_told_from_gains() {
    for (ratio, on, least) in [(0.7, true, 39), (1.0, false, 28), (1.1, false, 38)] {
        let decide = |seed| {
            let mut simulation =
                Simulation::new(seed).ratio(ratio).noise(0.05).wandering(0.15).eyes(Eyes::Rest);
            run(&mut simulation, &mut Gate::new(GateMode::Auto), 30).on == on
        };
        let right = (0..40).filter(|&seed| decide(seed)).count();
        assert!(right >= least, "{ratio}: {right} of 40");
    }
}

/// A control finds that a saving is gone.
#[test]
fn a_control_finds_what_has_changed() {
    for (ratio, later, on) in [(0.6, 1.2, false), (1.2, 0.6, true)] {
        let mut simulation = Simulation::new(8).ratio(ratio).noise(0.05).eyes(Eyes::Rest);
        let mut gate = Gate::new(GateMode::Auto);
        assert_eq!(run(&mut simulation, &mut gate, 60).on, !on);
        let seconds = if on { TRIAL_REST_NS } else { CONTROL_REST_NS } / SECOND;
        let run = run(&mut simulation.ratio(later), &mut gate, seconds);
        assert_eq!((run.on, run.toggles), (on, 3));
    }
}

/// A menu with the passes of the game, at the start: its decision is soon judged again.
#[test]
fn a_slowdown_at_the_start_is_not_the_game_s() {
    for (eyes, seconds) in [(Eyes::Move, 60), (Eyes::Rest, 75)] {
        for seed in 0..12 {
            let mut simulation = Simulation::new(seed).ratio(1.1).noise(0.05).eyes(eyes);
            let mut gate = Gate::new(GateMode::Auto);
            assert!(!run(&mut simulation, &mut gate, 20).on, "seed {seed}");
            assert!(run(&mut simulation.ratio(0.7), &mut gate, seconds).on, "{eyes:?}, seed {seed}");
        }
    }
}

/// Nothing is measured where the technique is not at work although it might be, as with nothing matched.
#[test]
fn waits_until_the_technique_works() {
    let mut gate = Gate::new(GateMode::Auto);
    let mut simulation = Simulation::new(5).eyes(Eyes::Move);
    for _ in 0..10_000 {
        let frame = GateFrame { was_on: false, ..simulation.frame(true) };
        assert!(gate.frame(&frame, true));
    }
    assert!(gate.evidence().is_empty());
}

#[test]
fn modes_on_and_off_override_costs() {
    for (mode, on) in [(GateMode::On, true), (GateMode::Off, false)] {
        let mut gate = Gate::new(mode);
        let run = run(&mut Simulation::new(6).ratio(if on { 2.0 } else { 0.5 }), &mut gate, 60);
        assert_eq!((run.on, run.toggles, gate.has_trial()), (on, 0, false));
    }
}

/// A technique that saves time and one that costs time are distinguished, and never tried together.
#[test]
fn two_are_told_apart() {
    for (rates, reuse) in [(0.7, 1.2), (1.2, 0.7), (0.7, 0.8), (1.2, 1.3)] {
        let auto = Techniques { rates: GateMode::Auto, reuse: GateMode::Auto };
        let mut gates = Gates::new(auto);
        let mut simulation = Simulation::new(7).noise(0.05);
        let mut on = Techniques { rates: true, reuse: true };
        for _ in 0..90 * 120 {
            let factor = if on.rates { rates } else { 1.0 } * if on.reuse { reuse } else { 1.0 };
            let frame = simulation.frame_with_factor(on.rates, factor);
            on = gates.frame(&MeasuredFrame {
                time_ns: frame.time_ns,
                cost_ns: frame.cost_ns,
                was_on: on,
                phase: frame.phase,
                passes: Some(2),
                pixels: frame.pixels,
            });
            let gates = gates.gates();
            assert!(!(gates.rates.has_trial() && gates.reuse.has_trial()));
        }
        let kept = [gates.gates().rates.is_kept(), gates.gates().reuse.is_kept()];
        assert_eq!(kept, [rates < 1.0, reuse < 1.0], "{rates} {reuse}");
    }
}

/// Rates become coarse within a quarter of a second of the start: those frames are not costs of the kept state, or the saving looks smaller
/// than it is, and the first trial goes on until many later frames outweigh them.
#[test]
fn a_ramp_at_the_start_does_not_prolong_the_first_trial() {
    let mut gate = Gate::new(GateMode::Auto);
    let frame_ns = 11_111_111;
    let mut frames = 0;
    let mut decide = || {
        while gate.evidence().is_empty() || gate.has_trial() {
            let ramp = 1.0 - 0.4 * (frames as f64 / 25.0).min(1.0);
            let jitter = 1.0 + 0.01 * (frames % 3) as f64;
            let was_on = gate.is_on();
            let cost_ns = Some((5e7 * jitter * if was_on { ramp } else { 1.0 }) as u64);
            let phase = GazePhase::Fixation;
            let frame =
                GateFrame { time_ns: frames * frame_ns, cost_ns, was_on, phase, passes: Some(1), pixels: 0 };
            gate.frame(&frame, true);
            frames += 1;
        }
        frames
    };
    let frames = decide();
    let (ratio, _) = gate.evidence().ratio().unwrap();
    assert!(gate.is_kept() && (ratio - 0.6).abs() < 0.01, "{ratio}");
    // Two ramps of 45 frames.
    assert!(frames < 150, "{frames}");
}

/// Rates become coarse anew after each switch. A trial that begins without them saw only the frames before that, and took a saving for none:
/// at 144 Hz these are 18 frames, and the first estimate comes after 10.
#[test]
fn a_ramp_after_a_switch_hides_no_saving() {
    for hz in [45.0, 90.0, 144.0] {
        let mut simulation = Simulation::new(11).noise(0.005).eyes(Eyes::Rest).rate(hz);
        let mut gate = Gate::new(GateMode::Auto);
        let mut on_since = Some(0);
        let mut kept = Vec::new();
        for (passes, ratio) in [(1, 1.4), (2, 0.8)] {
            let end = simulation.now() + 100 * SECOND;
            while simulation.now() < end {
                let is_on = gate.is_on();
                on_since = if is_on { on_since.or(Some(simulation.now())) } else { None };
                let on_for_s = on_since.map_or(0.0, |since| (simulation.now() - since) as f64 / 1e9);
                let factor = 1.0 + (ratio - 1.0) * ((on_for_s - 0.125) / 0.25).clamp(0.0, 1.0);
                let frame = simulation.frame_with_factor(is_on, factor);
                gate.frame(&GateFrame { passes: Some(passes), ..frame }, true);
            }
            kept.push(gate.is_kept());
        }
        assert_eq!(kept, [false, true], "{hz} Hz");
    }
}

/// Without eye passes, or with them and never a cost, timestamps are not written for ever; with the first eye pass they are.
#[test]
fn costs_that_never_come_are_not_asked_for_all_the_time() {
    for passes in [None, Some(1)] {
        let mut gate = Gate::new(GateMode::Auto);
        let mut simulation = Simulation::new(12);
        let mut asked = 0;
        for _ in 0..90 * 120 {
            let frame = GateFrame { passes, cost_ns: None, ..simulation.frame(gate.is_on()) };
            gate.frame(&frame, true);
            asked += u32::from(gate.wants_costs());
        }
        let most_s = if passes.is_some() { 31 } else { 11 };
        assert!((90 * 9..90 * most_s).contains(&asked), "{passes:?}: {asked}");
        let frame = GateFrame { passes: Some(2), ..simulation.frame(gate.is_on()) };
        let frame = GateFrame { time_ns: frame.time_ns + 60 * SECOND, ..frame };
        gate.frame(&frame, true);
        assert!(gate.wants_costs());
    }
}
