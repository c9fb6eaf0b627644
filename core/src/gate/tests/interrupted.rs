//! Trials that end without a decision, and decisions that are forgotten.

use super::*;

/// Scenes by turns, each too short for a decision, as a vehicle that is entered and left: at most four switches in any minute with open eyes, fewer
/// and fewer of them, and no technique is on for ever without a decision.
#[test]
fn scenes_too_short_for_a_decision_are_seldom_tried() {
    for period in [12, 15, 20] {
        for (gain, seed) in [0.0, 0.03].into_iter().flat_map(|gain| [(gain, 1), (gain, 2), (gain, 3)]) {
            let mut simulation = Simulation::new(seed).ratio(1.0 - gain).noise(0.2).eyes(Eyes::Rest);
            let mut gate = Gate::new(GateMode::Auto);
            let (mut seen, mut was_on) = (Vec::new(), true);
            while simulation.now() < 20 * 60 * SECOND {
                let passes = Some((simulation.now() / SECOND / period % 2) as u32);
                let frame = GateFrame { passes, ..simulation.frame(gate.is_on()) };
                let on = gate.frame(&frame, true);
                if std::mem::replace(&mut was_on, on) != on {
                    seen.push(frame.time_ns);
                }
            }
            let way = format!("{period} s, gain {gain}, seed {seed}: {seen:?}");
            assert!(seen.windows(5).all(|window| window[4] - window[0] >= TRIAL_REST_NS), "{way}");
            let late = seen.iter().filter(|&&time| time >= 10 * 60 * SECOND).count();
            assert!(late <= 8, "{way}");
            assert!(gain > 0.0 || !gate.is_kept(), "{way}");
        }
    }
}

/// A loading screen ends the first trial without enough costs: the next one decides.
#[test]
fn a_trial_without_eye_passes_is_repeated() {
    let mut gate = Gate::new(GateMode::Auto);
    let mut simulation = Simulation::new(9).ratio(1.3).eyes(Eyes::Rest);
    let mut had_trial = false;
    while simulation.now() < 140 * SECOND {
        let is_loading = (SECOND..60 * SECOND).contains(&simulation.now());
        let frame = simulation.frame(gate.is_on());
        gate.frame(&GateFrame { passes: if is_loading { None } else { Some(2) }, ..frame }, true);
        had_trial |= is_loading && gate.has_trial();
    }
    assert!(had_trial && !gate.is_kept());
    assert_eq!(gate.evidence().verdict(), Verdict::SavesNothing);
}

/// Costs that end with the first trial, and return for the next one only: then the technique is off, without a decision.
#[test]
fn a_technique_is_off_after_two_trials_without_costs() {
    let mut gate = Gate::new(GateMode::Auto);
    let mut simulation = Simulation::new(9).ratio(0.7).eyes(Eyes::Rest);
    while simulation.now() < 300 * SECOND {
        let frame = simulation.frame(gate.is_on());
        let cost_ns = frame.cost_ns.filter(|_| !gate.has_trial());
        gate.frame(&GateFrame { cost_ns, ..frame }, true);
    }
    assert!(!gate.is_kept() && gate.evidence().is_empty());
}

/// Other settings of a technique that was dropped: it is on at once, and judged by its new cost.
#[test]
fn forgotten_decisions_are_made_again() {
    for (later, on) in [(0.6, true), (1.2, false)] {
        let mut simulation = Simulation::new(10).ratio(1.2).noise(0.05).eyes(Eyes::Rest);
        let mut gate = Gate::new(GateMode::Auto);
        assert!(!run(&mut simulation, &mut gate, 30).on);
        gate.forget_decisions();
        assert!(gate.is_kept() && gate.evidence().is_empty());
        let run = run(&mut simulation.ratio(later), &mut gate, 45);
        assert_eq!((run.on, gate.evidence().is_empty()), (on, false));
    }
}

/// Re-use that goes during a trial of rates, for example because a pass reads earlier frames: its cost is none of rates.
#[test]
fn a_technique_that_goes_ends_the_trial_of_the_other() {
    let auto = Techniques { rates: GateMode::Auto, reuse: GateMode::Auto };
    let mut gates = Gates::new(auto);
    let mut simulation = Simulation::new(7).noise(0.05);
    while !gates.gates().rates.has_trial() {
        let frame = simulation.frame(true);
        let (time_ns, phase) = (frame.time_ns, GazePhase::Fixation);
        let was_on = Techniques { rates: true, reuse: true };
        gates.frame(&MeasuredFrame {
            time_ns,
            cost_ns: frame.cost_ns,
            was_on,
            phase,
            passes: Some(2),
            pixels: 0,
        });
    }
    gates.set_mode(auto);
    assert!(gates.gates().rates.has_trial(), "nothing changed");
    gates.set_mode(Techniques { reuse: GateMode::Off, ..auto });
    assert!(!gates.gates().rates.has_trial());
}
