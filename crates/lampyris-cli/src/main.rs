//! The command line of Lampyris: checked arguments in, library calls, and words about them.
//!
//! Results go to the standard output; progress, warnings and errors to the standard error.

mod args;
mod budget;
mod convert;
mod denoise;
mod films;
mod format;
mod generate;
mod image_commands;
mod info;
mod interrupt;
mod memory;
mod meter;
mod photons;
mod preview;
mod progress;
mod render;
mod report;
mod scene;
mod snapshots;
mod stats;
mod transient;

use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command};
use report::Failure;

/// What the program says to the shell in the end. A panic, which is our fault and nobody else's, gives 101.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum Exit {
    /// All is done.
    Done = 0,
    /// Something that the user gave is wrong, or a file cannot be read or written. What clap finds wrong with the
    /// arguments has this code too.
    BadInput = 2,
    /// A second Ctrl-C: 128 and the number of the signal, as shells have it.
    Interrupted = 130,
}

fn main() -> ExitCode {
    match run(&Arguments::parse().command) {
        Ok(()) => ExitCode::from(Exit::Done as u8),
        Err(failure) => {
            failure.report();
            ExitCode::from(Exit::BadInput as u8)
        }
    }
}

fn run(command: &Command) -> Result<(), Failure> {
    match command {
        Command::Render(arguments) => render::run(arguments),
        Command::Merge(arguments) => films::merge(arguments),
        Command::Photons(arguments) => photons::run(arguments),
        Command::Denoise(arguments) => denoise::run(arguments),
        Command::Info(arguments) => info::info(arguments),
        Command::Check(arguments) => info::check(arguments),
        Command::Convert(arguments) => convert::run(arguments),
        Command::Tonemap(arguments) => Ok(image_commands::tonemap(arguments)?),
        Command::Compare(arguments) => Ok(image_commands::compare(arguments)?),
        Command::Transient(arguments) => Ok(transient::run(arguments)?),
        Command::Completions(arguments) => Ok(generate::completions(arguments.shell)?),
        Command::Man(arguments) => Ok(generate::man(&arguments.output)?),
        Command::Schema => Ok(report::print(&lampyris::scene::schema::json_schema())?),
    }
}
