//! The fault matrix: with any failure, delay or garbage below the layer, the application sees the same as without the layer.
//!
//! A cell is a call, a fault of it, and a technique. `cargo dev test` runs every [`SHARE`]th cell, `cargo dev faults` all.

mod openxr;
mod runs;
mod technique;
mod vulkan;

use parafovea_test_layers::{VulkanFault, Whose};
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
    print!("{}", table(cells));
    let wrong = wrong.into_inner().unwrap();
    assert!(wrong.is_empty(), "{} of {} cells\n{}", wrong.len(), cells.len(), wrong.join("\n"));
}

/// Numbers of cells by call and technique, in Markdown.
fn table(cells: &[Cell]) -> String {
    let names = Technique::ALL.iter().map(|technique| technique.name);
    let mut rows: BTreeMap<&str, BTreeMap<&str, u32>> = BTreeMap::new();
    for cell in cells {
        *rows.entry(cell.call()).or_default().entry(cell.technique.name).or_default() += 1;
    }
    let heads: String = names.clone().map(|name| format!(" {name} |")).collect();
    let mut text =
        format!("{} cells\n\n| call |{heads}\n|---|{}\n", cells.len(), "---:|".repeat(names.len()));
    for (call, counts) in rows {
        let counts: String = names
            .clone()
            .map(|name| counts.get(name).map_or_else(|| " - |".to_owned(), |count| format!(" {count} |")))
            .collect();
        text += &format!("| {call} |{counts}\n");
    }
    text
}

#[test]
fn a_share_of_the_matrix_holds() {
    let cells = matrix();
    assert!(cells.len() >= 150, "{} cells", cells.len());
    run(&cells.into_iter().step_by(SHARE).collect::<Vec<_>>());
}

/// A render pass with a rate attachment of ours needs an image of ours in each framebuffer. Where one cannot be made, the one that was made
/// with the render pass stands in.
#[test]
fn no_framebuffer_of_the_application_fails_for_an_allocation_of_ours() {
    let technique = Technique::ALL.iter().find(|technique| technique.name == "attachment").unwrap();
    for call in ["vkCreateImage", "vkCreateImageView"] {
        let fault = VulkanFault {
            call: call.to_owned(),
            result: vulkan::OUT_OF_DEVICE_MEMORY,
            whose: Whose::Own,
            // The image that stands in.
            skip: 1,
            count: u64::MAX,
        };
        let run =
            technique.run(&Technique::scenario()).on(technique.config).faulted(Some(&fault)).validated();
        let outcome = run.finish().unwrap().expect_frames(runs::FRAMES).unwrap();
        let reports = outcome.faults().unwrap();
        assert!(reports.iter().any(|report| report.failed > 0), "{call}: nothing failed\n{}", outcome.log);
        let framebuffers = reports.iter().filter_map(|report| report.application.get("vkCreateFramebuffer"));
        assert!(framebuffers.sum::<u64>() > 0, "{call}: {reports:?}");
    }
}

#[test]
#[ignore = "minutes: cargo dev faults"]
fn the_whole_matrix_holds() {
    let wanted = std::env::var("PARAFOVEA_FAULTS").unwrap_or_default();
    let cells: Vec<Cell> = matrix().into_iter().filter(|cell| cell.to_string().contains(&wanted)).collect();
    run(&cells);
}
