use super::*;
use proptest::prelude::*;

mod simulation;

use simulation::{Eyes, Simulation};

const SECOND: i64 = 1_000_000_000;

/// Toggles seen with open eyes, as times, and all changes of the stand.
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

    /// What is plain is known at the end of the first series, without any movement of the eyes, and stays.
    #[test]
    fn what_is_plain_is_found_at_the_start(seed: u64, gain in 0.25f64..0.6, costs: bool) {
        let ratio = if costs { 1.0 + gain } else { 1.0 - gain };
        let mut simulation = Simulation::new(seed).ratio(ratio).noise(0.1).eyes(Eyes::Rest);
        let mut gate = Gate::new(GateMode::Auto);
        let start = run(&mut simulation, &mut gate, 3);
        prop_assert_eq!(start.on, !costs, "{:?}", gate.evidence().ratio());
        prop_assert_eq!(run(&mut simulation, &mut gate, 20 * 60).changes, 0);
    }

    /// With open eyes it toggles only at the start and, beyond that, away and back once in 30 s; whatever frames cost.
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
        let start = run(&mut simulation, &mut gate, 5);
        prop_assert!(start.visible_toggles.len() <= 2 * BURST as usize + 1);
        let run = run(&mut simulation, &mut gate, 15 * 60);
        for window in run.visible_toggles.windows(3) {
            prop_assert!(window[2] - window[0] >= VISIBLE_REST_NS, "{window:?}");
        }
        prop_assert!(run.visible_toggles.len() <= 2 * 15 * 2 + 2);
    }

    /// Noise alone does not make it flap: at a true ratio of 1 the stand changes at most four times in an hour.
    #[test]
    fn noise_does_not_make_it_flap(seed: u64, noise in 0.0f64..0.5, ratio in 0.995f64..1.005) {
        let mut simulation = Simulation::new(seed).ratio(ratio).noise(noise);
        let mut gate = Gate::new(GateMode::Auto);
        let run = run(&mut simulation, &mut gate, 60 * 60);
        prop_assert!(run.changes <= 4, "{}", run.changes);
    }

    /// Any order of anything: it does not panic, and it is away only where it may be.
    #[test]
    fn takes_anything(
        frames in prop::collection::vec(
            (any::<i64>(), any::<Option<u64>>(), any::<bool>(), 0usize..5, any::<bool>(), any::<bool>(), any::<bool>()),
            0..300,
        ),
    ) {
        let phases =
            [GazePhase::Fixation, GazePhase::Saccade, GazePhase::PostSaccade, GazePhase::Blink, GazePhase::Lost];
        let mut gate = Gate::new(GateMode::Auto);
        for (time_ns, cost_ns, was_on, phase, scene_changed, waited, may_leave) in frames {
            let was_away = matches!(gate.stage, Stage::Away(_));
            let frame = GateFrame { time_ns, cost_ns, was_on, phase: phases[phase], scene_changed, waited };
            gate.frame(&frame, may_leave);
            let left = matches!(gate.stage, Stage::Away(_)) && !was_away;
            prop_assert!(!left || (may_leave && !waited));
        }
    }
}

/// While everything waits, nothing is begun and nothing decided.
#[test]
fn decides_nothing_while_frames_wait() {
    for eyes in [Eyes::Rest, Eyes::Move] {
        let mut simulation = Simulation::new(1).ratio(1.5).eyes(eyes).waiting();
        let mut gate = Gate::new(GateMode::Auto);
        let run = run(&mut simulation, &mut gate, 10 * 60);
        assert_eq!((run.toggles, run.changes, run.on), (0, 0, true));
        assert!(gate.evidence().is_empty());
    }
}

/// One outlier in ten frames, of ten times the cost, hides nothing.
#[test]
fn outliers_hide_nothing() {
    for (ratio, on) in [(0.8, true), (1.25, false)] {
        let mut simulation = Simulation::new(2).ratio(ratio).noise(0.05).outliers();
        let mut gate = Gate::new(GateMode::Auto);
        assert_eq!(run(&mut simulation, &mut gate, 10 * 60).on, on, "{:?}", gate.evidence().ratio());
        assert_eq!(gate.evidence().verdict().wants_on(), Some(on));
    }
}

/// What grows slowly falls on both sides of every excursion: 0.5 % a frame is not taken for a difference of 1.0.
#[test]
fn drift_is_no_difference() {
    let mut simulation = Simulation::new(3).ratio(1.0).noise(0.02).growing(1.005);
    let mut gate = Gate::new(GateMode::Auto);
    run(&mut simulation, &mut gate, 3);
    let (ratio, _) = gate.evidence().ratio().unwrap();
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

/// A change of scene is judged anew, at once; one every frame is not, and leaves things as they are.
#[test]
fn another_scene_is_judged_anew() {
    let mut gate = Gate::new(GateMode::Auto);
    let mut simulation = Simulation::new(4).ratio(1.4).noise(0.05).eyes(Eyes::Rest);
    assert!(!run(&mut simulation, &mut gate, 10).on);
    let mut simulation = simulation.ratio(0.6);
    gate.frame(&GateFrame { scene_changed: true, ..simulation.frame(gate.is_on()) }, true);
    assert!(gate.evidence().is_empty());
    assert!(run(&mut simulation, &mut gate, 3).on);

    let before = gate.is_on();
    for _ in 0..1000 {
        let frame = GateFrame { scene_changed: true, ..simulation.frame(gate.is_on()) };
        assert_eq!(gate.frame(&frame, true), before);
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
fn what_is_set_holds() {
    for (mode, on) in [(GateMode::On, true), (GateMode::Off, false)] {
        let mut gate = Gate::new(mode);
        let run = run(&mut Simulation::new(6).ratio(if on { 2.0 } else { 0.5 }), &mut gate, 60);
        assert_eq!((run.on, run.toggles, gate.is_away()), (on, 0, false));
    }
}

/// Two techniques, of which one pays and the other costs, are told apart, and never away together.
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
            on = gates.frame(&JudgedFrame {
                time_ns: frame.time_ns,
                cost_ns: frame.cost_ns,
                was_on: on,
                phase: frame.phase,
                scene_changed: false,
                waited: false,
            });
            let gates = gates.gates();
            assert!(!(gates.rates.is_away() && gates.reuse.is_away()));
        }
        let kept = [gates.gates().rates.is_kept(), gates.gates().reuse.is_kept()];
        assert_eq!(kept, [rates < 1.0, reuse < 1.0], "{rates} {reuse}");
    }
}
