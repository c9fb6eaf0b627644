//! Shows the scene in one style, for so many frames.

use clap::Parser;
use parafovea_zoo::{End, Options, SKIPPED, STYLES, devices, run, style};
use std::process::ExitCode;

fn main() -> ExitCode {
    let options = Options::parse();
    if options.devices {
        return match print_devices() {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("{error:#}");
                ExitCode::FAILURE
            }
        };
    }
    let Some(name) = options.style.as_deref().filter(|_| !options.list) else {
        for style in STYLES {
            println!("{:20} {}", style.name, style.says);
        }
        return ExitCode::SUCCESS;
    };
    let Some(style) = style(name) else {
        eprintln!("no style {name}: --list prints the names");
        return ExitCode::from(2);
    };
    match run(style, &options) {
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

fn print_devices() -> anyhow::Result<()> {
    for device in devices()? {
        println!("{}", serde_json::to_string(&device)?);
    }
    Ok(())
}
