//! `cargo dev soak churn [--minutes N] [STYLE]`: an hour, or so long, of sessions that make and destroy swapchains, targets, render passes and framebuffers of
//! changing sizes, with every technique on, beside the same without the layer. Prints medians of parts, and fails where memory or objects of the layer grow.

use parafovea_tests::churn::{Backend, churn};
use std::process::ExitCode;
use std::time::Duration;

const MINUTES: u64 = 60;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (minutes, style) = match &arguments[..] {
        [option, minutes, rest @ ..] if option == "--minutes" => (minutes.parse().ok(), rest),
        all => (Some(MINUTES), all),
    };
    let style = match style {
        [] => Some(None),
        [style] if !style.starts_with('-') => Some(Some(style.clone())),
        _ => None,
    };
    let (Some(minutes), Some(style)) = (minutes.filter(|&minutes: &u64| minutes > 0), style) else {
        eprintln!("usage: cargo dev soak churn [--minutes N] [STYLE]");
        return ExitCode::from(2);
    };
    let time = Duration::from_secs(60 * minutes);
    let runs = [Backend::Mask, Backend::Attachment].map(|backend| {
        let style = style.clone();
        std::thread::spawn(move || churn(backend, time, 0, style.as_deref()))
    });
    let mut is_flat = true;
    for run in runs {
        match run.join() {
            Ok(Ok(churn)) => {
                println!("{}", churn.table());
                let grown = churn.growth();
                grown.iter().for_each(|grown| println!("{}: {grown}", churn.backend.name()));
                is_flat &= grown.is_empty();
            }
            Ok(Err(error)) => {
                eprintln!("{error}");
                is_flat = false;
            }
            // It has said why.
            Err(_) => is_flat = false,
        }
    }
    if is_flat { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
