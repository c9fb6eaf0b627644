//! Shows the scene in one style, for so many frames.

use clap::Parser;
use parafovea_zoo::{End, Options, SKIPPED, STYLES, churn, devices, run, shading_rates, style};
use serde::Serialize;
use std::process::ExitCode;
use std::time::Duration;

fn main() -> ExitCode {
    let options = Options::parse();
    if options.devices {
        return print(devices());
    }
    if options.shading_rates {
        return print(shading_rates());
    }
    if let Some(seconds) = options.churn {
        return ended("churn", churn(&options, Duration::from_secs(seconds)));
    }
    let Some(name) = options.style.as_deref().filter(|_| !options.list) else {
        for style in STYLES {
            println!("{:20} {}", style.name, style.says);
        }
        return ExitCode::SUCCESS;
    };
    let Some(style) = style(name) else {
        eprintln!("unknown style {name}; to list the styles: --list");
        return ExitCode::from(2);
    };
    ended(name, run(style, &options))
}

fn ended(name: &str, end: anyhow::Result<End>) -> ExitCode {
    match end {
        Ok(End::Shown) => ExitCode::SUCCESS,
        Ok(End::Skipped(lacking)) => {
            println!("{SKIPPED}{lacking}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{name}: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Prints one JSON object a line.
fn print<T: Serialize>(objects: anyhow::Result<Vec<T>>) -> ExitCode {
    let lines = objects.and_then(|objects| {
        objects.iter().map(|object| Ok(serde_json::to_string(object)?)).collect::<anyhow::Result<Vec<_>>>()
    });
    match lines {
        Ok(lines) => {
            lines.iter().for_each(|line| println!("{line}"));
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::FAILURE
        }
    }
}
