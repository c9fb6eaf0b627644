//! The table of applications that change their resolution.

use super::super::game::{Control, Game};
use super::{Eyes, LONG_SEEDS, SEEDS, most_within};

/// Controls, and the shares of the cost that follow the pixels.
const GAMES: [(Control, f64); 10] = [
    (Control::Smooth(0.05), 0.9),
    (Control::Smooth(0.05), 0.5),
    (Control::Smooth(0.5), 0.7),
    (Control::Steps(0.1), 0.7),
    (Control::Steps(1.0), 0.7),
    (Control::Steps(5.0), 0.7),
    (Control::Setting(3.0), 0.7),
    (Control::Jumps(4.0), 0.7),
    (Control::Jumps(4.0), 0.0),
    (Control::Wander(1.0), 0.0),
];

/// Least seeds of 100 that are right. Noise of 10 % hides 10 % from the gate where pixels change whatever frames cost: both ends have to
/// agree, and then rates are off.
fn least_right(gain: f64, control: Control) -> usize {
    let is_random = matches!(control, Control::Wander(_) | Control::Jumps(_));
    if gain == 0.1 && is_random { 70 } else { 90 }
}

#[test]
fn decisions_equal_the_truth_at_changing_resolutions() {
    println!(
        "\n| gain, % | resolution | share that follows pixels, % | right after 30 s, of 100 | switches seen in a minute \
         | off, % of 10 minutes | off without the count of pixels, % |\n|---:|---|---:|---:|---:|---:|---:|"
    );
    for gain in [0.25, 0.1, 0.0, -0.05] {
        for (control, share) in GAMES {
            let game = Game { control, share, gain, ..Game::DEFAULT };
            let run = |seed| game.play(Eyes::Rest, seed, if seed < LONG_SEEDS { 600 } else { 30 });
            let runs: Vec<_> = (0..SEEDS).map(run).collect();
            let right = runs.iter().filter(|run| run.is_kept_at_30_s == (gain > 0.0)).count();
            let in_minute = runs.iter().map(|run| most_within(&run.seen_ns, 60)).max().unwrap();
            let mean = |on: &dyn Fn(u64) -> f64| (0..LONG_SEEDS).map(on).sum::<f64>() / LONG_SEEDS as f64;
            let on = mean(&|seed| runs[seed as usize].on);
            let unknown = Game { is_known: false, ..game };
            let on_before = mean(&|seed| unknown.play(Eyes::Rest, seed, 600).on);
            println!(
                "| {:.0} | {control:?} | {:.0} | {right} | {in_minute} | {:.1} | {:.1} |",
                gain * 100.0,
                share * 100.0,
                100.0 - on * 100.0,
                100.0 - on_before * 100.0
            );
            let case = format!("gain {gain}, {control:?}, share {share}");
            assert!(right >= least_right(gain, control), "{case}: {right} of 100 right");
            assert!(in_minute <= 4, "{case}: {in_minute} switches");
            assert!(gain != 0.25 || on > 0.9, "{case}: on {on}");
            // One seed of ten at the most.
            assert!(gain != -0.05 || on < 0.15, "{case}: on {on}");
        }
    }
}
