//! `cargo dev bench budget`: shading and loss of rates on six stills, by the look of hardware rates, by way of spending an error budget.
//!
//! The gaze of one eye is at the centre of the view. The planner makes the maps, as `decide` does on the GPU. A still at a rate shows one sample for
//! each block of pixels: the mean of the pixels around its centre, like a texture that is sampled at a fitting level, or one of these pixels, like an
//! edge or a highlight.

#[path = "budget/maps.rs"]
mod maps;
#[path = "budget/stills.rs"]
mod stills;

use maps::{Way, ways};
use std::thread::{self, available_parallelism};
use stills::{Sampling, Still, stills};

/// Shading and loss of one way of choosing rates on a still.
struct Figures {
    share: f64,
    /// For each way of sampling: the mean loss over the view, and the detected loss, JND.
    lost: [[f64; 2]; 2],
}

fn main() {
    let stills = stills();
    if stills.is_empty() {
        eprintln!("no stills: no Vulkan device");
        return;
    }
    println!("{}", HEAD.trim_end());
    for way in ways(&stills) {
        let figures = at_once(&stills, |still| figures(&way, still));
        let mean = |of: &dyn Fn(&Figures) -> f64| figures.iter().map(of).sum::<f64>() / figures.len() as f64;
        print!("{:<46} {:.3}", way.name, mean(&|one| one.share));
        for sampling in 0..2 {
            let [loss, detected] = [0, 1].map(|kind: usize| mean(&|one| one.lost[sampling][kind]));
            print!("  {loss:.3} {detected:>5.2}");
        }
        let each: Vec<String> = figures
            .iter()
            .map(|one| format!("{:.3} {:.3} {:>5.2}", one.share, one.lost[0][0], one.lost[0][1]))
            .collect();
        println!("  | {}", each.join("  "));
    }
    let names: Vec<&str> = stills.iter().map(|still| still.name).collect();
    println!("stills: {}", names.join(", "));
}

const HEAD: &str = "\
Shaded: samples for each pixel. JND: mean over the view, and detected. In the mean of all stills, where blocks show a mean, then where they show one
pixel; then each still, where blocks show a mean.

                                               shaded  mean, det.   one, det.   | each still
";

fn figures(way: &Way, still: &Still) -> Figures {
    let map = way.map(still);
    let lost = [Sampling::Mean, Sampling::One].map(|sampling| still.lost(&map, sampling));
    Figures { share: map.share(), lost }
}

/// Does the same with each, on as many threads as there are processors.
fn at_once<T: Sync, R: Send>(each: &[T], what: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let what = &what;
    let chunks = each.chunks(available_parallelism().map_or(1, usize::from));
    chunks
        .flat_map(|together| {
            thread::scope(|scope| {
                let started: Vec<_> = together.iter().map(|one| scope.spawn(move || what(one))).collect();
                let joined = started
                    .into_iter()
                    .map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
                joined.collect::<Vec<_>>()
            })
        })
        .collect()
}
