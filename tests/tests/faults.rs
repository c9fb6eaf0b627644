//! The fault matrix: whatever fails, comes late or is garbage below the layer, the application sees what it sees without the layer.
//!
//! A cell is a call, a fault of it, and a technique. `cargo dev test` runs every [`SHARE`]th cell, `cargo dev faults` all.

mod openxr;
mod runs;
mod technique;
mod vulkan;

use runs::Cell;
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use technique::Technique;

/// One cell in so many runs in every test.
const SHARE: usize = 8;

/// Runs of applications at a time.
const AT_ONCE: usize = 2;

/// All cells, technique by technique.
fn matrix() -> Vec<Cell> {
    let of =
        |technique: &'static Technique| vulkan::cells(technique).into_iter().chain(openxr::cells(technique));
    Technique::ALL.iter().flat_map(of).collect()
}

/// Runs cells, and panics with all that is wrong.
fn run(cells: &[Cell]) {
    let next = AtomicUsize::new(0);
    let wrong = Mutex::new(Vec::new());
    let work = || {
        while let Some(cell) = cells.get(next.fetch_add(1, Ordering::Relaxed)) {
            if let Err(reason) = cell.check() {
                eprintln!("{cell}: {reason}");
                wrong.lock().unwrap().push(cell.to_string());
            }
        }
    };
    std::thread::scope(|scope| (0..AT_ONCE).for_each(|_| drop(scope.spawn(work))));
    let mut counts = BTreeMap::new();
    cells.iter().for_each(|cell| *counts.entry(cell.technique.name).or_insert(0) += 1);
    println!("{} cells: {counts:?}", cells.len());
    let wrong = wrong.into_inner().unwrap();
    assert!(wrong.is_empty(), "{} of {} cells\n{}", wrong.len(), cells.len(), wrong.join("\n"));
}

#[test]
fn a_share_of_the_matrix_holds() {
    let cells = matrix();
    assert!(cells.len() >= 150, "{} cells", cells.len());
    run(&cells.into_iter().step_by(SHARE).collect::<Vec<_>>());
}

#[test]
#[ignore = "minutes: cargo dev faults"]
fn the_whole_matrix_holds() {
    let wanted = std::env::var("PARAFOVEA_FAULTS").unwrap_or_default();
    let cells: Vec<Cell> = matrix().into_iter().filter(|cell| cell.to_string().contains(&wanted)).collect();
    run(&cells);
}
